//! A simulated drive in its own process, for tests that plug and unplug one.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A drive on USB behind a link of this name; dropping it unplugs it.
pub struct Drive(Child);

impl Drive {
    /// Plugs the drive in. The port exists on return.
    pub fn plug(link: &Path) -> Self {
        let mut drive = Command::new(env!("CARGO_BIN_EXE_velomotion"))
            .args(["firmware-sim", "--usb", "--link"])
            .arg(link)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut port = String::new();
        let mut out = BufReader::new(drive.stdout.take().unwrap());
        out.read_line(&mut port).unwrap();
        Self(drive)
    }
}

impl Drop for Drive {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
