//! SDO transfers of every kind: scripts for a transfer, for the simulated unit, and for both.

use crate::Seed;

/// Modes of `properties::sdo`.
const TRANSFER: u8 = 0;
const UNIT: u8 = 1;
const BOTH: u8 = 2;

/// Sends the pending request.
const SEND: [u8; 1] = [2];

pub fn seeds() -> Vec<Seed> {
    let mut seeds = Vec::new();
    let mut add = |name: &str, parts: &[&[u8]]| seeds.push((name.to_owned(), parts.concat()));
    let read = [0, 0];
    // Step 3 answers: kind, then its arguments.
    let expedited = [3, 2, 7, 1, 2, 3, 4];
    let announced = [3, 2, 3, 9];
    let first = [3, 3, 7, 1, 2, 3, 4, 5, 6, 7];
    let second = [3, 0x83, 2 | 8, 8, 9];
    let abort = [3, 7, 0, 0, 2, 6];
    add("read", &[&[TRANSFER], &read, &SEND, &expedited]);
    add(
        "segments",
        &[
            &[TRANSFER],
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
        &[&[TRANSFER], &read, &SEND, &announced, &SEND, &second],
    );
    add(
        "abort",
        &[&[TRANSFER], &read, &SEND, &abort, &read, &SEND, &expedited],
    );
    // Another transfer replaces one without an answer.
    let restarted: [&[u8]; 8] = [
        &[TRANSFER],
        &read,
        &SEND,
        &[0, 1],
        &SEND,
        &expedited,
        &expedited,
        &SEND,
    ];
    add("restarted", &restarted);
    let write = [1, 12, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9];
    let taken = [3, 5];
    add(
        "write",
        &[
            &[TRANSFER],
            &write,
            &SEND,
            &taken,
            &SEND,
            &[3, 6],
            &SEND,
            &[3, 0x86],
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
