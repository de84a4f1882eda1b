//! First pass over the records: arrival times of lidar packets, shaft samples and acknowledged
//! writes of the drive.

use drive::cia402::mode;
use drive::objects::{self, Address};
use drive::record::{DriveLink, Record, Wire};
use drive::{DriveListener, Observation, ShaftSample};
use lidar::{Options, Timekeeper};
use units::{Gearing, Host, Span, Stamp};

use crate::clock::Arrival;
use crate::clock_steps::{ClockStep, ClockSteps, HostTimeline, Timeline};
use crate::config::ScanConfig;
use crate::error::ScanError;
use crate::receive_order::ReceiveOrder;
use crate::sweeps::MoveWatch;

/// First pass: collects what the records show about time and tilt.
pub struct Survey {
    gearing: Gearing,
    reader: RecordReader,
    arrivals: Vec<Arrival>,
    samples: Vec<ShaftSample>,
    /// Objects of moves that were written to the drive or read back.
    accesses: Vec<SettingAccess>,
    clock_steps: ClockSteps,
    receive_order: ReceiveOrder,
    link: Option<DriveLink>,
}

/// An access to an object of the drive.
struct SettingAccess {
    address: Address,
    value: u32,
    request: Stamp<Host>,
    is_write: bool,
}

/// The contents of the drive's records, with all stamps on one host clock.
pub(crate) struct ShaftRecords {
    pub gearing: Gearing,
    pub samples: Vec<ShaftSample>,
    pub moves: MoveWatch,
}

impl Survey {
    /// A survey of a log written with `config`.
    ///
    /// # Errors
    /// [`ScanError::Gearing`] if a number of the configured gearing is zero.
    pub fn new(config: &ScanConfig, options: Options) -> Result<Self, ScanError> {
        Ok(Self {
            gearing: config.axis.gearing()?,
            reader: RecordReader::new(config, options),
            arrivals: Vec::new(),
            samples: Vec::new(),
            accesses: Vec::new(),
            clock_steps: ClockSteps::default(),
            receive_order: ReceiveOrder::default(),
            link: None,
        })
    }

    /// Takes one record.
    pub fn observe(&mut self, record: &Record<'_>) {
        match record.wire {
            Wire::Lidar { payload, .. } => {
                let host = self.receive_order.distinct(record.host);
                if let Some(arrival) = self.reader.packet(host, payload) {
                    self.clock_steps.packet(arrival.device.as_nanos(), host);
                    self.arrivals.push(arrival);
                }
            }
            Wire::Drive { link, .. } => {
                self.link = Some(link);
                let host = self.clock_steps.monotonic(record.host);
                self.reader
                    .frame(host, &record.wire, &mut |seen| match seen {
                        Observation::Sample(sample) => {
                            self.samples.push(sample);
                            self.clock_steps.sample();
                        }
                        Observation::Wrote {
                            address,
                            value,
                            request,
                            ..
                        } => self.accesses.push(SettingAccess {
                            address,
                            value,
                            request,
                            is_write: true,
                        }),
                        Observation::Read {
                            address,
                            value,
                            request,
                            ..
                        } if MoveWatch::reads(address) => self.accesses.push(SettingAccess {
                            address,
                            value,
                            request,
                            is_write: false,
                        }),
                        _ => {}
                    });
            }
        }
    }

    /// Steps of the clocks that the records show; empty without packets of a lidar.
    #[must_use]
    pub fn steps(&self) -> Vec<ClockStep> {
        self.timeline()
            .map_or(Vec::new(), |timeline| timeline.steps)
    }

    /// Link to the drive and number of shaft samples; `None` without traffic of a drive.
    #[must_use]
    pub fn drive(&self) -> Option<(DriveLink, u64)> {
        self.link.map(|link| (link, self.samples.len() as u64))
    }

    pub(crate) fn timeline(&self) -> Option<Timeline> {
        Timeline::new(&self.arrivals, &self.samples, &self.clock_steps)
    }

    /// The packets as they were recorded.
    pub(crate) fn take_arrivals(&mut self) -> Vec<Arrival> {
        core::mem::take(&mut self.arrivals)
    }

    /// The drive's records, on the host clock as it was at the beginning.
    pub(crate) fn into_shaft_records(mut self, timeline: &HostTimeline) -> ShaftRecords {
        timeline.convert(&mut self.samples);
        let mut moves = MoveWatch::new(self.gearing);
        for access in self.accesses {
            let host = timeline.host(access.request);
            match access.is_write {
                true => moves.wrote(access.address, access.value, host),
                false => moves.read(access.address, access.value, host),
            }
        }
        ShaftRecords {
            gearing: self.gearing,
            samples: self.samples,
            moves,
        }
    }
}

/// Reads times and angles from records, for the first pass and for the live cloud.
pub(crate) struct RecordReader {
    timekeeper: Timekeeper,
    listener: DriveListener,
    request_transmission_time: Span,
    /// The drive homes: its positions may lose their zero at any time.
    is_homing: bool,
}

impl RecordReader {
    pub(crate) fn new(config: &ScanConfig, options: Options) -> Self {
        Self {
            timekeeper: Timekeeper::new(options),
            listener: DriveListener::new(config.axis.node),
            request_transmission_time: config.request_transmission_time(),
            is_homing: false,
        }
    }

    /// The arrival of a lidar packet; `None` for other datagrams.
    pub(crate) fn packet(&mut self, host: Stamp<Host>, payload: &[u8]) -> Option<Arrival> {
        let timing = self.timekeeper.packet(host, payload)?;
        Some(Arrival {
            device: timing.first_firing,
            host: host.saturating_add(-timing.fill),
        })
    }

    /// Passes on what a frame of the drive completes, stamped `host`.
    pub(crate) fn frame(
        &mut self,
        host: Stamp<Host>,
        wire: &Wire<'_>,
        emit: &mut impl FnMut(Observation),
    ) {
        let Wire::Drive {
            link,
            direction,
            frame,
        } = *wire
        else {
            return;
        };
        // The drive takes the position after it has the whole request.
        let transmission = self.request_transmission_time;
        let is_homing = &mut self.is_homing;
        self.listener
            .observe(link, direction, frame, host, &mut |mut seen| {
                match &mut seen {
                    Observation::Sample(_) if *is_homing => return,
                    Observation::Sample(sample) => {
                        sample.request = sample.answer.min(sample.request + transmission);
                    }
                    Observation::Wrote { address, value, .. }
                        if *address == objects::MODE.address =>
                    {
                        *is_homing = objects::MODE.decode(*value) == mode::HOMING;
                    }
                    // The log may lack the write.
                    Observation::Read { address, value, .. }
                        if *address == objects::MODE_DISPLAY.address =>
                    {
                        *is_homing = objects::MODE_DISPLAY.decode(*value) == mode::HOMING;
                    }
                    _ => {}
                }
                emit(seen);
            });
    }
}
