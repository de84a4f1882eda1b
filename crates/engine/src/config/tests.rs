use scanner::config::MountConfig;

use super::*;

#[test]
fn the_shipped_file_sets_sim_and_only_defaults() {
    let text = include_str!("../../../../velomotion.toml");
    let config: Config = toml::from_str(text).unwrap();
    assert_eq!(config.device.default.as_deref(), Some("sim"));
    let braked = AxisSettings {
        brake_output: Some(1),
        ..AxisSettings::default()
    };
    assert_eq!(config.axis, braked);
    assert_eq!(config.mount.pose(), MountConfig::default());
    assert_eq!(config.lidar, LidarSettings::default());
}

#[test]
fn out_of_range_numbers_are_refused() {
    for (text, key) in [
        ("[mount]\nd_m = nan", "mount.d_m"),
        ("[mount]\nposition_m = [0.0, 11.0, 0.0]", "mount.position_m"),
        (
            "[mount]\nrotation_deg = [0.0, 0.0, inf]",
            "mount.rotation_deg",
        ),
        ("[axis]\nmin_deg = -inf", "axis.min_deg"),
        ("[lidar]\nrange_sd_m = -0.01", "lidar.range_sd_m"),
        ("[lidar]\nmodel = 'hi-res'\nrpm = 30", "lidar.rpm"),
        (
            "[lidar]\nrpm = 601",
            "lidar.rpm: expected 300 to 1200 rpm in steps of 60",
        ),
        ("[axis]\nmax_speed_deg_s = -20.0", "axis.max_speed_deg_s"),
        ("[axis]\nmax_accel_deg_s2 = 0.0", "axis.max_accel_deg_s2"),
        ("[axis]\nquick_stop_deg_s2 = nan", "axis.quick_stop_deg_s2"),
        (
            "[axis.homing]\nspeed_deg_s = -5.0",
            "axis.homing.speed_deg_s",
        ),
        (
            "[axis]\nmax_speed_deg_s = 5.0",
            "axis.homing.speed_deg_s: expected a number above 0 up to 5,",
        ),
    ] {
        let config: Config = toml::from_str(text).unwrap();
        let message = config.check().unwrap_err();
        assert!(message.starts_with(key), "{text}: {message}");
    }
    for (keys, key) in [
        ("kind = 'usb'\naccel_deg_s2 = -5.0", "device.a.accel_deg_s2"),
        ("kind = 'can'\nbaud = 9600", "device.a.baud"),
        ("kind = 'usb'\ndata_port = 0", "device.a.data_port"),
        ("kind = 'usb'\nposition_port = 0", "device.a.position_port"),
        (
            "kind = 'usb'\nlidar_group = '192.168.1.201'",
            "device.a.lidar_group: expected a multicast address",
        ),
        (
            "kind = 'usb'\nlidar = '239.1.2.3'",
            "device.a.lidar: expected an address of this machine",
        ),
        (
            "kind = 'usb'\nlidar_source = '255.255.255.255'",
            "device.a.lidar_source",
        ),
        (
            "kind = 'sim'\ndata_port = 2369",
            "device.a.data_port: expected with a real lidar only",
        ),
        (
            "kind = 'sim'\nlidar_source = '127.0.0.1'",
            "device.a.lidar_source: expected with a real lidar only",
        ),
    ] {
        let config: Config = toml::from_str(&format!("[device.a]\n{keys}")).unwrap();
        assert!(config.check().unwrap_err().starts_with(key), "{keys}");
    }
    assert_eq!(Config::default().check(), Ok(()));
}

#[test]
fn brakes_and_limit_switches_are_absent_by_default() {
    let axis = |text: &str| toml::from_str::<Config>(text).unwrap().axis;
    assert_eq!(axis("").brake_output, None);
    assert_eq!(axis("[axis]\nnode = 2").brake_output, None);
    let of = |text| axis(text).limit_switches;
    assert_eq!(of("[axis]\nnode = 2"), LimitSwitchSettings::default());
    let one = LimitSwitchSettings {
        negative: Some(3),
        positive: None,
        normally_closed: true,
    };
    assert_eq!(
        of("[axis.limit_switches]\nnegative = 3\nnormally_closed = true"),
        one
    );
}

#[test]
fn the_device_is_a_name_or_tables() {
    let config: Config = toml::from_str(
        "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '/dev/ttyUSB3'",
    )
    .unwrap();
    assert_eq!(config.device.default.as_deref(), Some("bench"));
    let bench = &config.device.profiles["bench"];
    assert_eq!(bench.kind, DeviceKind::Usb);
    assert_eq!(bench.accel_deg_s2, 500.0);
}

#[test]
fn a_misspelt_key_is_an_error_with_its_line() {
    for text in [
        "\n[axis]\nmin_degg = -45",
        "\n[device.a]\nkind = 'usb'\nprot = '/dev/x'",
    ] {
        let error = toml::from_str::<Config>(text).unwrap_err().to_string();
        assert!(error.contains("line "), "{error}");
        assert!(error.contains("unknown field"), "{error}");
    }
    // NaN and infinity are refused too.
    for (key, what) in [
        ("data_port = 70000", "70000"),
        ("lidar_group = '239.1.2'", "IPv4"),
    ] {
        let text = format!("[device.a]\nkind = 'usb'\n{key}");
        let error = toml::from_str::<Config>(&text).unwrap_err().to_string();
        assert!(error.contains("line 3") && error.contains(what), "{error}");
    }
}

#[test]
fn an_error_names_the_page_of_its_table() {
    for (text, expected) in [
        ("[axis]\nmin = 5", "wiring"),
        ("[daemon]\nlisten = 5", "daemon"),
        ("[daemon]\n[daemon.ros2]\ndds = 'yes'", "ros2"),
        ("[daemon.ros2]\n[lidar]\nrpm = 'fast'", "wiring"),
        ("[daemon", "daemon"),
    ] {
        let error = toml::from_str::<Config>(text).unwrap_err();
        assert_eq!(page(text, &error), expected, "{text}");
    }
}
