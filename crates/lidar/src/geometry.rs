//! Direction and origin of each laser as the sines, cosines and offsets of its points, computed
//! once per sensor.
//!
//! [`LaserRay`] serves the plain path, which follows the formula of [`crate::LaserCorrection`].
//! [`ChannelTable`] serves the fast path: one column per term over the 32 channels of a block.

use core::array;

use protocol::vlp16::{CHANNELS, LidarModel};
use units::Span;

use crate::corrections::{Corrections, LaserCorrection};
use crate::firing::azimuth_variance_rad2;

/// Precomputed terms of one laser.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaserRay {
    pub sin_elevation: f64,
    pub cos_elevation: f64,
    pub azimuth_offset_deg: f64,
    pub range_offset_m: f64,
    pub radial_offset_m: f64,
    pub tangential_offset_m: f64,
    pub vertical_offset_m: f64,
    pub delay_s: f64,
    pub delay_ns: i64,
    pub ring: u8,
}

/// A value per channel of a block. Blocks have 32 channels in every model: two firings of 16
/// lasers, or one of 32.
pub(crate) type PerChannel<T> = [T; CHANNELS];

/// Terms of the lasers by channel. A distance of c counts is `out_per_count` (c + `out_counts`)
/// along the horizon and `up_per_count` c + `up_m` upwards.
///
/// Columns are aligned to cache lines, so that no register spans two.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct ChannelTable {
    pub out_per_count: PerChannel<f64>,
    pub out_counts: PerChannel<f64>,
    pub up_per_count: PerChannel<f64>,
    pub up_m: PerChannel<f64>,
    pub azimuth_offset_deg: PerChannel<f64>,
    /// Time after the block's start, as a fraction of the block's period.
    pub part: PerChannel<f64>,
    pub azimuth_variance_rad2: PerChannel<f64>,
    pub delay_ns: PerChannel<i64>,
    pub delay_f64_ns: PerChannel<f64>,
    /// Tangential offset over `out_per_count`, if any laser has one.
    pub tangential_counts: Option<PerChannel<f64>>,
    /// Longest delay.
    pub length: Span,
    pub laser: PerChannel<u8>,
    pub ring: PerChannel<u8>,
}

/// The lasers of a model in firing order.
#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    pub model: &'static LidarModel,
    pub rays: Vec<LaserRay>,
    pub channels: ChannelTable,
}

impl Geometry {
    /// `corrections` must have as many lasers as the model: see [`fits`].
    pub(crate) fn new(
        model: &'static LidarModel,
        vertical_offsets: bool,
        corrections: Option<&Corrections>,
    ) -> Self {
        let corrected = |laser: usize| corrections.and_then(|c| c.lasers.get(laser)).copied();
        let rays: Vec<LaserRay> = model
            .lasers
            .iter()
            .enumerate()
            .map(|(i, laser)| {
                let correction = corrected(i).unwrap_or_else(|| LaserCorrection::from(laser));
                let (sin_elevation, cos_elevation) =
                    correction.elevation_deg.to_radians().sin_cos();
                LaserRay {
                    sin_elevation,
                    cos_elevation,
                    azimuth_offset_deg: correction.azimuth_offset_deg,
                    range_offset_m: correction.range_offset_m,
                    radial_offset_m: correction.radial_offset_m,
                    tangential_offset_m: correction.tangential_offset_m,
                    vertical_offset_m: if vertical_offsets {
                        correction.vertical_offset_m
                    } else {
                        0.0
                    },
                    delay_s: f64::from(laser.delay_ns) * 1e-9,
                    delay_ns: i64::from(laser.delay_ns),
                    ring: laser.ring,
                }
            })
            .collect();
        let channels = ChannelTable::new(model, &rays);
        Self {
            model,
            rays,
            channels,
        }
    }
}

/// Whether corrections have as many lasers as the model.
pub(crate) fn fits(corrections: &Corrections, model: &LidarModel) -> bool {
    corrections.lasers.len() == model.lasers.len()
}

impl ChannelTable {
    fn new(model: &LidarModel, rays: &[LaserRay]) -> Self {
        let lasers = rays.len().max(1);
        let laser = |channel: usize| channel % lasers;
        let of = |value: &dyn Fn(&LaserRay) -> f64| -> PerChannel<f64> {
            array::from_fn(|channel| rays.get(laser(channel)).map_or(0.0, value))
        };
        let unit_m = model.distance_unit_m;
        // Never 0: no angle in degrees has a cosine of exactly 0.
        let out_per_count = |ray: &LaserRay| unit_m * ray.cos_elevation;
        let tangential = of(&|ray| ray.tangential_offset_m / out_per_count(ray));
        let delay_ns: PerChannel<i64> = array::from_fn(|channel| {
            let firing = (channel / lasers) as i64 * i64::from(model.firing_period_ns);
            firing + rays.get(laser(channel)).map_or(0, |ray| ray.delay_ns)
        });
        let period_ns = f64::from(model.block_period_ns());
        Self {
            out_per_count: of(&out_per_count),
            out_counts: of(&|ray| {
                ray.range_offset_m / unit_m + ray.radial_offset_m / out_per_count(ray)
            }),
            up_per_count: of(&|ray| unit_m * ray.sin_elevation),
            up_m: of(&|ray| ray.range_offset_m * ray.sin_elevation + ray.vertical_offset_m),
            tangential_counts: tangential
                .iter()
                .any(|&tangential| tangential != 0.0)
                .then_some(tangential),
            azimuth_offset_deg: of(&|ray| ray.azimuth_offset_deg),
            part: delay_ns.map(|ns| ns as f64 / period_ns),
            azimuth_variance_rad2: delay_ns.map(|ns| azimuth_variance_rad2(ns as f64 / period_ns)),
            delay_ns,
            delay_f64_ns: delay_ns.map(|ns| ns as f64),
            length: Span::from_nanos(delay_ns.into_iter().max().unwrap_or(0)),
            laser: array::from_fn(|channel| laser(channel) as u8),
            ring: array::from_fn(|channel| rays.get(laser(channel)).map_or(0, |ray| ray.ring)),
        }
    }
}
