//! Destination of a cloud: stdout, or a file that gets its name when it is complete.

mod companion;
mod file;
mod texts;

use std::io::{self as stdio, IsTerminal};
use std::path::{Path, PathBuf};

use ::io::files::{FileError, NewFile, Overwrite};
use cloud::formats::Format;
use cloud::formats::mcap::McapWriter;
use cloud::formats::pcd::PcdWriter;
use cloud::formats::ply::PlyPipe;
use cloud::{Fields, Sink, SinkError};

use self::companion::{check_beside, write_beside};
use crate::failure::{Failure, Kind};

pub use self::file::{BufferedFile, SharedFile};
pub use self::texts::{make_folder, write_text};

/// A cloud's destination, opened before anything is measured.
pub struct Target {
    path: PathBuf,
    file: Option<SharedFile>,
    sink: Box<dyn Sink + Send>,
}

impl Target {
    /// Opens `path` with the columns `fields`. The extension selects the format; `-` is PLY on
    /// stdout.
    ///
    /// # Errors
    /// [`Kind::Usage`] for an unknown extension or an existing file without `force`;
    /// [`Kind::BadInput`] if the file cannot be created.
    pub fn open(path: &Path, fields: Fields, force: bool) -> Result<Self, Failure> {
        if path == Path::new("-") {
            if stdio::stdout().is_terminal() {
                return Err(Failure::new(
                    Kind::Usage,
                    "a cloud named - is PLY in bytes, and stdout is a terminal",
                )
                .help("name a file instead of -, or redirect stdout"));
            }
            let scratch = ::io::files::scratch_in(&::io::files::scratch_folder());
            let scratch = scratch.map_err(|error| {
                Failure::new(Kind::BadInput, format!("cannot write to stdout: {error}"))
                    .help("set TMPDIR to a folder with enough space, or name a file instead of -")
            })?;
            let scratch = BufferedFile::new(scratch);
            return Ok(Self {
                path: path.to_owned(),
                file: None,
                sink: Box::new(PlyPipe::new(stdio::stdout(), scratch, fields)),
            });
        }
        if path.is_dir() {
            let path = path.to_owned();
            return Err(file_failure(&FileError::Directory { path }));
        }
        let format = Format::from_path(path).map_err(|error| {
            Failure::new(Kind::Usage, format!("{}: {error}", path.display()))
                .help("use one of those extensions, or - for PLY on stdout")
        })?;
        let name = path.as_os_str().to_string_lossy().to_ascii_lowercase();
        if name.ends_with(".copc.laz") {
            // Programs take a plain LAZ of that name for a broken COPC.
            let what = format!("{}: COPC cannot be written", path.display());
            return Err(Failure::new(Kind::Usage, what)
                .help("name it .laz; its points can be converted to COPC"));
        }
        let refused = format.refused_columns();
        if let Some(column) = fields
            .columns()
            .find(|column| refused.contains(column.field()))
        {
            let what = format!(
                "{}: .{format} has no column {}",
                path.display(),
                column.name()
            );
            return Err(Failure::new(Kind::Usage, what).help(
                "omit --uncertainty, --echo and --laser, or write another format, such as .ply",
            ));
        }
        if format.needs_companion() {
            check_beside(path)?;
        }
        Self::file(path, force, |file| {
            format.writer(BufferedFile::new(file), fields)
        })
    }

    /// Opens `path` for an organised PCD of `rows` rows with the columns `fields`.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn organised(path: &Path, fields: Fields, force: bool, rows: u64) -> Result<Self, Failure> {
        Self::file(path, force, |file| {
            Box::new(PcdWriter::organised(BufferedFile::new(file), rows, fields))
        })
    }

    /// Opens `path` for an MCAP with one cloud per revolution.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn by_revolution(path: &Path, fields: Fields, force: bool) -> Result<Self, Failure> {
        Self::file(path, force, |file| {
            Box::new(McapWriter::new(BufferedFile::new(file), fields).by_revolution())
        })
    }

    /// Opens `path` for the sink that `writer` creates.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn file(
        path: &Path,
        force: bool,
        writer: impl FnOnce(SharedFile) -> Box<dyn Sink + Send>,
    ) -> Result<Self, Failure> {
        let file = NewFile::create(path, overwrite(force)).map_err(|error| file_failure(&error))?;
        let shared = SharedFile::new(file);
        Ok(Self {
            path: path.to_owned(),
            file: Some(shared.clone()),
            sink: writer(shared),
        })
    }

    /// The sink.
    pub fn sink(&mut self) -> &mut (dyn Sink + Send) {
        &mut *self.sink
    }

    /// Path as the user wrote it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the cloud goes to stdout.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        self.file.is_none()
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// Errors of the sink or the file system; an older file of that name remains unchanged.
    pub fn commit(mut self) -> Result<(), Failure> {
        self.sink
            .finish()
            .map_err(|error| sink_failure(&self.path, &error))?;
        let name = self.path.file_name().unwrap_or_default();
        let companion = self.sink.companion(&name.to_string_lossy());
        drop(self.sink);
        match self.file.and_then(|shared| shared.release()) {
            Some(file) => file.commit().map_err(|error| file_failure(&error))?,
            None => return Ok(()),
        }
        match companion {
            Some(companion) => write_beside(&self.path, &companion),
            None => Ok(()),
        }
    }
}

/// Refuses an existing file, before anything is opened.
///
/// # Errors
/// [`Kind::Usage`].
pub fn check_free(path: &Path, force: bool) -> Result<(), Failure> {
    if !force && path.exists() {
        let path = path.to_owned();
        return Err(file_failure(&FileError::Exists { path }));
    }
    Ok(())
}

/// Refuses a file in a folder that does not exist, before hours of work for it.
///
/// # Errors
/// [`Kind::Usage`].
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => Err(file_failure(&FileError::NoFolder {
            path: path.to_owned(),
            folder: folder.to_owned(),
        })),
        None => Ok(()),
    }
}

/// Refuses `-` for a log, which must be a file, and other extensions. `with` names the option.
///
/// # Errors
/// [`Kind::Usage`].
pub fn log_is_file(log: &Path, with: &str, extensions: &[&str]) -> Result<(), Failure> {
    let known = format!(".{}", extensions.join(" or ."));
    let extension = log.extension().unwrap_or_default();
    let wrong = match log == Path::new("-") {
        true => format!("a log must be a file: expected a file name with {with}, got -"),
        false
            if extensions
                .iter()
                .any(|own| extension.eq_ignore_ascii_case(own)) =>
        {
            return Ok(());
        }
        false => format!("the log {}: expected the extension {known}", log.display()),
    };
    Err(Failure::new(Kind::Usage, wrong).help(format!("name a file {known} with {with}")))
}

/// Refuses a cloud that would overwrite its own recording.
///
/// # Errors
/// [`Kind::Usage`].
pub fn two_files(log: &Path, cloud: &Path) -> Result<(), Failure> {
    if same_file(log, cloud) {
        let log = log.display();
        return Err(Failure::new(
            Kind::Usage,
            format!("{log} cannot be both the cloud and its recording"),
        )
        .help("give the cloud another name, with the extension of a cloud such as .ply"));
    }
    Ok(())
}

/// Refuses an output that would overwrite its input.
///
/// # Errors
/// [`Kind::Usage`].
pub fn refuse_overwrite(input: &Path, output: &Path) -> Result<(), Failure> {
    if same_file(input, output) {
        return Err(Failure::new(
            Kind::Usage,
            format!("the output would overwrite its input {}", output.display()),
        )
        .help("give it another name"));
    }
    Ok(())
}

/// Whether two paths name the same file, existing or not.
fn same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let path = path
            .file_name()
            .map_or(folder.clone(), |name| folder.join(name));
        path.canonicalize().unwrap_or(path)
    };
    place(a) == place(b)
}

/// Refuses a cloud and a JSON object on the same stdout.
///
/// # Errors
/// [`Kind::Usage`].
pub fn one_for_stdout(cloud: Option<&Path>, json: bool) -> Result<(), Failure> {
    if json && cloud == Some(Path::new("-")) {
        return Err(Failure::new(
            Kind::Usage,
            "a cloud named - and --json both write to stdout".to_owned(),
        )
        .help("name a file instead of -, or omit --json"));
    }
    Ok(())
}

/// An older file, renamed until its replacement is complete.
pub struct Backup {
    path: PathBuf,
    aside: Option<PathBuf>,
}

impl Backup {
    /// Renames `path` if it exists. Dropping the guard restores it like [`Backup::restore`], unless
    /// [`Backup::replaced`] was called.
    ///
    /// # Errors
    /// [`Kind::BadInput`] if it cannot be renamed.
    pub fn put(path: &Path) -> Result<Self, Failure> {
        let mut aside = None;
        if path.is_file() {
            let mut name = path.as_os_str().to_owned();
            name.push(".before");
            std::fs::rename(path, &name).map_err(|source| {
                file_failure(&FileError::Io {
                    path: path.to_owned(),
                    action: "rename",
                    source,
                })
            })?;
            aside = Some(PathBuf::from(name));
        }
        Ok(Self {
            path: path.to_owned(),
            aside,
        })
    }

    /// Removes the older file: its replacement is complete.
    pub fn replaced(mut self) {
        if let Some(aside) = self.aside.take() {
            // A file that cannot be removed stays.
            let _ = std::fs::remove_file(aside);
        }
    }

    /// Gives the older file its name again. A newer one of that name is kept beside it; returns
    /// where it is.
    #[must_use]
    pub fn restore(mut self) -> PathBuf {
        self.swap().unwrap_or_else(|| self.path.clone())
    }

    /// The new name of the newer file, where there is an older one.
    fn swap(&mut self) -> Option<PathBuf> {
        let aside = self.aside.take()?;
        let newer = self.path.is_file().then(|| self.free_name());
        if let Some(newer) = &newer
            && std::fs::rename(&self.path, newer).is_err()
        {
            // The older one keeps its other name: neither is lost.
            return None;
        }
        let _ = std::fs::rename(aside, &self.path);
        newer
    }

    /// A name beside the file that no file has: `scan-new.pcapng`.
    fn free_name(&self) -> PathBuf {
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let extension = self.path.extension().unwrap_or_default().to_string_lossy();
        let name = |number: u64| match number {
            1 => format!("{stem}-new.{extension}"),
            _ => format!("{stem}-new-{number}.{extension}"),
        };
        let names = (1..).map(|number| self.path.with_file_name(name(number)));
        let mut free = names.skip_while(|name| name.exists());
        free.next().unwrap_or_else(|| self.path.clone())
    }
}

impl Drop for Backup {
    fn drop(&mut self) {
        self.swap();
    }
}

/// Overwrite policy for `--force`.
#[must_use]
pub fn overwrite(force: bool) -> Overwrite {
    if force {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    }
}

/// Whether there is no space left for a file.
fn is_full(error: &stdio::Error) -> bool {
    use stdio::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}

/// The failure for a file error.
#[must_use]
pub fn file_failure(error: &FileError) -> Failure {
    let (kind, help) = match error {
        FileError::Exists { .. } => (
            Kind::Usage,
            "choose another name, or overwrite it with --force",
        ),
        FileError::Directory { .. } => (Kind::Usage, "name a file in it"),
        FileError::NoFolder { .. } => (Kind::Usage, "create the folder, or name another"),
        FileError::Io { source, .. } if source.kind() == stdio::ErrorKind::InvalidFilename => {
            (Kind::Usage, "choose a shorter name")
        }
        FileError::Io { source, .. } if is_full(source) => {
            (Kind::Incomplete, "free some space, or name another folder")
        }
        FileError::Io { .. } => (
            Kind::BadInput,
            "check the free space and the write permission of the folder",
        ),
    };
    Failure::new(kind, error.to_string()).help(help)
}

/// The failure for a sink error.
#[must_use]
pub fn sink_failure(path: &Path, error: &SinkError) -> Failure {
    if let SinkError::Write { source, .. } = error
        && source.kind() == stdio::ErrorKind::BrokenPipe
    {
        return Failure::new(
            Kind::Incomplete,
            "the reader of stdout closed it before the end of the cloud".to_owned(),
        )
        .help("read all of stdout, or write the cloud to a file");
    }
    if path == Path::new("-") {
        return Failure::new(
            Kind::Incomplete,
            format!("the cloud could not be written to stdout: {error}"),
        )
        .help(format!(
            "a PLY begins with its point count, so points are first stored in a scratch file, 29 bytes each: free some space in {}, \
             set TMPDIR to a folder with more, or name a file instead of -",
            ::io::files::scratch_folder().display()
        ));
    }
    if let SinkError::Write { source, .. } = error
        && source.kind() == stdio::ErrorKind::NotSeekable
    {
        return Failure::new(
            Kind::Incomplete,
            format!("the cloud {} could not be written: {error}", path.display()),
        )
        .help("this format needs a seekable file: use -o - for a PLY on stdout, or name a file");
    }
    Failure::new(
        Kind::Incomplete,
        format!("the cloud {} could not be written: {error}", path.display()),
    )
    .help("free some space or choose another folder; velomotion replay makes the cloud again from its log")
}

#[cfg(test)]
mod tests {
    use super::{Backup, Fields, Kind, Target};

    #[test]
    fn a_laz_is_not_named_as_if_it_were_copc() {
        let folder = tempfile::tempdir().unwrap();
        let open = |name| Target::open(&folder.path().join(name), Fields::FILE, false);
        let refused = open("hall.COPC.laz").err().unwrap();
        assert_eq!(refused.kind, Kind::Usage);
        assert!(refused.message.ends_with("COPC cannot be written"));
        assert!(open("copc.laz").is_ok());
    }

    #[test]
    fn neither_an_older_nor_a_newer_file_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scan.pcapng");
        let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        std::fs::write(&path, "older").unwrap();
        for newer in ["scan-new.pcapng", "scan-new-2.pcapng"] {
            let backup = Backup::put(&path).unwrap();
            std::fs::write(&path, newer).unwrap();
            assert_eq!(backup.restore(), folder.path().join(newer));
            assert_eq!(
                (text("scan.pcapng"), text(newer)),
                ("older".into(), newer.into())
            );
        }
        // Without a newer one.
        assert_eq!(Backup::put(&path).unwrap().restore(), path);
        drop(Backup::put(&path).unwrap());
        assert_eq!(text("scan.pcapng"), "older");
        let backup = Backup::put(&path).unwrap();
        std::fs::write(&path, "newer").unwrap();
        backup.replaced();
        assert_eq!(text("scan.pcapng"), "newer");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
    }
}
