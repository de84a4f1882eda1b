//! HTTP client of a daemon that has the device, over its Unix socket, with one connection per
//! request.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use io::processes::{self, SocketOwner};

use super::sockets;
use engine::config::Device;
use engine::failure::{Failure, Kind};

/// Longest wait for an answer: homing, or a stop of a capture.
const ANSWER: Duration = Duration::from_secs(180);
/// Longest wait for an answer that a person needs at once: the axis's state, and its stop, which
/// takes a few seconds with a drive that does not answer.
const URGENT_ANSWER: Duration = Duration::from_secs(10);
/// Paths of these requests.
const URGENT: [&str; 3] = ["/api/v1/status", "/api/v1/tilt", "/api/v1/tilt/stop"];
/// Longest header line, bytes.
const LINE: u64 = 8 << 10;
const LINES: usize = 64;
/// Largest JSON body, bytes.
const JSON: u64 = 64 << 20;

/// Client of one daemon.
#[derive(Clone, Debug)]
pub struct Client {
    /// Its socket.
    pub socket: PathBuf,
}

/// An answer whose body is unread.
struct Answer {
    status: u16,
    length: u64,
    body: BufReader<UnixStream>,
}

/// The part of the status that clients of this program read.
#[derive(Debug, Deserialize)]
#[non_exhaustive]
pub struct RemoteStatus {
    /// The task of the axis.
    pub activity: RemoteActivity,
    /// The drive.
    pub drive: RemoteDrive,
}

/// The task of the axis.
#[derive(Debug, Deserialize)]
#[non_exhaustive]
pub struct RemoteActivity {
    /// Number of the move, from 1.
    pub step: usize,
    /// Lidar packets of the capture so far.
    pub received: u64,
}

/// The drive.
#[derive(Debug, Deserialize)]
#[non_exhaustive]
pub struct RemoteDrive {
    /// Port.
    pub port: Option<PathBuf>,
    /// Angle of the axis, degrees.
    pub angle_deg: Option<f64>,
}

impl Client {
    /// The daemon that has the device, if one runs. A daemon that denies access is logged.
    #[must_use]
    pub fn find(profile: &str, device: &Device) -> Option<Self> {
        let named = sockets::candidates(profile, device).into_iter();
        let port = device.port.as_deref();
        let in_use = port.is_some_and(|port| !processes::holders(port).is_empty());
        let mut reached = named.filter_map(Self::reach);
        let found =
            reached.find(
                |client| match in_use && client.holds_port(device) == Some(false) {
                    true => {
                        let socket = client.socket.display();
                        tracing::warn!(
                            "{socket} is ignored: its program does not have the drive's port"
                        );
                        false
                    }
                    false => true,
                },
            );
        found.or_else(|| {
            let looking = sockets::looking(device).into_iter();
            let mut reached = looking.filter_map(Self::reach);
            reached.find(|client| client.has_port(device.port.as_deref()))
        })
    }

    /// Whether the process at the socket has the device's serial port open; `None` if that is not
    /// visible, or the device has no such port.
    #[must_use]
    pub fn holds_port(&self, device: &Device) -> Option<bool> {
        let port = device.port.as_deref()?;
        let stream = UnixStream::connect(&self.socket).ok()?;
        processes::has_open(SocketOwner::of(&stream)?.pid, port)
    }

    /// Client of the daemon at a socket, if one of a trusted user answers.
    fn reach(socket: PathBuf) -> Option<Self> {
        match UnixStream::connect(&socket) {
            Ok(stream) => match SocketOwner::of(&stream) {
                Some(owner) if sockets::is_trusted_user(&socket, owner.uid) => {
                    return Some(Self { socket });
                }
                owner => tracing::warn!(
                    "{} is ignored: {owner:?} listens there, which is another user",
                    socket.display()
                ),
            },
            Err(error) if error.kind() == ErrorKind::PermissionDenied => tracing::warn!(
                "a daemon may have the device, and denies access to it: {}; \
                 join the group that owns its socket (adduser YOU velomotion), and log in again",
                socket.display()
            ),
            Err(_) => {}
        }
        None
    }

    /// Whether the daemon's drive is at this port.
    fn has_port(&self, port: Option<&Path>) -> bool {
        let real = |port: &Path| port.canonicalize().ok();
        let Ok(status) = self.status() else {
            return false;
        };
        let found = status.drive.port.as_deref().and_then(real);
        found.is_some() && found == port.and_then(real)
    }

    /// The status.
    ///
    /// # Errors
    /// As [`Client::get`].
    pub fn status(&self) -> Result<RemoteStatus, Failure> {
        self.get("/api/v1/status")
    }

    /// The daemon that answers at a socket.
    #[must_use]
    pub const fn at(socket: PathBuf) -> Self {
        Self { socket }
    }

    /// `GET`, in JSON.
    ///
    /// # Errors
    /// The daemon's own failure, or that it is gone.
    pub fn get<T: DeserializeOwned>(&self, path: &str) -> Result<T, Failure> {
        self.json(self.request("GET", path, None)?)
    }

    /// `POST` of a body, in JSON.
    ///
    /// # Errors
    /// As [`Client::get`].
    pub fn post<T: DeserializeOwned>(
        &self,
        path: &str,
        body: &impl Serialize,
    ) -> Result<T, Failure> {
        let body = serde_json::to_vec(body).map_err(|error| self.gone(&error.to_string()))?;
        self.json(self.request("POST", path, Some(&body))?)
    }

    /// `DELETE`.
    ///
    /// # Errors
    /// As [`Client::get`].
    pub fn delete(&self, path: &str) -> Result<(), Failure> {
        let answer = self.request("DELETE", path, None)?;
        match answer.status {
            200..300 => Ok(()),
            _ => Err(self.refused(answer)),
        }
    }

    /// `GET` into a writer. Returns the number of bytes.
    ///
    /// # Errors
    /// Those of [`Client::get`], and an error of the writer.
    pub fn download(&self, path: &str, out: &mut dyn Write) -> Result<u64, Failure> {
        let mut answer = self.request("GET", path, None)?;
        if answer.status != 200 {
            return Err(self.refused(answer));
        }
        let length = answer.length;
        let copied = std::io::copy(&mut (&mut answer.body).take(length), out);
        match copied {
            Ok(copied) if copied == length => Ok(copied),
            Ok(copied) => Err(self.gone(&format!("{copied} of {length} bytes came"))),
            Err(error) => Err(Failure::new(
                Kind::Incomplete,
                format!("what the daemon recorded could not be copied: {error}"),
            )
            .help("free some space; the scan is kept by the daemon")),
        }
    }

    fn json<T: DeserializeOwned>(&self, answer: Answer) -> Result<T, Failure> {
        if !(200..300).contains(&answer.status) {
            return Err(self.refused(answer));
        }
        let length = answer.length.min(JSON);
        serde_json::from_reader(answer.body.take(length))
            .map_err(|error| self.gone(&format!("its answer is not what was expected: {error}")))
    }

    /// The failure in a refusal.
    fn refused(&self, answer: Answer) -> Failure {
        #[derive(Deserialize)]
        struct RefusalBody {
            error: Failure,
        }
        let status = answer.status;
        let length = answer.length.min(JSON);
        match serde_json::from_reader::<_, RefusalBody>(answer.body.take(length)) {
            Ok(refused) => refused.error,
            Err(_) => self.gone(&format!("it answers {status}")),
        }
    }

    fn gone(&self, why: &str) -> Failure {
        Failure::new(
            Kind::Incomplete,
            format!("the connection to the daemon at {} is lost: {why}", self.socket.display()),
        )
        .help("see its log (journalctl -u velomotion); the daemon keeps what it recorded and lists it after its next start")
    }

    fn request(&self, method: &str, path: &str, body: Option<&[u8]>) -> Result<Answer, Failure> {
        self.try_request(method, path, body)
            .map_err(|error| match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => self.silent(path),
                _ => self.gone(&error.to_string()),
            })
    }

    /// The failure of a program that has the device and does not answer.
    fn silent(&self, path: &str) -> Failure {
        let owner = UnixStream::connect(&self.socket).ok();
        let program = match owner.as_ref().and_then(SocketOwner::of) {
            Some(owner) => format!("process {}", owner.pid),
            None => "the program".to_owned(),
        };
        let limit = limit(path).as_secs();
        let socket = self.socket.display();
        let message =
            format!("{program} at {socket} has the device and has not answered for {limit} s");
        Failure::new(Kind::DeviceFault, message).help(
            "switch the motor's supply off if the axis moves and must not\n\
             the process may hang or be suspended (kill -CONT); if it is killed, its guardian stops the axis",
        )
    }

    fn try_request(
        &self,
        method: &str,
        path: &str,
        body: Option<&[u8]>,
    ) -> std::io::Result<Answer> {
        let mut stream = UnixStream::connect(&self.socket)?;
        stream.set_read_timeout(Some(limit(path)))?;
        let mut request =
            format!("{method} {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n");
        if let Some(body) = body {
            let length = body.len();
            request.push_str(&format!(
                "content-type: application/json\r\ncontent-length: {length}\r\n"
            ));
        }
        request.push_str("\r\n");
        stream.write_all(request.as_bytes())?;
        stream.write_all(body.unwrap_or_default())?;
        let mut answer = BufReader::new(stream);
        let status = line(&mut answer)?;
        let status = status.split(' ').nth(1).and_then(|code| code.parse().ok());
        let mut length = None;
        for _ in 0..LINES {
            let line = line(&mut answer)?;
            if line.is_empty() {
                return match (status, length) {
                    (Some(status), length) => Ok(Answer {
                        status,
                        length: length.unwrap_or(0),
                        body: answer,
                    }),
                    (None, _) => Err(std::io::Error::other("its answer is not HTTP")),
                };
            }
            if let Some((name, value)) = line.split_once(':')
                && name.eq_ignore_ascii_case("content-length")
            {
                length = value.trim().parse().ok();
            }
        }
        Err(std::io::Error::other(
            "its answer has too many header lines",
        ))
    }
}

/// Longest wait for the answer to a request.
fn limit(path: &str) -> Duration {
    match URGENT.contains(&path) {
        true => URGENT_ANSWER,
        false => ANSWER,
    }
}

/// A header line without its end.
fn line(answer: &mut BufReader<UnixStream>) -> std::io::Result<String> {
    let mut line = String::new();
    answer.take(LINE).read_line(&mut line)?;
    if !line.ends_with('\n') {
        return Err(std::io::Error::other("its answer ends too early"));
    }
    Ok(line.trim_end().to_owned())
}
