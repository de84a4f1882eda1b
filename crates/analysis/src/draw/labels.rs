//! Placement of labels next to marks, without overlaps.

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LabelBox {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl LabelBox {
    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn within(&self, other: &Self) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }

    /// The rectangle around a horizontal or vertical line, one pixel to each side.
    pub(crate) fn along(a: (f64, f64), b: (f64, f64)) -> Self {
        Self {
            left: a.0.min(b.0) - 1.0,
            top: a.1.min(b.1) - 1.0,
            right: a.0.max(b.0) + 1.0,
            bottom: a.1.max(b.1) + 1.0,
        }
    }

    /// The square around a mark.
    pub(crate) fn about(x: f64, y: f64, half: f64) -> Self {
        Self {
            left: x - half,
            top: y - half,
            right: x + half,
            bottom: y + half,
        }
    }
}

/// Approximate width of a text of 11 pixels.
pub(crate) fn width(text: &str) -> f64 {
    6.1 * text.chars().count() as f64
}

const HEIGHT: f64 = 12.0;
const AWAY: f64 = 8.0;
/// Free at both sides of a label: two in a row would read as one number.
const BESIDE: f64 = 2.0;

/// Position of the label for the mark at (`x`, `y`): the first place inside `room` that is free of
/// `taken`.
pub(crate) fn place(
    text: &str,
    (x, y): (f64, f64),
    room: &LabelBox,
    taken: &[LabelBox],
) -> Option<(LabelBox, (f64, f64))> {
    let wide = width(text);
    let places = [
        (x + AWAY, y),
        (x - AWAY - wide, y),
        (x - wide / 2.0, y - 13.0),
        (x - wide / 2.0, y + 13.0),
        (x + AWAY, y - 11.0),
        (x + AWAY, y + 11.0),
        (x - AWAY - wide, y - 11.0),
        (x - AWAY - wide, y + 11.0),
        (x + 5.0, y - 15.0),
        (x - 5.0 - wide, y + 15.0),
        (x + 5.0, y + 15.0),
        (x - 5.0 - wide, y - 15.0),
    ];
    places.into_iter().find_map(|(left, middle)| {
        let area = LabelBox {
            left,
            top: middle - HEIGHT / 2.0,
            right: left + wide,
            bottom: middle + HEIGHT / 2.0,
        };
        let apart = LabelBox {
            left: area.left - BESIDE,
            right: area.right + BESIDE,
            ..area
        };
        let free = area.within(room) && !taken.iter().any(|other| apart.meets(other));
        free.then_some((apart, (left, middle + 4.0)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: LabelBox = LabelBox {
        left: 0.0,
        top: 0.0,
        right: 100.0,
        bottom: 100.0,
    };

    #[test]
    fn labels_go_right_then_left_then_are_dropped() {
        let (area, (left, _)) = place("abc", (20.0, 50.0), &ROOM, &[]).unwrap();
        assert_eq!(left, 28.0);
        let (_, (left, _)) = place("abc", (95.0, 50.0), &ROOM, &[]).unwrap();
        assert!(left < 80.0);
        let (other, _) = place("abc", (20.0, 50.0), &ROOM, &[area]).unwrap();
        assert!(!other.meets(&area));
        assert!(place("abc", (50.0, 50.0), &ROOM, &[ROOM]).is_none());
        // Free, but so near that both would read as one.
        let (_, (left, _)) = place("abc", (38.5, 50.0), &ROOM, &[area]).unwrap();
        assert_ne!(left, 46.5);
    }
}
