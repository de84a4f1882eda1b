//! Recordings with changed packets.

use super::*;

/// The file header of a classic pcap, and its records.
fn records(pcap: &[u8]) -> (Vec<u8>, Vec<Vec<u8>>) {
    let (head, mut rest) = pcap.split_at(24);
    let mut records = Vec::new();
    while rest.len() >= 16 {
        let len = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
        let (record, after) = rest.split_at(16 + len);
        records.push(record.to_vec());
        rest = after;
    }
    (head.to_vec(), records)
}

/// Writes `recording` with its records changed.
fn changed(place: &Place, recording: &Path, change: impl FnOnce(&mut Vec<Vec<u8>>)) -> PathBuf {
    let (head, mut records) = records(&std::fs::read(recording).unwrap());
    change(&mut records);
    let path = place.path("changed.pcap");
    std::fs::write(&path, [head, records.concat()].concat()).unwrap();
    path
}

/// Offset of the UDP payload in an Ethernet record.
const PAYLOAD: usize = 16 + 42;

#[test]
fn a_stray_first_datagram_is_not_mistaken_for_the_lidar() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let input = changed(&place, &path, |records| {
        let data = records.iter().find(|r| r.len() == PAYLOAD + 1206).unwrap();
        let mut stray = data[..PAYLOAD + 40].to_vec();
        stray[8] = 82;
        stray[9] = 0;
        stray[12] = 82;
        stray[13] = 0;
        // IP total length, UDP length, last byte of the source address.
        stray[16 + 16..16 + 18].copy_from_slice(&68_u16.to_be_bytes());
        stray[16 + 38..16 + 40].copy_from_slice(&48_u16.to_be_bytes());
        stray[16 + 29] ^= 1;
        records.insert(0, stray);
    });
    let line = format!("replay {} --tilt none -o cloud.ply --json", input.display());
    assert_eq!(json(&place.run(&line))["points"], 7_747);
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["returns"], 7_747);
    assert_eq!(found["packets"]["malformed"], 1);
}

#[test]
fn position_packets_before_the_data_are_used() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let is_position = |record: &Vec<u8>| record.len() == PAYLOAD + 512;
    let input = changed(&place, &path, |records| {
        let at = records.iter().position(is_position).unwrap();
        let position = records.remove(at);
        records.insert(0, position);
    });
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["packets"]["position"], 5);
    assert_eq!(found["returns"], 7_747);
    let input = changed(&place, &path, |records| records.retain(is_position));
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["packets"]["position"], 5);
}

#[test]
fn packets_out_of_order_keep_utc() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let points = |input: &Path| {
        let options = "--tilt none --time utc -o cloud.ply --force --json";
        let line = format!("replay {} {options}", input.display());
        json(&place.run(&line))["points"].as_u64().unwrap()
    };
    let all = points(&path);
    let input = changed(&place, &path, |records| {
        for at in [5, 10, 15, 20] {
            records.swap(at, at + 1);
        }
    });
    assert_eq!(points(&input), all);
}

/// A packet that comes after its successor is put before it, and is no gap.
#[test]
fn packets_that_overtake_each_other_are_not_missing() {
    let whole = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let input = changed(&place, &whole, |records| records.swap(9, 10));
    let line = format!("replay {} --tilt none -o cloud.ply --json", input.display());
    let output = place.run(&line);
    let scan = json(&output);
    assert_eq!(
        (output.status.code(), &scan["points"]),
        (Some(0), &7_747.into())
    );
    assert_eq!(
        (&scan["lost_packets"], &scan["packet_gaps"]),
        (&0.into(), &serde_json::Value::Null)
    );
}

#[test]
fn dual_returns_are_labelled() {
    let path = recording("vlp16-dual.pcap");
    let place = Place::new();
    for (more, counts) in [
        ("", [0, 0, 4, 1_508, 2]),
        ("--equal-returns twice", [0, 0, 4, 3_016, 2]),
    ] {
        let options = format!("--tilt none --echo --force -o cloud.csv {more}");
        assert!(
            place
                .run(&format!("replay {} {options}", path.display()))
                .status
                .success()
        );
        let text = std::fs::read_to_string(place.path("cloud.csv")).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        assert!(lines.next().unwrap().ends_with(",echo"));
        let mut seen = [0; 5];
        for line in lines {
            let code: usize = line.rsplit(',').next().unwrap().parse().unwrap();
            seen[code] += 1;
        }
        assert_eq!(seen, counts, "{more}");
    }
}

#[test]
fn one_origin_omits_the_laser_offsets() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let line = format!(
        "replay {} --tilt none --one-origin -o cloud.csv",
        path.display()
    );
    assert!(place.run(&line).status.success());
    let text = std::fs::read_to_string(place.path("cloud.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let z: f64 = rows
        .map(|row| row.split(',').nth(2).unwrap().parse::<f64>().unwrap())
        .sum();
    // The sum of z by independent decoders.
    assert!((z / 544.269 - 1.0).abs() < 1e-4, "{z}");
}

/// Of the pulses of `dual_returns_are_labelled` two have two returns with a distance.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn laspy_reads_the_return_numbers_of_dual_mode() {
    let path = recording("vlp16-dual.pcap");
    let place = Place::new();
    for output in ["-o cloud.las", "--frames 0 -o frame.las"] {
        let line = format!("replay {} --tilt none {output}", path.display());
        assert!(place.run(&line).status.success());
    }
    let python = std::env::var_os("VELOMOTION_PYTHON").unwrap_or_else(|| "python3".into());
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/foreign/laspy_reads.py"
    );
    // Number, of how many, points.
    let expected = serde_json::json!([[1, 1, 1_510], [1, 2, 2], [2, 2, 2]]);
    for cloud in ["cloud.las", "frame-00000.las"] {
        let mut read = Command::new(&python);
        let read = read.arg(script).arg(place.path(cloud));
        assert_eq!(
            json(&read.output().unwrap())["returns"],
            expected,
            "{cloud}"
        );
    }
}
