//! A daemon in this process or in its own, a small HTTP client, and waits for conditions.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use daemon::limits::Waits;
use daemon::{Daemon, Options};
use engine::config::Config;
use serde_json::{Value, json};

/// Every awaited condition comes sooner, or never.
const LIMIT: Duration = Duration::from_secs(90);

/// A daemon in this process with folders of its own.
pub struct Rig {
    pub daemon: Option<Daemon>,
    pub folder: tempfile::TempDir,
    pub address: SocketAddr,
}

impl Rig {
    pub fn new() -> Self {
        Self::with("", |_| {})
    }

    /// Starts a daemon with more keys under `[daemon]` and changed options.
    pub fn with(more: &str, change: impl FnOnce(&mut Options)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            "device = 'sim'\n[daemon]\nscans = '{}'\nreserve_bytes = 1000\n{more}",
            folder.path().join("scans").display()
        );
        let config: Config = toml::from_str(&text).unwrap();
        let mut options = Options {
            config,
            listen: Some("127.0.0.1:0".parse().unwrap()),
            runtime: Some(folder.path().to_owned()),
            waits: Waits::default(),
            ..Options::default()
        };
        change(&mut options);
        let daemon = Daemon::start(options).unwrap();
        let address = daemon.address();
        Self {
            daemon: Some(daemon),
            folder,
            address,
        }
    }

    pub fn daemon(&self) -> &Daemon {
        self.daemon.as_ref().unwrap()
    }

    pub fn get(&self, path: &str) -> Answer {
        request(self.address, "GET", path, "", "")
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        post(self.address, path, body)
    }

    pub fn status(&self) -> Value {
        self.get("/api/v1/status").json()
    }

    /// Waits until both devices are connected and the axis is idle.
    pub fn ready(&self) -> &Self {
        ready(self.address);
        self
    }

    /// Makes a scan and waits for its end.
    pub fn scan(&self, request: &Value) -> Value {
        let answer = self.post("/api/v1/captures", request);
        assert_eq!(answer.status, 201, "{}", answer.text());
        self.finished(answer.json()["id"].as_str().unwrap())
    }

    /// Makes a complete scan.
    pub fn whole_scan(&self, request: &Value) -> Value {
        let scan = self.scan(request);
        assert_eq!(scan["state"], "whole", "{scan}");
        scan
    }

    /// Waits for the scan's final state.
    pub fn finished(&self, id: &str) -> Value {
        finished(self.address, id)
    }

    pub fn log(&self, id: &str) -> PathBuf {
        self.folder.path().join("scans").join(id).join("log.pcapng")
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        if let Some(daemon) = self.daemon.take() {
            let stopped = daemon.stop(|| true);
            if !std::thread::panicking() {
                stopped.unwrap();
            }
        }
    }
}

/// Repeats `wanted` until it returns a value.
pub fn wait<T>(what: &str, mut wanted: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = wanted() {
            return found;
        }
        assert!(begin.elapsed() < LIMIT, "timed out: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

pub fn ready(address: SocketAddr) {
    wait("both devices", || {
        let status = request(address, "GET", "/api/v1/status", "", "").json();
        let connected = |which: &str| status[which]["state"] == "connected";
        let idle = status["activity"]["doing"] == "idle";
        (connected("drive") && connected("lidar") && idle).then_some(())
    });
}

pub fn finished(address: SocketAddr, id: &str) -> Value {
    wait("the end of the scan", || {
        let scan = request(address, "GET", &format!("/api/v1/scans/{id}"), "", "").json();
        let over = ["whole", "partial", "failed"].contains(&scan["state"].as_str().unwrap());
        over.then_some(scan)
    })
}

/// An answer to a request.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Checks that the request was refused with this status, and returns the error object.
    pub fn refused(&self, status: u16, what: &str) -> Value {
        assert_eq!(self.status, status, "{what}: {}", self.text());
        let printed = self.json();
        assert_eq!(printed["schema"], "error-1", "{what}: {printed}");
        let error = &printed["error"];
        for key in ["message", "help", "kind"] {
            assert!(error[key].is_string(), "{what}: no {key} in {printed}");
        }
        assert!(error["exit_code"].is_u64(), "{what}: {printed}");
        error.clone()
    }
}

pub fn post(address: SocketAddr, path: &str, body: &Value) -> Answer {
    let json = "content-type: application/json\r\n";
    request(address, "POST", path, json, &body.to_string())
}

/// Sends a request with more header lines.
pub fn request(address: SocketAddr, method: &str, path: &str, headers: &str, body: &str) -> Answer {
    let host = match headers.to_lowercase().contains("host:") {
        true => String::new(),
        false => format!("host: {address}\r\n"),
    };
    let length = match (method, body) {
        ("GET", "") => String::new(),
        _ => format!("content-length: {}\r\n", body.len()),
    };
    let text = format!(
        "{method} {path} HTTP/1.1\r\n{host}{headers}{length}connection: close\r\n\r\n{body}"
    );
    raw(address, text.as_bytes())
}

/// Sends these bytes.
pub fn raw(address: SocketAddr, bytes: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    // The daemon may refuse a request before it has read all of it.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let end = answer.windows(4).position(|four| four == b"\r\n\r\n");
    let Some(end) = end else {
        return Answer {
            status: 0,
            head: String::new(),
            body: answer,
        };
    };
    let head = String::from_utf8_lossy(&answer[..end]).into_owned();
    Answer {
        status: head.split(' ').nth(1).unwrap().parse().unwrap(),
        head,
        body: answer[end + 4..].to_vec(),
    }
}

/// The program in `folder`, with every default folder inside it.
pub fn velomotion(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_velomotion"));
    command
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_STATE_HOME", folder)
        .env("XDG_CONFIG_HOME", folder)
        .env_remove("RUST_LOG")
        .env_remove("RUNTIME_DIRECTORY")
        .env_remove("STATE_DIRECTORY");
    command
}

pub fn run(folder: &Path, line: &str) -> Output {
    velomotion(folder, line).output().unwrap()
}

/// The text on stderr without line breaks.
pub fn printed(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).replace('│', " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A daemon in its own process.
pub struct Process {
    pub child: Child,
    pub address: SocketAddr,
}

impl Process {
    /// Starts a daemon in `folder` with the configuration there.
    pub fn start(folder: &Path) -> Self {
        Self::of(velomotion(folder, "daemon --listen 127.0.0.1:0 --json"))
    }

    /// Starts this command of a daemon that prints JSON.
    pub fn of(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        let mut printed = BufReader::new(child.stdout.take().unwrap());
        printed.read_line(&mut line).unwrap();
        let reported: Value =
            serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line:?}"));
        let address = reported["address"].as_str().unwrap().parse().unwrap();
        Self { child, address }
    }

    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args([name, &id]).status().unwrap();
        assert!(sent.success());
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A folder with a configuration that names the simulator.
pub fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = "device = 'sim'\n[daemon]\nreserve_bytes = 1000\n";
    std::fs::write(folder.path().join("velomotion.toml"), text).unwrap();
    folder
}

/// Starts a sweep that is long enough to be interrupted, and waits until the axis moves. Returns
/// the scan's id.
pub fn sweep(address: SocketAddr) -> String {
    ready(address);
    let answer = post(address, "/api/v1/captures", &json!({ "speed_deg_s": 5.0 }));
    assert_eq!(answer.status, 201, "{}", answer.text());
    let id = answer.json()["id"].as_str().unwrap().to_owned();
    assert!(sweeps(address), "{}", finished(address, &id));
    id
}

/// Waits until the axis sweeps. Returns false if the capture ended before.
pub fn sweeps(address: SocketAddr) -> bool {
    // The highest angle since the start of the sweep: the first reported one may be older.
    let mut highest = f64::NEG_INFINITY;
    wait("a sweep", || {
        let status = request(address, "GET", "/api/v1/status", "", "").json();
        if status["activity"]["doing"] != "capturing" {
            return Some(false);
        }
        let moving = status["activity"]["step"].as_u64()? > 0;
        let angle = status["drive"]["angle_deg"].as_f64()?;
        if moving {
            highest = highest.max(angle);
        }
        (moving && angle < highest - 1.0).then_some(true)
    })
}
