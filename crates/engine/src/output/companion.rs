//! Companion files of formats that need one: `metadata.yaml` of a bag, the metadata of a `.bin`.

use std::io::{self as stdio, Write};
use std::path::Path;

use ::io::files::{FileError, NewFile, Overwrite};
use cloud::Companion;

use crate::failure::{Failure, Kind};

/// Writes the companion of the file `path`. A companion of another file stays: a folder has room
/// for one, and both files are usable without it.
pub(super) fn write_beside(path: &Path, companion: &Companion) -> Result<(), Failure> {
    let beside = path.with_file_name(&companion.name);
    let failed = |what: String| {
        Failure::new(
            Kind::Incomplete,
            format!("the cloud {} is saved, but {what}", path.display()),
        )
        .help("check the free space and the write permission of the folder")
    };
    let older = match std::fs::read_to_string(&beside) {
        Ok(text) => Some(text),
        Err(error) if error.kind() == stdio::ErrorKind::NotFound => None,
        Err(error) => {
            return Err(failed(format!(
                "{} cannot be read: {error}",
                beside.display()
            )));
        }
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let ours = [format!("- {name}"), format!("- \"{name}\"")];
    let of_this = |text: String| {
        text.lines()
            .any(|line| ours.iter().any(|l| l == line.trim()))
    };
    if older.is_some_and(|text| !of_this(text)) {
        tracing::warn!(
            "{} belongs to another file and is kept; {name} is usable without it, or write it to a folder of its own",
            beside.display()
        );
        return Ok(());
    }
    let written = NewFile::create(&beside, Overwrite::Replace).and_then(|mut file| {
        match file.write_all(companion.text.as_bytes()) {
            Ok(()) => file.commit(),
            Err(source) => Err(FileError::Io {
                path: beside.clone(),
                action: "write",
                source,
            }),
        }
    });
    written.map_err(|error| failed(error.to_string()))
}
