//! Output files that are never half there: written under a temporary name, renamed when complete.
//!
//! Logs do not go through here: a log must be readable while it grows. Formats are written by
//! others through [`std::io::Write`] and [`std::io::Seek`].

use std::env;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// How the name of a file ends that is being written.
const HALF_WRITTEN: &str = ".partial";

/// What to do about a file that is already there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Leave it and fail.
    Refuse,
    /// Replace it (`--force`).
    Replace,
}

/// Why an output file could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The name is taken and may not be replaced.
    #[error("{} exists already", path.display())]
    Exists {
        /// The file in the way.
        path: PathBuf,
    },
    /// The name is a directory's.
    #[error("{}: expected the name of a file, got a directory", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The folder for the file is missing.
    #[error("{}: the folder {} does not exist", path.display(), folder.display())]
    NoFolder {
        /// The file asked for.
        path: PathBuf,
        /// The folder which is missing.
        folder: PathBuf,
    },
    /// The system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file asked for.
        path: PathBuf,
        /// What was being done: `create`, `write` or `rename`.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
}

/// A file being written. It takes its name on [`NewFile::commit`]; dropped before, it leaves no
/// trace and an older file of that name is untouched.
///
/// Not buffered: wrap it in [`std::io::BufWriter`] and take it out again to commit.
///
/// A name that is a device or a pipe (`/dev/null`, `/dev/stdout`) is written in place: there is
/// nothing to preserve.
#[derive(Debug)]
pub struct NewFile {
    file: File,
    path: PathBuf,
    /// Where the bytes are until the commit; `None` once renamed, and for devices.
    temporary: Option<PathBuf>,
    overwrite: Overwrite,
}

impl NewFile {
    /// Opens a temporary file beside `path`.
    ///
    /// # Errors
    /// [`FileError`]: the name is taken (and `overwrite` says [`Overwrite::Refuse`]), is a
    /// directory, lies in a folder that is missing, or cannot be written.
    pub fn create(path: impl AsRef<Path>, overwrite: Overwrite) -> Result<Self, FileError> {
        let path = path.as_ref();
        let io_error = |source| FileError::Io {
            path: path.to_owned(),
            action: "create",
            source,
        };
        // Through a symbolic link it is the file behind it that is replaced, not the link.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        match fs::metadata(&target) {
            Ok(there) if there.is_dir() => {
                return Err(FileError::Directory {
                    path: path.to_owned(),
                });
            }
            Ok(there) if !there.is_file() => {
                let file = OpenOptions::new()
                    .write(true)
                    .open(&target)
                    .map_err(io_error)?;
                return Ok(Self {
                    file,
                    path: target,
                    temporary: None,
                    overwrite,
                });
            }
            Ok(_) if overwrite == Overwrite::Refuse => {
                return Err(FileError::Exists {
                    path: path.to_owned(),
                });
            }
            _ => {}
        }
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return Err(FileError::NoFolder {
                path: path.to_owned(),
                folder: folder.to_owned(),
            });
        }
        let (file, temporary) = create_temporary(&target).map_err(io_error)?;
        Ok(Self {
            file,
            path: target,
            temporary: Some(temporary),
            overwrite,
        })
    }

    /// The name the file will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the bytes durable and gives the file its name, durably too.
    ///
    /// # Errors
    /// [`FileError::Exists`] if another program made the file meanwhile and it may not be replaced;
    /// [`FileError::Io`]. After an error the older file is as it was.
    pub fn commit(mut self) -> Result<(), FileError> {
        let Some(temporary) = self.temporary.clone() else {
            return self.file.flush().map_err(|e| self.io_error("write", e));
        };
        self.file
            .sync_all()
            .map_err(|e| self.io_error("write", e))?;
        match self.overwrite {
            Overwrite::Replace => {
                fs::rename(&temporary, &self.path).map_err(|e| self.io_error("rename", e))?;
            }
            // `link` fails where the name is taken, which `rename` would not; Drop then removes the
            // other name.
            Overwrite::Refuse => match fs::hard_link(&temporary, &self.path) {
                Ok(()) => {
                    keep_name(&self.path);
                    return Ok(());
                }
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                    return Err(FileError::Exists {
                        path: self.path.clone(),
                    });
                }
                // File systems without hard links (FAT, some network mounts): the check is not
                // atomic there.
                Err(_) if !self.path.exists() => {
                    fs::rename(&temporary, &self.path).map_err(|e| self.io_error("rename", e))?;
                }
                Err(_) => {
                    return Err(FileError::Exists {
                        path: self.path.clone(),
                    });
                }
            },
        }
        self.temporary = None;
        keep_name(&self.path);
        Ok(())
    }

    fn io_error(&self, action: &'static str, source: io::Error) -> FileError {
        FileError::Io {
            path: self.path.clone(),
            action,
            source,
        }
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Nobody is left to tell, and a stale temporary file harms nothing.
            let _ = fs::remove_file(temporary);
        }
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// What was written can be read again, but for devices and pipes.
impl Read for NewFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Waits until a disk has all bytes of a file, which then survive a power cut. Devices and pipes
/// have no such thing, and that is fine.
///
/// # Errors
/// What the disk says.
pub fn make_durable(file: &File) -> io::Result<()> {
    match file.sync_data() {
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

/// Has the disk remember the name of a file or folder that was just made: it may else be gone after
/// a power cut, however safe the bytes are. File systems that cannot are left alone.
pub fn keep_name(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        // Some network file systems refuse; the file is as safe there as it can be.
        let _ = folder.sync_all();
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether a file is what a process that was killed left of a [`NewFile`].
#[must_use]
pub fn is_half_written(name: &std::ffi::OsStr) -> bool {
    let name = name.as_encoded_bytes();
    name.starts_with(b".") && name.ends_with(HALF_WRITTEN.as_bytes())
}

/// A new file beside `path`, named after it and this process.
fn create_temporary(path: &Path) -> io::Result<(File, PathBuf)> {
    let mut taken = io::Error::from(io::ErrorKind::AlreadyExists);
    for attempt in 0..100 {
        let mut name = std::ffi::OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{}-{attempt}{HALF_WRITTEN}", std::process::id()));
        let temporary = folder_of(path).join(name);
        match OpenOptions::new()
            .read(true)
            .write(true)
            .create_new(true)
            .open(&temporary)
        {
            Ok(file) => return Ok((file, temporary)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => taken = e,
            Err(e) => return Err(e),
        }
    }
    Err(taken)
}

/// A file without a name for what does not fit memory, in [`scratch_folder`]; it is gone when it is
/// closed.
///
/// # Errors
/// Where none can be made there; the error names the folder.
pub fn scratch() -> io::Result<File> {
    scratch_in(&scratch_folder())
}

/// The same in a folder of the caller's.
///
/// # Errors
/// As [`scratch`].
pub fn scratch_in(folder: &Path) -> io::Result<File> {
    tempfile::tempfile_in(folder).map_err(|error| {
        io::Error::new(
            error.kind(),
            format!("no scratch file in {}: {error}", folder.display()),
        )
    })
}

/// `$TMPDIR`, or else `/var/tmp`, which unlike `/tmp` is no memory.
#[must_use]
pub fn scratch_folder() -> PathBuf {
    match env::var_os("TMPDIR") {
        Some(folder) => folder.into(),
        None if Path::new("/var/tmp").is_dir() => "/var/tmp".into(),
        None => env::temp_dir(),
    }
}

/// Bytes that this user can still write to the file system of `path`.
///
/// # Errors
/// Where the path is not there or the system does not tell.
pub fn free_bytes(path: &Path) -> io::Result<u64> {
    let stat = nix::sys::statvfs::statvfs(path)?;
    // Their widths differ between systems.
    #[allow(clippy::useless_conversion)]
    let (blocks, size) = (
        u64::from(stat.blocks_available()),
        u64::from(stat.fragment_size()),
    );
    Ok(blocks.saturating_mul(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_free_space_is_what_df_says() {
        let folder = tempfile::tempdir().unwrap();
        let df = std::process::Command::new("df")
            .args(["--output=avail", "-B1"])
            .arg(folder.path())
            .output()
            .unwrap();
        let text = String::from_utf8(df.stdout).unwrap();
        let says: f64 = text.lines().last().unwrap().trim().parse().unwrap();
        let free = free_bytes(folder.path()).unwrap() as f64;
        // Others write in between.
        assert!((free / says - 1.0).abs() < 0.05, "{free} and {says}");
        assert!(free_bytes(&folder.path().join("none")).is_err());
    }

    #[test]
    fn a_committed_file_has_its_name_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let mut file = NewFile::create(&path, Overwrite::Refuse).unwrap();
        file.write_all(b"old header").unwrap();
        file.seek(SeekFrom::Start(0)).unwrap();
        file.write_all(b"new").unwrap();
        assert!(!path.exists(), "not before it is complete");
        file.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new header");
        assert_eq!(names(folder.path()), ["cloud.ply"]);
    }

    #[test]
    fn an_existing_file_is_refused_or_survives_until_the_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        fs::write(&path, "precious").unwrap();
        let refused = NewFile::create(&path, Overwrite::Refuse).unwrap_err();
        assert!(matches!(refused, FileError::Exists { .. }), "{refused}");

        let mut abandoned = NewFile::create(&path, Overwrite::Replace).unwrap();
        abandoned.write_all(b"half").unwrap();
        drop(abandoned);
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");

        let mut replaced = NewFile::create(&path, Overwrite::Replace).unwrap();
        replaced.write_all(b"whole").unwrap();
        replaced.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
        assert_eq!(names(folder.path()), ["cloud.ply"]);
    }

    #[test]
    fn a_file_made_by_someone_else_meanwhile_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let mine = NewFile::create(&path, Overwrite::Refuse).unwrap();
        fs::write(&path, "theirs").unwrap();
        assert!(matches!(mine.commit(), Err(FileError::Exists { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "theirs");
        assert_eq!(names(folder.path()), ["cloud.ply"]);
    }

    #[test]
    fn two_writers_of_one_name_do_not_share_a_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let mut one = NewFile::create(&path, Overwrite::Replace).unwrap();
        let mut two = NewFile::create(&path, Overwrite::Replace).unwrap();
        one.write_all(b"one").unwrap();
        two.write_all(b"two").unwrap();
        one.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        two.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
    }

    #[test]
    fn directories_missing_folders_and_devices() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(
            NewFile::create(folder.path(), Overwrite::Replace),
            Err(FileError::Directory { .. })
        ));
        let orphan = folder.path().join("missing/cloud.ply");
        assert!(matches!(
            NewFile::create(orphan, Overwrite::Refuse),
            Err(FileError::NoFolder { .. })
        ));
        let mut device = NewFile::create("/dev/null", Overwrite::Refuse).unwrap();
        device.write_all(b"gone").unwrap();
        device.commit().unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn a_symbolic_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("real.ply");
        let link = folder.path().join("link.ply");
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        let mut file = NewFile::create(&link, Overwrite::Replace).unwrap();
        file.write_all(b"new").unwrap();
        file.commit().unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    }
}
