//! Density and evenness of points, as `velomotion analyze` measures them.

use std::num::NonZeroUsize;

use analysis::density::{
    BinCounts, DensityError, Icosahedron, Locator, TOLERANCE_RAD, largest_hole,
};
use analysis::k::{self as ripley, Edges, FrameRotation, KCurve, KError, Sampling};
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use sim::patterns::{Pattern, PatternRequest};

use crate::binding_error::BindingError;
use crate::table::to_python;
use crate::work;

/// Farthest origin: map coordinates are nearer, and it keeps their millimetres.
const MAX_ORIGIN_M: f64 = 1e9;
/// Most bins of the K function, as `velomotion analyze` takes them.
const MAX_BINS: usize = 3_600;

/// Source of the measured directions.
enum DirectionSource {
    Pattern(String),
    /// Positions, metres from the scanner.
    Positions(Vec<[f64; 3]>),
}

/// Unit directions and their provenance.
struct FoundDirections {
    directions: Vec<DVec3>,
    /// Points at the origin, or without numbers.
    without_direction: usize,
    pattern: Option<Pattern>,
}

impl DirectionSource {
    fn new(source: &Bound<'_, PyAny>, origin: Option<[f64; 3]>) -> PyResult<Self> {
        let py = source.py();
        if origin.is_some_and(|origin| !origin.iter().all(|axis| axis.abs() <= MAX_ORIGIN_M)) {
            let what = format!("origin: expected three numbers up to {MAX_ORIGIN_M:e} m");
            return Err(BindingError::usage(what).into_py(py));
        }
        let wrong = || {
            BindingError::usage(
                "source: expected the name of a pattern, an array of shape (n, 3), or one with fields x, y, z",
            )
            .into_py(py)
        };
        if let Ok(name) = source.extract::<String>() {
            if origin.is_some() {
                let what = "origin: it is for points; patterns know where theirs is";
                return Err(BindingError::usage(what).into_py(py));
            }
            return Ok(Self::Pattern(name));
        }
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("asarray", (source,));
        let array = array.map_err(|_| wrong())?;
        let columns = match array.getattr("dtype")?.getattr("names")?.is_none() {
            true => array,
            false => {
                let column = |name: &str| array.get_item(name).map_err(|_| wrong());
                let columns = (column("x")?, column("y")?, column("z")?);
                numpy.call_method1("column_stack", (columns,))?
            }
        };
        // Columns of packed rows are not aligned.
        let rows = numpy.call_method1("require", (columns, "f8", "CA"));
        let rows: PyReadonlyArray2<'_, f64> =
            rows.and_then(|rows| rows.extract()).map_err(|_| wrong())?;
        let rows = rows.as_array();
        if rows.ncols() != 3 {
            return Err(wrong());
        }
        let [x, y, z] = origin.unwrap_or_default();
        let rows = rows.rows().into_iter();
        let positions = rows.map(|row| [row[0] - x, row[1] - y, row[2] - z]);
        Ok(Self::Positions(positions.collect()))
    }

    fn directions(self) -> Result<FoundDirections, BindingError> {
        let found = match self {
            Self::Pattern(name) => {
                let pattern = PatternRequest::parse(&name).and_then(|request| request.build());
                let pattern =
                    pattern.map_err(|error| BindingError::usage(format!("source: {error}")))?;
                FoundDirections {
                    directions: pattern.directions(),
                    without_direction: 0,
                    pattern: Some(pattern),
                }
            }
            Self::Positions(positions) => {
                let points = positions.len();
                let places = positions.into_iter().map(DVec3::from_array);
                let places = places.filter(|place| place.is_finite());
                // Scaling first avoids overflow and underflow of the squares.
                let direction = |place: DVec3| (place / place.abs().max_element()).try_normalize();
                let directions: Vec<DVec3> = places.filter_map(direction).collect();
                FoundDirections {
                    without_direction: points - directions.len(),
                    directions,
                    pattern: None,
                }
            }
        };
        match found.directions.is_empty() {
            true => Err(BindingError::usage("source: no point that has a direction")),
            false => Ok(found),
        }
    }
}

/// Points per bin of the sphere, and the largest hole between them.
///
/// Parameters
/// ----------
/// source : str or array
///     A scan pattern such as "velomotion16:50" (names and options: the book's page Scan patterns),
///     positions of shape (n, 3) in m, or a structured array with fields x, y, z such as read
///     gives.
/// level : int
///     Cuts of the icosahedron whose faces are the bins: 20 x 4^level bins, 0 to 8.
/// origin : sequence of 3 floats, optional
///     Position of the scanner among the points, m.
///
/// Returns
/// -------
/// dict
///     points, without_direction; density: statistics of the points per bin (min, mean, max, sd,
///     empty and others); hole: radius_deg, at_most_deg and centre of the largest circle without a
///     point; counts: array (bins,) u8 of points per bin; centres: array (bins, 3) f8 of unit
///     vectors, x right, y along the tilt axis, z up.
#[pyfunction]
#[pyo3(signature = (source, *, level=4, origin=None))]
pub(crate) fn density<'py>(
    py: Python<'py>,
    source: &Bound<'py, PyAny>,
    level: u32,
    origin: Option<[f64; 3]>,
) -> PyResult<Bound<'py, PyAny>> {
    let source = DirectionSource::new(source, origin)?;
    let (report, counts, centres) = work::run(py, move |_| {
        let found = source.directions()?;
        let wrong = |error: DensityError| BindingError::usage(error.to_string());
        let icosahedron = Icosahedron::new(level).map_err(wrong)?;
        let counts = BinCounts::new(&Locator::new(&icosahedron), &found.directions);
        let counts = counts.map_err(wrong)?;
        let hole = largest_hole(&found.directions, TOLERANCE_RAD).map_err(wrong)?;
        let hole = hole.map(|largest| {
            json!({
                "radius_deg": largest.hole.radius_rad.to_degrees(),
                "at_most_deg": largest.bound_rad.to_degrees(),
                "centre": largest.hole.centre.to_array(),
            })
        });
        let report = json!({
            "points": found.directions.len(),
            "without_direction": found.without_direction,
            "level": level,
            "density": counts.statistics(),
            "hole": hole,
        });
        let centres = icosahedron
            .bins()
            .iter()
            .map(|bin| bin.centre.to_array().to_vec());
        Ok((
            report,
            counts.by_bin().to_vec(),
            centres.collect::<Vec<_>>(),
        ))
    })?;
    let report = to_python(py, &report)?;
    report.set_item("counts", PyArray1::from_vec(py, counts))?;
    report.set_item("centres", PyArray2::from_vec2(py, &centres)?)?;
    Ok(report)
}

/// Ripley's K function of directions: whether points cluster, by the angle between them.
///
/// Parameters
/// ----------
/// source : str or array
///     As in density.
/// bins : int
///     Bins of angle from 0 to 180 deg, 1 to 3600.
/// error : float
///     Tolerated error as a share of all pairs, which selects the cheapest sufficient method; 0
///     counts every pair.
/// origin : sequence of 3 floats, optional
///     Position of the scanner among the points, m.
///
/// Returns
/// -------
/// dict
///     theta_deg: array (bins,), upper end of each bin; d: array (bins,), (K - K_csr) / (4 pi R2),
///     the excess share of all pairs within that angle over randomness (above 0 points cluster);
///     k_minus_csr: array (bins,), on a sphere of 1 m, m2; d_error_bound; risk, the probability
///     that the bound does not hold; method; points; on_edges, pairs on the edge of two bins within
///     rounding. A single point has empty arrays.
#[pyfunction]
#[pyo3(signature = (source, *, bins=151, error=1e-4, origin=None))]
pub(crate) fn k<'py>(
    py: Python<'py>,
    source: &Bound<'py, PyAny>,
    bins: usize,
    error: f64,
    origin: Option<[f64; 3]>,
) -> PyResult<Bound<'py, PyDict>> {
    let wrong = |what| Err(BindingError::usage(what).into_py(py));
    if !(0.0..1.0).contains(&error) {
        return wrong("error: expected a share from 0 (every pair is counted) to below 1");
    }
    if !(1..=MAX_BINS).contains(&bins) {
        return wrong("bins: expected 1 to 3600");
    }
    let source = DirectionSource::new(source, origin)?;
    let (estimate, curve) = work::run(py, move |_| {
        let found = source.directions()?;
        let wrong = |error: KError| BindingError::usage(error.to_string());
        let edges = Edges::equal(bins).map_err(wrong)?;
        let rotation = found.pattern.as_ref().and_then(Pattern::frame_rotation);
        let rotation = rotation.filter(|rotation| rotation.frames > 1);
        let rotation = rotation.map(|rotation| FrameRotation {
            axis: rotation.axis,
            step_rad: rotation.step_rad,
            frames: rotation.frames as usize,
        });
        let sampling = Sampling {
            tolerance: error,
            ..Sampling::default()
        };
        let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let directions = &found.directions;
        let estimate = ripley::estimate(directions, rotation.as_ref(), &edges, &sampling, threads);
        let estimate = estimate.map_err(wrong)?;
        let curve = KCurve::new(&estimate, 1.0);
        Ok((estimate, curve))
    })?;
    let report = PyDict::new(py);
    let theta_deg = curve.theta_rad.iter().map(|theta| theta.to_degrees());
    report.set_item("method", estimate.method)?;
    report.set_item("points", estimate.points)?;
    report.set_item("theta_deg", PyArray1::from_vec(py, theta_deg.collect()))?;
    report.set_item("d", PyArray1::from_vec(py, curve.d))?;
    report.set_item("k_minus_csr", PyArray1::from_vec(py, curve.k_minus_csr_m2))?;
    report.set_item("d_error_bound", curve.d_error_bound)?;
    report.set_item("risk", estimate.risk)?;
    report.set_item("on_edges", estimate.on_edges)?;
    Ok(report)
}
