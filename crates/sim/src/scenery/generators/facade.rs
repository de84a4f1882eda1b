//! A building seen from its front: a box with panes of glass on it, in storeys.

use super::super::objects::Facade;
use super::Part;

/// How far panes stand out of the wall, metres: so that they are what a beam meets.
const PANE_M: f64 = 0.01;

pub(in super::super) fn facade(wish: &Facade, wall: u32, glass: u32) -> Vec<Part> {
    let building = Part::cuboid([0.0; 3], [wish.width_m, wish.depth_m, wish.height_m], wall);
    let [width, height] = wish.window_m;
    let (columns, storeys) = (f64::from(wish.columns), f64::from(wish.storeys));
    let gap = (wish.width_m - columns * width) / (columns + 1.0);
    let storey = (wish.height_m - wish.sill_m) / storeys;
    let mut parts = vec![building];
    for row in (0..wish.storeys).map(f64::from) {
        for column in (0..wish.columns).map(f64::from) {
            let (x, z) = (gap + column * (width + gap), wish.sill_m + row * storey);
            let pane = Part::cuboid([x, -PANE_M, z], [x + width, 0.0, z + height], glass);
            parts.push(pane);
        }
    }
    parts
}
