//! Construction of the tree by the surface area heuristic (MacDonald and Booth 1990; binned, Wald
//! 2007), eight children at a time.
//!
//! One input and one [`Quality`] give the same tree on any machine.

use super::bvh::{BoundingBox, Bvh, BvhNode, LEVELS, MOST_SHARING, leaf};

/// More places along an axis than this are not tried.
const MOST_BINS: usize = 64;

/// Effort for a tree of boxes. It changes the time of rays, never their hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Bins per axis between which cuts are tried, up to 64; the cut with the least expected cost
    /// is made. Below two, every cut goes through the middle of the triangles along their widest
    /// axis.
    pub bins: usize,
    /// Greatest number of triangles that share a box, 1 to 16.
    pub sharing: usize,
}

impl Quality {
    /// Quality for the triangles of a mesh. Rays take a sixth less time than with a box per
    /// triangle (docs/src/studies.md, Quality of the tree of boxes).
    pub const MESH: Self = Self {
        bins: 16,
        sharing: 4,
    };

    /// Quality for objects: each has a box, since a mesh takes longer than a box.
    pub(super) const OBJECTS: Self = Self {
        bins: 16,
        sharing: 1,
    };

    /// Within its bounds.
    fn clean(self) -> Self {
        Self {
            bins: self.bins.min(MOST_BINS),
            sharing: self.sharing.clamp(1, MOST_SHARING),
        }
    }
}

/// An item while the tree is built.
struct BuildItem {
    bounds: BoundingBox,
    id: u32,
}

/// Items that become one child.
struct BuildRange {
    begin: usize,
    end: usize,
    bounds: BoundingBox,
}

impl BuildRange {
    fn over(items: &[BuildItem], begin: usize, end: usize) -> Self {
        let mut bounds = BoundingBox::EMPTY;
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

pub(super) fn build(boxes: &[BoundingBox], quality: Quality) -> (Bvh, Vec<u32>) {
    let quality = quality.clean();
    let mut bins = Bins::new(quality.bins);
    let mut items: Vec<BuildItem> = boxes
        .iter()
        .zip(0..)
        .map(|(bounds, id)| BuildItem {
            bounds: *bounds,
            id,
        })
        .collect();
    let whole = BuildRange::over(&items, 0, items.len());
    let mut nodes = Vec::with_capacity(items.len() / 4 + 1);
    nodes.push(BvhNode::EMPTY);
    let mut jobs = vec![Job {
        node: 0,
        begin: 0,
        end: items.len(),
        level: 0,
    }];
    while let Some(job) = jobs.pop() {
        let parts = parts(&mut items, &job, &mut bins);
        let mut made = BvhNode::EMPTY;
        for (lane, part) in parts.iter().enumerate() {
            for axis in 0..3 {
                made.slabs[2 * axis][lane] = below(part.bounds.low[axis]);
                made.slabs[2 * axis + 1][lane] = above(part.bounds.high[axis]);
            }
            made.child[lane] = if part.len() <= quality.sharing {
                leaf(part.begin, part.len())
            } else {
                jobs.push(Job {
                    node: nodes.len(),
                    begin: part.begin,
                    end: part.end,
                    level: job.level + 1,
                });
                nodes.push(BvhNode::EMPTY);
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
fn parts(items: &mut [BuildItem], job: &Job, bins: &mut Bins) -> Vec<BuildRange> {
    let (begin, end) = (job.begin, job.end);
    if end - begin <= 8 {
        return (begin..end)
            .map(|at| BuildRange::over(items, at, at + 1))
            .collect();
    }
    // Cuts go through the middle where the best ones could make the tree too deep for the stack.
    let balanced = (end - begin - 1).ilog2() as usize / 3 + 1;
    let by_area = bins.can_cut() && job.level + balanced < LEVELS;
    let mut parts = vec![BuildRange::over(items, begin, end)];
    while parts.len() < 8 {
        let size = |part: &BuildRange| {
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
        let cut = cut(items, &part, by_area.then_some(&mut *bins));
        parts.push(BuildRange::over(items, part.begin, cut));
        parts.push(BuildRange::over(items, cut, part.end));
    }
    // In the order of the items, so that neighbours stay neighbours in memory.
    parts.sort_unstable_by_key(|part| part.begin);
    parts
}

/// Sorts the items of a part so that those before the result are one side of the best cut.
fn cut(items: &mut [BuildItem], part: &BuildRange, bins: Option<&mut Bins>) -> usize {
    let middle = part.begin + part.len() / 2;
    let Some(slice) = items.get_mut(part.begin..part.end) else {
        return middle;
    };
    let mut centres = BoundingBox::EMPTY;
    for item in slice.iter() {
        let centre = [0, 1, 2].map(|axis| item.bounds.middle2(axis));
        centres.join(&BoundingBox {
            low: centre,
            high: centre,
        });
    }
    if let Some(bins) = bins
        && let Some((axis, bin)) = bins.cheapest(slice, &centres)
    {
        let binning = Binning::new(&centres, axis, bins.count());
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

/// Assignment of items to bins by their centres.
struct Binning {
    axis: usize,
    low: f64,
    scale: f64,
    last: usize,
}

impl Binning {
    fn new(centres: &BoundingBox, axis: usize, bins: usize) -> Self {
        let (low, high) = (centres.low[axis], centres.high[axis]);
        Self {
            axis,
            low,
            scale: bins as f64 * (1.0 - 1e-9) / (high - low),
            last: bins.saturating_sub(1),
        }
    }

    fn bin(&self, item: &BuildItem) -> usize {
        (((item.bounds.middle2(self.axis) - self.low) * self.scale) as usize).min(self.last)
    }
}

/// Contents of each bin and of all bins from it on; the memory is reused for every cut.
struct Bins {
    of: Vec<(BoundingBox, usize)>,
    behind: Vec<(f64, usize)>,
}

impl Bins {
    fn new(count: usize) -> Self {
        Self {
            of: vec![(BoundingBox::EMPTY, 0); count],
            behind: vec![(0.0, 0); count],
        }
    }

    fn count(&self) -> usize {
        self.of.len()
    }

    /// Whether there is a place between two of them.
    fn can_cut(&self) -> bool {
        self.count() > 1
    }

    /// Axis and first bin behind the cut with the least expected cost; `None` if no cut separates
    /// anything.
    fn cheapest(&mut self, items: &[BuildItem], centres: &BoundingBox) -> Option<(usize, usize)> {
        let mut best = (f64::INFINITY, None);
        for axis in 0..3 {
            if centres.high[axis] <= centres.low[axis] {
                continue;
            }
            self.fill(items, &Binning::new(centres, axis, self.count()));
            let (mut bounds, mut count) = (BoundingBox::EMPTY, 0);
            let cuts = self.of.iter().zip(self.behind.iter().enumerate().skip(1));
            for ((of, of_count), (bin, &(area_behind, count_behind))) in cuts {
                bounds.join(of);
                count += of_count;
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

    fn fill(&mut self, items: &[BuildItem], binning: &Binning) {
        self.of.fill((BoundingBox::EMPTY, 0));
        for item in items {
            if let Some((bounds, count)) = self.of.get_mut(binning.bin(item)) {
                bounds.join(&item.bounds);
                *count += 1;
            }
        }
        let (mut bounds, mut count) = (BoundingBox::EMPTY, 0);
        for ((of, of_count), behind) in self.of.iter().zip(&mut self.behind).rev() {
            bounds.join(of);
            count += of_count;
            *behind = (bounds.area(), count);
        }
    }
}

/// Cost of testing this number of items, which go by fours.
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
