//! Idle connections and connection limits.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::os::unix::net::{UnixListener, UnixStream};
use std::process::Command;
use std::time::{Duration, Instant};

use daemon::client::Client;
use daemon::limits::{CONNECTIONS, LOCAL_CONNECTIONS};
use serde_json::Value;

use super::rig::{Rig, request, velomotion, wait};

const TOKEN: &str = "0123456789abcdef-secret";
const SOCKET: &str = "velomotion-sim.daemon.sock";
/// Far below every limit that ends a wait for a free connection.
const SOON: Duration = Duration::from_secs(3);

fn guarded(write: Duration) -> Rig {
    Rig::with(&format!("token = '{TOKEN}'"), |options| {
        options.waits.write = write;
        options.waits.headers = Duration::from_secs(600);
    })
}

/// A client that sends requests as long as the daemon accepts them and never reads.
struct NonReadingClient(TcpStream);

impl NonReadingClient {
    fn new(address: SocketAddr, path: &str) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_nonblocking(true).unwrap();
        let mut client = Self(stream);
        // Sends until the buffers are full of requests; the answers exceed the buffers of the other
        // direction.
        while client.request(path) == Some(true) {}
        client
    }

    /// Whether the socket accepted the request; `None` after the daemon closed it.
    fn request(&mut self, path: &str) -> Option<bool> {
        let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n").repeat(100);
        match self.0.write(request.as_bytes()) {
            Ok(_) => Some(true),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Some(false),
            Err(_) => None,
        }
    }
}

/// Whether the daemon has closed the stream.
fn closed(stream: &mut (impl Read + ?Sized)) -> bool {
    match stream.read(&mut [0; 64]) {
        Ok(read) => read == 0,
        Err(error) => error.kind() != ErrorKind::WouldBlock,
    }
}

fn status(rig: &Rig) -> u16 {
    let token = format!("authorization: Bearer {TOKEN}\r\n");
    request(rig.address, "GET", "/api/v1/status", &token, "").status
}

#[test]
fn clients_that_never_read_do_not_block_others() {
    let rig = guarded(Duration::from_secs(600));
    let client = Client::at(rig.folder.path().join(SOCKET));
    wait("the drive", || {
        let status: Value = client.get("/api/v1/status").unwrap();
        let idle = status["activity"]["doing"] == "idle";
        (idle && status["drive"]["state"] == "connected").then_some(())
    });
    let mut clients: Vec<NonReadingClient> = (0..CONNECTIONS + 2)
        .map(|_| NonReadingClient::new(rig.address, "/page.css"))
        .collect();
    let begin = Instant::now();
    let _: Value = client.post("/api/v1/tilt/stop", &()).unwrap();
    assert!(begin.elapsed() < SOON, "{:?}", begin.elapsed());
    assert_eq!(status(&rig), 200);
    assert!(begin.elapsed() < SOON, "{:?}", begin.elapsed());
    // The latest connections are open: only the oldest were closed.
    let inside = clients
        .iter_mut()
        .filter_map(|client| client.request("/page.css"));
    assert!(inside.count() > CONNECTIONS / 2);
}

#[test]
fn clients_that_never_read_are_disconnected() {
    let rig = guarded(Duration::from_millis(200));
    let mut client = NonReadingClient::new(rig.address, "/page.css");
    wait("its end", || {
        client.request("/page.css").is_none().then_some(())
    });
    // Without a token the time limit is that of a download.
    let rig = Rig::with("", |options| {
        options.waits.download = Duration::from_millis(200);
    });
    let mut client = NonReadingClient::new(rig.address, "/api/v1/openapi.json");
    wait("its end", || {
        client
            .request("/api/v1/openapi.json")
            .is_none()
            .then_some(())
    });
}

#[test]
fn the_oldest_client_without_token_is_disconnected_first() {
    let rig = guarded(Duration::from_secs(600));
    let request_with = |stream: &mut TcpStream, headers: &str| {
        let head = format!("GET /login HTTP/1.1\r\nhost: localhost\r\n{headers}\r\n");
        let _ = stream.write_all(head.as_bytes());
        let mut first = [0; 12];
        stream.read_exact(&mut first).is_ok()
    };
    let connect = || TcpStream::connect(rig.address).unwrap();
    let mut strangers: Vec<TcpStream> = (0..CONNECTIONS).map(|_| connect()).collect();
    // The last of them is connected, so all are.
    assert!(request_with(&mut strangers[CONNECTIONS - 1], ""));
    strangers[1].set_nonblocking(true).unwrap();
    let mut late = connect();
    assert!(request_with(&mut late, ""));
    assert!(closed(&mut strangers[0]));
    assert!(
        !closed(&mut strangers[1]),
        "one connection too many was closed"
    );
    drop((strangers, late));
    let token = format!("authorization: Bearer {TOKEN}\r\n");
    let trusted: Vec<TcpStream> = (0..CONNECTIONS)
        .map(|_| {
            let mut stream = connect();
            let head = format!("GET /api/v1/tilt HTTP/1.1\r\nhost: localhost\r\n{token}\r\n");
            stream.write_all(head.as_bytes()).unwrap();
            stream.read_exact(&mut [0; 12]).unwrap();
            stream.set_nonblocking(true).unwrap();
            stream
        })
        .collect();
    // One more is closed at once; the others stay.
    assert!(closed(&mut connect()));
    for mut stream in trusted {
        // The rest of its answer, then the end.
        let end = stream.read_to_end(&mut Vec::new()).map_err(|e| e.kind());
        assert_eq!(
            end,
            Err(ErrorKind::WouldBlock),
            "a connection with the token was closed"
        );
    }
    wait("a place again", || {
        let mut stream = connect();
        request_with(&mut stream, "").then_some(())
    });
}

#[test]
fn the_unix_socket_has_its_own_slots_and_drops_the_oldest() {
    let rig = guarded(Duration::from_secs(600));
    let path = rig.folder.path().join(SOCKET);
    let mut idle: Vec<UnixStream> = (0..2 * LOCAL_CONNECTIONS)
        .map(|_| UnixStream::connect(&path).unwrap())
        .collect();
    let begin = Instant::now();
    let status: Value = Client::at(path).get("/api/v1/status").unwrap();
    assert!(begin.elapsed() < SOON && status["version"].is_string());
    assert!(closed(&mut idle[0]));
    assert_eq!(self::status(&rig), 200);
}

#[test]
fn a_waiting_command_ends_at_a_signal() {
    let folder = super::rig::place();
    // A daemon that accepts connections and sends nothing.
    let socket = UnixListener::bind(folder.path().join(SOCKET)).unwrap();
    let mut command = velomotion(folder.path(), "tilt stop").spawn().unwrap();
    // The first connection checks for a daemon; the second carries the request.
    drop(socket.accept().unwrap());
    let (mut connection, _) = socket.accept().unwrap();
    connection.read_exact(&mut [0; 4]).unwrap();
    let id = command.id().to_string();
    wait("its end", || {
        let sent = Command::new("kill").args(["-TERM", &id]).status();
        assert!(sent.is_ok());
        command.try_wait().unwrap()
    });
    assert_eq!(command.wait().unwrap().code(), Some(130));
}
