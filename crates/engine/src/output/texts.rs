//! Text files: pages, figures, tables.

use std::io::Write;
use std::path::Path;

use io::files::{FileError, NewFile};

use super::{file_failure, overwrite};
use crate::failure::Failure;

/// Creates a folder and its parents.
///
/// # Errors
/// [`crate::failure::Kind::BadInput`] if the system refuses.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|source| {
        file_failure(&FileError::Io {
            path: folder.to_owned(),
            action: "create",
            source,
        })
    })
}

/// Writes a complete file or none.
///
/// # Errors
/// [`crate::failure::Kind::Usage`] for an existing file without `force`;
/// [`crate::failure::Kind::BadInput`] if the system refuses.
pub fn write_text(path: &Path, content: &str, force: bool) -> Result<(), Failure> {
    let mut file = NewFile::create(path, overwrite(force)).map_err(|error| file_failure(&error))?;
    file.write_all(content.as_bytes()).map_err(|source| {
        file_failure(&FileError::Io {
            path: path.to_owned(),
            action: "write",
            source,
        })
    })?;
    file.commit().map_err(|error| file_failure(&error))
}
