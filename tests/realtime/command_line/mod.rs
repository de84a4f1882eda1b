//! Commands with devices, those of the book, and what commands print.

mod book;
mod captures;
#[path = "../../offline/place.rs"]
mod place;
mod schemas;

use std::path::{Path, PathBuf};
use std::process::Command;

use place::{Place, json, recording};
