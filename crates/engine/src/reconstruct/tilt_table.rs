//! The argument of `--tilt`: the log's angles, none, or a CSV table.

use std::path::Path;

use scanner::{AngleTable, AngleTableError, TiltSource};

use crate::failure::{Failure, Kind};

/// Reads `--tilt`: `log`, `none`, or the path of a CSV.
///
/// # Errors
/// [`Kind::BadInput`] where the file is missing or malformed.
pub fn tilt_source(text: &str) -> Result<TiltSource, Failure> {
    match text {
        "log" => Ok(TiltSource::Log),
        "none" => Ok(TiltSource::None),
        path => angle_table(Path::new(path)).map(TiltSource::Table),
    }
}

/// Reads a CSV of time_s,angle_deg. A first line without numbers is a header.
fn angle_table(path: &Path) -> Result<AngleTable, Failure> {
    let wrong = |what: String| {
        Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(
            "give a CSV of two columns, time_s,angle_deg: times in increasing order, either Unix seconds\n\
             or seconds since the recording's first packet",
        )
    };
    let text =
        std::fs::read_to_string(path).map_err(|error| wrong(format!("cannot read: {error}")))?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    let mut heading = false;
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        let blank = line.is_empty() || line.starts_with('#');
        match parse_row(line) {
            Some(row) => {
                rows.push(row);
                lines.push(number + 1);
            }
            None if blank => {}
            None if rows.is_empty() && !heading => heading = true,
            None => {
                return Err(wrong(format!(
                    "line {}: expected two finite numbers, got {line:?}",
                    number + 1
                )));
            }
        }
    }
    AngleTable::new(rows).map_err(|error| match error {
        AngleTableError::Range { row } | AngleTableError::Order { row } => {
            let line = lines.get(row.saturating_sub(1)).copied().unwrap_or(row);
            wrong(format!("line {line}: {error}"))
        }
        error => wrong(error.to_string()),
    })
}

fn parse_row(line: &str) -> Option<(f64, f64)> {
    let mut cells = line
        .split([',', ';'])
        .map(|cell| cell.trim().parse::<f64>());
    match (cells.next(), cells.next()) {
        (Some(Ok(time)), Some(Ok(angle))) if time.is_finite() && angle.is_finite() => {
            Some((time, angle))
        }
        _ => None,
    }
}
