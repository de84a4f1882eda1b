//! Figures are well-formed, whole, and inside their frame.

use super::super::study::example;
use super::*;

/// Names of elements in their order, after a check that tags match, attributes are quoted and nothing is unescaped.
pub(crate) fn elements(xml: &str) -> Vec<String> {
    let (mut open, mut names) = (Vec::new(), Vec::new());
    let mut rest = xml;
    while let Some(at) = rest.find('<') {
        text(&rest[..at]);
        let end = at + rest[at..].find('>').expect("a tag ends");
        let tag = &rest[at + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "in {tag}");
            continue;
        }
        let (tag, alone) = tag
            .strip_suffix('/')
            .map_or((tag, false), |tag| (tag, true));
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        assert!(name.chars().all(|c| c.is_ascii_alphanumeric()), "<{tag}>");
        attributes_are_quoted(attributes);
        names.push(name.to_owned());
        if !alone {
            open.push(name.to_owned());
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
    assert_eq!(rest.trim(), "", "after the end");
    names
}

fn attributes_are_quoted(mut rest: &str) {
    while !rest.trim().is_empty() {
        let (name, value) = rest.trim_start().split_once("=\"").expect("name=\"");
        assert!(
            name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'),
            "{name}"
        );
        let (value, after) = value.split_once('"').expect("an end quote");
        text(value);
        rest = after;
    }
}

fn text(text: &str) {
    for (at, _) in text.match_indices('&') {
        let known = ["&amp;", "&lt;", "&gt;", "&quot;"];
        assert!(known.iter().any(|k| text[at..].starts_with(k)), "{text}");
    }
}

#[test]
fn a_figure_is_well_formed_and_has_every_choice_in_every_plot() {
    let report = example();
    let findings = &report.studies[0];
    let svg = figure(findings);
    let names = elements(&svg);
    assert_eq!(names[0], "svg");
    for row in &findings.rows {
        let title = format!("<title>{}</title>", escaped(&row.name));
        assert_eq!(
            svg.matches(&title).count(),
            findings.trades.len(),
            "{title}"
        );
    }
    for group in ["plain", "clever"] {
        assert!(svg.contains(&format!(">{group}</text>")), "{group}");
    }
    // One front a plot and one in the legend; three of eight marks lie behind a front.
    assert_eq!(svg.matches("class=\"tv-front\"").count(), 3);
    assert_eq!(svg.matches(" tv-open\"").count(), 2);
    assert!(svg.contains("median, least and greatest of 5 runs"));
    assert!(svg.contains("prefers-color-scheme:dark"));
}

#[test]
fn everything_is_inside_the_figure() {
    let report = example();
    let svg = figure(&report.studies[0]);
    let numbers = |name: &str| -> Vec<f64> {
        svg.split(&format!(" {name}=\""))
            .skip(1)
            .filter_map(|rest| rest.split('"').next()?.parse().ok())
            .collect()
    };
    for x in [numbers("x"), numbers("cx")].concat() {
        assert!((0.0..=WIDTH).contains(&x), "{x}");
    }
    assert!(numbers("cy").iter().all(|y| (0.0..=700.0).contains(y)));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn what_is_not_a_number_is_left_out_of_the_figure() {
    let mut report = example();
    let findings = &mut report.studies[0];
    findings.rows[3].values[1] = Value::Computed(f64::NAN);
    let svg = figure(findings);
    elements(&svg);
    assert!(!svg.contains("NaN"));
    assert!(!svg.contains("<title>bad"));
    findings.rows.clear();
    elements(&figure(findings));
}

#[test]
#[should_panic(expected = "in /svg")]
fn the_check_finds_tags_that_do_not_match() {
    elements("<svg><g><path/></svg></g>");
}
