//! Findings as a page of the book. The figures stand beside it, in a folder of its name.

use super::{Findings, Report, number};

/// The page: `command` is what makes it, `folder` where its figures are, seen from the page.
#[must_use]
pub fn page(report: &Report, command: &str, folder: &str) -> String {
    let mut page = vec![
        "# What accuracy costs in time".to_owned(),
        format!(
            "Every choice that buys accuracy with time, measured by `{command}` on {}. Times are the median of repeated runs, with the least \
             and the greatest; the competitors took turns. Less is better everywhere: a choice is on the Pareto front (*, or the \
             figure's number) where no other is at least as good in both and better in one, not even than its best run.",
            escaped(&report.machine.line())
        ),
    ];
    page.extend(
        report
            .cautions()
            .iter()
            .map(|caution| format!("**{caution}**")),
    );
    for findings in &report.studies {
        page.push(section(findings, folder));
    }
    page.join("\n\n") + "\n"
}

fn section(findings: &Findings, folder: &str) -> String {
    let mut section = vec![format!("## {}", escaped(findings.title))];
    section.extend(findings.about.iter().map(|paragraph| escaped(paragraph)));
    section.push(format!(
        "![{}]({folder}/{}.svg)",
        escaped(findings.title),
        findings.name
    ));
    section.push(table(findings));
    section.extend(findings.verdicts().iter().map(|verdict| escaped(verdict)));
    section.join("\n\n")
}

fn table(findings: &Findings) -> String {
    let headings = findings.columns.iter().map(|column| column.heading);
    let headings: Vec<&str> = [findings.choice].into_iter().chain(headings).collect();
    let mut lines = vec![
        format!("| {} | front |", headings.join(" | ")),
        format!("|---{}|:-:|", "|--:".repeat(findings.columns.len())),
    ];
    for (row, mark) in findings.rows.iter().zip(findings.marks()) {
        let values: Vec<String> = row.values.iter().map(number::value).collect();
        let mark = mark.replace('*', "\\*");
        lines.push(format!(
            "| {} | {} | {mark} |",
            escaped(&row.name),
            values.join(" | ")
        ));
    }
    lines.join("\n")
}

/// What Markdown would take for its own.
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
    use super::super::study::example;
    use super::*;

    #[test]
    fn the_page_names_machine_command_figures_and_every_choice() {
        let report = example();
        let page = self::page(&report, "velomotion tradeoff", "tradeoff");
        assert!(page.contains("`velomotion tradeoff` on Processor &lt;4&gt;, 2 cores, Linux."));
        assert!(page.contains("**A quick look"), "{page}");
        assert!(page.contains("![Ways &amp; means](tradeoff/example.svg)"));
        assert!(page.contains(
            "| way | ns a point | worst error, mm | bytes | front |\n|---|--:|--:|--:|:-:|\n"
        ));
        assert!(
            page.contains("| coarse &lt;&amp;&gt; way | 2 (1.8..3.4) | 130 | 10 | 1 |"),
            "{page}"
        );
        let columns = |line: &str| line.matches('|').count();
        let lines: Vec<&str> = page.lines().filter(|l| l.starts_with('|')).collect();
        assert_eq!(lines.len(), 6);
        assert!(lines.iter().all(|line| columns(line) == columns(lines[0])));
    }
}
