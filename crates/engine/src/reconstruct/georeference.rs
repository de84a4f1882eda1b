//! Origin and accuracy of a georeferenced cloud, from the fixes of the lidar's satellite receiver.

use std::path::Path;

use protocol::vlp16::{PositionPacket, Pps, UtcTime};
use units::Degrees;

use super::report::{GeoreferenceReport, GpsReport};
use super::satellite::pps_name;
use crate::failure::{Failure, Kind};

/// Most fixes kept: 18 hours of one per second, 1 MiB. Of longer recordings every second or fourth
/// fix, and so on, is kept.
const MAX_FIXES: usize = 1 << 16;
/// Mean radius of the earth. The ellipsoid differs by 0.6 % of a spread.
const EARTH_M: f64 = 6_371_009.0;

/// Collects the fixes of a recording.
#[derive(Debug)]
pub(super) struct FixSurvey {
    heading: Degrees,
    packets: u64,
    /// Time of the last fix.
    last: Option<UtcTime>,
    fixes: u64,
    /// One fix in so many is kept.
    stride: u64,
    /// Latitude and longitude in degrees; longitudes within 180 deg of the first.
    kept: Vec<[f64; 2]>,
}

impl FixSurvey {
    /// Creates a survey for a scanner of this heading.
    pub const fn new(heading: Degrees) -> Self {
        Self {
            heading,
            packets: 0,
            last: None,
            fixes: 0,
            stride: 1,
            kept: Vec::new(),
        }
    }

    /// Takes a position packet. Packets repeat a sentence until the next.
    pub fn observe(&mut self, packet: &PositionPacket<'_>) {
        self.packets += 1;
        let Ok(rmc) = packet.rmc() else {
            return;
        };
        let Some(position) = rmc.position.filter(|_| rmc.valid && rmc.utc != self.last) else {
            return;
        };
        self.last = rmc.utc;
        if self.fixes.is_multiple_of(self.stride) {
            if self.kept.len() == MAX_FIXES {
                let mut is_odd = true;
                self.kept.retain(|_| {
                    is_odd = !is_odd;
                    !is_odd
                });
                self.stride *= 2;
            }
            let first_deg = self.kept.first().map_or(0.0, |fix| fix[1]);
            let east_deg = position.longitude_deg - first_deg;
            let longitude_deg = first_deg + wrap_longitude(east_deg);
            self.kept.push([position.latitude_deg, longitude_deg]);
        }
        self.fixes += 1;
    }

    /// The frame, for a pulse in the state `pps`.
    ///
    /// # Errors
    /// [`Kind::BadInput`] if no fix is valid.
    pub fn report(&self, path: &Path, pps: Option<Pps>) -> Result<GeoreferenceReport, Failure> {
        let axis = |axis: usize| median(self.kept.iter().filter_map(|fix| fix.get(axis).copied()));
        let (Some(latitude_deg), Some(longitude_deg), Some(pps)) = (axis(0), axis(1), pps) else {
            let what = format!(
                "{}: --georeference needs the position of a satellite receiver: expected valid fixes, found none (position packets: {})",
                path.display(),
                self.packets
            );
            return Err(Failure::new(Kind::BadInput, what).help(
                "velomotion info shows the state of the receiver; record again once it has a fix, or omit --georeference",
            ));
        };
        let cos_latitude = latitude_deg.to_radians().cos();
        let distances = self.kept.iter().map(|[latitude, longitude]| {
            let north = (latitude - latitude_deg).to_radians();
            let east = (longitude - longitude_deg).to_radians() * cos_latitude;
            EARTH_M * north.hypot(east)
        });
        let spread_worst_m = distances.clone().fold(0.0, f64::max);
        let spread_p50_m = median(distances).unwrap_or_default();
        let origin = match self.fixes {
            1 => "the origin is the only fix".to_owned(),
            fixes => format!(
                "the origin is the median of {fixes} fixes, half within {spread_p50_m:.1} m of it, all within {spread_worst_m:.1} m"
            ),
        };
        // Garmin, GPS 16x Technical Specifications (190-00228-08), 1.5.4.4: < 15 m, 95 % typical.
        let accuracy = format!(
            "{origin}; fixes share errors: receivers such as the GPS 16x are specified to 15 m (95 %); 1 deg of heading is {:.0} mm at 20 m; the height is unknown, and the base is taken as level",
            20e3 * 1.0_f64.to_radians()
        );
        Ok(GeoreferenceReport {
            origin: GpsReport {
                latitude_deg,
                longitude_deg: wrap_longitude(longitude_deg),
            },
            heading_deg: self.heading.0,
            fixes: self.fixes,
            spread_p50_m,
            spread_worst_m,
            pps: pps_name(pps),
            accuracy,
        })
    }
}

impl GeoreferenceReport {
    /// The origin and the heading in words, each with its label.
    #[must_use]
    pub fn frame(&self) -> [(&'static str, String); 2] {
        let GpsReport {
            latitude_deg,
            longitude_deg,
        } = self.origin;
        let (heading_deg, pps) = (self.heading_deg, &self.pps);
        let origin = format!("{latitude_deg:.6}, {longitude_deg:.6} deg (WGS 84), pulse {pps}");
        let heading = format!("y forward was {heading_deg} deg clockwise from true north");
        [("origin", origin), ("heading", heading)]
    }

    /// The accuracy, a statement each.
    pub fn accuracy_clauses(&self) -> impl Iterator<Item = &str> {
        self.accuracy.split("; ")
    }

    /// Comments in a cloud's metadata.
    pub(super) fn comments(&self) -> Vec<String> {
        let clauses = self.accuracy_clauses();
        let accuracy = clauses.map(|clause| ("accuracy", clause.to_owned()));
        let named = self.frame().into_iter().chain(accuracy);
        named
            .map(|(name, text)| format!("{name}: {text}"))
            .collect()
    }
}

/// A longitude from -180 to 180, degrees.
fn wrap_longitude(longitude_deg: f64) -> f64 {
    match longitude_deg {
        east if east > 180.0 => east - 360.0,
        west if west < -180.0 => west + 360.0,
        longitude => longitude,
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let lower = sorted.get(sorted.len().checked_sub(1)? / 2)?;
    let upper = sorted.get(sorted.len() / 2)?;
    Some(f64::midpoint(*lower, *upper))
}

#[cfg(test)]
mod tests {
    use firmware_sim::vlp16::position_packet;

    use super::*;

    /// Observes a packet with the sentence of a second of the day.
    fn observe(survey: &mut FixSurvey, status: char, second: u64, longitude: &str) {
        let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
        let body = format!(
            "GPRMC,{hour:02}{minute:02}{second:02},{status},4807.038,N,{longitude},022.4,084.4,230326,003.1,W"
        );
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let sentence = format!("${body}*{sum:02X}\r\n");
        let bytes = position_packet(17, Pps::Locked, sentence.as_bytes());
        survey.observe(&PositionPacket::new(&bytes).unwrap());
    }

    fn report(survey: &FixSurvey) -> Result<GeoreferenceReport, Failure> {
        survey.report(Path::new("hall.pcapng"), Some(Pps::Locked))
    }

    #[test]
    fn the_origin_is_the_median_of_the_valid_fixes() {
        let mut survey = FixSurvey::new(Degrees(30.0));
        // On both sides of the antimeridian; a repeated sentence, an invalid and a wild one.
        for (status, second, longitude) in [
            ('A', 1, "17959.990,E"),
            ('A', 2, "17959.990,W"),
            ('A', 2, "17959.990,W"),
            ('V', 3, "17900.000,E"),
            ('A', 4, "17959.995,W"),
            ('A', 5, "17959.980,W"),
            ('A', 6, "17900.000,E"),
        ] {
            observe(&mut survey, status, second, longitude);
        }
        let report = report(&survey).unwrap();
        assert_eq!(report.fixes, 5);
        assert!((report.origin.longitude_deg + 179.0 + 59.995 / 60.0).abs() < 1e-9);
        assert!((report.origin.latitude_deg - 48.1173).abs() < 1e-9);
        // A minute of longitude is one of latitude, 1853.2 m, times the cosine of the latitude.
        let minute_m = 1853.2 * 48.1173_f64.to_radians().cos();
        assert!(
            (report.spread_p50_m - 0.015 * minute_m).abs() < 0.1,
            "{report:?}"
        );
        assert!((report.spread_worst_m / (60.005 * minute_m) - 1.0).abs() < 1e-3);
        assert!(
            report
                .accuracy
                .contains("1 deg of heading is 349 mm at 20 m")
        );
        assert_eq!((report.heading_deg, &*report.pps), (30.0, "locked"));
    }

    #[test]
    fn a_recording_without_a_valid_fix_is_refused() {
        let mut survey = FixSurvey::new(Degrees(0.0));
        observe(&mut survey, 'V', 1, "17959.990,E");
        let failure = report(&survey).unwrap_err();
        assert_eq!(failure.kind, Kind::BadInput);
        assert!(failure.message.starts_with("hall.pcapng: --georeference"));
        assert!(
            failure
                .message
                .ends_with("found none (position packets: 1)"),
            "{failure}"
        );
    }

    /// The memory of a long recording is bounded.
    #[test]
    fn of_many_fixes_a_part_is_kept() {
        let mut survey = FixSurvey::new(Degrees(0.0));
        for second in 0..80_000 {
            observe(&mut survey, 'A', second, "01131.000,E");
        }
        assert_eq!((survey.fixes, survey.stride), (80_000, 2));
        assert_eq!(survey.kept.len(), 40_000);
        assert_eq!(report(&survey).unwrap().fixes, 80_000);
    }
}
