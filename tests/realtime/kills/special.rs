//! The guardian itself: killed, signalled with its program, at work while another command comes,
//! and on a loaded machine.

use std::process::{Child, Command, Stdio};
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
    send(guardian_of(moving.id())?, "KILL");
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
        // The simulated drive may be silent, and a machine that stops for longer than half of what
        // the guardian waits is no loaded one.
        let stalled = bench.longest_stall() > STALL;
        if printed.contains("guardian") && !stalled {
            return Err(printed.into_owned());
        }
    }
    Ok(())
}

/// systemd's watchdog sends SIGABRT, and a stop SIGTERM, to every process of a service whose
/// `KillMode` is that of a control group. The guardian outlives both, and ends once the axis is at
/// rest.
pub fn signalled_together(bench: &Bench) -> Result<(), String> {
    for signal in ["ABRT", "TERM"] {
        bench.run("tilt goto 0 --speed 60")?;
        bench.forget();
        let mut moving = start(bench, "tilt goto -40 --speed 5")?;
        let guardian = guardian_of(moving.id())?;
        let ids = [moving.id(), guardian].map(|id| id.to_string());
        let sent = Command::new("kill")
            .arg(format!("-{signal}"))
            .args(ids)
            .status();
        let signalled = io::clock::now();
        sent.map_err(|error| error.to_string())?;
        let aftermath = bench.aftermath(signalled)?;
        moving.wait().map_err(|error| error.to_string())?;
        if aftermath.moves || aftermath.powered {
            return Err(format!("{signal} to both: {aftermath:?}"));
        }
        wait("the guardian's end", || {
            (!is_guardian(guardian)).then_some(())
        })?;
    }
    Ok(())
}

/// The service leaves the guardian alone: see [`signalled_together`] and systemd.kill(5).
pub fn service_spares_the_guardian() -> Result<(), String> {
    let unit = include_str!("../../../packaging/velomotion.service");
    match unit.lines().any(|line| line == "KillMode=process") {
        true => Ok(()),
        false => Err("packaging/velomotion.service lacks KillMode=process".to_owned()),
    }
}

/// The child of a process that is its guardian; an inhibitor of sleep may be another.
fn guardian_of(parent: u32) -> Result<u32, String> {
    wait("the guardian", || {
        let tasks = std::fs::read_dir(format!("/proc/{parent}/task")).ok()?;
        let lists = tasks.flatten().map(|task| task.path().join("children"));
        let texts = lists.filter_map(|list| std::fs::read_to_string(list).ok());
        let ids: Vec<u32> = texts
            .flat_map(|text| {
                let words = text.split_whitespace().map(str::parse);
                words.flatten().collect::<Vec<u32>>()
            })
            .collect();
        ids.into_iter().find(|id| is_guardian(*id))
    })
}

/// Whether a process runs as a guardian. One that has ended has no command line.
fn is_guardian(id: u32) -> bool {
    let line = std::fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
    let argument = engine::devices::guardian::ARGUMENT.as_bytes();
    line.split(|byte| *byte == 0).any(|word| word == argument)
}
