//! The command line: arguments, one file per command, and what appears on the terminal.

pub mod cli;
pub mod commands;
pub mod logging;
pub mod signals;
pub mod tables;
pub mod terminal;
