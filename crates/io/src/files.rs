//! Output files that are complete or absent: they are written under a temporary name and renamed.
//!
//! Logs are written in place instead, since a log must be readable while it grows.

use std::env;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

/// Suffix of the temporary name.
const PARTIAL: &str = ".partial";

/// Opens a regular file of this name to read it. A symbolic link, also of its folder, may lead
/// elsewhere, and a FIFO without a writer would block.
///
/// # Errors
/// The system's, and [`io::ErrorKind::InvalidInput`] for anything but a regular file in a folder.
#[cfg(target_os = "linux")]
pub fn open_regular(path: &Path) -> io::Result<File> {
    use nix::fcntl::OFlag;
    use nix::sys::stat::Mode;
    use std::os::unix::fs::OpenOptionsExt;

    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
        return Err(io::ErrorKind::InvalidInput.into());
    };
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    // Its files may be readable where the folder itself is not.
    let folder = OpenOptions::new()
        .read(true)
        .custom_flags((OFlag::O_PATH | OFlag::O_NOFOLLOW | OFlag::O_DIRECTORY).bits())
        .open(folder)?;
    let flags = OFlag::O_NOFOLLOW | OFlag::O_NONBLOCK | OFlag::O_CLOEXEC;
    let file = File::from(nix::fcntl::openat(folder, name, flags, Mode::empty())?);
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "not a regular file",
        )),
    }
}

/// Treatment of an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Keeps it and fails.
    Refuse,
    /// Replaces it (`--force`).
    Replace,
}

/// Failure to write an output file.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file exists and must not be replaced.
    #[error("{} exists already", path.display())]
    Exists {
        /// The existing file.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error("{}: expected the name of a file, got a directory", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The directory of the file is missing.
    #[error("{}: the folder {} does not exist", path.display(), folder.display())]
    NoFolder {
        /// The requested file.
        path: PathBuf,
        /// The missing directory.
        folder: PathBuf,
    },
    /// A system call failed.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The requested file.
        path: PathBuf,
        /// `create`, `write` or `rename`.
        action: &'static str,
        /// The system's error.
        source: io::Error,
    },
}

/// A file that appears under its name on [`NewFile::commit`]. Dropped before, it leaves no trace,
/// and an older file of that name stays untouched.
///
/// It is not buffered: wrap it in [`std::io::BufWriter`]. A device or pipe (`/dev/null`,
/// `/dev/stdout`) is written in place.
#[derive(Debug)]
pub struct NewFile {
    target: WriteTarget,
    path: PathBuf,
    overwrite: Overwrite,
}

#[derive(Debug)]
enum WriteTarget {
    Temporary(NamedTempFile),
    Device(File),
}

impl NewFile {
    /// Opens a temporary file in the directory of `path`.
    ///
    /// # Errors
    /// [`FileError`]: the file exists (with [`Overwrite::Refuse`]), is a directory, lies in a
    /// missing directory, or cannot be created.
    pub fn create(path: impl AsRef<Path>, overwrite: Overwrite) -> Result<Self, FileError> {
        let path = path.as_ref();
        let io_error = |source| FileError::Io {
            path: path.to_owned(),
            action: "create",
            source,
        };
        // A symbolic link stays; the file that it points to is replaced.
        let file_path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let target = match fs::metadata(&file_path) {
            Ok(metadata) if metadata.is_dir() => {
                return Err(FileError::Directory {
                    path: path.to_owned(),
                });
            }
            Ok(metadata) if !metadata.is_file() => {
                WriteTarget::Device(open_device(&file_path).map_err(io_error)?)
            }
            Ok(_) if overwrite == Overwrite::Refuse => {
                return Err(FileError::Exists {
                    path: path.to_owned(),
                });
            }
            _ => {
                let folder = folder_of(&file_path);
                if !folder.is_dir() {
                    return Err(FileError::NoFolder {
                        path: path.to_owned(),
                        folder: folder.to_owned(),
                    });
                }
                WriteTarget::Temporary(create_temporary(&file_path, folder).map_err(io_error)?)
            }
        };
        Ok(Self {
            target,
            path: file_path,
            overwrite,
        })
    }

    /// The name that the file will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Syncs the bytes to disk and gives the file its name.
    ///
    /// # Errors
    /// [`FileError::Exists`] if another program created the file meanwhile and it must not be
    /// replaced; [`FileError::Io`]. After an error the older file is unchanged.
    pub fn commit(self) -> Result<(), FileError> {
        let path = self.path;
        let io_error = |action, source| FileError::Io {
            path: path.clone(),
            action,
            source,
        };
        let temporary = match self.target {
            WriteTarget::Device(mut device) => {
                return device.flush().map_err(|e| io_error("write", e));
            }
            WriteTarget::Temporary(temporary) => temporary,
        };
        let synced = temporary.as_file().sync_all();
        synced.map_err(|e| io_error("write", e))?;
        let persisted = match self.overwrite {
            Overwrite::Replace => temporary.persist(&path),
            Overwrite::Refuse => match temporary.persist_noclobber(&path) {
                // File systems with neither hard links nor renameat2 (some network mounts): the
                // check is not atomic there.
                Err(error) if !path.exists() => error.file.persist(&path),
                result => result,
            },
        };
        if let Err(error) = persisted {
            return Err(match self.overwrite {
                Overwrite::Refuse if path.exists() => FileError::Exists { path },
                _ => io_error("rename", error.error),
            });
        }
        sync_folder(&path);
        Ok(())
    }

    fn file(&self) -> &File {
        match &self.target {
            WriteTarget::Temporary(temporary) => temporary.as_file(),
            WriteTarget::Device(device) => device,
        }
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

/// Written bytes can be read again, except from devices and pipes.
impl Read for NewFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file().read(bytes)
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file().seek(to)
    }
}

/// Syncs a file to disk, so that it survives a power cut; does nothing for devices and pipes.
pub(crate) fn sync(file: &File) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, Unsupported};
    match file.sync_data() {
        Err(error) if matches!(error.kind(), InvalidInput | Unsupported) => Ok(()),
        synced => synced,
    }
}

/// Syncs the directory of a new file or directory: its name may otherwise be lost in a power cut.
/// Some network file systems refuse, which is ignored.
pub fn sync_folder(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether a file name is that of a [`NewFile`] whose process was killed.
#[must_use]
pub fn is_half_written(name: &OsStr) -> bool {
    let name = name.as_encoded_bytes();
    name.starts_with(b".") && name.ends_with(PARTIAL.as_bytes())
}

/// Opens a device or pipe to write it. A pipe that no program reads would block: after 10 s it is
/// an error.
#[cfg(target_os = "linux")]
fn open_device(path: &Path) -> io::Result<File> {
    use nix::errno::Errno;
    use nix::fcntl::{FcntlArg, OFlag, fcntl};
    use std::os::unix::fs::OpenOptionsExt;
    use std::time::{Duration, Instant};

    let mut options = OpenOptions::new();
    options.write(true).custom_flags(OFlag::O_NONBLOCK.bits());
    let start = Instant::now();
    let file = loop {
        match options.open(path) {
            Err(error) if error.raw_os_error() == Some(Errno::ENXIO as i32) => {
                if start.elapsed() > Duration::from_secs(10) {
                    return Err(io::Error::other("no program reads this pipe"));
                }
                std::thread::sleep(Duration::from_millis(20));
            }
            opened => break opened?,
        }
    };
    let flags = OFlag::from_bits_truncate(fcntl(&file, FcntlArg::F_GETFL)?);
    fcntl(&file, FcntlArg::F_SETFL(flags - OFlag::O_NONBLOCK))?;
    Ok(file)
}

#[cfg(not(target_os = "linux"))]
fn open_device(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// A temporary file in `folder`, named after `path`.
fn create_temporary(path: &Path, folder: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = OsString::from(".");
    prefix.push(path.file_name().unwrap_or_default());
    prefix.push(".");
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(PARTIAL);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Less the umask, as for any new file.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// An open file that several readers can open again, each with its own position.
#[derive(Debug)]
pub struct ReopenableFile {
    file: File,
    /// Only Linux opens a file again without its name.
    #[cfg(not(target_os = "linux"))]
    path: PathBuf,
    /// Removes a scratch file.
    #[cfg(not(target_os = "linux"))]
    _temporary: Option<tempfile::TempPath>,
}

impl ReopenableFile {
    /// Opens a file to read it.
    ///
    /// # Errors
    /// The system's.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            file: File::open(path)?,
            #[cfg(not(target_os = "linux"))]
            path: path.to_owned(),
            #[cfg(not(target_os = "linux"))]
            _temporary: None,
        })
    }

    /// Like [`scratch_in`], in [`scratch_folder`]. The file is removed with this value.
    ///
    /// # Errors
    /// As [`scratch_in`].
    pub fn scratch() -> io::Result<Self> {
        let folder = scratch_folder();
        #[cfg(target_os = "linux")]
        return scratch_in(&folder).map(|file| Self { file });
        #[cfg(not(target_os = "linux"))]
        {
            let named = Builder::new().tempfile_in(&folder);
            let named = named.map_err(|error| no_scratch(&folder, &error))?;
            let (file, temporary) = named.into_parts();
            Ok(Self {
                file,
                path: temporary.to_path_buf(),
                _temporary: Some(temporary),
            })
        }
    }

    /// The file, whose position is shared.
    #[must_use]
    pub const fn file(&self) -> &File {
        &self.file
    }

    /// Opens it for a reader with its own position.
    ///
    /// # Errors
    /// The system's.
    pub fn reopen(&self) -> io::Result<File> {
        #[cfg(target_os = "linux")]
        {
            use std::os::fd::AsRawFd;
            // proc(5)
            File::open(format!("/proc/self/fd/{}", self.file.as_raw_fd()))
        }
        #[cfg(not(target_os = "linux"))]
        File::open(&self.path)
    }
}

/// An unnamed file in `folder`, such as [`scratch_folder`], for data that does not fit memory.
///
/// # Errors
/// The system's; the message names the folder.
pub fn scratch_in(folder: &Path) -> io::Result<File> {
    tempfile::tempfile_in(folder).map_err(|error| no_scratch(folder, &error))
}

fn no_scratch(folder: &Path, error: &io::Error) -> io::Error {
    io::Error::new(
        error.kind(),
        format!("no scratch file in {}: {error}", folder.display()),
    )
}

/// `$TMPDIR`, or else `/var/tmp`, which unlike `/tmp` is never held in memory.
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
/// The system's, such as a missing path.
#[cfg(target_os = "linux")]
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

    #[cfg(target_os = "linux")]
    #[test]
    fn the_free_space_agrees_with_df() {
        let folder = tempfile::tempdir().unwrap();
        let df = std::process::Command::new("df")
            .args(["--output=avail", "-B1"])
            .arg(folder.path())
            .output()
            .unwrap();
        let text = String::from_utf8(df.stdout).unwrap();
        let expected: f64 = text.lines().last().unwrap().trim().parse().unwrap();
        let free = free_bytes(folder.path()).unwrap() as f64;
        // Other programs may write in between.
        assert!(
            (free / expected - 1.0).abs() < 0.05,
            "{free} and {expected}"
        );
        assert!(free_bytes(&folder.path().join("none")).is_err());
    }

    #[test]
    fn the_named_file_does_not_exist_before_the_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let mut file = NewFile::create(&path, Overwrite::Refuse).unwrap();
        file.write_all(b"old header").unwrap();
        file.seek(SeekFrom::Start(0)).unwrap();
        file.write_all(b"new").unwrap();
        assert!(!path.exists(), "the file appears only when complete");
        file.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new header");
        assert_eq!(names(folder.path()), ["cloud.ply"]);
    }

    #[test]
    fn existing_files_are_refused_or_kept_until_the_commit() {
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
    fn files_created_by_others_meanwhile_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let ours = NewFile::create(&path, Overwrite::Refuse).unwrap();
        fs::write(&path, "theirs").unwrap();
        assert!(matches!(ours.commit(), Err(FileError::Exists { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "theirs");
        assert_eq!(names(folder.path()), ["cloud.ply"]);
    }

    #[test]
    fn two_writers_of_one_name_use_two_temporary_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let mut first = NewFile::create(&path, Overwrite::Replace).unwrap();
        let mut second = NewFile::create(&path, Overwrite::Replace).unwrap();
        first.write_all(b"first").unwrap();
        second.write_all(b"second").unwrap();
        first.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "first");
        second.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn directories_and_missing_folders_are_refused_and_devices_written() {
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

    #[cfg(target_os = "linux")]
    #[test]
    fn symbolic_links_are_kept() {
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
