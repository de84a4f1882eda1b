//! Nearest-neighbour search among directions, by cells.
//!
//! Distances are chords, which need no trigonometry and satisfy the triangle inequality.

use glam::DVec3;

use super::cells::CubeCell;

/// Points sorted into cells.
#[derive(Clone, Debug)]
pub(super) struct Nearby {
    points: Vec<DVec3>,
    /// Start of the points of each cell of the last level, and the end.
    starts: Vec<u32>,
    /// Per level and cell: its centre, and the largest distance of its points; negative without
    /// points.
    levels: Vec<Vec<CellBall>>,
}

#[derive(Clone, Copy, Debug)]
struct CellBall {
    middle: DVec3,
    radius: f64,
}

/// Approximate number of points per cell.
const IN_A_CELL: usize = 6;
/// Points closer than this chord are treated as one.
pub(super) const SAME: f64 = 1e-9;

/// The cube of a lattice that contains a point. Two points in the same cube are closer than
/// [`SAME`].
fn cube(point: DVec3) -> [i64; 3] {
    (point * (2.0 / SAME)).round().to_array().map(|c| c as i64)
}

impl Nearby {
    pub fn new(directions: &[DVec3]) -> Self {
        let mut depth = 0_u8;
        while depth < 11 && (6 * IN_A_CELL) << (2 * depth) < directions.len() {
            depth += 1;
        }
        let cells = 6_usize << (2 * depth);
        let of: Vec<u32> = directions
            .iter()
            .map(|direction| CubeCell::of(*direction, depth) as u32)
            .collect();
        let mut starts = vec![0_u32; cells + 1];
        for &cell in &of {
            if let Some(count) = starts.get_mut(cell as usize + 1) {
                *count += 1;
            }
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut next = starts.clone();
        let mut points = vec![DVec3::ZERO; directions.len()];
        for (direction, &cell) in directions.iter().zip(&of) {
            if let Some(next) = next.get_mut(cell as usize) {
                if let Some(slot) = points.get_mut(*next as usize) {
                    *slot = *direction;
                }
                *next += 1;
            }
        }
        let mut nearby = Self {
            points,
            starts,
            levels: Vec::new(),
        };
        nearby.leave_out_the_same();
        nearby.levels = nearby.balls(depth);
        nearby
    }

    /// Keeps one of nearly equal points, which changes the distance to the nearest by at most
    /// [`SAME`]. Only cells with many points are examined.
    fn leave_out_the_same(&mut self) {
        let mut kept = Vec::with_capacity(self.points.len());
        let mut starts = Vec::with_capacity(self.starts.len());
        for cell in 0..self.starts.len().saturating_sub(1) {
            starts.push(kept.len() as u32);
            let own = self.range(cell, cell + 1);
            if own.len() <= 4 * IN_A_CELL {
                kept.extend_from_slice(own);
                continue;
            }
            let mut by_place: Vec<([i64; 3], DVec3)> =
                own.iter().map(|point| (cube(*point), *point)).collect();
            by_place.sort_by_key(|(place, _)| *place);
            by_place.dedup_by_key(|(place, _)| *place);
            kept.extend(by_place.iter().map(|(_, point)| *point));
        }
        starts.push(kept.len() as u32);
        self.points = kept;
        self.starts = starts;
    }

    /// Whether all points within a distance of a direction lie behind the plane `way . p = at`.
    /// Cells behind it or farther off are skipped.
    pub fn all_behind(&self, of: DVec3, distance: f64, way: DVec3, at: f64) -> bool {
        let mut open: Vec<(usize, usize)> = (0..6).map(|cell| (0, cell)).collect();
        while let Some((level, cell)) = open.pop() {
            let Some(ball) = self.levels.get(level).and_then(|balls| balls.get(cell)) else {
                continue;
            };
            let is_off = ball.middle.distance(of) - ball.radius > distance + 1e-15;
            let is_behind = way.dot(ball.middle) + ball.radius < at - 1e-15;
            if ball.radius < 0.0 || is_off || is_behind {
                continue;
            }
            if level + 1 < self.levels.len() {
                open.extend((4 * cell..4 * cell + 4).map(|cell| (level + 1, cell)));
                continue;
            }
            let mut near = self.range(cell, cell + 1).iter();
            let near_and_before =
                |p: &DVec3| p.distance_squared(of) <= distance * distance && way.dot(*p) >= at;
            if near.any(near_and_before) {
                return false;
            }
        }
        true
    }

    fn balls(&self, depth: u8) -> Vec<Vec<CellBall>> {
        let mut cells = CubeCell::faces().to_vec();
        let mut levels = Vec::new();
        for level in 0..=depth {
            let below = 2 * (depth - level);
            let balls = cells.iter().map(|cell| {
                let (middle, _) = cell.ball();
                let first = cell.number() << below;
                let own = self.range(first, first + (1 << below));
                let off = own.iter().map(|point| point.distance_squared(middle));
                let farthest = off.fold(-1.0, f64::max);
                let radius = if farthest < 0.0 {
                    -1.0
                } else {
                    farthest.sqrt()
                };
                CellBall { middle, radius }
            });
            levels.push(balls.collect());
            if level < depth {
                cells = cells.iter().flat_map(|cell| cell.cut()).collect();
            }
        }
        levels
    }

    /// The points of cells of the last level.
    fn range(&self, first: usize, end: usize) -> &[DVec3] {
        let start = |cell: usize| self.starts.get(cell).map_or(0, |&start| start as usize);
        self.points
            .get(start(first)..start(end))
            .unwrap_or_default()
    }

    /// The chord to the nearest point; infinite without points.
    pub fn nearest(&self, to: DVec3) -> f64 {
        let mut nearest = f64::INFINITY;
        self.visit(to, &mut |distance, _| {
            nearest = nearest.min(distance);
            nearest
        });
        nearest
    }

    /// The nearest point.
    pub fn nearest_point(&self, to: DVec3) -> Option<DVec3> {
        let mut nearest = (f64::INFINITY, None);
        self.visit(to, &mut |distance, points| {
            if distance < nearest.0 {
                let off = |p: &DVec3| p.distance_squared(to);
                let of_cell = points.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
                nearest = (distance, of_cell.copied());
            }
            nearest.0
        });
        nearest.1
    }

    /// The points within a distance; `None` if there are more than `most`.
    pub fn within(&self, of: DVec3, distance: f64, most: usize) -> Option<Vec<DVec3>> {
        let mut found: Vec<DVec3> = Vec::new();
        self.visit(of, &mut |_, points| {
            let near = |point: &&DVec3| point.distance_squared(of) <= distance * distance;
            let room = (most + 1).saturating_sub(found.len());
            found.extend(points.iter().filter(near).take(room));
            if found.len() > most { -1.0 } else { distance }
        });
        (found.len() <= most).then_some(found)
    }

    /// Visits cells, near ones first, with the distance of their nearest point, while they may
    /// contain points within the distance that `take` returned last.
    fn visit(&self, to: DVec3, take: &mut dyn FnMut(f64, &[DVec3]) -> f64) {
        let mut limit = f64::INFINITY;
        self.descend(to, 0, 0..6, &mut limit, take);
    }

    fn descend(
        &self,
        to: DVec3,
        level: usize,
        cells: std::ops::Range<usize>,
        limit: &mut f64,
        take: &mut dyn FnMut(f64, &[DVec3]) -> f64,
    ) {
        let Some(balls) = self.levels.get(level) else {
            return;
        };
        let last = level + 1 == self.levels.len();
        let mut order = [(f64::INFINITY, 0_usize); 6];
        let mut count = 0;
        for (cell, ball) in cells.clone().zip(balls.get(cells).unwrap_or_default()) {
            if ball.radius >= 0.0
                && let Some(slot) = order.get_mut(count)
            {
                *slot = (to.distance(ball.middle) - ball.radius, cell);
                count += 1;
            }
        }
        let order = order.get_mut(..count).unwrap_or_default();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &mut (least, cell) in order {
            if least > *limit + 1e-15 {
                break;
            }
            if last {
                let points = self.range(cell, cell + 1);
                let off = points.iter().map(|point| point.distance_squared(to));
                *limit = take(off.fold(f64::INFINITY, f64::min).sqrt(), points);
            } else {
                self.descend(to, level + 1, 4 * cell..4 * cell + 4, limit, take);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    prop_compose! {
        fn direction()(z in -1.0..1.0_f64, a in 0.0..6.3_f64, flat in prop::bool::weighted(0.1)) -> DVec3 {
            let z = if flat { 0.0 } else { z };
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * a.cos(), r * a.sin(), z).normalize()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn nearest_points_agree_with_a_linear_search(
            points in prop::collection::vec(direction(), 0..2_000), origins in prop::collection::vec(direction(), 20), within in 0.0..0.3_f64,
        ) {
            let nearby = Nearby::new(&points);
            for to in origins {
                let slow = points.iter().map(|p| p.distance_squared(to)).fold(f64::INFINITY, f64::min).sqrt();
                prop_assert_eq!(nearby.nearest(to), slow);
                let mut all: Vec<[u64; 3]> = points.iter().filter(|p| p.distance_squared(to) <= within * within)
                    .map(|p| p.to_array().map(f64::to_bits)).collect();
                let few = nearby.within(to, within, 30);
                prop_assert_eq!(few.is_some(), all.len() <= 30);
                if let Some(few) = few {
                    let mut few: Vec<[u64; 3]> = few.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
                    few.sort_unstable();
                    all.sort_unstable();
                    prop_assert_eq!(few, all);
                }
            }
        }
    }
}
