//! The services, both of type `std_srvs/srv/Trigger`.
//!
//! `start_capture` answers when the capture has begun, `stop_capture` when the axis is at rest.
//! `start_capture` is offered only if a capture is configured: every client of the router can call
//! it.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use cloud::messages::cdr::Cdr;
use cloud::messages::{TRIGGER, trigger_response};
use tokio::runtime::Runtime;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::Query;
use zenoh::{Session, Wait};

use engine::config::ros2::Ros2;
use engine::failure::Failure;

use crate::Context;
use crate::bridge::STOP_POLL;
use crate::link::{self, Error, Request};
use crate::rmw::{self, Entity, QualityOfService};

/// Calls that wait for their answers.
const WAITING: usize = 8;

/// QoS of services (`rmw_qos_profile_services_default`).
const QUALITY: QualityOfService = QualityOfService {
    reliable: true,
    latched: false,
    depth: 10,
};

/// A service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Service {
    /// Begins a capture.
    Start,
    /// Stops the capture.
    Stop,
}

impl Service {
    /// The services that a configuration offers.
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

/// The sending end of the queue of calls.
pub type Inbox = SyncSender<Call>;

/// A queue of calls.
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
    let name = settings.resolve(service.name());
    let inbox = inbox.clone();
    session
        .declare_queryable(rmw::key(settings, &name, &TRIGGER))
        .complete(true)
        .callback(move |query| {
            // Runs on a thread of zenoh, which must not wait.
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

/// Answers calls until the bridge ends.
pub(crate) fn run(context: &Context, calls: &Receiver<Call>, runtime: &Runtime) {
    while !context.stop.is_set() {
        let Ok(call) = calls.recv_timeout(STOP_POLL) else {
            continue;
        };
        let (done, message) = match call.service {
            Service::Start => start_capture(context),
            Service::Stop => (true, runtime.block_on(stop_capture(context))),
        };
        answer(&call, done, &message);
        context.counts.calls.fetch_add(1, Ordering::Relaxed);
    }
}

fn start_capture(context: &Context) -> (bool, String) {
    let Some(request) = &context.settings.capture else {
        return (false, "no capture is configured".to_owned());
    };
    match context.scans.start_capture(request) {
        Ok(id) => (true, id),
        Err(Failure { message, help, .. }) => match help {
            Some(help) => (false, format!("{message} ({help})")),
            None => (false, message),
        },
    }
}

async fn stop_capture(context: &Context) -> String {
    match context.devices().stop_capture().await {
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
