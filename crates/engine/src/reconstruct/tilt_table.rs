//! The argument of `--tilt`: the log's angles, none, or a CSV table.

use std::path::Path;

use scanner::{AngleTable, AngleTableError, TiltSource};

use crate::failure::{Failure, Kind};

/// Lines, each with its time, seconds, and its angle, degrees.
type Rows = Vec<(usize, (f64, f64))>;

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

/// Reads a CSV of time_s,angle_deg.
fn angle_table(path: &Path) -> Result<AngleTable, Failure> {
    let wrong = |what: String| {
        Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(
            "--tilt takes log, none, or a CSV of time_s,angle_deg (time or t, angle or tilt) with decimal points: times in increasing \
             order, either Unix seconds or seconds since the recording's first packet",
        )
    };
    let text =
        std::fs::read_to_string(path).map_err(|error| wrong(format!("cannot read: {error}")))?;
    let rows = rows_of(&text).map_err(wrong)?;
    let (lines, rows): (Vec<usize>, Vec<(f64, f64)>) = rows.into_iter().unzip();
    AngleTable::new(rows).map_err(|error| match error {
        AngleTableError::Range { row }
        | AngleTableError::Order { row }
        | AngleTableError::Wrapped { row } => {
            let line = lines.get(row.saturating_sub(1)).copied().unwrap_or(row);
            wrong(format!("line {line}: {error}"))
        }
        error => wrong(error.to_string()),
    })
}

/// The rows with their lines. A first line without numbers is a header; it must name a time in
/// seconds and then an angle in degrees. The first line has the separator and the number of columns
/// of all: decimal commas would give other numbers.
fn rows_of(text: &str) -> Result<Rows, String> {
    // Spreadsheets begin UTF-8 with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = Rows::new();
    let mut columns = None;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let wrong =
            |expected: &str| Err(format!("line {number}: expected {expected}, got {line:?}"));
        let is_first = columns.is_none();
        let (separator, count) = *columns.get_or_insert_with(|| {
            let separator = if line.contains(';') { ';' } else { ',' };
            (separator, line.split(separator).count())
        });
        let cells: Vec<&str> = line.split(separator).map(str::trim).collect();
        if cells.len() != count {
            return wrong(&format!("{count} columns separated by {separator:?}"));
        }
        match parse_row(&cells) {
            Some(_) if is_first && count > 2 => {
                return wrong("the two columns time_s,angle_deg, or a header first");
            }
            Some(row) => rows.push((number, row)),
            None if is_first && is_header(&cells) => {}
            None if is_first => return wrong("the columns time_s,angle_deg"),
            None => return wrong("two finite numbers with decimal points"),
        }
    }
    Ok(rows)
}

/// Whether the first two names are a time and an angle without another unit; `time,angle` has
/// none.
fn is_header(header: &[&str]) -> bool {
    let known: [(&[&str], &str); 2] = [
        (&["time", "t", "timestamp"], "s"),
        (&["angle", "tilt", "tilt_angle", "a"], "deg"),
    ];
    header.len() >= known.len()
        && header.iter().zip(known).all(|(name, (names, unit))| {
            let name = name.to_lowercase();
            let end = format!("_{unit}");
            names.contains(&name.strip_suffix(&end).unwrap_or(&name))
        })
}

fn parse_row(cells: &[&str]) -> Option<(f64, f64)> {
    let [time, angle, ..] = cells else {
        return None;
    };
    let row: (f64, f64) = (time.parse().ok()?, angle.parse().ok()?);
    (row.0.is_finite() && row.1.is_finite()).then_some(row)
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
            "timestamp,tilt_angle_deg",
            "time_s,angle_deg,note",
            "\u{feff}time_s,angle_deg",
        ] {
            assert_eq!(rows_of(header), Ok(Vec::new()), "{header}");
        }
        for header in [
            "time_s,angle_rad",
            "time_ms,angle_deg",
            "time_s,position_qc",
            "time_s",
            "angle,time",
            "angle_deg,time_s",
            "seconds,radians",
            "time (ms),angle (rad)",
            "secs,nsecs,angle_deg",
            "time,speed,angle",
            "x,y,z",
        ] {
            let message = rows_of(header).unwrap_err();
            assert!(message.starts_with("line 1: expected the columns time_s,angle_deg"));
        }
    }

    #[test]
    fn rows_have_the_columns_of_the_first_line() {
        let expected = Ok(vec![(3, (0.0, -1.5)), (5, (1.0, 2.0))]);
        assert_eq!(
            rows_of("# of a rig\nt;a;note\n0;-1.5;x\n\n1 ; 2;y\n"),
            expected
        );
        for table in ["0, 1\n", "\u{feff}0,1\n"] {
            assert_eq!(rows_of(table), Ok(vec![(1, (0.0, 1.0))]));
        }
    }

    /// A decimal comma is a separator elsewhere: 0,5;10,2 must not become 0 s and 5 deg.
    #[test]
    fn decimal_commas_and_other_columns_are_refused() {
        for (table, wanted) in [
            ("0,5;10,2\n1,0;12,0", "line 1: expected the columns"),
            (
                "time_s;angle_deg\n0,5;10,2",
                "line 2: expected two finite numbers with decimal points",
            ),
            ("0,5,10,2\n1,0,12,0", "line 1: expected the two columns"),
            (
                "time,angle\n0,5,10,2",
                "line 2: expected 2 columns separated by ','",
            ),
            (
                "time;angle\n0,5",
                "line 2: expected 2 columns separated by ';'",
            ),
            ("0,1\n1;2", "line 2: expected 2 columns separated by ','"),
            ("0,1\n1,nan", "line 2: expected two finite numbers"),
            ("banana", "line 1: expected the columns"),
        ] {
            let message = rows_of(table).unwrap_err();
            assert!(message.starts_with(wanted), "{table}: {message}");
        }
    }
}
