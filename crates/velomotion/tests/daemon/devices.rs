//! Devices that go and come back.

use serde_json::json;

use crate::rig::{Rig, wait};
use crate::software_drive::Drive;

fn drive(rig: &Rig, wanted: &str) -> serde_json::Value {
    wait(wanted, || {
        let drive = rig.status()["drive"].clone();
        (drive["state"] == wanted).then_some(drive)
    })
}

#[test]
fn a_drive_that_is_unplugged_is_missed_and_found_again() {
    let bench = tempfile::tempdir().unwrap();
    let link = bench.path().join("epos");
    let profile = format!(
        "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '{}'\nlidar = '127.0.0.1'\ndata_port = 1\n",
        link.display()
    );
    let rig = Rig::with("", |options| {
        let own: velomotion::config::Config = toml::from_str(&profile).unwrap();
        options.config.device = own.device;
        // A port that no lidar sends to.
        let free = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
        let port = free.local_addr().unwrap().port();
        let device = options.config.device.profiles.get_mut("bench").unwrap();
        (device.data_port, device.position_port) = (Some(port), Some(port));
    });
    let absent = drive(&rig, "absent");
    wait("why", || {
        rig.status()["drive"]["problem"]["help"]
            .as_str()
            .map(str::to_owned)
    });
    assert_eq!(absent["referenced"], false);
    let refused = rig.post("/api/v1/tilt/home", &json!({}));
    assert_eq!(refused.refused(409, "absent").json()["kind"], "no-device");

    let unit = Drive::plug(&link);
    let found = drive(&rig, "connected");
    assert_eq!(
        (&found["link"], &found["problem"]),
        (&json!("usb"), &json!(null))
    );
    // No lidar: nothing moves, nothing is recorded, and the scan says why.
    let scan = rig.scan(&json!({"speed_deg_s": 10.0}));
    assert_eq!(scan["state"], "failed", "{scan}");
    assert_eq!(scan["why"]["kind"], "no-device");
    assert!(
        scan["why"]["error"].as_str().unwrap().contains("no lidar"),
        "{scan}"
    );
    assert_eq!(scan["log_bytes"], json!(null));
    let lidar = rig.status()["lidar"].clone();
    assert_eq!(lidar["state"], "absent", "{lidar}");
    assert!(lidar["problem"]["help"].is_string());
    assert_eq!(
        rig.status()["drive"]["referenced"],
        false,
        "it was not to move"
    );

    drop(unit);
    let gone = drive(&rig, "absent");
    assert!(gone["problem"]["help"].is_string(), "{gone}");
    let _unit = Drive::plug(&link);
    drive(&rig, "connected");
    assert_eq!(
        rig.daemon()
            .shared()
            .counters
            .connects
            .load(std::sync::atomic::Ordering::Relaxed),
        2
    );
}
