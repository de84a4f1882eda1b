//! The parts of all plots: texts, lines, frames and grids.

use super::axis::{AxisTick, PlotAxis};
use super::escaped;

/// Alignment of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TextAnchor {
    Start,
    Middle,
    End,
}

/// A text of a CSS class.
pub(crate) fn text(x: f64, y: f64, at: TextAnchor, class: &str, text: &str) -> String {
    let anchor = match at {
        TextAnchor::Start => "start",
        TextAnchor::Middle => "middle",
        TextAnchor::End => "end",
    };
    format!(
        "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>\n",
        escaped(text)
    )
}

/// A small grey text.
pub(crate) fn small(x: f64, y: f64, at: TextAnchor, words: &str) -> String {
    text(x, y, at, "tv-soft tv-small", words)
}

/// A line through places; empty without places.
pub(crate) fn line(attributes: &str, places: impl IntoIterator<Item = (f64, f64)>) -> String {
    let places = places.into_iter().map(|(x, y)| format!("{x:.1} {y:.1}"));
    let places: Vec<String> = places.collect();
    match places.is_empty() {
        true => String::new(),
        false => format!("<path {attributes} d=\"M{}\"/>\n", places.join("L")),
    }
}

/// The area of a plot, pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlotArea {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl PlotArea {
    /// The frame around it.
    pub(crate) fn frame(&self) -> String {
        format!(
            "<rect class=\"tv-frame\" x=\"{}\" y=\"{}\" width=\"{:.1}\" height=\"{:.1}\"/>\n",
            self.left,
            self.top,
            self.right - self.left,
            self.bottom - self.top
        )
    }

    /// A vertical line from the top to the bottom.
    pub(crate) fn vertical(&self, class: &str, x: f64) -> String {
        let Self { top, bottom, .. } = self;
        format!("<path class=\"{class}\" d=\"M{x:.1} {top}V{bottom}\"/>\n")
    }

    /// A horizontal line from the left to the right.
    pub(crate) fn horizontal(&self, class: &str, y: f64) -> String {
        let Self { left, right, .. } = self;
        format!("<path class=\"{class}\" d=\"M{left} {y:.1}H{right}\"/>\n")
    }

    /// Vertical lines at ticks, with labels so far below the plot.
    pub(crate) fn verticals(&self, ticks: &[AxisTick], below: f64) -> String {
        let draw = |AxisTick { at, label }: &AxisTick| {
            self.vertical("tv-grid", *at)
                + &small(*at, self.bottom + below, TextAnchor::Middle, label)
        };
        ticks.iter().map(draw).collect()
    }

    /// Horizontal lines at the ticks of an axis, with labels on the left.
    pub(crate) fn horizontals(&self, axis: &PlotAxis) -> String {
        let draw = |AxisTick { at, label }: AxisTick| {
            self.horizontal("tv-grid", at)
                + &small(self.left - 6.0, at + 4.0, TextAnchor::End, &label)
        };
        axis.ticks().into_iter().map(draw).collect()
    }
}
