//! The kernel's CAN interfaces, from sysfs.

use std::fs;
use std::path::Path;

/// Type of a CAN interface in sysfs: `ARPHRD_CAN` of the kernel's `if_arp.h`.
const CAN: &str = "280";
/// `IFF_UP` of the kernel's `if.h`.
const UP: u32 = 1;

/// A CAN interface of the kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CanInterface {
    /// Its name, such as `can0`.
    pub name: String,
    /// Whether it is up.
    pub up: bool,
}

/// The CAN interfaces in order of their names.
#[must_use]
pub fn interfaces() -> Vec<CanInterface> {
    interfaces_in(Path::new("/sys"))
}

fn interfaces_in(sysfs: &Path) -> Vec<CanInterface> {
    let Ok(entries) = fs::read_dir(sysfs.join("class/net")) else {
        return Vec::new();
    };
    let mut found: Vec<_> = entries
        .flatten()
        .filter(|entry| read(&entry.path().join("type")).is_some_and(|kind| kind == CAN))
        .map(|entry| CanInterface {
            name: entry.file_name().to_string_lossy().into_owned(),
            up: is_up(&entry.path()),
        })
        .collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

fn is_up(interface: &Path) -> bool {
    read(&interface.join("flags"))
        .and_then(|flags| u32::from_str_radix(flags.strip_prefix("0x")?, 16).ok())
        .is_some_and(|flags| flags & UP != 0)
}

fn read(file: &Path) -> Option<String> {
    Some(fs::read_to_string(file).ok()?.trim().to_owned())
}

/// The command that brings the interface up, as administrator.
#[must_use]
pub fn up_command(name: &str) -> String {
    if name.starts_with("vcan") {
        format!("sudo ip link set {name} up")
    } else {
        format!("sudo ip link set {name} up type can bitrate 1000000")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_interfaces_are_ignored() {
        let sysfs = tempfile::tempdir().unwrap();
        for (name, kind, flags) in [
            ("vcan0", "280\n", "0xc1\n"),
            ("can0", "280\n", "0x40080\n"),
            ("eth0", "1\n", "0x1003\n"),
        ] {
            let folder = sysfs.path().join("class/net").join(name);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("type"), kind).unwrap();
            fs::write(folder.join("flags"), flags).unwrap();
        }
        let found = interfaces_in(sysfs.path());
        let [can0, vcan0] = [("can0", false), ("vcan0", true)].map(|(name, up)| CanInterface {
            name: name.to_owned(),
            up,
        });
        assert_eq!(found, [can0.clone(), vcan0.clone()]);
        assert_eq!(
            up_command(&can0.name),
            "sudo ip link set can0 up type can bitrate 1000000"
        );
        assert_eq!(up_command(&vcan0.name), "sudo ip link set vcan0 up");
        assert_eq!(interfaces_in(&sysfs.path().join("none")), []);
    }
}
