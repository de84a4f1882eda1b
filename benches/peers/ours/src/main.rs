//! velomotion's side of the benchmark: `peers-ours RECORDING FOLDER`.
//!
//! It first writes the input of the other workers into FOLDER (`packets.bin`, `points.bin`,
//! `angles.csv`) and describes the recording in one line of JSON. Then it reads a name of a
//! measurement per line and answers with CPU seconds, seconds, passes and points. `run` starts it.

mod limits;
mod prepare;
mod work;

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use work::Work;

/// Minimum duration of a measurement; short recordings are decoded several times.
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
        // An untimed pass fills memory and caches.
        work.pass(&line);
        let (mut passes, mut points) = (0, 0);
        let (start, core) = (Instant::now(), core_s());
        while passes == 0 || start.elapsed().as_secs_f64() < LEAST_S {
            points += work.pass(&line);
            passes += 1;
        }
        let (seconds, wall) = (core_s() - core, start.elapsed().as_secs_f64());
        println!(r#"{{"seconds":{seconds},"wall_s":{wall},"passes":{passes},"points":{points}}}"#);
        std::io::stdout().flush().expect("stdout is open");
        work.rest(&line);
    }
}

/// CPU seconds of this process.
fn core_s() -> f64 {
    let clock = nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID;
    let time = clock.now().expect("Linux");
    time.tv_sec() as f64 + time.tv_nsec() as f64 * 1e-9
}
