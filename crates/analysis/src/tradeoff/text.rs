//! Findings as text of 80 columns.

use super::{StudyFindings, StudyReport};

/// Width of a line.
const WIDTH: usize = 80;
const GAP: usize = 2;

/// The machine, cautions, and each study with its table and fronts.
#[must_use]
pub fn report(report: &StudyReport) -> String {
    let mut text = Vec::new();
    text.extend(wrap(
        &format!("{} on {}", report.program, report.machine.line()),
        WIDTH,
    ));
    for caution in report.cautions() {
        text.extend(wrap(caution, WIDTH));
    }
    for findings in &report.studies {
        text.push(String::new());
        text.push(self::findings(findings));
    }
    text.join("\n")
}

/// One study.
#[must_use]
pub fn findings(findings: &StudyFindings) -> String {
    let mut text = vec![
        format!("{} ({})", findings.study.title, findings.study.name),
        String::new(),
    ];
    for paragraph in &findings.about {
        text.extend(wrap(paragraph, WIDTH));
    }
    text.push(String::new());
    text.extend(table(findings));
    text.push(String::new());
    for verdict in findings.verdicts() {
        text.extend(wrap(&verdict, WIDTH));
    }
    text.join("\n")
}

/// The table: names on the left, values on the right, marks of the fronts last.
fn table(findings: &StudyFindings) -> Vec<String> {
    let (headings, rows) = (findings.headings(), findings.cells());
    let longest = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| length(cell)).max().unwrap_or(0)
    };
    let mut widths = Vec::new();
    for (column, heading) in headings.iter().enumerate().skip(1) {
        let words = heading.split(' ').map(length);
        widths.push(words.fold(longest(column), usize::max));
    }
    let taken: usize = widths.iter().map(|w| w + GAP).sum();
    let first = longest(0)
        .max(length(findings.study.choice))
        .min(WIDTH.saturating_sub(taken))
        .max(8);
    widths.insert(0, first);
    let heads = headings.iter().zip(&widths);
    let heads: Vec<Vec<String>> = heads
        .map(|(heading, width)| wrap(heading, *width))
        .collect();
    let deep = heads.iter().map(Vec::len).max().unwrap_or(1);
    let mut lines = Vec::new();
    for line in 0..deep {
        // Headings are aligned at the bottom.
        let words = heads.iter().map(|head| {
            let place = (line + head.len()).checked_sub(deep);
            place.and_then(|i| head.get(i)).cloned().unwrap_or_default()
        });
        lines.push(line_of(&words.collect::<Vec<_>>(), &widths));
    }
    lines.push("-".repeat((first + taken).min(WIDTH)));
    for mut row in rows {
        let names = row.first().map_or(Vec::new(), |name| wrap(name, first));
        for name in names {
            if let Some(cell) = row.first_mut() {
                *cell = name;
            }
            lines.push(line_of(&row, &widths));
            // Only the first line has values.
            row.fill(String::new());
        }
    }
    lines
}

fn line_of(cells: &[String], widths: &[usize]) -> String {
    let mut line = String::new();
    for (column, (cell, width)) in cells.iter().zip(widths).enumerate() {
        line += &match column {
            0 => format!("{cell:<width$}"),
            _ => format!("{:GAP$}{cell:>width$}", ""),
        };
    }
    line.trim_end().to_owned()
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// Lines of at most `width` characters; a longer word has a line of its own.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            if line.is_empty() {
                line.push_str(word);
            } else if length(line) + 1 + length(word) <= width {
                line.push(' ');
                line.push_str(word);
            } else {
                lines.push(word.to_owned());
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::study::example;
    use super::*;

    #[test]
    fn table_columns_are_aligned() {
        let expected = "
                                  worst
                                 error,
way                  ns a point      mm  bytes  front
-----------------------------------------------------
coarse <&> way     2 (1.8..3.4)     130     10      1
fine <&> way      9 (8.1..15.3)    1e-6     12    1,2
exact <&> way       20 (18..34)       0     14    1,2
bad <&> way     21 (18.9..35.7)       1      9      2";
        let report = example();
        let table = table(&report.studies[0]);
        assert_eq!(table, expected.lines().skip(1).collect::<Vec<_>>());
        let text = self::report(&report);
        assert!(text.lines().all(|line| length(line) <= WIDTH), "{text}");
    }

    #[test]
    fn long_names_are_wrapped() {
        let mut report = example();
        let long = "a way whose name is so long that it would leave no room at all for what was measured of it";
        report.studies[0].rows[0].name = long.to_owned();
        let text = self::report(&report);
        assert!(text.lines().all(|line| length(line) <= WIDTH), "{text}");
        assert!(text.contains("2 (1.8..3.4)"), "{text}");
    }
}
