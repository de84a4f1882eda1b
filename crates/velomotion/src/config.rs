//! The configuration file: which devices there are and how the scanner is built.
//!
//! Values of the command line win over the file, the file over what is built in. A key that is not known is an error with
//! its line: a misspelt limit must not pass for none.

use std::collections::BTreeMap;
use std::fmt;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};

use scanner::config::{AxisConfig, LidarConfig, MountConfig};
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::daemon::settings::Settings;
use crate::failure::{Failure, Kind};

/// The whole file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// `device = "NAME"`, or a `[device.NAME]` table each and `[device] default = "NAME"`.
    pub device: Devices,
    /// How the lidar sits on the tilt axis.
    pub mount: MountConfig,
    /// How well the lidar measures; software devices say it themselves.
    pub lidar: LidarConfig,
    /// The tilt axis.
    pub axis: Axis,
    /// The daemon.
    pub daemon: Settings,
}

/// The devices of a configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Devices {
    /// What is used without `--device`.
    pub default: Option<String>,
    /// Profiles by name.
    pub profiles: BTreeMap<String, Device>,
}

/// One `[device.NAME]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Device {
    /// How the drive is attached.
    pub kind: DeviceKind,
    /// Path of the drive's serial port, or the SLCAN adapter's.
    pub port: Option<PathBuf>,
    /// Name of the CAN interface of a drive of kind `can`.
    pub interface: Option<String>,
    /// Speed of the serial port, where it is not the factory's.
    pub baud: Option<u32>,
    /// Local address on which the lidar's packets arrive.
    #[serde(default = "any_address")]
    pub lidar: Ipv4Addr,
    /// Multicast group that the lidar sends to; none where it sends to this machine alone or to all.
    pub lidar_group: Option<Ipv4Addr>,
    /// The lidar's own address, where others send to the same ports; none: whoever sends.
    pub lidar_source: Option<Ipv4Addr>,
    /// UDP port of the lidar's data packets, where it is not the factory's.
    pub data_port: Option<u16>,
    /// UDP port of its position packets, where it is not the factory's.
    pub position_port: Option<u16>,
    /// Acceleration used without `--accel`, degrees per second squared.
    #[serde(default = "gentle")]
    pub accel_deg_s2: f64,
}

/// How the drive is attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// Software EPOS2 and software VLP-16.
    Sim,
    /// EPOS2 on USB.
    Usb,
    /// EPOS2 on RS232.
    Rs232,
    /// EPOS2 on CAN, behind an SLCAN adapter on a serial port.
    Slcan,
    /// EPOS2 on CAN, on an interface of the kernel.
    Can,
}

/// The tilt axis: encoder, gear, limits.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Axis {
    /// Node id of the drive.
    pub node: u8,
    /// Lines of the encoder on the motor shaft.
    pub encoder_lines: u32,
    /// Motor turns and axis turns.
    pub gear: [u32; 2],
    /// Smallest tilt angle allowed, degrees.
    pub min_deg: f64,
    /// Largest tilt angle allowed, degrees.
    pub max_deg: f64,
    /// Largest tilt speed allowed, degrees per second.
    pub max_speed_deg_s: f64,
    /// Largest tilt acceleration allowed, degrees per second squared.
    pub max_accel_deg_s2: f64,
    /// Deceleration of a quick stop (Ctrl-C, limit switch, fault), degrees per second squared.
    pub quick_stop_deg_s2: f64,
    /// Digital output of the drive (1..=5) that opens the brake; absent without brake. From the factory no output is one.
    pub brake_output: Option<u8>,
    /// The limit switches; without the table they are where the factory expects them.
    pub limit_switches: LimitSwitches,
    /// How the axis finds its angle after power-on.
    pub homing: Homing,
}

/// The limit switches' digital inputs (1..=9). In a table that is there, a switch that is left out does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSwitches {
    /// Input of the switch at the lower end.
    #[serde(default)]
    pub negative: Option<u8>,
    /// Input of the switch at the upper end.
    #[serde(default)]
    pub positive: Option<u8>,
    /// Whether the inputs are low while a switch is pressed, so that a broken wire stops the axis too.
    #[serde(default)]
    pub normally_closed: bool,
}

/// How the axis finds its angle.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Homing {
    /// Homing method (object 6098).
    pub method: i8,
    /// Tilt angle at the place that homing finds, degrees.
    pub at_deg: f64,
    /// Tilt angle to go to from there, degrees.
    pub to_deg: f64,
    /// Speed towards the switch, degrees per second.
    pub speed_deg_s: f64,
    /// Speed over its edge, degrees per second.
    pub edge_speed_deg_s: f64,
}

impl Default for Axis {
    fn default() -> Self {
        let scan = AxisConfig::default();
        Self {
            node: scan.node,
            encoder_lines: scan.encoder_lines,
            gear: scan.gear,
            min_deg: -45.0,
            max_deg: 0.0,
            max_speed_deg_s: 98.0,
            max_accel_deg_s2: 10_000.0,
            quick_stop_deg_s2: 500.0,
            brake_output: None,
            limit_switches: LimitSwitches::default(),
            homing: Homing::default(),
        }
    }
}

impl Default for LimitSwitches {
    /// The factory's choice: inputs 6 and 5, high when pressed (2070, 2071).
    fn default() -> Self {
        Self {
            negative: Some(6),
            positive: Some(5),
            normally_closed: false,
        }
    }
}

impl Default for Homing {
    fn default() -> Self {
        Self {
            method: 18,
            at_deg: 1.0,
            to_deg: 0.0,
            speed_deg_s: 10.0,
            edge_speed_deg_s: 1.0,
        }
    }
}

impl Axis {
    /// The part of it that a log carries.
    #[must_use]
    pub fn scan(&self) -> AxisConfig {
        AxisConfig {
            node: self.node,
            encoder_lines: self.encoder_lines,
            gear: self.gear,
        }
    }
}

impl Device {
    /// The built-in simulator: a head so light that it takes 45 degrees at 56.25 deg/s in 0.81 s.
    #[must_use]
    pub fn simulator() -> Self {
        Self {
            kind: DeviceKind::Sim,
            port: None,
            interface: None,
            baud: None,
            lidar: Ipv4Addr::LOCALHOST,
            lidar_group: None,
            lidar_source: None,
            data_port: None,
            position_port: None,
            accel_deg_s2: 5000.0,
        }
    }

    /// An EPOS2 found on USB.
    #[must_use]
    pub fn usb(port: PathBuf) -> Self {
        Self {
            kind: DeviceKind::Usb,
            port: Some(port),
            lidar: any_address(),
            accel_deg_s2: gentle(),
            ..Self::simulator()
        }
    }
}

fn any_address() -> Ipv4Addr {
    Ipv4Addr::UNSPECIFIED
}

/// The drive's factory setting behind 120:1, 10,000 rpm/s.
fn gentle() -> f64 {
    500.0
}

impl<'de> Deserialize<'de> for Devices {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameOrProfiles;
        impl<'de> Visitor<'de> for NameOrProfiles {
            type Value = Devices;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a device's name, or [device.NAME] tables")
            }
            fn visit_str<E>(self, name: &str) -> Result<Devices, E> {
                Ok(Devices {
                    default: Some(name.to_owned()),
                    profiles: BTreeMap::new(),
                })
            }
            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Devices, M::Error> {
                let mut devices = Devices::default();
                while let Some(key) = map.next_key::<String>()? {
                    if key == "default" {
                        devices.default = Some(map.next_value()?);
                    } else {
                        devices.profiles.insert(key, map.next_value()?);
                    }
                }
                Ok(devices)
            }
        }
        deserializer.deserialize_any(NameOrProfiles)
    }
}

/// Reads the configuration: `file` if given, else the first there is of the usual places, else what is built in.
///
/// # Errors
/// Where a file was named and cannot be read, or any that is read cannot be understood.
pub fn load(file: Option<&Path>) -> Result<Config, Failure> {
    let Some(path) = file.map(Path::to_owned).or_else(usual_place) else {
        return Ok(Config::default());
    };
    let text = std::fs::read_to_string(&path).map_err(|error| {
        Failure::new(
            Kind::BadInput,
            format!("cannot read the configuration {}: {error}", path.display()),
        )
        .help("name a text file that exists with --config, or leave the option out")
    })?;
    let config: Config = toml::from_str(&text).map_err(|error| {
        Failure::new(
            Kind::BadInput,
            format!(
                "the configuration {} cannot be understood:\n{}",
                path.display(),
                error.to_string().trim_end()
            ),
        )
        .help("correct that line; docs/src/wiring.md shows every key")
    })?;
    config.check().map_err(|what| {
        Failure::new(
            Kind::BadInput,
            format!("the configuration {}: {what}", path.display()),
        )
        .help("correct that value; docs/src/wiring.md says what each one means")
    })?;
    Ok(config)
}

impl Config {
    /// Refuses numbers that no scanner has (TOML knows nan and inf).
    fn check(&self) -> Result<(), String> {
        let Axis { homing, .. } = &self.axis;
        for (name, value, low, high) in [
            ("mount.d_m", self.mount.d_m, -10.0, 10.0),
            ("lidar.range_sd_m", self.lidar.range_sd_m, 0.0, 10.0),
            ("axis.min_deg", self.axis.min_deg, -3_600.0, 3_600.0),
            ("axis.max_deg", self.axis.max_deg, -3_600.0, 3_600.0),
            ("axis.homing.at_deg", homing.at_deg, -3_600.0, 3_600.0),
            ("axis.homing.to_deg", homing.to_deg, -3_600.0, 3_600.0),
        ] {
            // Not a number is not within either.
            if !(low..=high).contains(&value) {
                return Err(format!(
                    "{name}: expected a number from {low} to {high}, got {value}"
                ));
            }
        }
        let fastest = self.axis.max_speed_deg_s;
        for (name, value, high) in [
            ("axis.max_speed_deg_s", fastest, 1e6),
            ("axis.max_accel_deg_s2", self.axis.max_accel_deg_s2, 1e9),
            ("axis.quick_stop_deg_s2", self.axis.quick_stop_deg_s2, 1e9),
            ("axis.homing.speed_deg_s", homing.speed_deg_s, fastest),
            (
                "axis.homing.edge_speed_deg_s",
                homing.edge_speed_deg_s,
                fastest,
            ),
        ] {
            // Directions are no business of these: a sign is a mistake.
            if !(value > 0.0 && value <= high) {
                return Err(format!(
                    "{name}: expected a number above 0 up to {high}, got {value}"
                ));
            }
        }
        let devices = self.device.profiles.iter();
        devices
            .map(|(name, device)| device.check(name))
            .find(Result::is_err)
            .unwrap_or(Ok(()))
    }
}

impl Device {
    fn check(&self, name: &str) -> Result<(), String> {
        let accel = self.accel_deg_s2;
        if !(accel > 0.0 && accel <= 1e9) {
            return Err(format!(
                "device.{name}.accel_deg_s2: expected a number above 0 up to 1000000000, got {accel}"
            ));
        }
        let has_none = matches!(self.kind, DeviceKind::Sim | DeviceKind::Can);
        if let Some(baud) = self.baud.filter(|_| has_none) {
            return Err(format!(
                "device.{name}.baud: expected on a serial port only, got {baud} on a device without one"
            ));
        }
        self.check_lidar()
            .map_err(|what| format!("device.{name}.{what}"))
    }

    /// The key and what is wrong with it.
    fn check_lidar(&self) -> Result<(), String> {
        let ports = [
            ("data_port", self.data_port),
            ("position_port", self.position_port),
        ];
        let addresses = [
            ("lidar_group", self.lidar_group),
            ("lidar_source", self.lidar_source),
        ];
        if self.kind == DeviceKind::Sim {
            let port = ports.iter().find(|(_, port)| port.is_some());
            let address = addresses.iter().find(|(_, address)| address.is_some());
            let key = port.map(|(key, _)| key).or(address.map(|(key, _)| key));
            return key.map_or(Ok(()), |key| {
                Err(format!(
                    "{key}: expected with a real lidar only, got it on software devices"
                ))
            });
        }
        if let Some((key, _)) = ports.iter().find(|(_, port)| *port == Some(0)) {
            return Err(format!("{key}: expected a port from 1 to 65535, got 0"));
        }
        if let Some(group) = self.lidar_group.filter(|group| !group.is_multicast()) {
            return Err(format!(
                "lidar_group: expected a multicast address, 224.0.0.0 to 239.255.255.255, got {group}"
            ));
        }
        if self.lidar.is_multicast() {
            return Err(format!(
                "lidar: expected an address of this machine, got the multicast address {}, which belongs into lidar_group",
                self.lidar
            ));
        }
        let nobody = |ip: &Ipv4Addr| ip.is_unspecified() || ip.is_multicast() || ip.is_broadcast();
        if let Some(source) = self.lidar_source.filter(nobody) {
            return Err(format!(
                "lidar_source: expected the lidar's own address, got {source}, which no device has"
            ));
        }
        Ok(())
    }
}

fn usual_place() -> Option<PathBuf> {
    let var = |name| std::env::var_os(name).map(PathBuf::from);
    let user = var("XDG_CONFIG_HOME").or_else(|| var("HOME").map(|home| home.join(".config")));
    [
        Some(PathBuf::from("velomotion.toml")),
        user.map(|dir| dir.join("velomotion/velomotion.toml")),
        Some(PathBuf::from("/etc/velomotion/velomotion.toml")),
    ]
    .into_iter()
    .flatten()
    .find(|path| path.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checkouts_own_file_says_sim_and_nothing_but_defaults() {
        let text = include_str!("../../../velomotion.toml");
        let config: Config = toml::from_str(text).unwrap();
        assert_eq!(config.device.default.as_deref(), Some("sim"));
        let braked = Axis {
            brake_output: Some(1),
            ..Axis::default()
        };
        assert_eq!(config.axis, braked);
        assert_eq!(config.mount, MountConfig::default());
        assert_eq!(config.lidar, LidarConfig::default());
    }

    #[test]
    fn numbers_that_no_scanner_has_are_refused() {
        for (text, key) in [
            ("[mount]\nd_m = nan", "mount.d_m"),
            ("[axis]\nmin_deg = -inf", "axis.min_deg"),
            ("[lidar]\nrange_sd_m = -0.01", "lidar.range_sd_m"),
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
            let said = config.check().unwrap_err();
            assert!(said.starts_with(key), "{text}: {said}");
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
    fn a_brake_and_a_switch_that_are_not_named_are_not_there() {
        let axis = |text: &str| toml::from_str::<Config>(text).unwrap().axis;
        assert_eq!(axis("").brake_output, None);
        assert_eq!(axis("[axis]\nnode = 2").brake_output, None);
        let of = |text| axis(text).limit_switches;
        assert_eq!(of("[axis]\nnode = 2"), LimitSwitches::default());
        let one = LimitSwitches {
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
    fn device_is_a_name_or_tables() {
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
        // Nor does a value that is none pass.
        for (key, what) in [
            ("data_port = 70000", "70000"),
            ("lidar_group = '239.1.2'", "IPv4"),
        ] {
            let text = format!("[device.a]\nkind = 'usb'\n{key}");
            let error = toml::from_str::<Config>(&text).unwrap_err().to_string();
            assert!(error.contains("line 3") && error.contains(what), "{error}");
        }
    }
}
