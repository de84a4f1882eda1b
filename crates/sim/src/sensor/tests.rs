use super::*;

#[test]
fn the_rules_give_what_the_manuals_print() {
    let row = |beam: &Beam| (beam.elevation_deg, beam.origin_m * 1e3);
    let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9;
    let origins = [
        11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1, 5.1, -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2,
    ];
    for (i, (beam, origin)) in Sensor::vlp16().beams().iter().zip(origins).enumerate() {
        let elevation = i as f64 - if i % 2 == 0 { 15.0 } else { 0.0 };
        assert!(near(row(beam), (elevation, origin)), "{beam:?}");
        assert_eq!(beam.delay_ns, 2_304 * i as i64);
    }
    let hi_res = Sensor::hi_res();
    for (i, expected) in [
        (0, (-10.0, 7.4)),
        (1, (0.67, -0.9)),
        (4, (-7.33, 5.5)),
        (14, (-0.67, 0.9)),
        (15, (10.0, -7.4)),
    ] {
        assert!(near(row(&hi_res.beams()[i]), expected), "{i}");
    }
    let hdl = Sensor::hdl32e();
    for (i, expected) in [
        (0, (-30.67, 17.17)),
        (1, (-9.33, 4.76)),
        (2, (-29.33, 16.27)),
        (15, (0.0, 0.0)),
        (30, (-10.67, 5.45)),
        (31, (10.67, -5.45)),
    ] {
        assert!(near(row(&hdl.beams()[i]), expected), "{i}");
    }
    assert_eq!(hdl.beams()[31].delay_ns, 35_712);
    let vlp32c = Sensor::vlp32c();
    assert_eq!(vlp32c.beams()[31].delay_ns, 34_560);
    assert_eq!(vlp32c.beams()[29].elevation_deg, 15.0);
    assert_eq!(vlp32c.beams()[1].azimuth_deg, -4.2);
}

#[test]
fn tables_are_as_long_as_their_packets() {
    for sensor in [
        Sensor::vlp16(),
        Sensor::hi_res(),
        Sensor::hdl32e(),
        Sensor::vlp32c(),
        Sensor::single_beam(),
    ] {
        let model = sensor.model();
        assert_eq!(sensor.beams().len(), model.lasers(), "{model:?}");
        let last = sensor
            .beams()
            .iter()
            .map(|beam| beam.delay_ns)
            .max()
            .unwrap();
        assert!(last < model.firing_period_ns());
        let used = sensor.used().count_ones() as usize;
        assert!(used == model.lasers() || (used == 1 && sensor.used() == 1 << 14));
    }
}

#[test]
fn one_laser_may_be_left_alone() {
    assert_eq!(Sensor::hdl32e().only(15).used(), 1 << 15);
    assert_eq!(Sensor::vlp16().only(16).used(), 0);
    assert_eq!(Sensor::vlp16().only(usize::MAX).used(), 0);
}

#[test]
fn a_reach_ends_where_the_wire_does() {
    let far = Reach {
        min_m: 0.5,
        max_m: 1e4,
    };
    assert_eq!(Sensor::vlp16().seeing(far).reach().max_m, 131.07);
    assert_eq!(Sensor::vlp32c().seeing(far).reach().max_m, 262.14);
    assert_eq!(Sensor::hdl32e().reach().max_m, 70.0);
}

#[test]
fn the_head_turns_between_the_first_laser_and_each_other() {
    let sensor = Sensor::vlp32c();
    let rays = Rays::new(&sensor, 3_600.0);
    for (beam, aim) in sensor.beams().iter().zip(rays.aims) {
        let azimuth_deg = beam.azimuth_deg + 3.6e-6 * beam.delay_ns as f64;
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let (up, level) = beam.elevation_deg.to_radians().sin_cos();
        assert!(aim.distance(DVec3::new(level * sin, level * cos, up)) < 1e-15);
    }
}
