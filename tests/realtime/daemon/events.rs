//! Live events: every subscriber gets every event, and slow ones are disconnected.

use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use engine::service::events::MessageLevel;
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use super::rig::{Rig, wait};

/// Opens a WebSocket with this query.
pub fn connect(address: SocketAddr, query: &str) -> Result<WebSocket<TcpStream>, String> {
    let stream = TcpStream::connect(address).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let url = format!("ws://{address}/api/v1/events{query}");
    tungstenite::client(url, stream)
        .map(|(socket, _)| socket)
        .map_err(|error| error.to_string())
}

/// What one client received until the end of scan `id`.
#[derive(Debug, Default, PartialEq)]
struct ReceivedFrame {
    frames: Vec<u32>,
    points: u64,
    motions: usize,
    states: Vec<String>,
    angles_fall: bool,
}

fn listen(mut socket: WebSocket<TcpStream>) -> ReceivedFrame {
    let mut received = ReceivedFrame::default();
    let mut angles = Vec::new();
    loop {
        match socket.read().unwrap() {
            Message::Binary(bytes) => {
                let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
                let count = u32_at(4) as usize;
                assert_eq!(&bytes[..4], b"VMP1");
                assert_eq!(bytes.len(), 32 + 22 * count);
                assert_eq!(u32_at(20), 0, "the live view omitted records");
                received.frames.push(u32_at(16));
                received.points += count as u64;
            }
            Message::Text(text) => {
                let event: Value = serde_json::from_str(&text).unwrap();
                match event["type"].as_str().unwrap() {
                    "motion" => {
                        received.motions += 1;
                        angles.push(event["angle_deg"].as_f64().unwrap());
                    }
                    "scan" => {
                        let state = event["scan"]["state"].as_str().unwrap().to_owned();
                        let over = ["whole", "partial", "failed"].contains(&state.as_str());
                        received.states.push(state);
                        if over {
                            received.angles_fall = angles.last() < angles.first();
                            return received;
                        }
                    }
                    "status" => assert!(event["status"]["activity"]["doing"].is_string()),
                    other => assert_eq!(other, "message"),
                }
            }
            _ => {}
        }
    }
}

#[test]
fn eight_clients_receive_the_same_and_the_capture_loses_nothing() {
    let rig = Rig::new();
    rig.ready();
    let clients: Vec<_> = (0..8)
        .map(|_| {
            let socket = connect(rig.address, "").unwrap();
            std::thread::spawn(move || listen(socket))
        })
        .collect();
    let thinned = connect(rig.address, "?thin=10").unwrap();
    let thinned = std::thread::spawn(move || listen(thinned));
    wait("all nine", || {
        (rig.daemon().state().events().clients() == 9).then_some(())
    });
    let scan = rig.scan(&json!({"speed_deg_s": 56.25}));
    let received: Vec<ReceivedFrame> = clients.into_iter().map(|c| c.join().unwrap()).collect();
    let thinned = thinned.join().unwrap();
    assert_eq!(scan["state"], "whole", "{scan}");
    assert_eq!(scan["lost_records"], 0);
    assert_eq!(scan["reception"]["dropped_by_kernel"], 0);
    let points = scan["points"].as_u64().unwrap();
    for one in &received {
        assert_eq!(one.states, ["recording", "making", "whole"]);
        assert!(one.motions > 3 && one.angles_fall, "{one:?}");
        let numbers: Vec<u32> = (0..one.frames.len() as u32).collect();
        assert_eq!(one.frames, numbers, "frames in order, none missing");
        assert_eq!(one.points, received[0].points);
        assert!(
            one.points.abs_diff(points) < points / 50,
            "{} of {points}",
            one.points
        );
    }
    assert_eq!(thinned.frames, received[0].frames);
    assert!((received[0].points / 10..received[0].points / 9).contains(&thinned.points));
    assert_eq!(rig.status()["clients"]["dropped"], 0);
}

#[test]
fn clients_that_stop_reading_are_disconnected() {
    let rig = Rig::new();
    let mut idle = connect(rig.address, "").unwrap();
    let events = rig.daemon().state().events();
    wait("it is there", || (events.clients() == 1).then_some(()));
    // More than the sockets' buffers hold. The sender never waits: the daemon notices the lag while
    // it sends.
    let long = "x".repeat(100_000);
    let mut reported = 0;
    wait("the client is disconnected", || {
        for _ in 0..100 {
            events.message(MessageLevel::Info, long.clone(), None);
            reported += 1;
        }
        (events.disconnected() == 1).then_some(())
    });
    wait("its place is free", || {
        (events.clients() == 0).then_some(())
    });
    // The client receives the end once it reads again.
    let mut read = 0;
    while idle.read().is_ok() {
        read += 1;
    }
    assert!(read < reported, "{read} of {reported}");
    assert_eq!(rig.status()["clients"]["dropped"], 1);
    // Other clients are served.
    assert!(connect(rig.address, "").unwrap().read().unwrap().is_text());
}
