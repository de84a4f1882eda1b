//! Study of the tilt speed: scan time, resolution and unseen areas. Computed, not timed.

use super::pattern::{PatternLidar, TiltSweep};
use super::{Bench, Measured, Row, Study, StudyError, Trade};

/// The study.
pub const SCAN_SPEED: Study = Study {
    name: "scan-speed",
    title: "Tilt speed and scan time",
    choice: "cruise",
    columns: &[
        ("scan_time_s", "scan time, s"),
        ("mean_resolution_deg", "mean vertical resolution, deg"),
        ("gap_deg", "widest gap, deg"),
        ("gap_in_the_middle_deg", "widest gap in the middle, deg"),
        ("widest_circle_deg", "widest unseen circle, deg"),
    ],
    trades: &[
        Trade::new(0, 1).joined(),
        Trade::new(0, 2).joined(),
        Trade::new(0, 3).joined(),
    ],
    measure,
};

/// 45 degrees, with the drive's factory ramps.
const WAY_DEG: f64 = 45.0;
const ACCEL_DEG_S2: f64 = 500.0;
/// Speeds of the drive: 1 rpm of the motor is 0.05 deg/s.
const SPEEDS_DEG_S: [f64; 18] = [
    0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 12.5, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0,
    56.25,
];

fn measure(bench: &mut Bench<'_>) -> Result<Measured, StudyError> {
    let lidar = PatternLidar::vlp_16();
    let (phases, step_deg) = bench.pick((8, 3.0), (64, 0.5));
    (bench.say)(&format!("{} speeds, computed", SPEEDS_DEG_S.len()));
    let rows = SPEEDS_DEG_S.map(|speed_deg_s| {
        let sweep = TiltSweep {
            way_deg: WAY_DEG,
            speed_deg_s,
            accel_deg_s2: ACCEL_DEG_S2,
        };
        let gaps = lidar.gaps(&sweep, phases);
        let values = [
            sweep.duration_s(),
            lidar.mean_resolution_deg(&sweep),
            gaps.field_deg,
            gaps.middle_deg,
            lidar.widest_circle_deg(&sweep, step_deg),
        ];
        Row::new(
            format!("{speed_deg_s} deg/s"),
            speed_deg_s.to_string(),
            "VLP-16 at 600 rpm",
            values.map(without_rounding),
        )
    });
    Ok((about(phases, step_deg), rows.into()))
}

/// Rounds to 1e-9, so that equal gaps of two speeds compare as equal.
fn without_rounding(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

fn about(phases: u32, step_deg: f64) -> Vec<String> {
    vec![
        format!(
            "A tilt of {WAY_DEG} degrees with ramps of {ACCEL_DEG_S2} deg/s2, computed from the directions of the scan lines; a scan line \
             is what one laser sweeps in one revolution. The mean vertical resolution is that of the paper and of analyze: the vertical \
             field of view, 75 degrees, divided by 16 lasers and by the revolutions in 45 degrees at cruise speed (0.80 s and 8 revolutions \
             at 56.25 deg/s). It excludes ramps, the scan time includes them. It is not the tilt per revolution, which is 5.6 degrees there."
        ),
        format!(
            "The widest gap is the largest angle between neighbouring scan lines in the plane across the tilt axis, where they are farthest \
             apart. The ends of the field of view count as lines. It is the worst of {phases} azimuths of the lidar at the start. Near its \
             ends only one laser covers the field, and its lines are the tilt per revolution apart. In the middle 15 degrees, which all \
             lasers pass, they fill each other's gaps, unless their spacing of 2 degrees is a multiple of the tilt per revolution: then all \
             lines coincide, and 20 deg/s shows no more than one frame."
        ),
        format!(
            "The widest unseen circle is the diameter of the largest circle around any direction of the field of view, on a grid of \
             {step_deg} degrees, that no scan line enters. Around the tilt axis 2 degrees remain unseen at any speed: the lasers at -1 and \
             +1 degrees circle around the poles."
        ),
    ]
}

#[cfg(test)]
mod tests {
    use units::Stamp;

    use super::super::{Effort, StudyFindings};
    use super::*;

    #[test]
    fn findings_match_the_pattern() {
        let mut clock = || Stamp::from_nanos(0);
        let mut bench = Bench {
            clock: &mut clock,
            effort: Effort::Quick,
            say: &mut |_| {},
        };
        let (about, rows) = measure(&mut bench).unwrap();
        let study = SCAN_SPEED;
        let findings = StudyFindings { study, about, rows };
        let value = |name: &str, column: usize| {
            let row = findings.rows.iter().find(|row| row.name == name).unwrap();
            row.values[column].middle()
        };
        assert!((value("56.25 deg/s", 0) - 0.9125).abs() < 1e-12);
        assert!((value("56.25 deg/s", 1) - 75.0 / (16.0 * 8.0)).abs() < 1e-9);
        assert!((value("0.05 deg/s", 0) - 900.0).abs() < 1e-3);
        // 0.05 deg/s: 0.005 degrees per revolution, and only one laser sees the ends of the field.
        assert!((0.005..0.006).contains(&value("0.05 deg/s", 2)));
        for row in &findings.rows {
            let [mean, gap, middle] = [1, 2, 3].map(|column| row.values[column].middle());
            // Between lasers, or at an end the tilt during the first revolution: at most 0.5 x 500
            // x 0.1^2.
            assert!(mean <= gap && middle <= gap && gap <= 2.5, "{row:?}");
            assert!(middle <= 2.0 + 1e-9, "{row:?}");
            assert!(row.values[4].middle() >= 2.0 - 1e-9, "{row:?}");
        }
        // Slower is finer on average, so every speed is on the first front.
        assert_eq!(findings.front(&study.trades[0]), [true; 18]);
    }
}
