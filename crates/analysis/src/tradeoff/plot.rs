//! A plot: axes, grid, steps of the front, and a mark per choice with its spread and label.

use super::svg::WIDTH;
use super::{Measurement, Row, StudyFindings, Trade};
use crate::draw::Scale;
use crate::draw::axis::PlotAxis;
use crate::draw::labels::{self, LabelBox};
use crate::draw::plot::{PlotArea, line};
use crate::draw::{escaped, marks, number};

/// Height of a plot with its margins.
pub(super) const HEIGHT: f64 = 322.0;
const AREA: PlotArea = PlotArea {
    left: 56.0,
    right: WIDTH - 18.0,
    top: 26.0,
    bottom: 276.0,
};

/// A choice in the plot.
struct PlotPoint<'a> {
    row: &'a Row,
    x: f64,
    y: f64,
    /// Whether it is on the front.
    on: bool,
    /// Whether it is a step of the front.
    step: bool,
}

/// The ends of a line.
type Line = ((f64, f64), (f64, f64));

/// The plot of a trade, `top` pixels down.
pub(super) fn draw(
    findings: &StudyFindings,
    trade: &Trade,
    number: Option<usize>,
    groups: &[&str],
    top: f64,
) -> String {
    let x = axis(findings, trade.cost, None, (AREA.left, AREA.right));
    let y = axis(findings, trade.loss, trade.least, (AREA.bottom, AREA.top));
    let least = trade
        .least
        .map(|least| format!(" (less: at {})", number::short(least)));
    let number = number.map_or(String::new(), |n| format!("{n}: "));
    let mut svg = format!("<g transform=\"translate(0 {top})\">\n");
    svg += &AREA.verticals(&x.ticks(), 15.0);
    svg += &AREA.horizontals(&y);
    svg += &AREA.frame();
    svg += &format!(
        "<text class=\"tv-ink\" x=\"14\" y=\"16\">{number}{}{}</text>\n\
         <text class=\"tv-ink\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n",
        escaped(findings.column(trade.loss).1),
        least.unwrap_or_default(),
        AREA.right,
        AREA.bottom + 34.0,
        escaped(findings.column(trade.cost).1),
    );
    let points = points(findings, trade, &x, &y);
    let mut lines: Vec<LabelBox> = Vec::new();
    for group in findings.circumstances(trade) {
        let corners = corners(&points, group);
        let colour = group.map(|group| marks::colour(number_of(groups, group)));
        let class = colour.map_or("tv-front".to_owned(), |c| format!("tv-front {c} tv-none"));
        svg += &line(&format!("class=\"{class}\""), corners.iter().copied());
        let sides = corners.windows(2);
        lines.extend(sides.filter_map(|pair| Some(LabelBox::along(*pair.first()?, *pair.last()?))));
    }
    if trade.joined {
        let (joined, along) = joined(&points, groups);
        svg += &joined;
        lines.extend(along);
    }
    for point in &points {
        svg += &bars(point, trade, &x, &y, groups);
    }
    for point in &points {
        let mark = marks::mark(
            number_of(groups, point.row.group),
            point.x,
            point.y,
            point.on,
        );
        let name = escaped(&point.row.name);
        svg += &format!("<g><title>{name}</title>{mark}</g>\n");
    }
    let bars = points.iter().flat_map(|point| spread(point, trade, &x, &y));
    lines.extend(bars.flatten().map(|(a, b)| LabelBox::along(a, b)));
    svg += &names(&points, &lines);
    svg + "</g>\n"
}

/// The number of a group, which selects its colour and shape.
fn number_of(groups: &[&str], group: &str) -> usize {
    let place = groups.iter().position(|name| *name == group);
    place.unwrap_or(0)
}

fn axis(
    findings: &StudyFindings,
    column: usize,
    least: Option<f64>,
    (from, to): (f64, f64),
) -> PlotAxis {
    let values = findings
        .rows
        .iter()
        .filter_map(|row| row.values.get(column));
    let ends = values.flat_map(|value| {
        let (low, high) = ends(value);
        [low, high].map(|end| at_least(end, least))
    });
    PlotAxis::new(Scale::Log, ends, from, to)
}

/// A value, or the least that is drawn.
fn at_least(value: f64, least: Option<f64>) -> f64 {
    // NaN stays.
    match least {
        Some(least) if value < least => least,
        _ => value,
    }
}

const fn ends(value: &Measurement) -> (f64, f64) {
    match value {
        Measurement::Computed(x) => (*x, *x),
        Measurement::Timed(spread) => (spread.min, spread.max),
    }
}

fn points<'a>(
    findings: &'a StudyFindings,
    trade: &Trade,
    x: &PlotAxis,
    y: &PlotAxis,
) -> Vec<PlotPoint<'a>> {
    let on = findings.front(trade).into_iter().zip(findings.steps(trade));
    let rows = findings.rows.iter().zip(on);
    rows.filter_map(|(row, (on, step))| {
        Some(PlotPoint {
            row,
            x: x.position(row.values.get(trade.cost)?.middle())?,
            y: y.position(at_least(row.values.get(trade.loss)?.middle(), trade.least))?,
            on,
            step,
        })
    })
    .collect()
}

/// Corners of the front of a group, or of all rows.
fn corners(points: &[PlotPoint<'_>], group: Option<&str>) -> Vec<(f64, f64)> {
    let of_group = |point: &&PlotPoint<'_>| group.is_none_or(|group| point.row.group == group);
    let steps = points.iter().filter(|point| point.step).filter(of_group);
    let mut front: Vec<&PlotPoint<'_>> = steps.collect();
    front.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut corners = Vec::new();
    let mut y = AREA.top;
    for point in front {
        corners.extend([(point.x, y), (point.x, point.y)]);
        y = point.y;
    }
    if !corners.is_empty() {
        corners.push((AREA.right, y));
    }
    corners
}

/// Parts of a slanting line that labels keep clear of, each in a box of its own.
const PARTS: u32 = 12;

/// Lines through the rows of each group, and the boxes along them.
fn joined(points: &[PlotPoint<'_>], groups: &[&str]) -> (String, Vec<LabelBox>) {
    let (mut svg, mut boxes) = (String::new(), Vec::new());
    let mut names = groups.to_vec();
    names.sort_unstable();
    for group in names {
        let own = points.iter().filter(|point| point.row.group == group);
        let class = format!(
            "class=\"{} tv-line tv-none\"",
            marks::colour(number_of(groups, group))
        );
        let places: Vec<(f64, f64)> = own.map(|point| (point.x, point.y)).collect();
        for (a, b) in places.iter().zip(places.iter().skip(1)) {
            let at = |part: u32| {
                let share = f64::from(part) / f64::from(PARTS);
                (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
            };
            boxes.extend((0..PARTS).map(|part| LabelBox::along(at(part), at(part + 1))));
        }
        if places.len() > 1 {
            svg += &line(&class, places);
        }
    }
    (svg, boxes)
}

/// Horizontal and vertical lines from minimum to maximum, where they are longer than the mark.
fn spread(point: &PlotPoint<'_>, trade: &Trade, x: &PlotAxis, y: &PlotAxis) -> [Option<Line>; 2] {
    let places = |axis: &PlotAxis, column: usize| {
        let (low, high) = ends(point.row.values.get(column)?);
        let (low, high) = (axis.position(low)?, axis.position(high)?);
        ((high - low).abs() > marks::HALF).then_some((low, high))
    };
    [
        places(x, trade.cost).map(|(a, b)| ((a, point.y), (b, point.y))),
        places(y, trade.loss).map(|(a, b)| ((point.x, a), (point.x, b))),
    ]
}

fn bars(
    point: &PlotPoint<'_>,
    trade: &Trade,
    x: &PlotAxis,
    y: &PlotAxis,
    groups: &[&str],
) -> String {
    let class = marks::colour(number_of(groups, point.row.group));
    let [level, upright] = spread(point, trade, x, y);
    let level = level.map(|((a, y), (b, _))| {
        let top = y - 3.0;
        format!("M{a:.1} {y:.1}H{b:.1}M{a:.1} {top:.1}v6M{b:.1} {top:.1}v6")
    });
    let upright = upright.map(|((x, a), (_, b))| {
        let left = x - 3.0;
        format!("M{x:.1} {a:.1}V{b:.1}M{left:.1} {a:.1}h6M{left:.1} {b:.1}h6")
    });
    let paths = level.into_iter().chain(upright);
    paths
        .map(|path| format!("<path class=\"{class} tv-bar\" d=\"{path}\"/>\n"))
        .collect()
}

/// Distance of marks of which one label of the same name suffices.
const TOGETHER: f64 = 3.0 * marks::HALF;

/// The labels, those on the front first. They avoid marks, each other and `lines`. A label without
/// a free place is left out; the table has it.
fn names(points: &[PlotPoint<'_>], lines: &[LabelBox]) -> String {
    let room = LabelBox {
        left: AREA.left + 2.0,
        top: AREA.top + 2.0,
        right: AREA.right - 2.0,
        bottom: AREA.bottom - 2.0,
    };
    let of_mark = |point: &PlotPoint<'_>| LabelBox::about(point.x, point.y, marks::HALF + 1.0);
    let mut taken: Vec<LabelBox> = points.iter().map(of_mark).chain(lines.to_vec()).collect();
    let mut order: Vec<&PlotPoint<'_>> = points.iter().collect();
    order.sort_by_key(|point| !point.on);
    let mut svg = String::new();
    let mut named: Vec<&PlotPoint<'_>> = Vec::new();
    for point in order {
        let (name, at) = (&point.row.label, (point.x, point.y));
        let is_beside = |other: &&PlotPoint<'_>| {
            let distance = (other.x - point.x).hypot(other.y - point.y);
            other.row.label == *name && distance < TOGETHER
        };
        if named.iter().any(is_beside) {
            continue;
        }
        if let Some((area, (x, y))) = labels::place(name, at, &room, &taken) {
            taken.push(area);
            named.push(point);
            svg += &format!(
                "<text class=\"tv-ink tv-small\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>\n",
                escaped(name)
            );
        }
    }
    svg
}
