//! What `analyze` says, as JSON for programs.
//!
//! Left out: the same for people (`text`).

use analysis::density::{BinCounts, EmptyBand, HistogramClass, HoleRow, Statistics};
use analysis::device::VisibleRange;
use analysis::k::KCurve;
use serde::Serialize;

use super::view::Seen;

/// All that was asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnalyzeReport {
    /// One entry a pattern, cloud or log, in the order asked for.
    pub patterns: Vec<PatternReport>,
}

/// Of one pattern, cloud or log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternReport {
    /// Its name as it was asked for.
    pub name: String,
    /// Points that have a direction.
    pub points: u64,
    /// Turns of the lidar; null where they are not known.
    pub frames: Option<u64>,
    /// How long the scan takes, seconds; null where it is not known.
    pub scan_s: Option<f64>,
    /// Points in the origin, left out.
    pub without_direction: u64,
    /// Rows whose coordinates are no numbers, left out.
    pub without_numbers: u64,
    /// What the scan can see, of patterns and logs; null where nothing tells.
    pub view: Option<Seen>,
    /// Points a bin, of all bins.
    pub density: Density,
    /// The same of bins with their middle in view; null where the view is not known.
    pub density_in_view: Option<BinReport>,
    /// The largest circle without a point, anywhere.
    pub hole: HoleReport,
    /// The largest with its middle where the scan can see at all; null where the view is not known.
    pub hole_in_view: Option<HoleReport>,
    /// How far it is to the nearest point, from directions in view; where that is not known from all directions.
    pub gaps: GapReport,
    /// Blind spots.
    pub blind: Blind,
    /// How evenly points lie, by the angles between them.
    pub k: KReport,
    /// What may mislead.
    pub warnings: Vec<String>,
    /// What the mount makes of the sensor; only where it is tilted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<DeviceReport>,
}

/// Points a bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Density {
    /// What their numbers are like.
    #[serde(flatten)]
    pub bins: BinReport,
    /// How often the icosahedron is cut.
    pub level: u32,
    /// Bins by their points.
    pub histogram: Vec<HistogramClass>,
    /// Points in each, for figures.
    #[serde(skip)]
    pub counts: BinCounts,
}

/// What the numbers of points in some bins are like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinReport {
    /// Mean, standard deviation and so on.
    #[serde(flatten)]
    pub statistics: Statistics,
    /// Standard deviation over mean; null without a point.
    pub sd_over_mean: Option<f64>,
    /// The share of them that hold a point; null where there are none.
    pub coverage: Option<f64>,
}

impl BinReport {
    /// Of these.
    #[must_use]
    pub fn new(statistics: Statistics) -> Self {
        Self {
            statistics,
            sd_over_mean: statistics.sd_over_mean(),
            coverage: statistics.coverage(),
        }
    }
}

/// The largest circle without a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HoleReport {
    /// Its radius, degrees.
    pub radius_deg: f64,
    /// No such circle is larger than this, degrees.
    pub at_most_deg: f64,
    /// The direction of its middle: x right, y along the tilt axis, z up.
    pub centre: [f64; 3],
    /// The angle of its middle from the tilt axis (+y), degrees.
    pub from_axis_deg: f64,
}

/// Ripley's K function beside that of points at random: above 0 points cluster, below they keep apart. `k_minus_csr` is K - K_csr on a sphere of `radius_m`, square metres; `d` is
/// the same over the area of the sphere, whatever its radius: so much larger is the share of all pairs that are within an angle. Null without pairs: of a single point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KReport {
    /// How pairs were counted: exact, turned (exact, too), sampled, gridded or harmonics.
    pub method: &'static str,
    /// Bins.
    pub bins: usize,
    /// The radius of the sphere that square metres are of: 1.
    pub radius_m: f64,
    /// How far any of `k_minus_csr` may be off, square metres: 0 for exact counts; null where it is not known.
    pub error_bound: Option<f64>,
    /// The upper end of each bin, degrees.
    pub theta_deg: Vec<f64>,
    /// K - K_csr there, square metres.
    pub k_minus_csr: Option<Vec<f64>>,
    /// The largest of them, whatever its sign.
    pub max_abs: Option<f64>,
    /// How far any of `d` may be off; null where it is not known.
    pub d_error_bound: Option<f64>,
    /// D = (K - K_csr) / (4 pi R2), a share.
    pub d: Option<Vec<f64>>,
    /// The largest D.
    pub d_max: Option<f64>,
    /// The smallest.
    pub d_min: Option<f64>,
    /// Pairs that lie on an edge between two bins within rounding: counted, of samples estimated; null where the method cannot tell. They count to the smaller angle.
    pub on_edges: Option<u64>,
    /// All of it, for figures.
    #[serde(skip)]
    pub curve: KCurve,
}

/// How far it is to the nearest point, from the middles of bins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapReport {
    /// Of which bins: those in `view`, or `all`.
    pub of: &'static str,
    /// From half of them it is at most this, degrees.
    pub median_deg: f64,
    /// From 99 % of them.
    pub of_99_percent_deg: f64,
}

/// Holes in view that are larger than what 99 % of directions have to the nearest point, and bands about the tilt axis that no point comes into.
/// Without a known view holes are not told apart from what the scan could not see: all of them are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blind {
    /// The least radius of the holes counted, degrees.
    pub least_radius_deg: Option<f64>,
    /// How many holes there are, no middle in a larger one.
    pub holes: Option<usize>,
    /// Whether there are more than were counted.
    pub and_more: Option<bool>,
    /// The rows that they stand in about the tilt axis, by angle.
    pub rows: Option<Vec<HoleRow>>,
    /// Bands of at least `BAND_DEG` about the tilt axis without a point.
    pub bands: Vec<EmptyBand>,
    /// Whether they hold no point at any speed of the axis: so with patterns of a sensor on it.
    pub bands_at_any_speed: bool,
}

/// What the mount makes of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeviceReport {
    /// Ranges and fields of view.
    #[serde(flatten)]
    pub view: VisibleRange,
    /// The paper's mean vertical resolution: the field of view, of tilt and lasers, shared by lasers times turns.
    pub mean_vertical_resolution_deg: f64,
    /// What the axis tilts in a turn of the lidar.
    pub tilt_per_turn_deg: f64,
}

/// The least width of a band, degrees.
pub const BAND_DEG: f64 = 0.1;
