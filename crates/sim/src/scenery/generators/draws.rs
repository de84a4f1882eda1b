//! Random numbers of generators: SplitMix64 (Steele, Lea and Flood 2014), by turn; and smooth noise over the plane, by key.

/// Draws one after the other.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Draws(u64);

/// The odd number next to 2^64 divided by the golden ratio.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The seed of an object's generator: the scene's, and which object it is.
pub(in super::super) const fn seed(scene: u64, object: u64) -> u64 {
    mix(mix(scene.wrapping_add(GOLDEN)).wrapping_add((object + 1).wrapping_mul(GOLDEN)))
}

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// From 0 to below 1 by 53 bits.
const fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

impl Draws {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 to below 1.
    pub const fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        unit(mix(self.0))
    }

    /// Between two numbers.
    pub const fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.unit()
    }

    /// One of so many; 0 of none.
    pub const fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// Smooth noise over the plane, -1..1: random values at whole numbers, blended in between.
pub(super) fn noise(seed: u64, x: f64, y: f64) -> f64 {
    let at = |i: f64, j: f64| {
        let (i, j) = (i as i64 as u64, j as i64 as u64);
        let key = mix(seed.wrapping_add(i.wrapping_mul(GOLDEN)));
        2.0 * unit(mix(key.wrapping_add(j.wrapping_mul(GOLDEN)))) - 1.0
    };
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (s, t) = (ease(x - i), ease(y - j));
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let (low, high) = (
        mix(at(i, j), at(i + 1.0, j), s),
        mix(at(i, j + 1.0), at(i + 1.0, j + 1.0), s),
    );
    mix(low, high, t)
}

/// Noise of several sizes: each half as large and half as high as the one before.
pub(super) fn rough(seed: u64, x: f64, y: f64) -> f64 {
    let (mut sum, mut height, mut fine) = (0.0, 0.5, 1.0);
    for octave in 0..4 {
        sum += height * noise(seed.wrapping_add(octave), x * fine, y * fine);
        height *= 0.5;
        fine *= 2.0;
    }
    sum
}
