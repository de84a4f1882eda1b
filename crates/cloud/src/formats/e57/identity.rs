//! File identifiers that are equal for equal clouds and differ otherwise. E57 requires a globally
//! unique identifier, and the same log must give the same bytes.

use units::{Host, Stamp};

use crate::Summary;

/// FNV-1a in 128 bits.
struct Hash(u128);

impl Hash {
    const fn new() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte))
                .wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013B);
        }
    }
}

/// A UUID in braces (version 8: own rule, RFC 9562) of a cloud's description, count, bounds and
/// times.
pub(super) fn of(
    description: &[String],
    summary: Summary,
    times: [Option<Stamp<Host>>; 2],
) -> String {
    let mut hash = Hash::new();
    for line in description {
        hash.add(line.as_bytes());
        hash.add(b"\n");
    }
    hash.add(&summary.points.to_le_bytes());
    if let Some(bounds) = summary.bounds {
        for value in bounds.min_m.into_iter().chain(bounds.max_m) {
            hash.add(&value.to_le_bytes());
        }
    }
    for time in times.into_iter().flatten() {
        hash.add(&time.as_nanos().to_le_bytes());
    }
    let marks = (0xF << 76) | (0x3 << 62);
    let value = (hash.0 & !marks) | (0x8 << 76) | (0x2 << 62);
    let hex = format!("{value:032x}");
    let part = |from: usize, to: usize| hex.get(from..to).unwrap_or_default();
    format!(
        "{{{}-{}-{}-{}-{}}}",
        part(0, 8),
        part(8, 12),
        part(12, 16),
        part(16, 20),
        part(20, 32)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_uuid_version_8_and_depend_on_the_content() {
        let time = |ns| [None, Some(Stamp::from_nanos(ns))];
        let some = of(&["a".into()], Summary::default(), time(1));
        assert_eq!(some, of(&["a".into()], Summary::default(), time(1)));
        let others = [
            of(&["b".into()], Summary::default(), time(1)),
            of(&["a".into()], Summary::default(), time(2)),
            of(
                &["a".into()],
                Summary {
                    points: 1,
                    bounds: None,
                },
                time(1),
            ),
        ];
        assert!(!others.contains(&some));
        for id in others.iter().chain([&some]) {
            let marks: Vec<char> = [0, 9, 14, 15, 19, 20, 24, 37]
                .map(|i| id.chars().nth(i).unwrap())
                .into();
            assert_eq!(marks[0..4], ['{', '-', '-', '8'], "{id}");
            assert!(
                marks[4] == '-' && "89ab".contains(marks[5]) && marks[6..] == ['-', '}'],
                "{id}"
            );
        }
    }
}
