//! The procedures: what each command does, step by step, as one would tell it.
//!
//! Each is a sequential `async fn` over [`crate::ops::Ops`]. None knows how requests travel or who runs it; each may be dropped between
//! any two steps. A procedure that fails while the axis may move brings it to rest before it reports.

mod configure;
mod connect;
mod home;
mod motion;
mod network;
mod object;
mod power;
mod report;
mod stop;

pub(crate) use connect::connect;
pub(crate) use home::home;
pub(crate) use motion::{goto, hold, sweep};
pub(crate) use object::{check_writable, read, write};
pub(crate) use power::clear_faults;
pub(crate) use report::status;
pub(crate) use stop::{brake, stop};
