//! Preferences of a client: quality values in headers (RFC 9110, 12.4.2).

/// The quality that a header gives to the first of these names that it has, 0 without one.
pub(super) fn quality(header: &str, names: &[&str]) -> f64 {
    let of = |name: &&str| {
        header.split(',').find_map(|part| {
            let mut fields = part.split(';').map(str::trim);
            let is_it = fields.next()?.eq_ignore_ascii_case(name);
            let mut given = fields.filter_map(|field| field.split_once('='));
            let given = given.find(|(key, _)| key.trim().eq_ignore_ascii_case("q"));
            is_it.then(|| given.map_or(1.0, |(_, value)| value.trim().parse().unwrap_or(0.0)))
        })
    };
    names.iter().find_map(of).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qualities_are_those_of_the_first_name() {
        for (header, expected) in [
            ("gzip", 1.0),
            ("deflate, GZIP;q=0.5", 0.5),
            ("gzip;q=0, *", 0.0),
            ("*;q=0.2", 0.2),
            ("gzip ; Q = 0.3", 0.3),
            ("gzip;q=x", 0.0),
            ("br", 0.0),
            ("", 0.0),
        ] {
            assert_eq!(quality(header, &["gzip", "*"]), expected, "{header}");
        }
    }
}
