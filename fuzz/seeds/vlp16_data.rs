//! Scripts of a simulated sensor: in order, late, lost, damaged, across the hour, with a limited
//! field of view.

use crate::Seed;

pub fn seeds() -> Vec<Seed> {
    // Step: bits 0 and 1 time (0 on time), bits 2 to 5 kind (0 to 5 a packet), the rest its
    // variant.
    let head = |host_ns: i64, stamp_us: u32, options: u8| {
        let mut script = host_ns.to_le_bytes().to_vec();
        script.extend(stamp_us.to_le_bytes());
        script.push(options);
        script
    };
    let at = 1_795_000_000_000_000_000;
    let what = |kind: u8| kind << 2;
    let steps: [(&str, Vec<u8>); 11] = [
        ("in-time", vec![0; 12]),
        ("dual", [&[what(10)][..], &[0; 8]].concat()),
        ("lost", vec![0, 0, 3, 5, 0, 0, 0, 0, 0, 0]),
        (
            "late",
            vec![0, 0, 1, 0x5E, 0x0A, 1, 0xA2, 0xF5, 1, 0x5E, 0x0A, 0, 0],
        ),
        ("twice", vec![0, what(12) | 1, 0, 0, 0, 0]),
        ("set", vec![0, 0, 2, 0, 0, 9, 9, 0, 0, 0, 0]),
        (
            "damaged",
            vec![0, what(14), 0, 0, 1, 0, what(14), 0xC8, 0, 0xFF, 0],
        ),
        ("gap", vec![0, what(15), 5, 0x10, 0x27, 0, 0]),
        (
            "other-model",
            vec![0, what(9) | 0x40, 0, 0, 0, what(9) | 0x80, 0, 0],
        ),
        (
            "other-mode",
            vec![0, what(8) | 0x40, 0, what(8) | 0xC0, 5, 0, 0],
        ),
        ("foreign", vec![0, what(13), 3, 1, 2, 3, 0]),
    ];
    let mut seeds = Vec::new();
    for (name, steps) in &steps {
        for (start, stamp_us, options) in [
            ("hour", 3_599_998_000, 0),
            ("mid", 1_082_337_235, 16),
            ("known", 0, 7),
        ] {
            let script = [head(at, stamp_us, options), steps.clone()].concat();
            seeds.push((format!("{name}-{start}"), script));
        }
    }
    seeds.push((
        "ends-of-time".to_owned(),
        [head(i64::MAX, 0, 0), vec![0; 4], vec![what(11); 20]].concat(),
    ));
    seeds
}
