//! Studies of choices that trade accuracy for time.
//!
//! A [`Study`] measures every choice and returns [`StudyFindings`]: a table, the pairs of columns
//! that are traded, and the choices on the Pareto front ([`front`]). [`text`], [`svg`], [`Book`],
//! [`html`] and [`json`] show the findings. [`KFunction`] and [`ScanSpeed`] are studies; others are
//! in `velomotion` and in `studies`. The clock is an argument ([`StudyClock`]).

pub mod front;
pub mod html;
pub mod json;
mod k_function;
mod markdown;
mod noise;
mod panel;
pub mod pattern;
mod scan_speed;
mod study;
pub mod svg;
pub mod text;
mod timing;

pub use crate::draw::Scale;
pub use k_function::KFunction;
pub use markdown::Book;
pub use noise::SeededNoise;
pub use scan_speed::ScanSpeed;
pub use study::{
    Bench, Effort, Machine, Measurement, Row, Study, StudyColumn, StudyError, StudyFindings,
    StudyReport, Trade, UnknownStudy, select,
};
pub use timing::{StudyClock, TimingPlan, TimingSpread, Work, in_rounds};
