//! The guardian itself: killed, at work while another command comes, and on a loaded machine.

use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

use units::Span;

use crate::bench::{Bench, wait};
use crate::cases::send;

/// Half of the silence that the guardian waits for.
const STALL: Span = Span::from_millis(250);
/// Threads that keep the processors busy.
const LOAD: usize = 8;

fn start(bench: &Bench, line: &str) -> Result<Child, String> {
    let mut command = bench.command(line);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().map_err(|error| error.to_string())?;
    wait("the motion", || bench.moves_faster(1.0).then_some(()))?;
    Ok(child)
}

/// The axis is stopped if its guardian is gone, and the next command has a new one.
pub fn guardian_killed(bench: &Bench) -> Result<(), String> {
    bench.run("tilt goto 0 --speed 60")?;
    let moving = start(bench, "tilt goto -40 --speed 5")?;
    send(child_of(moving.id())?, "KILL");
    let output = moving
        .wait_with_output()
        .map_err(|error| error.to_string())?;
    let printed = String::from_utf8_lossy(&output.stderr);
    if output.status.code() != Some(5) || !printed.contains("guardian") {
        return Err(format!("{}: {printed}", output.status));
    }
    wait("an axis at rest", || bench.is_safe(false).then_some(()))?;
    bench.run("tilt goto -1 --speed 60")
}

/// A command after a kill waits for the port until the guardian has stopped the axis.
pub fn next_command_waits(bench: &Bench) -> Result<(), String> {
    bench.run("tilt goto 0 --speed 60")?;
    let mut moving = start(bench, "tilt goto -40 --speed 40")?;
    send(moving.id(), "KILL");
    let next = bench.run("tilt goto 0 --speed 60");
    let _ = moving.wait();
    next
}

/// A busy machine delays the drive loop, which is no reason for an alarm.
pub fn no_false_alarm(bench: &Bench) -> Result<(), String> {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..LOAD {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let result = under_load(bench);
        stop.store(true, Ordering::Relaxed);
        result
    })
}

fn under_load(bench: &Bench) -> Result<(), String> {
    for to in [-40, 0, -40, 0] {
        bench.forget();
        let line = format!("tilt goto {to} --speed 10");
        let output = bench.command(&line).output().map_err(|e| e.to_string())?;
        let printed = String::from_utf8_lossy(&output.stderr);
        // The software drive may be silent, and a machine that stops for longer than half of what
        // the guardian waits is no loaded one.
        let stalled = bench.longest_stall() > STALL;
        if printed.contains("guardian") && !stalled {
            return Err(printed.into_owned());
        }
    }
    Ok(())
}

/// The only child of a process.
fn child_of(parent: u32) -> Result<u32, String> {
    wait("the guardian", || {
        let tasks = std::fs::read_dir(format!("/proc/{parent}/task")).ok()?;
        let lists = tasks.flatten().map(|task| task.path().join("children"));
        lists
            .filter_map(|list| std::fs::read_to_string(list).ok())
            .find_map(|list| list.split_whitespace().next()?.parse().ok())
    })
}
