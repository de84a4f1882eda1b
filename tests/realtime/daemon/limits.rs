//! Every limit that docs/src/daemon.md states.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use daemon::Options;
use daemon::limits::{
    self, BODY_BYTES, CONNECTIONS, DOWNLOADS, HEAD_BYTES, HEADERS, LOCAL_CONNECTIONS, MAKING,
    SHARE, SUBSCRIBERS, TARGET_BYTES, Waits,
};
use serde_json::json;

use super::events::connect;
use super::rig::{Rig, raw, request, wait};

#[test]
fn the_documentation_states_the_limits() {
    let page = include_str!("../../../docs/src/daemon.md");
    let kib = |bytes: usize| format!("{} KiB", bytes >> 10);
    let seconds = |wait: Duration| format!("{} s", wait.as_secs());
    let thousands = |n: usize| format!("{},{:03}", n / 1_000, n % 1_000);
    let waits = Waits::default();
    for (what, limit) in [
        ("body of a request", kib(BODY_BYTES)),
        ("path and query", kib(TARGET_BYTES)),
        (
            "all headers",
            format!("{}, {HEADERS} of them", kib(HEAD_BYTES)),
        ),
        ("time for a request's headers", seconds(waits.headers)),
        ("time for its body", seconds(waits.body)),
        (
            "connections over TCP",
            format!(
                "{CONNECTIONS}; one more takes the place of the oldest without the token, or is closed"
            ),
        ),
        (
            "of these, from one other host without the token",
            format!("{SHARE}; one more takes the place of the oldest"),
        ),
        (
            "connections over the Unix socket",
            format!("{LOCAL_CONNECTIONS}; one more takes the place of the oldest"),
        ),
        (
            "time without reading, client at the sign-in page",
            seconds(waits.write),
        ),
        ("WebSocket clients", SUBSCRIBERS.to_string()),
        ("messages queued for a client", limits::QUEUE.to_string()),
        (
            "message of a WebSocket client",
            kib(limits::CLIENT_MESSAGE_BYTES),
        ),
        (
            "time without a message or pong of a WebSocket client",
            seconds(waits.silence),
        ),
        (
            "clouds being made for downloads",
            format!("{MAKING} at once"),
        ),
        ("downloads", format!("{DOWNLOADS} at once")),
        (
            "time without reading, any other client",
            seconds(waits.download),
        ),
        (
            "signed-in browsers",
            format!("{}, the oldest is forgotten", limits::SIGNED_IN),
        ),
        ("points of a live message", thousands(limits::FRAME_POINTS)),
        (
            "records queued for the live view",
            format!(
                "{}, more are omitted from it",
                thousands(limits::WAITING_RECORDS)
            ),
        ),
        (
            "messages stored per scan",
            format!("{}, the first ones", limits::MESSAGES),
        ),
        ("name of a capture", format!("{} bytes", limits::NAME_BYTES)),
        (
            "name of a scan",
            format!("{} characters", limits::NAME_CHARS),
        ),
        (
            "notes on a scan",
            format!("{} characters", thousands(limits::NOTES_CHARS)),
        ),
        (
            "time for which a deleted scan can be restored",
            seconds(limits::UNDO),
        ),
    ] {
        let row = format!("| {what} | {limit} |");
        assert!(page.contains(&row), "no {row}");
    }
}

/// A daemon with a finished scan whose cloud has `bytes` bytes, and a `log` that the caller makes.
fn with_a_scan(bytes: u64, waits: Waits, change: impl FnOnce(&mut Options)) -> Rig {
    Rig::with("", |options| {
        options.waits = waits;
        let scans = options.config.daemon.scans.clone().unwrap();
        let place = scans.join("made");
        std::fs::create_dir_all(&place).unwrap();
        let record = json!({
            "id": "made", "name": null, "state": "whole", "why": null, "started_s": 0.0, "simulated": true,
            "asked": null, "points": 0, "duration_s": 0.0,
        });
        std::fs::write(place.join("scan.json"), record.to_string()).unwrap();
        let cloud = std::fs::File::create(place.join("cloud.ply")).unwrap();
        cloud.set_len(bytes).unwrap();
        change(options);
    })
}

/// A client that sends a request and reads only the head of the answer.
fn open_download(rig: &Rig, path: &str) -> (TcpStream, String) {
    let mut stream = TcpStream::connect(rig.address).unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut status = [0; 12];
    stream.read_exact(&mut status).unwrap();
    (stream, String::from_utf8_lossy(&status[9..]).into_owned())
}

const CLOUD: &str = "/api/v1/scans/made/cloud";
/// More than all buffers of a connection hold.
const LARGE: u64 = 64 << 20;

#[test]
fn concurrent_downloads_are_limited() {
    let rig = with_a_scan(LARGE, Waits::default(), |_| {});
    let mut all: Vec<_> = (0..DOWNLOADS).map(|_| open_download(&rig, CLOUD)).collect();
    assert!(all.iter().all(|(_, status)| status == "200"));
    let refused = rig.get(CLOUD);
    assert_eq!(refused.refused(429, "one more")["kind"], "limit");
    // Other requests are answered.
    assert_eq!(rig.get("/api/v1/scans").status, 200);
    drop(all.pop());
    wait("a free place", || {
        (open_download(&rig, CLOUD).1 == "200").then_some(())
    });
}

#[test]
fn an_unread_download_is_closed() {
    let waits = Waits {
        download: Duration::from_secs(1),
        ..Waits::default()
    };
    let rig = with_a_scan(LARGE, waits, |_| {});
    let mut all: Vec<_> = (0..DOWNLOADS)
        .map(|_| open_download(&rig, CLOUD).0)
        .collect();
    // A download slot is free again, and the dropped client finds less than was announced.
    wait("a free place", || {
        (open_download(&rig, CLOUD).1 == "200").then_some(())
    });
    let ended_early = all.iter_mut().any(|stalled| {
        let mut read = Vec::new();
        let _ = stalled.read_to_end(&mut read);
        (read.len() as u64) < LARGE
    });
    assert!(ended_early, "no download ended early");
    // A client that reads slowly gets everything.
    let (mut slow, _) = open_download(&rig, CLOUD);
    let (mut taken, mut piece) = (0_u64, vec![0; 4 << 20]);
    for _ in 0..8 {
        std::thread::sleep(Duration::from_millis(50));
        slow.read_exact(&mut piece).unwrap();
        taken += piece.len() as u64;
    }
    taken += std::io::copy(&mut slow, &mut std::io::sink()).unwrap();
    assert!(taken > LARGE, "{taken}");
}

#[test]
fn concurrent_cloud_builds_are_limited() {
    // Clouds wait for the answer of a disk.
    let disk = Arc::new(Mutex::new(()));
    let slow = Arc::clone(&disk);
    let rig = with_a_scan(1, Waits::default(), |options| {
        options.free_bytes = Arc::new(move |path| {
            drop(slow.lock().unwrap());
            io::files::free_bytes(path)
        });
    });
    let stalled = disk.lock().unwrap();
    let path = format!("{CLOUD}?format=pcd");
    let address = rig.address;
    let waiting: Vec<_> = (0..MAKING)
        .map(|_| {
            let path = path.clone();
            std::thread::spawn(move || request(address, "GET", &path, "", ""))
        })
        .collect();
    let refused = wait("a third that is refused", || {
        let mut stream = TcpStream::connect(rig.address).unwrap();
        let request =
            format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_millis(200)))
            .unwrap();
        let mut answer = String::new();
        // A request that came before the others is being made and never answered; it ends with its
        // client.
        stream.read_to_string(&mut answer).ok().map(|_| answer)
    });
    assert!(refused.starts_with("HTTP/1.1 429"), "{refused}");
    assert!(refused.contains("clouds being made"), "{refused}");
    // An existing cloud is not made again.
    assert_eq!(rig.get(CLOUD).status, 200);
    drop(stalled);
    for one in waiting {
        let answer = one.join().unwrap();
        assert!([404, 429].contains(&answer.status), "{}", answer.text());
    }
}

#[test]
fn oversized_requests_are_refused() {
    let rig = Rig::new();
    let json = "content-type: application/json\r\n";
    let body = " ".repeat(BODY_BYTES + 1);
    request(rig.address, "POST", "/api/v1/captures", json, &body).refused(413, "body");
    let fits = " ".repeat(BODY_BYTES);
    request(rig.address, "POST", "/api/v1/captures", json, &fits).refused(400, "body that fits");
    let path = format!("/api/v1/status?{}", "x".repeat(TARGET_BYTES));
    rig.get(&path).refused(414, "path");
    let header = format!("x: {}\r\n", "y".repeat(HEAD_BYTES));
    request(rig.address, "GET", "/api/v1/status", &header, "").refused(431, "headers");
    // So many that they are not read.
    let header = format!("x: {}\r\n", "y".repeat(3 * HEAD_BYTES));
    assert_eq!(
        request(rig.address, "GET", "/api/v1/status", &header, "").status,
        431
    );
    let many = "a: b\r\n".repeat(HEADERS + 1);
    request(rig.address, "GET", "/api/v1/status", &many, "").refused(431, "headers");
    // Bytes that are not HTTP, and a body whose announced length exceeds the limit.
    let answer = raw(rig.address, b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n");
    assert!(
        (400..500).contains(&answer.status) || answer.status == 0,
        "{answer:?}"
    );
    let claim = b"POST /api/v1/captures HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99999999999\r\n\r\n";
    assert_eq!(raw(rig.address, claim).status, 413);
}

#[test]
fn slow_clients_are_disconnected() {
    let rig = Rig::with("", |options| {
        options.waits.headers = Duration::from_millis(150);
        options.waits.body = Duration::from_millis(150);
    });
    // No bytes at all, and half a head.
    for partial in [&b""[..], b"GET /api/v1/status HTTP/1.1\r\nhost: loc"] {
        let answer = raw(rig.address, partial);
        assert!(answer.status == 408 || answer.body.is_empty(), "{answer:?}");
    }
    let half = b"POST /api/v1/captures HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\ncontent-type: application/json\r\ncontent-length: 100\r\n\r\n{";
    raw(rig.address, half).refused(408, "half a body");
}

#[test]
fn websockets_are_limited() {
    let rig = Rig::new();
    let all: Vec<_> = (0..SUBSCRIBERS)
        .map(|_| connect(rig.address, "").unwrap())
        .collect();
    let refused = connect(rig.address, "").unwrap_err();
    assert!(refused.contains("429"), "{refused}");
    drop(all);
    wait("a free place", || connect(rig.address, "").ok());
}

#[test]
fn a_client_that_sends_too_much_is_disconnected() {
    let rig = Rig::new();
    let mut socket = connect(rig.address, "").unwrap();
    let long = "x".repeat(daemon::limits::CLIENT_MESSAGE_BYTES + 1);
    socket.send(tungstenite::Message::text(long)).unwrap();
    // Data in flight, then the end.
    while socket.read().is_ok() {}
    wait("its place", || {
        (rig.daemon().state().events().clients() == 0).then_some(())
    });
}

#[test]
fn a_client_that_does_not_answer_pings_is_disconnected() {
    let rig = Rig::with("", |options| {
        options.waits.ping = Duration::from_millis(20);
        options.waits.silence = Duration::from_millis(200);
    });
    let silent = connect(rig.address, "?points=false").unwrap();
    wait("its place", || {
        (rig.daemon().state().events().clients() == 0).then_some(())
    });
    drop(silent);
}
