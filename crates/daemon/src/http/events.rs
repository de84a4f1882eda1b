//! Events over a WebSocket: JSON as text, points as binary. Slow clients are disconnected.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use engine::service::events::{Event, PointsRequest, RecvError, Subscription};
use serde::Deserialize;
use utoipa::IntoParams;

use engine::failure::Kind;

use super::api::Api;
use super::openapi::Limit;
use super::refusal::Refusal;
use crate::limits::CLIENT_MESSAGE_BYTES;

/// Highest thinning of points: one in this many is sent.
const MAX_THIN: usize = 1_000;
/// RFC 6455, 7.4.1: going away, policy violation.
const GOING_AWAY: u16 = 1001;
const POLICY: u16 = 1008;
/// Between two checks whether a client that takes nothing has missed events.
const LAG_POLL: Duration = Duration::from_millis(50);
/// Wait for a close frame to be sent.
const CLOSE_WAIT: Duration = Duration::from_millis(200);

/// Query of `GET /events`.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[serde(default, deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct EventsQuery {
    /// Whether points are sent, too.
    #[param(default = true)]
    points: bool,
    /// One point in this many is sent.
    #[param(default = 1, minimum = 1, maximum = 1000)]
    thin: usize,
}

impl Default for EventsQuery {
    fn default() -> Self {
        Self {
            points: true,
            thin: 1,
        }
    }
}

/// Events over a WebSocket.
///
/// Text messages are objects of the type `Event`; the book's page on the daemon describes the
/// binary ones, which are points.
#[utoipa::path(get, path = "/api/v1/events", tag = "events", params(EventsQuery), responses(
    (status = 101, description = "The connection becomes a WebSocket", body = Event),
    (status = 429, response = Limit),
))]
pub async fn events(
    State(api): State<Arc<Api>>,
    query: Result<Query<EventsQuery>, QueryRejection>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Refusal> {
    let Query(query) = query?;
    if !(1..=MAX_THIN).contains(&query.thin) {
        return Err(Refusal::usage(format!(
            "thin: expected 1 to {MAX_THIN}, got {}",
            query.thin
        )));
    }
    let upgrade = upgrade.map_err(|rejection| {
        Refusal::new(
            StatusCode::BAD_REQUEST,
            Kind::Usage,
            rejection.body_text(),
            "this path is for WebSockets",
        )
    })?;
    let subscription = api.state.events().subscribe_client();
    let subscription = subscription.ok_or_else(|| Refusal::too_many("WebSocket clients"))?;
    let points = PointsRequest::new(api.state.events(), query.points);
    let upgrade = upgrade
        .max_message_size(CLIENT_MESSAGE_BYTES)
        .max_frame_size(CLIENT_MESSAGE_BYTES);
    Ok(upgrade.on_upgrade(move |socket| async move {
        serve(&api, socket, subscription, query).await;
        drop(points);
    }))
}

/// Reason for the disconnection of a client.
enum Disconnect {
    /// The client or the network closed the connection.
    Gone,
    /// It did not read.
    Lagged,
    /// The daemon is ending.
    Ending,
}

async fn serve(
    api: &Api,
    mut socket: WebSocket,
    mut subscription: Subscription,
    query: EventsQuery,
) {
    let mut closing = api.closing.clone();
    let reason = tokio::select! {
        reason = forward(api, &mut socket, &mut subscription, query) => reason,
        _ = closing.wait_for(|closing| *closing) => Disconnect::Ending,
    };
    drop(subscription);
    let (code, text) = match reason {
        Disconnect::Gone => return,
        Disconnect::Lagged => {
            api.state.events().count_disconnected();
            (POLICY, "too slow")
        }
        Disconnect::Ending => (GOING_AWAY, "the daemon ends"),
    };
    let close = Message::Close(Some(CloseFrame {
        code,
        reason: text.into(),
    }));
    // A client that does not read will not read this either.
    let _ = tokio::time::timeout(CLOSE_WAIT, socket.send(close)).await;
}

async fn forward(
    api: &Api,
    socket: &mut WebSocket,
    subscription: &mut Subscription,
    query: EventsQuery,
) -> Disconnect {
    let status = Box::new(api.state.service.status());
    let first = Message::Text(json(&Event::Status { status }));
    if let Err(reason) = send(socket, first, subscription).await {
        return reason;
    }
    let mut ping = tokio::time::interval(api.waits.ping);
    let mut last_message = Instant::now();
    loop {
        let message = tokio::select! {
            event = subscription.next() => match event.as_deref() {
                Ok(Event::Points(_)) if !query.points => continue,
                Ok(Event::Points(frame)) => Message::Binary(frame.bytes(query.thin)),
                Ok(event) => Message::Text(json(event)),
                Err(RecvError::Lagged(_)) => return Disconnect::Lagged,
                Err(RecvError::Closed) => return Disconnect::Ending,
            },
            received = socket.recv() => match received {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Disconnect::Gone,
                // Messages of a client only show that it is alive.
                Some(Ok(_)) => {
                    last_message = Instant::now();
                    continue;
                }
            },
            _ = ping.tick() => {
                if last_message.elapsed() > api.waits.silence {
                    return Disconnect::Gone;
                }
                Message::Ping(Bytes::new())
            }
        };
        if let Err(reason) = send(socket, message, subscription).await {
            return reason;
        }
    }
}

/// Sends a message, unless the client takes nothing while events are lost.
async fn send(
    socket: &mut WebSocket,
    message: Message,
    subscription: &Subscription,
) -> Result<(), Disconnect> {
    let mut sending = std::pin::pin!(socket.send(message));
    loop {
        tokio::select! {
            sent = sending.as_mut() => return sent.map_err(|_| Disconnect::Gone),
            () = tokio::time::sleep(LAG_POLL) => {
                if subscription.has_lagged() {
                    return Err(Disconnect::Lagged);
                }
            }
        }
    }
}

fn json(event: &Event) -> Utf8Bytes {
    serde_json::to_string(event).unwrap_or_default().into()
}
