//! Steps of the host's clock while records come in.
//!
//! Both devices' records jump where the host's clock is set. A packet far from the lidar's clock
//! may be a delayed one, so it and all records after it wait until the delays of some packets are
//! alike, which shows a step, or a packet is on time again. If the drive's records jump as well,
//! the host's clock was set, otherwise the lidar's. Steps below 10 ms are not undone.

use std::collections::VecDeque;

use drive::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Span, Stamp};

use crate::clock::Arrival;

/// The smallest step, and the tolerance of delays that are alike.
const LEAST: Span = Span::from_millis(10);
const ALIKE: Span = Span::from_millis(5);
/// Packets whose delays have to be alike, and packets that wait at most: a third of a second.
const LEVEL: usize = 12;
const MAX_DOUBTFUL: usize = 256;
/// Packets on time before steps are looked for.
const MIN_ON_TIME: usize = 64;
/// Frames that wait at most, for a lidar that is silent.
const MAX_FRAMES: usize = 1_024;
/// Packets on time after which frames that seem to go back are used all the same.
const MAX_BLOCKED: usize = 64;

/// A frame of the drive that waits for a packet after it.
pub(super) struct HeldFrame {
    link: DriveLink,
    direction: Direction,
    bytes: Vec<u8>,
    recorded: Stamp<Host>,
    /// Recorded less continuous time.
    shift: Span,
}

impl HeldFrame {
    /// Its time by the host's clock before all steps.
    fn host(&self) -> Stamp<Host> {
        self.recorded.saturating_add(-self.shift)
    }

    /// The record with that time.
    pub fn record(&self) -> Record<'_> {
        Record {
            host: self.host(),
            wire: Wire::Drive {
                link: self.link,
                direction: self.direction,
                frame: &self.bytes,
            },
        }
    }
}

/// Decision about a packet.
pub(super) enum PacketDecision {
    /// These packets belong to the clock; the first ones may have waited.
    Packets(Vec<Arrival>),
    /// The lidar's clock was set back by so much before these packets.
    LidarStep(Span, Vec<Arrival>),
    /// Nothing yet.
    Undecided,
}

/// Converts stamps to the host's clock as it was at the beginning.
#[derive(Default)]
pub(super) struct HostSteps {
    shift: Span,
    /// Packets far from the lidar's clock, and their delays.
    doubtful: Vec<(Arrival, Span)>,
    frames: VecDeque<HeldFrame>,
    /// Time of the last frame that was used.
    used: Option<Stamp<Host>>,
    /// Packets on time, and those since a frame was used.
    on_time: usize,
    blocked: usize,
}

impl HostSteps {
    /// The arrival by the clock before all steps.
    pub fn converted(&self, arrival: Arrival) -> Arrival {
        Arrival {
            host: arrival.host.saturating_add(-self.shift),
            ..arrival
        }
    }

    /// Whether records wait for the next packets.
    pub fn is_in_doubt(&self) -> bool {
        !self.doubtful.is_empty()
    }

    /// Takes a frame of the drive.
    pub fn hold(&mut self, recorded: Stamp<Host>, link: DriveLink, at: (Direction, &[u8])) {
        self.frames.push_back(HeldFrame {
            link,
            direction: at.0,
            bytes: at.1.to_vec(),
            recorded,
            shift: self.shift,
        });
    }

    /// Takes a converted packet that is late by so much; `None` if the clock is not known.
    pub fn packet(&mut self, arrival: Arrival, late: Option<Span>) -> PacketDecision {
        let late = late.unwrap_or(Span::ZERO);
        // The first packets may be the late ones.
        if (-LEAST < late && late < LEAST) || self.on_time < MIN_ON_TIME {
            // Delayed packets tell nothing of the clock, and early ones are damaged.
            self.doubtful.clear();
            self.on_time += 1;
            self.blocked += 1;
            return PacketDecision::Packets(vec![arrival]);
        }
        self.doubtful.push((arrival, late));
        let recent = self.doubtful.len().checked_sub(LEVEL);
        let recent = recent.and_then(|first| self.doubtful.get(first..));
        let lates = || recent.into_iter().flatten().map(|(_, late)| *late);
        let level = lates().min().zip(lates().max());
        let waited = |by: Span, doubtful: &mut Vec<(Arrival, Span)>| {
            let shifted = doubtful.drain(..).map(|(arrival, _)| Arrival {
                host: arrival.host.saturating_add(-by),
                ..arrival
            });
            shifted.collect()
        };
        match level {
            Some((least, most)) if most.saturating_sub(least) < ALIKE => {
                let first = self.first_after(least);
                if first.is_none() && !self.frames.is_empty() {
                    return PacketDecision::LidarStep(
                        least,
                        waited(Span::ZERO, &mut self.doubtful),
                    );
                }
                self.shift = self.shift.saturating_add(least);
                let after = self.frames.iter_mut().skip(first.unwrap_or(0));
                for frame in after {
                    frame.shift = self.shift;
                }
                PacketDecision::Packets(waited(least, &mut self.doubtful))
            }
            _ if self.doubtful.len() >= MAX_DOUBTFUL => {
                PacketDecision::Packets(waited(Span::ZERO, &mut self.doubtful))
            }
            _ => PacketDecision::Undecided,
        }
    }

    /// The first waiting frame after a step of the host's clock by `by`, if the frames show it.
    fn first_after(&self, by: Span) -> Option<usize> {
        let mut last = self.used?;
        self.frames.iter().position(|frame| {
            let length = frame.host().saturating_since(last);
            last = frame.host();
            match by < Span::ZERO {
                true => length < by.half(),
                false => length > by.half(),
            }
        })
    }

    /// The next frame to use, after a packet received at `recorded`; with `None` all are used.
    pub fn next_frame(&mut self, recorded: Option<Stamp<Host>>) -> Option<HeldFrame> {
        let front = self.frames.front()?;
        let is_due = recorded.is_none_or(|recorded| {
            let limit = recorded.saturating_add(LEAST - self.shift);
            let is_back = self
                .used
                .is_some_and(|used| front.host() < used.saturating_add(-LEAST));
            !self.is_in_doubt() && front.host() <= limit && !is_back
        });
        let is_overdue = self.frames.len() > MAX_FRAMES || self.blocked > MAX_BLOCKED;
        if !is_due && !is_overdue {
            return None;
        }
        self.blocked = 0;
        let frame = self.frames.pop_front()?;
        self.used = Some(frame.host());
        Some(frame)
    }
}
