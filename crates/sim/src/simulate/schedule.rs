//! Numbers of the blocks that fire: consecutive, but for azimuths that the sensor leaves out.
//!
//! Blocks are numbered as if none were left out, so a block's number gives its time.

use crate::effects::{Needs, ViewEffect};
use crate::packet_maker::HeadRotation;
use crate::simulate::Simulation;

/// The blocks that fire.
#[derive(Clone, Debug)]
pub(super) struct BlockSchedule {
    /// Runs of consecutive blocks.
    runs: Vec<BlockRun>,
    blocks_per_packet: u64,
    packets: u64,
}

/// Consecutive blocks.
#[derive(Clone, Copy, Debug, Default)]
struct BlockRun {
    /// Number of blocks that fire before.
    before: u64,
    /// Number of the first block.
    first: u64,
}

impl BlockSchedule {
    pub fn new<V: ViewEffect>(simulation: &Simulation, needs: Needs, view: &V) -> Self {
        let sensor = &simulation.sensor;
        let block = sensor.firings_per_block() as i64 * sensor.firing_period_ns;
        let period_ns = block / sensor.firings_at_once() as i64;
        let possible = u64::try_from(simulation.end_ns() / period_ns).unwrap_or(0);
        let (runs, fired) = if needs.azimuths {
            runs_in_view(simulation.rotation, period_ns, possible, view)
        } else {
            (vec![BlockRun::default()], possible)
        };
        let blocks_per_packet = firmware_sim::vlp16::firing_blocks(simulation.returns) as u64;
        Self {
            runs,
            blocks_per_packet,
            packets: fired / blocks_per_packet,
        }
    }

    /// Number of full packets.
    pub const fn packets(&self) -> u64 {
        self.packets
    }

    /// The blocks of a packet.
    pub fn blocks(&self, packet: u64) -> impl Iterator<Item = u64> {
        let first = packet.saturating_mul(self.blocks_per_packet);
        (first..first.saturating_add(self.blocks_per_packet)).map(|fired| self.block(fired))
    }

    /// The number of the block that fires after `fired` others.
    fn block(&self, fired: u64) -> u64 {
        let run = self.runs.partition_point(|run| run.before <= fired);
        let run = run.checked_sub(1).and_then(|run| self.runs.get(run));
        run.map_or(fired, |run| run.first + (fired - run.before))
    }
}

/// The blocks that a view lets fire, and their number.
fn runs_in_view<V: ViewEffect>(
    rotation: HeadRotation,
    period_ns: i64,
    possible: u64,
    view: &V,
) -> (Vec<BlockRun>, u64) {
    let mut runs: Vec<BlockRun> = Vec::new();
    let (mut fired, mut gap) = (0, true);
    let mut device_ns = 0_i64;
    for block in 0..possible {
        let fires = view.fires(rotation.azimuth_deg(device_ns));
        if fires && gap {
            runs.push(BlockRun {
                before: fired,
                first: block,
            });
        }
        fired += u64::from(fires);
        gap = !fires;
        device_ns = device_ns.saturating_add(period_ns);
    }
    (runs, fired)
}
