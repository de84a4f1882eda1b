//! Numbers with three significant digits.

/// Three significant digits: plain between 0.001 and 100,000, otherwise as a power of ten.
#[must_use]
pub fn short(x: f64) -> String {
    if !x.is_finite() {
        return "-".to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let rounded = format!("{x:.2e}");
    let (digits, power) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    match power {
        -3..=1 => {
            let decimals = usize::try_from(2 - power).unwrap_or(0);
            let plain = format!("{x:.decimals$}");
            plain.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        2..=4 => format!("{x:.0}"),
        _ => {
            let digits = match digits.contains('.') {
                true => digits.trim_end_matches('0').trim_end_matches('.'),
                false => digits,
            };
            format!("{digits}e{power}")
        }
    }
}

/// A power of ten as an axis label.
#[must_use]
pub fn decade(power: i32) -> String {
    match power {
        -3..=4 => short(10_f64.powi(power)),
        _ => {
            let raised: String = power.to_string().chars().map(raised).collect();
            format!("10{raised}")
        }
    }
}

const fn raised(c: char) -> char {
    match c {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁻',
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.586, "0.586"),
            (0.5859, "0.586"),
            (9.996, "10"),
            (99.96, "100"),
            (999.6, "1000"),
            (12_345.6, "12346"),
            (123_456.0, "1.23e5"),
            (5.208e-4, "5.21e-4"),
            (0.00521, "0.00521"),
            (1e-6, "1e-6"),
            (2.5, "2.5"),
            (-20.0, "-20"),
            (900.1, "900"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(short(x), text);
        }
        assert_eq!(decade(-6), "10⁻⁶");
        assert_eq!(decade(-3), "0.001");
        assert_eq!(decade(12), "10¹²");
    }

    proptest! {
        #[test]
        fn printed_numbers_are_within_half_a_percent(x in -1e12..1e12_f64, power in -20..20_i32) {
            let x = x * 10_f64.powi(power);
            let back: f64 = short(x).parse().unwrap();
            prop_assert!((back - x).abs() <= 5.01e-3 * x.abs(), "{} {}", x, back);
        }
    }
}
