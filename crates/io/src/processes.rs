//! Other processes of this machine: those that hold a device file, and the one at the other end of
//! a socket.

use std::fs;
use std::os::unix::net::UnixStream;
use std::path::Path;

use nix::sys::socket::getsockopt;
use nix::sys::socket::sockopt::PeerCredentials;

/// The process that listens at a Unix socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SocketOwner {
    /// Process id; 0 if it is in a container.
    pub pid: u32,
    /// User id.
    pub uid: u32,
}

impl SocketOwner {
    /// The process at the other end of a connection, by the kernel's word.
    #[must_use]
    pub fn of(stream: &UnixStream) -> Option<Self> {
        let owner = getsockopt(stream, PeerCredentials).ok()?;
        Some(Self {
            pid: u32::try_from(owner.pid()).unwrap_or(0),
            uid: owner.uid(),
        })
    }
}

/// Whether a process has a file open; `None` if its open files are not visible to this user.
#[must_use]
pub fn has_open(pid: u32, file: &Path) -> Option<bool> {
    has_handle(pid, &file.canonicalize().ok()?)
}

/// The processes that have a file open, as far as this user may see them. The program that made a
/// pseudo-terminal, a simulated device, is none of its users.
#[must_use]
pub fn holders(file: &Path) -> Vec<u32> {
    let Ok(real) = file.canonicalize() else {
        return Vec::new();
    };
    let mut holders = holders_of(&real);
    if let Ok(index) = real.strip_prefix("/dev/pts") {
        holders.retain(|pid| !has_device_side(*pid, index));
    }
    holders
}

/// Whether a process has the device side of the pseudo-terminal with this number (pts(4)).
fn has_device_side(pid: u32, index: &Path) -> bool {
    let infos = fs::read_dir(format!("/proc/{pid}/fdinfo"));
    infos.into_iter().flatten().flatten().any(|info| {
        let text = fs::read_to_string(info.path()).unwrap_or_default();
        let number = text
            .lines()
            .find_map(|line| line.strip_prefix("tty-index:"));
        number.is_some_and(|number| Path::new(number.trim()) == index)
    })
}

/// Names and ids of the processes that have a file open, for messages.
#[must_use]
pub fn descriptions(file: &Path) -> String {
    describe(&holders(file))
}

/// Names and ids of the processes that listen on a UDP port, for messages.
pub(crate) fn udp_descriptions(port: u16) -> String {
    let sockets = fs::read_to_string("/proc/net/udp").unwrap_or_default();
    let holders = sockets
        .lines()
        .filter_map(|line| socket_inode(line, port))
        .flat_map(|inode| holders_of(Path::new(&format!("socket:[{inode}]"))));
    describe(&holders.collect::<Vec<_>>())
}

/// The inode of a UDP socket in a line of `/proc/net/udp` (proc_net_udp(5)), if it is bound to the
/// port: the local address is field 1, the inode field 9.
fn socket_inode(line: &str, port: u16) -> Option<&str> {
    let mut fields = line.split_whitespace();
    let (_, local) = fields.nth(1)?.split_once(':')?;
    if u16::from_str_radix(local, 16) != Ok(port) {
        return None;
    }
    fields.nth(7)
}

/// Whether one of a process's open files is `target`, as `/proc` names it.
fn has_handle(pid: u32, target: &Path) -> Option<bool> {
    let open = fs::read_dir(format!("/proc/{pid}/fd")).ok()?;
    let mut files = open
        .flatten()
        .filter_map(|fd| fs::read_link(fd.path()).ok());
    Some(files.any(|open| open == target))
}

fn holders_of(target: &Path) -> Vec<u32> {
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let pids = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    pids.filter(|pid| has_handle(*pid, target) == Some(true))
        .collect()
}

fn describe(pids: &[u32]) -> String {
    let name = |pid: &u32| {
        let name = fs::read_to_string(format!("/proc/{pid}/comm"));
        let name = name.as_deref().map_or("a program", str::trim);
        format!("{name} (pid {pid})")
    };
    match pids {
        [] => "another program".to_owned(),
        pids => pids.iter().map(name).collect::<Vec<_>>().join(" and "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::net::UnixListener;

    #[test]
    fn this_process_holds_its_own_files_and_sockets() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let own = std::process::id();
        let file = fs::File::create(&path).unwrap();
        assert_eq!(has_open(own, &link), Some(true));
        assert_eq!(holders(&link), [own]);
        drop(file);
        assert_eq!(has_open(own, &link), Some(false));
        assert!(holders(&path).is_empty());

        let udp = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
        let named = udp_descriptions(udp.local_addr().unwrap().port());
        assert!(named.ends_with(&format!("(pid {own})")), "{named}");

        let listener = UnixListener::bind(folder.path().join("socket")).unwrap();
        let stream = UnixStream::connect(folder.path().join("socket")).unwrap();
        assert_eq!(SocketOwner::of(&stream).unwrap().pid, own);
        drop(listener);
    }
}
