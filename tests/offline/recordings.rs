//! Recordings of sensors and logs: clouds, contents, angles of other devices.

use super::*;

#[test]
fn files_other_than_recordings_are_refused() {
    let place = Place::new();
    std::fs::write(place.path("empty.pcap"), b"").unwrap();
    std::fs::write(
        place.path("text.pcap"),
        b"this is no recording at all, but it is long enough",
    )
    .unwrap();
    std::fs::write(place.path("other.pcap"), ping()).unwrap();
    for verb in ["info", "replay --tilt none"] {
        place.fails(&format!("{verb} missing.pcap"), 3, &["missing.pcap"]);
        place.fails(&format!("{verb} empty.pcap"), 3, &["empty"]);
        place.fails(&format!("{verb} text.pcap"), 3, &["pcap"]);
    }
    place.fails("replay --tilt none other.pcap", 3, &["no lidar"]);
    place.fails("info .", 3, &["name one recording in it"]);
    place.fails("replay --tilt missing.csv other.pcap", 3, &["missing.csv"]);
}

/// A classic pcap with one Ethernet frame of another protocol (ARP).
fn ping() -> Vec<u8> {
    let mut file = vec![0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0];
    file.extend([0; 8]);
    file.extend(65_535u32.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    let mut frame = vec![0xFF; 12];
    frame.extend([0x08, 0x06]);
    frame.extend([0; 46]);
    file.extend(1_600_000_000u32.to_le_bytes());
    file.extend([0; 4]);
    file.extend((frame.len() as u32).to_le_bytes());
    file.extend((frame.len() as u32).to_le_bytes());
    file.extend(frame);
    file
}

#[test]
fn ros_recordings_are_bags_and_keep_the_metadata_of_others() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let line = |options: &str| format!("replay {} --tilt none {options}", path.display());
    let metadata = || std::fs::read_to_string(place.path("metadata.yaml")).unwrap();
    assert!(place.run(&line("-o scan.mcap")).status.success());
    let first = metadata();
    assert!(first.contains("- \"scan.mcap\"\n"), "{first}");
    let words = &["scan.mcap", "--force"];
    place.fails(&line("-o scan.mcap"), 2, words);
    std::fs::write(place.path("metadata.yaml"), "files:\n  - scan.mcap\n").unwrap();
    assert!(place.run(&line("-o scan.mcap --force")).status.success());
    assert_eq!(metadata(), first);
    let output = place.run(&line("-o an.mcap"));
    assert!(output.status.success() && place.path("an.mcap").is_file());
    assert_eq!(metadata(), first);
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(printed.contains("belongs to another file"), "{printed}");
}

#[test]
fn a_real_recording_becomes_a_cloud() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let line = format!("replay {} --tilt none -o cloud.csv --json", path.display());
    let output = place.run(&line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let scan = json(&output);
    assert_eq!(scan["points"], 7_747);
    assert_eq!(scan["packets"]["data"], 26);
    assert_eq!(scan["packets"]["position"], 5);
    assert_eq!(scan["lost_packets"], 0);
    assert_eq!(scan["simulated"], false);
    // A plain recording has no tilt: an error, not a guess.
    place.fails(
        &format!("replay {}", path.display()),
        3,
        &["no tilt", "--tilt none"],
    );
}

/// Text of a cloud as CSV: comments and rows.
fn comments_and_rows(csv: &Path) -> (String, Vec<String>) {
    let text = std::fs::read_to_string(csv).unwrap();
    let (comments, rows): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with('#'));
    let rows = rows.into_iter().map(str::to_owned).collect();
    (comments.join("\n"), rows)
}

#[test]
fn a_georeferenced_cloud_is_in_east_north_up_in_every_format() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let replay = |options: &str| {
        let line = format!("replay {} --tilt none {options} --json", path.display());
        let output = place.run(&line);
        assert!(output.status.success(), "{options}: {output:?}");
        json(&output)
    };
    assert!(replay("-o plain.csv").get("georeference").is_none());
    let (_, plain) = comments_and_rows(&place.path("plain.csv"));
    let scan = replay("--georeference 90deg -o turned.csv");
    let georeference = &scan["georeference"];
    let degrees = |key: &str| georeference["origin"][key].as_f64().unwrap();
    assert!((degrees("latitude_deg") - 36.829_131).abs() < 1e-6);
    assert!((degrees("longitude_deg") + 2.407_572).abs() < 1e-6);
    assert_eq!(georeference["heading_deg"], 90.0);
    assert_eq!(georeference["pps"], "locked");
    // Its five position packets repeat one sentence.
    assert_eq!(
        (&georeference["fixes"], &georeference["spread_worst_m"]),
        (&1.into(), &0.0.into())
    );
    let (comments, turned) = comments_and_rows(&place.path("turned.csv"));
    for part in [
        "frame: x east, y north, z up in metres",
        "origin: 36.829131, -2.407572 deg (WGS 84), pulse locked",
        "heading: y forward was 90 deg clockwise from true north",
        "15 m (95 %)",
        "1 deg of heading is 349 mm at 20 m",
    ] {
        assert!(comments.contains(part), "no {part:?} in {comments}");
    }
    assert_eq!(plain.len(), turned.len());
    for (plain, turned) in plain.iter().zip(&turned).skip(1) {
        let split = |row: &str| {
            let mut cells = row.splitn(4, ',').map(str::to_owned);
            let axes = [0; 3].map(|_| cells.next().unwrap().parse::<f64>().unwrap());
            (axes, cells.next())
        };
        let (([x, y, z], rest), ([east, north, up], same)) = (split(plain), split(turned));
        assert!((east - y).abs() < 1e-12 && (north + x).abs() < 1e-12);
        assert_eq!((z, rest), (up, same));
    }
    // A heading of 0 changes nothing but the names of the axes.
    replay("--georeference 0 -o north.csv");
    assert_eq!(comments_and_rows(&place.path("north.csv")).1, plain);
    let read = |name: &str| {
        let path = place.path(name);
        let format = cloud::formats::Format::from_path(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let cloud = cloud::read::cloud(format, bytes, cloud::Fields::NONE).unwrap();
        cloud.positions
    };
    let expected = read("turned.csv");
    for format in cloud::formats::Format::ALL {
        let name = format!("turned.{format}");
        replay(&format!("--georeference=-270deg --force -o {name}"));
        let positions = read(&name);
        assert_eq!(positions.len(), expected.len(), "{format}");
        for (got, expected) in positions.iter().zip(&expected) {
            let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-4;
            assert!(got.iter().zip(expected).all(is_close), "{format}: {got:?}");
        }
    }
    // An organised frame has its rows turned, too.
    replay("--frames 0 --organised -o plain.pcd");
    replay("--georeference 90 --frames 0 --organised -o grid.pcd");
    let [plain, grid] = ["plain-00000.pcd", "grid-00000.pcd"].map(read);
    assert!(!plain.is_empty() && plain.len() == grid.len());
    for ([x, y, z], turned) in plain.iter().zip(&grid) {
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-4 || a.is_nan() && b.is_nan();
        let expected = [*y, -x, *z];
        assert!(turned.iter().zip(&expected).all(is_close), "{turned:?}");
    }
}

#[test]
fn a_georeference_needs_a_fix_and_a_heading() {
    let place = Place::new();
    let path = recording("vlp16-dual.pcap");
    let line = format!("replay {} --tilt none -o cloud.ply", path.display());
    let words = [
        "vlp16-dual.pcap",
        "--georeference",
        "valid fixes",
        "found none (position packets: 0)",
    ];
    place.fails(&format!("{line} --georeference 30deg"), 3, &words);
    for heading in ["north", "361", "30rad", "nan"] {
        let words = ["expected a heading from -360 to 360 degrees"];
        place.fails(&format!("{line} --georeference {heading}"), 2, &words);
    }
    let line = format!("replay {} -o copy.pcap --georeference 30", path.display());
    place.fails(&line, 2, &["--georeference is for clouds"]);
}

#[test]
fn a_recording_goes_from_stdin_to_stdout() {
    let output = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args(["replay", "-", "--tilt", "none", "-o", "-"])
        .stdin(std::fs::File::open(recording("vlp16-strongest-gps.pcap")).unwrap())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(output.stdout.starts_with(b"ply\n"));
}

/// A calling program learns of lost packets by its exit code, with `-q` too.
#[test]
fn a_recording_with_missing_packets_is_incomplete() {
    let whole = std::fs::read(recording("vlp16-strongest-gps.pcap")).unwrap();
    // Records of a pcap: 16 bytes of times and lengths, then the packet; 24 bytes of file header.
    let mut at = 24;
    let mut ends = Vec::new();
    while at < whole.len() {
        let length = u32::from_le_bytes(whole[at + 8..at + 12].try_into().unwrap()) as usize;
        at += 16 + length;
        ends.push(at);
    }
    let place = Place::new();
    let cut = [&whole[..ends[9]], &whole[ends[12]..]].concat();
    std::fs::write(place.path("cut.pcap"), cut).unwrap();
    let cloud = ("--tilt none -o cloud.ply", "cloud.ply");
    // A copy of the packets has the same gap.
    let copy = ("-o copy.pcap", "copy.pcap");
    for (options, made, quiet) in [
        (cloud.0, cloud.1, ""),
        (cloud.0, cloud.1, " -q"),
        (copy.0, copy.1, " -q"),
    ] {
        let line = format!("replay cut.pcap {options} --force{quiet}");
        let output = place.run(&line);
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(6), "{printed}");
        assert!(
            printed.contains("3 of 26 lidar packets are missing at 0.01"),
            "{printed}"
        );
        assert!(place.path(made).is_file());
    }
}

/// A lidar that is plugged in late, or whose cable comes out, leaves no gap between two packets.
#[test]
fn a_lidar_that_is_silent_at_an_end_of_the_sweep_is_incomplete() {
    let place = Place::new();
    let made = place.run("simulate room -o room.pcapng");
    assert!(made.status.success());
    let log = std::fs::read(place.path("room.pcapng")).unwrap();
    let word = |at: usize| u32::from_le_bytes(log[at..at + 4].try_into().unwrap()) as usize;
    let mut blocks = vec![0];
    while let Some(at) = blocks.last().copied().filter(|at| *at < log.len()) {
        blocks.push(at + word(at + 4));
    }
    // An enhanced packet block holds a data packet of 1206 bytes after headers of 42.
    let is_data = |at: usize| word(at) == 6 && word(at + 20) == 1_248;
    let data = blocks.windows(2).filter(|ends| is_data(ends[0])).count();
    for (first, kept, part) in [(200, data, "first"), (0, data - 200, "last")] {
        let (mut seen, mut cut) = (0, Vec::new());
        for ends in blocks.windows(2) {
            seen += usize::from(is_data(ends[0]));
            if !is_data(ends[0]) || (first < seen && seen <= kept) {
                cut.extend_from_slice(&log[ends[0]..ends[1]]);
            }
        }
        std::fs::write(place.path("cut.pcapng"), cut).unwrap();
        let silent = format!("no lidar packet arrived in the {part} 0.");
        let output = place.run("replay cut.pcapng -o cut.ply --force -q");
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(6), "{printed}");
        assert!(printed.contains(&silent), "{printed}");
    }
}

#[test]
fn info_names_the_sensor_and_its_position() {
    let place = Place::new();
    let gps = recording("vlp16-strongest-gps.pcap");
    let info = json(&place.run(&format!("info {} --json", gps.display())));
    assert_eq!(info["configuration"], serde_json::Value::Null);
    assert_eq!(info["sweeps"], serde_json::json!([]));
    assert!(
        info["sensor"].as_str().unwrap().ends_with(":2368"),
        "{info}"
    );
    assert_eq!(info["gps"]["pps"], "locked");
    for (key, range) in [
        ("latitude_deg", -90.0..90.0),
        ("longitude_deg", -180.0..180.0),
    ] {
        let value = info["gps"]["position"][key].as_f64().unwrap();
        assert!(range.contains(&value) && value != 0.0, "{info}");
    }
    let line = format!("replay {} --tilt none -o gps.ply", gps.display());
    assert!(place.run(&line).status.success(), "{line}");
    let cloud = std::fs::read(place.path("gps.ply")).unwrap();
    let head = String::from_utf8_lossy(&cloud[..2_000]).into_owned();
    let latitude = info["gps"]["position"]["latitude_deg"].as_f64().unwrap();
    let expected = format!("comment satellite receiver at {latitude:.6}, ");
    assert!(
        head.contains(&expected) && head.contains("pulse locked"),
        "{head}"
    );
}

#[test]
fn angles_of_another_device_can_be_attached() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    std::fs::write(
        place.path("angles.csv"),
        "time_s,angle_deg\n0.0,-10\n0.02,-20\n",
    )
    .unwrap();
    // Where the lidar is above the axis is not known.
    let line = format!(
        "replay {} --tilt angles.csv -o cloud.ply --json",
        path.display()
    );
    let own = place.path("velomotion.toml");
    std::fs::rename(&own, place.path("other-name.toml")).unwrap();
    place.fails(&line, 2, &["--mount"]);
    std::fs::rename(place.path("other-name.toml"), &own).unwrap();
    // This configuration has no mount, and an empty one does not say where the lidar is either.
    place.fails(&line, 3, &["velomotion.toml: expected [mount] with d_m"]);
    std::fs::write(place.path("empty.toml"), "[mount]\n").unwrap();
    place.fails(&format!("{line} --mount empty.toml"), 3, &["d_m"]);
    std::fs::write(place.path("other.toml"), "[mount]\nd_m = 0.25\n").unwrap();
    // The accuracy of these angles is not known.
    let uncertain = format!("{line} --mount other.toml --uncertainty");
    place.fails(&uncertain, 2, &["--uncertainty with --tilt"]);
    let output = place.run(&format!("{line} --mount other.toml"));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        printed.contains("mount of other.toml: the lidar is 0.25 m above"),
        "{printed}"
    );
    let scan = json(&output);
    assert_eq!(scan["sync"]["angle_bound_deg"], serde_json::Value::Null);
    assert!(!scan["warnings"].to_string().contains("drive"), "{scan}");
    place.fails(
        &format!("replay {} --tilt none --mount other.toml", path.display()),
        2,
        &["--mount", "--tilt none"],
    );
    // The configuration has a mount, too: the cloud is the same.
    let cloud = std::fs::read(place.path("cloud.ply")).unwrap();
    let again = place.run(&format!("{line} --config other.toml --force"));
    assert!(again.status.success());
    assert!(cloud == std::fs::read(place.path("cloud.ply")).unwrap());
    std::fs::write(place.path("low.toml"), "[mount]\nd_m = 0.05\n").unwrap();
    let lower = place.run(&format!(
        "{line} --mount low.toml --config other.toml --force"
    ));
    assert!(lower.status.success());
    assert!(cloud != std::fs::read(place.path("cloud.ply")).unwrap());
    // It also comes before the mount of a log.
    place.run("simulate room -o scan.pcapng");
    std::fs::write(place.path("turned.csv"), "0,-1\n60,-61\n").unwrap();
    let of_log = place.run("replay scan.pcapng --tilt turned.csv -o own.ply");
    assert!(of_log.status.success());
    let given = place.run("replay scan.pcapng --tilt turned.csv --config other.toml -o given.ply");
    let printed = String::from_utf8_lossy(&given.stderr).into_owned();
    assert!(printed.contains("mount of other.toml"), "{printed}");
    let clouds = ["own.ply", "given.ply"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert!(clouds[0] != clouds[1]);
    let points = scan["points"].as_u64().unwrap();
    let left_out = scan["left_out"].as_u64().unwrap();
    // The table covers 0.02 s of 0.0345 s: only points within it are placed.
    assert_eq!(points + left_out, 7_747);
    assert!((3_500..5_500).contains(&points), "{points}");
    std::fs::write(
        place.path("late.csv"),
        "time_s,angle_deg\n2e9,-10\n2.1e9,-20\n",
    )
    .unwrap();
    place.fails(
        &format!("replay {} --tilt late.csv --mount low.toml", path.display()),
        3,
        &["do not overlap"],
    );
    std::fs::write(place.path("bad.csv"), "time_s,angle_deg\n0.0,x\n").unwrap();
    place.fails(
        &format!("replay {} --tilt bad.csv", path.display()),
        3,
        &["bad.csv", "line 2"],
    );
}

/// Each file has its result and its error; one that fails does not stop the others.
#[test]
fn several_recordings_are_read_in_turn() {
    let place = Place::new();
    for name in ["vlp16-strongest-gps.pcap", "vlp16-dual.pcap"] {
        std::fs::copy(recording(name), place.path(name)).unwrap();
    }
    std::fs::write(place.path("empty.pcap"), b"").unwrap();
    let line = "info vlp16-strongest-gps.pcap empty.pcap vlp16-dual.pcap --json";
    let output = place.run(line);
    assert_eq!(output.status.code(), Some(3));
    let printed = String::from_utf8(output.stdout).unwrap();
    let objects: Vec<serde_json::Value> = printed
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let schemas: Vec<&str> = objects
        .iter()
        .map(|o| o["schema"].as_str().unwrap())
        .collect();
    assert_eq!(schemas, ["info-1", "error-1", "info-1"]);
    assert_eq!(objects[2]["return_mode"], "dual");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    for part in ["empty.pcap", "1 of 3 files failed"] {
        assert!(message.contains(part), "{message}");
    }

    let line = "replay vlp16-strongest-gps.pcap vlp16-dual.pcap --tilt none";
    place.fails(
        &format!("{line} -o both.ply"),
        2,
        &["-o both.ply", "2 recordings"],
    );
    let output = place.run(line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let twice = "replay vlp16-dual.pcap ./vlp16-dual.pcap --tilt none --force";
    place.fails(twice, 2, &["vlp16-dual.ply"]);
    for cloud in ["vlp16-strongest-gps.ply", "vlp16-dual.ply"] {
        assert!(place.path(cloud).is_file(), "{cloud}");
    }
}
