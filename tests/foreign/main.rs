//! Foreign programs read velomotion's files.
//!
//! `VELOMOTION_PYTHON` names a python3 that has the packages of `requirements.txt`; tshark is
//! Debian's.

mod clouds;
mod ray_casting;
mod requests;
mod scenes;

use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use engine::config::AxisSettings;
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::devices::simulated_drive::{self, SimulatedPort};
use engine::reconstruct::lidar_copy;
use engine::reconstruct::source::Source;
use serde_json::Value;
use sim::Attachment;
use velomotion_tests::capture::{Captured, Setting};

/// Runs a program that must succeed. Returns its output.
fn run(mut command: Command) -> String {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// The Python interpreter of the tests.
fn python() -> Command {
    Command::new(std::env::var_os("VELOMOTION_PYTHON").unwrap_or_else(|| "python3".into()))
}

/// Runs a script of this folder. Returns the JSON object that it printed.
fn run_script(name: &str, arguments: &[&Path]) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("foreign");
    let mut command = python();
    command.arg(folder.join(name)).args(arguments);
    let printed = run(command);
    serde_json::from_str(&printed).unwrap_or_else(|error| panic!("{error} in {printed}"))
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn velodyne_decoder_decodes_our_log_to_the_same_points() {
    let scan = Captured::new(Setting::default());
    let sensor = scan.sensor_frame("sensor.csv");
    let result = run_script("velodyne_decoder_agrees.py", &[&scan.log(), &sensor]);
    assert_eq!(result["theirs"], result["ours"], "{result}");
    assert!(result["ours"].as_u64().unwrap() > 180_000, "{result}");
    assert_eq!(result["same_rings"], true, "{result}");
    let of = |name: &str| result[name].as_f64().unwrap();
    // Equal to 1 mm apart from azimuth. velodyne-decoder rounds azimuths to hundredths of a degree,
    // up to 3 mm at the hall's 17 m.
    assert!(of("max_difference_turned_m") < 1e-3, "{result}");
    assert!(of("their_azimuth_off_grid_deg") < 1e-4, "{result}");
    assert!(of("max_azimuth_difference_deg") < 0.0125, "{result}");
    assert!(
        of("near") > 10_000.0 && of("max_difference_near_m") < 1e-3,
        "{result}"
    );
}

#[test]
#[ignore = "needs tshark"]
fn tshark_reads_our_log_without_a_malformed_record() {
    let scan = Captured::new(Setting::default());
    let fields = [
        "-T",
        "fields",
        "-e",
        "frame.protocols",
        "-e",
        "udp.length",
        "-e",
        "_ws.malformed",
    ];
    let checks = [
        "-o",
        "ip.check_checksum:TRUE",
        "-o",
        "udp.check_checksum:TRUE",
    ];
    let mut command = Command::new("tshark");
    command
        .args(["-n", "-r"])
        .arg(scan.log())
        .args(fields)
        .args(checks);
    let printed = run(command);
    assert_eq!(printed.lines().count(), scan.records());
    let udp = printed
        .lines()
        .filter(|line| line.contains("\t1214"))
        .count();
    assert_eq!(udp as u64, scan.data_packets());
    let mut command = Command::new("tshark");
    command
        .args(["-n", "-r"])
        .arg(scan.log())
        .args(checks)
        .args([
            "-Y",
            "_ws.malformed || udp.checksum.status == 0 || ip.checksum.status == 0",
        ]);
    assert_eq!(run(command), "");
}

/// Programs of libpcap and others read no pcapng with two kinds of interfaces, but this.
#[test]
#[ignore = "needs tcpdump, and python3 with the packages of tests/foreign/requirements.txt"]
fn other_programs_read_the_lidar_of_our_log_as_pcap() {
    let scan = Captured::new(Setting::default());
    let pcap = scan.log().with_file_name("lidar.pcap");
    let source = Source::open(&scan.log(), None).unwrap();
    let copied = lidar_copy::copy(&source, &pcap, false, &AtomicBool::new(false)).unwrap();
    let mut command = Command::new("tcpdump");
    command.args(["-n", "-r"]).arg(&pcap);
    let printed = run(command);
    assert_eq!(printed.lines().count() as u64, copied.datagrams);
    let data = printed.lines().filter(|line| line.ends_with("length 1206"));
    assert_eq!(data.count() as u64, scan.data_packets());
    let read = run_script("velodyne_decoder_pcap.py", &[&pcap]);
    assert_eq!(read["measurements"], 384 * scan.data_packets(), "{read}");
}

/// tshark dissects the drive's traffic of a capture over CAN.
#[test]
#[ignore = "needs tshark"]
fn tshark_reads_the_can_traffic_of_a_capture_as_canopen() {
    let scan = Captured::new(Setting::over(Attachment::Can));
    let tshark = |arguments: &[&str]| {
        let mut command = Command::new("tshark");
        command
            .args(["-n", "-r"])
            .arg(scan.log())
            .args(["-d", "can.subdissector,canopen"])
            .args(arguments);
        run(command)
    };
    let printed = tshark(&["-Y", "canopen"]);
    let frames = printed.lines().count();
    assert!(frames > 1_500, "{frames}");
    // A SYNC has no data.
    assert_eq!(tshark(&["-Y", "can && !canopen && can.len > 0"]), "");
    assert_eq!(tshark(&["-Y", "_ws.malformed"]), "");
}

/// The dissector of the Debian package names the objects of a capture over USB and RS232.
#[test]
#[ignore = "needs tshark"]
fn tshark_reads_the_serial_traffic_of_a_capture_with_our_dissector() {
    let dissector = Path::new(env!("CARGO_MANIFEST_DIR")).join("../packaging/epos2.lua");
    for attachment in [Attachment::Usb, Attachment::Rs232] {
        let scan = Captured::new(Setting::over(attachment));
        let tshark = |filter: &str, field: &str| {
            let mut command = Command::new("tshark");
            command
                .arg("-X")
                .arg(format!("lua_script:{}", dissector.display()))
                .args(["-n", "-r"])
                .arg(scan.log())
                .args(["-Y", filter, "-T", "fields", "-e", field]);
            run(command)
        };
        let frames = |filter: &str| tshark(filter, "frame.number").lines().count();
        assert_eq!(frames("epos2"), frames("frame.interface_id == 1"));
        assert_eq!(tshark("_ws.lua.error || _ws.expert", "frame.number"), "");
        assert_eq!(frames("epos2.crc_good == 0"), 0, "{attachment:?}");
        let answered = frames("epos2.crc && epos2.opcode == 0");
        assert_eq!(answered, frames("epos2.request"), "{attachment:?}");
        let positions = tshark("epos2.index == 0x6064 && epos2.request", "epos2.value");
        let target = tshark(
            "epos2.index == 0x607a && epos2.opcode == 0x11",
            "epos2.value",
        );
        let [target, last] = [target.trim(), positions.lines().last().unwrap()];
        assert!(positions.lines().count() > 300, "{attachment:?}");
        let [target, last] = [target, last].map(|text| text.parse::<i32>().unwrap());
        assert!(
            target < -10_000 && last.abs_diff(target) < 20,
            "{target} {last}"
        );
    }
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn laspy_reads_our_laz_with_the_right_count_and_bounds() {
    let scan = Captured::new(Setting::default());
    let cloud = scan.cloud_file("cloud.laz");
    let result = run_script("laspy_reads.py", &[&cloud]);
    let summary = scan.cloud().summary();
    let bounds = summary.bounds.unwrap();
    assert_eq!(result["points"].as_u64(), Some(summary.points));
    for (name, wanted) in [("min", bounds.min_m), ("max", bounds.max_m)] {
        for (axis, wanted) in wanted.iter().enumerate() {
            // Steps of 0.1 mm.
            for of in [name.to_owned(), format!("header_{name}")] {
                let got = result[&of][axis].as_f64().unwrap();
                assert!(
                    (got - wanted).abs() < 1.01e-4,
                    "{of} {axis}: {got} {wanted}"
                );
            }
        }
    }
    assert_eq!(
        result["crs_records"],
        serde_json::json!([]),
        "coordinates are local"
    );
    assert_eq!(result["scales"], serde_json::json!([1e-4, 1e-4, 1e-4]));
    let dimensions = result["dimensions"].as_array().unwrap();
    for name in ["intensity", "ring", "time", "tilt"] {
        assert!(
            dimensions.iter().any(|d| d == name),
            "{name}: {dimensions:?}"
        );
    }
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn python_canopen_runs_our_simulated_drive_over_slcan() {
    let pty = io::port::Pty::open().unwrap();
    let port = pty.path().to_owned();
    let stop = Arc::new(AtomicBool::new(false));
    let stopping = Arc::clone(&stop);
    let axis = devices::axis(&AxisSettings::default()).unwrap();
    let node = simulated::node(&axis);
    let drive = std::thread::spawn(move || {
        simulated_drive::run(
            node,
            Attachment::Slcan,
            SimulatedPort::Serial(pty),
            &stopping,
        )
    });
    let seen = run_script("canopen_master.py", &[&port, Path::new("-10000")]);
    stop.store(true, Ordering::Relaxed);
    drive.join().unwrap().unwrap();
    assert_eq!(seen["name"], "EPOS2", "{seen}");
    assert_eq!(seen["vendor"], 0xFB, "{seen}");
    assert_eq!(seen["device_type"], 0x0002_0192, "{seen}");
    assert_eq!(seen["abort"], 0x0602_0000, "{seen}");
    assert_eq!(seen["states"].as_array().unwrap().len(), 3, "{seen}");
    assert_eq!(seen["homed_at"], 0, "{seen}");
    assert!(
        (seen["arrived_at"].as_i64().unwrap() + 10_000).abs() < 3,
        "{seen}"
    );
    assert_eq!(seen["tpdos"], 200, "{seen}");
    assert_eq!(seen["tpdo_times_never_fall"], true, "{seen}");
    assert!(
        seen["tpdo_positions_distinct"].as_u64().unwrap() > 50,
        "{seen}"
    );
    assert_eq!(seen["emcy"], 0xFF09, "{seen}");
    assert_eq!(seen["history"], 0xFF09, "{seen}");
    assert_eq!(seen["lss_selected"], true, "{seen}");
    assert_eq!(seen["lss_node_id"], 1, "{seen}");
    assert_eq!(seen["lss_moved_to"], 9, "{seen}");
    let homed = seen["homed"].as_object().unwrap();
    assert_eq!(homed.len(), 15, "{seen}");
    assert!(homed.values().all(|attained| attained == true), "{seen}");
    for (met, error) in [("limit_switch", 0xFF07), ("mechanical_stop", 0x8611)] {
        assert_eq!(seen[met]["received"], serde_json::json!([error]), "{seen}");
        assert_eq!(seen[met]["history"], serde_json::json!([error]), "{seen}");
    }
    assert_eq!(seen["enabled_again"], true, "{seen}");
}
