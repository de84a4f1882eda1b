//! The capture that a seed stands for: which fault, when, in which moves.

use engine::capture::moves::SweepRequest;
use sim::Attachment;
use units::{DegPerS, DegPerS2, Degrees, Span};
use velomotion_tests::capture::PacketLoss;
use velomotion_tests::inject::Fault;
use velomotion_tests::random::Random;

/// Faults in virtual time.
#[derive(Clone, Copy, Debug)]
pub enum Virtual {
    /// No fault.
    Nothing,
    /// A fault of the link or of the drive.
    Link(Fault),
    /// The cable or the program disappears; another client connects after this time.
    Gone(Span),
    /// The network loses packets of the lidar.
    Lost(PacketLoss),
    /// The host's clock is set forward by this much.
    HostClock(Span),
    /// The lidar's clock is set forward by this much.
    LidarClock(Span),
    /// The program is killed: so many thousandths of the log are on disk.
    Killed(u64),
    /// The user presses Ctrl-C.
    Interrupted,
}

/// Faults in real time, with processes and sockets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Real {
    /// No fault.
    Nothing,
    /// The drive's cable is unplugged and plugged in again.
    UsbGone,
    /// The lidar is silent for a while.
    LidarGone,
    /// The network loses every n-th packet.
    PacketsLost,
    /// The daemon is killed and restarted.
    Killed,
    /// The daemon is stopped with SIGTERM and restarted.
    Ended,
    /// The disk is full.
    DiskFull,
}

/// One capture.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The seed that determines everything else.
    pub seed: u64,
    /// The moves.
    pub sweep_request: SweepRequest,
    /// The fault.
    pub fault: Either,
    /// Time from the beginning to the fault.
    pub after: Span,
    /// Time from the fault to its repair.
    pub mended_after: Span,
    /// Attachment of the drive in virtual time.
    pub attached: Attachment,
}

/// Virtual or real time.
#[derive(Clone, Copy, Debug)]
pub enum Either {
    /// Virtual time.
    Virtual(Virtual),
    /// Real time.
    Real(Real),
}

/// Rows of the table in order.
pub const ROWS: [&str; 15] = [
    "no fault",
    "drive or its link",
    "drive loses its client",
    "lidar packets lost",
    "lidar silent",
    "host clock set",
    "lidar clock set",
    "killed: log cut off at any byte",
    "Ctrl-C",
    "USB unplugged (real)",
    "lidar silent (real)",
    "lidar packets lost (real)",
    "kill -9 and restart (real)",
    "SIGTERM and restart (real)",
    "disk full (real)",
];

impl Plan {
    /// Makes the plan of a seed. Twenty consecutive seeds cover every kind of fault.
    pub fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let attached = [
            Attachment::Usb,
            Attachment::Rs232,
            Attachment::Slcan,
            Attachment::Can,
        ];
        let attached = attached[usize::try_from(seed / 20 + seed % 20).unwrap() % 4];
        // Covers homing, ramps and the whole sweep.
        let after = Span::from_millis(random.between(100, 5_500));
        let fault = match seed % 20 {
            0 => Either::Virtual(Virtual::Nothing),
            1..=4 => Either::Virtual(Virtual::Link(link_fault(&mut random))),
            5 => Either::Virtual(Virtual::Gone(Span::from_millis(random.between(0, 4_000)))),
            6 => Either::Virtual(Virtual::Lost(loss(after, &mut random, false))),
            7 => Either::Virtual(Virtual::Lost(loss(after, &mut random, true))),
            8 => Either::Virtual(Virtual::HostClock(step(&mut random))),
            9 => Either::Virtual(Virtual::LidarClock(step(&mut random))),
            10 | 11 => Either::Virtual(Virtual::Killed(random.below(1_001))),
            12 => Either::Virtual(Virtual::Interrupted),
            13 => Either::Real(Real::UsbGone),
            14 => Either::Real(Real::LidarGone),
            15 => Either::Real(Real::PacketsLost),
            16 | 17 => Either::Real(Real::Killed),
            18 => Either::Real(Real::Ended),
            _ => Either::Real(match seed / 20 % 4 {
                0 => Real::DiskFull,
                1 => Real::Nothing,
                2 => Real::DiskFull,
                _ => Real::Killed,
            }),
        };
        let sweep_request = SweepRequest {
            from: Degrees(0.0),
            to: Degrees(-(random.between(10, 46) as f64)),
            speed: DegPerS(random.between(20, 91) as f64),
            acceleration: DegPerS2(random.between(500, 5_000) as f64),
            sweeps: 1 + u32::try_from(random.below(2)).unwrap(),
            both_ways: random.below(2) == 0,
        };
        Self {
            seed,
            sweep_request,
            fault,
            after,
            mended_after: Span::from_millis(random.between(50, 2_500)),
            attached,
        }
    }

    /// Row of the table.
    pub fn row(&self) -> usize {
        match self.fault {
            Either::Virtual(what) => match what {
                Virtual::Nothing => 0,
                Virtual::Link(_) => 1,
                Virtual::Gone(_) => 2,
                Virtual::Lost(loss) if loss.per_mille < 1_000 => 3,
                Virtual::Lost(_) => 4,
                Virtual::HostClock(_) => 5,
                Virtual::LidarClock(_) => 6,
                Virtual::Killed(_) => 7,
                Virtual::Interrupted => 8,
            },
            Either::Real(what) => match what {
                Real::Nothing => 0,
                Real::UsbGone => 9,
                Real::LidarGone => 10,
                Real::PacketsLost => 11,
                Real::Killed => 12,
                Real::Ended => 13,
                Real::DiskFull => 14,
            },
        }
    }

    /// Name of the scan.
    pub fn name(&self) -> String {
        format!("seed-{}", self.seed)
    }
}

fn link_fault(random: &mut Random) -> Fault {
    use protocol::epos2::DeviceError;
    let span = Span::from_millis(random.between(1, 400));
    let late = Span::from_millis(random.between(5, 300));
    let device = random.one(&[
        DeviceError::OVERCURRENT,
        DeviceError::UNDERVOLTAGE,
        DeviceError::POSITION_SENSOR,
        DeviceError::FOLLOWING,
        DeviceError::NEGATIVE_LIMIT,
    ]);
    random.one(&[
        Fault::AnswersLost(span),
        Fault::RequestsLost(span),
        Fault::AnswersLate(span, late),
        Fault::AnswersFlipped(span),
        Fault::RequestsFlipped(span),
        Fault::AnswersCut(span),
        Fault::AnswersDoubled(span),
        Fault::AnswersStale(span),
        Fault::AnswersInBytes(span),
        Fault::Noise(span),
        Fault::NoiseWithFrameStarts(span),
        Fault::WriteBlocked,
        Fault::PowerCycle,
        Fault::Device(device),
        Fault::Blocked,
    ])
}

fn loss(after: Span, random: &mut Random, all: bool) -> PacketLoss {
    match all {
        true => PacketLoss {
            after,
            span: Span::from_secs(1_000),
            per_mille: 1_000,
        },
        false => PacketLoss {
            after,
            span: Span::from_millis(random.between(20, 2_000)),
            per_mille: 1 + random.below(600),
        },
    }
}

/// A clock step forwards or back, by milliseconds or by an hour.
fn step(random: &mut Random) -> Span {
    let far = random.one(&[50, 900, 30_000, 3_600_000]);
    let ms = random.between(far / 2, far);
    Span::from_millis(if random.below(2) == 0 { ms } else { -ms })
}
