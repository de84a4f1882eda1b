//! Findings as a page of the book.

use std::path::{Path, PathBuf};

use super::{StudyFindings, StudyReport, svg};

/// A page of the book that a command writes, with its figures in a folder of the page's name.
#[derive(Clone, Copy, Debug)]
pub struct Book<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// Command that writes the page.
    pub command: &'a str,
    /// Name of the page and of the folder of its figures.
    pub name: &'a str,
}

impl Book<'_> {
    /// The page and its figures: paths within the book, and contents.
    #[must_use]
    pub fn files(&self, report: &StudyReport) -> Vec<(PathBuf, String)> {
        let page = (
            PathBuf::from(format!("{}.md", self.name)),
            self.page(report),
        );
        let figures = report.studies.iter().map(|study| {
            let path = Path::new(self.name).join(format!("{}.svg", study.study.name));
            (path, svg::figure(study))
        });
        [page].into_iter().chain(figures).collect()
    }

    /// The page alone.
    #[must_use]
    pub fn page(&self, report: &StudyReport) -> String {
        let (how, compared) = match report.is_timed() {
            true => (
                format!(
                    "Measured by `{}` on {}. Times are medians (minimum..maximum) of repeated runs, \
                     in turns.",
                    self.command,
                    escaped(&report.machine.line())
                ),
                ", compared with their best run",
            ),
            false => (format!("Computed by `{}`.", self.command), ""),
        };
        let mut page = vec![
            format!("# {}", escaped(self.title)),
            format!(
                "{how} Smaller is better. Choices on the Pareto front have a * or the number of the \
                 plot. No other choice is at least as good in both columns and better in \
                 one{compared}."
            ),
        ];
        page.extend(
            report
                .cautions()
                .iter()
                .map(|caution| format!("**{caution}**")),
        );
        for findings in &report.studies {
            page.push(section(findings, self.name));
        }
        page.join("\n\n") + "\n"
    }
}

fn section(findings: &StudyFindings, folder: &str) -> String {
    let mut section = vec![format!("## {}", escaped(findings.study.title))];
    section.extend(findings.about.iter().map(|paragraph| escaped(paragraph)));
    section.push(format!(
        "![{}]({folder}/{}.svg)",
        escaped(&(findings.study.finding)(findings)),
        findings.study.name
    ));
    // Its last column has the fronts, and the figure their axes.
    section.push(table(findings));
    section.join("\n\n")
}

fn table(findings: &StudyFindings) -> String {
    let columns = findings.study.columns.len();
    let mut lines = vec![
        format!("| {} |", findings.headings().join(" | ")),
        format!("|---{}|:-:|", "|--:".repeat(columns)),
    ];
    for row in findings.cells() {
        let cells: Vec<String> = row.iter().map(|cell| escaped(cell)).collect();
        lines.push(format!("| {} |", cells.join(" | ")));
    }
    lines.join("\n")
}

/// Text with the special characters of Markdown escaped.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '*' | '_' | '|' | '`' | '[' | ']' | '\\' => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    const BOOK: Book<'_> = Book {
        title: "Accuracy and time",
        command: "velomotion tradeoff",
        name: "tradeoff",
    };

    #[test]
    fn the_page_names_machine_command_figures_and_every_choice() {
        let report = example();
        let page = BOOK.page(&report);
        assert!(page.contains("`velomotion tradeoff` on Processor &lt;4&gt;, 2 cores, Linux."));
        assert!(page.contains("**A quick look"), "{page}");
        let finding = "2 to 20 ns per point, worst error, mm 130 (coarse) to 0 (exact)";
        assert!(page.contains(&format!("![{finding}](tradeoff/example.svg)")));
        assert!(page.contains(
            "| way | ns per point | worst error, mm | bytes | front |\n|---|--:|--:|--:|:-:|\n"
        ));
        assert!(
            page.contains("| coarse &lt;&amp;&gt; way | 2 (1.8..3.4) | 130 | 10 | 1 |"),
            "{page}"
        );
        let files = BOOK.files(&report);
        assert_eq!(files[0], (PathBuf::from("tradeoff.md"), page.clone()));
        assert_eq!(files[1].0, PathBuf::from("tradeoff/example.svg"));
        let columns = |line: &str| line.matches('|').count();
        let lines: Vec<&str> = page.lines().filter(|l| l.starts_with('|')).collect();
        assert_eq!(lines.len(), 6);
        assert!(lines.iter().all(|line| columns(line) == columns(lines[0])));
    }
}
