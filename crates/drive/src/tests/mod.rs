//! Tests of the whole client against a scripted drive, in virtual time.

mod bursts;
mod can;
mod damaged_logs;
mod fake;
mod faults;
mod firmware;
mod hold;
mod link;
mod links;
mod listener;
mod objects;
mod procedures;
mod rig;
mod rs232;
mod script;
mod wire;
