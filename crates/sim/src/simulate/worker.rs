//! Packets, made by threads in chunks and handed on in order.
//!
//! Which packets a chunk holds does not depend on the threads, and no chunk knows of another; so their number changes nothing but the time.
//! Left out: what becomes of packets once they have left the lidar.

mod packet;
mod schedule;

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;
use std::thread;

use firmware_sim::vlp16::DATA_LEN;

use super::{Simulation, TruePoint};
use crate::clock::LidarClock;
use crate::effects::{FiringEffects, Needs};
use crate::sensor::Rays;
use packet::Worker;
use schedule::Schedule;

use super::course::Course;

/// Packets of a chunk.
const PACKETS: u64 = 32;
/// Chunks of a thread that may wait to be taken.
const WAITING: usize = 4;

/// What all threads work on.
pub(super) struct Job<'a> {
    simulation: &'a Simulation,
    course: &'a Course,
    rays: Rays,
    needs: Needs,
    clock: LidarClock,
    schedule: Schedule,
    truth: bool,
}

/// Packets in the order in which they left.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub packets: Vec<Packet>,
    /// The true points of all of them.
    pub points: Vec<TruePoint>,
}

/// A data packet that has left the lidar.
#[derive(Debug)]
pub(super) struct Packet {
    pub payload: [u8; DATA_LEN],
    /// When, host's nanoseconds since the start.
    pub leaves_ns: i64,
    /// The lidar's clock then, microseconds past the hour.
    pub stamp_us: u32,
    /// How many of the chunk's points are its own.
    pub points: usize,
    pub shots: u32,
    pub returned: u32,
    pub returns: u32,
}

impl<'a> Job<'a> {
    pub fn new<F: FiringEffects>(
        simulation: &'a Simulation,
        course: &'a Course,
        effects: &F,
        truth: bool,
    ) -> Self {
        let needs = effects.needs();
        Self {
            rays: Rays::new(&simulation.sensor, simulation.spin.deg_per_s()),
            schedule: Schedule::new(simulation, needs, effects.parts().view),
            // Its drift is an effect.
            clock: LidarClock::new(simulation.start, simulation.clock_at_start_us, 0.0),
            simulation,
            course,
            needs,
            truth,
        }
    }

    fn chunk<F: FiringEffects>(&self, worker: &mut Worker<'_, F>, number: u64) -> Chunk {
        let first = number.saturating_mul(PACKETS);
        let last = first.saturating_add(PACKETS).min(self.schedule.packets());
        let mut chunk = Chunk {
            packets: Vec::with_capacity(PACKETS as usize),
            points: Vec::new(),
        };
        for packet in first..last {
            worker.packet(packet, &mut chunk);
        }
        chunk
    }

    fn chunks(&self) -> u64 {
        self.schedule.packets().div_ceil(PACKETS)
    }
}

/// Makes all packets and hands them to `take` in order, until it says `Break`. Gives the copies of the effects that threads worked with.
pub(super) fn run<F: FiringEffects>(
    job: &Job<'_>,
    effects: &F,
    threads: NonZeroUsize,
    take: &mut dyn FnMut(&Chunk) -> ControlFlow<()>,
) -> Vec<F> {
    let chunks = job.chunks();
    let threads = threads
        .get()
        .min(usize::try_from(chunks).unwrap_or(usize::MAX));
    if threads <= 1 {
        let mut worker = Worker::new(job, effects.clone());
        for number in 0..chunks {
            if take(&job.chunk(&mut worker, number)).is_break() {
                break;
            }
        }
        return vec![worker.into_effects()];
    }
    thread::scope(|scope| {
        // Thread t makes chunks t, t + threads...: whose turn it is to be taken is known without asking.
        let mut hands = Vec::with_capacity(threads);
        for thread in 0..threads {
            let (give, got) = sync_channel(WAITING);
            let effects = effects.clone();
            let handle = scope.spawn(move || {
                let mut worker = Worker::new(job, effects);
                for number in (thread as u64..chunks).step_by(threads) {
                    // Nobody takes any more: done.
                    if give.send(job.chunk(&mut worker, number)).is_err() {
                        break;
                    }
                }
                worker.into_effects()
            });
            hands.push((got, handle));
        }
        let mut turns = hands.iter().map(|(got, _)| got).cycle();
        for _ in 0..chunks {
            let Some(Ok(chunk)) = turns.next().map(|got| got.recv()) else {
                break;
            };
            if take(&chunk).is_break() {
                break;
            }
        }
        let handles: Vec<_> = hands.into_iter().map(|(_, handle)| handle).collect();
        handles
            .into_iter()
            .filter_map(|handle| handle.join().ok())
            .collect()
    })
}
