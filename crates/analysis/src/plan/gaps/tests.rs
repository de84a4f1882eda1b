//! Gaps against the density analysis of all rays.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::super::lidar::tests::vlp_16;
use super::*;
use crate::density::{Icosahedron, gaps};

/// Every ray of the sweeps as a direction from the origin of the base, by the equations of the
/// mount.
fn rays(lidar: &PlanLidar, rpm: f64, range_m: f64, sweeps: &[StartedSweep]) -> Vec<DVec3> {
    let mut found = Vec::new();
    for StartedSweep { motion, start } in sweeps {
        let sweep = motion.sweep;
        let (from_s, until_s) = motion.seen_s;
        for firing in 0.. {
            let begin_s = f64::from(firing) * lidar.firing_period_s;
            if begin_s > sweep.duration_s() {
                break;
            }
            for laser in &lidar.lasers {
                let t = begin_s + laser.delay_s;
                if t < from_s || t > until_s {
                    continue;
                }
                let a = (start + t * rpm / 60.0) * TAU + laser.azimuth_deg.to_radians();
                let is_seen = |[first, last]: [f64; 2]| {
                    (a.to_degrees() - first).rem_euclid(360.0) <= last - first
                };
                if !lidar.azimuths_deg.is_none_or(is_seen) {
                    continue;
                }
                let (sin_w, cos_w) = laser.elevation_deg.to_radians().sin_cos();
                let d = lidar.d_m + laser.height_m;
                // Eq. 9.
                let up = d * sin_w;
                let r = (range_m * range_m - d * d + up * up).sqrt() - up;
                let mount = cloud::mount::Mount::new(units::Metres(d));
                let at = [r * cos_w * a.sin(), r * cos_w * a.cos(), r * sin_w];
                let tilt = cloud::mount::Tilt::new(units::Degrees(sweep.angle_deg(t)));
                found.push(DVec3::from_array(mount.place(at, tilt)).normalize());
            }
        }
    }
    found
}

fn places() -> Vec<DVec3> {
    let bins = Icosahedron::new(3).unwrap();
    bins.bins().iter().map(|bin| bin.centre).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::with_cases(12)
    })]

    /// Against the density analysis of all rays: fast sweeps with few revolutions and slow ones
    /// with many, both ways, with ramps of all lengths.
    #[test]
    fn gaps_agree_with_the_analysis_of_all_rays(
        // Slow sweeps are short, for the sake of all rays.
        (speed_deg_s, part) in prop_oneof![
            (0.5..1.0_f64, Just(0.05)),
            (3.0..8.0_f64, Just(1.0)),
            (20.0..98.0_f64, Just(1.0)),
        ],
        accel_deg_s2 in prop_oneof![Just(f64::INFINITY), 50.0..5_000.0_f64],
        to_deg in prop_oneof![-45.0..-10.0_f64, 100.0..180.0_f64],
        rpm in prop_oneof![Just(300.0), Just(600.0), Just(1_200.0)],
        starts in [0.0..1.0_f64, 0.0..1.0_f64],
        both_ways: bool,
        unseen_deg in prop_oneof![Just(0.0), Just(0.003), Just(0.02)],
    ) {
        let to_deg = part * to_deg;
        let mut lidar = vlp_16();
        lidar.d_m = 0.5;
        lidar.lasers[3].azimuth_deg = 4.2;
        lidar.lasers[5].height_m = 0.05;
        let sweep = TiltSweep { from_deg: 0.0, to_deg, speed_deg_s, accel_deg_s2 };
        let back = TiltSweep { from_deg: to_deg, to_deg: 0.0, ..sweep };
        let sweeps = [sweep, back].into_iter().zip(starts);
        let sweeps: Vec<_> = sweeps.map(|(sweep, start)| StartedSweep::new(&sweep, start, unseen_deg)).collect();
        let sweeps = if both_ways { &sweeps[..] } else { &sweeps[..1] };
        let planned = PlannedRays::new(&lidar, rpm, 10.0);
        let places: Vec<DVec3> = places().into_iter().filter(|p| planned.is_in_view(*p, [0.0, to_deg])).collect();
        let mut sum = 0.0;
        let slow = gaps(&rays(&lidar, rpm, 10.0, sweeps), &places).unwrap();
        for (place, slow) in places.iter().zip(slow) {
            let place = planned.place(*place, [0.0, to_deg]);
            let fast = planned.gap_deg(sweeps, &place);
            let slow = slow.to_degrees();
            // No ray is nearer than the nearest; one of another revolution may be nearer by a
            // part of a step of azimuth.
            let step_deg = rpm * 6.0 * lidar.firing_period_s;
            prop_assert!(place.least_chord() <= slow.to_radians() + 1e-9);
            for (share, within) in [(0.999, false), (1.001, true)] {
                prop_assert_eq!(planned.is_within(sweeps, &place, share * fast), within);
                let beyond = planned.gap_beyond_deg(sweeps, &place, share * fast);
                prop_assert_eq!(beyond, if within { share * fast } else { fast });
            }
            prop_assert!(fast >= slow - 1e-6 && fast <= 1.01 * slow + 0.25 * step_deg, "{}: {fast} {slow}", place.direction());
            sum += (fast - slow) / (slow + step_deg) / places.len() as f64;
        }
        prop_assert!(sum < 0.01, "{sum}");
    }
}

/// A UTM-30LX: one level laser that sees 270 degrees in steps of 0.25.
fn planar(front_deg: f64) -> PlanLidar {
    let mut lidar = vlp_16();
    lidar.lasers.truncate(1);
    lidar.lasers[0].elevation_deg = 0.0;
    lidar.firing_period_s = 1.0 / 57_600.0;
    lidar.azimuths_deg = Some([front_deg - 135.0, front_deg + 135.0]);
    lidar
}

#[test]
fn gaps_of_planar_scanners_agree_with_the_analysis_of_all_rays() {
    for (front_deg, speed_deg_s, accel_deg_s2, start) in [
        (-90.0, 45.0, 500.0, 0.3),
        (-90.0, 8.0, f64::INFINITY, 0.8),
        (0.0, 20.0, 5_000.0, 0.1),
    ] {
        let lidar = planar(front_deg);
        let sweep = TiltSweep {
            from_deg: 0.0,
            to_deg: -45.0,
            speed_deg_s,
            accel_deg_s2,
        };
        let sweeps = [StartedSweep::new(&sweep, start, 0.003)];
        let planned = PlannedRays::new(&lidar, 2_400.0, 10.0);
        let in_view = |place: &DVec3| planned.is_in_view(*place, [0.0, -45.0]);
        let (seen, unseen): (Vec<DVec3>, Vec<DVec3>) = places().into_iter().partition(in_view);
        let rays = rays(&lidar, 2_400.0, 10.0, &sweeps);
        let slow = gaps(&rays, &seen).unwrap();
        let mut sum = 0.0;
        for (place, slow) in seen.iter().zip(slow) {
            let planned_place = planned.place(*place, [0.0, -45.0]);
            let fast = planned.gap_deg(&sweeps, &planned_place);
            let slow = slow.to_degrees();
            assert!(
                fast >= slow - 1e-6 && fast <= 1.02 * slow + 0.15,
                "{place}: {fast} {slow}"
            );
            sum += (fast - slow) / seen.len() as f64;
        }
        assert!(sum < 0.003, "{sum}");
        // The lines of a revolution of the lidar are 1.1 deg apart at 45 deg/s; what is not in
        // view is farther from them than a line from its neighbour.
        let line_deg = speed_deg_s / 40.0;
        let blind = gaps(&rays, &unseen).unwrap();
        let near = blind
            .iter()
            .filter(|gap| gap.to_degrees() < 0.3 * line_deg)
            .count();
        assert!(near * 50 < unseen.len(), "{near} of {}", unseen.len());
    }
}

#[test]
fn the_view_ends_at_the_outermost_rays() {
    let lidar = vlp_16();
    let rays_at_10_m = PlannedRays::new(&lidar, 600.0, 10.0);
    let sweep = TiltSweep {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 56.25,
        accel_deg_s2: 500.0,
    };
    let started = StartedSweep::new(&sweep, 0.3, 0.0);
    for ray in rays(&lidar, 600.0, 10.0, &[started]).iter().step_by(97) {
        let inwards = (*ray * (1.0 - 1e-9)).normalize();
        assert!(rays_at_10_m.is_in_view(inwards, [0.0, -45.0]) || ray.z.abs() > 0.2);
    }
    assert!(!rays_at_10_m.is_in_view(DVec3::Z, [0.0, -45.0]));
    assert!(rays_at_10_m.is_in_view(DVec3::Y, [0.0, -45.0]));
}
