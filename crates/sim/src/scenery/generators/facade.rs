//! A building seen from its front: a box with panes of glass on it, in storeys.

use super::super::objects::Facade;
use super::ObjectPart;

/// Distance of panes from the wall, metres, so that beams meet them.
const PANE_M: f64 = 0.01;

pub(in super::super) fn facade(config: &Facade, wall: u32, glass: u32) -> Vec<ObjectPart> {
    let building = ObjectPart::cuboid(
        [0.0; 3],
        [config.width_m, config.depth_m, config.height_m],
        wall,
    );
    let [width, height] = config.window_m;
    let (columns, storeys) = (f64::from(config.columns), f64::from(config.storeys));
    let gap = (config.width_m - columns * width) / (columns + 1.0);
    let storey = (config.height_m - config.sill_m) / storeys;
    let mut parts = vec![building];
    for row in (0..config.storeys).map(f64::from) {
        for column in (0..config.columns).map(f64::from) {
            let (x, z) = (gap + column * (width + gap), config.sill_m + row * storey);
            let pane = ObjectPart::cuboid([x, -PANE_M, z], [x + width, 0.0, z + height], glass);
            parts.push(pane);
        }
    }
    parts
}
