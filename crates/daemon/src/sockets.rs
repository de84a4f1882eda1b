//! Paths of the daemon's Unix socket, which is named after the drive's port.

use std::collections::BTreeSet;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use io::discover::{ConnectedDevices, discover};

use engine::config::{Device, DeviceKind};
use engine::devices::drive_port::{self as ports, Search};
use engine::failure::Failure;

/// Folder of a service's socket.
const SERVICE: &str = "/run/velomotion";
/// Folders of the sockets of logged-in users, named by user id (systemd's pam_systemd(8)).
const USERS: &str = "/run/user";

/// The machine's Unix sockets (proc_net_unix(5)): the path is the last field.
const LISTENING: &str = "/proc/net/unix";

/// The files of this process belong to its user.
const SELF: &str = "/proc/self";

/// Name for a drive that is searched on USB.
const LOOKED_FOR: &str = "-usb-epos2";

/// Folder in which a daemon makes its socket.
#[must_use]
pub fn folder() -> PathBuf {
    let var = |name| std::env::var_os(name).map(PathBuf::from);
    var("RUNTIME_DIRECTORY")
        .or_else(|| var("XDG_RUNTIME_DIR"))
        .unwrap_or_else(std::env::temp_dir)
}

/// The socket's name for a device: its port as in the configuration. The target of a symbolic link
/// changes when the cable returns elsewhere and is absent before.
///
/// # Errors
/// Returns a failure if the profile names no port.
pub fn name(profile: &str, device: &Device) -> Result<String, Failure> {
    Ok(name_of(&port_path(profile, device)?))
}

/// The path behind the socket's name. A drive that is searched on USB has no fixed port.
fn port_path(profile: &str, device: &Device) -> Result<PathBuf, Failure> {
    match device.kind {
        DeviceKind::Sim => Ok(PathBuf::from(format!("-{profile}"))),
        _ if device.is_looked_for() => Ok(PathBuf::from(LOOKED_FOR)),
        _ => ports::port_path(profile, device, Search::Once, &ConnectedDevices::default),
    }
}

fn name_of(place: &Path) -> String {
    let name: String = place
        .to_string_lossy()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    format!("velomotion{name}.daemon.sock")
}

/// Possible sockets of a daemon that has the device, likeliest first. The daemon may use another of
/// udev's names for the port.
#[must_use]
pub fn candidates(profile: &str, device: &Device) -> Vec<PathBuf> {
    let Ok(named) = port_path(profile, device) else {
        return Vec::new();
    };
    let mut places = vec![named];
    if device.is_looked_for() {
        places.extend(ports::port_path(profile, device, Search::Once, &discover));
    }
    let others: Vec<PathBuf> = places.iter().flat_map(|place| other_names(place)).collect();
    places.extend(others);
    trusted(
        device.kind,
        places.iter().map(|place| name_of(place)).collect(),
    )
}

/// Possible sockets of a daemon that searches its drive: it may have found the one at `device`'s
/// port.
#[must_use]
pub fn looking(device: &Device) -> Vec<PathBuf> {
    match device.kind == DeviceKind::Usb && device.port.is_some() {
        true => trusted(device.kind, vec![name_of(Path::new(LOOKED_FOR))]),
        false => Vec::new(),
    }
}

/// Existing trusted sockets with these names in all socket folders. A port may be held by a process
/// with another environment (sudo, systemd, cron); simulated devices belong to one environment.
fn trusted(kind: DeviceKind, names: Vec<String>) -> Vec<PathBuf> {
    let mut folders = vec![folder(), PathBuf::from(SERVICE)];
    if kind != DeviceKind::Sim {
        let users = std::fs::read_dir(USERS).into_iter().flatten().flatten();
        folders.extend(users.map(|user| user.path()));
        folders.push(std::env::temp_dir());
    }
    let mut seen = BTreeSet::new();
    folders.retain(|folder| seen.insert(folder.clone()));
    let mut sockets: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| names.iter().map(move |name| folder.join(name)))
        .collect();
    if kind != DeviceKind::Sim {
        let table = std::fs::read_to_string(LISTENING).unwrap_or_default();
        // Accepted connections have the path, too.
        for socket in listening(&table, &names) {
            if !sockets.contains(&socket) {
                sockets.push(socket);
            }
        }
    }
    sockets.retain(|socket| is_trusted(socket));
    sockets
}

/// Sockets of a table with these names, whatever the folders that their processes chose.
fn listening(table: &str, names: &[String]) -> impl Iterator<Item = PathBuf> {
    let paths = table.lines().filter_map(|line| {
        let begin = line.find(" /")?;
        Some(Path::new(&line[begin + 1..]))
    });
    paths
        .filter(|path| names.iter().any(|name| path.ends_with(name)))
        .map(Path::to_owned)
}

/// Gives a socket the group of the drive's port, whose members may open the port: they may stop the
/// axis that a command of root moves. Root alone can do so; in a folder of another user its socket
/// could be exchanged for another file.
pub(crate) fn share_with_port(socket: &Path, profile: &str, device: &Device) {
    let is_of_root = owner(SELF) == Some(0) && socket.parent().and_then(owner) == Some(0);
    let port = match device.is_looked_for() {
        true => ports::port_path(profile, device, Search::Once, &discover),
        false => port_path(profile, device),
    };
    // A CAN interface has a name and no path.
    let port = port.ok().filter(|port| is_of_root && port.is_absolute());
    if let Some(group) = port.and_then(|port| Some(std::fs::metadata(port).ok()?.gid()))
        && let Err(error) = std::os::unix::fs::lchown(socket, None, Some(group))
    {
        tracing::debug!("the socket {} stays with root: {error}", socket.display());
    }
}

/// The target of a port's symbolic link, and other links to it in `/dev` and in the port's folder.
fn other_names(place: &Path) -> Vec<PathBuf> {
    let Ok(real) = place.canonicalize() else {
        return Vec::new();
    };
    let folders = [Some(Path::new("/dev")), place.parent()];
    let entries = folders
        .into_iter()
        .flatten()
        .filter_map(|folder| std::fs::read_dir(folder).ok());
    let links = entries
        .flatten()
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()))
        .map(|entry| entry.path())
        .filter(|link| link.canonicalize().is_ok_and(|leads| leads == real));
    let mut names: Vec<PathBuf> = std::iter::once(real.clone()).chain(links).collect();
    names.sort();
    names.dedup();
    names.retain(|name| name != place);
    names
}

/// Whether the socket exists and its owner is trusted.
fn is_trusted(socket: &Path) -> bool {
    match (owner(socket), owner(SELF)) {
        (Some(owner), Some(own)) => is_trusted_owner(socket, owner, own),
        _ => false,
    }
}

/// Whether the owner is this user or root, or, for root, the user of the socket's folder. Any user
/// can write to the temporary folder.
fn is_trusted_owner(socket: &Path, owner: u32, own: u32) -> bool {
    owner == own
        || owner == 0
        || socket.starts_with(SERVICE)
        || own == 0 && socket.starts_with(Path::new(USERS).join(owner.to_string()))
}

/// Whether the listener at a trusted socket is its owner, this user or root.
pub(crate) fn is_trusted_user(socket: &Path, user: u32) -> bool {
    user == 0 || owner(socket) == Some(user) || owner(SELF) == Some(user)
}

/// The user id of a file's owner.
fn owner(file: impl AsRef<Path>) -> Option<u32> {
    Some(std::fs::metadata(file).ok()?.uid())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_names_of_a_port_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().canonicalize().unwrap().join(name);
        std::fs::write(path("ttyUSB0"), "").unwrap();
        std::fs::write(path("ttyUSB1"), "").unwrap();
        std::os::unix::fs::symlink("ttyUSB0", path("velomotion-epos2")).unwrap();
        std::os::unix::fs::symlink("ttyUSB1", path("other")).unwrap();
        // Each name finds the other; without a cable only the configured one exists.
        assert_eq!(other_names(&path("ttyUSB0")), [path("velomotion-epos2")],);
        assert_eq!(other_names(&path("velomotion-epos2")), [path("ttyUSB0")]);
        std::fs::remove_file(path("ttyUSB0")).unwrap();
        assert!(other_names(&path("velomotion-epos2")).is_empty());
        assert_eq!(
            name_of(Path::new("/dev/velomotion-epos2")),
            "velomotion-dev-velomotion-epos2.daemon.sock"
        );
    }

    #[test]
    fn sockets_in_any_folder_are_found_by_name() {
        let table = "Num       RefCount Protocol Flags    Type St Inode Path\n\
            0000000000000000: 00000002 00000000 00010000 0001 01 20 /a b/velomotion-x.daemon.sock\n\
            0000000000000000: 00000002 00000000 00010000 0001 01 21 @/abstract/velomotion-x.daemon.sock\n\
            0000000000000000: 00000002 00000000 00010000 0001 01 22\n\
            0000000000000000: 00000002 00000000 00010000 0001 01 23 /a/other.sock\n";
        let found: Vec<PathBuf> =
            listening(table, &["velomotion-x.daemon.sock".to_owned()]).collect();
        assert_eq!(found, [PathBuf::from("/a b/velomotion-x.daemon.sock")]);
    }

    #[test]
    fn sockets_of_other_users_are_not_trusted() {
        for (socket, owner, own, is_trusted) in [
            ("/tmp/velomotion.sock", 1000, 1000, true),
            ("/tmp/velomotion.sock", 0, 1000, true),
            ("/tmp/velomotion.sock", 1001, 1000, false),
            // Not even for root, unless it is in that user's own folder.
            ("/tmp/velomotion.sock", 1001, 0, false),
            ("/run/user/1001/velomotion.sock", 1001, 0, true),
            ("/run/user/1000/velomotion.sock", 1001, 0, false),
            ("/run/user/1001/velomotion.sock", 1001, 1000, false),
            // The service's user; other users cannot write to its folder.
            ("/run/velomotion/velomotion.sock", 998, 1000, true),
            ("/run/velomotion-other/velomotion.sock", 998, 1000, false),
        ] {
            let found = is_trusted_owner(Path::new(socket), owner, own);
            assert_eq!(found, is_trusted, "{socket} of {owner} for {own}");
        }
        let folder = tempfile::tempdir().unwrap();
        assert!(is_trusted(folder.path()));
        assert!(!is_trusted(&folder.path().join("absent")));
    }

    #[test]
    fn a_listener_is_trusted_if_it_is_root_this_user_or_the_owner() {
        let folder = tempfile::tempdir().unwrap();
        let own = owner(SELF).unwrap();
        let foreign = own + 4321;
        let absent = folder.path().join("absent");
        for socket in [folder.path(), &absent] {
            assert!(is_trusted_user(socket, 0));
            assert!(is_trusted_user(socket, own));
            assert!(!is_trusted_user(socket, foreign));
        }
        // Only root can give a file away.
        if std::os::unix::fs::chown(folder.path(), Some(foreign), None).is_ok() {
            assert!(is_trusted_user(folder.path(), foreign));
            assert!(!is_trusted(folder.path()));
        }
    }
}
