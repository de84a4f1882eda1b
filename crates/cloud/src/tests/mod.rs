//! Items shared by tests of several modules, and the type hashes of messages.

pub mod cdr_reader;
mod hashes;
pub mod samples;
