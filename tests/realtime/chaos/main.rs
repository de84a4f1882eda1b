//! Captures with seeded failures, and the conditions that hold after each. Every scan is complete,
//! or partial and marked so. No scan is lost silently. The motor never keeps moving without a
//! master.
//!
//! `cargo test -p velomotion-tests --test chaos -- [--captures N] [--first SEED] [--bless]`.
//! Without arguments it runs the first twenty seeds, which cover every kind of fault; `--bless`
//! writes the table of docs/src/chaos.md.

mod check;
mod disk;
mod plan;
mod process;
mod real;
mod table;
mod virtual_time;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use daemon::scans::Scans;

use check::Wanted;
use disk::Disk;
use plan::{Either, Plan};
use process::{Process, wait};
use real::{CaptureOutcome, CaptureResult, World};
use table::Table;

/// Number of captures without arguments.
const FEW: u64 = 20;
/// Number of virtual-time captures whose clouds one daemon makes.
const BATCH: usize = 5;
/// Threads for virtual-time captures, and for real-time ones, which mostly wait.
const THREADS: (usize, usize) = (2, 3);

/// Command-line arguments.
struct Arguments {
    first: u64,
    captures: u64,
    bless: bool,
    /// Fail if the full disk of a scenario cannot be mounted.
    require_disk: bool,
}

/// Results of the run.
#[derive(Default)]
struct Results {
    table: Mutex<Table>,
    failed: Mutex<Vec<(u64, String)>>,
}

impl Results {
    fn put(&self, plan: &Plan, made: Result<CaptureResult, String>) {
        match made {
            Ok(made) => self.table.lock().unwrap().count(plan.row(), made),
            Err(why) => {
                eprintln!("seed {}: {why}\n  {plan:?}", plan.seed);
                self.failed.lock().unwrap().push((plan.seed, why));
            }
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [argument, path] = words.as_slice()
        && argument == process::ARGUMENT
    {
        std::process::exit(process::be(path));
    }
    let arguments = arguments(&words);
    let plans: Vec<Plan> = (arguments.first..arguments.first + arguments.captures)
        .map(Plan::new)
        .collect();
    let (begin, results) = (Instant::now(), Results::default());
    in_virtual_time(&plans, &results);
    let real = begin.elapsed();
    in_real_time(&plans, &results, arguments.require_disk);
    let table = results.table.into_inner().unwrap();
    println!("{table}");
    println!(
        "{} captures from seed {} in {:.0} s, {:.0} s of them in virtual time",
        plans.len(),
        arguments.first,
        begin.elapsed().as_secs_f64(),
        real.as_secs_f64(),
    );
    let failed = results.failed.into_inner().unwrap();
    for (seed, why) in &failed {
        let first = why.lines().next().unwrap_or_default();
        println!("FAILED: seed {seed}: {first}\n  again: just chaos --first {seed} --captures 1");
    }
    if arguments.bless {
        table.bless();
    }
    if !failed.is_empty() {
        std::process::exit(1);
    }
}

fn arguments(words: &[String]) -> Arguments {
    let mut arguments = Arguments {
        first: 0,
        captures: FEW,
        bless: false,
        require_disk: false,
    };
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let mut number = || words.next().and_then(|text| text.parse().ok());
        match word.as_str() {
            "--first" => arguments.first = number().unwrap_or_else(usage),
            "--captures" => arguments.captures = number().unwrap_or_else(usage),
            "--bless" => arguments.bless = true,
            "--include-ignored" => arguments.require_disk = true,
            // Other arguments of `cargo test`.
            _ => {}
        }
    }
    arguments
}

fn usage() -> u64 {
    eprintln!("--first SEED, --captures N: whole numbers");
    std::process::exit(2);
}

fn in_virtual_time(plans: &[Plan], results: &Results) {
    let ours: Vec<&Plan> = plans
        .iter()
        .filter(|plan| matches!(plan.fault, Either::Virtual(_)))
        .collect();
    let batches: Vec<&[&Plan]> = ours.chunks(BATCH).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..THREADS.0 {
            scope.spawn(|| {
                while let Some(batch) = batches.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Err(why) = one_batch(batch, results) {
                        results.put(batch[0], Err(why));
                    }
                }
            });
        }
    });
}

/// Makes captures in virtual time, then starts a daemon that finds them.
fn one_batch(batch: &[&Plan], results: &Results) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let place = folder.path().join("scans");
    let scans = Scans::open(&place).map_err(|failure| failure.to_string())?;
    let mut wanted: Vec<(&Plan, Wanted)> = Vec::new();
    for &plan in batch {
        let Either::Virtual(what) = plan.fault else {
            continue;
        };
        let made = catch_unwind(AssertUnwindSafe(|| virtual_time::make(plan, what, &scans)));
        match made.unwrap_or_else(|_| Err("panicked".to_owned())) {
            Ok(want) => wanted.push((plan, want)),
            Err(why) => results.put(plan, Err(why)),
        }
    }
    drop(scans);
    let text = real::nowhere(&place.display().to_string());
    std::fs::write(folder.path().join("velomotion.toml"), text).map_err(|e| e.to_string())?;
    let daemon = Process::start(folder.path())?;
    let all = wait("the clouds", || {
        let all = check::list(&daemon.client).ok()?;
        all.iter()
            .all(|scan| scan.state.is_final() && check::written(scan, &place))
            .then_some(all)
    })?;
    check::agree(&all, &place)?;
    for (plan, want) in wanted {
        let checked = check::named(&all, &plan.name()).and_then(|scan| {
            check::check_scan(scan, &place, want)?;
            check::check_without_sweep(scan, &place)?;
            Ok(CaptureResult {
                came: CaptureOutcome::Scan(scan.state),
                safe_after: None,
            })
        });
        results.put(plan, checked);
    }
    Ok(())
}

fn in_real_time(plans: &[Plan], results: &Results, require_disk: bool) {
    let ours: Vec<&Plan> = plans
        .iter()
        .filter(|plan| matches!(plan.fault, Either::Real(_)))
        .collect();
    if ours.is_empty() {
        return;
    }
    let small = has_small_disk(require_disk);
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..THREADS.1.min(ours.len()) {
            scope.spawn(|| {
                let mut world = None;
                while let Some(plan) = ours.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let Either::Real(what) = plan.fault else {
                        continue;
                    };
                    let made = capture_in_world(&mut world, plan, what, small);
                    if made.is_err() {
                        // A failed setup must not affect the next capture.
                        world = None;
                    }
                    results.put(plan, made);
                }
            });
        }
    });
}

fn capture_in_world(
    world: &mut Option<World>,
    plan: &Plan,
    what: plan::Real,
    small: bool,
) -> Result<CaptureResult, String> {
    let world = match world {
        Some(world) => world,
        None => world.insert(World::start(small)?),
    };
    world.capture(plan, what)
}

/// Whether captures with a full disk run: with `--include-ignored`, as they need a tmpfs.
fn has_small_disk(required: bool) -> bool {
    if !required {
        println!("test a_full_disk ... ignored, needs root to mount a tmpfs (--include-ignored)");
        return false;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    if let Err(why) = Disk::mount(folder.path()) {
        panic!("--include-ignored needs root to mount a tmpfs: {why}");
    }
    true
}
