//! Tests of the whole client against a scripted drive, in virtual time.

mod fake;
mod faults;
mod firmware;
mod link;
mod listener;
mod procedures;
mod rig;
mod script;
