//! Clouds of finished scans, made from their logs and sent sweep by sweep, as fast as the network
//! takes them: never all of one in memory.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use cloud::messages::{Cloud, Clouds, Frames, Topic};
use cloud::{Sink, SinkError};
use engine::failure::Failure;
use engine::output::sink_failure;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use engine::service::events::{Event, MessageLevel, RecvError};
use engine::service::scan_record::{ScanState, ScanView};
use tokio::runtime::Runtime;

use crate::Context;
use crate::bridge::STOP_POLL;
use crate::link::RouterLink;

/// The name of the output in failures.
const OUTPUT: &str = "ros2";
/// Finished scans that may wait for the network.
const QUEUE: usize = 256;

/// A queue of finished scans.
pub(crate) fn queue() -> (SyncSender<Arc<Event>>, Receiver<Arc<Event>>) {
    sync_channel(QUEUE)
}

/// Queues finished scans until the bridge ends. It has a thread of its own because clouds take
/// longer than events wait.
pub(crate) fn queue_finished(
    context: &Context,
    runtime: &Runtime,
    finished: &SyncSender<Arc<Event>>,
) {
    let mut subscription = context.devices().events().subscribe();
    while !context.stop.is_set() {
        let next = async { tokio::time::timeout(STOP_POLL, subscription.next()).await };
        match runtime.block_on(next) {
            Ok(Ok(event)) if finished_scan(&event).is_some() => {
                if let Err(TrySendError::Full(_)) = finished.try_send(event) {
                    context.counts.missed.fetch_add(1, Ordering::Relaxed);
                }
            }
            Ok(Err(RecvError::Closed)) => return,
            _ => {}
        }
    }
}

fn finished_scan(event: &Event) -> Option<&ScanView> {
    match event {
        Event::Scan {
            scan,
            deleted: false,
        } if matches!(scan.state, ScanState::Whole | ScanState::Partial) => Some(scan),
        _ => None,
    }
}

/// Sends clouds until the bridge ends.
pub(crate) fn run(context: &Context, link: &RouterLink, finished: Receiver<Arc<Event>>) {
    let mut last = String::new();
    while !context.stop.is_set() {
        let Ok(event) = finished.recv_timeout(STOP_POLL) else {
            continue;
        };
        let Some(scan) = finished_scan(&event) else {
            continue;
        };
        if scan.id == last || !link.is_watched(Topic::Points) {
            continue;
        }
        last.clone_from(&scan.id);
        if let Err(failure) = send(context, link, scan)
            && !context.stop.is_set()
        {
            let text = format!(
                "the cloud of {} was not sent to ROS 2: {}",
                scan.id, failure.message
            );
            let events = context.devices().events();
            events.message(MessageLevel::Warning, text, failure.help);
        }
    }
}

fn send(context: &Context, link: &RouterLink, scan: &ScanView) -> Result<(), Failure> {
    let source = Source::open(&context.scans.log(&scan.id), None)?;
    let request = Reconstruction::of_log(&source, scan.accuracy(), context.stop.flag())?;
    let frames = Frames::with_prefix(&context.settings.frame_prefix);
    let mut sink = Clouds::new(frames, |cloud: Cloud<'_>| {
        match link.send(Topic::Points, cloud.bytes) {
            Ok(true) => Ok(()),
            Ok(false) => Err(SinkError::Other("its subscribers went away".into())),
            Err(error) => Err(SinkError::Other(error.to_string().into())),
        }
    });
    let output = Path::new(OUTPUT);
    replay::scan(&request, &mut sink, output)?;
    sink.finish()
        .map_err(|error| sink_failure(output, &error))?;
    Ok(())
}
