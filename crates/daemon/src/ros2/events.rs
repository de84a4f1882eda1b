//! What happens, as messages: live clouds, the joint and its transform, diagnostics.

use std::time::Duration;

use cloud::messages::cdr::Cdr;
use cloud::messages::{
    CloudMessage, Frames, Time, Topic, diagnostic_array, joint_state, tf_message,
};
use cloud::{Diagnostic, DiagnosticLevel, Fields};
use units::{Degrees, Host, Metres, Stamp};

use super::link::{Error, Link};
use super::{rmw, threads::Stop};
use crate::hub::Event;
use crate::hub::inside::Wants;
use crate::points::Frame;
use crate::shared::Shared;
use crate::view::{DeviceState, Doing, Status};
use engine::config::ros2::Ros2;
use engine::failure::Failure;

/// How often it is looked whether the daemon ends.
pub const LOOK: Duration = Duration::from_millis(100);

/// Makes messages of events.
struct Teller<'a> {
    shared: &'a Shared,
    link: &'a Link,
    node: String,
    frames: Frames,
    cloud: CloudMessage,
    cdr: Cdr,
    /// The time of the last angle that was sent.
    told: Option<Stamp<Host>>,
}

/// Until the daemon ends.
pub fn run(shared: &Shared, settings: &Ros2, link: &Link, stop: &Stop) -> Result<(), Error> {
    let mut teller = Teller {
        shared,
        link,
        node: settings.namespace.resolve("/").trim_matches('/').to_owned(),
        frames: Frames::with_prefix(&settings.frame_prefix.0),
        cloud: CloudMessage::new(Fields::NONE),
        cdr: Cdr::new(),
        told: None,
    };
    if !teller.node.is_empty() {
        teller.node.push('/');
    }
    teller.node.push_str(rmw::NODE);
    teller.tell_mount()?;
    let missed = &shared.ros2.missed;
    let inside = shared.hub.subscribe_inside(Wants::Events, missed);
    link.follow(&inside.wish())?;
    while !stop.is_set() {
        let Ok(told) = inside.next(LOOK) else {
            continue;
        };
        let sent = match &told.event {
            Event::Points(frame) => teller.tell_frame(frame),
            Event::Motion { angle_deg, at, .. } => teller.tell_angle(*at, Degrees(*angle_deg)),
            Event::Status { status } => {
                let status_sent = teller.tell_status(status);
                super::threads::tell_connection(shared, settings, link);
                status_sent
            }
            Event::Scan { .. } | Event::Message { .. } => Ok(()),
        };
        if let Err(error) = sent {
            tracing::debug!("ROS 2: {error}");
        }
    }
    Ok(())
}

impl Teller<'_> {
    /// How lidar and axis sit on each other.
    fn tell_mount(&mut self) -> Result<(), Error> {
        let mount = Metres(self.shared.config.mount.d_m);
        let stamp = Time::of(io::clock::now())?;
        tf_message(&mut self.cdr, stamp, &self.frames.fixed(Some(mount)));
        self.link.send(Topic::StaticTransforms, self.cdr.bytes())?;
        Ok(())
    }

    fn tell_frame(&mut self, frame: &Frame) -> Result<(), Error> {
        self.cloud.clear();
        let name = self.frames.of_clouds(true);
        self.cloud
            .push(&frame.points, 0..frame.points.len(), name)?;
        if self.cloud.points() > 0 {
            let message = self.cloud.message();
            self.link.send(Topic::LivePoints, message.bytes())?;
        }
        Ok(())
    }

    /// The axis was there then. A time is said once, as receivers want it.
    fn tell_angle(&mut self, at: Stamp<Host>, angle: Degrees) -> Result<(), Error> {
        if self.told.is_some_and(|told| at <= told) {
            return Ok(());
        }
        let stamp = Time::of(at)?;
        joint_state(&mut self.cdr, stamp, angle);
        self.link.send(Topic::JointStates, self.cdr.bytes())?;
        tf_message(&mut self.cdr, stamp, &[self.frames.tilted(angle)]);
        self.link.send(Topic::Transforms, self.cdr.bytes())?;
        self.told = Some(at);
        Ok(())
    }

    fn tell_status(&mut self, status: &Status) -> Result<(), Error> {
        let now = io::clock::now();
        // While it stands it is where it was; while it moves, samples say where.
        if let (Doing::Idle, Some(angle)) = (status.activity.doing, status.drive.angle_deg) {
            self.tell_angle(now, Degrees(angle))?;
        }
        let checks = checks(&self.node, status, self.shared);
        diagnostic_array(&mut self.cdr, Time::of(now)?, &status.device, &checks);
        self.link.send(Topic::Diagnostics, self.cdr.bytes())?;
        Ok(())
    }
}

fn device(
    name: String,
    (state, problem): (DeviceState, &Option<Failure>),
    values: Vec<(String, String)>,
) -> Diagnostic {
    let (level, usual) = match state {
        DeviceState::Connected => (DiagnosticLevel::Ok, "connected"),
        DeviceState::Absent => (DiagnosticLevel::Error, "absent"),
        DeviceState::Fault => (DiagnosticLevel::Error, "fault"),
    };
    let message = problem.as_ref().map(|problem| match &problem.help {
        Some(help) => format!("{} ({help})", problem.message),
        None => problem.message.clone(),
    });
    Diagnostic {
        name,
        level,
        message: message.unwrap_or_else(|| usual.to_owned()),
        values,
    }
}

fn values<const N: usize>(values: [(&str, String); N]) -> Vec<(String, String)> {
    values.map(|(key, value)| (key.to_owned(), value)).to_vec()
}

/// The status as diagnostics have it.
fn checks(node: &str, status: &Status, shared: &Shared) -> Vec<Diagnostic> {
    let (drive, lidar, disk) = (&status.drive, &status.lidar, &status.disk);
    let known = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.3}"));
    let drive = device(
        format!("{node}: drive"),
        (drive.state, &drive.problem),
        values([
            ("port", drive.port.clone().unwrap_or_default()),
            ("state", drive.cia402.clone().unwrap_or_default()),
            ("referenced", drive.referenced.to_string()),
            ("angle_deg", known(drive.angle_deg)),
            ("speed_deg_s", format!("{:.3}", drive.speed_deg_s)),
            ("faults", drive.faults.len().to_string()),
        ]),
    );
    let lidar = device(
        format!("{node}: lidar"),
        (lidar.state, &lidar.problem),
        values([
            ("model", lidar.model.unwrap_or_default().to_owned()),
            ("rpm", known(lidar.rpm)),
            ("packets_per_s", format!("{:.0}", lidar.packets_per_s)),
            ("lost_packets", lidar.lost_packets.to_string()),
            ("dropped_by_kernel", lidar.dropped_by_kernel.to_string()),
        ]),
    );
    let full = disk
        .free_bytes
        .is_some_and(|free| free < disk.reserve_bytes);
    let activity = &status.activity;
    let scans = Diagnostic {
        name: format!("{node}: scans"),
        level: if full {
            DiagnosticLevel::Warn
        } else {
            DiagnosticLevel::Ok
        },
        message: match full {
            true => "the disk is nearly full".to_owned(),
            false => format!("{:?}", activity.doing).to_lowercase(),
        },
        values: values([
            ("simulated", status.simulated.to_string()),
            ("scan", activity.scan.clone().unwrap_or_default()),
            ("scans", disk.scans.to_string()),
            (
                "disk_free_bytes",
                disk.free_bytes.map_or_else(String::new, |b| b.to_string()),
            ),
        ]),
    };
    let counters = shared.ros2.counters();
    let missed = shared
        .ros2
        .missed
        .load(std::sync::atomic::Ordering::Relaxed);
    let network = Diagnostic {
        name: format!("{node}: ros2"),
        level: if missed > 0 {
            DiagnosticLevel::Warn
        } else {
            DiagnosticLevel::Ok
        },
        message: match missed {
            0 => "every message was sent".to_owned(),
            _ => "the network took too long for some messages".to_owned(),
        },
        values: counters
            .map(|(name, _, value)| (name.to_owned(), value.to_string()))
            .to_vec(),
    };
    vec![drive, lidar, scans, network]
}
