//! Counters of sent and missed messages, for `/metrics` and diagnostics.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Counters since the start.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Counts {
    /// Whether a router is connected.
    pub connected: AtomicBool,
    /// Messages sent, of all topics.
    pub messages: AtomicU64,
    /// Clouds of sweeps sent, and parts of long ones.
    pub clouds: AtomicU64,
    /// Live clouds sent.
    pub frames: AtomicU64,
    /// Service calls answered.
    pub calls: AtomicU64,
    /// Messages left out because the network took too long.
    pub missed: AtomicU64,
}

impl Counts {
    /// Names, descriptions and values of the counters for Prometheus.
    #[must_use]
    pub fn counters(&self) -> [(&'static str, &'static str, u64); 5] {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        [
            (
                "ros2_messages",
                "Messages that were sent to ROS 2",
                of(&self.messages),
            ),
            (
                "ros2_clouds",
                "Of those, clouds of sweeps",
                of(&self.clouds),
            ),
            ("ros2_frames", "Of those, live clouds", of(&self.frames)),
            (
                "ros2_calls",
                "Calls of services that were answered",
                of(&self.calls),
            ),
            (
                "ros2_missed",
                "Messages left out because the network took too long",
                of(&self.missed),
            ),
        ]
    }

    /// Whether a router is connected.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.connected.load(Ordering::Relaxed)
    }
}
