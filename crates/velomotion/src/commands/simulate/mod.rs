//! `velomotion simulate`: a log of a simulated scene, and its ground truth.

mod words;

use std::num::NonZeroUsize;

use engine::document::Document;
use engine::failure::Failure;
use engine::output::{self, Target};
use engine::simulate::{
    Sampler, SimulationFiles, SimulationOutput, SimulationReport, SimulationRequest,
    choose_effects, find, make, nanoseconds, read, unmet,
};
use engine::words::counted;
use sim::effects::Stopwatch;
use sim::scene_file::EffectLine;

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::signals;
use crate::terminal::{Progress, to_stderr};

/// Runs the command.
///
/// # Errors
/// [`Failure`] for an invalid scene or an unwritable file.
pub fn run(arguments: &cli::Simulate, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    let (name, text) = find(&arguments.scene)?;
    let clock: Stopwatch = arguments.explain.then_some(nanoseconds as fn() -> u64);
    let mut scene = read(&name, &text, arguments.seed, clock)?;
    let is_out = |effect: &str| {
        let mut out = arguments.without.iter();
        out.any(|name| name == effect || name == cli::ALL)
    };
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let threads = arguments.threads.unwrap_or_else(cores);
    let default = || SimulationOutput::default_path(&scene, &name);
    let path = arguments.output.clone().unwrap_or_else(default);
    for cloud in [Some(path.as_path()), arguments.truth.as_deref()] {
        output::one_for_stdout(cloud, common.json)?;
    }
    let files = SimulationFiles {
        scene: &arguments.scene,
        output: &path,
        option: "-o",
        truth: arguments.truth.as_deref(),
        force: arguments.force,
    };
    let (output, truth) = files.open(&scene)?;
    let stdout_taken = output.is_stdout() || truth.as_ref().is_some_and(Target::is_stdout);
    let mut progress = Progress::new(common);
    progress.begin_comparison();
    let choice = choose_effects(
        &mut scene,
        &name,
        is_out,
        arguments.tolerance,
        threads,
        clock,
        Some(&interrupt),
    )?;
    let sampler = Sampler::new(&scene, threads).interrupted_by(Some(&interrupt));
    let sizes = match arguments.explain {
        true => Some(sampler.sizes(&sampler.candidates())?),
        false => None,
    };
    // What a tolerance leaves out is reported with the choice.
    let is_chosen_out = |effect: &str| {
        (choice.iter()).any(|choice| choice.off.iter().any(|out| out.effect == effect))
    };
    let mut warnings = unmet(&sampler, sizes.as_deref(), &is_chosen_out)?;
    let without_use =
        (arguments.without.iter()).filter(|name| *name != cli::ALL && !scene.is_requested(name));
    warnings
        .extend(without_use.map(|name| format!("--without {name}: the scene does not have it")));
    if arguments.tolerance.is_some() && choice.is_none() {
        warnings.push("--tolerance: no effect is left to choose from".to_owned());
    }
    progress.begin_run(scene.simulation.motion.end_s);
    let (has_objects, range) = (scene.has_objects(), scene.simulation.sensor.range());
    let request = SimulationRequest {
        name,
        output,
        truth,
        threads,
        explain: arguments.explain,
        interrupt: &interrupt,
        progressed: &mut |seconds| progress.ran(seconds),
    };
    let made = make(scene, request);
    progress.end_run();
    let (mut report, failure) = made?;
    report.warnings.extend(warnings);
    if report.returned == 0 && report.shots > 0 {
        let nothing = match has_objects {
            true => format!(
                "no shot returned: no object is within {} to {} m of the lidar where it points",
                range.min_m, range.max_m
            ),
            false => "no shot returned: the file has no objects; name a scene (scene = \"hall\") or add [[objects]]".to_owned(),
        };
        report.warnings.push(nothing);
    }
    if common.quiet && !common.json {
        for warning in &report.warnings {
            to_stderr(&format!("warning: {warning}"));
        }
    }
    report.sizes = sizes;
    report.choice = choice;
    Ok(CommandOutput {
        json: report.to_json(),
        text: report_text(&report),
        failure,
        stdout_taken,
        is_result: false,
    })
}

/// Text of the report.
fn report_text(report: &SimulationReport) -> String {
    let duration = format!("{:.3} s", report.duration_s);
    let time = match &report.log {
        Some(_) => (
            "packets",
            format!("{} over {duration}", report.packets.data),
        ),
        None => ("duration", duration),
    };
    let mut rows = vec![
        ("scene", format!("{}, seed {}", report.scene, report.seed)),
        ("effects", effects_text(report)),
        time,
        (
            "returned",
            format!(
                "{} of {} shots, {:.1} %",
                report.returned,
                report.shots,
                100.0 * report.share_returned
            ),
        ),
    ];
    if report.polls > 0 && report.log.is_some() {
        rows.push(("drive", format!("asked {} times", report.polls)));
    }
    rows.push((
        "took",
        format!(
            "{:.2} s on {}, {:.1} times real time",
            report.took_s,
            counted(report.threads as u64, "thread"),
            report.times_real_time
        ),
    ));
    rows.extend((report.choice.iter()).map(|choice| ("tolerance", choice.text(report.took_s))));
    rows.extend(report.log.iter().map(|log| ("log", log.clone())));
    rows.extend(report.cloud.iter().map(|cloud| ("cloud", cloud.clone())));
    rows.extend(report.truth.iter().map(|truth| ("truth", truth.clone())));
    let warnings = report.warnings.iter();
    rows.extend(warnings.map(|warning| ("warning", warning.clone())));
    let table = crate::tables::table(rows);
    match (&report.sizes, &report.explanation) {
        (Some(sizes), Some(explanation)) => {
            let (size, why) = (words::table(sizes), words::reasons(sizes, explanation));
            format!("{table}\n{size}\n{why}")
        }
        _ => table,
    }
}

/// The effects that are on, one per line, each with the fact that calls for it.
fn effects_text(report: &SimulationReport) -> String {
    let reason = |effect: &EffectLine| {
        let mut demands = (report.demands.iter()).filter(|demand| demand.effect == effect.name);
        let (demand, others) = (demands.next(), demands.count());
        let others = match others {
            0 => String::new(),
            _ => format!(", and {others} more"),
        };
        let line = (effect.line).map_or_else(String::new, |line| format!(" (line {line})"));
        match demand {
            Some(demand) => format!("{}: {}{line}{others}", effect.name, demand.reason),
            None => format!("{}: requested{line}", effect.name),
        }
    };
    match report.effects.is_empty() {
        true => "none".to_owned(),
        false => (report.effects.iter().map(reason))
            .collect::<Vec<_>>()
            .join("\n"),
    }
}
