//! How many points the shipped scenes give, beside Table 4 of the paper: `cargo run --release -p sim --example scan_counts`.
//!
//! Two things beside geometry and the sensor's range decide whether a beam returns, both stated here in a few lines, so that this needs nothing of the
//! engine: enough light (Lambert: reflectivity x cosine of incidence / range squared, 10 % head-on noticed up to 50 m), and the scanner's own frame.

use std::error::Error;

use glam::DVec3;
use sim::Head;
use sim::cast::{Caster, Ray, Reach};
use sim::scenery::{Material, Placed, Scenery, no_files, shipped};
use units::{Degrees, Metres};

/// Firings of 16 lasers a second, and degrees of azimuth from one to the next at 10 Hz: the paper's 28,800 a frame.
const FIRINGS_PER_S: f64 = 18_000.0;
const STEP_DEG: f64 = 0.2;
/// A target of so many percent is noticed up to so far, head-on.
const NOTICED: (f64, f64) = (10.0, 50.0);
/// What the scanner stands on hides beams that go lower, degrees.
const STAND_DEG: f64 = -30.0;
/// The motor's side of the frame hides these azimuths, degrees.
const FRAME_DEG: std::ops::Range<f64> = 175.0..185.0;

/// A scene of ours, the paper's place, and its points: VLP-16 level for 0.1 s, velomotion's fast scan in 0.8 s.
const PLACES: [(&str, &str, f64, f64); 3] = [
    ("hall", "building hall", 27_998.0, 201_851.0),
    ("parking", "parking area", 20_141.0, 158_351.0),
    ("quarry", "quarry", 16_954.0, 125_237.0),
];

/// What became of the beams.
#[derive(Default)]
struct Count {
    fired: f64,
    returned: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| scene | place of the paper | | VLP-16, 0.1 s | share | fast scan, 0.8 s | share | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, place, level, fast) in PLACES {
        let text = shipped(name).ok_or(name)?;
        let placed = Scenery::parse(text)?.place(seed(text), &mut no_files)?;
        let caster = placed.caster()?;
        let ours = [
            scan(&placed, &caster, 0.1, 0.0)?,
            scan(&placed, &caster, 0.8, -56.25)?,
        ];
        row(name, "", "simulated", &ours);
        let count = |returned, seconds: f64| Count {
            fired: seconds * FIRINGS_PER_S * 16.0,
            returned,
        };
        row("", place, "paper", &[count(level, 0.1), count(fast, 0.8)]);
    }
    Ok(())
}

fn row(scene: &str, place: &str, whose: &str, [level, fast]: &[Count; 2]) {
    let share = |count: &Count| 100.0 * count.returned / count.fired;
    println!(
        "| {scene} | {place} | {whose} | {:.0} | {:.1} % | {:.0} | {:.1} % | {:.2} |",
        level.returned,
        share(level),
        fast.returned,
        share(fast),
        fast.returned / level.returned
    );
}

/// The scene's own seed.
fn seed(text: &str) -> u64 {
    let line = text.lines().find_map(|line| line.strip_prefix("seed = "));
    line.and_then(|seed| seed.parse().ok()).unwrap_or(0)
}

/// A scan from level on, the axis turning steadily.
fn scan(
    placed: &Placed,
    caster: &Caster,
    seconds: f64,
    deg_per_s: f64,
) -> Result<Count, Box<dyn Error>> {
    let head = Head::new(Metres(0.06));
    let lowest = STAND_DEG.to_radians().sin();
    let mut count = Count::default();
    for firing in 0..(seconds * FIRINGS_PER_S).round() as u32 {
        let azimuth = f64::from(firing) * STEP_DEG;
        let tilt = Degrees(deg_per_s * f64::from(firing) / FIRINGS_PER_S);
        for laser in 0..16 {
            let (origin, direction) = head.beam(laser, Degrees(azimuth), tilt).ok_or("laser")?;
            count.fired += 1.0;
            let hidden = FRAME_DEG.contains(&(azimuth % 360.0)) || direction.z < lowest;
            if !hidden && returns(placed, caster, &Ray::new(origin, direction)?) {
                count.returned += 1.0;
            }
        }
    }
    Ok(count)
}

/// Whether a beam comes back: from 1 m to 100 m, with light enough.
fn returns(placed: &Placed, caster: &Caster, ray: &Ray) -> bool {
    let Some(hit) = caster.nearest::<DVec3>(ray, Reach::up_to(100.0)) else {
        return false;
    };
    let Some(material) = placed.material(hit.object.index(), hit.primitive) else {
        return false;
    };
    let cosine = hit.normal.dot(ray.direction()).abs();
    hit.range_m >= 1.0 && light(material) * cosine * (NOTICED.1 / hit.range_m).powi(2) >= NOTICED.0
}

/// Percent of the light that a material scatters; what retroreflects is seen wherever it is met.
fn light(material: &Material) -> f64 {
    match material.reflectivity {
        _ if material.absorbing => 0.0,
        diffuse @ 0..=100 => f64::from(diffuse) * (1.0 - material.specular),
        _ => 1e4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within 5 points of the paper's shares, level and fast, and its ratios within a twentieth.
    #[test]
    fn shares_of_returns_are_near_the_papers() {
        for (name, _, level, fast) in PLACES {
            let text = shipped(name).unwrap();
            let placed = Scenery::parse(text).unwrap();
            let placed = placed.place(seed(text), &mut no_files).unwrap();
            let caster = placed.caster().unwrap();
            let of = |seconds, speed| scan(&placed, &caster, seconds, speed).unwrap();
            let ours = [of(0.1, 0.0), of(0.8, -56.25)];
            for (ours, paper) in ours.iter().zip([level, fast]) {
                let off = 100.0 * (ours.returned - paper) / ours.fired;
                assert!(off.abs() < 5.0, "{name}: {off} points");
            }
            let ratio = ours[1].returned / ours[0].returned;
            assert!(
                (ratio / (fast / level) - 1.0).abs() < 0.05,
                "{name}: {ratio}"
            );
        }
    }
}
