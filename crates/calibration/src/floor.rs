//! The zero of the tilt by the floor: the encoder's zero turns every surface about the axis alike.

use crate::equations::ShotWeights;
use crate::linear::Vec3;
use crate::model::ScannerModel;
use crate::patches::Patches;
use crate::shots::Scan;

/// Surfaces count as floor down to this cosine of their slope.
const MIN_COSINE: f64 = 0.985;
/// Depth below the axis at which floors begin, metres.
const MIN_DEPTH_M: f64 = 0.3;
/// Fewest elements of a floor.
const MIN_ELEMENTS: usize = 20;

/// The tilt by which the floor becomes level across the axis, radians; `None` without a floor.
pub(crate) fn tilt_rad(scans: &[Scan], model: &ScannerModel<'_>, noise_m: &[f64]) -> Option<f64> {
    let weigh: Vec<_> = scans
        .iter()
        .map(|scan| ShotWeights::new(scan, noise_m))
        .collect();
    let patches = Patches::new(scans, model, &weigh);
    let frames = patches
        .list
        .iter()
        .map(|patch| (&patch.frame.centre, patch.frame.normal));
    let mut tilts: Vec<f64> = frames
        .filter(|(centre, normal)| normal[2].abs() > MIN_COSINE && centre[2] < -MIN_DEPTH_M)
        .map(|(_, normal)| tilt_of(normal))
        .collect();
    if tilts.len() < MIN_ELEMENTS {
        return None;
    }
    let middle = tilts.len() / 2;
    Some(*tilts.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The tilt (z to x) that turns a normal upright across the axis.
fn tilt_of([x, _, z]: Vec3) -> f64 {
    -(x / z).atan()
}

#[cfg(test)]
mod tests {
    use cloud::mount::{Mount, Tilt};
    use units::{Degrees, Metres};

    use super::*;

    #[test]
    fn a_tilted_normal_becomes_upright() {
        for normal in [[0.05, 0.1, 0.99], [0.05, -0.1, -0.99]] {
            let tilt = Tilt::new(Degrees(tilt_of(normal).to_degrees()));
            let [x, ..] = Mount::new(Metres(0.0)).place(normal, tilt);
            assert!(x.abs() < 1e-12, "{x}");
        }
    }
}
