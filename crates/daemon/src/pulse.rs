//! What is looked at every second: the lidar's rate, the disk, whether the machine has slept, and that the keeper lives.

use std::sync::Arc;
use std::sync::PoisonError;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use sd_notify::NotifyState;
use units::Span;

use super::hub::Level;
use super::keeper::Order;
use super::shared::Shared;
use super::view::{DeviceState, Doing};
use engine::capture::run as job;
use engine::failure::{Failure, Kind};

const EVERY: Duration = Duration::from_secs(1);
/// A lidar that sends nothing for so long is not there.
const SILENCE: Duration = Duration::from_secs(2);
/// A shorter sleep is the reading of two clocks.
const SLEPT: Span = Span::from_millis(500);
/// A keeper that was not seen for so long hangs: its longest wait is a homing without an answer.
const HANGS: Duration = Duration::from_secs(90);

/// What is remembered between two looks.
struct Pulse {
    shared: Arc<Shared>,
    packets: u64,
    heard: Instant,
    slept: Span,
    watchdog: bool,
}

/// Until `end` is dropped.
pub fn run(shared: &Arc<Shared>, end: &Receiver<()>) {
    let mut pulse = Pulse {
        shared: Arc::clone(shared),
        packets: 0,
        heard: Instant::now(),
        slept: (shared.world.suspended)(),
        watchdog: sd_notify::watchdog_enabled().is_some(),
    };
    // The service manager's limit may be shorter than two of ours.
    let every = sd_notify::watchdog_enabled().map_or(EVERY, |limit| EVERY.min(limit / 3));
    while end.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
        pulse.lidar();
        pulse.disk();
        shared.scans.settle();
        shared.look_at_disk();
        pulse.sleep();
        pulse.keeper();
        shared.tell_status();
    }
}

impl Pulse {
    fn lidar(&mut self) {
        let shared = &self.shared;
        let Some(hearing) = shared.hearing() else {
            return;
        };
        let counts = hearing.counts();
        drop(hearing);
        let seen = shared
            .monitor
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .look();
        if seen.packets != self.packets {
            self.packets = seen.packets;
            self.heard = Instant::now();
        }
        let (state, problem) = match &counts {
            Err(failure) => (DeviceState::Fault, Some(failure.clone())),
            Ok(_) if self.heard.elapsed() >= SILENCE => (
                DeviceState::Absent,
                Some(job::silence(&shared.listen_config())),
            ),
            Ok(_) if seen.packets > 0 => (DeviceState::Connected, None),
            Ok(_) => (DeviceState::Absent, None),
        };
        shared.set_lidar(|lidar| {
            lidar.state = state;
            lidar.problem = problem;
            lidar.model = seen.model;
            lidar.return_mode = seen.return_mode;
            lidar.rpm = seen.rpm;
            lidar.packets = seen.packets;
            lidar.packets_per_s = seen.packets_per_s;
            lidar.lost_packets = seen.lost_packets;
            if let Ok(counts) = counts {
                lidar.dropped_by_kernel = counts.dropped;
            }
        });
    }

    /// A scan that would fill the disk is ended while all of it can still be saved.
    fn disk(&self) {
        let shared = &self.shared;
        if shared.activity().doing != Doing::Capturing {
            return;
        }
        let reserve = shared.settings().reserve_bytes;
        let Ok(free) = (shared.world.free_bytes)(shared.scans.folder()) else {
            return;
        };
        if free < reserve {
            let failure = disk_full(free, reserve);
            if shared.interrupt(Some(failure.clone())) {
                shared.hub.say(Level::Error, failure.message, failure.help);
            }
        }
    }

    fn sleep(&mut self) {
        let slept = (self.shared.world.suspended)();
        let Some(failure) = suspended(self.slept, slept) else {
            return;
        };
        self.slept = slept;
        self.shared.interrupt(Some(failure.clone()));
        self.shared.hub.say(
            Level::Warning,
            failure.message,
            Some("the devices are connected anew".to_owned()),
        );
        // A keeper that is gone has no devices.
        let _ = self.shared.order(Order::Reopen);
    }

    fn keeper(&self) {
        if self.watchdog && self.shared.silence() < HANGS {
            // Whoever started this has the limit; where it is not there, nobody is.
            let _ = sd_notify::notify(&[NotifyState::Watchdog]);
        }
    }
}

/// What is said where the machine has slept between two looks at how long it has slept in all.
#[must_use]
pub fn suspended(before: Span, now: Span) -> Option<Failure> {
    let slept = now - before;
    (slept >= SLEPT).then(|| {
        Failure::new(
            Kind::Incomplete,
            format!("the machine was suspended for {:.0} s", slept.as_secs_f64()),
        )
        .help("scan again; see whether the machine may sleep while it scans (systemd-inhibit)")
    })
}

/// Too little room.
#[must_use]
pub fn disk_full(free: u64, reserve: u64) -> Failure {
    Failure::new(
        Kind::Incomplete,
        format!(
            "the disk is nearly full: {} MB free, {} MB are left free",
            free / 1_000_000,
            reserve / 1_000_000
        ),
    )
    .help("delete scans, or give another folder or a smaller reserve_bytes under [daemon] of the configuration")
}
