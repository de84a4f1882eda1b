//! Where a cloud goes: a file that takes its name when it is complete, or stdout.

mod companion;
mod file;
mod texts;

use std::io as stdio;
use std::path::{Path, PathBuf};

use ::io::files::{FileError, NewFile, Overwrite};
use cloud::formats::Format;
use cloud::formats::mcap::McapWriter;
use cloud::formats::pcd::PcdWriter;
use cloud::formats::ply::PlyPipe;
use cloud::{Fields, Sink, SinkError};

use self::companion::write_beside;
use crate::failure::{Failure, Kind};

pub use self::file::{Buffered, Shared};
pub use self::texts::{make_folder, write_text};

/// A cloud's destination, checked and opened before anything is measured.
pub struct Target {
    path: PathBuf,
    file: Option<Shared>,
    sink: Box<dyn Sink + Send>,
}

impl Target {
    /// Opens `path` for a cloud with the columns `fields`: the format by its extension, `-` for PLY on stdout.
    ///
    /// # Errors
    /// [`Kind::Usage`] where the extension names no format or the file exists and `force` is not set; [`Kind::BadInput`] where it
    /// cannot be made.
    pub fn open(path: &Path, fields: Fields, force: bool) -> Result<Self, Failure> {
        if path == Path::new("-") {
            let scratch = ::io::files::scratch().map_err(|error| {
                Failure::new(Kind::BadInput, format!("cannot write to stdout: {error}"))
                    .help("set TMPDIR to a folder with room for the cloud, or name a file with -o")
            })?;
            let scratch = Buffered::new(scratch);
            return Ok(Self {
                path: path.to_owned(),
                file: None,
                sink: Box::new(PlyPipe::new(stdio::stdout(), scratch).with_fields(fields)),
            });
        }
        let format = Format::from_path(path).map_err(|error| {
            Failure::new(Kind::Usage, format!("{}: {error}", path.display()))
                .help("give -o a name with one of those extensions, or - for PLY on stdout")
        })?;
        Self::file(path, force, |file| {
            format.writer(Buffered::new(file), fields)
        })
    }

    /// Opens `path` for an organised cloud of so many rows with the columns `fields`: a PCD.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn organised(path: &Path, fields: Fields, force: bool, rows: u64) -> Result<Self, Failure> {
        Self::file(path, force, |file| {
            Box::new(PcdWriter::organised(Buffered::new(file), rows).with_fields(fields))
        })
    }

    /// Opens `path` for the clouds of many turns of the lidar in one file: an MCAP.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn turns(path: &Path, fields: Fields, force: bool) -> Result<Self, Failure> {
        Self::file(path, force, |file| {
            let writer = McapWriter::new(Buffered::new(file));
            Box::new(writer.with_fields(fields).by_turns())
        })
    }

    /// Opens `path` for what a `writer` makes of a cloud.
    ///
    /// # Errors
    /// As [`Target::open`].
    pub fn file(
        path: &Path,
        force: bool,
        writer: impl FnOnce(Shared) -> Box<dyn Sink + Send>,
    ) -> Result<Self, Failure> {
        let file = NewFile::create(path, overwrite(force)).map_err(|error| file_failure(&error))?;
        let shared = Shared::new(file);
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

    /// The name as the user gave it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the cloud goes to stdout, where nothing else may go then.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        self.file.is_none()
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// What the sink or the file system reports; an older file of that name is then as it was.
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

/// Refuses a name that is taken, before anything is opened.
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

/// Refuses `-` for a log: it is a file, read again to make the cloud.
///
/// # Errors
/// [`Kind::Usage`] that says `with` what to name one.
pub fn log_is_file(log: &Path, with: &str) -> Result<(), Failure> {
    if log == Path::new("-") {
        return Err(Failure::new(
            Kind::Usage,
            format!("a log is a file: expected its name with {with}, got -"),
        )
        .help(format!("name a file with {with}")));
    }
    Ok(())
}

/// Refuses to write a cloud over the log or recording that it is made of.
///
/// # Errors
/// [`Kind::Usage`].
pub fn two_files(log: &Path, cloud: &Path) -> Result<(), Failure> {
    if same_file(log, cloud) {
        return Err(Failure::new(
            Kind::Usage,
            format!(
                "the cloud and what it is made of are both {}",
                log.display()
            ),
        )
        .help("give the cloud another name with -o"));
    }
    Ok(())
}

/// Refuses to write over what is read.
///
/// # Errors
/// [`Kind::Usage`].
pub fn not_over(input: &Path, output: &Path) -> Result<(), Failure> {
    if same_file(input, output) {
        return Err(Failure::new(
            Kind::Usage,
            format!(
                "{} would be written over what it is made of",
                output.display()
            ),
        )
        .help("give it another name"));
    }
    Ok(())
}

/// Whether two names are one file, there or not.
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

/// Refuses a cloud and a JSON object on one stdout.
///
/// # Errors
/// [`Kind::Usage`].
pub fn one_for_stdout(cloud: Option<&Path>, json: bool) -> Result<(), Failure> {
    if json && cloud == Some(Path::new("-")) {
        return Err(
            Failure::new(Kind::Usage, "-o - and --json both want stdout".to_owned())
                .help("name a file with -o, or leave --json out"),
        );
    }
    Ok(())
}

/// An older file of a name, put aside until the new one is worth more.
pub struct Aside {
    path: PathBuf,
    aside: Option<PathBuf>,
}

impl Aside {
    /// Puts `path` aside if it is there. Dropped without [`Aside::replaced`], it is put back.
    ///
    /// # Errors
    /// [`Kind::BadInput`] where it cannot be renamed.
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

    /// The new file is there: the older one goes.
    pub fn replaced(mut self) {
        if let Some(aside) = self.aside.take() {
            // What cannot be removed stays, which loses nothing.
            let _ = std::fs::remove_file(aside);
        }
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        if let Some(aside) = self.aside.take() {
            let _ = std::fs::rename(aside, &self.path);
        }
    }
}

/// `--force` or not.
#[must_use]
pub fn overwrite(force: bool) -> Overwrite {
    if force {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    }
}

/// A file that cannot be made, with what to do about it.
#[must_use]
pub fn file_failure(error: &FileError) -> Failure {
    let (kind, help) = match error {
        FileError::Exists { .. } => (
            Kind::Usage,
            "choose another name, or overwrite it with --force",
        ),
        FileError::Directory { .. } => (Kind::Usage, "name a file in it"),
        FileError::NoFolder { .. } => (Kind::Usage, "make the folder first, or name another"),
        FileError::Io { .. } => (
            Kind::BadInput,
            "see whether the disk is full and the folder may be written to",
        ),
    };
    Failure::new(kind, error.to_string()).help(help)
}

/// A cloud that cannot be written, with what to do about it.
#[must_use]
pub fn sink_failure(path: &Path, error: &SinkError) -> Failure {
    if let SinkError::Write { source, .. } = error
        && source.kind() == stdio::ErrorKind::BrokenPipe
    {
        return Failure::new(
            Kind::Incomplete,
            "whoever read the cloud from stdout closed it before its end".to_owned(),
        )
        .help("read all of it, or write the cloud to a file with -o");
    }
    if path == Path::new("-") {
        return Failure::new(
            Kind::Incomplete,
            format!("the cloud could not be written to stdout: {error}"),
        )
        .help(format!(
            "its points wait in a scratch file, 29 bytes each, as a PLY begins with their count: free some space in {}, \
             set TMPDIR to a folder with more, or name a file with -o",
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
        .help("a pipe cannot be gone back in: use -o - and send stdout there, or name a file");
    }
    Failure::new(
        Kind::Incomplete,
        format!("the cloud {} could not be written: {error}", path.display()),
    )
    .help("free some space or name another place; the cloud can be made again from its log with replay")
}
