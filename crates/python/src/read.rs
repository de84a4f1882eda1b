//! Recordings to arrays of points.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points, Sink, SinkError, TiltTrack};
use engine::capture::completeness;
use engine::reconstruct::decoder_options::{DecoderRequest, decoder_options};
use engine::reconstruct::replay::{self, Reconstruction, TimeReference};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::{SensorAddress, Source};
use pyo3::prelude::*;
use scanner::{Accuracy, TiltSource};
use units::Degrees;

use crate::arguments::{
    MountArgument, TiltArgument, decoder_request, mount_for, sensor, time_reference,
};
use crate::binding_error::{BindingError, check_readable, warn};
use crate::frames::FrameIterator;
use crate::rows::{PointLayout, PointRows};
use crate::table::{row_type, to_numpy};
use crate::work;

/// A recording to read.
pub(crate) struct ReadRequest {
    path: PathBuf,
    tilt: TiltArgument,
    mount: Option<MountArgument>,
    sensor: Option<SensorAddress>,
    decoder: DecoderRequest,
    time: TimeReference,
    has_sd: bool,
}

impl ReadRequest {
    /// Reads the recording into a sink, which gets the ends of revolutions at an azimuth if there
    /// is one.
    pub fn read(
        self,
        cut: Option<Degrees>,
        sink: &mut dyn Sink,
        interrupt: &AtomicBool,
    ) -> Result<Findings, BindingError> {
        check_readable(&self.path)?;
        let mut source = Source::open(&self.path, self.sensor)?;
        let tilt = self.tilt.resolve(&source)?;
        if let (TiltSource::Table(_), true) = (&tilt, self.has_sd) {
            return Err(BindingError::usage(
                "fields: no sd with a table of angles, of which nothing says how accurate they are",
            ));
        }
        if let Some(mount) = mount_for(self.mount.as_ref(), &tilt, &source)? {
            source.set_mount(mount);
        }
        if let Some(file) = &self.decoder.calibration {
            check_readable(file)?;
        }
        let is_table = matches!(tilt, TiltSource::Table(_));
        let request = Reconstruction {
            tilt,
            options: decoder_options(&self.decoder, &source)?,
            time: self.time,
            ..Reconstruction::of_log(&source, Accuracy::Best, interrupt)?
        };
        let output = Path::new("the array");
        let report: ScanReport = match cut {
            None => replay::scan(&request, sink, output)?,
            Some(cut) => replay::scan_by_revolution(&request, cut, sink, output)?,
        };
        let mut warnings = report.contents.warnings.clone();
        // The sweeps of a log have their ends; a table has those of another program.
        if is_table && report.left_out > 0 {
            let (out, all) = (report.left_out, report.left_out + report.points);
            let why = report.left_out_because.as_deref().unwrap_or("left out");
            warnings.push(format!("{out} of {all} returns were omitted: {why}"));
        }
        let named = |what: String| format!("{}: {what}", self.path.display());
        Ok(Findings {
            missing: completeness::missing(&report).map(|missing| named(missing.to_string())),
            // Incomplete sweeps are among what is missing.
            warnings: warnings
                .into_iter()
                .filter(|warning| !report.incomplete_sweeps.contains(warning))
                .map(named)
                .collect(),
        })
    }
}

/// What a reader should know about a recording, besides its points.
pub(crate) struct Findings {
    missing: Option<String>,
    warnings: Vec<String>,
}

impl Findings {
    /// Warns of them.
    pub fn warn(self, py: Python<'_>) -> PyResult<()> {
        for warning in &self.warnings {
            warn(py, "RecordingWarning", warning)?;
        }
        match self.missing {
            Some(missing) => warn(py, "IncompleteWarning", &missing),
            None => Ok(()),
        }
    }
}

/// Collects all points.
struct CloudRows(PointRows);

impl Sink for CloudRows {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.0.add(batch);
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.0.layout().columns()
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.0.set_mount(track.mount);
        Ok(())
    }
}

/// The arguments that `read` and `frames` share.
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
fn request(
    py: Python<'_>,
    path: PathBuf,
    tilt: Option<&Bound<'_, PyAny>>,
    mount: Option<&Bound<'_, PyAny>>,
    sensor_name: Option<&str>,
    model: Option<&str>,
    calibration: Option<PathBuf>,
    time: &str,
    equal_returns: &str,
    fields: Option<Vec<String>>,
) -> PyResult<(ReadRequest, PointLayout)> {
    let (tilt, mount) = (TiltArgument::new(tilt)?, MountArgument::new(mount)?);
    let checked = || {
        let layout = PointLayout::new(fields.as_deref())?;
        let request = ReadRequest {
            path,
            tilt,
            mount,
            sensor: sensor(sensor_name)?,
            decoder: decoder_request(model, calibration, equal_returns)?,
            time: time_reference(time)?,
            has_sd: layout.has_sd(),
        };
        Ok((request, layout))
    };
    checked().map_err(|error: BindingError| error.into_py(py))
}

/// Reads a recording as one array, a row per return.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
///     A pcap or pcapng with lidar packets, or a log of velomotion.
/// tilt : "log", "none", path or array of shape (n, 2), optional
///     Tilt angles: the log's own, none, or a table of times (s: Unix time, or since the first
///     packet) and angles (deg). By default the log's if it has a drive, else none.
/// mount : path or float, optional
///     Mount of the tilted lidar: a TOML file with [mount], as calibrate makes it, or the height
///     above the tilt axis (m). By default the log's.
/// sensor : str, optional
///     ADDRESS or ADDRESS:PORT of the lidar, if there are several.
/// model : "vlp16", "hi-res", "hdl32e" or "vlp32c", optional
///     Model, if the packets do not tell it.
/// calibration : path, optional
///     Calibration of the individual lidar: ROS YAML or TOML.
/// time : "host" or "utc"
///     Clock of the times: the recording host's, or the lidar's satellite receiver.
/// equal_returns : "once" or "twice"
///     Two equal returns of a pulse in dual return mode: one row or two.
/// fields : sequence of str, optional
///     Fields of a row, in this order. By default all but sd and device_time.
///
/// Returns
/// -------
/// numpy.ndarray of shape (returns,)
///     Its fields:
///
///     - x, y, z (f4): position, m: x right, y forward, z up. With tilt in the frame of the
///       platform's base, whose origin is on the tilt axis; without it in the lidar's own frame.
///     - range (f4): distance from the lidar's origin, m.
///     - azimuth (f4): direction in the lidar's frame, deg clockwise from its y seen from above, 0
///       to 360.
///     - tilt (f4): angle of the platform at the instant of the firing, deg.
///     - time (f8): instant of the firing, Unix time, s.
///     - intensity (u1): calibrated reflectivity, 0 to 255.
///     - ring (u1): by elevation, 0 the lowest.
///     - laser (u1): by firing order.
///     - echo (u1): 1 strongest, 2 last, 3 both, 4 second return, 0 unknown.
///     - sd (f4): expected error of the point, root mean square, m.
///     - device_time (f8): instant of the firing by the lidar's clock, s.
///
/// Warns
/// -----
/// IncompleteWarning
///     Packets or parts of sweeps are missing, or there is no point.
/// RecordingWarning
///     The recording contradicts itself or an argument, such as the model, or a table of angles
///     covers a part of it: what velomotion replay warns of.
///
/// The array is the memory that the points were written to. Other Python threads run meanwhile.
#[pyfunction]
#[pyo3(signature = (path, *, tilt=None, mount=None, sensor=None, model=None, calibration=None, time="host",
    equal_returns="once", fields=None))]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub(crate) fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    tilt: Option<&Bound<'py, PyAny>>,
    mount: Option<&Bound<'py, PyAny>>,
    sensor: Option<&str>,
    model: Option<&str>,
    calibration: Option<PathBuf>,
    time: &str,
    equal_returns: &str,
    fields: Option<Vec<String>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (request, layout) = request(
        py,
        path,
        tilt,
        mount,
        sensor,
        model,
        calibration,
        time,
        equal_returns,
        fields,
    )?;
    let row_type = row_type(py, &layout.fields, layout.row_bytes)?;
    let (bytes, findings) = work::run(py, move |interrupt| {
        let mut rows = CloudRows(PointRows::new(layout));
        let findings = request.read(None, &mut rows, interrupt)?;
        let mut bytes = rows.0.bytes;
        bytes.shrink_to_fit();
        Ok((bytes, findings))
    })?;
    findings.warn(py)?;
    to_numpy(bytes, &row_type)
}

/// Reads a recording revolution by revolution, in bounded memory.
///
/// Parameters
/// ----------
/// path, tilt, mount, sensor, model, calibration, time, equal_returns, fields
///     As in read.
/// cut : float
///     Azimuth at which a revolution ends, deg.
///
/// Returns
/// -------
/// Frames
///     An iterator of arrays as read gives them, one per revolution of the lidar that has points;
///     the first and the last are seldom whole. The next revolutions are read meanwhile. Its end
///     warns as read does.
#[pyfunction]
#[pyo3(signature = (path, *, tilt=None, mount=None, sensor=None, model=None, calibration=None, time="host",
    equal_returns="once", fields=None, cut=0.0))]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub(crate) fn frames<'py>(
    py: Python<'py>,
    path: PathBuf,
    tilt: Option<&Bound<'py, PyAny>>,
    mount: Option<&Bound<'py, PyAny>>,
    sensor: Option<&str>,
    model: Option<&str>,
    calibration: Option<PathBuf>,
    time: &str,
    equal_returns: &str,
    fields: Option<Vec<String>>,
    cut: f64,
) -> PyResult<FrameIterator> {
    let checked = check_readable(&path).and_then(|()| match cut.abs() <= 360.0 {
        true => Ok(()),
        false => Err(BindingError::usage(
            "cut: expected an azimuth from -360 to 360 deg",
        )),
    });
    checked.map_err(|error| error.into_py(py))?;
    let (request, layout) = request(
        py,
        path,
        tilt,
        mount,
        sensor,
        model,
        calibration,
        time,
        equal_returns,
        fields,
    )?;
    FrameIterator::start(py, request, layout, Degrees(cut))
}
