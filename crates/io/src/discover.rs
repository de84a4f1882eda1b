//! Discovery of connected devices: serial ports, and EPOS2 units on USB.
//!
//! Linux's `ftdi_sio` driver does not know the EPOS2's product number. A drive may therefore be on
//! the bus without a serial port, which only sysfs shows. Devices are not opened.

use std::fs;
use std::path::{Path, PathBuf};

use serialport::SerialPortType;

/// USB vendor of the EPOS2 (FTDI).
pub const EPOS2_VENDOR: u16 = 0x0403;
/// USB product of the EPOS2.
pub const EPOS2_PRODUCT: u16 = 0xA8B0;

/// Descriptor of a USB device.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct UsbIdentity {
    /// Vendor number.
    pub vendor: u16,
    /// Product number.
    pub product: u16,
}

/// A serial port of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SerialPortFound {
    /// Its path.
    pub path: PathBuf,
    /// Its USB device, if it is one.
    pub usb: Option<UsbIdentity>,
}

/// An EPOS2 on USB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Epos2Found {
    /// Position on the bus, such as `1-4.2`.
    pub bus_place: String,
    /// Its serial port; `None` without a driver.
    pub port: Option<PathBuf>,
}

/// Connected devices, in order of their names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConnectedDevices {
    /// Serial ports of any device.
    pub serial_ports: Vec<SerialPortFound>,
    /// EPOS2 units on USB.
    pub epos2: Vec<Epos2Found>,
    /// Failed lookups, with the reason.
    pub problems: Vec<String>,
}

/// Lists the devices of this machine.
#[must_use]
pub fn discover() -> ConnectedDevices {
    let mut findings = ConnectedDevices::default();
    match serial_ports() {
        Ok(ports) => findings.serial_ports = ports,
        Err(e) => findings.problems.push(format!("serial ports: {e}")),
    }
    match find_epos2(Path::new("/sys/bus/usb/devices")) {
        Ok(units) => findings.epos2 = units,
        Err(e) => findings.problems.push(format!("USB: {e}")),
    }
    findings
}

fn serial_ports() -> std::io::Result<Vec<SerialPortFound>> {
    // serialport (4.10) panics if this directory is unreadable.
    fs::read_dir("/sys/class/tty")?;
    let mut ports: Vec<_> = serialport::available_ports()?
        .into_iter()
        .map(serial_port)
        .collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(ports)
}

fn serial_port(found: serialport::SerialPortInfo) -> SerialPortFound {
    let usb = match found.port_type {
        SerialPortType::UsbPort(usb) => Some(UsbIdentity {
            vendor: usb.vid,
            product: usb.pid,
        }),
        _ => None,
    };
    SerialPortFound {
        path: PathBuf::from(found.port_name),
        usb,
    }
}

/// The EPOS2 units in sysfs's list of USB devices; none if the machine has no such list
/// (containers).
fn find_epos2(devices: &Path) -> std::io::Result<Vec<Epos2Found>> {
    let mut units = Vec::new();
    let entries = match fs::read_dir(devices) {
        Ok(entries) => entries,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(units),
        Err(e) => return Err(e),
    };
    for entry in entries {
        let device = entry?.path();
        let number = |file| u16::from_str_radix(&attribute(&device, file)?, 16).ok();
        let identity = (number("idVendor"), number("idProduct"));
        if identity != (Some(EPOS2_VENDOR), Some(EPOS2_PRODUCT)) {
            continue;
        }
        let bus_place = device
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        units.push(Epos2Found {
            port: port_of(&device, &bus_place),
            bus_place,
        });
    }
    units.sort_by(|a, b| a.bus_place.cmp(&b.bus_place));
    Ok(units)
}

/// The serial port under a USB device: `1-4/1-4:1.0/ttyUSB0`, or `1-4/1-4:1.0/tty/ttyACM0`.
fn port_of(device: &Path, bus_place: &str) -> Option<PathBuf> {
    let prefix = format!("{bus_place}:");
    for interface in names(device).iter().filter(|n| n.starts_with(&prefix)) {
        let interface = device.join(interface);
        for folder in [interface.clone(), interface.join("tty")] {
            let port = names(&folder)
                .into_iter()
                .find(|name| name.starts_with("tty") && name.len() > 3);
            if let Some(port) = port {
                return Some(Path::new("/dev").join(port));
            }
        }
    }
    None
}

/// The sorted names in a directory; none if it is unreadable.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    names
}

/// Content of a sysfs file.
fn attribute(device: &Path, file: &str) -> Option<String> {
    let text = fs::read_to_string(device.join(file)).ok()?;
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device(devices: &Path, place: &str, product: &str) -> PathBuf {
        let folder = devices.join(place);
        fs::create_dir_all(&folder).unwrap();
        for (file, text) in [
            ("idVendor", "0403"),
            ("idProduct", product),
            ("product", "maxon motor EPOS2"),
            ("serial", "123456"),
        ] {
            fs::write(folder.join(file), format!("{text}\n")).unwrap();
        }
        folder
    }

    #[test]
    fn units_are_found_with_and_without_a_port() {
        let sysfs = tempfile::tempdir().unwrap();
        let with_port = device(sysfs.path(), "1-4.2", "a8b0");
        fs::create_dir_all(with_port.join("1-4.2:1.0/ttyUSB0")).unwrap();
        device(sysfs.path(), "1-1", "a8b0");
        let acm = device(sysfs.path(), "2-1", "a8b0");
        fs::create_dir_all(acm.join("2-1:1.0/tty/ttyACM3")).unwrap();
        device(sysfs.path(), "1-2", "6001"); // an ordinary FTDI adapter
        fs::create_dir_all(sysfs.path().join("1-4.2:1.0")).unwrap(); // sysfs lists interfaces too
        let found = find_epos2(sysfs.path()).unwrap();
        let summary: Vec<_> = found
            .iter()
            .map(|unit| (unit.bus_place.as_str(), unit.port.as_deref()))
            .collect();
        assert_eq!(
            summary,
            [
                ("1-1", None),
                ("1-4.2", Some(Path::new("/dev/ttyUSB0"))),
                ("2-1", Some(Path::new("/dev/ttyACM3"))),
            ]
        );
    }

    #[test]
    fn machines_without_usb_have_no_units() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(find_epos2(&folder.path().join("missing")).unwrap(), []);
    }

    #[test]
    fn serial_ports_are_paths_under_dev() {
        let found = serial_port(serialport::SerialPortInfo {
            port_name: "/dev/ttyUSB0".to_owned(),
            port_type: SerialPortType::UsbPort(serialport::UsbPortInfo {
                vid: EPOS2_VENDOR,
                pid: EPOS2_PRODUCT,
                serial_number: None,
                manufacturer: None,
                product: Some("maxon motor EPOS2".to_owned()),
            }),
        });
        assert_eq!(found.path, Path::new("/dev/ttyUSB0"));
        assert_eq!(found.usb.map(|usb| usb.product), Some(EPOS2_PRODUCT));
        for port in discover().serial_ports {
            assert!(port.path.starts_with("/dev"), "{port:?}");
        }
    }
}
