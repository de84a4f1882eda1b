//! Moves, links and faults of a capture.

use engine::capture::moves::SweepRequest;
use firmware_sim::epos2::Servo;
use sim::Attachment;
use sim::GearRipple;
use units::{DegPerS, DegPerS2, Degrees, Host, Span, Stamp};

use crate::inject::Fault;
use crate::port::{Arrived, Links};
use crate::random::Random;

/// Settings of a capture.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The moves.
    pub sweep_request: SweepRequest,
    /// Delays of the links.
    pub links: Links,
    /// Host time of the beginning.
    pub start: Stamp<Host>,
    /// The lidar's clock at the beginning, microseconds past the hour.
    pub lidar_clock_us: u32,
    /// The fault, and the time from the beginning to it.
    pub fault: Option<(Fault, Span)>,
    /// Time from the beginning at which the host's clock is set, and by how much.
    pub host_set: Option<(Span, Span)>,
    /// The same for the lidar's clock.
    pub lidar_set: Option<(Span, Span)>,
    /// Lost packets of the lidar.
    pub packets_lost: Option<PacketLoss>,
    /// Time from the end until the next client connects over a repaired line.
    pub rejoined_after: Option<Span>,
    /// Time from the beginning to Ctrl-C.
    pub interrupt_after: Option<Span>,
    /// The servo; `None` follows exactly.
    pub servo: Option<Servo>,
    /// Whether the drive renews its position once per millisecond.
    pub latches_position: bool,
    /// The gear's ripple; `None` has none.
    pub ripple: Option<GearRipple>,
    /// Least time between two polls; `None` is the axis's own.
    pub poll_period: Option<Span>,
    /// Revolutions of the lidar per minute.
    pub lidar_rpm: u32,
    /// Radius in metres of a hollow sphere about the tilt axis; `None` is the hall.
    pub sphere_m: Option<f64>,
    /// Standard deviation of ranges in metres, which the lidar's settings state; `None` has only
    /// the steps of the packets.
    pub range_sd_m: Option<f64>,
}

/// Packets that the network loses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketLoss {
    /// Time from the beginning.
    pub after: Span,
    /// Duration.
    pub span: Span,
    /// Share of packets, per mille.
    pub per_mille: u64,
}

impl PacketLoss {
    /// Drops the lost packets. Returns the number of dropped data packets, and of those between two
    /// received ones.
    pub(super) fn drop_packets(
        &self,
        packets: &mut Vec<Arrived>,
        start: Stamp<Host>,
        seed: u64,
    ) -> (u64, u64) {
        let (from, until) = (start + self.after, start + self.after + self.span);
        let mut random = Random(seed);
        let (mut lost, mut missed, mut in_a_row, mut started) = (0, 0, 0, false);
        packets.retain(|packet| {
            let goes = (from..until).contains(&packet.host) && random.below(1_000) < self.per_mille;
            match (packet.datagram.port == sim::DATA_PORT, goes) {
                (true, true) => {
                    lost += 1;
                    in_a_row += u64::from(started);
                }
                (true, false) => {
                    missed += in_a_row;
                    (in_a_row, started) = (0, true);
                }
                (false, _) => {}
            }
            !goes
        });
        (lost, missed)
    }
}

impl Default for Setting {
    /// 45 deg at 56.25 deg/s over USB, 2026-11-21 02:05:33 UTC.
    fn default() -> Self {
        Self {
            sweep_request: SweepRequest {
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
            latches_position: false,
            ripple: None,
            poll_period: None,
            lidar_rpm: 600,
            sphere_m: None,
            range_sd_m: None,
        }
    }
}

impl Setting {
    /// The same capture over another attachment. On RS232 and CAN the drive renews its position
    /// once per millisecond, on the others at each request: which of them a real one does is not
    /// known.
    #[must_use]
    pub fn over(attached: Attachment) -> Self {
        Self {
            links: Links::usual(attached, 1),
            latches_position: matches!(attached, Attachment::Rs232 | Attachment::Can),
            ..Self::default()
        }
    }
}
