//! A study's figure: a plot a trade, one under the other, the Pareto front in it, legible on light and on dark, on a phone and as a
//! file of its own.
//!
//! Plain SVG with a style sheet that the reader's colour scheme chooses from; no script, no font, nothing from outside. Left out:
//! any kind of plot that no study needs.

pub(crate) mod labels;
pub(crate) mod marks;
mod panel;
pub(crate) mod scale;

use std::collections::BTreeMap;

use super::{Findings, Value};

/// Width of a figure; everything is drawn at the size of text for reading at this width.
const WIDTH: f64 = 480.0;
const TITLE: f64 = 30.0;
const LEGEND_LINE: f64 = 18.0;
const MARGIN: f64 = 14.0;

pub(crate) const STYLE: &str = "\
.tv{font:12px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
.tv-page{fill:#ffffff}.tv-ink{fill:#1f2328}.tv-soft{fill:#57606a}.tv-small{font-size:11px}.tv-title{font-size:14px;font-weight:600}\
.tv-grid{stroke:#e1e5ea;stroke-width:1}.tv-frame{stroke:#8b949e;stroke-width:1;fill:none}\
.tv-front{stroke:#57606a;stroke-width:1.5;stroke-dasharray:5 4;fill:none}\
.tv-line{stroke-width:1;stroke-opacity:.45;fill:none}.tv-bar{stroke-width:1.2;stroke-opacity:.7}.tv-mark{stroke-width:1.8}\
.tv-s0{stroke:#0b62b8;fill:#0b62b8}.tv-s1{stroke:#c2410c;fill:#c2410c}.tv-s2{stroke:#0f7b5a;fill:#0f7b5a}\
.tv-s3{stroke:#9b3e8f;fill:#9b3e8f}.tv-s4{stroke:#8a6a00;fill:#8a6a00}.tv-s5{stroke:#475569;fill:#475569}\
.tv-open{fill:#ffffff}.tv-none{fill:none}\
@media (prefers-color-scheme:dark){\
.tv-page{fill:#181b20}.tv-ink{fill:#e6e8eb}.tv-soft{fill:#a9b1bb}\
.tv-grid{stroke:#2b3038}.tv-frame{stroke:#6b7480}.tv-front{stroke:#c3c9d1}\
.tv-s0{stroke:#6cb4ff;fill:#6cb4ff}.tv-s1{stroke:#ff9a62;fill:#ff9a62}.tv-s2{stroke:#4fd1a1;fill:#4fd1a1}\
.tv-s3{stroke:#e79bdc;fill:#e79bdc}.tv-s4{stroke:#e3c04d;fill:#e3c04d}.tv-s5{stroke:#b6c2d1;fill:#b6c2d1}\
.tv-open{fill:#181b20}.tv-none{fill:none}}";

/// The figure as a document.
#[must_use]
pub fn figure(findings: &Findings) -> String {
    let groups = Groups::of(findings);
    let legend = groups.legend(findings);
    let panels_end = TITLE + panel::HEIGHT * findings.trades.len() as f64;
    let height = panels_end + LEGEND_LINE * legend.len() as f64 + MARGIN;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tv\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         role=\"img\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"tv-page\" width=\"{WIDTH}\" height=\"{height}\" rx=\"6\"/>\n\
         <text class=\"tv-ink tv-title\" x=\"{MARGIN}\" y=\"20\">{title}</text>\n",
        title = escaped(findings.title)
    );
    for (number, trade) in findings.trades.iter().enumerate() {
        let number = (findings.trades.len() > 1).then_some(number + 1);
        let top = TITLE + panel::HEIGHT * number.map_or(0.0, |n| (n - 1) as f64);
        svg += &panel::draw(findings, trade, number, &groups, top);
    }
    for (i, line) in legend.iter().enumerate() {
        let y = panels_end + LEGEND_LINE * (i as f64 + 0.5);
        for entry in line {
            svg += &entry.draw(y);
        }
    }
    svg + "</svg>\n"
}

/// What XML would take for its own; what it forbids is left out.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// The groups in their order: each a colour and a shape.
struct Groups<'a>(BTreeMap<&'a str, usize>);

impl<'a> Groups<'a> {
    fn of(findings: &'a Findings) -> Self {
        let mut groups = BTreeMap::new();
        for row in &findings.rows {
            let next = groups.len();
            groups.entry(row.group).or_insert(next);
        }
        Self(groups)
    }

    fn number(&self, group: &str) -> usize {
        self.0.get(group).copied().unwrap_or(0)
    }

    /// What is under the plots, in lines that fit.
    fn legend(&self, findings: &Findings) -> Vec<Vec<Entry>> {
        let mut names: Vec<(&str, usize)> = self.0.iter().map(|(name, n)| (*name, *n)).collect();
        names.sort_by_key(|(_, number)| *number);
        let timed = findings.rows.iter().flat_map(|row| &row.values);
        let runs = timed
            .filter_map(|value| match value {
                Value::Timed(spread) => Some(spread.runs),
                Value::Computed(_) => None,
            })
            .max();
        let groups = names
            .into_iter()
            .map(|(name, n)| (Sign::Group(n), name.to_owned()));
        let front = (Sign::Front, "Pareto front: filled".to_owned());
        let bars = runs.map(|n| (Sign::Bar, format!("median, least and greatest of {n} runs")));
        let mut lines: Vec<Vec<Entry>> = vec![Vec::new()];
        let mut x = MARGIN;
        for (sign, text) in groups.chain([front]).chain(bars) {
            let width = 24.0 + labels::width(&text) + 14.0;
            if x > MARGIN && x + width > WIDTH {
                lines.push(Vec::new());
                x = MARGIN;
            }
            if let Some(line) = lines.last_mut() {
                line.push(Entry { sign, text, x });
            }
            x += width;
        }
        lines
    }
}

/// An entry of the legend.
struct Entry {
    sign: Sign,
    text: String,
    x: f64,
}

enum Sign {
    Group(usize),
    Front,
    Bar,
}

impl Entry {
    fn draw(&self, y: f64) -> String {
        let x = self.x;
        let sign = match self.sign {
            Sign::Group(n) => marks::mark(n, x + 8.0, y, true),
            Sign::Front => format!("<path class=\"tv-front\" d=\"M{x:.1} {y:.1}h18\"/>\n"),
            Sign::Bar => {
                format!("<path class=\"tv-frame\" d=\"M{x:.1} {y:.1}h18m0 -3v6m-18 -6v6\"/>\n")
            }
        };
        format!(
            "{sign}<text class=\"tv-soft tv-small\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\n",
            x + 24.0,
            y + 4.0,
            escaped(&self.text)
        )
    }
}

#[cfg(test)]
pub(crate) mod tests;
