//! Writes the first inputs of every target to `corpus/TARGET`, made by velomotion's encoders and
//! simulated devices.
//!
//! `cargo run --release --bin seeds` in this directory; existing files stay. No input is from a
//! real recording.

mod recording;
mod sdo;
mod serial_frame;
mod slcan;
mod vlp16_data;
mod vlp16_position;

use std::path::Path;
use std::{fs, io};

/// A file name and an input.
type Seed = (String, Vec<u8>);

fn main() -> io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let targets: [(&str, Vec<Seed>); 6] = [
        ("recording", recording::seeds()),
        ("sdo", sdo::seeds()),
        ("serial_frame", serial_frame::seeds()),
        ("slcan", slcan::seeds()),
        ("vlp16_data", vlp16_data::seeds()),
        ("vlp16_position", vlp16_position::seeds()),
    ];
    for (target, seeds) in targets {
        let directory = corpus.join(target);
        fs::create_dir_all(&directory)?;
        for (name, bytes) in &seeds {
            fs::write(directory.join(format!("seed-{name}")), bytes)?;
        }
        println!("{target}: {} seeds", seeds.len());
    }
    Ok(())
}
