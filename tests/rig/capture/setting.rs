//! What is captured, over what links, and what goes wrong meanwhile.

use engine::capture::moves::SweepRequest;
use firmware_sim::epos2::Servo;
use sim::Attachment;
use sim::GearRipple;
use units::{DegPerS, DegPerS2, Degrees, Host, Span, Stamp};

use crate::inject::Fault;
use crate::port::{Arrived, Links};
use crate::random::Random;

/// What to capture, and over what.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The moves.
    pub wish: SweepRequest,
    /// The links' delays.
    pub links: Links,
    /// When it begins.
    pub start: Stamp<Host>,
    /// The lidar's clock then, microseconds past the hour.
    pub lidar_clock_us: u32,
    /// What goes wrong, and how long after the begin.
    pub fault: Option<(Fault, Span)>,
    /// How long after the begin the host's clock is set, and how far forward.
    pub host_set: Option<(Span, Span)>,
    /// The same of the lidar's clock.
    pub lidar_set: Option<(Span, Span)>,
    /// What the network loses of the lidar's packets.
    pub packets_lost: Option<PacketLoss>,
    /// How long after the end the next client connects, over a line that is whole again.
    pub rejoined_after: Option<Span>,
    /// How long after the begin the user presses Ctrl-C.
    pub interrupt_after: Option<Span>,
    /// How the motor follows its demand; `None`: exactly.
    pub servo: Option<Servo>,
    /// What the gear adds; `None`: nothing.
    pub ripple: Option<GearRipple>,
    /// Least time between two polls; `None`: as the axis has it.
    pub poll_period: Option<Span>,
}

/// Packets that a network loses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketLoss {
    /// How long after the begin.
    pub after: Span,
    /// For how long.
    pub span: Span,
    /// How many of a thousand.
    pub per_mille: u64,
}

impl PacketLoss {
    /// Loses what is to be lost; how many data packets that were, and how many of them between two
    /// that came.
    pub(super) fn lose(
        &self,
        packets: &mut Vec<Arrived>,
        start: Stamp<Host>,
        seed: u64,
    ) -> (u64, u64) {
        let (from, until) = (start + self.after, start + self.after + self.span);
        let mut random = Random(seed);
        let (mut lost, mut missed, mut in_a_row, mut begun) = (0, 0, 0, false);
        packets.retain(|packet| {
            let goes = (from..until).contains(&packet.host) && random.below(1_000) < self.per_mille;
            match (packet.datagram.port == sim::DATA_PORT, goes) {
                (true, true) => {
                    lost += 1;
                    in_a_row += u64::from(begun);
                }
                (true, false) => {
                    missed += in_a_row;
                    (in_a_row, begun) = (0, true);
                }
                (false, _) => {}
            }
            !goes
        });
        (lost, missed)
    }
}

impl Default for Setting {
    /// The card's command: 45 degrees at 56.25 deg/s over USB, 2026-11-21 02:05:33 UTC.
    fn default() -> Self {
        Self {
            wish: SweepRequest {
                from: Degrees(0.0),
                to: Degrees(-45.0),
                speed: DegPerS(56.25),
                acceleration: DegPerS2(5_000.0),
                sweeps: 1,
                both_ways: false,
            },
            links: Links::usual(Attachment::Usb, 1),
            start: Stamp::from_nanos(1_795_226_733_000_000_000),
            lidar_clock_us: 1_234_567_890,
            fault: None,
            host_set: None,
            lidar_set: None,
            packets_lost: None,
            rejoined_after: None,
            interrupt_after: None,
            servo: None,
            ripple: None,
            poll_period: None,
        }
    }
}

impl Setting {
    /// The card's command over another way to the drive.
    #[must_use]
    pub fn over(attached: Attachment) -> Self {
        Self {
            links: Links::usual(attached, 1),
            ..Self::default()
        }
    }
}
