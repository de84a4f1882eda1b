//! Source of a recording: a file, a named pipe, or standard input (`-`).
//!
//! A pipe can be read once. For several passes [`RecordingInput`] copies it to a temporary file, up
//! to a limit.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::{Recording, RecordingError};
use crate::files::scratch_folder;

/// Default limit of a pipe's copy in bytes: five hours of a VLP-16 in single return (750 packets of
/// 1.2 kB per second).
pub const SPOOL_LIMIT: u64 = 16 << 30;
/// Standard input as an argument.
const STDIN: &str = "-";
/// Standard input as a file.
const DEV_STDIN: &str = "/dev/stdin";
/// Bytes copied at a time.
const CHUNK_LEN: usize = 256 << 10;

/// A recording for any number of passes.
#[derive(Debug)]
pub struct RecordingInput {
    /// Name for errors.
    name: PathBuf,
    /// File to open for a pass without a copy.
    path: PathBuf,
    copy: Option<NamedTempFile>,
}

impl RecordingInput {
    /// Opens a file. A pipe is copied to its end into a temporary file of at most `limit` bytes, in
    /// [`crate::files::scratch_folder`].
    ///
    /// # Errors
    /// [`RecordingError::Open`]; [`RecordingError::Read`] if the pipe cannot be read or copied, or
    /// exceeds `limit` bytes.
    pub fn open(path: impl AsRef<Path>, limit: u64) -> Result<Self, RecordingError> {
        let name = path.as_ref();
        let file = open(name)?;
        let path = match name.to_str() {
            Some(STDIN) => Path::new(DEV_STDIN),
            _ => name,
        };
        let is_rereadable = |metadata: std::fs::Metadata| metadata.is_file() || metadata.is_dir();
        // Only Linux opens the file behind /dev/stdin again, from its beginning.
        let can_reopen = cfg!(target_os = "linux") || !path.starts_with("/dev");
        let is_rereadable = can_reopen && file.metadata().is_ok_and(is_rereadable);
        let copy = if is_rereadable {
            None
        } else {
            Some(copy(name, file, &scratch_folder(), limit)?)
        };
        Ok(Self {
            name: name.to_owned(),
            path: path.to_owned(),
            copy,
        })
    }

    /// Starts an independent pass.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn recording(&self) -> Result<Recording, RecordingError> {
        let file = match &self.copy {
            Some(copy) => copy.reopen(),
            None => File::open(&self.path),
        };
        let file = file.map_err(|source| RecordingError::Open {
            path: self.name.clone(),
            source,
        })?;
        Recording::new(file, &self.name)
    }

    #[cfg(all(test, target_os = "linux"))]
    fn is_copied(&self) -> bool {
        self.copy.is_some()
    }
}

/// Opens a file or standard input.
pub(super) fn open(path: &Path) -> Result<File, RecordingError> {
    let file = if path.to_str() == Some(STDIN) {
        open_stdin()
    } else {
        File::open(path)
    };
    file.map_err(|source| RecordingError::Open {
        path: path.to_owned(),
        source,
    })
}

#[cfg(unix)]
fn open_stdin() -> io::Result<File> {
    use std::os::fd::AsFd;
    io::stdin().as_fd().try_clone_to_owned().map(File::from)
}

#[cfg(windows)]
fn open_stdin() -> io::Result<File> {
    use std::os::windows::io::AsHandle;
    let handle = io::stdin().as_handle().try_clone_to_owned();
    handle.map(File::from)
}

/// Copies a stream to a temporary file.
fn copy(
    name: &Path,
    mut from: impl Read,
    folder: &Path,
    limit: u64,
) -> Result<NamedTempFile, RecordingError> {
    let mut offset = 0;
    let failed = |offset, source| RecordingError::Read {
        path: name.to_owned(),
        offset,
        source,
    };
    let mut file = Builder::new()
        .prefix("velomotion-")
        .tempfile_in(folder)
        .map_err(|e| {
            failed(
                0,
                context(
                    "cannot create a temporary file for a second pass",
                    folder,
                    &e,
                ),
            )
        })?;
    let mut chunk = vec![0; CHUNK_LEN];
    loop {
        let n = match from.read(&mut chunk) {
            Ok(0) => return Ok(file),
            Ok(n) => n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(failed(offset, e)),
        };
        if offset + n as u64 > limit {
            let what = format!(
                "the pipe exceeds the {limit} bytes that are kept for a second pass: write it to a file first"
            );
            return Err(failed(
                limit,
                io::Error::new(io::ErrorKind::FileTooLarge, what),
            ));
        }
        file.write_all(chunk.get(..n).unwrap_or_default())
            .map_err(|e| failed(offset, context("cannot keep a copy", folder, &e)))?;
        offset += n as u64;
    }
}

fn context(what: &str, folder: &Path, error: &io::Error) -> io::Error {
    io::Error::new(
        error.kind(),
        format!("{what} in {}: {error}", folder.display()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pipe_is_copied_up_to_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let bytes: Vec<u8> = (0..600_000_u32).map(|n| n as u8).collect();
        let name = Path::new("pipe");
        let kept = copy(name, bytes.as_slice(), folder.path(), 600_000).unwrap();
        for _ in 0..2 {
            let mut back = Vec::new();
            kept.reopen().unwrap().read_to_end(&mut back).unwrap();
            assert_eq!(back, bytes);
        }
        drop(kept);
        let error = copy(name, bytes.as_slice(), folder.path(), 599_999).unwrap_err();
        assert!(error.to_string().contains("599999 bytes"), "{error}");
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 0, "no file remains");
        let nowhere = copy(name, bytes.as_slice(), Path::new("/nonexistent"), 1).unwrap_err();
        assert!(nowhere.to_string().contains("/nonexistent"), "{nowhere}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn fifos_are_copied_and_files_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file.pcap");
        let header = [
            &[0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0][..],
            &[0; 8],
            &[0, 0, 1, 0, 1, 0, 0, 0],
        ]
        .concat();
        std::fs::write(&file, &header).unwrap();
        let input = RecordingInput::open(&file, 1).unwrap();
        assert!(!input.is_copied());
        assert!(input.recording().unwrap().next_record().unwrap().is_none());

        let fifo = folder.path().join("fifo");
        nix::unistd::mkfifo(&fifo, nix::sys::stat::Mode::S_IRWXU).unwrap();
        let writer = {
            let fifo = fifo.clone();
            std::thread::spawn(move || std::fs::write(fifo, header).unwrap())
        };
        let input = RecordingInput::open(&fifo, SPOOL_LIMIT).unwrap();
        writer.join().unwrap();
        assert!(input.is_copied());
        for _ in 0..2 {
            let mut recording = input.recording().unwrap();
            assert!(recording.next_record().unwrap().is_none());
        }
        let missing = RecordingInput::open(folder.path().join("missing"), 1).unwrap_err();
        assert!(matches!(missing, RecordingError::Open { .. }), "{missing}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_single_pass_needs_no_copy() {
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("fifo");
        nix::unistd::mkfifo(&fifo, nix::sys::stat::Mode::S_IRWXU).unwrap();
        let writer = {
            let fifo = fifo.clone();
            std::thread::spawn(move || std::fs::write(fifo, [0x0A, 0x0D, 0x0D]).unwrap())
        };
        let error = Recording::open(&fifo).unwrap_err();
        writer.join().unwrap();
        assert!(
            matches!(error, RecordingError::Short { got: 3, .. }),
            "{error}"
        );
    }
}
