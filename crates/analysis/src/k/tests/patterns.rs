//! Scan patterns, by the paper's Eq. 1-6 with d = 0.

use glam::DVec3;

/// Firings of 16 lasers from -15 to 15 degrees, at this many azimuths 0.4 degrees apart from 0.
pub fn vlp16(azimuths: u32) -> Vec<DVec3> {
    let mut points = Vec::new();
    for azimuth in 0..azimuths {
        let (sin_a, cos_a) = (f64::from(azimuth) * 0.4).to_radians().sin_cos();
        for laser in 0..16 {
            let (sin_w, cos_w) = (f64::from(laser) * 2.0 - 15.0).to_radians().sin_cos();
            points.push(DVec3::new(cos_w * sin_a, cos_w * cos_a, sin_w));
        }
    }
    points
}

/// Rotates points about y by a tilt (Eq. 4-6).
pub fn tilted(frame: &[DVec3], tilt_deg: f64) -> impl Iterator<Item = DVec3> {
    let (sin_g, cos_g) = tilt_deg.to_radians().sin_cos();
    let turn =
        move |p: &DVec3| DVec3::new(p.x * cos_g + p.z * sin_g, p.y, p.z * cos_g - p.x * sin_g);
    frame.iter().map(turn)
}

/// This many frames of 901 azimuths at even tilts from 0 to below 180 degrees, constant within a
/// frame.
pub fn rmbl(frames: u32) -> Vec<DVec3> {
    let frame = vlp16(901);
    let step = 180.0 / f64::from(frames);
    let tilts = (0..frames).map(|k| f64::from(k) * step);
    tilts
        .flat_map(|tilt| tilted(&frame, tilt).collect::<Vec<_>>())
        .collect()
}

/// Pseudorandom directions from a linear congruential generator.
pub fn scattered(count: usize, seed: u64) -> Vec<DVec3> {
    let mut state = seed.wrapping_mul(2) | 1;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut points = Vec::with_capacity(count);
    while points.len() < count {
        let p = DVec3::new(draw(), draw(), draw()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&p.length_squared()) {
            points.push(p.normalize());
        }
    }
    points
}
