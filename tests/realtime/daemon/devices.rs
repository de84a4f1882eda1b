//! Devices that disappear and return.

use std::path::PathBuf;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex};

use daemon::Options;
use io::discover::{ConnectedDevices, Epos2Found};
use serde_json::json;
use units::Span;

use super::events::connect;
use super::rig::{Rig, printed, run, wait};
use crate::simulated_drive::Drive;

/// The device `bench` with these keys and a lidar port without a sender.
pub fn bench(options: &mut Options, keys: &str) {
    let free = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    let profile = format!(
        "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nlidar = '127.0.0.1'\ndata_port = {port}\nposition_port = {port}\n{keys}"
    );
    let own: engine::config::Config = toml::from_str(&profile).unwrap();
    options.config.device = own.device;
}

pub fn drive(rig: &Rig, wanted: &str) -> serde_json::Value {
    wait(wanted, || {
        let drive = rig.status()["drive"].clone();
        (drive["state"] == wanted).then_some(drive)
    })
}

#[test]
fn an_unplugged_drive_is_reported_and_found_again() {
    let table = tempfile::tempdir().unwrap();
    let link = table.path().join("epos");
    let rig = Rig::with("", |options| {
        bench(options, &format!("port = '{}'", link.display()));
    });
    let absent = drive(&rig, "absent");
    wait("why", || {
        rig.status()["drive"]["problem"]["help"]
            .as_str()
            .map(str::to_owned)
    });
    assert_eq!(absent["referenced"], false);
    let refused = rig.post("/api/v1/tilt/home", &json!({}));
    assert_eq!(refused.refused(409, "absent")["kind"], "no-device");

    let unit = Drive::plug(&link);
    let found = drive(&rig, "connected");
    assert_eq!(
        (&found["link"], &found["problem"]),
        (&json!("usb"), &json!(null))
    );
    // Without a lidar nothing moves, nothing is recorded, and no scan remains.
    let refused = rig.post("/api/v1/captures", &json!({"speed_deg_s": 10.0}));
    let printed = refused.refused(409, "no lidar");
    assert_eq!(printed["kind"], "no-device");
    assert!(
        printed["message"].as_str().unwrap().contains("no lidar"),
        "{printed}"
    );
    assert_eq!(rig.get("/api/v1/scans").json(), json!({"scans": []}));
    let lidar = rig.status()["lidar"].clone();
    assert_eq!(lidar["state"], "absent", "{lidar}");
    assert!(lidar["problem"]["help"].is_string());
    assert_eq!(
        rig.status()["drive"]["referenced"],
        false,
        "the axis must not move"
    );

    drop(unit);
    let gone = drive(&rig, "absent");
    assert!(gone["problem"]["help"].is_string(), "{gone}");
    let _unit = Drive::plug(&link);
    drive(&rig, "connected");
    assert_eq!(rig.daemon().state().service.connects(), 2);
}

#[test]
fn a_drive_is_found_on_any_port_after_reconnecting() {
    let table = tempfile::tempdir().unwrap();
    let units: Arc<Mutex<Vec<Epos2Found>>> = Arc::default();
    let on_the_bus = Arc::clone(&units);
    let rig = Rig::with("", |options| {
        bench(options, "");
        options.environment.plugged = Arc::new(move || ConnectedDevices {
            epos2: on_the_bus.lock().unwrap().clone(),
            ..ConnectedDevices::default()
        });
    });
    let plug = |port: Option<PathBuf>| {
        *units.lock().unwrap() = vec![Epos2Found {
            bus_place: "1-4".to_owned(),
            port,
        }];
    };
    let problem = |word: &str| {
        wait(word, || {
            let problem = rig.status()["drive"]["problem"].clone();
            problem.to_string().contains(word).then_some(problem)
        })
    };
    let looking = "no drive found yet: looking for an EPOS2";
    let absent = problem(looking);
    assert_eq!(absent["kind"], "no-device");
    assert!(
        absent["help"]
            .as_str()
            .unwrap()
            .contains("plug the EPOS2 in")
    );
    let metrics = rig.get("/metrics").text();
    assert!(
        metrics.contains("velomotion_drive_connected 0"),
        "{metrics}"
    );
    // Later requests get the same error.
    rig.get("/api/v1/tilt").refused(409, "status");
    for (path, body) in [
        ("/api/v1/tilt/home", json!({})),
        ("/api/v1/captures", json!({"speed_deg_s": 10.0})),
    ] {
        let refused = rig.post(path, &body);
        let refused = refused.refused(409, path);
        assert!(
            refused["message"].as_str().unwrap().starts_with(looking),
            "{refused}"
        );
    }
    let folder = rig.folder.path();
    let configure = |keys: &str| {
        let text = format!("[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\n{keys}");
        std::fs::write(folder.join("velomotion.toml"), text).unwrap();
    };
    configure("");
    for line in ["tilt status", "capture --speed 10 -o scan.ply"] {
        let output = run(folder, line);
        assert_eq!(
            output.status.code(),
            Some(4),
            "{line}: {}",
            printed(&output)
        );
        assert!(
            printed(&output).contains(looking),
            "{line}: {}",
            printed(&output)
        );
    }
    // An EPOS2 for which Linux makes no port.
    plug(None);
    problem("ftdi_sio");

    let first = table.path().join("ttyUSB0");
    let unit = Drive::plug(&first);
    plug(Some(first.clone()));
    let found = drive(&rig, "connected");
    assert_eq!(found["port"], first.display().to_string());
    for keys in [String::new(), format!("port = '{}'", first.display())] {
        // The daemon holds the port under every name: no other process can open it.
        configure(&keys);
        let output = run(folder, "tilt status --json");
        assert!(output.status.success(), "{keys}: {}", printed(&output));
    }

    units.lock().unwrap().clear();
    drop(unit);
    problem(looking);
    let second = table.path().join("ttyUSB1");
    let _unit = Drive::plug(&second);
    plug(Some(second.clone()));
    let found = drive(&rig, "connected");
    assert_eq!(found["port"], second.display().to_string());
    assert_eq!(found["problem"], json!(null));
}

#[test]
fn the_drive_is_reconnected_after_a_suspension() {
    let table = tempfile::tempdir().unwrap();
    let link = table.path().join("epos");
    let _unit = Drive::plug(&link);
    let slept = Arc::new(AtomicI64::new(0));
    let reported = Arc::clone(&slept);
    let rig = Rig::with("", |options| {
        bench(options, &format!("port = '{}'", link.display()));
        options.environment.suspended =
            Arc::new(move || Span::from_nanos(reported.load(Ordering::Relaxed)));
    });
    drive(&rig, "connected");
    assert_eq!(rig.post("/api/v1/tilt/home", &json!({})).status, 200);
    let service = &rig.daemon().state().service;
    let connects = || service.connects();
    let received = Arc::downgrade(&service.receiver().unwrap());
    let mut events = connect(rig.address, "?points=false").unwrap();
    // Less than half a second does not count as a suspension.
    slept.store(400_000_000, Ordering::Relaxed);
    let mut next = |wanted: &str| loop {
        // Pings arrive in between.
        let tungstenite::Message::Text(text) = events.read().unwrap() else {
            continue;
        };
        let event: serde_json::Value = serde_json::from_str(&text).unwrap();
        if event["type"] == "status" && event["status"]["drive"]["state"] == wanted {
            break event["status"]["drive"].clone();
        }
    };
    for _ in 0..3 {
        assert_eq!(next("connected")["referenced"], true);
    }
    assert_eq!(connects(), 1);
    slept.store(7_200_000_000_000, Ordering::Relaxed);
    // The axis may have been moved by hand and the drive may have lost its supply: its state is
    // read again.
    let unknown = next("absent");
    assert_eq!(
        (&unknown["referenced"], &unknown["angle_deg"]),
        (&json!(false), &json!(null))
    );
    let again = drive(&rig, "connected");
    assert_eq!(again["referenced"], true, "{again}");
    assert!(again["angle_deg"].is_number(), "{again}");
    assert_eq!(connects(), 2);
    // The lidar's sockets are new: the network may have dropped the group membership of the old
    // ones.
    wait("other sockets", || {
        let now = service.receiver()?;
        (!std::ptr::eq(received.as_ptr(), Arc::as_ptr(&now))).then_some(())
    });
    wait("the end of the old ones", || {
        received.upgrade().is_none().then_some(())
    });
}
