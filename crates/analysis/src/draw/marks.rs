//! Marks of choices. Each group has its own shape, so that colour is not the only difference.

const SHAPES: usize = 5;
const COLOURS: usize = 6;

/// Half the size of a mark.
pub(crate) const HALF: f64 = 4.5;

/// CSS class of a group's colour.
pub(crate) fn colour(group: usize) -> String {
    format!("tv-s{}", group % COLOURS)
}

/// The mark of a group at a position; filled for choices on the front.
pub(crate) fn mark(group: usize, x: f64, y: f64, filled: bool) -> String {
    let open = if filled { "" } else { " tv-open" };
    let class = format!("tv-mark {}{open}", colour(group));
    let r = HALF;
    let path = |d: String| format!("<path class=\"{class}\" d=\"{d}\"/>\n");
    match group % SHAPES {
        0 => format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\"/>\n"),
        1 => path(format!(
            "M{:.1} {:.1}h{w}v{w}h-{w}z",
            x - 4.0,
            y - 4.0,
            w = 8.0
        )),
        2 => path(format!(
            "M{x:.1} {:.1}l5.5 5.5l-5.5 5.5l-5.5 -5.5z",
            y - 5.5
        )),
        3 => path(format!("M{x:.1} {:.1}l5.2 9h-10.4z", y - 5.5)),
        _ => path(format!("M{x:.1} {:.1}l5.2 -9h-10.4z", y + 5.5)),
    }
}
