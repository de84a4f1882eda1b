//! The entries of the dictionary: index, subindex, type, access, factory value, limits and
//! mappability, all 430 of them.
//!
//! They follow the device description (EDS) of an EPOS2 70/10 with firmware 2126h, in the order of
//! addresses. Where it gives no factory value, the value of a real unit is used. Objects of
//! functions that are not simulated (data recorder, interpolation buffer, autotuning, analogue
//! inputs) are plain storage.

mod communication;
mod device;
mod manufacturer;

use super::entry::DictionaryEntry;

/// The number of entries in the device description.
pub(super) const COUNT: usize = 430;

const PARTS: [&[DictionaryEntry]; 3] = [
    communication::ENTRIES,
    manufacturer::ENTRIES,
    device::ENTRIES,
];

/// All entries, one per subindex, in order for binary search.
pub(super) static TABLE: [DictionaryEntry; COUNT] = {
    let mut all = [PARTS[0][0]; COUNT];
    let (mut part, mut to, mut last) = (0, 0, 0);
    while part < PARTS.len() {
        let mut from = 0;
        while from < PARTS[part].len() {
            let mut entry = PARTS[part][from];
            while entry.address.sub <= entry.last_sub {
                let key = (entry.address.index as u32) << 8 | entry.address.sub as u32;
                assert!(key > last, "the table is not in order");
                all[to] = entry;
                last = key;
                entry.address.sub += 1;
                to += 1;
            }
            from += 1;
        }
        part += 1;
    }
    assert!(to == COUNT);
    all
};
