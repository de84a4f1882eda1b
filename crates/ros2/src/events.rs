//! Events as messages: live clouds, the joint and its transform, diagnostics.

use std::sync::atomic::Ordering;

use cloud::messages::cdr::Cdr;
use cloud::messages::{
    CloudMessage, Frames, Time, Topic, diagnostic_array, joint_state, tf_message,
};
use cloud::{Diagnostic, DiagnosticLevel, Fields};
use units::{Degrees, Host, Stamp};

use engine::failure::Failure;
use engine::service::events::{Event, PointsRequest, RecvError};
use engine::service::live_preview::PreviewFrame;
use engine::service::status::{AxisTask, DeviceHealth, ServiceStatus};
use tokio::runtime::Runtime;

use crate::bridge::{STOP_POLL, report_connection};
use crate::link::{Error, RouterLink};
use crate::{Context, Counts, rmw};

/// Makes messages of events.
struct Publisher<'a> {
    context: &'a Context,
    link: &'a RouterLink,
    node: String,
    frames: Frames,
    cloud: CloudMessage,
    cdr: Cdr,
    /// Time of the last angle sent.
    last_angle: Option<Stamp<Host>>,
}

/// Publishes events until the bridge ends.
pub(crate) fn run(context: &Context, link: &RouterLink, runtime: &Runtime) -> Result<(), Error> {
    let settings = &context.settings;
    let mut publisher = Publisher {
        context,
        link,
        node: settings.resolve("/").trim_matches('/').to_owned(),
        frames: Frames::with_prefix(&settings.frame_prefix),
        cloud: CloudMessage::new(Fields::NONE),
        cdr: Cdr::new(),
        last_angle: None,
    };
    if !publisher.node.is_empty() {
        publisher.node.push('/');
    }
    publisher.node.push_str(rmw::NODE);
    publisher.send_mount()?;
    let events = context.devices().events();
    let mut subscription = events.subscribe();
    let request = PointsRequest::new(events, false);
    link.follow(Topic::LivePoints, move |watched| request.set(watched))?;
    while !context.stop.is_set() {
        let next = async { tokio::time::timeout(STOP_POLL, subscription.next()).await };
        let event = match runtime.block_on(next) {
            Ok(Ok(event)) => event,
            Ok(Err(RecvError::Lagged(missed))) => {
                context.counts.missed.fetch_add(missed, Ordering::Relaxed);
                continue;
            }
            Ok(Err(RecvError::Closed)) => return Ok(()),
            Err(_elapsed) => continue,
        };
        let sent = match &*event {
            Event::Points(frame) => publisher.send_points(frame),
            Event::Motion { angle_deg, at, .. } => publisher.send_angle(*at, Degrees(*angle_deg)),
            Event::Status { status } => {
                let sent = publisher.send_status(status);
                report_connection(context, link);
                sent
            }
            Event::Scan { .. } | Event::Message { .. } => Ok(()),
        };
        if let Err(error) = sent {
            tracing::debug!("ROS 2: {error}");
        }
    }
    Ok(())
}

impl Publisher<'_> {
    /// Sends the mount of the lidar on the axis, and the frame of its packets.
    fn send_mount(&mut self) -> Result<(), Error> {
        let mount = self.context.devices().config().mount.pose().mount();
        let stamp = Time::of(io::clock::now())?;
        let mut fixed = self.frames.fixed(Some(mount));
        fixed.push(self.frames.of_packets());
        tf_message(&mut self.cdr, stamp, &fixed);
        self.link.send(Topic::StaticTransforms, self.cdr.bytes())?;
        Ok(())
    }

    fn send_points(&mut self, frame: &PreviewFrame) -> Result<(), Error> {
        let name = self.frames.of_clouds();
        self.cloud
            .push(&frame.points, 0..frame.points.len(), name)?;
        if self.cloud.points() > 0 {
            self.link.send(Topic::LivePoints, self.cloud.finish())?;
        }
        Ok(())
    }

    /// Sends the angle at a time. Each time is sent once, as transform buffers expect.
    fn send_angle(&mut self, at: Stamp<Host>, angle: Degrees) -> Result<(), Error> {
        if self.last_angle.is_some_and(|last| at <= last) {
            return Ok(());
        }
        let stamp = Time::of(at)?;
        joint_state(&mut self.cdr, stamp, angle);
        self.link.send(Topic::JointStates, self.cdr.bytes())?;
        tf_message(&mut self.cdr, stamp, &[self.frames.tilted(angle)]);
        self.link.send(Topic::Transforms, self.cdr.bytes())?;
        self.last_angle = Some(at);
        Ok(())
    }

    fn send_status(&mut self, status: &ServiceStatus) -> Result<(), Error> {
        let now = io::clock::now();
        // The last angle holds while the axis is at rest; samples give it during motion.
        if let (AxisTask::Idle, Some(angle)) = (status.activity.doing, status.drive.angle_deg) {
            self.send_angle(now, Degrees(angle))?;
        }
        let checks = checks(&self.node, status, &self.context.counts);
        diagnostic_array(&mut self.cdr, Time::of(now)?, &status.device, &checks);
        self.link.send(Topic::Diagnostics, self.cdr.bytes())?;
        Ok(())
    }
}

fn device(
    name: String,
    (state, problem): (DeviceHealth, &Option<Failure>),
    values: Vec<(String, String)>,
) -> Diagnostic {
    let (level, usual) = match state {
        DeviceHealth::Connected => (DiagnosticLevel::Ok, "connected"),
        DeviceHealth::Absent => (DiagnosticLevel::Error, "absent"),
        DeviceHealth::Fault => (DiagnosticLevel::Error, "fault"),
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

/// The status as diagnostics.
fn checks(node: &str, status: &ServiceStatus, counts: &Counts) -> Vec<Diagnostic> {
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
    let counters = counts.counters();
    let missed = counts.missed.load(Ordering::Relaxed);
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
