//! What accuracy costs in time: studies of choices, measured and compared.
//!
//! A [`Study`] measures every way to do one thing and gives [`Findings`]: a table, what is traded for what, and which ways are
//! on the Pareto front ([`front`]). The rest says findings: [`text`] at 80 columns, [`svg`] figures, [`markdown`] and [`html`]
//! pages, [`json`]. [`placing`] and [`pattern`] are what studies here and elsewhere measure; [`KFunction`] is one.
//! Left out: the clock, which is an argument ([`Clock`]), files, and studies of what this crate may not see.

pub mod front;
pub mod html;
pub mod json;
mod k_function;
pub mod markdown;
pub mod number;
pub mod pattern;
pub mod placing;
mod study;
pub mod svg;
pub mod text;
mod timing;

pub use k_function::KFunction;
pub use study::{
    Bench, Column, Effort, Findings, Machine, Report, Row, Scale, Study, StudyError, Trade, Value,
};
pub use timing::{Clock, Plan, Spread, Work, in_rounds};
