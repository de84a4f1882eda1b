//! Figures for Prometheus, collected when they are asked for.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric, text};
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::registry::Registry;

use super::Api;
use super::refusal::Refusal;
use crate::ros2::counts::Counts;
use crate::shared::Shared;
use crate::view::{DeviceState, Doing};

/// `GET /metrics`.
pub async fn metrics(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    let mut registry = Registry::with_prefix("velomotion");
    registry.register_collector(Box::new(Figures(Arc::clone(&api.shared))));
    let mut said = String::new();
    text::encode(&mut said, &registry).map_err(|error| {
        Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "incomplete",
            error.to_string(),
            "this is a defect of the program",
        )
    })?;
    let content = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    Ok(([(header::CONTENT_TYPE, content)], said).into_response())
}

struct Figures(Arc<Shared>);

impl fmt::Debug for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Figures")
    }
}

impl Collector for Figures {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let status = self.0.status();
        let (drive, lidar, disk) = (&status.drive, &status.lidar, &status.disk);
        let connected = |state| f64::from(u8::from(state == DeviceState::Connected));
        let gauges = [
            (
                "drive_connected",
                "Whether the drive is there and well",
                connected(drive.state),
            ),
            (
                "lidar_connected",
                "Whether the lidar is there and well",
                connected(lidar.state),
            ),
            (
                "capturing",
                "Whether a scan is recorded",
                f64::from(u8::from(status.activity.doing == Doing::Capturing)),
            ),
            (
                "tilt_angle_degrees",
                "Where the axis is, NaN while that is not known",
                drive.angle_deg.unwrap_or(f64::NAN),
            ),
            (
                "tilt_speed_degrees_per_second",
                "How fast it moves",
                drive.speed_deg_s,
            ),
            (
                "lidar_packets_per_second",
                "Data and position packets in the last second",
                lidar.packets_per_s,
            ),
            (
                "lidar_rpm",
                "Turns of the lidar a minute, NaN while that is not known",
                lidar.rpm.unwrap_or(f64::NAN),
            ),
            ("scans", "Scans that are kept", disk.scans as f64),
            ("scans_bytes", "Bytes of them", disk.scans_bytes as f64),
            (
                "disk_free_bytes",
                "Free bytes on their disk",
                disk.free_bytes.map_or(f64::NAN, |free| free as f64),
            ),
            (
                "event_clients",
                "WebSocket clients",
                status.clients.events as f64,
            ),
        ];
        for (name, help, value) in gauges {
            put(&mut encoder, name, help, &ConstGauge::new(value))?;
        }
        let counters = &self.0.counters;
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let counts = [
            ("lidar_packets", "Data and position packets", lidar.packets),
            (
                "lidar_lost_packets",
                "Data packets missing by the lidar's own time",
                lidar.lost_packets,
            ),
            (
                "lidar_dropped_packets",
                "Packets for which this machine was too slow",
                lidar.dropped_by_kernel,
            ),
            (
                "captures",
                "Captures that were begun",
                of(&counters.captures),
            ),
            (
                "captures_whole",
                "Captures that are whole",
                of(&counters.whole),
            ),
            (
                "captures_partial",
                "Captures that are not whole",
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
                of(&counters.connects),
            ),
            (
                "event_clients_dropped",
                "WebSocket clients that did not read",
                status.clients.dropped,
            ),
            (
                "requests",
                "Requests that were answered",
                of(&counters.requests),
            ),
            (
                "requests_refused",
                "Of those, refused",
                of(&counters.refused),
            ),
        ];
        let ros2 = self.0.settings().ros2.as_ref().map(|_| &self.0.ros2);
        if let Some(ros2) = ros2 {
            let gauge = ConstGauge::new(f64::from(u8::from(ros2.is_connected())));
            let help = "Whether a zenoh router is connected";
            put(&mut encoder, "ros2_connected", help, &gauge)?;
        }
        let ros2 = ros2.map(Counts::counters).into_iter().flatten();
        for (name, help, value) in counts.into_iter().chain(ros2) {
            put(&mut encoder, name, help, &ConstCounter::new(value))?;
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
