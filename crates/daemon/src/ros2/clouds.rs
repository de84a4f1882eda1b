//! Clouds of scans that are over, made of their logs once more and sent sweep by sweep, as fast as the network takes them: never all of one in
//! memory.

use std::path::Path;

use cloud::messages::{Cloud, Clouds, Frames, Topic};
use cloud::{Sink, SinkError};
use scanner::{Accuracy, TiltSource};

use super::events::LOOK;
use super::link::{Error, Link};
use super::threads::Stop;
use crate::hub::inside::Wants;
use crate::hub::{Event, Level};
use crate::scans::ScanState;
use crate::shared::Shared;
use engine::config::ros2::Ros2;
use engine::failure::Failure;
use engine::output::sink_failure;
use engine::reconstruct::replay::TimeReference;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;

/// What failures call the place that clouds go to.
const PLACE: &str = "ros2";

/// Until the daemon ends.
pub fn run(shared: &Shared, settings: &Ros2, link: &Link, stop: &Stop) {
    let missed = &shared.ros2.missed;
    let inside = shared.hub.subscribe_inside(Wants::Scans, missed);
    let mut last = String::new();
    while !stop.is_set() {
        let Ok(told) = inside.next(LOOK) else {
            continue;
        };
        let Event::Scan { scan, deleted } = &told.event else {
            continue;
        };
        let has_cloud = matches!(scan.state, ScanState::Whole | ScanState::Partial);
        if *deleted || !has_cloud || scan.id == last || !link.is_watched(Topic::Points) {
            continue;
        }
        last.clone_from(&scan.id);
        if let Err(failure) = send(shared, settings, link, stop, &scan.id)
            && !stop.is_set()
        {
            let text = format!(
                "the cloud of {} was not sent to ROS 2: {}",
                scan.id, failure.message
            );
            shared.hub.say(Level::Warning, text, failure.help);
        }
    }
}

fn send(
    shared: &Shared,
    settings: &Ros2,
    link: &Link,
    stop: &Stop,
    id: &str,
) -> Result<(), Failure> {
    let asked = shared
        .scans
        .record(id)
        .and_then(|record| record.asked.clone());
    let source = Source::open(&shared.log(id), None)?;
    let request = Reconstruction {
        recording: &source,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: TimeReference::Host,
        accuracy: asked
            .and_then(|asked| asked.accuracy().ok())
            .unwrap_or(Accuracy::Best),
        pace: None,
        truth: None,
        lost_records: 0,
        interrupt: stop.flag(),
    };
    let frames = Frames::with_prefix(&settings.frame_prefix.0);
    let mut sink = Clouds::new(frames, |cloud: Cloud<'_>| {
        match link.send(Topic::Points, cloud.bytes) {
            Ok(true) => Ok(()),
            Ok(false) => Err(SinkError::Other("its subscribers went away".into())),
            Err(error) => Err(SinkError::Other(said(&error).into())),
        }
    });
    let place = Path::new(PLACE);
    replay::scan(&request, &mut sink, place)?;
    sink.finish().map_err(|error| sink_failure(place, &error))?;
    Ok(())
}

fn said(error: &Error) -> String {
    error.to_string()
}
