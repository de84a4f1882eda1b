//! Numbers in messages.

use core::fmt;

/// A number as it was given; 1e300 and 1e-300 would have hundreds of digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortNumber(pub f64);

impl fmt::Display for ShortNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.abs() {
            0.0 | 1e-4..1e6 => self.0.fmt(f),
            _ => write!(f, "{:e}", self.0),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::ToString;

    use super::ShortNumber;

    #[test]
    fn a_number_has_few_digits() {
        for (number, text) in [
            (0.0, "0"),
            (-45.0, "-45"),
            (0.3, "0.3"),
            (1e300, "1e300"),
            (-2.5e-300, "-2.5e-300"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(ShortNumber(number).to_string(), text);
        }
    }
}
