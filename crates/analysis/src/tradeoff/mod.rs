//! Studies of choices that trade accuracy for time.
//!
//! A [`Study`] measures every choice. [`StudyFindings`] are a table, the pairs of columns that are
//! traded, and the choices on the Pareto front ([`front`]). [`svg`], [`Book`], [`html`] and
//! [`TradeoffReport`] show them. The studies are in `velomotion` and in `studies`. The clock is an
//! argument.

mod findings;
pub mod front;
pub mod html;
mod json;
mod machine;
mod markdown;
mod plot;
mod report;
mod study;
pub mod svg;
mod timing;

pub use crate::noise::SeededNoise;
pub use findings::StudyFindings;
pub use json::TradeoffReport;
pub use machine::Machine;
pub use markdown::Book;
pub use report::StudyReport;
pub use study::{
    Bench, Effort, Measurement, Row, Study, StudyError, StudyRows, TimedChoice, Trade,
    UnknownStudy, select,
};
pub use timing::{TimingPlan, TimingSpread, Work, in_rounds};
