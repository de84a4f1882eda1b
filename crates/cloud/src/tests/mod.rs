//! What tests of several modules share, and the type hashes of messages.

pub mod cdr_reader;
mod hashes;
pub mod samples;
