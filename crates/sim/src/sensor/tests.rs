use proptest::prelude::*;

use super::*;

#[test]
fn tables_agree_with_the_manuals() {
    let row = |beam: &LaserBeam| (beam.elevation_deg, beam.origin_m * 1e3);
    let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9;
    let origins = [
        11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1, 5.1, -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2,
    ];
    for (i, (beam, origin)) in LidarSensor::vlp16().beams.iter().zip(origins).enumerate() {
        let elevation = i as f64 - if i % 2 == 0 { 15.0 } else { 0.0 };
        assert!(near(row(beam), (elevation, origin)), "{beam:?}");
        assert_eq!(beam.delay_ns, 2_304 * i as i64);
    }
    let hi_res = LidarSensor::hi_res();
    for (i, expected) in [
        (0, (-10.0, 7.4)),
        (1, (0.67, -0.9)),
        (4, (-7.33, 5.5)),
        (14, (-0.67, 0.9)),
        (15, (10.0, -7.4)),
    ] {
        assert!(near(row(&hi_res.beams[i]), expected), "{i}");
    }
    let hdl = LidarSensor::hdl32e();
    for (i, expected) in [
        (0, (-30.67, 17.17)),
        (1, (-9.33, 4.76)),
        (2, (-29.33, 16.27)),
        (15, (0.0, 0.0)),
        (30, (-10.67, 5.45)),
        (31, (10.67, -5.45)),
    ] {
        assert!(near(row(&hdl.beams[i]), expected), "{i}");
    }
    assert_eq!(hdl.beams[31].delay_ns, 35_712);
    let vlp32c = LidarSensor::vlp32c();
    assert_eq!(vlp32c.beams[31].delay_ns, 34_560);
    assert_eq!(vlp32c.beams[29].elevation_deg, 15.0);
    assert_eq!(vlp32c.beams[1].azimuth_deg, -4.2);
    let ideal = &vlp32c.ideal().beams[1];
    assert_eq!((ideal.azimuth_deg, ideal.delay_ns), (-4.2, 0));
}

#[test]
fn tables_are_as_long_as_their_packets() {
    for sensor in [
        LidarSensor::vlp16(),
        LidarSensor::hi_res(),
        LidarSensor::hdl32e(),
        LidarSensor::vlp32c(),
        LidarSensor::single_beam(),
    ] {
        let model = sensor.packets.unwrap();
        assert_eq!(sensor.beams.len(), model.lasers(), "{model:?}");
        let last = sensor.beams.iter().map(|beam| beam.delay_ns).max().unwrap();
        assert!(last < model.firing_period_ns());
        let used = sensor.used.count_ones() as usize;
        assert!(used == model.lasers() || (used == 1 && sensor.used == 1 << 14));
    }
}

#[test]
fn a_single_laser_can_be_selected() {
    assert_eq!(LidarSensor::hdl32e().only(15).used, 1 << 15);
    assert_eq!(LidarSensor::vlp16().only(16).used, 0);
    assert_eq!(LidarSensor::vlp16().only(usize::MAX).used, 0);
}

#[test]
fn planar_scanners_see_their_aperture() {
    let scanner = LidarSensor::utm30lx();
    for (azimuth_deg, is_seen) in [
        (0.0, true),
        (135.0, true),
        (135.1, false),
        (224.9, false),
        (225.0, true),
        (359.9, true),
    ] {
        assert_eq!(scanner.sees(azimuth_deg), is_seen, "{azimuth_deg}");
        assert!(LidarSensor::hdl64e().sees(azimuth_deg));
    }
}

#[test]
fn the_range_is_limited_by_the_wire_format() {
    let far = DetectionRange {
        min_m: 0.5,
        max_m: 1e4,
    };
    assert_eq!(LidarSensor::vlp16().with_range(far).range().max_m, 131.07);
    assert_eq!(LidarSensor::vlp32c().with_range(far).range().max_m, 262.14);
    assert_eq!(LidarSensor::hdl32e().range().max_m, 70.0);
}

#[test]
fn rays_include_the_rotation_during_a_firing_sequence() {
    let sensor = LidarSensor::vlp32c();
    let rays = RayTable::new(&sensor, 3_600.0);
    for (beam, aim) in sensor.beams.iter().zip(rays.directions) {
        let azimuth_deg = beam.azimuth_deg + 3.6e-6 * beam.delay_ns as f64;
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let (up, level) = beam.elevation_deg.to_radians().sin_cos();
        assert!(aim.distance(DVec3::new(level * sin, level * cos, up)) < 1e-15);
    }
}

/// Eq. 4-6 of "Analysis of 3D Scan Measurement Distribution with Application to a Multi-Beam Lidar
/// on a Rotating Platform" (2018) as printed, with z raised in the head's frame by the laser's
/// vertical origin.
fn printed(range_m: f64, beam: &LaserBeam, azimuth_deg: f64, tilt_deg: f64, d_m: f64) -> DVec3 {
    let (sw, cw) = beam.elevation_deg.to_radians().sin_cos();
    let (sa, ca) = azimuth_deg.to_radians().sin_cos();
    let (sg, cg) = tilt_deg.to_radians().sin_cos();
    let d = d_m + beam.origin_m;
    DVec3::new(
        range_m * (cw * sa * cg + sw * sg) + d * sg,
        range_m * cw * ca,
        range_m * (sw * cg - cw * sa * sg) + d * cg,
    )
}

#[test]
fn origins_of_the_vlp16_follow_from_one_crossing() {
    let sensor = LidarSensor::vlp16();
    // The beams cross close to one point, 41.91 mm from the axis: origin = -41.91 mm x
    // tan(elevation), printed to 0.1 mm; they mirror about the middle of the stack.
    for (beam, mirrored) in sensor.beams.iter().zip(sensor.beams.iter().rev()) {
        let crossing = -0.041_91 * beam.elevation_deg.to_radians().tan();
        assert!((beam.origin_m - crossing).abs() < 0.6e-4, "{beam:?}");
        assert_eq!(beam.elevation_deg, -mirrored.elevation_deg);
        assert_eq!(beam.origin_m, -mirrored.origin_m);
    }
}

#[test]
fn a_level_ray_points_along_y_and_right_along_x() {
    let (sensor, mount) = (LidarSensor::vlp16(), LidarMount::above(0.06));
    let (origin, direction) = sensor.ray(15, 0.0, 0.0, &mount).unwrap();
    assert!(origin.distance(DVec3::new(0.0, 0.0, 0.06 - 0.0112)) < 1e-15);
    let (sin, cos) = 15_f64.to_radians().sin_cos();
    assert!(direction.distance(DVec3::new(0.0, cos, sin)) < 1e-15);
    let (_, right) = sensor.ray(15, 90.0, 0.0, &mount).unwrap();
    assert!(right.distance(DVec3::new(cos, 0.0, sin)) < 1e-15);
    assert!(sensor.ray(16, 0.0, 0.0, &mount).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn rays_follow_the_papers_equations(
        range_m in 0.0..100.0,
        laser in 0..16_usize,
        azimuth in 0.0..360.0,
        tilt in -180.0..180.0,
        d in -1.0..1.0,
    ) {
        let sensor = LidarSensor::vlp16();
        let ray = sensor.ray(laser, azimuth, tilt, &LidarMount::above(d));
        let (origin, direction) = ray.unwrap();
        prop_assert!((direction.length() - 1.0).abs() < 1e-15);
        let point = origin + range_m * direction;
        let expected = printed(range_m, &sensor.beams[laser], azimuth, tilt, d);
        prop_assert!(point.distance(expected) < 1e-13, "{point} {expected}");
    }
}
