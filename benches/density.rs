//! Time to compute the density of a scan by number of points, and its largest hole.
//!
//! `cargo bench -p velomotion-analysis --bench density` prints the table of docs/src/patterns.md:
//! the minimum of `-- --rounds N` (5). `RAYON_NUM_THREADS=1` limits it to one core. The largest
//! scan has as many points as the slow one of the 2018 paper. Computing the points is not included.

#![allow(
    clippy::expect_used,
    clippy::disallowed_methods,
    reason = "a bench: it looks at the clock, and fails if it must"
)]

use std::env;
use std::time::{Duration, Instant};

use analysis::density::{BinCounts, Icosahedron, Locator, TOLERANCE_RAD, largest_hole};
use sim::patterns::PatternRequest;

const PATTERNS: [&str; 4] = [
    "vlp16",
    "rmbl:120",
    "rmbl:50",
    "velomotion16:1.07,frames=787",
];

fn main() {
    let mut arguments = env::args().skip_while(|argument| argument != "--rounds");
    let rounds: u32 = arguments.nth(1).and_then(|n| n.parse().ok()).unwrap_or(5);
    let began = Instant::now();
    let locator = Locator::new(&Icosahedron::new(4).expect("level 4"));
    println!(
        "the grid of 5120 bins, once: {:.1} ms\n",
        ms(began.elapsed())
    );
    println!("| pattern | points | density | largest hole |");
    println!("|---|---|---|---|");
    for text in PATTERNS {
        let pattern = PatternRequest::parse(text)
            .and_then(|request| request.build())
            .expect("a pattern");
        let directions = pattern.directions();
        let count = || BinCounts::new(&locator, &directions).expect("directions");
        let all = least(rounds, || {
            std::hint::black_box(count());
        });
        let hole = least(rounds.min(2), || {
            std::hint::black_box(largest_hole(&directions, TOLERANCE_RAD).expect("directions"));
        });
        println!(
            "| {text} | {} | {:.1} ms | {:.1} ms |",
            directions.len(),
            ms(all),
            ms(hole)
        );
    }
}

fn least(rounds: u32, mut run: impl FnMut()) -> Duration {
    let times = (0..rounds.max(1)).map(|_| {
        let began = Instant::now();
        run();
        began.elapsed()
    });
    times.min().unwrap_or_default()
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
