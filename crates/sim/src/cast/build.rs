//! Building the tree: the surface area heuristic (MacDonald and Booth 1990; binned, Wald 2007), eight children at a time.
//!
//! One input gives one tree, on any machine. Left out: triangles cut in two, several threads.

use super::bvh::{Bounds, Bvh, LEAF, LEVELS, Node};

/// Places along an axis where a cut is tried.
const BINS: usize = 16;

/// An item while the tree is built.
struct Item {
    bounds: Bounds,
    id: u32,
}

/// Items that become one child.
struct Part {
    begin: usize,
    end: usize,
    bounds: Bounds,
}

impl Part {
    fn over(items: &[Item], begin: usize, end: usize) -> Self {
        let mut bounds = Bounds::EMPTY;
        for item in items.get(begin..end).unwrap_or_default() {
            bounds.join(&item.bounds);
        }
        Self { begin, end, bounds }
    }

    const fn len(&self) -> usize {
        self.end - self.begin
    }
}

/// A node whose children are still to be made.
struct Job {
    node: usize,
    begin: usize,
    end: usize,
    level: usize,
}

pub(super) fn build(boxes: &[Bounds]) -> (Bvh, Vec<u32>) {
    let mut items: Vec<Item> = boxes
        .iter()
        .zip(0..)
        .map(|(bounds, id)| Item {
            bounds: *bounds,
            id,
        })
        .collect();
    let whole = Part::over(&items, 0, items.len());
    let mut nodes = Vec::with_capacity(items.len() / 4 + 1);
    nodes.push(Node::EMPTY);
    let mut jobs = vec![Job {
        node: 0,
        begin: 0,
        end: items.len(),
        level: 0,
    }];
    while let Some(job) = jobs.pop() {
        let parts = parts(&mut items, &job);
        let mut made = Node::EMPTY;
        for (lane, part) in parts.iter().enumerate() {
            for axis in 0..3 {
                made.slabs[2 * axis][lane] = below(part.bounds.low[axis]);
                made.slabs[2 * axis + 1][lane] = above(part.bounds.high[axis]);
            }
            made.child[lane] = if part.len() == 1 {
                part.begin as u32 | LEAF
            } else {
                jobs.push(Job {
                    node: nodes.len(),
                    begin: part.begin,
                    end: part.end,
                    level: job.level + 1,
                });
                nodes.push(Node::EMPTY);
                nodes.len() as u32 - 1
            };
        }
        if let Some(node) = nodes.get_mut(job.node) {
            *node = made;
        }
    }
    let reach_m = whole.bounds.reach();
    let order = items.iter().map(|item| item.id).collect();
    (Bvh { nodes, reach_m }, order)
}

/// Up to eight parts of the items of a node: the largest is cut until there are eight.
fn parts(items: &mut [Item], job: &Job) -> Vec<Part> {
    let (begin, end) = (job.begin, job.end);
    if end - begin <= 8 {
        return (begin..end)
            .map(|at| Part::over(items, at, at + 1))
            .collect();
    }
    // Cuts go through the middle where the best ones could make a tree too deep for the stack.
    let balanced = (end - begin - 1).ilog2() as usize / 3 + 1;
    let by_area = job.level + balanced < LEVELS;
    let mut parts = vec![Part::over(items, begin, end)];
    while parts.len() < 8 {
        let size = |part: &Part| {
            if by_area {
                part.bounds.area()
            } else {
                part.len() as f64
            }
        };
        let largest = (0..parts.len())
            .filter(|&at| parts[at].len() > 1)
            .max_by(|&a, &b| size(&parts[a]).total_cmp(&size(&parts[b])));
        let Some(largest) = largest else {
            break;
        };
        let part = parts.swap_remove(largest);
        let cut = cut(items, &part, by_area);
        parts.push(Part::over(items, part.begin, cut));
        parts.push(Part::over(items, cut, part.end));
    }
    // In the order of the items, so that neighbours stay neighbours in memory.
    parts.sort_unstable_by_key(|part| part.begin);
    parts
}

/// Orders the items of a part so that those before the answer are one side of the best cut.
fn cut(items: &mut [Item], part: &Part, by_area: bool) -> usize {
    let middle = part.begin + part.len() / 2;
    let Some(slice) = items.get_mut(part.begin..part.end) else {
        return middle;
    };
    let mut centres = Bounds::EMPTY;
    for item in slice.iter() {
        let centre = [0, 1, 2].map(|axis| item.bounds.middle2(axis));
        centres.join(&Bounds {
            low: centre,
            high: centre,
        });
    }
    if by_area && let Some((axis, bin)) = cheapest(slice, &centres) {
        let binning = Binning::new(&centres, axis);
        let mut before = 0;
        for at in 0..slice.len() {
            if binning.bin(&slice[at]) < bin {
                slice.swap(before, at);
                before += 1;
            }
        }
        if before > 0 && before < slice.len() {
            return part.begin + before;
        }
    }
    let widest = (0..3)
        .max_by(|&a, &b| {
            let width = |axis: usize| centres.high[axis] - centres.low[axis];
            width(a).total_cmp(&width(b))
        })
        .unwrap_or(0);
    let half = slice.len() / 2;
    slice.select_nth_unstable_by(half, |a, b| {
        let (a_at, b_at) = (a.bounds.middle2(widest), b.bounds.middle2(widest));
        a_at.total_cmp(&b_at).then(a.id.cmp(&b.id))
    });
    middle
}

/// Which bin an item's centre falls into.
struct Binning {
    axis: usize,
    low: f64,
    scale: f64,
}

impl Binning {
    fn new(centres: &Bounds, axis: usize) -> Self {
        let (low, high) = (centres.low[axis], centres.high[axis]);
        Self {
            axis,
            low,
            scale: BINS as f64 * (1.0 - 1e-9) / (high - low),
        }
    }

    fn bin(&self, item: &Item) -> usize {
        (((item.bounds.middle2(self.axis) - self.low) * self.scale) as usize).min(BINS - 1)
    }
}

/// Axis and first bin behind the cut with the least expected cost; `None` if no cut separates anything.
fn cheapest(items: &[Item], centres: &Bounds) -> Option<(usize, usize)> {
    let mut best = (f64::INFINITY, None);
    for axis in 0..3 {
        if centres.high[axis] <= centres.low[axis] {
            continue;
        }
        let binning = Binning::new(centres, axis);
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for item in items {
            let (bounds, count) = &mut bins[binning.bin(item)];
            bounds.join(&item.bounds);
            *count += 1;
        }
        // What lies at or behind each bin.
        let mut behind = [(0.0, 0_usize); BINS + 1];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for bin in (0..BINS).rev() {
            bounds.join(&bins[bin].0);
            count += bins[bin].1;
            behind[bin] = (bounds.area(), count);
        }
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for bin in 1..BINS {
            bounds.join(&bins[bin - 1].0);
            count += bins[bin - 1].1;
            let (area_behind, count_behind) = behind[bin];
            if count == 0 || count_behind == 0 {
                continue;
            }
            let cost = bounds.area() * blocks(count) + area_behind * blocks(count_behind);
            if cost < best.0 {
                best = (cost, Some((axis, bin)));
            }
        }
    }
    best.1
}

/// What testing so many items costs: they go by fours.
fn blocks(count: usize) -> f64 {
    count.div_ceil(4) as f64
}

/// The greatest f32 below a coordinate.
fn below(coordinate: f64) -> f32 {
    (coordinate as f32).next_down()
}

/// The least f32 above a coordinate.
fn above(coordinate: f64) -> f32 {
    (coordinate as f32).next_up()
}
