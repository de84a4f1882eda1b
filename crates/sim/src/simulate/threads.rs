//! Packets in chunks, made by threads and passed on in order.
//!
//! The packets of a chunk do not depend on the threads, and chunks do not depend on each other, so
//! the number of threads changes only the time.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;
use std::thread;

use super::Simulation;
use super::course::AxisCourse;
use super::schedule::BlockSchedule;
use crate::effects::FiringEffects;
use crate::firing::Surroundings;
use crate::packet_maker::{PacketMaker, SimulatedLidar, SimulatedPacket, TruePoint};

/// Packets per chunk.
const CHUNK_PACKETS: u64 = 32;
/// Finished chunks per thread that may wait.
const QUEUED_CHUNKS: usize = 4;

/// State of all threads.
pub(super) struct SharedRun<'a> {
    lidar: SimulatedLidar,
    course: &'a AxisCourse,
    schedule: BlockSchedule,
    surroundings: Surroundings,
    truth: bool,
}

/// Packets in the order in which they leave.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub packets: Vec<SimulatedPacket>,
    /// The true points of all packets.
    pub points: Vec<TruePoint>,
}

impl<'a> SharedRun<'a> {
    pub fn new<F: FiringEffects>(
        simulation: &'a Simulation,
        course: &'a AxisCourse,
        effects: &F,
        truth: bool,
    ) -> Self {
        let needs = effects.needs();
        let range = simulation.sensor.range();
        Self {
            lidar: simulation.lidar(effects.parts().surface),
            course,
            schedule: BlockSchedule::new(simulation, needs, effects.parts().view),
            surroundings: Surroundings::new(simulation.scene.clone(), range, !needs.moving),
            truth,
        }
    }

    fn maker<F: FiringEffects>(&self, effects: F) -> PacketMaker<F> {
        PacketMaker::new(&self.lidar, effects, self.surroundings.clone())
    }

    fn chunk<F: FiringEffects>(&self, maker: &mut PacketMaker<F>, number: u64) -> Chunk {
        let first = number.saturating_mul(CHUNK_PACKETS);
        let last = (first.saturating_add(CHUNK_PACKETS)).min(self.schedule.packets());
        let mut chunk = Chunk {
            packets: Vec::with_capacity(CHUNK_PACKETS as usize),
            points: Vec::new(),
        };
        for packet in first..last {
            let points = self.truth.then_some(&mut chunk.points);
            let blocks = self.schedule.blocks(packet);
            let packet = maker.packet(&self.lidar, self.course, blocks, points);
            chunk.packets.push(packet);
        }
        chunk
    }
}

/// Makes all packets and passes them to `take` in order until it returns `Break`. Returns the
/// copies of the effects that the threads worked with.
pub(super) fn run<F: FiringEffects>(
    run: &SharedRun<'_>,
    effects: &F,
    threads: NonZeroUsize,
    take: &mut dyn FnMut(&Chunk) -> ControlFlow<()>,
) -> Vec<F> {
    let chunks = run.schedule.packets().div_ceil(CHUNK_PACKETS);
    let threads = threads
        .get()
        .min(usize::try_from(chunks).unwrap_or(usize::MAX));
    if threads <= 1 {
        let mut maker = run.maker(effects.clone());
        for number in 0..chunks {
            if take(&run.chunk(&mut maker, number)).is_break() {
                break;
            }
        }
        return vec![maker.into_effects()];
    }
    thread::scope(|scope| {
        // Thread t makes chunks t, t + threads..., so the order of receivers is known.
        let mut workers = Vec::with_capacity(threads);
        for thread in 0..threads {
            let (sender, receiver) = sync_channel(QUEUED_CHUNKS);
            let effects = effects.clone();
            let handle = scope.spawn(move || {
                let mut maker = run.maker(effects);
                for number in (thread as u64..chunks).step_by(threads) {
                    if sender.send(run.chunk(&mut maker, number)).is_err() {
                        // The receiver stopped.
                        break;
                    }
                }
                maker.into_effects()
            });
            workers.push((receiver, handle));
        }
        let mut receivers = workers.iter().map(|(receiver, _)| receiver).cycle();
        for _ in 0..chunks {
            let Some(Ok(chunk)) = receivers.next().map(|receiver| receiver.recv()) else {
                break;
            };
            if take(&chunk).is_break() {
                break;
            }
        }
        let handles: Vec<_> = workers.into_iter().map(|(_, handle)| handle).collect();
        let effects = handles.into_iter().filter_map(|handle| handle.join().ok());
        effects.collect()
    })
}
