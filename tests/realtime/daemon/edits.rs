//! Names and notes of scans, and deletion with undo, over the API.

use std::path::Path;

use daemon::{Daemon, Options};
use serde_json::{Value, json};

use super::rig::{Answer, Rig, request, wait};

/// A daemon that finds these finished scans.
fn with_scans(ids: &[&str]) -> Rig {
    Rig::with("", |options| {
        let scans = options.config.daemon.scans.clone().unwrap();
        for id in ids {
            let place = scans.join(id);
            std::fs::create_dir_all(&place).unwrap();
            let record = json!({
                "id": id, "name": id, "state": "whole", "why": null, "started_s": 0.0, "simulated": true,
                "asked": null, "points": 0, "duration_s": 0.0,
            });
            std::fs::write(place.join("scan.json"), record.to_string()).unwrap();
            std::fs::write(place.join("log.pcapng"), id).unwrap();
        }
    })
}

fn patch(rig: &Rig, id: &str, body: &str) -> Answer {
    let json = "content-type: application/json\r\n";
    request(
        rig.address,
        "PATCH",
        &format!("/api/v1/scans/{id}"),
        json,
        body,
    )
}

fn delete(rig: &Rig, id: &str, query: &str) -> u16 {
    request(
        rig.address,
        "DELETE",
        &format!("/api/v1/scans/{id}{query}"),
        "",
        "",
    )
    .status
}

fn restore(rig: &Rig, id: &str) -> Answer {
    request(
        rig.address,
        "POST",
        &format!("/api/v1/scans/{id}/restore"),
        "",
        "",
    )
}

/// Ends the daemon and starts another one on its folder.
fn restart(rig: &mut Rig) {
    let config = rig.daemon().state().service.config().clone();
    rig.daemon.take().unwrap().stop(|| true).unwrap();
    let again = Daemon::start(Options {
        config,
        listen: Some("127.0.0.1:0".parse().unwrap()),
        runtime: Some(rig.folder.path().to_owned()),
        ..Options::default()
    })
    .unwrap();
    rig.address = again.address();
    rig.daemon = Some(again);
}

/// Names in the scans folder, without the daemon's lock.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join("scans")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.filter(|name| name != ".lock").collect();
    names.sort();
    names
}

#[test]
fn name_and_notes_are_kept_with_the_scan_and_invalid_ones_refused() {
    let mut rig = with_scans(&["hall"]);
    let texts = |scan: &Value| [scan["name"].clone(), scan["notes"].clone()];
    let listed = |rig: &Rig| texts(&rig.get("/api/v1/scans").json()["scans"][0]);
    assert_eq!(listed(&rig), [json!("hall"), json!(null)]);
    let notes = "Door open.\nTripod on the gallery, 2\u{a0}m high \u{1f6aa}";
    let body = json!({ "name": "Hall, north end", "notes": notes }).to_string();
    let changed = patch(&rig, "hall", &body);
    assert_eq!(changed.status, 200, "{}", changed.text());
    let wanted = [json!("Hall, north end"), json!(notes)];
    assert_eq!(texts(&changed.json()), wanted);
    let longest = |n: usize| "\u{e9}".repeat(n);
    for (body, part) in [
        (
            json!({ "name": longest(61) }),
            "name: expected at most 60 characters, got 61",
        ),
        (
            json!({ "notes": longest(2_001) }),
            "notes: expected at most 2000 characters",
        ),
        (json!({ "name": "two\nlines" }), "control character"),
        (json!({ "notes": "a\u{1b}[2J" }), "control character"),
        (json!({ "note": "misspelt" }), "note"),
        (json!({ "name": 7 }), "string"),
        (json!([]), "object"),
    ] {
        let refused = patch(&rig, "hall", &body.to_string()).refused(400, part);
        assert!(
            refused["message"].as_str().unwrap().contains(part),
            "{refused}"
        );
    }
    patch(&rig, "none", &body).refused(404, "unknown");
    request(rig.address, "PATCH", "/api/v1/scans/hall", "", &body).refused(415, "no type");
    assert_eq!(listed(&rig), wanted);
    restart(&mut rig);
    assert_eq!(listed(&rig), wanted);
    let fits = json!({ "name": longest(60), "notes": longest(2_000) }).to_string();
    assert_eq!(patch(&rig, "hall", &fits).status, 200);
    assert_eq!(
        patch(&rig, "hall", "{\"name\": \"\"}").json()["name"],
        json!(null)
    );
    assert_eq!(listed(&rig)[1], json!(longest(2_000)));
}

#[test]
fn a_running_scan_is_renamed_and_keeps_the_name() {
    let rig = Rig::new();
    let id = super::rig::sweep(rig.address);
    let changed = patch(&rig, &id, "{\"name\": \"North\", \"notes\": \"windy\"}").json();
    assert_eq!(changed["state"], "recording", "{changed}");
    rig.post("/api/v1/captures/stop", &json!({}));
    let scan = rig.finished(&id);
    assert_eq!(
        (&scan["name"], &scan["notes"]),
        (&json!("North"), &json!("windy"))
    );
}

#[test]
fn a_deleted_scan_is_restored_within_its_time_and_never_half_removed() {
    let mut rig = with_scans(&["a", "b", "c"]);
    let folder = rig.folder.path().to_owned();
    let before = rig.get("/api/v1/scans").json();
    assert_eq!(delete(&rig, "b", "?undo=true"), 204);
    assert_eq!(delete(&rig, "b", "?undo=true"), 404);
    rig.get("/api/v1/scans/b").refused(404, "deleted");
    rig.get("/api/v1/scans/b/log").refused(404, "deleted");
    let restored = restore(&rig, "b");
    assert_eq!(restored.status, 200, "{}", restored.text());
    assert_eq!(rig.get("/api/v1/scans").json(), before);
    assert_eq!(rig.get("/api/v1/scans/b/log").body, b"b");
    restore(&rig, "b").refused(404, "not deleted");

    // Without undo it is gone at once, with it after 10 s.
    assert_eq!(delete(&rig, "a", ""), 204);
    restore(&rig, "a").refused(404, "deleted permanently");
    assert_eq!(names(&folder), ["b", "c"]);
    let begin = std::time::Instant::now();
    assert_eq!(delete(&rig, "b", "?undo=true"), 204);
    assert_eq!(delete(&rig, "c", "?undo=perhaps"), 400);
    wait("the removal", || (names(&folder) == ["c"]).then_some(()));
    assert!(begin.elapsed() >= daemon::limits::UNDO);
    restore(&rig, "b").refused(404, "its time is over");

    // The next daemon removes what the last one kept.
    assert_eq!(delete(&rig, "c", "?undo=true"), 204);
    assert_eq!(names(&folder), [".c.deleted"]);
    restart(&mut rig);
    assert!(names(&folder).is_empty());
    restore(&rig, "c").refused(404, "of the last daemon");
}
