//! Where the commands find the daemon: a Unix socket named after the drive's port.

use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use crate::config::{Device, DeviceKind};
use crate::failure::Failure;
use crate::ports;

/// Where a service's socket is.
const SERVICE: &str = "/run/velomotion";

/// Folder in which a daemon makes its socket.
#[must_use]
pub fn folder() -> PathBuf {
    let var = |name| std::env::var_os(name).map(PathBuf::from);
    var("RUNTIME_DIRECTORY")
        .or_else(|| var("XDG_RUNTIME_DIR"))
        .unwrap_or_else(std::env::temp_dir)
}

/// The socket's name for a device.
///
/// # Errors
/// Where the profile names no port.
pub fn name(profile: &str, device: &Device) -> Result<String, Failure> {
    let place = match device.kind {
        DeviceKind::Sim => PathBuf::from(format!("-{profile}")),
        _ => ports::place(profile, device)?,
    };
    let place = place.canonicalize().unwrap_or(place);
    let name: String = place
        .to_string_lossy()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    Ok(format!("velomotion{name}.daemon.sock"))
}

/// The sockets where a daemon that has the device may listen, the likeliest first.
#[must_use]
pub fn candidates(profile: &str, device: &Device) -> Vec<PathBuf> {
    let Ok(name) = name(profile, device) else {
        return Vec::new();
    };
    let mut folders = vec![folder()];
    if folders.iter().all(|folder| folder != Path::new(SERVICE)) {
        folders.push(SERVICE.into());
    }
    let sockets = folders.into_iter().map(|folder| folder.join(&name));
    sockets.filter(|socket| is_trusted(socket)).collect()
}

/// Whether whoever made it may be told what to do: this user, or the system. The temporary folder is everybody's.
fn is_trusted(socket: &Path) -> bool {
    let owner = std::fs::metadata(socket).map(|there| there.uid());
    let own = std::fs::metadata("/proc/self").map(|there| there.uid());
    match (owner, own) {
        (Ok(owner), Ok(own)) => owner == own || owner == 0 || socket.starts_with(SERVICE),
        _ => false,
    }
}
