//! Field of view of a log, by its lidar, sweeps and mount.

use cloud::TiltTrack;
use protocol::vlp16::Laser;
use protocol::vlp16::models::ALL;
use sim::patterns::FieldOfView;

use super::report::ScanReport;

/// A field of view and what it is of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LogView {
    /// The directions.
    pub view: FieldOfView,
    /// Lowest and highest laser above the sensor's horizontal plane, degrees.
    pub elevations_deg: [f64; 2],
    /// Smallest and largest tilt, degrees.
    pub tilt_deg: [f64; 2],
    /// Height of the sensor above the tilt axis, metres.
    pub d_m: f64,
}

impl LogView {
    /// Field of view of a scan at all distances of a range, metres; `None` for an unknown model or
    /// several lidars.
    #[must_use]
    pub fn new(scan: &ScanReport, track: &TiltTrack, distance_m: [f64; 2]) -> Option<Self> {
        if scan.contents.sensors.len() > 1 {
            return None;
        }
        let name = scan.contents.model.as_deref()?;
        let model = ALL.into_iter().find(|model| model.name == name)?;
        let by = |a: &&Laser, b: &&Laser| a.elevation_deg.total_cmp(&b.elevation_deg);
        let (low, high) = (
            model.lasers.iter().min_by(by)?,
            model.lasers.iter().max_by(by)?,
        );
        let tilts = scan
            .sweeps
            .iter()
            .flat_map(|sweep| [sweep.from_deg, sweep.to_deg]);
        let tilt_deg = tilts.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], tilt| {
            [least.min(tilt), most.max(tilt)]
        });
        let tilt_deg = match scan.sweeps.is_empty() {
            true => [0.0; 2],
            false => tilt_deg,
        };
        let d_m = track.mount.map_or(0.0, |mount| mount.position_m()[2]);
        let elevations_deg = [low.elevation_deg, high.elevation_deg];
        let heights_m = [low, high].map(|laser| d_m + laser.vertical_offset_m);
        Some(Self {
            view: FieldOfView::new(elevations_deg, tilt_deg, heights_m, distance_m),
            elevations_deg,
            tilt_deg,
            d_m,
        })
    }
}
