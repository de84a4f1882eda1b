//! Findings as one page that needs nothing beside it: figures inside, light and dark, readable on a phone.

use super::svg::escaped;
use super::{Findings, Report, number, svg};

pub(crate) const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1f2328;--soft:#57606a;--page:#f3f4f6;--card:#fff;--line:#d8dee4;--mark:#0b62b8;--tint:#eef5fc}\
@media (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--soft:#a0a8b2;--page:#101216;--card:#181b20;--line:#333941;--mark:#6cb4ff;--tint:#1b2733}}\
*{box-sizing:border-box}\
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.55 system-ui,-apple-system,'Segoe UI',sans-serif}\
main,header,footer{max-width:56rem;margin:0 auto;padding:1rem}\
h1{font-size:1.7rem;line-height:1.2;margin:1rem 0 .4rem}\
h2{font-size:1.25rem;line-height:1.3;margin:0 0 .6rem}\
p{margin:.5rem 0}\
.soft,footer{color:var(--soft);font-size:.92rem}\
.caution{border-left:4px solid #d9822b;padding:.3rem .8rem;margin:.8rem 0}\
nav{display:flex;flex-wrap:wrap;gap:.5rem;margin:1rem 0 0}\
nav a{background:var(--card);border:1px solid var(--line);border-radius:99px;padding:.25rem .8rem;color:var(--mark);text-decoration:none;font-size:.92rem}\
section{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:1.1rem;margin:0 0 1.2rem}\
figure{margin:1rem 0}\
figure svg{display:block;width:100%;max-width:40rem;height:auto;margin:0 auto}\
.scroll{overflow-x:auto;-webkit-overflow-scrolling:touch}\
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums;font-size:.9rem}\
th,td{padding:.35rem .6rem;border-bottom:1px solid var(--line);text-align:right;vertical-align:bottom}\
th:first-child,td:first-child{text-align:left}\
th{font-weight:600}\
td small{color:var(--soft);white-space:nowrap}\
tr.on td{background:var(--tint)}\
tr.on td:last-child{color:var(--mark);font-weight:700}\
@media (max-width:34rem){header,footer{padding:.8rem}main{padding:.4rem}section{padding:.7rem;border-radius:8px}figure{margin:1rem -.7rem}\
th,td{padding:.3rem .35rem}td small{display:block;font-size:.78rem}}";

/// The page.
#[must_use]
pub fn page(report: &Report) -> String {
    let machine = escaped(&report.machine.line());
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>velomotion: what accuracy costs in time</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>What accuracy costs in time</h1>\n<p class=\"soft\">{machine}</p>\n"
    );
    for caution in report.cautions() {
        page += &format!("<p class=\"caution\">{}</p>\n", escaped(caution));
    }
    page += "<nav>\n";
    for findings in &report.studies {
        page += &format!(
            "<a href=\"#{}\">{}</a>\n",
            findings.name,
            escaped(findings.title)
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

fn section(findings: &Findings) -> String {
    let mut html = format!(
        "<section id=\"{}\">\n<h2>{}</h2>\n",
        findings.name,
        escaped(findings.title)
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

fn table(findings: &Findings) -> String {
    let mut html = format!(
        "<div class=\"scroll\"><table>\n<thead><tr><th>{}</th>",
        escaped(findings.choice)
    );
    for column in &findings.columns {
        html += &format!("<th>{}</th>", escaped(column.heading));
    }
    html += "<th>front</th></tr></thead>\n<tbody>\n";
    for (row, mark) in findings.rows.iter().zip(findings.marks()) {
        let class = if mark.is_empty() { "" } else { " class=\"on\"" };
        html += &format!("<tr{class}><td>{}</td>", escaped(&row.name));
        for value in &row.values {
            let text = number::value(value);
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
    fn the_page_stands_alone_and_has_every_choice() {
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
