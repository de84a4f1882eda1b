//! A small disk that can be filled completely: a tmpfs, where this user may mount one.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Space for the longest scan of a plan and for the daemon's reserve.
const BYTES: u64 = 256 << 20;

/// A tmpfs, until dropped.
pub struct Disk {
    place: PathBuf,
}

impl Disk {
    /// Mounts a tmpfs. Returns the reason if that is impossible.
    pub fn mount(place: &Path) -> Result<Self, String> {
        std::fs::create_dir_all(place).map_err(|error| error.to_string())?;
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={BYTES}"), "tmpfs"])
            .arg(place)
            .output()
            .map_err(|error| error.to_string())?;
        match mounted.status.success() {
            true => Ok(Self {
                place: place.to_owned(),
            }),
            false => Err(String::from_utf8_lossy(&mounted.stderr).trim().to_owned()),
        }
    }

    fn filler(&self) -> PathBuf {
        self.place.join("filler")
    }

    /// Fills the disk but for so many bytes.
    pub fn fill(&self, but: u64) -> Result<(), String> {
        let text = |error: std::io::Error| error.to_string();
        let free = io::files::free_bytes(&self.place).map_err(text)?;
        let mut file = File::create(self.filler()).map_err(text)?;
        let piece = vec![0; 1 << 20];
        let mut left = free.saturating_sub(but);
        while left > 0 {
            let now = left.min(piece.len() as u64);
            // Other writers may take the space first.
            if file
                .write_all(&piece[..usize::try_from(now).unwrap()])
                .is_err()
            {
                break;
            }
            left -= now;
        }
        Ok(())
    }

    /// Frees the space.
    pub fn empty(&self) -> Result<(), String> {
        std::fs::remove_file(self.filler()).map_err(|error| error.to_string())
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // Lazily: a daemon that is being killed may still have an open file.
        let _ = Command::new("umount").arg("-l").arg(&self.place).status();
    }
}
