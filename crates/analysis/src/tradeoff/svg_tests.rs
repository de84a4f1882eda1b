//! Figures are well-formed, complete, and inside their frame.

use super::super::report::example;
use super::*;
use crate::draw::xml::elements;

#[test]
fn the_figure_is_well_formed_and_has_every_choice_in_every_plot() {
    let report = example();
    let findings = &report.studies[0];
    let svg = figure(findings);
    let names = elements(&svg);
    assert_eq!(names[0], "svg");
    for row in &findings.rows {
        let title = format!("<title>{}</title>", escaped(&row.name));
        assert_eq!(
            svg.matches(&title).count(),
            findings.study.trades.len(),
            "{title}"
        );
    }
    for group in ["plain", "clever"] {
        assert!(svg.contains(&format!(">{group}</text>")), "{group}");
    }
    // One front per plot and one in the legend; three of eight marks are dominated.
    assert_eq!(svg.matches("class=\"tv-front\"").count(), 3);
    assert_eq!(svg.matches(" tv-open\"").count(), 2);
    assert!(svg.contains("median, least and greatest of 5 runs"));
    assert!(svg.contains("prefers-color-scheme:dark"));
}

#[test]
fn all_elements_are_inside_the_figure() {
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
    // Two panels, the legend, and two lines of the title.
    assert_eq!(svg.matches("tv-title\"").count(), 2);
    assert!(numbers("cy").iter().all(|y| (0.0..=718.0).contains(y)));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn nan_values_are_left_out_of_the_figure() {
    let mut report = example();
    let findings = &mut report.studies[0];
    findings.rows[3].values[1] = Measurement::Computed(f64::NAN);
    let svg = figure(findings);
    elements(&svg);
    assert!(!svg.contains("NaN"));
    assert!(!svg.contains("<title>bad"));
    findings.rows.clear();
    elements(&figure(findings));
}

#[test]
#[should_panic(expected = "in /svg")]
fn mismatched_tags_are_detected() {
    elements("<svg><g><path/></svg></g>");
}
