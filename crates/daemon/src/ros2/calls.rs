//! The services: both `std_srvs/srv/Trigger`, so that any ROS 2 can call them.
//!
//! `start_capture` answers when the capture has begun, `stop_capture` when the axis stands. There is a `start_capture` only where the configuration says
//! which capture: everybody whom the router lets in can call it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use cloud::messages::cdr::Cdr;
use cloud::messages::{TRIGGER, trigger_response};
use tokio::runtime::Runtime;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::Query;
use zenoh::{Session, Wait};

use super::events::LOOK;
use super::link::{self, Error, Request};
use super::rmw::{self, Entity, Quality};
use super::threads::Stop;
use crate::http::captures;
use crate::shared::Shared;
use engine::config::ros2::Ros2;

/// Calls that wait for their answers.
const WAITING: usize = 8;

/// What ROS 2's services offer (`rmw_qos_profile_services_default`).
const QUALITY: Quality = Quality {
    reliable: true,
    latched: false,
    depth: 10,
};

/// What can be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Service {
    /// Begins a capture.
    Start,
    /// Stops it.
    Stop,
}

impl Service {
    /// Those that this configuration offers.
    pub fn offered(settings: &Ros2) -> Vec<Self> {
        match settings.capture {
            Some(_) => vec![Self::Start, Self::Stop],
            None => vec![Self::Stop],
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Start => "/velomotion/start_capture",
            Self::Stop => "/velomotion/stop_capture",
        }
    }
}

/// A call that waits for its answer.
pub struct Call {
    service: Service,
    query: Query,
    request: Request,
}

/// Where calls go.
pub type Inbox = SyncSender<Call>;

/// A place for calls.
pub fn queue() -> (Inbox, Receiver<Call>) {
    sync_channel(WAITING)
}

/// Offers a service.
pub fn declare(
    session: &Session,
    settings: &Ros2,
    (id, zid): (u32, &str),
    service: Service,
    inbox: &Inbox,
) -> Result<LivelinessToken, Error> {
    let name = settings.namespace.resolve(service.name());
    let inbox = inbox.clone();
    session
        .declare_queryable(rmw::key(settings, &name, &TRIGGER))
        .complete(true)
        .callback(move |query| {
            // zenoh's own thread: it is not kept. What is no call moves nothing.
            let Some(request) = link::request(&query) else {
                return;
            };
            let call = Call {
                service,
                query,
                request,
            };
            match inbox.try_send(call) {
                Ok(()) => {}
                Err(TrySendError::Full(call) | TrySendError::Disconnected(call)) => {
                    answer(&call, false, "too many calls at once; try again");
                }
            }
        })
        .background()
        .wait()?;
    let service_id = (id, Entity::Service);
    let token = rmw::token(settings, zid, service_id, (&name, &TRIGGER), QUALITY);
    session.liveliness().declare_token(token).wait()
}

/// Until the daemon ends.
pub fn run(
    shared: &Arc<Shared>,
    settings: &Ros2,
    calls: &Receiver<Call>,
    runtime: &Runtime,
    stop: &Stop,
) {
    while !stop.is_set() {
        let Ok(call) = calls.recv_timeout(LOOK) else {
            continue;
        };
        let (done, message) = match call.service {
            Service::Start => begin(shared, settings),
            Service::Stop => (true, runtime.block_on(end(shared))),
        };
        answer(&call, done, &message);
        shared.ros2.calls.fetch_add(1, Ordering::Relaxed);
    }
}

fn begin(shared: &Shared, settings: &Ros2) -> (bool, String) {
    let Some(asked) = &settings.capture else {
        return (false, "no capture is configured".to_owned());
    };
    match captures::start(shared, asked) {
        Ok(id) => (true, id),
        Err(refusal) => (false, refusal.to_string()),
    }
}

async fn end(shared: &Shared) -> String {
    match captures::end(shared).await {
        (true, Some(scan)) => format!("stopped {scan}"),
        _ => "nothing was being captured".to_owned(),
    }
}

fn answer(call: &Call, done: bool, message: &str) {
    let mut cdr = Cdr::new();
    trigger_response(&mut cdr, done, message);
    if let Err(error) = link::answer(&call.query, call.request, cdr.bytes()) {
        tracing::debug!("ROS 2: {error}");
    }
}
