//! The daemon as a service: notifications to the service manager, and logging to journald.

use std::fs::File;
use std::os::unix::fs::MetadataExt;
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::rig::{place, velomotion, wait};

/// The service manager's socket, as in sd_notify(3).
struct Manager(UnixDatagram);

impl Manager {
    fn new(socket: &Path) -> Self {
        let socket = UnixDatagram::bind(socket).unwrap();
        socket
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        Self(socket)
    }

    /// The lines of the next message.
    fn messages(&self) -> Vec<String> {
        let mut bytes = [0; 4096];
        let length = self.0.recv(&mut bytes).unwrap();
        let text = String::from_utf8(bytes[..length].to_vec()).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

fn kill(signal: &str, id: u32) {
    let sent = Command::new("kill")
        .args([signal, &id.to_string()])
        .status();
    assert!(sent.unwrap().success());
}

#[test]
fn the_service_manager_is_notified_of_start_watchdog_and_stop() {
    let folder = place();
    let socket = folder.path().join("notify");
    let manager = Manager::new(&socket);
    let mut daemon = velomotion(folder.path(), "daemon --listen 127.0.0.1:0")
        .env("NOTIFY_SOCKET", &socket)
        .env("WATCHDOG_USEC", "300000")
        .env_remove("WATCHDOG_PID")
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let is = |line: &'static str| move |printed: &String| printed == line;
    // A heartbeat may precede READY.
    let ready = loop {
        let printed = manager.messages();
        if !printed.iter().any(is("WATCHDOG=1")) {
            break printed;
        }
    };
    assert!(ready.iter().any(is("READY=1")), "{ready:?}");
    assert!(
        ready
            .iter()
            .any(|line| line.starts_with("STATUS=http://127.0.0.1:")),
        "{ready:?}"
    );
    for _ in 0..3 {
        assert_eq!(manager.messages(), ["WATCHDOG=1"]);
    }
    kill("-TERM", daemon.id());
    let last = loop {
        let printed = manager.messages();
        if printed != ["WATCHDOG=1"] {
            break printed;
        }
    };
    assert!(last.iter().any(is("STOPPING=1")), "{last:?}");
    // The daemon sends heartbeats until its end and blocks if they are not read.
    std::thread::spawn(move || while manager.0.recv(&mut [0; 4096]).is_ok() {});
    assert!(daemon.wait().unwrap().success());
}

/// The text that `line` writes to stderr, a file that is or is not announced as the journal.
fn printed_to(folder: &Path, line: &str, to_journal: bool) -> String {
    let path = folder.join("stderr");
    let file = File::create(&path).unwrap();
    let about = file.metadata().unwrap();
    let inode = if to_journal {
        about.ino()
    } else {
        about.ino() + 1
    };
    let status = velomotion(folder, line)
        .env("JOURNAL_STREAM", format!("{}:{inode}", about.dev()))
        .stderr(file)
        .status();
    assert_eq!(status.unwrap().code(), Some(3));
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn priority_prefixes_are_written_only_to_the_journal() {
    let folder = place();
    let line = "daemon --config missing.toml";
    let to_journal = printed_to(folder.path(), line, true);
    let lines: Vec<&str> = to_journal.lines().collect();
    assert_eq!(lines.len(), 2, "{to_journal}");
    assert!(
        lines[0].starts_with("<3>cannot read the configuration missing.toml"),
        "{to_journal}"
    );
    assert!(
        lines[1].starts_with("<3>name an existing text file"),
        "{to_journal}"
    );
    let plain = printed_to(folder.path(), line, false);
    assert!(plain.contains("missing.toml"), "{plain}");
    assert!(
        !plain.contains("<3>") && !plain.contains('\u{1b}'),
        "{plain}"
    );
}

#[test]
fn events_are_logged_line_by_line() {
    let folder = place();
    let path = folder.path().join("stderr");
    let file = File::create(&path).unwrap();
    let about = file.metadata().unwrap();
    let mut daemon = velomotion(folder.path(), "daemon --listen 127.0.0.1:0 -v")
        .env("JOURNAL_STREAM", format!("{}:{}", about.dev(), about.ino()))
        .stderr(file)
        .spawn()
        .unwrap();
    let text = wait("the drive's line", || {
        let text = std::fs::read_to_string(&path).unwrap();
        text.contains("<6>drive: connected\n").then_some(text)
    });
    // The address has no priority prefix: journald takes it as information.
    assert!(
        text.lines().any(|line| line.starts_with("http://")),
        "{text}"
    );
    assert!(!text.contains('\u{1b}'), "{text}");
    kill("-TERM", daemon.id());
    assert!(daemon.wait().unwrap().success());
}
