//! The figure of a study: one plot per trade with its Pareto front.
//!
//! Plain SVG with a style sheet for light and dark colour schemes, without scripts, fonts or
//! external resources. `plotters` 0.3 draws the plot of `plot.rs` in 30 lines instead of 170, but
//! not as well: its SVG backend writes fixed colours and no CSS classes, so a figure cannot follow
//! the colour scheme of the page. It has no tooltips (`title`), no place for zero on a logarithmic
//! axis and no labels that avoid each other, and its file is 1.6 times as large (10,771 bytes for a
//! plot of 6 rows, ours 6,696 for 8).

use super::{Measurement, StudyFindings, plot};
use crate::draw::{STYLE, escaped, labels, marks};

/// Width of a figure. Text has its reading size at this width.
pub(super) const WIDTH: f64 = 480.0;
const TITLE: f64 = 30.0;
/// Height of a line of the title, and characters that fit into one.
const TITLE_LINE: f64 = 18.0;
const MOST_IN_LINE: usize = 58;
const LEGEND_LINE: f64 = 18.0;
const MARGIN: f64 = 14.0;

/// The figure as a document, with the finding as its title.
#[must_use]
pub fn figure(findings: &StudyFindings) -> String {
    titled(findings, &(findings.study.finding)(findings))
}

/// The same with another title.
#[must_use]
pub fn titled(findings: &StudyFindings, title: &str) -> String {
    let groups = findings.groups();
    let lines = wrapped(title);
    let plots_top = TITLE + TITLE_LINE * (lines.len().max(1) - 1) as f64;
    let plots_end = plots_top + plot::HEIGHT * findings.study.trades.len() as f64;
    let (legend, legend_end) = legend(findings, &groups, plots_end);
    let height = legend_end + MARGIN;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tv\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         role=\"img\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"tv-page\" width=\"{WIDTH}\" height=\"{height}\" rx=\"6\"/>\n",
        title = escaped(title)
    );
    for (number, line) in lines.iter().enumerate() {
        let (y, line) = (20.0 + TITLE_LINE * number as f64, escaped(line));
        svg += &format!("<text class=\"tv-ink tv-title\" x=\"{MARGIN}\" y=\"{y}\">{line}</text>\n");
    }
    for (number, trade) in findings.study.trades.iter().enumerate() {
        let number = (findings.study.trades.len() > 1).then_some(number + 1);
        let top = plots_top + plot::HEIGHT * number.map_or(0.0, |n| (n - 1) as f64);
        svg += &plot::draw(findings, trade, number, &groups, top);
    }
    svg + &legend + "</svg>\n"
}

/// A title in lines that fit.
fn wrapped(title: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in title.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < MOST_IN_LINE => {
                *line += " ";
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A symbol of the legend.
enum LegendSymbol {
    Group(usize),
    Front,
    Bar,
}

/// The legend below the plots in lines that fit, and its end.
fn legend(findings: &StudyFindings, groups: &[&str], top: f64) -> (String, f64) {
    let timed = findings.rows.iter().flat_map(|row| &row.values);
    let runs = timed
        .filter_map(|value| match value {
            Measurement::Timed(spread) => Some(spread.runs),
            Measurement::Computed(_) => None,
        })
        .max();
    let groups = groups.iter().enumerate();
    let groups = groups.map(|(n, name)| (LegendSymbol::Group(n), (*name).to_owned()));
    let front = (LegendSymbol::Front, "Pareto front: filled".to_owned());
    let bars = runs.map(|n| {
        let text = format!("median, least and greatest of {n} runs");
        (LegendSymbol::Bar, text)
    });
    let mut svg = String::new();
    let (mut x, mut y) = (MARGIN, top + LEGEND_LINE / 2.0);
    for (symbol, text) in groups.chain([front]).chain(bars) {
        let width = 24.0 + labels::width(&text) + 14.0;
        if x > MARGIN && x + width > WIDTH {
            x = MARGIN;
            y += LEGEND_LINE;
        }
        svg += &match symbol {
            LegendSymbol::Group(n) => marks::mark(n, x + 8.0, y, true),
            LegendSymbol::Front => format!("<path class=\"tv-front\" d=\"M{x:.1} {y:.1}h18\"/>\n"),
            LegendSymbol::Bar => {
                format!("<path class=\"tv-frame\" d=\"M{x:.1} {y:.1}h18m0 -3v6m-18 -6v6\"/>\n")
            }
        };
        svg += &format!(
            "<text class=\"tv-soft tv-small\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\n",
            x + 24.0,
            y + 4.0,
            escaped(&text)
        );
        x += width;
    }
    (svg, y + LEGEND_LINE / 2.0)
}

#[cfg(test)]
#[path = "svg_tests.rs"]
mod tests;
