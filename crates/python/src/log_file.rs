//! Contents of a log, as arrays.

use std::path::PathBuf;

use drive::{DriveListener, Observation, SampleTrigger};
use engine::capture::completeness;
use engine::document::Document;
use engine::reconstruct::contents::read_contents;
use engine::reconstruct::decoder_options::{DecoderRequest, decoder_options};
use engine::reconstruct::scan_failure;
use engine::reconstruct::source::{SensorAddress, Source};
use lidar::{Options, Timekeeper};
use protocol::record::Wire;
use protocol::vlp16::DATA_LEN;
use pyo3::prelude::*;
use scanner::{Accuracy, Alignment, Survey, TiltSource};
use units::Span;

use crate::arguments::sensor;
use crate::binding_error::{BindingError, check_readable};
use crate::table::{RowField, Table, to_python};
use crate::work;

/// A recording or log, and what is in it.
///
/// Every method reads the file and gives a structured numpy array; times are whole nanoseconds
/// (Unix time of the recording host's clock, unless the name says otherwise).
///
/// Parameters
/// ----------
/// path : str or os.PathLike
///     A pcap, pcapng or log of velomotion.
/// sensor : str, optional
///     ADDRESS or ADDRESS:PORT of the lidar, if there are several.
#[pyclass(module = "velomotion", name = "Log", frozen)]
pub(crate) struct LogFile {
    path: PathBuf,
    sensor: Option<SensorAddress>,
}

/// Fields of `packets`.
const PACKET: [RowField; 4] = [
    ("host_ns", "i8", 0),
    ("port", "u2", 8),
    ("length", "u2", 10),
    ("payload", "(1206,)u1", 12),
];
const PACKET_BYTES: usize = 12 + DATA_LEN;
/// Fields of `polls`.
const POLL: [RowField; 5] = [
    ("request_ns", "i8", 0),
    ("answer_ns", "i8", 8),
    ("angle_deg", "f8", 16),
    ("position_qc", "i4", 24),
    ("at_sync", "?", 28),
];
const POLL_BYTES: usize = 32;
/// Fields of `angles`.
const ANGLE: [RowField; 3] = [
    ("host_ns", "i8", 0),
    ("bound_ns", "i8", 8),
    ("angle_deg", "f8", 16),
];
const ANGLE_BYTES: usize = 24;
/// Fields of `sweeps`.
const SWEEP: [RowField; 8] = [
    ("start_ns", "i8", 0),
    ("end_ns", "i8", 8),
    ("from_deg", "f8", 16),
    ("to_deg", "f8", 24),
    ("cruise_deg_s", "f8", 32),
    ("commanded_deg_s", "f8", 40),
    ("acceleration_deg_s2", "f8", 48),
    ("deceleration_deg_s2", "f8", 56),
];
const SWEEP_BYTES: usize = 64;
/// Fields of `clocks`.
const CLOCK: [RowField; 4] = [
    ("device_ns", "i8", 0),
    ("received_ns", "i8", 8),
    ("host_ns", "i8", 16),
    ("bound_ns", "i8", 24),
];
const CLOCK_BYTES: usize = 32;

impl LogFile {
    fn open(&self) -> Result<Source, BindingError> {
        check_readable(&self.path)?;
        Ok(Source::open(&self.path, self.sensor)?)
    }
}

/// An opener for the thread that works.
fn opener(log: &LogFile) -> impl FnOnce() -> Result<Source, BindingError> + Send + 'static {
    let log = LogFile {
        path: log.path.clone(),
        sensor: log.sensor,
    };
    move || log.open()
}

/// First pass of a reconstruction.
fn align(source: &Source, tilt: &TiltSource, options: Options) -> Result<Alignment, BindingError> {
    let config = source.config()?;
    let failed = |link| move |error| scan_failure(source.path(), link, &error);
    let mut survey = Survey::new(&config, options).map_err(failed(None))?;
    source.read(|record| {
        survey.observe(record);
        Ok(())
    })?;
    let link = survey.drive().map(|drive| drive.0);
    Ok((survey.solve(&config, tilt, Accuracy::Best)).map_err(failed(link))?)
}

fn options(source: &Source) -> Result<Options, BindingError> {
    Ok(decoder_options(&DecoderRequest::default(), source)?)
}

#[pymethods]
impl LogFile {
    #[new]
    #[pyo3(signature = (path, *, sensor=None))]
    fn new(py: Python<'_>, path: PathBuf, sensor: Option<&str>) -> PyResult<Self> {
        let open = || {
            let log = Self {
                path,
                sensor: self::sensor(sensor)?,
            };
            log.open()?;
            Ok(log)
        };
        open().map_err(|error: BindingError| error.into_py(py))
    }

    fn __repr__(&self) -> String {
        format!("velomotion.Log({:?})", self.path.display().to_string())
    }

    /// Lists what the recording holds: the object of velomotion info --json, as a dict.
    ///
    /// Its key incomplete says what is missing, or is None.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let (report, missing) = work::run(py, move |_| {
            let source = open()?;
            let report = read_contents(&source, options(&source)?)?;
            let missing = report.incomplete_sweeps.iter().cloned();
            let missing = missing.chain(completeness::missing_packets(&report.contents));
            let missing: Vec<_> = missing.chain(report.contents.truncated.clone()).collect();
            let missing = (!missing.is_empty()).then(|| missing.join(", and "));
            Ok((report.to_json(), missing))
        })?;
        let report = to_python(py, &report)?;
        report.set_item("incomplete", missing)?;
        Ok(report)
    }

    /// The lidar's datagrams of up to 1206 bytes, in the order of the file.
    ///
    /// Fields: host_ns (i8), receive time; port (u2), destination; length (u2), bytes; payload
    /// (u1, 1206), zero beyond length.
    fn packets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let table = work::run(py, move |_| {
            let mut bytes = Vec::new();
            open()?.read(|record| {
                if let Wire::Lidar { port, payload, .. } = record.wire
                    && payload.len() <= DATA_LEN
                {
                    let end = bytes.len() + PACKET_BYTES;
                    bytes.extend(record.host.as_nanos().to_ne_bytes());
                    bytes.extend(port.to_ne_bytes());
                    bytes.extend((payload.len() as u16).to_ne_bytes());
                    bytes.extend_from_slice(payload);
                    bytes.resize(end, 0);
                }
                Ok(())
            })?;
            Ok(Table {
                fields: &PACKET,
                row_bytes: PACKET_BYTES,
                bytes,
            })
        })?;
        table.into_numpy(py)
    }

    /// The drive's positions as they were polled, from homing to the end.
    ///
    /// Fields: request_ns (i8), when the request was sent; answer_ns (i8), when the answer was
    /// complete; angle_deg (f8), by the gear, before homing from an unknown zero; position_qc (i4),
    /// quadcounts of the encoder; at_sync (bool), sampled at a SYNC of a CAN bus instead of between
    /// the two times. Empty without a drive.
    fn polls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let table = work::run(py, move |_| {
            let source = open()?;
            let config = source.config()?;
            let gearing = config.axis.gearing();
            let gearing = gearing.map_err(|error| BindingError::usage(error.to_string()))?;
            let mut listener = DriveListener::new(config.axis.node);
            let mut bytes = Vec::new();
            source.read(|record| {
                let Wire::Drive {
                    link,
                    direction,
                    frame,
                } = record.wire
                else {
                    return Ok(());
                };
                listener.observe(link, direction, frame, record.host, &mut |seen| {
                    if let Observation::Sample(sample) = seen {
                        bytes.extend(sample.request.as_nanos().to_ne_bytes());
                        bytes.extend(sample.answer.as_nanos().to_ne_bytes());
                        bytes.extend(gearing.angle(sample.position).0.to_ne_bytes());
                        bytes.extend(sample.position.0.to_ne_bytes());
                        let at_sync = sample.trigger == SampleTrigger::Sync;
                        bytes.extend([u8::from(at_sync), 0, 0, 0]);
                    }
                });
                Ok(())
            })?;
            Ok(Table {
                fields: &POLL,
                row_bytes: POLL_BYTES,
                bytes,
            })
        })?;
        table.into_numpy(py)
    }

    /// The tilt angles that a reconstruction uses: polls without slow and implausible ones.
    ///
    /// Fields: host_ns (i8); bound_ns (i8), the angle held within this time of host_ns; angle_deg
    /// (f8).
    fn angles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let table = work::run(py, move |_| {
            let source = open()?;
            let alignment = align(&source, &TiltSource::Log, options(&source)?)?;
            let samples = alignment.trajectory.samples().iter();
            let rows = samples.flat_map(|sample| {
                [
                    sample.host.as_nanos().to_ne_bytes(),
                    sample.bound.as_nanos().to_ne_bytes(),
                    sample.angle.0.to_ne_bytes(),
                ]
            });
            Ok(Table {
                fields: &ANGLE,
                row_bytes: ANGLE_BYTES,
                bytes: rows.flatten().collect(),
            })
        })?;
        table.into_numpy(py)
    }

    /// The sweeps of the axis.
    ///
    /// Fields: start_ns, end_ns (i8), the last sample at rest before and the first after; from_deg,
    /// to_deg (f8); cruise_deg_s (f8), measured speed, negative while the angle falls;
    /// commanded_deg_s, acceleration_deg_s2, deceleration_deg_s2 (f8), zero if the log lacks the
    /// command.
    fn sweeps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let table = work::run(py, move |_| {
            let source = open()?;
            let alignment = align(&source, &TiltSource::Log, options(&source)?)?;
            let rows = alignment.sweeps.iter().flat_map(|sweep| {
                let commanded = sweep.commanded;
                [
                    sweep.start.as_nanos().to_ne_bytes(),
                    sweep.end.as_nanos().to_ne_bytes(),
                    sweep.from.0.to_ne_bytes(),
                    sweep.to.0.to_ne_bytes(),
                    sweep.cruise.0.to_ne_bytes(),
                    commanded.speed.0.to_ne_bytes(),
                    commanded.acceleration.0.to_ne_bytes(),
                    commanded.deceleration.0.to_ne_bytes(),
                ]
            });
            Ok(Table {
                fields: &SWEEP,
                row_bytes: SWEEP_BYTES,
                bytes: rows.flatten().collect(),
            })
        })?;
        table.into_numpy(py)
    }

    /// The lidar's clock and the host's, a row per data packet.
    ///
    /// Fields: device_ns (i8), first firing by the lidar's clock; received_ns (i8), receive time
    /// less the time that the lidar takes to fill the packet; host_ns (i8), device_ns by the fitted
    /// clock; bound_ns (i8), error bound of host_ns. received_ns - host_ns is the packet's delay.
    /// If the host's clock was set during the recording (`info` shows it), host_ns is by the clock
    /// before that, and received_ns as recorded.
    fn clocks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let open = opener(self);
        let table = work::run(py, move |_| {
            let source = open()?;
            let options = options(&source)?;
            let alignment = align(&source, &TiltSource::None, options.clone())?;
            let mut timekeeper = Timekeeper::new(options);
            let mut bytes = Vec::new();
            source.read(|record| {
                if let Wire::Lidar { payload, .. } = record.wire
                    && let Some(timing) = timekeeper.packet(record.host, payload)
                {
                    let device = timing.first_firing;
                    let fill = Span::from_nanos(-timing.fill.as_nanos());
                    let moment = alignment.clock.moment_near(device, Some(record.host));
                    for nanos in [
                        device.as_nanos(),
                        record.host.saturating_add(fill).as_nanos(),
                        moment.host.as_nanos(),
                        alignment.clock.bound_at(device).as_nanos(),
                    ] {
                        bytes.extend(nanos.to_ne_bytes());
                    }
                }
                Ok(())
            })?;
            Ok(Table {
                fields: &CLOCK,
                row_bytes: CLOCK_BYTES,
                bytes,
            })
        })?;
        table.into_numpy(py)
    }
}
