use crate::effects::{Effects, FiringEffectSet};
use crate::packet_maker::{HeadRotation, TruePoint};
use crate::sensor::{LidarMount, LidarSensor, ReturnMode};
use crate::simulate::{Simulation, SimulationEvent, SimulationSink};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use units::Stamp;

use super::*;
use crate::cast::{Object, Sphere};
use crate::motion::{AxisMotion, Sweeps};
use crate::scene::Scene;

fn pattern(text: &str) -> Pattern {
    PatternRequest::parse(text).unwrap().build().unwrap()
}

#[test]
fn point_counts_match_the_paper() {
    for (text, frames, points) in [
        ("vlp16", 1, 14_416),
        ("vlp16,seam=once", 1, 14_400),
        ("hdl32e", 1, 28_832),
        ("vlp32c", 1, 28_832),
        ("rmbl:120", 30, 432_480),
        ("rmbl:50", 72, 1_037_952),
        ("velomotion16:50", 18, 259_488),
        ("rsbl:50", 72, 64_872),
        ("hi-res:50", 18, 259_488),
        ("vlp32c:50", 18, 18 * 28_832),
        // 45 deg at 50 deg/s and 10 Hz; 20,828 firings per second.
        ("hdl64e", 1, 64 * 2_083),
        ("hdl64e:50,spin", 36, 36 * 64 * 2_083),
        // 270 deg in steps of 0.25, both ends included.
        ("utm30lx", 1, 1_081),
        ("utm30lx:180,spin", 40, 40 * 1_081),
        ("lms151:180,spin", 25, 25 * 1_081),
        // 8 frames of 10 Hz at the fastest speed, 0.2 deg.
        ("velomotion16:56.25,rpm=600", 8, 8 * 16 * 1_801),
    ] {
        let pattern = pattern(text);
        assert_eq!(pattern.frames(), frames, "{text}");
        let directions = pattern.directions();
        assert_eq!(directions.len(), points, "{text}");
        assert!(pattern.frame_rotation().is_some(), "{text}");
        let off = directions.iter().map(|d| (d.length() - 1.0).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{text}");
    }
}

#[test]
fn points_are_addressed_by_their_number() {
    for text in [
        "velomotion16:13,d=0.06",
        "velomotion16:50,accel=500",
        "hdl64e:400,spin",
        "utm30lx:300",
        "lms151",
    ] {
        let pattern = pattern(text);
        let all = pattern.directions();
        assert_eq!(pattern.points(), all.len() as u64, "{text}");
        for (number, direction) in all.iter().enumerate().step_by(101) {
            assert_eq!(pattern.direction(number as u64), Some(*direction), "{text}");
        }
        assert_eq!(pattern.direction(pattern.points() - 1), all.last().copied());
        assert_eq!(pattern.direction(pattern.points()), None, "{text}");
    }
    // 45 degrees at 0.05 deg/s: 9000 revolutions.
    assert_eq!(
        pattern("velomotion16:0.05,rpm=600").points(),
        9_000 * 1_801 * 16
    );
}

#[test]
fn planar_scanners_see_their_aperture() {
    for (text, azimuths_deg, behind) in [
        ("utm30lx:180,spin", [-135.0, 135.0], DVec3::NEG_Y),
        ("utm30lx:50", [-225.0, 45.0], DVec3::X),
    ] {
        let pattern = pattern(text);
        assert_eq!(pattern.azimuths_deg(), Some(azimuths_deg));
        // The cone behind, 45 degrees from its axis, stays empty.
        let nearest = pattern
            .frame(0)
            .iter()
            .map(|d| d.angle_between(behind))
            .fold(9.0, f64::min);
        assert!(
            (nearest.to_degrees() - 45.0).abs() < 1e-9,
            "{text}: {nearest}"
        );
        assert!(pattern.view().depth_rad(behind) < -0.7, "{text}");
    }
    assert_eq!(pattern("hdl64e").azimuths_deg(), None);
    // At rest it sees half a plane and two eighths, not the whole.
    let resting = pattern("utm30lx").view();
    assert!(resting.depth_rad(DVec3::NEG_X).abs() < 1e-9);
    assert!(resting.depth_rad(DVec3::X) < -0.7);
}

#[test]
fn each_frame_is_the_first_one_rotated() {
    for text in [
        "rmbl:120",
        "rmbl:50,tilt=stepped",
        "velomotion16:50",
        "velomotion16:50,d=0.06",
        "hdl32e,frames=3",
        "rmbl:7,frames=5",
    ] {
        let pattern = pattern(text);
        let rotation = pattern.frame_rotation().unwrap();
        let first = pattern.frame(0);
        for number in [1, 2, rotation.frames - 1] {
            let turn = DMat3::from_axis_angle(rotation.axis, f64::from(number) * rotation.step_rad);
            let frame = pattern.frame(number);
            assert_eq!(frame.len(), first.len());
            let off = first
                .iter()
                .zip(&frame)
                .map(|(a, b)| (turn * *a).distance(*b));
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-14, "{text} {number}: {off}");
        }
        assert!(pattern.frame(rotation.frames).is_empty());
        let all: usize = (0..rotation.frames).map(|k| pattern.frame(k).len()).sum();
        assert_eq!(all, pattern.directions().len());
    }
}

#[test]
fn a_partial_last_frame_ends_the_sweep() {
    // 45 deg at 13 deg/s and 20 Hz: 69.23 frames.
    let cut = pattern("velomotion16:13");
    assert_eq!(cut.frames(), 70);
    assert!(cut.frame_rotation().is_none());
    // 69.23 frames of 900 steps, and the repeated firings at the frame boundaries.
    let steps: f64 = 900.0 * 45.0 / (13.0 / 20.0);
    let expected = 16 * (69 + (steps.floor() as usize) + 1);
    assert_eq!(cut.directions().len(), expected);
    assert!((cut.scan_s() - 45.0 / 13.0).abs() < 1e-12);
    assert_eq!(pattern("velomotion16:13,frames=70").scan_s(), 3.5);
}

#[test]
fn ramps_lengthen_a_pattern_and_are_denser() {
    let (plain, ramped) = (
        pattern("velomotion16:56.25,rpm=600"),
        pattern("velomotion16:56.25,rpm=600,accel=500"),
    );
    assert!((plain.scan_s() - 0.8).abs() < 1e-12);
    assert!(
        (ramped.scan_s() - 0.9125).abs() < 1e-12,
        "{}",
        ramped.scan_s()
    );
    assert_eq!((plain.frames(), ramped.frames()), (8, 10));
    assert!(ramped.frame_rotation().is_none());
    assert_eq!(ramped.tilts_deg(), [-45.0, 0.0]);
    // The first revolution tilts by a / 2 t^2 in 0.1 s, less than the 5.6 degrees of the cruise.
    assert!((ramped.tilt_deg(1.0, 0).unwrap() + 2.5).abs() < 1e-9);
    assert_eq!(ramped.tilt_deg(9.0, 300), None);
    for refused in [
        "rmbl:50,accel=0",
        "vlp16,accel=5",
        "rmbl:50,accel=5,frames=3",
        "rmbl:50,accel=5,tilt=stepped",
    ] {
        let built = PatternRequest::parse(refused).and_then(|request| request.build());
        assert!(built.is_err(), "{refused}");
    }
}

#[test]
fn rays_off_the_axis_hit_the_sphere_as_the_equation_gives() {
    let (level, lifted) = (
        pattern("velomotion16:50,frames=2"),
        pattern("velomotion16:50,frames=2,d=0.06"),
    );
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    for (k, (a, b)) in level
        .directions()
        .iter()
        .zip(&lifted.directions())
        .enumerate()
    {
        let (firing, frame) = (k / 16 % 901, k / 16 / 901);
        let gamma = -(2.5 * (frame as f64 + firing as f64 / 900.0)).to_radians();
        let origin = 0.06 * DVec3::new(gamma.sin(), 0.0, gamma.cos());
        // The range at which the ray is 10 m from the base's origin.
        let along = a.dot(origin);
        let range_m = (along * along + 100.0 - 0.0036).sqrt() - along;
        worst = worst.max(b.distance((origin + range_m * *a) / 10.0));
        most = most.max(a.distance(*b));
    }
    assert!(worst < 1e-14, "{worst}");
    assert!((0.005..0.006_1).contains(&most), "{most}");
}

#[derive(Default)]
struct Truth(Vec<TruePoint>);

impl SimulationSink for Truth {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.0.extend_from_slice(points);
        ControlFlow::Continue(())
    }
}

/// Points of the simulation on the hollow sphere, of a frame that begins at a tilt.
fn simulated(sensor: LidarSensor, from_deg: f64, speed_deg_s: f64, d_m: f64) -> Vec<TruePoint> {
    let motion = match speed_deg_s {
        0.0 => AxisMotion::fixed(from_deg, 0.05).unwrap(),
        _ => AxisMotion::sweeps(&Sweeps {
            from_deg,
            to_deg: from_deg + 0.05 * speed_deg_s,
            speed_deg_s: speed_deg_s.abs(),
            accel_deg_s2: None,
            count: 1,
            both_ways: false,
            rest_s: 0.0,
        })
        .unwrap(),
    };
    let simulation = Simulation {
        scene: Arc::new(
            Scene::new()
                .with(Object::new(Sphere { radius_m: SPHERE_M }), 50)
                .unwrap(),
        ),
        sensor: sensor.ideal(),
        returns: ReturnMode::Strongest,
        rotation: HeadRotation {
            rpm: 1_200,
            start_deg: 90.0,
        },
        mount: LidarMount::above(d_m),
        motion,
        polls: None,
        start: Stamp::from_nanos(1_790_000_000_000_000_000),
        clock_at_start_us: 0,
    };
    let mut truth = Truth::default();
    let one = NonZeroUsize::MIN;
    simulation
        .run(&mut Effects::<FiringEffectSet>::default(), one, &mut truth)
        .unwrap();
    truth.0
}

#[test]
fn patterns_agree_with_the_simulation() {
    // Rotation of the head at 7200 deg/s during a firing: 55.296 us for a VLP-16, 46.08 us for an
    // HDL-32E.
    let (vlp, hdl) = (7_200.0 * 55.296e-6, 7_200.0 * 46.08e-6);
    let heads: [(&str, LidarSensor, f64); 5] = [
        ("vlp16,", LidarSensor::vlp16(), vlp),
        ("hdl32e,", LidarSensor::hdl32e(), hdl),
        ("velomotion16:50,", LidarSensor::vlp16(), vlp),
        ("velomotion16:50,d=0.06,", LidarSensor::vlp16(), vlp),
        ("rsbl:50,", LidarSensor::hdl32e().only(15), hdl),
    ];
    for (text, sensor, step_deg) in heads {
        let pattern = pattern(&format!("{text}frames=3,step={step_deg}"));
        let d_m = pattern.settings().d_m;
        for frame in 0..3_u32 {
            let expected = pattern.frame(frame);
            let speed = if text.starts_with("velo") {
                -50.0
            } else {
                50.0
            };
            let speed = if pattern.step_deg == 0.0 { 0.0 } else { speed };
            let from_deg = f64::from(frame) * 0.05 * speed;
            let points = simulated(sensor.clone(), from_deg, speed, d_m);
            // The simulation ends with its last whole packet.
            assert!(points.len() > 9 * expected.len() / 10 && points.len() <= expected.len());
            let off = points
                .iter()
                .zip(&expected)
                .map(|(point, direction)| point.position_m.normalize().distance(*direction));
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-9, "{text} frame {frame}: {off}");
        }
    }
}

#[test]
fn directions_fill_the_field_of_view() {
    for text in [
        "vlp16",
        "hdl32e,from=20",
        "velomotion16:50",
        "rmbl:120",
        "velomotion16:50,from=30,to=-200",
        "rsbl:50,frames=9",
    ] {
        let pattern = pattern(text);
        let directions = pattern.directions();
        let depths = directions
            .iter()
            .map(|direction| pattern.view().depth_rad(*direction));
        let least = depths.fold(f64::INFINITY, f64::min);
        assert!(least > -1e-7, "{text}: {least}");
        // The outermost rays are on its edge.
        let [low, high] = pattern.elevations_deg();
        let way = pattern.settings().tilt;
        let whole = (way.to_deg - way.from_deg).abs() + high - low >= 180.0;
        assert!(whole || least < 1e-3, "{text}: {least}");
        // The depth changes no faster than the direction.
        for pair in directions.windows(2).step_by(97) {
            let middle = (pair[0] + DVec3::new(0.3, -0.2, 0.1)).normalize();
            let by = (pattern.view().depth_rad(pair[0]) - pattern.view().depth_rad(middle)).abs();
            assert!(by <= pair[0].angle_between(middle) + 1e-7, "{text}");
        }
    }
    let level = pattern("vlp16");
    assert!((level.view().depth_rad(DVec3::Z) + 75_f64.to_radians()).abs() < 1e-12);
    assert!((level.view().depth_rad(DVec3::Y) - 15_f64.to_radians()).abs() < 1e-12);
    let swept = pattern("velomotion16:50");
    // The zenith is 30 deg above the highest ray.
    assert!((swept.view().depth_rad(DVec3::Z) + 30_f64.to_radians()).abs() < 1e-12);
    assert!(pattern("rmbl:50").view().depth_rad(DVec3::Z) > 0.2);
}

#[test]
fn invalid_patterns_are_reported() {
    let wrong = |text: &str| {
        let built = PatternRequest::parse(text).and_then(|request| request.build());
        built.unwrap_err().to_string()
    };
    for (text, words) in [
        ("vlp64", "expected one of vlp16, hi-res, hdl32e"),
        (
            "rmbl",
            "expected a speed above 0 deg/s, as in rmbl:50, got \"none\"",
        ),
        ("rmbl:0", "a speed above 0"),
        ("rmbl:-3", "a speed above 0"),
        ("rmbl:fast", "expected a number for speed, got \"fast\""),
        ("rmbl:NaN", "a number for speed"),
        ("vlp16,to=-30", "a speed with to, accel and spin"),
        ("vlp16,spin", "a speed with to, accel and spin"),
        ("vlp16:50,roll", "a rotating head has no front"),
        ("rmbl:50,spin", "KEY=VALUE or a word of"),
        ("lms151:50,start=0", "a planar scanner begins at the edge"),
        ("lms151:50,d=0.1", "d=0: the view of a planar scanner"),
        ("rmbl:50,colour=red", "expected rpm, step, start"),
        ("rmbl:50,colour=3", "expected rpm, step, start"),
        ("rmbl:50,rpm=fast", "a number for rpm"),
        (
            "vlp16,start=0,start=90",
            "expected start once, got \"start=90 as well\"",
        ),
        ("rmbl:50,speed=30", "expected speed once"),
        ("rmbl:50,tilt=stepped,tilt=stepped", "expected tilt once"),
        ("velomotion16:50,,d=1", "expected KEY=VALUE"),
        ("velomotion16:50,", "expected KEY=VALUE"),
        ("vlp16,", "expected KEY=VALUE"),
        ("velomotion16:", "a number for speed"),
        (
            "velomotion16:50,from=0,to=0",
            "from and to that differ (vlp16 stands still), got \"both 0\"",
        ),
        ("rmbl:50,stepped", "KEY=VALUE"),
        ("rmbl:50,tilt=jumping", "tilt=stepped or tilt=continuous"),
        ("rmbl:50,seam=thrice", "seam=once or seam=twice"),
        ("rmbl:50,frames=0", "frames as a whole number from 1"),
        ("rmbl:50,frames=2.5", "frames as a whole number from 1"),
        (
            "rmbl:50,rpm=0",
            "rpm: expected 300 to 1200 rpm in steps of 60",
        ),
        ("velomotion16:50,rpm=601", "in steps of 60, got 601"),
        ("hdl64e:50,rpm=1200", "rpm: expected 300 to 900"),
        ("rmbl:50,step=0", "step: expected 0.001"),
        ("rmbl:50,d=7", "d: expected -5 to 5 m"),
        ("rmbl:0.001", "at most 2000000000 points, got"),
    ] {
        let message = wrong(text);
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn options_without_numbers_reject_numbers() {
    let mut request = PatternRequest::parse("velomotion16:50").unwrap();
    for (key, words) in [
        (
            "tilt",
            "expected tilt=stepped or tilt=continuous, which is no number, got \"tilt=1\"",
        ),
        ("seam", "expected seam=once or seam=twice"),
        ("colour", "a number: rpm, step, start"),
    ] {
        let message = request.set_number(key, 1.0).unwrap_err().to_string();
        assert!(message.contains(words), "{key}: {message}");
    }
    // An option that is part of the name may be set again.
    request.set_number("speed", 10.0).unwrap();
    assert_eq!(request.build().unwrap().settings().tilt.speed_deg_s, 10.0);
}
