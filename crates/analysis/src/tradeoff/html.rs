//! Findings as one self-contained HTML page for light and dark colour schemes and phones.

use super::{StudyFindings, StudyReport, svg};
use crate::draw::{PAGE_STYLE, escaped};

/// The page.
#[must_use]
pub fn page(report: &StudyReport) -> String {
    let machine = escaped(&report.machine.line());
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>velomotion: what accuracy costs in time</title>\n<style>{PAGE_STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>What accuracy costs in time</h1>\n<p class=\"soft\">{machine}</p>\n"
    );
    for caution in report.cautions() {
        page += &format!("<p class=\"caution\">{}</p>\n", escaped(caution));
    }
    page += "<nav>\n";
    for findings in &report.studies {
        page += &format!(
            "<a href=\"#{}\">{}</a>\n",
            findings.study.name,
            escaped(findings.study.title)
        );
    }
    page += "</nav>\n</header>\n<main>\n";
    for findings in &report.studies {
        page += &section(findings);
    }
    page += &format!(
        "</main>\n<footer>{}. Times: the median of repeated runs in turns, with the least and the greatest. Less is better everywhere. \
         Marked rows are on the Pareto front of their figure (\u{25cf}, or its number). \
         The same figures are in <a href=\"tradeoff.json\">tradeoff.json</a>.</footer>\n</body>\n</html>\n",
        escaped(&report.program)
    );
    page
}

fn section(findings: &StudyFindings) -> String {
    let mut html = format!(
        "<section id=\"{}\">\n<h2>{}</h2>\n",
        findings.study.name,
        escaped(findings.study.title)
    );
    for paragraph in &findings.about {
        html += &format!("<p>{}</p>\n", escaped(paragraph));
    }
    html += &format!("<figure>\n{}</figure>\n", svg::figure(findings));
    html += &table(findings);
    for verdict in findings.verdicts() {
        html += &format!("<p class=\"soft\">{}</p>\n", escaped(&verdict));
    }
    html + "</section>\n"
}

fn table(findings: &StudyFindings) -> String {
    let mut html = format!(
        "<div class=\"scroll\"><table>\n<thead><tr><th>{}</th>",
        escaped(findings.study.choice)
    );
    for (_, heading) in findings.study.columns {
        html += &format!("<th>{}</th>", escaped(heading));
    }
    html += "<th>front</th></tr></thead>\n<tbody>\n";
    for (row, mark) in findings.rows.iter().zip(findings.marks()) {
        let class = if mark.is_empty() { "" } else { " class=\"on\"" };
        html += &format!("<tr{class}><td>{}</td>", escaped(&row.name));
        for value in &row.values {
            let text = value.text();
            let (middle, ends) = text.split_once(' ').unwrap_or((&text, ""));
            html += &format!("<td>{middle}");
            if !ends.is_empty() {
                html += &format!(" <small>{ends}</small>");
            }
            html += "</td>";
        }
        let mark = mark.replace('*', "\u{25cf}");
        html += &format!("<td>{mark}</td></tr>\n");
    }
    html + "</tbody></table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::super::study::example;
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
