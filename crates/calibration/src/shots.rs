//! The measurements: shots of the lidar in its own frame, with the tilt of their instants.

use cloud::{Fields, MissingColumns, Points};
use units::{Host, Stamp};

/// Nominal direction and origin of a laser, as the scans were decoded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalLaser {
    /// Elevation, degrees.
    pub elevation_deg: f64,
    /// Height of the ray's origin above the lidar's, metres.
    pub vertical_offset_m: f64,
}

/// A shot with a return.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RangeShot {
    pub range_m: f64,
    /// Sine and cosine of the azimuth.
    pub azimuth: [f64; 2],
    pub tilt_rad: f64,
    pub rate_rad_s: f64,
    /// Seconds from the middle of the log.
    pub time_s: f64,
    pub laser: u8,
    /// Calibrated reflectivity as reported.
    pub reflectivity: u8,
    /// Number of its sweep, from 0.
    pub sweep: u16,
    /// Index of its point.
    pub point: u32,
}

/// The shots of one log, in order of time.
#[derive(Clone, Debug)]
pub struct Scan {
    pub(crate) shots: Vec<RangeShot>,
}

/// Error of a tilt angle, one standard deviation, radians: a step of the encoder of 0.0015 deg.
pub(crate) const TILT_SD_RAD: f64 = 0.0015 / 3.464 * std::f64::consts::PI / 180.0;
/// Error of an azimuth, one standard deviation, radians: steps of 0.01 deg in packets.
pub(crate) const AZIMUTH_SD_RAD: f64 = 0.01 / 3.464 * std::f64::consts::PI / 180.0;
/// Least time over which the rate of the tilt is taken.
const RATE_SPAN_NS: i64 = 4_000_000;
/// A longer gap separates sweeps.
const SWEEP_GAP_NS: i64 = 20_000_000;
/// The nearest return that counts: nearer ones are of the scanner's own frame.
const MIN_RANGE_M: f64 = 0.7;

impl Scan {
    /// Columns that the points need.
    pub const FIELDS: Fields = Fields::TIME
        .union(Fields::TILT)
        .union(Fields::LASER)
        .union(Fields::INTENSITY);

    /// The shots behind the points of a log, which were placed without mount
    /// ([`cloud::mount::Mount::new`] with 0) and without corrections of the lasers, in order of
    /// time.
    ///
    /// # Errors
    /// [`MissingColumns`] without time, tilt, laser and intensity.
    pub fn new(points: &Points, lasers: &[NominalLaser]) -> Result<Self, MissingColumns> {
        points.fields().require(Self::FIELDS)?;
        let times: Vec<i64> = points
            .time()
            .iter()
            .map(|t: &Stamp<Host>| t.as_nanos())
            .collect();
        let tilts = points.tilt_deg();
        let rates = rates_deg_s(&times, tilts);
        let middle = match (times.first(), times.last()) {
            (Some(first), Some(last)) => first + (last - first) / 2,
            _ => 0,
        };
        let mut shots = Vec::with_capacity(points.len());
        let mut sweep = 0_u16;
        let positions = points.x_m().iter().zip(points.y_m()).zip(points.z_m());
        for (index, ((&x, &y), &z)) in positions.enumerate() {
            let laser = points.laser()[index];
            if index > 0 && times[index] - times[index - 1] >= SWEEP_GAP_NS {
                sweep = sweep.saturating_add(1);
            }
            let Some(table) = lasers.get(usize::from(laser)) else {
                continue;
            };
            let tilt_rad = tilts[index].to_radians();
            let (sin, cos) = tilt_rad.sin_cos();
            // Back from the tilted frame into the lidar's.
            let (x, z) = (x * cos - z * sin, z * cos + x * sin);
            let horizontal = x.hypot(y);
            let range_m = horizontal.hypot(z - table.vertical_offset_m);
            if !(range_m > MIN_RANGE_M && horizontal > 0.0) {
                continue;
            }
            shots.push(RangeShot {
                range_m,
                azimuth: [x / horizontal, y / horizontal],
                tilt_rad,
                rate_rad_s: rates[index].to_radians(),
                time_s: (times[index] - middle) as f64 * 1e-9,
                laser,
                reflectivity: points.intensity()[index],
                sweep,
                point: index as u32,
            });
        }
        Ok(Self { shots })
    }

    /// Number of shots.
    #[must_use]
    pub fn len(&self) -> usize {
        self.shots.len()
    }

    /// Whether there is no shot.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shots.is_empty()
    }
}

/// Rate of the tilt at each time, from tilts some milliseconds apart in the same sweep.
fn rates_deg_s(times: &[i64], tilts_deg: &[f64]) -> Vec<f64> {
    let mut rates = vec![0.0; times.len()];
    let mut from = 0;
    while from < times.len() {
        let mut to = from + 1;
        while to < times.len() && times[to] - times[to - 1] < SWEEP_GAP_NS {
            to += 1;
        }
        let (mut low, mut high) = (from, from);
        for index in from..to {
            while low < index && times[index] - times[low] > RATE_SPAN_NS {
                low += 1;
            }
            while high + 1 < to && times[high] - times[index] < RATE_SPAN_NS {
                high += 1;
            }
            let span = times[high] - times[low];
            if span > 0 {
                rates[index] = (tilts_deg[high] - tilts_deg[low]) / (span as f64 * 1e-9);
            }
        }
        from = to;
    }
    rates
}

/// Standard deviation of each laser's ranges from the second differences of neighbouring shots,
/// which smooth surfaces hardly bend. `surface` numbers the surfaces of a log's shots; three
/// neighbours count if they are on one. A laser without keeps the value of `default_m`.
pub(crate) fn noise_m(
    scans: &[Scan],
    lasers: usize,
    surface: impl Fn(usize, usize) -> Option<u32>,
    default_m: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let mut differences: Vec<Vec<f64>> = vec![Vec::new(); lasers];
    for (log, scan) in scans.iter().enumerate() {
        let mut windows = vec![NeighbourWindow::default(); lasers];
        for (index, shot) in scan.shots.iter().enumerate() {
            let laser = usize::from(shot.laser);
            let difference = windows[laser].push(shot, surface(log, index));
            differences[laser].extend(difference);
        }
    }
    let each = differences.into_iter().enumerate().map(|(laser, mut all)| {
        all.sort_unstable_by(f64::total_cmp);
        let half = &all[..all.len() / 2];
        if half.len() < MIN_DIFFERENCES {
            return default_m(laser);
        }
        let mean = half.iter().sum::<f64>() / half.len() as f64;
        (mean / (HALF_MEAN * 6_f64.sqrt())).max(MIN_NOISE_M)
    });
    each.collect()
}

/// Noise of each laser by all its shots.
pub(crate) fn noise_of_all_m(scans: &[Scan], lasers: usize) -> Vec<f64> {
    noise_m(scans, lasers, |_, _| Some(0), |_| DEFAULT_NOISE_M)
}

/// The last shots of a laser.
#[derive(Clone, Debug, Default)]
struct NeighbourWindow {
    last: Option<(f64, f64, Option<u32>)>,
    before: Option<f64>,
}

impl NeighbourWindow {
    /// Adds a shot. Returns the second difference if three neighbours are on one surface.
    fn push(&mut self, shot: &RangeShot, surface: Option<u32>) -> Option<f64> {
        let is_neighbour = self.last.is_some_and(|(time, _, on)| {
            shot.time_s - time < MAX_NEIGHBOUR_S && surface.is_some() && on == surface
        });
        let last = self.last.map(|(_, range_m, _)| range_m);
        let difference = match (is_neighbour, self.before, last) {
            (true, Some(before), Some(last)) => Some((before - 2.0 * last + shot.range_m).abs()),
            _ => None,
        };
        self.before = last.filter(|_| is_neighbour);
        self.last = Some((shot.time_s, shot.range_m, surface));
        difference
    }
}

/// Mean of the lower half of |x| of a standard normal x: 4 (phi(0) - phi(0.6745)). Edges do not
/// move the lower half; a mean is finer than the steps of ranges, a median is not.
const HALF_MEAN: f64 = 0.324_663;
/// Fewest differences of a laser.
const MIN_DIFFERENCES: usize = 100;
/// Neighbouring shots of a laser are one or two firings apart.
const MAX_NEIGHBOUR_S: f64 = 250e-6;
/// The manual's accuracy, for a laser without neighbouring shots.
const DEFAULT_NOISE_M: f64 = 0.03;
/// Rounding to 2 mm.
const MIN_NOISE_M: f64 = 0.002 / 3.464;
