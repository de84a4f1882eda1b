//! True intersections of rays and triangles in double-double arithmetic ([`Dd`]).
//!
//! Cramer's rule on `origin + t direction = a + u (b - a) + v (c - a)`.

use analysis::k::Dd;

use super::kernels::{LANES, Patch};

type Three = [Dd; 3];

fn difference(a: [f64; 3], b: [f64; 3]) -> Three {
    [0, 1, 2].map(|axis| Dd::difference(a[axis], b[axis]))
}

fn cross(a: &Three, b: &Three) -> Three {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

fn dot(a: &Three, b: &Three) -> Dd {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A quotient, rounded to f64.
fn quotient(of: Dd, by: Dd) -> f64 {
    let first = of.hi / by.hi;
    let rest = of - by * Dd::of(first);
    first + rest.hi / by.hi
}

/// -1, 0 or 1.
fn sign(of: Dd) -> f64 {
    match of.hi == 0.0 {
        true => 0.0,
        false => of.hi.signum(),
    }
}

/// Distance along a ray to a triangle, including edges and corners; `None` for a miss and for a ray
/// in its plane.
fn triangle(from: [f64; 3], along: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> Option<f64> {
    let (ab, ac, off) = (difference(b, a), difference(c, a), difference(from, a));
    let along = along.map(Dd::of);
    let across = cross(&along, &ac);
    let whole = dot(&ab, &across);
    let around = cross(&off, &ab);
    let (u, v) = (dot(&off, &across), dot(&along, &around));
    let range = dot(&ac, &around);
    let side = sign(whole);
    let inside = [u, v, whole - u - v]
        .iter()
        .all(|weight| sign(*weight) * side >= 0.0);
    (inside && side != 0.0 && sign(range) * side > 0.0).then(|| quotient(range, whole))
}

/// The range of every ray, packet after packet, infinite for none.
pub fn ranges(patches: &[Patch<f64>]) -> Vec<[f64; LANES]> {
    let packets = patches
        .iter()
        .flat_map(|patch| patch.packets.iter().map(move |rays| (patch, rays)));
    packets
        .map(|(patch, rays)| {
            std::array::from_fn(|lane| {
                let [from, along] = [&rays.origin, &rays.direction]
                    .map(|of| of.each_ref().map(|axis| axis[lane % LANES]));
                let triangles = patch.triangles.iter();
                triangles
                    .filter_map(|corners| triangle(from, along, *corners))
                    .fold(f64::INFINITY, f64::min)
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::SeededNoise;

    use super::*;

    /// Integers are not rounded: the determinants fit i128.
    fn exact(from: [i128; 3], along: [i128; 3], [a, b, c]: [[i128; 3]; 3]) -> Option<(i128, i128)> {
        let minus = |p: [i128; 3], q: [i128; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let cross = |p: [i128; 3], q: [i128; 3]| {
            [(1, 2), (2, 0), (0, 1)].map(|(i, j): (usize, usize)| p[i] * q[j] - p[j] * q[i])
        };
        let dot = |p: [i128; 3], q: [i128; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        let (ab, ac, off) = (minus(b, a), minus(c, a), minus(from, a));
        let (across, around) = (cross(along, ac), cross(off, ab));
        let whole = dot(ab, across);
        let (u, v, range) = (dot(off, across), dot(along, around), dot(ac, around));
        let weights = [u, v, whole - u - v].map(|weight| weight * whole.signum());
        let hit = whole != 0 && weights.iter().all(|w| *w >= 0) && range * whole.signum() > 0;
        hit.then_some((range, whole))
    }

    #[test]
    fn the_reference_agrees_with_integer_arithmetic() {
        let mut chance = SeededNoise(3);
        // Numbers up to 2^26: products of three have 80 bits, more than an f64 holds. Small ones
        // make rays through edges and corners common.
        let mut whole = |bits: u32| {
            let size = (1_i64 << bits) as f64;
            i128::from(((chance.uniform() - 0.5) * size) as i64)
        };
        let (mut hits, mut on_edges) = (0, 0);
        for at in 0..4_000 {
            let bits = if at % 2 == 0 { 26 } else { 3 };
            let mut point = || std::array::from_fn(|_| whole(bits));
            let (from, corners): ([i128; 3], [[i128; 3]; 3]) =
                (point(), [point(), point(), point()]);
            let [a, b, c] = corners;
            // Towards a corner, the centre of the triangle, or anywhere.
            let along: [i128; 3] = match at % 3 {
                0 => std::array::from_fn(|i| a[i] - from[i]),
                1 => std::array::from_fn(|i| a[i] + b[i] + c[i] - 3 * from[i]),
                _ => point(),
            };
            let float = |p: [i128; 3]| p.map(|x| x as f64);
            let got = triangle(float(from), float(along), corners.map(float));
            let expected = exact(from, along, corners);
            assert_eq!(
                got.is_some(),
                expected.is_some(),
                "{from:?} {along:?} {corners:?}"
            );
            if let Some((got, (range, whole))) = got.zip(expected) {
                let expected = range as f64 / whole as f64;
                assert!(
                    (got - expected).abs() <= 4e-16 * expected,
                    "{got} {expected}"
                );
                hits += 1;
                on_edges += usize::from(at % 3 == 0);
            }
        }
        assert!(hits > 1_000 && on_edges > 300, "{hits} {on_edges}");
    }
}
