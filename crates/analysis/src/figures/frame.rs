//! The parts of all figures of scans: document, headings, colours and dashes of curves.

use crate::draw::labels::width;
use crate::draw::plot::{TextAnchor, small, text};
use crate::draw::{STYLE, escaped};

/// Width of a figure, pixels.
pub(super) const WIDTH: f64 = 720.0;
/// Left and right margin.
pub(super) const MARGIN: f64 = 14.0;
/// Height of the figure's title.
pub(super) const TITLE: f64 = 32.0;

/// Additions to the style of all figures. The background of spheres and planes stays white in dark
/// colour schemes, since dark means many points.
const MORE_STYLE: &str = "\
.tv-paper{fill:#ffffff;stroke:#8b949e;stroke-width:1}.tv-empty{fill:#ffffff;stroke:#9aa1a9;stroke-width:4}\
.tv-curve{stroke-width:1.9;stroke-linejoin:round;fill:none}.tv-zero{stroke:#57606a;stroke-width:1.2;fill:none}\
.tv-fill{stroke:none;fill-opacity:.75}.tv-mean{stroke:#1f2328;stroke-width:2;fill:none}.tv-sd{stroke:#1f2328;stroke-width:1.5;stroke-dasharray:5 4;fill:none}\
@media (prefers-color-scheme:dark){.tv-zero{stroke:#a9b1bb}.tv-mean,.tv-sd{stroke:#e6e8eb}}";

/// A figure as a document, with a description for screen readers.
pub(super) fn document(title: &str, about: &str, height: f64, body: &str) -> String {
    let (title, about) = (escaped(title), escaped(about));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tv\" viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" height=\"{height:.0}\" \
         role=\"img\" aria-label=\"{title}. {about}\">\n<title>{title}</title>\n<desc>{about}</desc>\n<style>{STYLE}{MORE_STYLE}{}</style>\n\
         <rect class=\"tv-page\" width=\"{WIDTH}\" height=\"{height:.0}\" rx=\"6\"/>\n\
         <text class=\"tv-ink tv-title\" x=\"{MARGIN}\" y=\"21\">{title}</text>\n{body}</svg>\n",
        colours()
    )
}

/// Longest name in a figure, characters; the tables have the rest.
const NAME: usize = 48;

/// The end of a long name, which may be a path.
pub(super) fn short_name(name: &str) -> String {
    let long = name.chars().count().saturating_sub(NAME - 1);
    match long {
        0 | 1 => name.to_owned(),
        _ => format!("\u{2026}{}", name.chars().skip(long).collect::<String>()),
    }
}

/// The line above the drawings of a scan: its name and details.
pub(super) fn heading(name: &str, more: &str, y: f64) -> String {
    let name = short_name(name);
    let beside = MARGIN + width(&name) * 1.12 + 16.0;
    text(MARGIN, y, TextAnchor::Start, "tv-ink", &name) + &small(beside, y, TextAnchor::Start, more)
}

/// Colours of curves in light and dark colour schemes; the first ten differ.
const COLOURS: [[&str; 2]; 10] = [
    ["#0b62b8", "#6cb4ff"],
    ["#c2410c", "#ff9a62"],
    ["#0f7b5a", "#4fd1a1"],
    ["#9b3e8f", "#e79bdc"],
    ["#8a6a00", "#e3c04d"],
    ["#475569", "#b6c2d1"],
    ["#b3123f", "#ff8097"],
    ["#0e7490", "#5fd6ee"],
    ["#5b7a0a", "#b5d84a"],
    ["#5b3fd0", "#b3a3ff"],
];

/// Length of a dash in pixels. Coinciding curves show in turns, each in the gaps of the others.
const DASH: f64 = 9.0;

/// CSS of the colours of curves.
pub(super) fn colours() -> String {
    let class =
        |number: usize, colour: &str| format!(".tv-c{number}{{stroke:{colour};fill:{colour}}}");
    let all = |which: usize| -> String {
        let colours = COLOURS.iter().enumerate();
        colours
            .map(|(number, pair)| class(number, pair.get(which).copied().unwrap_or("#000")))
            .collect()
    };
    format!(
        "{}@media (prefers-color-scheme:dark){{{}}}.tv-c.tv-none{{fill:none}}",
        all(0),
        all(1)
    )
}

/// CSS class of a scan's colour.
pub(super) fn colour(number: usize) -> String {
    format!("tv-c tv-c{}", number % COLOURS.len())
}

/// Class and dashes of a scan's curve. The first curve is solid, and later ones have shorter
/// dashes.
pub(super) fn stroke(number: usize) -> String {
    let class = colour(number);
    let dash = match number {
        0 => "none".to_owned(),
        // Gaps are as long as dashes, so that the curve below shows. Lengths differ, so that no two
        // curves stay aligned.
        _ => {
            let on = DASH * (1.0 - 0.62 * (number % COLOURS.len()) as f64 / COLOURS.len() as f64);
            let long = number / COLOURS.len();
            format!("{:.1} {:.1}{}", on, on * 1.1, " 2 4".repeat(long.min(3)))
        }
    };
    format!("class=\"{class} tv-curve tv-none\" stroke-dasharray=\"{dash}\"")
}

/// The names of curves from `y` down in lines that fit, and the end of the last line.
pub(super) fn legend(names: &[&str], mut y: f64) -> (String, f64) {
    let mut svg = String::new();
    let mut x = MARGIN;
    for (number, name) in names.iter().enumerate() {
        let name = short_name(name);
        let wide = 44.0 + width(&name) + 16.0;
        if x > MARGIN && x + wide > WIDTH {
            x = MARGIN;
            y += 18.0;
        }
        svg += &format!("<path {} d=\"M{x:.1} {y:.1}h36\"/>\n", stroke(number));
        svg += &small(x + 42.0, y + 4.0, TextAnchor::Start, &name);
        x += wide;
    }
    (svg, y + 14.0)
}

/// The quantity of a colour scale.
pub(super) fn scale_name(y: f64, name: &str) -> String {
    text(MARGIN, y + 10.0, TextAnchor::Start, "tv-ink tv-small", name)
}
