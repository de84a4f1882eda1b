//! Position packets of the simulated sensor, and scripts that generate some.

use firmware_sim::vlp16::{Pps, position_packet};

use crate::Seed;

const SENTENCE: &[u8] = b"$GPRMC,083124,A,3650.4,N,00228.1,W,0.0,0.0,210116,1.1,W*63\r\n";

pub fn seeds() -> Vec<Seed> {
    let states = [Pps::Absent, Pps::Synchronising, Pps::Locked, Pps::Error];
    let mut seeds = Vec::new();
    for (state, pps) in (0..).zip(states) {
        for (name, sentence) in [("silent", &b""[..]), ("fix", SENTENCE)] {
            let packet = position_packet(1_082_337_235, pps, sentence);
            let name = format!("{name}-{state}");
            seeds.push((format!("packet-{name}"), [&[0], &packet[..]].concat()));
            let made = [&[1, 1, 2, 3, 4, state], sentence].concat();
            seeds.push((format!("made-{name}"), made));
        }
    }
    let body = &SENTENCE[1..SENTENCE.len() - 5];
    seeds.push(("sentence".to_owned(), [&[2], body].concat()));
    let cold = b"GPRMC,,V,,,,,,,,,,N";
    seeds.push(("sentence-cold".to_owned(), [&[2], &cold[..]].concat()));
    for (name, digits) in [
        ("leap-second", [23, 59, 60, 31, 12, 16, 0]),
        ("leap-day", [0, 0, 0, 29, 2, 96, 1]),
    ] {
        seeds.push((format!("date-{name}"), [&[3], &digits[..]].concat()));
    }
    seeds
}
