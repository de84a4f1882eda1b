//! Metrics for Prometheus, collected on request.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric, text};
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::Registry;

use super::accept::quality;
use super::api::Api;
use super::refusal::Refusal;
use crate::state::DaemonState;
use engine::service::status::{AxisTask, DeviceHealth};

/// Unit of CPU times in proc(5), the same on all Linux architectures of today.
const TICKS_PER_S: f64 = 100.0;

/// Metrics for Prometheus: OpenMetrics, or the text format 0.0.4 for clients that accept only that.
#[utoipa::path(get, path = "/metrics", tag = "daemon", responses(
    (status = 200, content(
        (String = "application/openmetrics-text"),
        (String = "text/plain"),
    )),
))]
pub async fn metrics(State(api): State<Arc<Api>>, headers: HeaderMap) -> Result<Response, Refusal> {
    let mut registry = Registry::default();
    registry.register_collector(Box::new(ProcessFigures));
    let own = registry.sub_registry_with_prefix("velomotion");
    own.register_collector(Box::new(Figures(Arc::clone(&api.state))));
    let mut metrics = String::new();
    text::encode(&mut metrics, &registry)
        .map_err(|error| Refusal::defect(error.to_string(), "this is a defect of the program"))?;
    let accept = headers
        .get(header::ACCEPT)
        .and_then(|accept| accept.to_str().ok());
    let prefers_plain = |accept: &str| {
        let plain = quality(accept, &["text/plain", "text/*", "*/*"]);
        let open = quality(
            accept,
            &["application/openmetrics-text", "application/*", "*/*"],
        );
        plain > open
    };
    let content = match accept.is_some_and(prefers_plain) {
        true => {
            metrics = as_plain_text(&metrics);
            "text/plain; version=0.0.4; charset=utf-8"
        }
        false => "application/openmetrics-text; version=1.0.0; charset=utf-8",
    };
    Ok(([(header::CONTENT_TYPE, content)], metrics).into_response())
}

/// The text format 0.0.4, in which counters and information have their suffix in the metadata too.
fn as_plain_text(metrics: &str) -> String {
    let mut plain = String::new();
    let mut suffixes = std::collections::HashMap::new();
    for line in metrics.lines() {
        if let Some((name, kind)) = line
            .strip_prefix("# TYPE ")
            .and_then(|rest| rest.split_once(' '))
        {
            match kind {
                "counter" => suffixes.insert(name, ("_total", kind)),
                "info" => suffixes.insert(name, ("_info", "gauge")),
                _ => None,
            };
        }
    }
    for line in metrics.lines().filter(|line| *line != "# EOF") {
        let words: Vec<&str> = line.splitn(4, ' ').collect();
        match words[..] {
            ["#", what, name, rest] => {
                let (suffix, kind) = suffixes.get(name).copied().unwrap_or(("", rest));
                let rest = if what == "TYPE" { kind } else { rest };
                plain.push_str(&format!("# {what} {name}{suffix} {rest}\n"));
            }
            _ => {
                plain.push_str(line);
                plain.push('\n');
            }
        }
    }
    plain
}

/// Figures of the process under their customary names.
#[derive(Debug)]
struct ProcessFigures;

impl Collector for ProcessFigures {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> fmt::Result {
        // Fields of proc(5), counted after the name of the program, which may contain spaces.
        let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
        let fields: Vec<&str> = stat
            .rsplit(')')
            .next()
            .unwrap_or_default()
            .split_whitespace()
            .collect();
        let ticks = |field: usize| fields.get(field).and_then(|text| text.parse::<f64>().ok());
        if let (Some(user), Some(system)) = (ticks(11), ticks(12)) {
            let cpu_s = ConstCounter::new((user + system) / TICKS_PER_S);
            put(&mut encoder, "process_cpu_seconds", "CPU time", &cpu_s)?;
        }
        let boot = std::fs::read_to_string("/proc/stat").unwrap_or_default();
        let boot = boot.lines().find_map(|line| line.strip_prefix("btime "));
        let boot_s = boot.and_then(|text| text.trim().parse::<f64>().ok());
        if let (Some(boot_s), Some(start)) = (boot_s, ticks(19)) {
            let start_s = ConstGauge::new(boot_s + start / TICKS_PER_S);
            put(
                &mut encoder,
                "process_start_time_seconds",
                "Start of the process, Unix time",
                &start_s,
            )?;
        }
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = resident.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
        if let Some(kib) = kib {
            let bytes = ConstGauge::new(1024.0 * kib);
            put(
                &mut encoder,
                "process_resident_memory_bytes",
                "Resident memory",
                &bytes,
            )?;
        }
        if let Ok(open) = std::fs::read_dir("/proc/self/fd") {
            let open = ConstGauge::new(open.count() as f64);
            put(
                &mut encoder,
                "process_open_fds",
                "Open file descriptors",
                &open,
            )?;
        }
        Ok(())
    }
}

struct Figures(Arc<DaemonState>);

impl fmt::Debug for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Figures")
    }
}

impl Collector for Figures {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let status = self.0.service.status();
        let (drive, lidar, disk) = (&status.drive, &status.lidar, &status.disk);
        let connected = |state| f64::from(u8::from(state == DeviceHealth::Connected));
        let gauges = [
            (
                "drive_connected",
                "1 if the drive is connected and without fault",
                connected(drive.state),
            ),
            (
                "lidar_connected",
                "1 if the lidar is connected and without fault",
                connected(lidar.state),
            ),
            (
                "capturing",
                "1 while a scan is recorded",
                f64::from(u8::from(status.activity.doing == AxisTask::Capturing)),
            ),
            (
                "tilt_angle_degrees",
                "Angle of the axis, NaN while unknown",
                drive.angle_deg.unwrap_or(f64::NAN),
            ),
            (
                "tilt_speed_degrees_per_second",
                "Speed of the axis",
                drive.speed_deg_s,
            ),
            (
                "lidar_packets_per_second",
                "Data and position packets in the last second",
                lidar.packets_per_s,
            ),
            (
                "lidar_rpm",
                "Revolutions of the lidar per minute, NaN while unknown",
                lidar.rpm.unwrap_or(f64::NAN),
            ),
            ("scans", "Scans kept", disk.scans as f64),
            ("scans_bytes", "Bytes of the scans", disk.scans_bytes as f64),
            (
                "disk_free_bytes",
                "Free bytes on the disk of the scans",
                disk.free_bytes.map_or(f64::NAN, |free| free as f64),
            ),
            (
                "event_clients",
                "WebSocket clients",
                status.clients.events as f64,
            ),
        ];
        let build = Info::new([
            ("version", env!("CARGO_PKG_VERSION")),
            ("commit", self.0.commit),
        ]);
        put(&mut encoder, "build", "Build of the daemon", &build)?;
        let started = ConstGauge::new(status.started_s);
        put(
            &mut encoder,
            "start_time_seconds",
            "Start of the daemon, Unix time",
            &started,
        )?;
        for (name, help, value) in gauges {
            put(&mut encoder, name, help, &ConstGauge::new(value))?;
        }
        let counters = &self.0.counters;
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let counts = [
            ("lidar_packets", "Data and position packets", lidar.received),
            (
                "lidar_lost_packets",
                "Data packets missing by the lidar's own time",
                lidar.lost_packets,
            ),
            (
                "lidar_dropped_packets",
                "Packets dropped because this machine was too slow",
                lidar.dropped_by_kernel,
            ),
            ("captures", "Captures begun", of(&counters.captures)),
            ("captures_whole", "Complete captures", of(&counters.whole)),
            (
                "captures_partial",
                "Incomplete captures",
                of(&counters.partial),
            ),
            (
                "captures_failed",
                "Captures without a cloud",
                of(&counters.failed),
            ),
            (
                "drive_connects",
                "Times that the drive's port was opened",
                self.0.service.connects(),
            ),
            (
                "event_clients_dropped",
                "WebSocket clients disconnected because they did not read",
                status.clients.dropped,
            ),
            ("requests", "Requests answered", of(&counters.requests)),
            (
                "requests_refused",
                "Requests refused",
                of(&counters.refused),
            ),
        ];
        for (name, help, value) in counts {
            put(&mut encoder, name, help, &ConstCounter::new(value))?;
        }
        #[cfg(feature = "ros2")]
        if self.0.settings().ros2.is_some() {
            let ros2 = &self.0.ros2;
            let gauge = ConstGauge::new(f64::from(u8::from(ros2.is_connected())));
            let help = "Whether a zenoh router is connected";
            put(&mut encoder, "ros2_connected", help, &gauge)?;
            for (name, help, value) in ros2.counters() {
                put(&mut encoder, name, help, &ConstCounter::new(value))?;
            }
        }
        Ok(())
    }
}

fn put(
    encoder: &mut DescriptorEncoder<'_>,
    name: &str,
    help: &str,
    figure: &impl EncodeMetric,
) -> fmt::Result {
    figure.encode(encoder.encode_descriptor(name, help, None, figure.metric_type())?)
}
