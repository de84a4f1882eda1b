//! The procedure of each command.
//!
//! Each is a sequential `async fn` over [`crate::ops::Ops`], independent of the link and of who
//! runs it, and may be dropped between any two steps. If a procedure fails while the axis may move,
//! it stops the axis before it reports the failure.

mod configure;
mod connect;
mod guard;
mod home;
mod motion;
mod network;
mod object;
mod power;
mod ramp;
mod report;
mod stop;
mod switches;

pub(crate) use connect::connect;
pub(crate) use home::home;
pub(crate) use motion::{goto, hold, sweep};
pub(crate) use object::{check_writable, read, write};
pub(crate) use power::clear_faults;
pub(crate) use report::status;
pub(crate) use stop::{brake, stop};
