//! Description of a cloud.
//!
//! It contains no wall-clock time, user or host name: the same log must give the same file.

use crate::EastNorthUp;

/// Contents of a file's header, for all formats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Whether the devices were simulated. Every format marks that as early as it can.
    pub simulated: bool,
    /// Source of the points: the sensor and the rig.
    pub source: String,
    /// Name and version of the software that made the cloud.
    pub software: String,
    /// Epoch and clock of the time column, in words.
    pub time_reference: String,
    /// Whether the lidar reported two returns of each pulse. LAS numbers them.
    pub dual_return: bool,
    /// Whether the points are in the sensor's own frame, without tilt.
    pub sensor_frame: bool,
    /// Axes of a georeferenced file, into which its writer turns the points of the scanner.
    pub east_north_up: Option<EastNorthUp>,
    /// Further comments; several lines become several comments.
    pub comments: Vec<String>,
}

/// Longest comment line: some PLY readers keep a line in 1024 bytes, some split it into at most 32
/// words.
const LINE_CHARS: usize = 120;

impl Metadata {
    /// The metadata as lines of printable ASCII, none empty, none longer than 120 characters. For
    /// simulated devices the first line starts with `SIMULATED`.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut text = Vec::new();
        if self.simulated {
            text.push("SIMULATED: simulated devices, not a scan of anything real".to_owned());
        }
        let named = [
            ("software", &self.software),
            ("source", &self.source),
            ("time", &self.time_reference),
        ];
        for (name, value) in named {
            if !value.is_empty() {
                text.push(format!("{name}: {value}"));
            }
        }
        let origin = match self.sensor_frame {
            true => "the sensor, not tilted",
            false => "the tilt axis; tilt in degrees",
        };
        // `velomotion view` draws the scanner in clouds whose metres count from the tilt axis.
        text.push(match self.east_north_up {
            None => format!("frame: x right, y forward, z up in metres from {origin}"),
            Some(_) => format!("frame: x east, y north, z up in metres, origin at {origin}"),
        });
        text.extend(self.comments.iter().cloned());
        text.iter().flat_map(|text| printable(text)).collect()
    }
}

/// Splits at control characters and at the longest line, and replaces non-ASCII characters, on
/// which readers of PLY and LAS fail.
fn printable(text: &str) -> Vec<String> {
    text.split(|c: char| c.is_control() && c != '\t')
        .flat_map(|line| {
            let line: Vec<char> = line
                .trim()
                .chars()
                .map(|c| match c {
                    '\t' => ' ',
                    c if c.is_ascii() => c,
                    _ => '?',
                })
                .collect();
            let parts: Vec<String> = line
                .chunks(LINE_CHARS)
                .map(|part| part.iter().collect::<String>().trim().to_owned())
                .collect();
            parts
        })
        .filter(|line| !line.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_clouds_are_marked_first_and_others_are_not() {
        let mut metadata = Metadata {
            simulated: true,
            software: "velomotion 0.1.0".into(),
            ..Metadata::default()
        };
        let lines = metadata.lines();
        assert!(lines[0].starts_with("SIMULATED"));
        assert_eq!(lines[1], "software: velomotion 0.1.0");
        metadata.simulated = false;
        assert!(!metadata.lines().join("").contains("SIMULATED"));
    }

    #[test]
    fn lines_cannot_break_a_header() {
        let metadata = Metadata {
            comments: vec![
                "two\nlines\r\n\n  \nend_header".into(),
                "é\u{0}\u{1b}[31m".into(),
                "@".repeat(1000),
            ],
            ..Metadata::default()
        };
        let lines = metadata.lines();
        assert_eq!(lines[1..4], ["two", "lines", "end_header"]);
        for line in &lines {
            assert!(!line.is_empty() && line.len() <= LINE_CHARS, "{line:?}");
            assert!(line.bytes().all(|b| (b' '..=b'~').contains(&b)), "{line:?}");
        }
        assert_eq!(lines.join("").matches('@').count(), 1000);
    }
}
