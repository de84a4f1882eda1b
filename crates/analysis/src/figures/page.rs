//! All figures and tables as one self-contained HTML page, for light and dark colour schemes,
//! phones and print.

use super::conclusion::{conclusions, farthest};
use super::frame::short_name;
use super::{
    AnalyzedScan, AnalyzedScans, CELL_M, SPHERE_M, curves, density, histogram, planes, points,
};
use crate::draw::escaped;
use crate::draw::html::{self, Section, caution};
use crate::draw::number::short;

/// Files next to the page that it links to, and their descriptions.
pub const FILES: [(&str, &str); 9] = [
    ("points.svg", "points on the sphere"),
    ("density.svg", "density on the sphere"),
    ("histogram.svg", "histogram of the density"),
    ("planes.svg", "points on planes"),
    ("k.svg", "K - K_csr and its derivative"),
    ("density.csv", "points in each bin, with the bin's middle"),
    ("histogram.csv", "bins by their points"),
    ("k.csv", "K, K - K_csr and the derivative over the angle"),
    ("analyze.json", "everything that --json says"),
];

/// On narrow screens figures and tables keep a readable size and scroll in a frame of their own.
/// Also for print.
const MORE_STYLE: &str = "\
h1,h2{overflow-wrap:anywhere}section{min-width:0}figcaption{color:var(--soft);font-size:.92rem;margin-top:.5rem}\
figure svg{max-width:45rem}\
.scroll{border:1px solid var(--line);border-radius:6px;padding:0 .4rem;scrollbar-width:thin}.picture{padding:0}\
.hint{display:none;color:var(--soft);font-size:.85rem;margin:.6rem 0 .2rem}\
main,header,footer{max-width:64rem}\
.caption{color:var(--soft);font-size:.92rem;margin:1rem 0 .4rem}\
td:first-child{overflow-wrap:anywhere;min-width:9rem}summary{cursor:pointer;color:var(--mark)}\
code{overflow-wrap:anywhere}\
@media (max-width:47rem){.hint{display:block}.picture svg{width:45rem;max-width:none}.scroll table{width:max-content;min-width:100%}\
td:first-child,th:first-child{position:sticky;left:0;background:var(--card)}td:first-child{max-width:10rem}}\
@media (max-width:34rem){h1{font-size:1.3rem}figure{margin:1rem 0}figcaption{padding:0}}\
@media print{body{background:#fff}section{border:0;padding:0;break-inside:auto}figure,tr{break-inside:avoid}nav,.hint{display:none}\
.scroll{border:0;overflow:visible}.picture svg{width:100%;max-width:45rem}}";

/// Step of the angle in the table of K, degrees.
const EVERY_DEG: f64 = 15.0;

/// The page.
#[must_use]
pub fn page(scans: &AnalyzedScans) -> String {
    let names: Vec<String> = scans
        .scans
        .iter()
        .map(|scan| short_name(&scan.name))
        .collect();
    let title = format!("Scan patterns: {}", escaped(&names.join(", ")));
    let intro = format!(
        "<p class=\"soft\">{}: <code>{}</code></p>\n",
        escaped(&scans.program),
        escaped(&scans.command)
    );
    let footer = "After: Analysis of 3D Scan Measurement Distribution with Application to a Multi-Beam Lidar on a Rotating Platform (2018). \
                  Directions are seen from the origin, on the tilt axis y; x is right, z is up.";
    html::page(&title, MORE_STYLE, &title, &intro, &sections(scans), footer)
}

fn sections(scans: &AnalyzedScans) -> Vec<Section> {
    let bins = scans.bins.bins().len();
    let cell = short(CELL_M);
    vec![
        ("summary", "At a glance".to_owned(), summary(scans)),
        (
            "points",
            "Points on the sphere".to_owned(),
            figure(
                &points(scans),
                "Every point is counted; points in the same square are drawn as one, in the colour of their number.",
            ),
        ),
        (
            "density",
            "Density on the sphere".to_owned(),
            figure(
                &density(scans),
                "All scans have one scale of colours, by equal factors. Darker is more; bins without a point are white with grey edges.",
            ) + &densities(scans),
        ),
        (
            "histogram",
            "Histogram of the density".to_owned(),
            figure(
                &histogram(scans),
                &format!(
                    "{bins} bins by their points, about sixty classes from none to each scan's fullest bin. The line is the mean, dashed lines are a standard deviation off it. \
                     Each scan has its own scale across, and all have one upwards: bins are counted on a logarithmic scale, so that few of them show beside thousands."
                ),
            ),
        ),
        (
            "planes",
            "Points on planes".to_owned(),
            figure(
                &planes(scans),
                &format!(
                    "Where rays from 1.5 m above the ground meet it, and walls at 10 m parallel to YZ and XZ. Every point is counted; \
                     points in the same square of {cell} m are drawn as one, in the colour of their number."
                ),
            ) + &plane_table(scans),
        ),
        (
            "k",
            "How evenly points lie".to_owned(),
            figure(
                &curves(scans),
                "Ripley's K function less that of points at random (complete spatial randomness), over the area of the sphere: so much larger is the share of \
                 all pairs within an angle. Above 0 points cluster, below they keep apart. The derivative says at which angles pairs are too many or too few; \
                 last the derivative of K itself, beside that of random points in grey. \
                 Curves that coincide show in turns, by their dashes.",
            ) + &extremes(scans)
                + &k_table(scans),
        ),
        ("files", "Figures and numbers as files".to_owned(), files()),
    ]
}

/// Hint above wide content, on phones only.
const HINT: &str = "<p class=\"hint\">wider than the screen: swipe sideways \u{2194}</p>\n";

fn figure(svg: &str, caption: &str) -> String {
    format!(
        "<figure>\n{HINT}<div class=\"scroll picture\" tabindex=\"0\">\n{svg}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
        escaped(caption)
    )
}

/// A table with a caption above it, which wraps independent of the table's width.
fn table(caption: &str, headings: &[&str], rows: &[Vec<String>]) -> String {
    let caption = escaped(caption);
    let rows = rows.iter();
    let rows = rows.map(|row| (false, row.iter().map(|cell| escaped(cell)).collect()));
    let label = format!(" aria-label=\"{caption}\"");
    let table = html::table(&label, headings.iter().copied(), rows);
    format!(
        "<p class=\"caption\">{caption}</p>\n{HINT}<div class=\"scroll\" tabindex=\"0\">{table}</div>\n"
    )
}

fn rows(scans: &AnalyzedScans, row: impl Fn(&AnalyzedScan) -> Vec<String>) -> Vec<Vec<String>> {
    let all = scans.scans.iter();
    all.map(|scan| {
        std::iter::once(scan.name.clone())
            .chain(row(scan))
            .collect()
    })
    .collect()
}

fn summary(scans: &AnalyzedScans) -> String {
    let mut html = conclusions(scans);
    for scan in &scans.scans {
        for warning in &scan.warnings {
            html += &caution(&format!("{}: {warning}", scan.name));
        }
    }
    let percent =
        |share: Option<f64>| share.map_or(NONE.to_owned(), |share| format!("{:.1}", 100.0 * share));
    let three = |number: Option<f64>| number.map_or(NONE.to_owned(), |x| format!("{x:.3}"));
    let rows = rows(scans, |scan| {
        let all = scan.counts.statistics();
        let seen = scan.in_view.as_ref();
        vec![
            scan.points.to_string(),
            scan.scan_s.map_or(NONE.to_owned(), short),
            percent(all.coverage),
            percent(seen.and_then(|seen| seen.statistics.coverage)),
            format!("{:.3}", scan.hole_deg),
            three(seen.and_then(|seen| seen.hole_deg)),
            three(all.sd_over_mean),
            three(seen.and_then(|seen| seen.statistics.sd_over_mean)),
            farthest(scan).map_or(NONE.to_owned(), |d| format!("{d:.5}")),
        ]
    });
    let words = [
        "scan",
        "points",
        "seconds",
        "sphere covered, %",
        "view covered, %",
        "largest hole anywhere, deg",
        "largest hole in view, deg",
        "sd / mean, all bins",
        "sd / mean, bins in view",
        "largest |K - K_csr|",
    ];
    html + &table(
        "Covered: bins that hold a point. In view: where the scan could see at all, known of patterns and logs. Less is better from the holes on.",
        &words,
        &rows,
    )
}

/// Shown for an unknown number.
const NONE: &str = "-";

fn densities(scans: &AnalyzedScans) -> String {
    let rows = rows(scans, |scan| {
        let s = scan.counts.statistics();
        vec![
            format!("{:.3}", s.mean),
            format!("{:.2}", s.sd),
            s.min.to_string(),
            s.max.to_string(),
            s.empty.to_string(),
            format!("{:.2}", s.mean_per_deg2),
            format!("{:.2}", s.sd_per_deg2),
        ]
    });
    let words = [
        "scan",
        "mean",
        "sd",
        "min",
        "max",
        "empty",
        "mean a deg\u{b2}",
        "sd a deg\u{b2}",
    ];
    let bins = scans.bins.bins().len();
    table(&format!("Points per bin, of {bins} bins"), &words, &rows)
}

fn plane_table(scans: &AnalyzedScans) -> String {
    let rows = rows(scans, |scan| {
        let planes = &scan.planes;
        vec![
            scan.points.to_string(),
            planes.met().to_string(),
            planes.shown().to_string(),
            planes.drawn().to_string(),
        ]
    });
    let words = [
        "scan",
        "points",
        "meet the planes",
        "within the pictures",
        "squares drawn",
    ];
    table("What the pictures show", &words, &rows)
}

fn extremes(scans: &AnalyzedScans) -> String {
    let at = |scan: &AnalyzedScan, extreme: f64| {
        let found = scan.k.d.iter().position(|d| (*d - extreme).abs() <= 0.0);
        let theta = found.and_then(|bin| scan.k.theta_rad.get(bin));
        theta.map_or("0".to_owned(), |theta| format!("{:.1}", theta.to_degrees()))
    };
    let rows = rows(scans, |scan| {
        let k = &scan.k;
        if !k.has_pairs() {
            return vec!["-".to_owned(); 6];
        }
        let bound = match k.d_error_bound {
            0.0 => "0 (exact)".to_owned(),
            bound => format!("{bound:.1e}"),
        };
        vec![
            format!("{:+.5}", k.d_max),
            at(scan, k.d_max),
            format!("{:+.5}", k.d_min),
            at(scan, k.d_min),
            scan.method.to_owned(),
            bound,
        ]
    });
    let words = [
        "scan",
        "largest",
        "at, deg",
        "smallest",
        "at, deg",
        "counted by",
        "off by at most",
    ];
    table("K - K_csr, share of the sphere's area", &words, &rows)
}

/// The curves at some angles.
fn k_table(scans: &AnalyzedScans) -> String {
    let mut words = vec!["angle up to, deg"];
    words.extend(scans.scans.iter().map(|scan| scan.name.as_str()));
    let thetas = scans
        .scans
        .first()
        .map_or(&[][..], |scan| &scan.k.theta_rad);
    let mut rows = Vec::new();
    let mut next_deg = EVERY_DEG;
    for (bin, theta_deg) in thetas.iter().map(|theta| theta.to_degrees()).enumerate() {
        // Edges may not be at whole degrees: the first at or after each angle, and the last.
        if theta_deg < next_deg - 1e-9 && bin + 1 < thetas.len() {
            continue;
        }
        while next_deg <= theta_deg + 1e-9 {
            next_deg += EVERY_DEG;
        }
        let mut row = vec![format!("{theta_deg:.2}")];
        let all = scans.scans.iter();
        row.extend(all.map(|scan| {
            scan.k
                .d
                .get(bin)
                .map_or("-".to_owned(), |d| format!("{d:+.5}"))
        }));
        rows.push(row);
    }
    let table = table("K - K_csr, share of the sphere's area", &words, &rows);
    format!("<details>\n<summary>The curves as numbers</summary>\n{table}</details>\n")
}

fn files() -> String {
    let mut html = "<ul>\n".to_owned();
    for (name, what) in FILES {
        html += &format!("<li><a href=\"{name}\">{name}</a>: {what}</li>\n");
    }
    html + &format!(
        "</ul>\n<p class=\"soft\">Square metres in k.csv are of a sphere of {SPHERE_M} m.</p>\n"
    )
}
