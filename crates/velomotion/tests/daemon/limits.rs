//! Every limit that docs/src/daemon.md states.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use velomotion::daemon::limits::{
    BODY_BYTES, CONNECTIONS, HEAD_BYTES, HEADERS, SUBSCRIBERS, TARGET_BYTES, Waits,
};

use crate::events::connect;
use crate::rig::{Rig, raw, request, wait};

#[test]
fn the_book_states_the_limits() {
    let page = include_str!("../../../../docs/src/daemon.md");
    let kib = |bytes: usize| format!("{} KiB", bytes >> 10);
    for (what, limit) in [
        ("body of a request", kib(BODY_BYTES)),
        ("path and query", kib(TARGET_BYTES)),
        (
            "all headers",
            format!("{}, {HEADERS} of them", kib(HEAD_BYTES)),
        ),
        ("connections", format!("{CONNECTIONS}, more wait")),
        ("WebSocket clients", SUBSCRIBERS.to_string()),
        (
            "a message of a client",
            kib(velomotion::daemon::limits::CLIENT_MESSAGE_BYTES),
        ),
        (
            "messages queued for a client",
            velomotion::daemon::limits::QUEUE.to_string(),
        ),
        (
            "downloads",
            format!("{} at once", velomotion::daemon::limits::DOWNLOADS),
        ),
        (
            "clouds being made for downloads",
            format!("{} at once", velomotion::daemon::limits::MAKING),
        ),
        (
            "browsers signed in",
            format!(
                "{}, the oldest is forgotten",
                velomotion::daemon::limits::SIGNED_IN
            ),
        ),
    ] {
        let row = format!("| {what} | {limit} |");
        assert!(page.contains(&row), "no {row}");
    }
    assert_eq!(Waits::default().headers, Duration::from_secs(10));
    assert_eq!(Waits::default().silence, Duration::from_secs(60));
}

#[test]
fn requests_that_are_too_large_are_refused() {
    let rig = Rig::new();
    let json = "content-type: application/json\r\n";
    let body = " ".repeat(BODY_BYTES + 1);
    request(rig.address, "POST", "/api/v1/captures", json, &body).refused(413, "body");
    let fits = " ".repeat(BODY_BYTES);
    request(rig.address, "POST", "/api/v1/captures", json, &fits).refused(400, "body that fits");
    let path = format!("/api/v1/status?{}", "x".repeat(TARGET_BYTES));
    rig.get(&path).refused(414, "path");
    let header = format!("x: {}\r\n", "y".repeat(HEAD_BYTES));
    assert_eq!(
        request(rig.address, "GET", "/api/v1/status", &header, "").status,
        431
    );
    let many = "a: b\r\n".repeat(HEADERS + 1);
    assert_eq!(
        request(rig.address, "GET", "/api/v1/status", &many, "").status,
        431
    );
    // Bytes that are no HTTP, and a body that claims to be longer than it may be.
    let answer = raw(rig.address, b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n");
    assert!(
        (400..500).contains(&answer.status) || answer.status == 0,
        "{answer:?}"
    );
    let claim = b"POST /api/v1/captures HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99999999999\r\n\r\n";
    assert_eq!(raw(rig.address, claim).status, 413);
}

#[test]
fn who_is_too_slow_is_not_waited_for() {
    let rig = Rig::with("", |options| {
        options.waits.headers = Duration::from_millis(150);
        options.waits.body = Duration::from_millis(150);
    });
    // Says nothing, and half a head.
    for begun in [&b""[..], b"GET /api/v1/status HTTP/1.1\r\nhost: loc"] {
        let answer = raw(rig.address, begun);
        assert!(answer.status == 408 || answer.body.is_empty(), "{answer:?}");
    }
    let half = b"POST /api/v1/captures HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\ncontent-type: application/json\r\ncontent-length: 100\r\n\r\n{";
    raw(rig.address, half).refused(408, "half a body");
}

#[test]
fn more_connections_wait_until_one_ends() {
    let rig = Rig::with("", |options| {
        options.waits.headers = Duration::from_secs(600);
    });
    let mut idle: Vec<TcpStream> = (0..CONNECTIONS)
        .map(|_| {
            // Answered once, and kept open.
            let mut stream = TcpStream::connect(rig.address).unwrap();
            stream
                .write_all(b"GET / HTTP/1.1\r\nhost: localhost\r\n\r\n")
                .unwrap();
            let mut first = [0; 12];
            stream.read_exact(&mut first).unwrap();
            assert_eq!(&first, b"HTTP/1.1 200");
            stream
        })
        .collect();
    let mut late = TcpStream::connect(rig.address).unwrap();
    late.write_all(b"GET / HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n")
        .unwrap();
    late.set_read_timeout(Some(Duration::from_millis(200)))
        .unwrap();
    let mut answer = [0; 12];
    assert!(
        late.read_exact(&mut answer).is_err(),
        "answered beside {CONNECTIONS} others"
    );
    drop(idle.pop());
    late.set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    late.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 200");
}

#[test]
fn there_are_no_more_websockets_than_allowed() {
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
fn a_client_that_says_too_much_is_disconnected() {
    let rig = Rig::new();
    let mut socket = connect(rig.address, "").unwrap();
    let long = "x".repeat(velomotion::daemon::limits::CLIENT_MESSAGE_BYTES + 1);
    socket.send(tungstenite::Message::text(long)).unwrap();
    // Whatever was on its way, then the end.
    while socket.read().is_ok() {}
    wait("its place", || {
        rig.daemon().shared().hub.is_empty().then_some(())
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
        rig.daemon().shared().hub.is_empty().then_some(())
    });
    drop(silent);
}
