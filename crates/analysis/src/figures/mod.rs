//! Figures, tables and a page on scan patterns side by side, after Figures 2-7 and 11 of the 2018
//! paper.
//!
//! All functions turn data into text: [`points()`] and [`density()`] on the sphere from three
//! sides, [`planes()`] around the scanner, [`histogram()`] and [`curves()`] as SVG; [`mod@csv`] of
//! every curve; [`page()`] with all of it. All patterns of a figure share one colour scale. Darker
//! means more, so that it works in print without colour.

mod colour;
mod conclusion;
pub mod csv;
mod curves;
mod density;
mod frame;
mod histogram;
mod page;
mod planes;
mod points;
mod sides;
mod squares;
#[cfg(test)]
mod tests;

pub use curves::curves;
pub use density::density;
pub use histogram::{class_width, histogram};
pub use page::{FILES, page};
pub use planes::{CELL_M, Planes, planes};
pub use points::{SpherePoints, points};

use crate::density::{BinCounts, Icosahedron, Statistics};
use crate::k::KCurve;

/// Radius of the paper's hollow sphere, metres; K functions in square metres refer to it.
pub const SPHERE_M: f64 = 10.0;

/// Results of one scan.
#[derive(Clone, Debug)]
pub struct AnalyzedScan {
    /// Its name.
    pub name: String,
    /// Number of points with a direction.
    pub points: u64,
    /// Duration in seconds, if known.
    pub scan_s: Option<f64>,
    /// Radius of the largest hole anywhere, degrees.
    pub hole_deg: f64,
    /// Results within the field of view; `None` if it is unknown.
    pub in_view: Option<InView>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Points per bin of [`AnalyzedScans::bins`].
    pub counts: BinCounts,
    /// K on a sphere of [`SPHERE_M`].
    pub k: KCurve,
    /// Method by which the pairs were counted.
    pub method: &'static str,
    /// Intersections of its rays with planes.
    pub planes: Planes,
    /// Its points on the sphere.
    pub sphere: SpherePoints,
}

/// Results for the directions that a scan could see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InView {
    /// Statistics of the bins with their centre in view.
    pub statistics: Statistics,
    /// Radius of the largest hole with its centre in view, degrees; `None` if nothing is in view.
    pub hole_deg: Option<f64>,
}

/// Scans to compare.
#[derive(Clone, Debug)]
pub struct AnalyzedScans {
    /// Program and version.
    pub program: String,
    /// The command line.
    pub command: String,
    /// The bins.
    pub bins: Icosahedron,
    /// The scans in the order of the command line.
    pub scans: Vec<AnalyzedScan>,
}
