//! Scan patterns as figures, tables and one page, in the manner of the 2018 paper's Figures 2-7 and 11, for any list of patterns side by side.
//!
//! Data in, text out: [`density()`] on the sphere from three sides, [`planes()`] about the scanner, [`histogram()`] and [`curves()`] as SVG; [`mod@csv`] of every curve;
//! [`page()`] with all of it. All patterns of a figure have one scale of colours, on which darker is more, so that it reads in print without colour, too.
//! Left out: where the numbers come from ([`crate::density`], [`crate::k`]), and files.

mod colour;
mod conclusion;
pub mod csv;
mod curves;
mod density;
mod frame;
mod histogram;
mod page;
mod planes;
#[cfg(test)]
mod tests;

pub use curves::curves;
pub use density::density;
pub use histogram::{class_width, histogram};
pub use page::{FILES, page};
pub use planes::{CELL_M, Planes, planes};

use crate::density::{BinCounts, Icosahedron, Statistics};
use crate::k::KCurve;

/// Radius of the paper's hollow sphere, metres: what square metres of a K function are of.
pub const SPHERE_M: f64 = 10.0;

/// What is known of one scan.
#[derive(Clone, Debug)]
pub struct AnalyzedScan {
    /// What it is called.
    pub name: String,
    /// Points with a direction.
    pub points: u64,
    /// How long it takes, seconds, where that is known.
    pub scan_s: Option<f64>,
    /// Radius of the largest hole anywhere, degrees.
    pub hole_deg: f64,
    /// What is in view; `None` where nothing tells what the scan could see.
    pub in_view: Option<InView>,
    /// What may mislead.
    pub warnings: Vec<String>,
    /// Points a bin of [`AnalyzedScans::bins`].
    pub counts: BinCounts,
    /// K on a sphere of [`SPHERE_M`].
    pub k: KCurve,
    /// How its pairs were counted.
    pub method: &'static str,
    /// Where its rays meet the planes.
    pub planes: Planes,
}

/// What is known of the directions that a scan could see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InView {
    /// Points a bin, of the bins with their middle in view.
    pub statistics: Statistics,
    /// Radius of the largest hole with its middle in view, degrees; `None` where nothing is in view.
    pub hole_deg: Option<f64>,
}

/// Scans side by side.
#[derive(Clone, Debug)]
pub struct AnalyzedScans {
    /// Program and version.
    pub program: String,
    /// What was asked for, as on the command line.
    pub command: String,
    /// The bins.
    pub bins: Icosahedron,
    /// The scans, in the order asked for.
    pub scans: Vec<AnalyzedScan>,
}
