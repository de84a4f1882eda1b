//! Tests of the whole client with the simulated EPOS2 of firmware-sim, in virtual time.

mod bursts;
mod can;
mod damaged_logs;
mod faults;
mod firmware;
mod hold;
mod homing;
mod link;
mod links;
mod listener;
mod long_object;
mod objects;
mod procedures;
mod rig;
mod rs232;
mod script;
mod test_drive;
mod wire;
