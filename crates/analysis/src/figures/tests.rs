//! Figures are well-formed and complete, and every printed number is the computed one.

use std::num::NonZeroUsize;

use glam::DVec3;

use super::*;
use crate::density::Locator;
use crate::draw::escaped;
use crate::draw::xml::elements;
use crate::k::{Edges, exact};

/// A lidar's grid: rings at some elevations about z, rotated about y to these tilts.
fn grid(azimuths: u32, tilts_deg: &[f64]) -> Vec<DVec3> {
    let mut points = Vec::new();
    for tilt in tilts_deg {
        let tilt = glam::DQuat::from_rotation_y(tilt.to_radians());
        for ring in 0..8 {
            let elevation = (-14.0 + 4.0 * f64::from(ring)).to_radians();
            for step in 0..azimuths {
                let azimuth =
                    std::f64::consts::TAU * (f64::from(step) + 0.25) / f64::from(azimuths);
                let flat = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0) * elevation.cos();
                points.push(tilt * (flat + DVec3::Z * elevation.sin()));
            }
        }
    }
    points
}

fn scan(name: &str, directions: &[DVec3], level: u32) -> AnalyzedScan {
    let locator = Locator::new(&Icosahedron::new(level).unwrap());
    let counts = exact(directions, &Edges::equal(37).unwrap(), NonZeroUsize::MIN).unwrap();
    AnalyzedScan {
        name: name.to_owned(),
        points: directions.len() as u64,
        scan_s: Some(0.1),
        hole_deg: 55.5,
        in_view: None,
        warnings: Vec::new(),
        counts: BinCounts::new(&locator, directions).unwrap(),
        k: KCurve::new(&counts.into(), SPHERE_M),
        method: "exact",
        planes: Planes::new(directions),
        sphere: SpherePoints::new(directions),
    }
}

fn scans(level: u32) -> AnalyzedScans {
    let tilts: Vec<f64> = (0..12).map(|k| 15.0 * f64::from(k)).collect();
    AnalyzedScans {
        program: "velomotion 1.0".to_owned(),
        command: "velomotion analyze a,b <c> & \"d\"".to_owned(),
        bins: Icosahedron::new(level).unwrap(),
        scans: vec![
            scan("still", &grid(60, &[0.0]), level),
            scan("turned,tilt=<stepped> & \"so\"", &grid(60, &tilts), level),
        ],
    }
}

fn all_figures(scans: &AnalyzedScans) -> [String; 5] {
    [
        points(scans),
        density(scans),
        histogram(scans),
        planes(scans),
        curves(scans),
    ]
}

#[test]
fn figures_are_well_formed_and_describe_every_scan() {
    for level in [0, 2, 6] {
        let scans = scans(level);
        for figure in all_figures(&scans) {
            assert_eq!(elements(&figure)[..3], ["svg", "title", "desc"]);
            assert!(
                !figure.contains("NaN") && !figure.contains("inf"),
                "{figure}"
            );
            let words = figure
                .split("<desc>")
                .nth(1)
                .unwrap()
                .split("</desc>")
                .next()
                .unwrap();
            assert!(
                words.contains("still: ")
                    && words.contains("&lt;stepped&gt; &amp; &quot;so&quot;: "),
                "{words}"
            );
            assert!(figure.contains(&format!(
                    "aria-label=\"{}",
                    figure
                        .split("<title>")
                        .nth(1)
                        .unwrap()
                        .split('<')
                        .next()
                        .unwrap()
                )));
        }
    }
}

#[test]
fn every_bin_is_drawn_in_each_view_that_shows_it() {
    let scans = scans(2);
    let figure = density(&scans);
    // Each triangle is a closed path; two more mark empty bins.
    let expected: usize = scans
        .bins
        .bins()
        .iter()
        .map(|face| {
            [DVec3::X, DVec3::NEG_Y, DVec3::Z]
                .iter()
                .filter(|to| face.centre.dot(**to) > 0.0)
                .count()
        })
        .sum();
    let paths = figure
        .split(" d=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap());
    let triangles: usize = paths.map(|path| path.matches('z').count()).sum();
    assert_eq!(triangles, 2 * expected + 2);
}

#[test]
fn finer_levels_are_merged_for_drawing_without_losing_points() {
    let (coarse, fine) = (scans(5), scans(6));
    assert!(density(&fine).contains("(20480 bins)"));
    // An equal number of triangles for four times as many bins.
    let size = |scans: &AnalyzedScans| density(scans).matches('l').count();
    assert!(
        size(&fine).abs_diff(size(&coarse)) < 60,
        "{} {}",
        size(&fine),
        size(&coarse)
    );
}

#[test]
fn empty_scans_are_drawn() {
    let mut scans = scans(2);
    let none = AnalyzedScan {
        hole_deg: 180.0,
        scan_s: None,
        ..scan("nothing", &[], 2)
    };
    scans.scans = vec![none, scan("one", &[DVec3::Z], 2)];
    for figure in all_figures(&scans) {
        elements(&figure);
        assert!(
            !figure.contains("NaN") && !figure.contains("inf"),
            "{figure}"
        );
    }
    assert_page_complete(&page(&scans), &scans);
    scans.scans.clear();
    for figure in all_figures(&scans) {
        elements(&figure);
    }
    assert_eq!(csv::k(&scans).lines().count(), 1);
}

/// The fields of a line without quotes.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

/// All numbers of a table from a column on, and the names before them.
fn read(csv: &str, from: usize) -> (Vec<String>, Vec<Vec<f64>>) {
    let columns = csv.lines().next().unwrap().split(',').count();
    let lines: Vec<Vec<String>> = csv.lines().skip(1).map(fields).collect();
    assert!(lines.iter().all(|line| line.len() == columns));
    let names = lines.iter().map(|line| line[0].clone()).collect();
    let numbers = lines
        .iter()
        .map(|line| line[from..].iter().map(|x| x.parse().unwrap()).collect());
    (names, numbers.collect())
}

#[test]
fn tables_print_the_exact_counts() {
    let scans = scans(3);
    let (names, rows) = read(&csv::k(&scans), 1);
    assert_eq!(rows.len(), 2 * 37);
    // Quotes inside are doubled, and the reader above removes them.
    assert_eq!(
        (names[0].as_str(), names[37].as_str()),
        ("still", "turned,tilt=<stepped> & so")
    );
    for (scan, rows) in scans.scans.iter().zip(rows.chunks(37)) {
        for (bin, row) in rows.iter().enumerate() {
            let k = &scan.k;
            assert_eq!(row[0], k.theta_rad[bin].to_degrees());
            assert_eq!(row[1..4], [k.k_m2[bin], k.k_minus_csr_m2[bin], k.d[bin]]);
            assert!((row[4] - (row[0] - 90.0 / 37.0)).abs() < 1e-9);
            assert_eq!(row[5], k.derivative_m2_rad[bin]);
        }
    }
    let (_, rows) = read(&csv::density(&scans), 1);
    assert_eq!(rows.len(), 2 * 1_280);
    for (place, row) in rows.iter().enumerate() {
        let (scan, bin) = (&scans.scans[place / 1_280], place % 1_280);
        assert_eq!(row[0], bin as f64);
        assert_eq!(row[1..4], scans.bins.bins()[bin].centre.to_array());
        assert_eq!(row[4], scan.counts.by_bin()[bin] as f64);
    }
    let (names, rows) = read(&csv::histogram(&scans), 1);
    for scan in &scans.scans {
        let plain = scan.name.replace('"', "");
        let own = names.iter().zip(&rows).filter(|(name, _)| **name == plain);
        let mut bins = 0.0;
        for (_, row) in own {
            let within = |count: &&u64| (row[0]..=row[1]).contains(&(**count as f64));
            assert_eq!(
                row[2],
                scan.counts.by_bin().iter().filter(within).count() as f64
            );
            bins += row[2];
        }
        assert_eq!(bins, 1_280.0);
    }
}

fn assert_page_complete(page: &str, scans: &AnalyzedScans) {
    let alone = page.replace("http://www.w3.org/2000/svg", "");
    for outside in [
        "http:", "https:", "src=", "<script", "<link", "@import", "url(",
    ] {
        assert!(!alone.contains(outside), "{outside}");
    }
    for figure in all_figures(scans) {
        assert!(page.contains(&figure));
    }
    for scan in &scans.scans {
        assert!(
            page.matches(&format!("<td>{}</td>", escaped(&scan.name)))
                .count()
                >= 4
        );
    }
    for (name, _) in FILES {
        assert!(page.contains(&format!("<a href=\"{name}\">")), "{name}");
    }
    // Apart from the void elements of HTML it is XML.
    let (head, body) = page.split_once("<body>").unwrap();
    assert!(head.contains("width=device-width") && head.contains("<html lang=\"en\">"));
    let body = format!("<body>{}", body.replace("</html>", ""));
    let names = elements(&body);
    assert_eq!(names.iter().filter(|name| *name == "figcaption").count(), 5);
    assert_eq!(page.matches("<p class=\"caption\">").count(), 5);
    // Content wider than a phone scrolls in its own frame, with a hint.
    let frames = page.matches("<div class=\"scroll").count();
    assert_eq!((frames, page.matches("class=\"hint\"").count()), (10, 10));
}

/// The page reports the known values of a view, omits unknown ones, and warns next to misleading
/// values.
#[test]
fn the_page_reports_values_and_warnings_of_a_view() {
    let mut scans = scans(3);
    let [still, turned] = scans.scans.as_mut_slice() else {
        panic!("two scans");
    };
    let half: Vec<bool> = (0..1_280).map(|bin| bin % 2 == 0).collect();
    let statistics = turned.counts.statistics_of(|bin| half[bin]);
    turned.in_view = Some(InView {
        statistics,
        hole_deg: Some(3.25),
    });
    still.warnings.push("the origin <0,0,0> is far".to_owned());
    let (all, uneven) = (still.counts.statistics(), statistics.sd_over_mean.unwrap());
    let page = page(&scans);
    let glance = page.split("id=\"summary\"").nth(1).unwrap();
    let glance = glance.split("</section>").next().unwrap();
    for words in [
        format!(
            "<b>still</b> covers {:.1} % of the sphere; its largest hole anywhere has a radius of 55.50",
            100.0 * all.coverage.unwrap()
        ),
        "What it could see is not known".to_owned(),
        "its largest hole in view has a radius of 3.25\u{b0}, anywhere 55.50\u{b0}".to_owned(),
        "smallest largest hole in view: turned,tilt=".to_owned(),
        "<p class=\"caution\">still: the origin &lt;0,0,0&gt; is far</p>".to_owned(),
        "<th scope=\"col\">sd / mean, all bins</th>".to_owned(),
        "<th scope=\"col\">sd / mean, bins in view</th>".to_owned(),
        format!("<td>{uneven:.3}</td>"),
        // A scan with an unknown view has no hole and no evenness there.
        format!(
            "<td>55.500</td><td>-</td><td>{:.3}</td><td>-</td>",
            all.sd_over_mean.unwrap()
        ),
    ] {
        assert!(glance.contains(&words), "no {words:?} in:\n{glance}");
    }
    // The most even scan over the sphere is the one closest to random.
    let nearest = scans
        .scans
        .iter()
        .map(|scan| scan.k.d_max.max(-scan.k.d_min));
    let least = nearest.fold(f64::INFINITY, f64::min);
    assert!(glance.contains(&format!("({least:.5})")), "{glance}");
}

/// Ten scans have ten colours; all curves but the first have gaps that show the curves below.
#[test]
fn coinciding_curves_are_distinguishable() {
    let mut scans = scans(2);
    let one = scans.scans.swap_remove(0);
    scans.scans = (0..10)
        .map(|number| AnalyzedScan {
            name: format!("scan {number}"),
            ..one.clone()
        })
        .collect();
    let figure = curves(&scans);
    let strokes = |from: &str| -> std::collections::BTreeSet<String> {
        let found = figure.split(from).skip(1);
        found
            .map(|rest| rest.split('"').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(strokes("<path class=\"tv-c ").len(), 10);
    let dashes = strokes("stroke-dasharray=\"");
    assert_eq!(dashes.len(), 10, "{dashes:?}");
    assert_eq!(dashes.iter().filter(|dash| *dash == "none").count(), 1);
    assert_eq!(
        figure.matches("angle between two points, degrees").count(),
        3
    );
}

/// A scan of few points next to one of many is not squeezed into a corner.
#[test]
fn each_histogram_has_its_own_scale() {
    let mut scans = scans(2);
    let alone = csv::histogram(&scans);
    let many = grid(60, &[0.0])
        .into_iter()
        .cycle()
        .take(480 * 500)
        .collect::<Vec<_>>();
    scans.scans.push(scan("many", &many, 2));
    // The figure of the first scan does not depend on the last one.
    assert!(csv::histogram(&scans).starts_with(&alone));
    let rows = |figure: &str| -> Vec<String> {
        let rows = figure.split("<g transform=").skip(1);
        rows.map(|row| {
            row.split("tv-fill\" d=\"")
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .to_owned()
        })
        .collect()
    };
    let drawn = rows(&histogram(&scans));
    let last = |path: &str| -> f64 {
        let right = path.rsplit('H').next().unwrap().split('V').next().unwrap();
        right.parse().unwrap()
    };
    for path in &drawn {
        assert!(last(path) > 500.0, "{path}");
    }
}

#[test]
fn the_page_is_self_contained_with_every_figure_and_table() {
    let scans = scans(3);
    let page = page(&scans);
    assert_page_complete(&page, &scans);
    assert!(page.contains("a,b &lt;c&gt; &amp; &quot;d&quot;"));
    let s = scans.scans[1].counts.statistics();
    assert!(page.contains(&format!(
        "<td>{:.3}</td><td>{:.2}</td><td>{}</td>",
        s.mean, s.sd, s.min
    )));
    // A row every 15 degrees: the first edge at or after each.
    let curves = page.split("The curves as numbers").nth(1).unwrap();
    let rows = curves
        .split("<tr><td>")
        .skip(1)
        .map(|row| row.split('<').next().unwrap());
    let rows: Vec<&str> = rows.collect();
    assert_eq!(
        (rows.len(), rows[0], rows[11]),
        (12, "19.46", "180.00"),
        "{rows:?}"
    );
}
