//! Effects in seven scenes: what each changes and costs, and which a tolerance leaves out.
//!
//! ```sh
//! cargo run --release -p studies --example effect_sizes -- docs/src/scenes/effects.svg
//! ```
//!
//! prints the tables of docs/src/effects.md and writes its picture.

use std::error::Error;
use std::fmt::Write as _;
use std::num::NonZeroUsize;

use engine::simulate::{EffectSize, Sampler, choose_effects, find, nanoseconds, read};
use sim::effect_models::EffectsConfig;
use sim::scene_file::SceneFile;

const SCENES: [&str; 7] = [
    "hall",
    "parking",
    "quarry",
    "glass-corridor",
    "fog",
    "traffic",
    "stairwell-0.9m",
];
const TOLERANCES: [&str; 3] = ["1mm,1%", "5mm,1%", "50mm,1%"];
/// The stairwell with a parapet nearer than a VLP-16 measures.
const PARAPET: &str = "\n[[objects]]\nname = \"parapet\"\nmaterial = \"plaster\"\n\
                       box = { from_m = [-3, 0.9, -1.7], to_m = [2.5, 1, 0] }\n";

fn main() -> Result<(), Box<dyn Error>> {
    let picture = std::env::args()
        .nth(1)
        .ok_or("expected the picture to write")?;
    let threads = std::thread::available_parallelism()?;
    let mut all = Vec::new();
    println!("| scene | effect | state | added | removed | moved | median | 99 % | worst | time |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for name in SCENES {
        let (scene, _) = chosen(name, "5mm,1%", threads)?;
        let sampler = Sampler::new(&scene, threads);
        let sizes = sampler.sizes(&sampler.candidates());
        let sizes = sizes.map_err(|failure| failure.message)?;
        for size in &sizes {
            println!("| {name} | {}", row(size));
        }
        all.push((name, sizes));
    }
    println!("\n| scene | tolerance | left out | left, % | time, % | choice, s |");
    println!("|---|---|---|---|---|---|");
    for name in SCENES {
        for tolerance in TOLERANCES {
            println!(
                "| {name} | {tolerance} | {} |",
                chosen(name, tolerance, threads)?.1
            );
        }
    }
    std::fs::write(picture, drawn(&all))?;
    Ok(())
}

/// A scene with the effects that a tolerance chooses, and what it leaves out.
fn chosen(
    name: &str,
    tolerance: &str,
    threads: NonZeroUsize,
) -> Result<(SceneFile, String), Box<dyn Error>> {
    let shipped = name.strip_suffix("-0.9m");
    let found = find(shipped.unwrap_or(name).as_ref());
    let (_, text) = found.map_err(|failure| failure.message)?;
    let text = text + if shipped.is_some() { PARAPET } else { "" };
    let scene = read(name, &text, None, Some(nanoseconds));
    let mut scene: SceneFile = scene.map_err(|failure| failure.message)?;
    let tolerance = Some(tolerance.parse()?);
    let clock = Some(nanoseconds as fn() -> u64);
    let choice = choose_effects(&mut scene, name, |_| false, tolerance, threads, clock, None);
    let choice = choice.map_err(|failure| failure.message)?;
    let choice = choice.ok_or("a scene without effects")?;
    let off: Vec<String> = (choice.off.iter())
        .map(|out| format!("`{}`", out.effect))
        .collect();
    let text = format!(
        "{} | {:.3} | {:.0} | {:.1}",
        off.join(", "),
        choice.left_percent,
        100.0 * choice.time_ratio,
        choice.took_s
    );
    Ok((scene, text))
}

fn row(size: &EffectSize) -> String {
    let state = if size.is_on { "on" } else { "off" };
    let mut row = format!("`{}` | {state} |", size.effect);
    for (value, digits) in [
        (size.gained_percent, 2),
        (size.lost_percent, 2),
        (size.moved_percent, 2),
        (size.median_mm, 2),
        (size.p99_mm, 1),
        (size.worst_mm, 0),
        (size.time_percent, 1),
    ] {
        let _ = write!(row, " {value:.digits$} |");
    }
    row
}

/// Points that an effect adds, removes or moves by over 1 mm, percent.
fn changed_percent(size: &EffectSize) -> f64 {
    size.gained_percent + size.lost_percent + size.moved_percent
}

const LEFT: f64 = 150.0;
const CELL: [f64; 2] = [98.0, 26.0];
const TOP: f64 = 64.0;
/// The share of the shortest bar, percent.
const LEAST_PERCENT: f64 = 0.01;

/// A row per effect, a column per scene, and bars of the share of changed points, by their
/// logarithm.
fn drawn(scenes: &[(&str, Vec<EffectSize>)]) -> String {
    let effects = EffectsConfig::NAMES.iter().copied();
    let is_in = |effect: &&str| {
        let mut sizes = scenes.iter().flat_map(|(_, sizes)| sizes);
        sizes.any(|size| size.effect == *effect)
    };
    let effects: Vec<&str> = effects.filter(is_in).collect();
    let width = LEFT + CELL[0] * scenes.len() as f64 + 10.0;
    let height = TOP + CELL[1] * effects.len() as f64 + 12.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<title>What effects change in seven scenes</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
         <text x=\"10\" y=\"20\" font-weight=\"bold\">Points that an effect adds, removes or moves by over 1 mm, percent</text>\n\
         <text x=\"10\" y=\"38\" fill=\"#57606a\">filled: on with a tolerance of 5mm,1%; hollow: left out. Bars are logarithmic from {LEAST_PERCENT} to 100 %.</text>\n"
    );
    for (row, effect) in effects.iter().enumerate() {
        let y = TOP + CELL[1] * row as f64;
        let _ = writeln!(svg, "<text x=\"10\" y=\"{}\">{effect}</text>", y + 17.0);
        for (column, (_, sizes)) in scenes.iter().enumerate() {
            let Some(size) = sizes.iter().find(|size| size.effect == *effect) else {
                continue;
            };
            let (x, percent) = (LEFT + CELL[0] * column as f64, changed_percent(size));
            let decades = (percent.max(LEAST_PERCENT) / LEAST_PERCENT).log10();
            let (bar, fill) = (12.0 * decades, if size.is_on { "#0b62b8" } else { "none" });
            let digits = if percent < 10.0 { 2 } else { 0 };
            let _ = writeln!(
                svg,
                "<rect x=\"{x}\" y=\"{}\" width=\"{bar:.1}\" height=\"12\" fill=\"{fill}\" stroke=\"#0b62b8\"/>\
                 <text x=\"{:.1}\" y=\"{}\" font-size=\"11\">{percent:.digits$}</text>",
                y + 7.0,
                x + bar + 4.0,
                y + 17.0
            );
        }
    }
    for (column, (name, _)) in scenes.iter().enumerate() {
        let x = LEFT + CELL[0] * column as f64;
        let _ = writeln!(svg, "<text x=\"{x}\" y=\"{}\">{name}</text>", TOP - 6.0);
    }
    svg + "</svg>\n"
}
