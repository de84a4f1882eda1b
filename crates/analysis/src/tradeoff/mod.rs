//! Studies of choices that trade accuracy for time.
//!
//! A [`Study`] measures every choice. [`StudyFindings`] are a table, the pairs of columns that are
//! traded, and the choices on the Pareto front ([`front`]). [`text`], [`svg`], [`Book`], [`html`]
//! and [`TradeoffReport`] show them. [`K_FUNCTION`] and [`SCAN_SPEED`] are studies; others are in
//! `velomotion` and in `studies`. The clock is an argument.

pub mod front;
pub mod html;
mod json;
mod k_function;
mod markdown;
mod panel;
pub mod pattern;
mod scan_speed;
mod study;
pub mod svg;
pub mod text;
mod timing;

pub use crate::noise::SeededNoise;
pub use json::TradeoffReport;
pub use k_function::K_FUNCTION;
pub use markdown::Book;
pub use scan_speed::SCAN_SPEED;
pub use study::{
    Bench, Effort, Machine, Measured, Measurement, Row, Study, StudyError, StudyFindings,
    StudyReport, TimedChoice, Trade, UnknownStudy, select,
};
pub use timing::{TimingPlan, TimingSpread, Work, in_rounds};
