//! Findings as text of 80 columns.

use super::{Measurement, StudyFindings, StudyReport};

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
    let marks = findings.marks();
    let headings = findings.study.columns.iter().map(|c| c.1).chain(["front"]);
    let headings: Vec<&str> = headings.collect();
    let cells: Vec<Vec<String>> = findings
        .rows
        .iter()
        .zip(marks)
        .map(|(row, mark)| {
            row.values
                .iter()
                .map(Measurement::text)
                .chain([mark])
                .collect()
        })
        .collect();
    let widths: Vec<usize> = headings
        .iter()
        .enumerate()
        .map(|(i, heading)| {
            let cells = cells.iter().filter_map(|row| row.get(i)).map(|c| length(c));
            let words = heading.split(' ').map(length);
            cells.chain(words).max().unwrap_or(0)
        })
        .collect();
    let taken: usize = widths.iter().map(|w| w + GAP).sum();
    let longest = findings.rows.iter().map(|row| length(&row.name)).max();
    let first = longest
        .unwrap_or(0)
        .max(length(findings.study.choice))
        .min(WIDTH.saturating_sub(taken))
        .max(8);
    let heads: Vec<Vec<String>> = headings
        .iter()
        .zip(&widths)
        .map(|(heading, width)| wrap(heading, *width))
        .collect();
    let deep = heads.iter().map(Vec::len).max().unwrap_or(1);
    let mut lines = Vec::new();
    for line in 0..deep {
        // Headings are aligned at the bottom.
        let words: Vec<String> = heads
            .iter()
            .map(|head| {
                let above = deep - head.len();
                line.checked_sub(above)
                    .and_then(|i| head.get(i).cloned())
                    .unwrap_or_default()
            })
            .collect();
        let name = if line + 1 == deep {
            findings.study.choice
        } else {
            ""
        };
        lines.push(line_of(name, first, &words, &widths));
    }
    lines.push("-".repeat((first + taken).min(WIDTH)));
    for (row, cells) in findings.rows.iter().zip(&cells) {
        for (i, name) in wrap(&row.name, first).iter().enumerate() {
            let none = vec![String::new(); cells.len()];
            let cells = if i == 0 { cells } else { &none };
            lines.push(line_of(name, first, cells, &widths));
        }
    }
    lines
}

fn line_of(name: &str, first: usize, cells: &[String], widths: &[usize]) -> String {
    let mut line = format!("{name:<first$}");
    for (cell, width) in cells.iter().zip(widths) {
        line += &format!("{:GAP$}{cell:>width$}", "");
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
