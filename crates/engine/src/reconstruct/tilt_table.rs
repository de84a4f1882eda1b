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

/// Reads a CSV of time_s,angle_deg. A first line without numbers is a header; its units must be
/// these.
fn angle_table(path: &Path) -> Result<AngleTable, Failure> {
    let wrong = |what: String| {
        Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(
            "give a CSV of two columns, time_s,angle_deg: times in increasing order, either Unix seconds \
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
            None if rows.is_empty() && !heading => {
                if !has_units(line) {
                    return Err(wrong(format!(
                        "line {}: expected the columns time_s,angle_deg, got {line:?}",
                        number + 1
                    )));
                }
                heading = true;
            }
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

/// Whether no column of a header has another unit: `time,angle` has none.
fn has_units(header: &str) -> bool {
    let units = ["s", "deg"];
    header.split([',', ';']).zip(units).all(|(name, unit)| {
        let name = name.trim().to_lowercase();
        match name.rsplit_once('_') {
            Some((_, found)) => found == unit,
            None => !name.is_empty(),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_name_seconds_and_degrees_or_no_unit() {
        for header in [
            "time_s,angle_deg",
            "Time;Angle",
            "t_s, tilt_deg",
            "time_s,angle_deg,note",
        ] {
            assert!(has_units(header), "{header}");
        }
        for header in [
            "time_s,angle_rad",
            "time_ms,angle_deg",
            "time_s,position_qc",
        ] {
            assert!(!has_units(header), "{header}");
        }
    }
}
