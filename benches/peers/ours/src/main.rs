//! velomotion's side of the benchmark: `peers-ours RECORDING FOLDER`.
//!
//! It first puts what the others need into FOLDER (`packets.bin`, `points.bin`, `angles.csv`) and says what the recording is, in one
//! line of JSON. Then it does what it is told, a name a line, and answers with seconds, passes and points. Left out: who runs
//! when, and what the figures mean; `run` knows that.

mod limits;
mod prepare;
mod work;

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use work::Work;

/// A measurement lasts at least so long; short recordings are gone through several times.
const LEAST_S: f64 = 0.1;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [recording, folder] = &arguments[..] else {
        eprintln!("usage: peers-ours RECORDING FOLDER");
        std::process::exit(2);
    };
    let packets = prepare::packets(Path::new(recording));
    println!("{}", prepare::prepare(&packets, Path::new(folder)));
    let mut work = Work::new(recording, packets);
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("a line of stdin");
        // Once for nothing: memory and caches.
        work.pass(&line);
        let (mut passes, mut points) = (0, 0);
        let start = Instant::now();
        while passes == 0 || start.elapsed().as_secs_f64() < LEAST_S {
            points += work.pass(&line);
            passes += 1;
        }
        let seconds = start.elapsed().as_secs_f64();
        println!(r#"{{"seconds":{seconds},"passes":{passes},"points":{points}}}"#);
        std::io::stdout().flush().expect("stdout is open");
        work.rest(&line);
    }
}
