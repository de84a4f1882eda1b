//! Cosines of edges against arbitrary-precision fractions.

use num_rational::BigRational;

use super::super::dd::{COSINE_ERROR, Dd};

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

fn whole(of: &str) -> BigRational {
    of.parse().unwrap()
}

/// 10 to the power of 119.
fn scale() -> BigRational {
    whole(&format!("1{}", "0".repeat(119)))
}

/// pi to 120 digits.
fn pi() -> BigRational {
    let digits = "314159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706798214808651328230664";
    whole(digits) / scale()
}

/// All terms of the series down to 10^-100, each truncated to 119 digits.
pub(super) fn cosine(part: u32, parts: u32) -> BigRational {
    let cut = |x: BigRational| (x * scale()).trunc() / scale();
    let x = pi() * exact(f64::from(part)) / exact(f64::from(parts));
    let square = cut(&x * &x);
    let (mut term, mut sum) = (exact(1.0), exact(1.0));
    for n in 1..90 {
        term = cut(-term * &square / exact(f64::from((2 * n - 1) * 2 * n)));
        sum += &term;
    }
    sum
}

#[test]
fn cosines_are_within_their_stated_error() {
    let bound = exact(COSINE_ERROR);
    for whole in [1, 2, 3, 5, 7, 64, 150, 151, 180, 997, 32_768] {
        let step = (whole / 40).max(1);
        for part in (0..=whole).step_by(step as usize) {
            let of = Dd::cosine(part, whole);
            let off = exact(of.hi) + exact(of.lo) - cosine(part, whole);
            let off = if off < exact(0.0) { -off } else { off };
            assert!(off < bound, "cos({part}/{whole} pi) is off by {off}");
            assert_eq!(Dd::cosine(whole - part, whole), -of, "{part}/{whole}");
        }
    }
}
