//! What happens, over a WebSocket: JSON as text, live points as binary. Who does not read is disconnected, not waited for.

use std::sync::Arc;
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;

use super::Api;
use super::refusal::Refusal;
use crate::hub::{Event, Subscription, Told};
use crate::limits::CLIENT_MESSAGE_BYTES;

/// Most of every so many points that can be left out.
const THINNEST: usize = 1_000;
/// RFC 6455, 7.4.1: going away, policy violation.
const GOING_AWAY: u16 = 1001;
const POLICY: u16 = 1008;

/// What a client wants to be told.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wanted {
    points: bool,
    thin: usize,
}

impl Default for Wanted {
    fn default() -> Self {
        Self {
            points: true,
            thin: 1,
        }
    }
}

/// `GET /events`.
pub async fn events(
    State(api): State<Arc<Api>>,
    query: Result<Query<Wanted>, QueryRejection>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Refusal> {
    let Query(wanted) = query?;
    if !(1..=THINNEST).contains(&wanted.thin) {
        return Err(Refusal::usage(format!(
            "thin: expected 1 to {THINNEST}, got {}",
            wanted.thin
        )));
    }
    let upgrade = upgrade.map_err(|rejection| {
        Refusal::new(
            StatusCode::BAD_REQUEST,
            "usage",
            rejection.body_text(),
            "this path is for WebSockets",
        )
    })?;
    let too_many = || Refusal::too_many("WebSocket clients");
    let permit = Arc::clone(&api.sockets).try_acquire_owned();
    let permit = permit.map_err(|_| too_many())?;
    let subscription = api.shared.hub.subscribe(wanted.points);
    let subscription = subscription.ok_or_else(too_many)?;
    let upgrade = upgrade
        .max_message_size(CLIENT_MESSAGE_BYTES)
        .max_frame_size(CLIENT_MESSAGE_BYTES);
    Ok(upgrade.on_upgrade(move |socket| async move {
        serve(&api, socket, subscription, wanted).await;
        drop(permit);
    }))
}

/// How a client was lost.
enum Lost {
    /// It went away, or the network did.
    Gone,
    /// It did not read.
    Behind,
    /// The daemon ends.
    Ending,
}

async fn serve(api: &Api, mut socket: WebSocket, mut subscription: Subscription, wanted: Wanted) {
    let behind = subscription.left_behind();
    let mut closing = api.closing.clone();
    let lost = tokio::select! {
        lost = talk(api, &mut socket, &mut subscription, wanted) => lost,
        () = behind.notified() => Lost::Behind,
        _ = closing.wait_for(|closing| *closing) => Lost::Ending,
    };
    drop(subscription);
    let (code, reason) = match lost {
        Lost::Gone => return,
        Lost::Behind => (POLICY, "too slow"),
        Lost::Ending => (GOING_AWAY, "the daemon ends"),
    };
    let close = Message::Close(Some(CloseFrame {
        code,
        reason: reason.into(),
    }));
    // Who does not read does not read this either.
    let _ = tokio::time::timeout(std::time::Duration::from_millis(200), socket.send(close)).await;
}

async fn talk(
    api: &Api,
    socket: &mut WebSocket,
    subscription: &mut Subscription,
    wanted: Wanted,
) -> Lost {
    let status = Box::new(api.shared.status());
    let first = Told::from(Event::Status { status });
    if socket.send(Message::Text(first.json())).await.is_err() {
        return Lost::Gone;
    }
    let mut ping = tokio::time::interval(api.waits.ping);
    let mut heard = Instant::now();
    loop {
        tokio::select! {
            told = subscription.next() => {
                let Some(told) = told else { return Lost::Behind };
                if socket.send(message(&told, wanted)).await.is_err() {
                    return Lost::Gone;
                }
            }
            said = socket.recv() => match said {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Lost::Gone,
                // Nothing that a client says means anything here, but that it is there.
                Some(Ok(_)) => heard = Instant::now(),
            },
            _ = ping.tick() => {
                if heard.elapsed() > api.waits.silence
                    || socket.send(Message::Ping(Bytes::new())).await.is_err()
                {
                    return Lost::Gone;
                }
            }
        }
    }
}

fn message(told: &Told, wanted: Wanted) -> Message {
    match told.points(wanted.thin) {
        Some(bytes) => Message::Binary(bytes),
        None => Message::Text(told.json()),
    }
}
