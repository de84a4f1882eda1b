//! The makers' tables of lasers, computed from the rules in their manuals: elevation by ring,
//! firing order, and the point where the beams cross.

use super::LaserBeam;

/// VLP-16: fires low and high lasers alternately, 2.304 us apart (63-9243, "Sensor operation").
pub(super) fn vlp16() -> Vec<LaserBeam> {
    // All beams cross 41.91 mm from the axis; the manual prints where they start to 0.1 mm.
    let beam = |ring: f64| {
        let elevation_deg = -15.0 + 2.0 * ring;
        (elevation_deg, crossing_mm(elevation_deg, 41.91, 0.1))
    };
    in_turn(16, 2_304, |ring| beam(f64::from(ring)))
}

/// Puck Hi-Res: the same with 4/3 of a degree between lasers, and origins as the manual prints
/// them.
pub(super) fn hi_res() -> Vec<LaserBeam> {
    // By distance from the horizon: elevation in hundredths of a degree, origin in tenths of a
    // millimetre below the middle.
    const ABOVE: [(i32, i32); 8] = [
        (67, 9),
        (200, 18),
        (333, 27),
        (467, 37),
        (600, 46),
        (733, 55),
        (867, 65),
        (1000, 74),
    ];
    in_turn(16, 2_304, |ring| {
        let above = ring >= 8;
        let from_horizon = if above { ring - 8 } else { 7 - ring };
        let sign = if above { 1.0 } else { -1.0 };
        let (hundredths, tenths) = ABOVE
            .get(from_horizon as usize)
            .copied()
            .unwrap_or_default();
        (
            sign * f64::from(hundredths) / 100.0,
            -sign * f64::from(tenths) / 10.0,
        )
    })
}

/// HDL-32E: low and high lasers alternately, 1.152 us apart; 4/3 of a degree between lasers,
/// printed to 0.01; beams cross 28.95 mm from the axis (drawing 86-0106, revision B), printed to
/// 0.01 mm.
pub(super) fn hdl32e() -> Vec<LaserBeam> {
    in_turn(32, 1_152, |ring| {
        let exact_deg = (4.0 * f64::from(ring) - 92.0) / 3.0;
        let printed_deg = (exact_deg * 100.0).round() / 100.0;
        (printed_deg, crossing_mm(exact_deg, 28.95, 0.01))
    })
}

/// VLP-32C: sixteen pairs 2.304 us apart (63-9325, section 9.5). The origins of its rays are not
/// published: all in one point.
pub(super) fn vlp32c() -> Vec<LaserBeam> {
    // Thousandths of a degree of elevation, and tenths of azimuth, by pair.
    const PAIRS: [[(i32, i32); 2]; 16] = [
        [(-25_000, 14), (-1_000, -42)],
        [(-1_667, 14), (-15_639, -14)],
        [(-11_310, 14), (0, -14)],
        [(-667, 42), (-8_843, -14)],
        [(-7_254, 14), (333, -42)],
        [(-333, 14), (-6_148, -14)],
        [(-5_333, 42), (1_333, -14)],
        [(667, 42), (-4_000, -14)],
        [(-4_667, 14), (1_667, -42)],
        [(1_000, 14), (-3_667, -42)],
        [(-3_333, 42), (3_333, -14)],
        [(2_333, 14), (-2_667, -14)],
        [(-3_000, 14), (7_000, -14)],
        [(4_667, 14), (-2_333, -42)],
        [(-2_000, 42), (15_000, -14)],
        [(10_333, 14), (-1_333, -14)],
    ];
    PAIRS
        .iter()
        .zip(0..)
        .flat_map(|(pair, number)| {
            pair.map(|(elevation, azimuth)| LaserBeam {
                elevation_deg: f64::from(elevation) / 1_000.0,
                origin_m: 0.0,
                azimuth_deg: f64::from(azimuth) / 10.0,
                delay_ns: 2_304 * number,
            })
        })
        .collect()
}

/// Lasers that fire alternately from the lower and the upper half, from below; elevation (deg) and
/// origin (mm) by place.
fn in_turn(count: i32, period_ns: i64, of_ring: impl Fn(i32) -> (f64, f64)) -> Vec<LaserBeam> {
    (0..count)
        .map(|number| {
            let ring = number / 2 + if number % 2 == 1 { count / 2 } else { 0 };
            let (elevation_deg, origin_mm) = of_ring(ring);
            LaserBeam {
                elevation_deg,
                origin_m: origin_mm / 1e3,
                azimuth_deg: 0.0,
                delay_ns: period_ns * i64::from(number),
            }
        })
        .collect()
}

/// Height of the origin of a beam that crosses the others at this distance from the axis,
/// millimetres, in steps of `step_mm`.
fn crossing_mm(elevation_deg: f64, distance_mm: f64, step_mm: f64) -> f64 {
    let exact = -distance_mm * elevation_deg.to_radians().tan();
    (exact / step_mm).round() / step_mm.recip()
}
