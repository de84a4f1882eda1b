//! Findings as text of 80 columns.

use analysis::tradeoff::{StudyFindings, StudyReport};
use comfy_table::Width::Fixed;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table};

/// Width of a line.
const WIDTH: usize = 80;

/// Width of names that stay on one line.
const NAME_WIDTH: usize = 24;

/// The machine, cautions, and each study with its table and fronts.
#[must_use]
pub(super) fn report(report: &StudyReport) -> String {
    let machine = format!("{} on {}", report.program, report.machine.line());
    let mut text = vec![textwrap::fill(&machine, WIDTH)];
    let cautions = report.cautions().into_iter();
    text.extend(cautions.map(|caution| textwrap::fill(caution, WIDTH)));
    for findings in &report.studies {
        text.extend([String::new(), self::findings(findings)]);
    }
    text.join("\n")
}

/// One study.
fn findings(findings: &StudyFindings) -> String {
    let study = &findings.study;
    let mut text = vec![format!("{} ({})", study.title, study.name), String::new()];
    let fill = |paragraph: &String| textwrap::fill(paragraph, WIDTH);
    text.extend(findings.about.iter().map(fill));
    text.extend([String::new(), table(findings), String::new()]);
    text.extend(findings.verdicts().iter().map(fill));
    text.join("\n")
}

/// The table: names on the left, values on the right, marks of the fronts last.
fn table(findings: &StudyFindings) -> String {
    let cells = findings.cells();
    let headings = findings.headings();
    let longest_word = |column: usize| {
        let texts = cells
            .iter()
            .filter_map(|row| row.get(column).map(String::as_str));
        let texts = texts.chain(headings.get(column).copied());
        let words = texts.flat_map(str::split_whitespace);
        words.map(|word| word.chars().count()).max().unwrap_or(0)
    };
    let words: Vec<usize> = (0..headings.len()).map(longest_word).collect();
    let values: usize = words.iter().skip(1).sum();
    // A blank between columns, and one more where there is room.
    let blank = u16::from(NAME_WIDTH + values + 2 * headings.len() <= WIDTH);
    let names = cells.iter().filter_map(|row| row.first());
    let is_short = names.map(|name| name.chars().count()).max() <= Some(NAME_WIDTH);
    let mut table = Table::new();
    table
        .load_style(NOTHING.header_separator(LineStyle::none().fill('-').junction('-')))
        .set_width(WIDTH as u16)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_header(headings)
        .add_rows(cells);
    for column in table.column_iter_mut() {
        column.set_padding((0, blank));
        if column.index > 0 {
            column.set_cell_alignment(CellAlignment::Right);
            // No word and no number is broken.
            let least = words.get(column.index).copied().unwrap_or(0) as u16 + blank;
            column.set_constraint(ColumnConstraint::LowerBoundary(Fixed(least)));
        } else if is_short {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::Trade;
    use analysis::tradeoff::{Effort, Machine, Measurement, Row, Study, StudyRows, TimingSpread};

    use super::*;

    fn example(first: &str) -> StudyReport {
        let row = |name: &str, cost: f64, loss: f64| {
            let (min, max) = (cost * 0.9, cost * 1.7);
            let mut row = Row::new(name, name, "plain", [loss]);
            let runs = 5;
            let spread = TimingSpread {
                median: cost,
                min,
                max,
                runs,
            };
            row.values.insert(0, Measurement::Timed(spread));
            row
        };
        StudyReport {
            program: "velomotion 0.0.0".to_owned(),
            effort: Effort::Quick,
            machine: Machine {
                cpu: "Processor".to_owned(),
                cores: 2,
                os: "Linux".to_owned(),
                build: "release",
            },
            studies: vec![StudyFindings {
                study: Study {
                    name: "example",
                    title: "Ways and means",
                    choice: "way",
                    columns: &[("time_ns", "ns per point"), ("error_mm", "worst error, mm")],
                    trades: const { &[Trade::new(0, 1)] },
                    finding: StudyFindings::ends_of_front,
                    measure: |_| Ok(StudyRows::default()),
                },
                about: vec![
                    "A sentence that is long enough to need a second line of text. ".repeat(2),
                ],
                rows: vec![
                    row(first, 2.0, 130.0),
                    row("exact", 20.0, 0.0),
                    row("bad", 21.0, 1.0),
                ],
            }],
        }
    }

    #[test]
    fn table_columns_are_aligned() {
        let expected = "
way        ns per point  worst error, mm  front
------------------------------------------------
coarse     2 (1.8..3.4)              130      *
exact       20 (18..34)                0      *
bad     21 (18.9..35.7)                1      *";
        let report = example("coarse");
        assert_eq!(table(&report.studies[0]), expected.trim_start());
        let text = self::report(&report);
        assert!(text.starts_with("velomotion 0.0.0 on Processor, 2 cores, Linux\nA quick look"));
        assert!(text.contains("\nPareto front of ns per point and worst error, mm: coarse"));
    }

    #[test]
    fn long_names_are_wrapped() {
        let long = "a way whose name is so long that it would leave no room at all for what was measured of it";
        let text = report(&example(long));
        assert!(
            text.lines().all(|line| line.chars().count() <= WIDTH),
            "{text}"
        );
        assert!(text.contains("2 (1.8..3.4)"), "{text}");
    }
}
