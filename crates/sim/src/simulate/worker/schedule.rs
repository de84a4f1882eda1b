//! Which block fires when: one after the other, but for azimuths that the sensor leaves out.
//!
//! Blocks are numbered as if none were left out, so a block's number is its time. Left out: what is in them.

use crate::effects::{Needs, View};
use crate::simulate::{Simulation, Spin};

/// The blocks that fire.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Blocks that fire without a gap.
    runs: Vec<Run>,
    blocks_per_packet: u64,
    packets: u64,
}

/// Blocks without a gap.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// How many blocks fired before.
    before: u64,
    /// The first.
    first: u64,
}

impl Schedule {
    pub fn new<V: View>(simulation: &Simulation, needs: Needs, view: &V) -> Self {
        let period_ns = simulation.sensor.model().block_period_ns();
        let possible = u64::try_from(simulation.end_ns() / period_ns).unwrap_or(0);
        let (runs, fired) = if needs.azimuths {
            windows(simulation.spin, period_ns, possible, view)
        } else {
            let all = Run {
                before: 0,
                first: 0,
            };
            (vec![all], possible)
        };
        let blocks_per_packet = firmware_sim::vlp16::firing_blocks(simulation.returns) as u64;
        Self {
            runs,
            blocks_per_packet,
            packets: fired / blocks_per_packet,
        }
    }

    /// Packets that are filled.
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

/// The blocks that a view lets fire, and how many there are.
fn windows<V: View>(spin: Spin, period_ns: i64, possible: u64, view: &V) -> (Vec<Run>, u64) {
    let mut runs: Vec<Run> = Vec::new();
    let (mut fired, mut gap) = (0, true);
    let mut at_ns = 0_i64;
    for block in 0..possible {
        let fires = view.fires(spin.azimuth_deg(at_ns));
        if fires && gap {
            runs.push(Run {
                before: fired,
                first: block,
            });
        }
        fired += u64::from(fires);
        gap = !fires;
        at_ns = at_ns.saturating_add(period_ns);
    }
    (runs, fired)
}
