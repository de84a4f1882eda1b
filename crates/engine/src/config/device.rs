//! `[device]`: device profiles.

use std::collections::BTreeMap;
use std::fmt;
use std::net::Ipv4Addr;
use std::path::PathBuf;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::positive;

/// The devices of a configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Devices {
    /// Profile used without `--device`.
    pub default: Option<String>,
    /// Profiles by name.
    pub profiles: BTreeMap<String, Device>,
}

/// One `[device.NAME]` table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Device {
    /// Connection of the drive.
    pub kind: DeviceKind,
    /// Serial port of the drive or the SLCAN adapter. Without it, kind `usb` searches for an EPOS2
    /// on USB.
    pub port: Option<PathBuf>,
    /// CAN interface of a drive of kind `can`.
    pub interface: Option<String>,
    /// Baud rate of the serial port; the factory's without it.
    pub baud: Option<u32>,
    /// Local address that receives the lidar's packets.
    #[serde(default = "any_address")]
    pub lidar: Ipv4Addr,
    /// Multicast group of the lidar, if any.
    pub lidar_group: Option<Ipv4Addr>,
    /// Address of the lidar; any sender is accepted without it.
    pub lidar_source: Option<Ipv4Addr>,
    /// UDP port of data packets; the factory's without it.
    pub data_port: Option<u16>,
    /// UDP port of position packets; the factory's without it.
    pub position_port: Option<u16>,
    /// Acceleration used without `--accel`, degrees per second squared.
    #[serde(default = "default_acceleration")]
    pub accel_deg_s2: f64,
}

/// Connection of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// Simulated EPOS2 and VLP-16.
    Sim,
    /// EPOS2 on USB.
    Usb,
    /// EPOS2 on RS232.
    Rs232,
    /// EPOS2 on CAN, behind an SLCAN adapter on a serial port.
    Slcan,
    /// EPOS2 on CAN, on a kernel interface.
    Can,
}

impl Device {
    /// The built-in simulator, with the drive's factory ramps: a sweep of 45 degrees at 56.25 deg/s
    /// takes 0.1 s more than with 5000 deg/s2, and its largest hole is half as wide.
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
            accel_deg_s2: default_acceleration(),
        }
    }

    /// The EPOS2 found on USB, on any port.
    #[must_use]
    pub fn found() -> Self {
        Self {
            kind: DeviceKind::Usb,
            lidar: any_address(),
            ..Self::simulator()
        }
    }

    /// Whether the drive is searched for on USB.
    #[must_use]
    pub fn is_looked_for(&self) -> bool {
        self.kind == DeviceKind::Usb && self.port.is_none()
    }
}

fn any_address() -> Ipv4Addr {
    Ipv4Addr::UNSPECIFIED
}

/// Factory setting of the drive behind a 120:1 gear: 10,000 rpm/s.
fn default_acceleration() -> f64 {
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

impl Device {
    /// Refuses inconsistent keys and impossible values.
    pub(super) fn check(&self, name: &str) -> Result<(), String> {
        let accel = format!("device.{name}.accel_deg_s2");
        positive(&accel, self.accel_deg_s2, 1e9)?;
        let has_none = matches!(self.kind, DeviceKind::Sim | DeviceKind::Can);
        if let Some(baud) = self.baud.filter(|_| has_none) {
            return Err(format!(
                "device.{name}.baud: expected on a serial port only, got {baud} on a device without one"
            ));
        }
        self.check_lidar()
            .map_err(|what| format!("device.{name}.{what}"))
    }

    /// Checks the lidar's keys.
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
                    "{key}: expected with a real lidar only, got it on simulated devices"
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
                "lidar: expected an address of this machine, got the multicast address {}, which belongs in lidar_group",
                self.lidar
            ));
        }
        let no_sender =
            |ip: &Ipv4Addr| ip.is_unspecified() || ip.is_multicast() || ip.is_broadcast();
        if let Some(source) = self.lidar_source.filter(no_sender) {
            return Err(format!(
                "lidar_source: expected the lidar's own address, got {source}, which no device has"
            ));
        }
        Ok(())
    }
}
