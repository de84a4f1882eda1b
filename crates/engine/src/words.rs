//! Words of reports for people.

/// A number of things, for people: `1 sweep`, `2 sweeps`.
#[must_use]
pub fn counted(number: impl Into<u64>, noun: &str) -> String {
    match number.into() {
        1 => format!("1 {noun}"),
        number => format!("{number} {noun}s"),
    }
}
