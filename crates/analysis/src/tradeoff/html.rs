//! Findings as one self-contained HTML page for light and dark colour schemes and phones.

use super::{StudyFindings, StudyReport, svg};
use crate::draw::escaped;
use crate::draw::html::{self, Section, caution};

/// The page.
#[must_use]
pub fn page(report: &StudyReport) -> String {
    let mut intro = format!(
        "<p class=\"soft\">{}</p>\n",
        escaped(&report.machine.line())
    );
    intro.extend(report.cautions().into_iter().map(caution));
    let studies = report.studies.iter();
    let sections: Vec<Section> = studies.map(section).collect();
    let footer = format!(
        "{}. Less is better everywhere. Marked rows are on the Pareto front of their figure (\u{25cf}, or its number). \
         The same figures are in <a href=\"tradeoff.json\">tradeoff.json</a>.",
        escaped(&report.program)
    );
    let heading = "What accuracy costs in time";
    let title = "velomotion: what accuracy costs in time";
    html::page(title, "", heading, &intro, &sections, &footer)
}

fn section(findings: &StudyFindings) -> Section {
    let mut html = String::new();
    for paragraph in &findings.about {
        html += &format!("<p>{}</p>\n", escaped(paragraph));
    }
    html += &format!("<figure>\n{}</figure>\n", svg::figure(findings));
    html += &table(findings);
    for verdict in findings.verdicts() {
        html += &format!("<p class=\"soft\">{}</p>\n", escaped(&verdict));
    }
    (findings.study.name, escaped(findings.study.title), html)
}

fn table(findings: &StudyFindings) -> String {
    let rows = findings.cells().into_iter().map(|row| {
        let is_marked = row.last().is_some_and(|mark| !mark.is_empty());
        let cells = row.iter().enumerate().map(|(column, text)| {
            let text = escaped(text).replace('*', "\u{25cf}");
            match text.split_once(' ').filter(|_| column > 0) {
                Some((middle, ends)) => format!("{middle} <small>{ends}</small>"),
                None => text,
            }
        });
        (is_marked, cells.collect())
    });
    let table = html::table("", findings.headings(), rows);
    format!("<div class=\"scroll\">{table}</div>\n")
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    #[test]
    fn the_page_is_self_contained_and_has_every_choice() {
        let report = example();
        let page = self::page(&report);
        for outside in ["http:", "https:", "src=", "<script", "<link", "@import"] {
            let page = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(page.contains("width=device-width"));
        assert!(page.contains("prefers-color-scheme:dark"));
        assert!(page.contains("Processor &lt;4&gt;"));
        assert_eq!(page.matches("<svg").count(), 1);
        for row in &report.studies[0].rows {
            assert!(page.contains(&format!("<td>{}</td>", escaped(&row.name))));
        }
        assert_eq!(page.matches("class=\"on\"").count(), 4);
        assert!(page.contains("<td>2 <small>(1.8..3.4)</small></td>"));
    }
}
