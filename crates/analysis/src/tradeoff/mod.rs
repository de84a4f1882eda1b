//! Studies of choices that trade accuracy for time.
//!
//! A [`Study`] measures every choice and returns [`Findings`]: a table, the pairs of columns that
//! are traded, and the choices on the Pareto front ([`front`]). [`text`], [`svg`], [`Book`],
//! [`html`] and [`json`] show the findings. [`KFunction`] and [`ScanSpeed`] are studies; others
//! are in `velomotion` and in `studies`. The clock is an argument ([`Clock`]).

pub mod front;
pub mod html;
pub mod json;
mod k_function;
mod markdown;
mod noise;
pub mod number;
pub mod pattern;
mod scan_speed;
mod study;
pub mod svg;
pub mod text;
mod timing;

pub use k_function::KFunction;
pub use markdown::Book;
pub use noise::SeededNoise;
pub use scan_speed::ScanSpeed;
pub use study::{
    Bench, Column, Effort, Findings, Machine, Report, Row, Scale, Study, StudyError, Trade,
    UnknownStudy, Value, select,
};
pub use timing::{Clock, Plan, Spread, Work, in_rounds};
