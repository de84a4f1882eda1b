//! What was sent and what was not, for `/metrics` and for diagnostics.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Counters since the start.
#[derive(Debug, Default)]
pub struct Counts {
    /// Whether a router is connected.
    pub connected: AtomicBool,
    /// Messages that were sent, of every topic.
    pub messages: AtomicU64,
    /// Of those: clouds of whole sweeps, and parts of long ones.
    pub clouds: AtomicU64,
    /// Of those: live clouds.
    pub frames: AtomicU64,
    /// Calls of services that were answered.
    pub calls: AtomicU64,
    /// What was to be sent, and was left out because the network took too long.
    pub missed: Arc<AtomicU64>,
}

impl Counts {
    /// Names, what they are, and values: counters for Prometheus.
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
