//! Firing time of each block of a packet and pace of the rotor, from the packet and its successor.
//!
//! A packet has one time and twelve azimuths. Blocks follow at the model's period, except at the
//! gap of a limited field of view: the sensor is silent there and continues the packet after the
//! gap. The azimuths show the jump, and the time of the next packet gives its duration. Nothing is
//! extrapolated across missing packets.

use protocol::vlp16::{BLOCKS, DataPacket, LidarModel};
use units::Span;

use crate::continuity::BlindSector;

/// A revolution in hundredths of a degree.
pub(crate) const REVOLUTION_CDEG: i32 = 36_000;
/// A smaller step backwards is jitter or a slow reversal, not a step forward by almost a
/// revolution.
const BACKLASH_CDEG: i32 = 100;
/// A step of more than twice the usual one plus this is a jump.
const JUMP_CDEG: i32 = 20;
/// Packets within this of the nominal spacing follow without a gap. The tolerance covers time
/// stamps in whole microseconds and a steered clock.
pub(crate) const CONTIGUOUS_NS: i64 = 20_000;
/// Largest ratio of a measured gap to the gap by the rotor's rate.
const GAP_SLACK: f64 = 1.5;

/// The next packet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Successor {
    /// Azimuth of its first block.
    pub azimuth_cdeg: i32,
    /// Device time from this packet's first firing to its first firing.
    pub after: Span,
}

/// Timing of one block, or of one pair of a dual-return packet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BlockTiming {
    /// Time after the packet's first firing.
    pub after: Span,
    /// Azimuth of its first firing, 0 up to 36000.
    pub azimuth_cdeg: i32,
    /// Azimuth per block period.
    pub step_per_block_cdeg: f64,
}

/// Azimuth steps within a packet.
#[derive(Clone, Debug)]
pub(crate) struct AzimuthSteps {
    azimuths: [i32; BLOCKS],
    /// Step from each block to the next within the packet.
    inner: [i32; BLOCKS],
    blocks: usize,
    period_ns: i64,
    /// Smallest step.
    least_cdeg: i32,
    /// Median step, if steps differ so much that jumps are possible.
    usual_cdeg: Option<i32>,
    /// Mean of the steps without jumps.
    pub mean_cdeg: f64,
    /// Number of those steps.
    count: usize,
}

/// Relation of a packet to its successor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SuccessorLink {
    /// Step from the last block to the successor's first, if they are contiguous.
    step_cdeg: Option<i32>,
    /// Duration of the packet's gaps over their duration by the rotor's rate.
    stretch: f64,
    /// Whether the successor's time measured it.
    pub measured: bool,
}

/// Rotation between two azimuths of 0 to 35999: forward, or slightly back.
pub(crate) const fn rotation(from: i32, to: i32) -> i32 {
    let way = to - from;
    let forward = if way < 0 { way + REVOLUTION_CDEG } else { way };
    if forward > REVOLUTION_CDEG - BACKLASH_CDEG {
        forward - REVOLUTION_CDEG
    } else {
        forward
    }
}

/// Azimuth of the first block, with 36000 as 0.
pub(crate) fn first_azimuth(packet: &DataPacket<'_>) -> i32 {
    let azimuth = packet.block(0).map_or(0, |block| block.azimuth_cdeg());
    i32::from(azimuth) % REVOLUTION_CDEG
}

impl AzimuthSteps {
    pub(crate) fn new(packet: &DataPacket<'_>, model: &LidarModel, dual: bool) -> Self {
        let mut steps = Self {
            azimuths: [0; BLOCKS],
            inner: [0; BLOCKS],
            blocks: LidarModel::distinct_blocks(dual),
            period_ns: i64::from(model.block_period_ns()),
            least_cdeg: 0,
            usual_cdeg: None,
            mean_cdeg: 0.0,
            count: 0,
        };
        let stride = BLOCKS / steps.blocks;
        for (azimuth, block) in steps
            .azimuths
            .iter_mut()
            .zip(packet.blocks().step_by(stride))
        {
            *azimuth = i32::from(block.azimuth_cdeg()) % REVOLUTION_CDEG;
        }
        for (step, pair) in steps.inner.iter_mut().zip(steps.azimuths.windows(2)) {
            if let [from, to] = pair {
                *step = rotation(*from, *to);
            }
        }
        let (least, most) = steps
            .inner()
            .fold((i32::MAX, i32::MIN), |(least, most), step| {
                (least.min(step), most.max(step))
            });
        steps.least_cdeg = least;
        steps.usual_cdeg = exceeds(most, least).then(|| steps.median());
        let (sum, count) = steps
            .inner()
            .filter(|&step| !steps.is_jump(step))
            .fold((0, 0), |(sum, count), step| (sum + step, count + 1));
        if count > 0 {
            steps.mean_cdeg = f64::from(sum) / count as f64;
            steps.count = count;
        }
        steps
    }

    /// Azimuths of blocks that fired separately.
    fn azimuths(&self) -> &[i32] {
        self.azimuths.get(..self.blocks).unwrap_or_default()
    }

    /// Azimuth of the last block.
    pub(crate) fn last_azimuth(&self) -> i32 {
        self.azimuths().last().copied().unwrap_or_default()
    }

    /// Steps from each block to the next within the packet.
    fn inner(&self) -> impl Iterator<Item = i32> + Clone + '_ {
        let steps = self.inner.get(..self.blocks.saturating_sub(1));
        steps.unwrap_or_default().iter().copied()
    }

    fn median(&self) -> i32 {
        let mut sorted = [i32::MAX; BLOCKS];
        for (slot, step) in sorted.iter_mut().zip(self.inner()) {
            *slot = step;
        }
        sorted.sort_unstable();
        sorted
            .get((self.blocks - 1) / 2)
            .copied()
            .unwrap_or_default()
    }

    pub(crate) fn is_jump(&self, step_cdeg: i32) -> bool {
        // The smallest step is compared first: the median is expensive, and never smaller.
        exceeds(step_cdeg, self.least_cdeg)
            && exceeds(step_cdeg, self.usual_cdeg.unwrap_or_else(|| self.median()))
    }

    /// The first jump within the packet.
    pub(crate) fn jump(&self) -> Option<BlindSector> {
        // Without a median the packet has no jump.
        self.usual_cdeg?;
        let azimuths = self.azimuths();
        let mut pairs = azimuths.iter().zip(azimuths.iter().skip(1));
        pairs
            .find(|&(&from, &to)| self.is_jump(rotation(from, to)))
            .map(|(&from, &to)| BlindSector { from, to })
    }

    /// Nominal time to fill the packet.
    pub(crate) const fn fill_ns(&self) -> i64 {
        self.period_ns * self.blocks as i64
    }

    /// Rotation while the packet is filled.
    pub(crate) fn fill_cdeg(&self) -> f64 {
        self.mean_cdeg * self.blocks as f64
    }

    /// Time that the rotor takes for a jump beyond the usual step; 0 at standstill.
    fn gap_ns(&self, step_cdeg: i32) -> f64 {
        if self.mean_cdeg <= 0.0 || !self.is_jump(step_cdeg) {
            return 0.0;
        }
        (f64::from(step_cdeg) - self.mean_cdeg) / self.mean_cdeg * self.period_ns as f64
    }

    /// Duration of the packet's gaps by the rotor's rate.
    pub(crate) fn gaps_ns(&self) -> f64 {
        if self.usual_cdeg.is_none() {
            return 0.0;
        }
        self.inner().map(|step| self.gap_ns(step)).sum()
    }

    /// Relates the packet to its successor, if the two are contiguous.
    pub(crate) fn link(&self, next: Option<Successor>) -> SuccessorLink {
        let inner_ns = self.gaps_ns();
        let Some(next) = next else {
            return SuccessorLink::missing();
        };
        let step = rotation(self.last_azimuth(), next.azimuth_cdeg);
        let contiguous_step = (!self.is_jump(step)).then_some(step);
        let excess_ns = next.after.as_nanos().saturating_sub(self.fill_ns());
        if (-CONTIGUOUS_NS..=CONTIGUOUS_NS).contains(&excess_ns) {
            // There was no time for a gap at any azimuths.
            return SuccessorLink {
                step_cdeg: contiguous_step,
                stretch: 0.0,
                measured: false,
            };
        }
        if inner_ns <= 0.0 || excess_ns < 0 {
            return SuccessorLink::missing();
        }
        // With a narrow field of view there may be another gap between the two packets.
        let has_outer_gap = self
            .jump()
            .is_some_and(|blind| blind.is_between(self.last_azimuth(), next.azimuth_cdeg));
        let outer_ns = if has_outer_gap {
            self.gap_ns(step)
        } else {
            0.0
        };
        let stretch = excess_ns as f64 / (inner_ns + outer_ns);
        let follows = (contiguous_step.is_some() || has_outer_gap) && stretch <= GAP_SLACK;
        SuccessorLink {
            step_cdeg: contiguous_step.filter(|_| follows),
            // The time of missing packets is not that of the gap.
            stretch: if follows { stretch } else { stretch.min(1.0) },
            measured: follows && stretch >= 1.0 / GAP_SLACK,
        }
    }

    /// Rotation without jumps and the block periods it took, up to a contiguous successor.
    pub(crate) fn rotation_and_periods(&self, link: SuccessorLink) -> (f64, f64) {
        let inner = (self.mean_cdeg * self.count as f64, self.count as f64);
        link.step_cdeg
            .map_or(inner, |step| (inner.0 + f64::from(step), inner.1 + 1.0))
    }

    /// Timing of each block, and the number of blocks.
    pub(crate) fn slots(&self, link: SuccessorLink) -> ([BlockTiming; BLOCKS], usize) {
        let mut slots = [BlockTiming::default(); BLOCKS];
        let mut after_ns = 0;
        let steps = self.inner().map(Some).chain([link.step_cdeg]);
        for ((slot, &azimuth), step) in slots.iter_mut().zip(self.azimuths()).zip(steps) {
            // At a jump the pace is the packet's mean.
            let even = step.filter(|&step| !self.is_jump(step));
            let pace = even.map_or(self.mean_cdeg, f64::from);
            *slot = BlockTiming {
                after: Span::from_nanos(after_ns),
                azimuth_cdeg: azimuth,
                step_per_block_cdeg: pace,
            };
            let gap = step.map_or(0.0, |step| self.gap_ns(step));
            after_ns += self.period_ns;
            if gap > 0.0 {
                after_ns += (gap * link.stretch).round() as i64;
            }
        }
        (slots, self.blocks)
    }
}

/// Whether a step is a jump compared with the usual one.
const fn exceeds(step_cdeg: i32, usual_cdeg: i32) -> bool {
    let usual_cdeg = if usual_cdeg > 0 { usual_cdeg } else { 0 };
    step_cdeg > 2 * usual_cdeg + JUMP_CDEG
}

impl SuccessorLink {
    /// Without a contiguous successor, gaps are timed by the rotor's rate.
    const fn missing() -> Self {
        Self {
            step_cdeg: None,
            stretch: 1.0,
            measured: false,
        }
    }
}
