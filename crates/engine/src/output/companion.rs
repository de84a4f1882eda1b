//! Companion files of formats that need one: `metadata.yaml` of a bag, the metadata of a `.bin`.

use std::io::{self as stdio, Write};
use std::path::Path;

use ::io::files::{FileError, NewFile, Overwrite};
use cloud::Companion;

use crate::failure::{Failure, Kind};

/// Refuses a cloud whose metadata have no place, since another file has the name of its companion.
///
/// # Errors
/// [`Kind::Usage`], [`Kind::BadInput`] for a file that cannot be read.
pub(super) fn check_beside(path: &Path) -> Result<(), Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let companion = path.with_file_name(format!("{name}.txt"));
    let place = companion.display();
    match is_of_another(&companion, &name) {
        Ok(false) => Ok(()),
        Ok(true) => {
            let what =
                format!("{place}: expected the metadata of an earlier {name}, got another file");
            Err(Failure::new(Kind::Usage, what)
                .help("rename that file, or give the cloud another name"))
        }
        Err(error) => Err(
            Failure::new(Kind::BadInput, format!("{place}: cannot read: {error}"))
                .help("rename that file, or give the cloud another name"),
        ),
    }
}

/// Whether a companion belongs to another file than `name`, which its list of files would have.
fn is_of_another(companion: &Path, name: &str) -> stdio::Result<bool> {
    let text = match std::fs::read_to_string(companion) {
        Ok(text) => text,
        Err(error) if error.kind() == stdio::ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(error),
    };
    let ours = [format!("- {name}"), format!("- \"{name}\"")];
    Ok(!text
        .lines()
        .any(|line| ours.iter().any(|own| own == line.trim())))
}

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
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match is_of_another(&beside, &name) {
        Ok(false) => {}
        Ok(true) => {
            tracing::warn!(
                "{} belongs to another file and is kept; {name} is usable without it, or write it to a folder of its own",
                beside.display()
            );
            return Ok(());
        }
        Err(error) => {
            return Err(failed(format!(
                "{} cannot be read: {error}",
                beside.display()
            )));
        }
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
