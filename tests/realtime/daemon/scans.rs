//! Scans on disk: listed, downloaded, deleted, found after a restart.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use cloud::formats::Format;
use daemon::{Daemon, Options, disk_quota};
use serde_json::json;
use units::Span;

use super::rig::{Process, Rig, finished, place, request, run, sweep, wait};

#[test]
fn a_scan_is_listed_downloaded_like_its_replay_and_deleted() {
    let rig = Rig::new();
    rig.ready();
    let scan = rig.whole_scan(&json!({"speed_deg_s": 56.25, "name": "hall"}));
    let id = scan["id"].as_str().unwrap();
    assert!(id.starts_with("hall-simulated-"), "{id}");
    assert_eq!(scan["simulated"], true);
    assert_eq!(scan["report"]["points"], scan["points"]);
    assert!(
        scan["report"]["truth"]["rms_m"].as_f64().unwrap() < 0.05,
        "{scan}"
    );
    let list = rig.get("/api/v1/scans").json();
    assert_eq!(list["scans"][0]["id"], id);
    assert_eq!(
        rig.status()["disk"]["scans"].as_u64(),
        Some(list["scans"].as_array().unwrap().len() as u64)
    );

    let log = rig.get(&format!("/api/v1/scans/{id}/log"));
    assert_eq!(log.body, std::fs::read(rig.log(id)).unwrap());
    downloads_go_on_where_they_ended(&rig, &format!("/api/v1/scans/{id}/log"), &log.body);
    let folder = rig.folder.path();
    for (query, option, extension) in [
        ("", "", "ply"),
        (
            "?format=ply&uncertainty=true&echo=true&laser=true",
            "--uncertainty --echo --laser",
            "ply",
        ),
        ("?format=pcd", "", "pcd"),
        ("?format=las", "", "las"),
        ("?format=laz&uncertainty=true", "--uncertainty", "laz"),
        ("?format=CSV", "", "csv"),
    ] {
        let cloud = rig.get(&format!("/api/v1/scans/{id}/cloud{query}"));
        assert_eq!(cloud.status, 200, "{query}: {}", cloud.text());
        assert!(
            cloud.head.contains(&format!("{id}.{extension}\"")),
            "{}",
            cloud.head
        );
        // Also made ones, which are made again.
        if ["ply", "csv"].contains(&extension) {
            let path = format!("/api/v1/scans/{id}/cloud{query}");
            downloads_go_on_where_they_ended(&rig, &path, &cloud.body);
        }
        let file = folder.join(format!("again.{extension}"));
        let line = format!(
            "replay {} -o {} --force {option}",
            rig.log(id).display(),
            file.display()
        );
        assert!(run(folder, &line).status.success(), "{line}");
        assert!(
            cloud.body == std::fs::read(&file).unwrap(),
            "{query}: differs from the replay"
        );
    }
    let wrong = rig.get(&format!("/api/v1/scans/{id}/cloud?format=nonsense"));
    assert!(wrong.refused(400, "format").to_string().contains(" laz "));
    rig.get(&format!("/api/v1/scans/{id}/cloud?formt=ply"))
        .refused(400, "misspelt");
    let picture = rig.get(&format!("/api/v1/scans/{id}/thumbnail"));
    assert_eq!(picture.status, 200);
    assert!(picture.body.starts_with(b"\x89PNG"));

    let path = format!("/api/v1/scans/{id}");
    assert_eq!(request(rig.address, "DELETE", &path, "", "").status, 204);
    request(rig.address, "DELETE", &path, "", "").refused(404, "deleted");
    rig.get(&path).refused(404, "deleted");
    assert!(!rig.log(id).exists());
}

/// A second request for what is missing of a file; none of it twice, none of another version.
fn downloads_go_on_where_they_ended(rig: &Rig, path: &str, whole: &[u8]) {
    let get = |headers: &str| request(rig.address, "GET", path, headers, "");
    let head = get("").head;
    assert!(head.contains("accept-ranges: bytes"), "{head}");
    let tag = head
        .lines()
        .find_map(|line| line.strip_prefix("etag: "))
        .unwrap();
    let rest = get(&format!("range: bytes=1000-\r\nif-range: {tag}\r\n"));
    assert_eq!((rest.status, &*rest.body), (206, &whole[1_000..]));
    let place = format!(
        "content-range: bytes 1000-{}/{}",
        whole.len() - 1,
        whole.len()
    );
    assert!(rest.head.contains(&place), "{}", rest.head);
    let changed = get("range: bytes=1000-\r\nif-range: \"older\"\r\n");
    assert_eq!((changed.status, &*changed.body), (200, whole));
    get("range: bytes=99999999999-\r\n").refused(416, "beyond the end");
    assert_eq!(get(&format!("if-none-match: {tag}\r\n")).status, 304);
}

#[test]
fn a_stopped_scan_is_partial_and_kept() {
    let mut rig = Rig::new();
    let id = sweep(rig.address);
    let path = format!("/api/v1/scans/{id}");
    request(rig.address, "DELETE", &path, "", "").refused(409, "while it is made");
    rig.get(&format!("{path}/cloud"))
        .refused(409, "while it is made");
    let stopped = rig.post("/api/v1/captures/stop", &json!({})).json();
    assert_eq!(
        (&stopped["stopped"], &stopped["scan"]),
        (&json!(true), &json!(id))
    );
    let scan = rig.finished(&id);
    assert_eq!(scan["state"], "partial", "{scan}");
    assert_eq!(scan["why"]["kind"], "interrupted");
    assert!(scan["points"].as_u64().unwrap() > 0, "{scan}");
    assert_eq!(
        rig.post("/api/v1/captures/stop", &json!({})).json()["stopped"],
        false
    );

    // The end of the daemon interrupts another sweep; the next daemon finds it.
    let second = sweep(rig.address);
    let config = rig.daemon().state().service.config().clone();
    rig.daemon.take().unwrap().stop(|| false).unwrap();
    let folder = rig.folder.path().to_owned();
    let again = Daemon::start(Options {
        config,
        listen: Some("127.0.0.1:0".parse().unwrap()),
        runtime: Some(folder),
        ..Options::default()
    })
    .unwrap();
    let second = again.state().scans.whole(&second).unwrap();
    assert!(second.scan.points > Some(0), "{second:?}");
    let why = second.scan.head.why.unwrap();
    assert!(why.message.contains("the daemon was stopped"), "{why:?}");
    again.stop(|| false).unwrap();
}

#[test]
fn a_scan_is_recovered_after_the_daemon_was_killed() {
    let folder = place();
    let daemon = Process::start(folder.path());
    let id = sweep(daemon.address);
    let log = folder
        .path()
        .join("velomotion/scans")
        .join(&id)
        .join("log.pcapng");
    // The last half second of a log may be lost: the log must hold more of the sweep.
    wait("a log", || {
        (std::fs::metadata(&log).ok()?.len() > 4_000_000).then_some(())
    });
    daemon.signal("-KILL");
    drop(daemon);
    let again = Process::start(folder.path());
    let scan = finished(again.address, &id);
    assert_eq!(scan["state"], "partial", "{scan}");
    assert!(
        scan["why"]["message"]
            .as_str()
            .unwrap()
            .contains("in the middle of this scan")
    );
    assert!(scan["points"].as_u64().unwrap() > 0);
    assert_eq!(scan["asked"]["speed_deg_s"], 5.0);
    // A second daemon finds the device in use.
    let second = run(folder.path(), "daemon --listen 127.0.0.1:0");
    assert_eq!(
        second.status.code(),
        Some(4),
        "{}",
        super::rig::printed(&second)
    );
    again.signal("-TERM");
    let mut again = again;
    assert_eq!(again.child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_truncated_log_does_not_count_as_a_complete_scan() {
    let mut rig = Rig::new();
    rig.ready();
    let id = rig.whole_scan(&json!({"speed_deg_s": 56.25}))["id"].clone();
    let id = id.as_str().unwrap();
    let config = rig.daemon().state().service.config().clone();
    rig.daemon.take().unwrap().stop(|| true).unwrap();
    // The state after a power cut during the construction of a cloud, on a disk that confirmed the
    // log and lost it. The folder also holds other files.
    let place = rig.log(id).parent().unwrap().to_owned();
    let record = std::fs::read_to_string(place.join("scan.json")).unwrap();
    let making = record.replacen("\"whole\"", "\"making\"", 1);
    assert_ne!(making, record);
    std::fs::write(place.join("scan.json"), making).unwrap();
    let log = std::fs::File::options()
        .write(true)
        .open(rig.log(id))
        .unwrap();
    log.set_len(log.metadata().unwrap().len() * 4 / 5).unwrap();
    for name in ["photo.jpg", "notes.partial", ".cloud.ply.1-0.partial"] {
        std::fs::write(place.join(name), name).unwrap();
    }
    let again = Daemon::start(Options {
        config,
        listen: Some("127.0.0.1:0".parse().unwrap()),
        runtime: Some(rig.folder.path().to_owned()),
        ..Options::default()
    })
    .unwrap();
    let scan = finished(again.address(), id);
    assert_eq!(scan["state"], "partial", "{scan}");
    let why = scan["why"]["message"].as_str().unwrap();
    assert!(
        why.contains("the log is incomplete") && why.contains("cut short"),
        "{why}"
    );
    for (name, stays) in [
        ("photo.jpg", true),
        ("notes.partial", true),
        (".cloud.ply.1-0.partial", false),
    ] {
        assert_eq!(place.join(name).exists(), stays, "{name}");
    }
    again.stop(|| false).unwrap();
}

#[test]
fn a_nearly_full_disk_ends_a_scan_and_prevents_new_ones() {
    let free = Arc::new(AtomicU64::new(u64::MAX));
    let reported = Arc::clone(&free);
    let rig = Rig::with("", |options| {
        options.config.daemon.reserve_bytes = 1_000_000_000;
        options.free_bytes = Arc::new(move |_| Ok(reported.load(Ordering::Relaxed)));
    });
    let id = sweep(rig.address);
    free.store(999_999_999, Ordering::Relaxed);
    let scan = rig.finished(&id);
    assert_eq!(scan["state"], "partial", "{scan}");
    assert!(
        scan["why"]["message"]
            .as_str()
            .unwrap()
            .contains("disk is nearly full"),
        "{scan}"
    );
    assert!(scan["points"].as_u64().unwrap() > 0);
    assert_eq!(rig.get("/health").json()["ready"], false);
    let refused = rig.post("/api/v1/captures", &json!({"speed_deg_s": 56.25}));
    assert!(
        refused
            .refused(409, "full")
            .to_string()
            .contains("may need"),
        "{}",
        refused.text()
    );
    assert_eq!(rig.status()["activity"]["doing"], "idle");
}

#[test]
fn after_a_suspension_devices_reconnect_and_the_scan_is_partial() {
    let slept = Arc::new(AtomicI64::new(0));
    let reported = Arc::clone(&slept);
    let rig = Rig::with("", |options| {
        options.environment.suspended =
            Arc::new(move || Span::from_nanos(reported.load(Ordering::Relaxed)));
    });
    rig.ready();
    let connects = || rig.daemon().state().service.connects();
    let id = sweep(rig.address);
    let before = connects();
    slept.store(3_600_000_000_000, Ordering::Relaxed);
    let scan = rig.finished(&id);
    assert_eq!(scan["state"], "partial", "{scan}");
    assert!(
        scan["why"]["message"]
            .as_str()
            .unwrap()
            .contains("suspended for 3600 s"),
        "{scan}"
    );
    wait("the drive to connect again", || {
        (connects() > before).then_some(())
    });
    rig.ready();
}

#[test]
fn a_suspension_detected_only_afterwards_makes_a_scan_partial() {
    let slept = Arc::new(AtomicI64::new(0));
    let reported = Arc::clone(&slept);
    let rig = Rig::with("", |options| {
        // Only the device thread sees the suspension.
        options.environment.suspended =
            Arc::new(
                move || match std::thread::current().name() == Some("devices") {
                    true => Span::from_nanos(reported.load(Ordering::Relaxed)),
                    false => Span::ZERO,
                },
            );
    });
    let id = sweep(rig.address);
    slept.store(60_000_000_000, Ordering::Relaxed);
    rig.post("/api/v1/captures/stop", &json!({}));
    let scan = rig.finished(&id);
    assert_eq!(scan["state"], "partial", "{scan}");
    let why = scan["why"]["message"].as_str().unwrap();
    assert_eq!(why, "the machine was suspended for 60 s");
    assert_eq!(scan["recording"]["message"], why);
    // The next scan is not affected.
    let next = rig.ready().whole_scan(&json!({"speed_deg_s": 56.25}));
    assert_eq!(next["why"], json!(null));
}

/// The scan's record on disk.
fn written(rig: &Rig, id: &str) -> serde_json::Value {
    let record = rig.log(id).with_file_name("scan.json");
    serde_json::from_slice(&std::fs::read(record).unwrap()).unwrap()
}

#[test]
fn a_cloud_is_built_once_the_disk_has_space() {
    let (free, looks) = (
        Arc::new(AtomicU64::new(u64::MAX)),
        Arc::new(AtomicU64::new(0)),
    );
    let disk = || {
        let (reported, looked) = (Arc::clone(&free), Arc::clone(&looks));
        move |options: &mut Options| {
            options.free_bytes = Arc::new(move |_| {
                looked.fetch_add(1, Ordering::SeqCst);
                Ok(reported.load(Ordering::SeqCst))
            });
        }
    };
    let mut rig = Rig::with("", disk());
    let id = sweep(rig.address);
    free.store(0, Ordering::SeqCst);
    let waits = |scan: &serde_json::Value| {
        assert_eq!(
            (&scan["state"], &scan["waits_for_room"]),
            (&json!("failed"), &json!(true)),
            "{scan}"
        );
        assert_eq!(scan["points"], json!(null), "{scan}");
    };
    let scan = rig.finished(&id);
    waits(&scan);
    let why = scan["why"].to_string();
    assert!(
        why.contains("nearly full") && why.contains("the disk is full"),
        "{why}"
    );
    let summary = scan["summary"].as_str().unwrap();
    assert!(
        summary.contains(" The log is kept: its cloud is made as soon as the disk has room. "),
        "{summary}"
    );
    assert!(!summary.contains('/'), "{summary}");
    wait("its record", || {
        (written(&rig, &id)["state"] == "failed").then_some(())
    });
    waits(&written(&rig, &id));
    let refused = rig.get(&format!("/api/v1/scans/{id}/cloud"));
    refused.refused(507, "full");
    assert!(
        refused.head.contains("\nretry-after: 5"),
        "{}",
        refused.head
    );
    // One byte less than it may need above the reserve.
    let needs = daemon::plan::most_cloud_bytes(scan["log_bytes"].as_u64().unwrap());
    free.store(1_000 + needs - 1, Ordering::SeqCst);
    let before = looks.load(Ordering::SeqCst);
    // The status, once per second, reads free space, too.
    wait("looks", || {
        (looks.load(Ordering::SeqCst) > before + 8).then_some(())
    });
    waits(&rig.get(&format!("/api/v1/scans/{id}")).json());
    // The state survives a restart.
    let config = rig.daemon().state().service.config().clone();
    rig.daemon.take().unwrap().stop(|| false).unwrap();
    waits(&written(&rig, &id));
    let mut options = Options {
        config,
        listen: Some("127.0.0.1:0".parse().unwrap()),
        runtime: Some(rig.folder.path().to_owned()),
        ..Options::default()
    };
    disk()(&mut options);
    let again = Daemon::start(options).unwrap();
    rig.address = again.address();
    rig.daemon = Some(again);
    waits(&rig.get(&format!("/api/v1/scans/{id}")).json());
    free.store(1_000 + needs, Ordering::SeqCst);
    let scan = wait("the cloud", || {
        let scan = rig.get(&format!("/api/v1/scans/{id}")).json();
        (scan["state"] == "partial").then_some(scan)
    });
    assert!(scan["points"].as_u64().unwrap() > 0, "{scan}");
    assert_eq!(scan["waits_for_room"], false);
    assert!(
        scan["why"]["message"]
            .as_str()
            .unwrap()
            .contains("nearly full"),
        "{scan}"
    );
    wait("its record", || {
        let reported = written(&rig, &id);
        (reported["state"] == "partial" && reported["waits_for_room"] == false).then_some(())
    });
    let counters = &rig.daemon().state().counters;
    let counts = [&counters.partial, &counters.failed].map(|count| count.load(Ordering::Relaxed));
    assert_eq!(counts, [1, 0]);
}

#[test]
fn a_scan_that_waits_for_disk_space_can_be_deleted() {
    let free = Arc::new(AtomicU64::new(u64::MAX));
    let reported = Arc::clone(&free);
    let rig = Rig::with("", |options| {
        options.free_bytes = Arc::new(move |_| Ok(reported.load(Ordering::Relaxed)));
    });
    let id = sweep(rig.address);
    free.store(0, Ordering::Relaxed);
    assert_eq!(rig.finished(&id)["waits_for_room"], true);
    let path = format!("/api/v1/scans/{id}");
    assert_eq!(request(rig.address, "DELETE", &path, "", "").status, 204);
    assert!(!rig.log(&id).exists());
}

#[test]
fn a_download_leaves_the_space_reserved_for_a_scan() {
    // Free bytes for a number of reads, and for all later ones.
    let (free, looks) = (
        Arc::new(AtomicU64::new(u64::MAX)),
        Arc::new(AtomicU64::new(u64::MAX)),
    );
    let (reported, left) = (Arc::clone(&free), Arc::clone(&looks));
    let rig = Rig::with("", |options| {
        options.free_bytes = Arc::new(move |_| {
            let lasts = |left: u64| left.checked_sub(1);
            match left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, lasts) {
                Ok(_) => Ok(reported.load(Ordering::Relaxed)),
                Err(_) => Ok(0),
            }
        });
    });
    rig.ready();
    let scan = rig.whole_scan(&json!({"speed_deg_s": 56.25}));
    let (id, points) = (
        scan["id"].as_str().unwrap(),
        scan["points"].as_u64().unwrap(),
    );
    let path = |format: Format| {
        format!("/api/v1/scans/{id}/cloud?format={format}&uncertainty=true&echo=true&laser=true")
    };
    for format in Format::ALL {
        if format.needs_companion() {
            rig.get(&path(format)).refused(400, "expected one of ply");
            continue;
        }
        let most = disk_quota::most_bytes(format, points);
        // Exactly the reserve of these tests.
        free.store(1_000 + most - 1, Ordering::Relaxed);
        let refused = rig.get(&path(format));
        assert_eq!(refused.refused(507, "full")["kind"], "incomplete");
        free.store(1_000 + most, Ordering::Relaxed);
        let made = rig.get(&path(format));
        assert_eq!(made.status, 200, "{format}: {}", made.text());
        assert!(
            made.body.len() as u64 <= most,
            "{format}: {}",
            made.body.len()
        );
    }
    // An existing cloud needs no space.
    free.store(0, Ordering::Relaxed);
    assert_eq!(rig.get(&format!("/api/v1/scans/{id}/cloud")).status, 200);
    // The disk fills up after the cloud's construction has started.
    free.store(u64::MAX, Ordering::Relaxed);
    looks.store(1, Ordering::Relaxed);
    rig.get(&path(Format::Pcd)).refused(507, "filled up");
    looks.store(u64::MAX, Ordering::Relaxed);
    // A running scan may need more than is left.
    let running = sweep(rig.address);
    free.store(
        1_000 + disk_quota::most_bytes(Format::Pcd, points),
        Ordering::Relaxed,
    );
    let refused = rig.get(&path(Format::Pcd));
    let printed = refused.refused(507, "promised").to_string();
    assert!(printed.contains("may still need"), "{printed}");
    let status = rig.status();
    assert_eq!(status["activity"]["scan"], running.as_str(), "{status}");
    free.store(u64::MAX, Ordering::Relaxed);
    assert_eq!(rig.get(&path(Format::Pcd)).status, 200);
    rig.post("/api/v1/captures/stop", &json!({}));
    rig.finished(&running);
}

/// Folders that a user, another program or a later version left there.
#[test]
fn odd_records_hide_no_others_and_serve_no_other_files() {
    let odd = ["a \"quoted\" name", "line\nbreak", "gr\u{fc}n", "plain"];
    let rig = Rig::with("", |options| {
        let scans = options.config.daemon.scans.clone().unwrap();
        let make = |name: &str| {
            let folder = scans.join(name);
            std::fs::create_dir_all(&folder).unwrap();
            folder
        };
        for name in odd {
            std::fs::write(make(name).join("cloud.ply"), name).unwrap();
            std::fs::write(scans.join(name).join("log.pcapng"), "no log").unwrap();
        }
        let secret = scans.parent().unwrap().join("secret");
        std::fs::write(&secret, "secret").unwrap();
        let links = make("links");
        for name in ["log.pcapng", "cloud.ply", "thumbnail.png"] {
            std::os::unix::fs::symlink(&secret, links.join(name)).unwrap();
        }
        std::fs::write(links.join("scan.json"), "{}").unwrap();
        let pipes = make("pipes");
        for name in ["scan.json", "log.pcapng", "cloud.ply", "thumbnail.png"] {
            let made = std::process::Command::new("mkfifo")
                .arg(pipes.join(name))
                .status();
            assert!(made.unwrap().success());
        }
        std::fs::write(make("later").join("scan.json"), "{\"state\": 7}").unwrap();
    });
    let listed = rig.get("/api/v1/scans").json();
    let listed: Vec<&str> = listed["scans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|scan| scan["id"].as_str().unwrap())
        .collect();
    for name in odd.into_iter().chain(["pipes", "later"]) {
        assert!(listed.contains(&name), "{name:?} is not in {listed:?}");
    }
    let escaped = |name: &str| {
        name.bytes()
            .map(|byte| format!("%{byte:02X}"))
            .collect::<String>()
    };
    for name in odd {
        let cloud = rig.get(&format!("/api/v1/scans/{}/cloud", escaped(name)));
        assert_eq!((cloud.status, cloud.text().as_str()), (200, name));
        assert_eq!(
            cloud.head.contains("filename*="),
            name != "plain",
            "{}",
            cloud.head
        );
    }
    for name in ["links", "pipes"] {
        for file in ["cloud", "cloud?format=las", "log", "thumbnail"] {
            let answer = rig.get(&format!("/api/v1/scans/{name}/{file}"));
            assert!(
                matches!(answer.status, 404 | 409),
                "{name}/{file}: {answer:?}"
            );
            answer.refused(answer.status, file);
        }
    }
    rig.get("/api/v1/scans/%FF").refused(400, "not UTF-8");
    rig.get("/api/v1/scans/%FF/cloud").refused(400, "not UTF-8");
}
