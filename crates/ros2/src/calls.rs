//! The services, both of type `std_srvs/srv/Trigger`.
//!
//! `start_capture` answers when the capture has begun, `stop_capture` when the axis is at rest.
//! `start_capture` is offered only if a capture is configured: every client of the router can call
//! it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use cloud::messages::cdr::Cdr;
use cloud::messages::{TRIGGER, trigger_response};
use tokio::runtime::Runtime;

use engine::config::ros2::Ros2;
use engine::failure::Failure;
use engine::service::{DeviceService, StopSignal};

use crate::Context;
use crate::bridge::STOP_POLL;
use crate::link::{Call, Declarer, Error, SERVICES};

/// Calls that wait for their answers.
const WAITING: usize = 8;

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

/// A call of a service.
pub struct TriggerCall {
    service: Service,
    /// Taken when it arrives: it may wait behind others.
    stop: StopSignal,
    call: Call,
}

/// The sending end of the queue of calls.
pub type Inbox = SyncSender<TriggerCall>;

/// A queue of calls.
pub fn queue() -> (Inbox, Receiver<TriggerCall>) {
    sync_channel(WAITING)
}

/// Offers a service.
pub fn declare(
    declarer: &mut Declarer<'_>,
    service: Service,
    devices: &Arc<DeviceService>,
    inbox: &Inbox,
) -> Result<(), Error> {
    let name = declarer.settings().resolve(service.name());
    let (devices, inbox) = (Arc::clone(devices), inbox.clone());
    declarer.service(&name, &TRIGGER, SERVICES, move |call| {
        let stop = devices.stop_signal(None);
        let call = TriggerCall {
            service,
            stop,
            call,
        };
        match inbox.try_send(call) {
            Ok(()) => {}
            Err(TrySendError::Full(call) | TrySendError::Disconnected(call)) => {
                answer(&call, false, "too many calls at once; try again");
            }
        }
    })
}

/// Answers calls until the bridge ends.
pub(crate) fn run(context: &Context, calls: &Receiver<TriggerCall>, runtime: &Runtime) {
    while !context.stop.is_set() {
        let Ok(call) = calls.recv_timeout(STOP_POLL) else {
            continue;
        };
        let (done, message) = match call.service {
            Service::Start => start_capture(context, &call.stop),
            Service::Stop => (true, runtime.block_on(stop_capture(context))),
        };
        answer(&call, done, &message);
        context.counts.calls.fetch_add(1, Ordering::Relaxed);
    }
}

fn start_capture(context: &Context, stop: &StopSignal) -> (bool, String) {
    let Some(request) = context.parameters.capture() else {
        return (false, "no capture is configured".to_owned());
    };
    match context.scans.start_capture(&request, stop) {
        Ok(id) => (true, id),
        Err(failure) => (false, text_of(failure)),
    }
}

/// A failure in one line.
pub(crate) fn text_of(Failure { message, help, .. }: Failure) -> String {
    match help {
        Some(help) => format!("{message} ({help})"),
        None => message,
    }
}

async fn stop_capture(context: &Context) -> String {
    match context.devices().stop_capture().await {
        (true, Some(scan)) => format!("stopped {scan}"),
        _ => "nothing was being captured".to_owned(),
    }
}

fn answer(call: &TriggerCall, done: bool, message: &str) {
    let mut cdr = Cdr::new();
    trigger_response(&mut cdr, done, message);
    call.call.answer(cdr.bytes());
}
