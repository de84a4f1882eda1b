//! Nanoseconds as f64 seconds, rounded once.

const NS_PER_S: i64 = 1_000_000_000;

/// `ns` nanoseconds in seconds. Whole seconds and fraction are converted separately, so that only
/// their sum is rounded; `ns as f64 * 1e-9` rounds three times.
pub(super) fn seconds(ns: i64) -> f64 {
    let whole = ns.div_euclid(NS_PER_S) as f64;
    let fraction = ns.rem_euclid(NS_PER_S) as f64 / NS_PER_S as f64;
    whole + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard library's parser rounds decimals exactly.
    #[test]
    fn seconds_are_the_nearest_f64_on_both_sides_of_zero() {
        for (ns, decimal) in [
            (1_700_000_000_123_456_789, "1700000000.123456789"),
            (4_102_444_799_999_999_999, "4102444799.999999999"),
            (-1_700_000_000_123_456_789, "-1700000000.123456789"),
            (-1_500_000_000, "-1.5"),
            (0, "0"),
        ] {
            assert_eq!(seconds(ns), decimal.parse::<f64>().unwrap(), "{ns}");
        }
    }
}
