//! Self-contained HTML pages for light and dark colour schemes and phones.

use super::escaped;

/// Style of an HTML page, for light and dark colour schemes.
const STYLE: &str = "\
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

/// Name, heading and content of a section, in HTML.
pub(crate) type Section = (&'static str, String, String);

/// A page with the title of its window, its heading and paragraphs below that, all in HTML. `style`
/// is added to the style of all pages.
pub(crate) fn page(
    title: &str,
    style: &str,
    heading: &str,
    intro: &str,
    sections: &[Section],
    footer: &str,
) -> String {
    let (mut links, mut main) = (String::new(), String::new());
    for (name, heading, content) in sections {
        links += &format!("<a href=\"#{name}\">{heading}</a>\n");
        main += &format!("<section id=\"{name}\">\n<h2>{heading}</h2>\n{content}</section>\n");
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>{STYLE}{style}</style>\n</head>\n<body>\n\
         <header>\n<h1>{heading}</h1>\n{intro}<nav>\n{links}</nav>\n</header>\n<main>\n{main}</main>\n\
         <footer>{footer}</footer>\n</body>\n</html>\n"
    )
}

/// A warning.
pub(crate) fn caution(text: &str) -> String {
    format!("<p class=\"caution\">{}</p>\n", escaped(text))
}

/// A table of headings as text and of rows as HTML; rows with `true` are marked.
pub(crate) fn table<'a>(
    attributes: &str,
    headings: impl IntoIterator<Item = &'a str>,
    rows: impl IntoIterator<Item = (bool, Vec<String>)>,
) -> String {
    let mut html = format!("<table{attributes}>\n<thead><tr>");
    for heading in headings {
        html += &format!("<th scope=\"col\">{}</th>", escaped(heading));
    }
    html += "</tr></thead>\n<tbody>\n";
    for (is_marked, cells) in rows {
        let class = if is_marked { " class=\"on\"" } else { "" };
        html += &format!("<tr{class}><td>{}</td></tr>\n", cells.join("</td><td>"));
    }
    html + "</tbody></table>"
}
