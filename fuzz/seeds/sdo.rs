//! SDO transfers of every kind: scripts for the client, for the simulated unit, and for both.

use crate::Seed;

/// Modes of `properties::sdo`.
const CLIENT: u8 = 0;
const UNIT: u8 = 1;
const BOTH: u8 = 2;

/// After each of the client's steps: fetch the outcome.
const FETCH: u8 = 1;
/// Sends the pending frames.
const SEND: [u8; 2] = [2, FETCH];

pub fn seeds() -> Vec<Seed> {
    let mut seeds = Vec::new();
    let mut add = |name: &str, parts: &[&[u8]]| seeds.push((name.to_owned(), parts.concat()));
    let read = [0, 0, FETCH];
    // Step 5 answers: kind, then its arguments.
    let expedited = [5, 2, 7, 1, 2, 3, 4, FETCH];
    let announced = [5, 2, 3, 9, FETCH];
    let first = [5, 3, 7, 1, 2, 3, 4, 5, 6, 7, FETCH];
    let second = [5, 0x83, 2 | 8, 8, 9, FETCH];
    let abort = [5, 7, 0, 0, 2, 6, FETCH];
    let late = [3, 25, FETCH];
    add("read", &[&[CLIENT], &read, &SEND, &expedited]);
    add(
        "segments",
        &[
            &[CLIENT],
            &read,
            &SEND,
            &announced,
            &SEND,
            &first,
            &SEND,
            &second,
        ],
    );
    add(
        "toggle",
        &[&[CLIENT], &read, &SEND, &announced, &SEND, &second],
    );
    add(
        "abort",
        &[&[CLIENT], &read, &SEND, &abort, &read, &SEND, &expedited],
    );
    add(
        "late",
        &[
            &[CLIENT],
            &read,
            &SEND,
            &late,
            &SEND,
            &[0, 1, FETCH],
            &SEND,
            &expedited,
            &expedited,
        ],
    );
    let write = [1, 12, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9, FETCH];
    let taken = [5, 5, FETCH];
    add(
        "write",
        &[
            &[CLIENT],
            &write,
            &SEND,
            &taken,
            &SEND,
            &[5, 6, FETCH],
            &SEND,
            &[5, 0x86, FETCH],
        ],
    );
    // Step 1 sends a request to the unit: kind, object, arguments; step 0 advances time; else a
    // frame.
    let objects: Vec<u8> = (0..13)
        .flat_map(|object| [1, 0, object, 1, 2, 1, 0x82])
        .collect();
    add("unit-reads", &[&[UNIT], &objects]);
    add(
        "unit-writes",
        &[
            &[UNIT],
            &[
                1, 0x1E, 12, 1, 2, 3, 4, 0, 20, 1, 3, 6, 8, 1, 0x3C, 6, 1, 2, 3, 4, 5, 6, 7,
            ],
        ],
    );
    add(
        "unit-pdo",
        &[
            &[UNIT],
            &[
                2, 0x30, 1, 1, 0, 0, 0, 0, 0, 0, 0, 5, 2, 0x35, 6, 0, 2, 1, 0, 0, 0xF2,
            ],
        ],
    );
    let both: Vec<u8> = (0..13).flat_map(|object| [5, 1, object]).collect();
    add("both", &[&[BOTH], &both, &[0, 0x10, 12, 1, 2, 3, 4]]);
    seeds
}
