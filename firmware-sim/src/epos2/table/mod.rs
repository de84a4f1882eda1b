//! The dictionary's entries: index, subindex, type, access, factory value, limits and mappability, all 430 of them.
//!
//! The entries follow the device description (EDS) of an EPOS2 70/10 with firmware 2126h, one line an entry, in the order of
//! addresses; where it gives no factory value, the one is taken that a real unit was configured with. Objects whose function is
//! not simulated (data recorder, interpolation buffer, autotuning, analogue inputs...) are plain storage.

mod communication;
mod device;
mod manufacturer;

use super::entry::Entry;

/// How many entries there are.
pub(super) const COUNT: usize =
    communication::ENTRIES.len() + manufacturer::ENTRIES.len() + device::ENTRIES.len();

/// All entries.
pub(super) static TABLE: [Entry; COUNT] = {
    let mut all = [communication::ENTRIES[0]; COUNT];
    let parts: [&[Entry]; 3] = [
        &communication::ENTRIES,
        &manufacturer::ENTRIES,
        &device::ENTRIES,
    ];
    let (mut part, mut to) = (0, 0);
    while part < parts.len() {
        let mut from = 0;
        while from < parts[part].len() {
            all[to] = parts[part][from];
            from += 1;
            to += 1;
        }
        part += 1;
    }
    all
};

/// The device description has so many, and lookups are binary searches.
const _: () = {
    assert!(COUNT == 430);
    let parts: [&[Entry]; 3] = [
        &communication::ENTRIES,
        &manufacturer::ENTRIES,
        &device::ENTRIES,
    ];
    let mut last = 0;
    let mut part = 0;
    while part < parts.len() {
        let mut i = 0;
        while i < parts[part].len() {
            let address = parts[part][i].address;
            let key = (address.index as u32) << 8 | address.sub as u32;
            assert!(key > last, "the table is not in order");
            last = key;
            i += 1;
        }
        part += 1;
    }
};
