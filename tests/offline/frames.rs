//! `replay --frames`.

use super::*;

#[test]
fn long_file_names_are_not_wrapped() {
    let place = Place::new();
    let name = format!("{}.pcap", "a-b".repeat(30));
    let printed = place.run(&format!("info {name}")).stderr;
    assert!(String::from_utf8_lossy(&printed).contains(&name));
}

#[test]
fn frames_are_written_only_to_files() {
    let path = recording("vlp16-strongest-gps.pcap");
    let line = format!("replay {} --tilt none --frames 180 -o -", path.display());
    Place::new().fails(&line, 2, &["stdout takes one", "frame.ply"]);
}

#[test]
fn frames_are_cut_at_an_azimuth() {
    for wrong in ["400", "-361", "nan", "north"] {
        let output = Place::new().run(&format!("replay scan.pcap --frames {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("--frames"));
    }
}

#[test]
fn frames_in_utc_equal_the_cloud_in_utc() {
    // The cut covers azimuths of 119 to 243 deg.
    assert_frames_in_utc(&recording("vlp16-strongest-gps.pcap"), 2);
}

#[test]
#[ignore = "needs the whole recordings"]
fn frames_of_a_whole_recording_in_utc_equal_the_cloud_in_utc() {
    assert_frames_in_utc(&whole_recording("vlp16-strongest-gps.pcap"), 4);
}

fn assert_frames_in_utc(path: &Path, least: usize) {
    let rows = |bytes: Vec<u8>| {
        let mark = b"end_header\n";
        let at = bytes.windows(mark.len()).position(|w| w == mark).unwrap();
        bytes[at + mark.len()..].to_vec()
    };
    let place = Place::new();
    let input = path.display();
    for options in ["-o whole.ply", "--frames 180 -o frame.ply"] {
        let line = format!("replay {input} --tilt none --time utc {options}");
        assert!(place.run(&line).status.success());
    }
    let whole = rows(std::fs::read(place.path("whole.ply")).unwrap());
    let frames = (0..).map_while(|i| std::fs::read(place.path(&format!("frame-{i:05}.ply"))).ok());
    let frames: Vec<Vec<u8>> = frames.map(rows).collect();
    assert!(frames.len() >= least, "{}", frames.len());
    assert_eq!(frames.concat(), whole);
    let organised =
        format!("replay {input} --tilt none --time utc --frames 180 --organised -o o.pcd");
    assert!(place.run(&organised).status.success());
}

#[test]
fn revolutions_are_written_to_one_recording() {
    let path = recording("vlp16-2014-no-factory-bytes.pcap");
    let place = Place::new();
    let input = path.display();
    let line = format!("replay {input} --tilt none --frames 180 -o turns.mcap --json");
    let report = json(&place.run(&line));
    let bytes = std::fs::read(place.path("turns.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let stats = summary.stats.unwrap();
    let count = |topic: &str| {
        let channel = summary.channels.values().find(|c| c.topic == topic);
        stats.channel_message_counts[&channel.unwrap().id]
    };
    assert_eq!(report["clouds"], count("/velomotion/points"));
    assert!(report["clouds"].as_u64() > Some(3), "{report}");
    assert_eq!(count("/diagnostics"), 1);
}

/// Numbers of another recording's frames need not be those of this one.
#[test]
fn frames_of_two_recordings_do_not_mix() {
    let place = Place::new();
    std::fs::write(place.path("frame-00042.ply"), "").unwrap();
    let path = recording("vlp16-strongest-gps.pcap");
    let line = format!(
        "replay {} --tilt none --frames 180 -o frame.ply",
        path.display()
    );
    place.fails(&line, 2, &["frame-00042.ply exists already"]);
    assert!(place.run(&format!("{line} --force")).status.success());
}
