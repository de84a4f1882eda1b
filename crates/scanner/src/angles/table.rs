//! A table of angles over time, measured by another rig.

use thiserror::Error;
use units::{Degrees, Host, Span, Stamp};

use super::AngleSample;
use crate::clock::Arrival;

/// Angles over time, in strictly increasing time.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleTable {
    rows: Vec<(f64, f64)>,
}

/// Reason why a table of angles is unusable.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AngleTableError {
    /// The table is of another time.
    #[error(
        "the tilt angles cover {table_from_s:.3}..{table_to_s:.3} s, the recording {recording_from_s:.3}..{recording_to_s:.3} s: they do not overlap"
    )]
    Elsewhere {
        /// First time of the table.
        table_from_s: f64,
        /// Last time of the table.
        table_to_s: f64,
        /// First packet.
        recording_from_s: f64,
        /// Last packet.
        recording_to_s: f64,
    },
    /// A table with fewer than two rows.
    #[error("tilt angles: expected at least two rows of time_s,angle_deg, got {rows}")]
    Short {
        /// Rows with numbers.
        rows: usize,
    },
    /// A table with a number out of range.
    #[error("tilt angles: row {row}: expected seconds within +-1e10 and degrees within +-3600")]
    Range {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// A table whose times do not increase.
    #[error("tilt angles: row {row} is not later than the row before it")]
    Order {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// A table whose angles begin again after a revolution: between them the axis would turn back.
    #[error(
        "tilt angles: row {row} is half a revolution or more from the row before it: expected angles that go on beyond 360 or -180 deg"
    )]
    Wrapped {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
}

/// Clock of a table's times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableTime {
    /// Host time: Unix seconds, as in the recording's packet headers.
    Unix,
    /// Seconds since the recording's first lidar packet.
    SinceFirstPacket,
}

/// Times below this (1973) count from the recording's first packet.
const UNIX_FROM_S: f64 = 1e8;

impl AngleTable {
    /// Rows of (seconds, degrees), in strictly increasing time.
    ///
    /// # Errors
    /// [`AngleTableError::Short`] with fewer than two rows, [`AngleTableError::Range`] for times
    /// and angles that cannot be, [`AngleTableError::Order`] where time does not increase,
    /// [`AngleTableError::Wrapped`] where angles begin again after a revolution.
    pub fn new(rows: Vec<(f64, f64)>) -> Result<Self, AngleTableError> {
        if rows.len() < 2 {
            return Err(AngleTableError::Short { rows: rows.len() });
        }
        if let Some(row) = rows.iter().position(|r| !in_range(*r)) {
            return Err(AngleTableError::Range { row: row + 1 });
        }
        let back = rows
            .windows(2)
            .position(|w| matches!(w, [a, b] if b.0 <= a.0));
        if let Some(row) = back {
            return Err(AngleTableError::Order { row: row + 2 });
        }
        match wrapped(&rows) {
            Some(row) => Err(AngleTableError::Wrapped { row: row + 1 }),
            None => Ok(Self { rows }),
        }
    }

    /// The clock of the table's times.
    #[must_use]
    pub fn time(&self) -> TableTime {
        match self.rows.first() {
            Some((first, _)) if *first >= UNIX_FROM_S => TableTime::Unix,
            _ => TableTime::SinceFirstPacket,
        }
    }

    /// The rows as samples in host time.
    pub(crate) fn samples(
        &self,
        arrivals: &[Arrival],
    ) -> Result<Vec<AngleSample>, AngleTableError> {
        let hosts = || arrivals.iter().map(|a| a.host);
        let (Some(first), Some(last)) = (hosts().min(), hosts().max()) else {
            return Ok(Vec::new());
        };
        let epoch: Stamp<Host> = match self.time() {
            TableTime::Unix => Stamp::from_nanos(0),
            TableTime::SinceFirstPacket => first,
        };
        let samples: Vec<AngleSample> = self
            .rows
            .iter()
            .map(|(seconds, angle)| AngleSample {
                host: epoch.saturating_add(Span::from_secs_f64(*seconds)),
                bound: Span::ZERO,
                angle: Degrees(*angle),
            })
            .collect();
        let overlaps = matches!(
            (samples.first(), samples.last()),
            (Some(from), Some(to)) if from.host <= last && to.host >= first
        );
        if overlaps {
            return Ok(samples);
        }
        let seconds = |host: Stamp<Host>| (host.saturating_since(epoch)).as_secs_f64();
        Err(AngleTableError::Elsewhere {
            table_from_s: self.rows.first().map_or(0.0, |r| r.0),
            table_to_s: self.rows.last().map_or(0.0, |r| r.0),
            recording_from_s: seconds(first),
            recording_to_s: seconds(last),
        })
    }
}

/// The first row after a jump of half a revolution or more that is more than twice as fast as the
/// other rows, while the rest of the revolution would be as slow as they are.
fn wrapped(rows: &[(f64, f64)]) -> Option<usize> {
    let steps = rows.windows(2).map(|pair| match pair {
        [before, after] => ((after.1 - before.1).abs(), after.0 - before.0),
        _ => (0.0, 1.0),
    });
    let usual_deg_s = steps
        .clone()
        .filter(|(step_deg, _)| *step_deg < 180.0)
        .map(|(step_deg, seconds)| 2.0 * step_deg / seconds)
        .reduce(f64::max)?;
    let mut steps = steps;
    let jump = steps.position(|(step_deg, seconds)| {
        let usual_deg = usual_deg_s * seconds;
        step_deg >= 180.0 && step_deg > usual_deg && 360.0 - step_deg <= usual_deg
    });
    jump.map(|at| at + 1)
}

/// Times from 1653 to 2286 and angles within ten revolutions: others are mistakes, and would
/// overflow 64 bits of nanoseconds.
fn in_range((seconds, degrees): (f64, f64)) -> bool {
    seconds.abs() <= 1e10 && degrees.abs() <= 3_600.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(from_s: i64, to_s: i64) -> Vec<Arrival> {
        [from_s, to_s]
            .map(|s| Arrival {
                device: Stamp::from_nanos(0),
                host: Stamp::from_nanos(s * 1_000_000_000),
            })
            .to_vec()
    }

    #[test]
    fn small_times_count_from_the_first_packet() {
        let table = AngleTable::new(vec![(0.5, -1.0), (1.5, -2.0)]).unwrap();
        assert_eq!(table.time(), TableTime::SinceFirstPacket);
        let samples = table
            .samples(&recording(1_600_000_000, 1_600_000_010))
            .unwrap();
        assert_eq!(samples[0].host.as_nanos(), 1_600_000_000_500_000_000);
    }

    /// Interpolated, the axis would turn back through the whole circle within one row.
    #[test]
    fn angles_that_begin_again_after_a_revolution_are_refused() {
        let table = |angles: &[f64]| {
            let rows = (0..).zip(angles).map(|(at, angle)| (f64::from(at), *angle));
            AngleTable::new(rows.collect()).map(|_| ())
        };
        let wrapped = |row| Err(AngleTableError::Wrapped { row });
        assert_eq!(table(&[358.0, 359.9, 1.8, 5.0]), wrapped(3));
        assert_eq!(table(&[178.0, 179.9, -179.0]), wrapped(3));
        assert_eq!(table(&[1.0, 359.0, 357.0]), wrapped(2));
        assert_eq!(table(&[0.0, 100.0, 200.0, 300.0, 40.0]), wrapped(5));
        // Slow and quantised motion.
        assert_eq!(table(&[358.0, 359.9, 359.9, 0.1, 2.0]), wrapped(4));
        assert_eq!(table(&[359.9, 359.95, 359.94, 0.01, 0.05]), wrapped(4));
        // Fast rotations, and sweeps there and back with a row at each end.
        for angles in [
            &[0.0, 360.0][..],
            &[0.0, 200.0, 400.0, 600.0],
            &[-90.0, 90.0],
            &[-90.0, 90.0, -90.0, 90.0],
            &[0.0, 100.0, -100.0, 100.0, 0.0],
            &[10.0, 0.0, -10.0, 0.0, 10.0],
        ] {
            assert_eq!(table(angles), Ok(()), "{angles:?}");
        }
    }

    #[test]
    fn unix_times_are_used_as_they_are() {
        let table = AngleTable::new(vec![(1.6e9, -1.0), (1.6e9 + 1.0, -2.0)]).unwrap();
        assert_eq!(table.time(), TableTime::Unix);
        let samples = table
            .samples(&recording(1_600_000_000, 1_600_000_010))
            .unwrap();
        assert_eq!(samples[0].host.as_nanos(), 1_600_000_000_000_000_000);
    }

    #[test]
    fn angles_of_another_time_are_refused_with_both_times() {
        let table = AngleTable::new(vec![(1.7e9, -1.0), (1.7e9 + 1.0, -2.0)]).unwrap();
        let error = table.samples(&recording(1_600_000_000, 1_600_000_010));
        let text = error.unwrap_err().to_string();
        assert!(
            text.contains("1700000000") && text.contains("1600000010"),
            "{text}"
        );
    }

    #[test]
    fn time_must_increase() {
        let rows = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)];
        assert_eq!(
            AngleTable::new(rows),
            Err(AngleTableError::Order { row: 3 })
        );
        assert_eq!(
            AngleTable::new(vec![(0.0, 0.0)]),
            Err(AngleTableError::Short { rows: 1 })
        );
        for bad in [(f64::NAN, 0.0), (9e18, 0.0), (1.0, f64::INFINITY)] {
            let table = AngleTable::new(vec![(0.0, 0.0), bad]);
            assert_eq!(table, Err(AngleTableError::Range { row: 2 }));
        }
    }
}
