use super::*;
use crate::limits::UNDO;
use io::log::{LogConfig, LogWriter};
use scanner::ScanConfig;

fn request(name: Option<&str>) -> CaptureRequest {
    CaptureRequest {
        speed_deg_s: 10.0,
        name: name.map(str::to_owned),
        ..CaptureRequest::default()
    }
}

fn finished(scans: &Scans, name: Option<&str>) -> String {
    let id = scans.begin(&request(name), true).unwrap().head.id;
    fs::write(scans.place(&id).join(CLOUD), [0; 100]).unwrap();
    let done = scans.change(&id, |record| record.state = ScanState::Whole);
    assert_eq!(done.unwrap().unwrap().cloud_bytes, Some(100));
    id
}

#[test]
fn the_newest_scan_does_not_depend_on_the_clock() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let ids: Vec<String> = (0..4).map(|_| finished(&scans, None)).collect();
    // The clock was years ahead at the first scan, and its battery was empty at the last.
    let set = |id: &str, at: f64| scans.change(id, |record| record.head.started_s = at);
    set(&ids[0], 4e9).unwrap();
    set(&ids[3], 1.0).unwrap();
    for again in [&scans, &Scans::open(folder.path()).unwrap()] {
        let listed: Vec<String> = again.list().iter().map(|scan| scan.id.clone()).collect();
        assert_eq!(
            listed,
            [&ids[3], &ids[2], &ids[1], &ids[0]].map(Clone::clone)
        );
    }
    let again = Scans::open(folder.path()).unwrap();
    let gone: Vec<String> = again
        .retain(2, u64::MAX)
        .iter()
        .map(|s| s.id.clone())
        .collect();
    assert_eq!(gone, [ids[0].clone(), ids[1].clone()]);
    // The next scan is the newest, after any deletion.
    let next = finished(&again, None);
    assert_eq!(again.list()[0].id, next);
}

#[test]
fn unreadable_scans_are_listed_and_left_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let (later, unknown) = (finished(&scans, None), finished(&scans, None));
    let edit = |id: &str, from: &str, to: &str| {
        let path = scans.place(id).join(RECORD);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(&path, text.replace(from, to)).unwrap();
        fs::read(&path).unwrap()
    };
    // An option of a later version: the scan is listed with the fields of this version.
    edit(&later, "\"both_ways\": false", "\"zigzag\": 3");
    // A state that this version does not know.
    let bytes = edit(&unknown, "\"whole\"", "\"superb\"");
    // A user's folder: a log and a cloud from elsewhere, and other files.
    let theirs = scans.place("hall");
    fs::create_dir(&theirs).unwrap();
    for name in [LOG, CLOUD, "hall.e57", "photo.jpg"] {
        fs::write(theirs.join(name), name).unwrap();
    }
    std::os::unix::fs::symlink(&theirs, scans.place("linked")).unwrap();
    let cloud_alone = scans.place("cloud-alone");
    fs::create_dir(&cloud_alone).unwrap();
    fs::write(cloud_alone.join(CLOUD), "ply\ncomment SIMULATED\n").unwrap();
    fs::write(cloud_alone.join(RECORD), "damaged").unwrap();

    let again = Scans::open(folder.path()).unwrap();
    let view = |id: &str| again.view(id).unwrap();
    assert_eq!(
        (view(&later).state, &view(&later).request),
        (ScanState::Whole, &None)
    );
    let why = view(&unknown).why.clone().unwrap();
    assert!(why.message.contains("superb"), "{why}");
    assert_eq!(view(&unknown).state, ScanState::Partial, "it has a cloud");
    assert_eq!(view("hall").state, ScanState::Partial);
    assert!(!view("hall").simulated);
    assert!(view("cloud-alone").simulated, "the cloud says it");
    assert_eq!(again.view("linked"), None);
    assert!(
        again.unfinished().is_empty(),
        "existing files are not overwritten"
    );
    // Neither overwritten nor deleted without a request.
    again
        .change(&unknown, |record| record.points = Some(7))
        .unwrap();
    let refused = again.edit(&unknown, &ScanEdit::default()).unwrap_err();
    assert_eq!(refused.kind, Kind::Incomplete);
    assert_eq!(fs::read(again.place(&unknown).join(RECORD)).unwrap(), bytes);
    let gone = again.retain(0, 0);
    assert!(gone.iter().all(|scan| scan.id != unknown), "{gone:?}");
    assert!(again.view(&unknown).is_some());
    assert!(again.delete(&unknown).unwrap().is_some());
}

#[test]
fn the_list_of_scans_follows_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let (first, second) = (finished(&scans, Some("hall")), finished(&scans, None));
    assert!(first.starts_with("hall-simulated-"), "{first}");
    let again = Scans::open(folder.path()).unwrap();
    assert_eq!(again.list(), scans.list());
    assert_eq!(again.delete(&first).unwrap().unwrap().id, first);
    assert_eq!(again.delete(&first).unwrap(), None);
    let left = Scans::open(folder.path()).unwrap().list();
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].id, second);
}

#[test]
fn unfinished_scans_wait_for_their_cloud() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let with_log = scans.begin(&request(Some("a")), false).unwrap().head.id;
    fs::write(scans.place(&with_log).join(LOG), b"log").unwrap();
    let without = scans.begin(&request(Some("b")), false).unwrap().head.id;
    // A scan being made cannot be deleted.
    assert!(scans.delete(&without).is_err());
    // A folder with only a log, and one that is not a scan.
    fs::create_dir(folder.path().join("copied")).unwrap();
    let config = ScanConfig {
        simulated: true,
        ..ScanConfig::default()
    };
    let config = LogConfig {
        metadata: toml::to_string(&config).unwrap(),
        drive: None,
    };
    let log = folder.path().join("copied").join(LOG);
    let log = LogWriter::create(&log, &config, Overwrite::Refuse).unwrap();
    log.finish().unwrap();
    fs::create_dir(folder.path().join("other")).unwrap();
    let again = Scans::open(folder.path()).unwrap();
    let mut unfinished = again.unfinished();
    unfinished.sort();
    assert_eq!(unfinished, [with_log.as_str(), "copied"]);
    assert_eq!(again.view(&without).unwrap().state, ScanState::Failed);
    assert!(again.record(&with_log).unwrap().recording.is_some());
    // The log says that it is simulated, whatever its folder is called.
    assert!(again.record("copied").unwrap().simulated);
    assert!(!again.record(&with_log).unwrap().simulated);
    assert_eq!(again.list().len(), 3);
}

#[test]
fn the_oldest_scans_are_deleted_over_the_limit_and_the_newest_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let ids: Vec<String> = (0..4).map(|_| finished(&scans, None)).collect();
    let gone = scans.retain(3, u64::MAX);
    assert_eq!(gone.len(), 1);
    assert_eq!(gone[0].id, ids[0]);
    // One scan has some hundred bytes.
    assert_eq!(scans.retain(3, 1).len(), 2);
    assert_eq!(scans.list()[0].id, ids[3]);
}

#[test]
fn scan_names_cannot_escape_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    for name in ["", "../x", "a/b", "a b", ".", &"x".repeat(61)] {
        let failure = scans.begin(&request(Some(name)), true).unwrap_err();
        assert_eq!(failure.kind, Kind::Usage, "{name}");
    }
    assert_eq!(scans.view("../x"), None);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_deleted_scan_is_restored_whole_or_removed_when_its_time_is_over() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let (first, second) = (finished(&scans, Some("a")), finished(&scans, None));
    let (before, now) = (scans.list(), std::time::Instant::now());
    let names = || {
        let entries = fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let whole = names();
    let size = scans.size();
    assert_eq!(
        scans.delete_with_undo(&first, now).unwrap().as_ref(),
        Some(&before[1])
    );
    assert_eq!(scans.list(), before[..1]);
    assert!(scans.size() < size);
    assert_eq!(scans.delete(&first).unwrap(), None);
    // Not a moment before its time.
    scans
        .remove_deleted(now + UNDO - std::time::Duration::from_nanos(1))
        .unwrap();
    assert_eq!(scans.restore(&first).unwrap().as_ref(), Some(&before[1]));
    assert_eq!((scans.list(), scans.size()), (before.clone(), size));
    assert_eq!(names(), whole);
    assert_eq!(scans.restore(&first).unwrap(), None);
    scans.remove_deleted(now + UNDO).unwrap();
    assert_eq!(names(), whole, "a restored scan is not removed");

    scans.delete_with_undo(&first, now).unwrap();
    scans.remove_deleted(now + UNDO).unwrap();
    assert_eq!(scans.restore(&first).unwrap(), None);
    assert_eq!(names(), [second.as_str()]);
    // A restart in the meantime removes it.
    scans.delete_with_undo(&second, now).unwrap();
    assert_eq!(names().len(), 1);
    assert!(Scans::open(folder.path()).unwrap().list().is_empty());
    assert!(names().is_empty());
}

#[test]
fn a_new_scan_never_takes_the_folder_of_a_deleted_one_that_can_be_restored() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let now = std::time::SystemTime::UNIX_EPOCH;
    let (id, place) = scans.new_place(Some("a"), now, true).unwrap();
    store(&place, &ScanRecord::default()).unwrap();
    let record = ScanRecord {
        head: ScanHead {
            id: id.clone(),
            state: ScanState::Whole,
            ..ScanHead::default()
        },
        ..ScanRecord::default()
    };
    scans.scans().insert(id.clone(), record);
    scans
        .delete_with_undo(&id, std::time::Instant::now())
        .unwrap();
    let (other, _) = scans.new_place(Some("a"), now, true).unwrap();
    assert_ne!(other, id);
    assert!(scans.restore(&id).unwrap().is_some());
}

#[test]
fn names_and_notes_are_written_or_nothing_is_changed() {
    let folder = tempfile::tempdir().unwrap();
    let scans = Scans::open(folder.path()).unwrap();
    let id = finished(&scans, Some("a"));
    let edit = |name: &str, notes: Option<&str>| ScanEdit {
        name: Some(name.to_owned()),
        notes: notes.map(str::to_owned),
    };
    let texts = |scan: ScanView| (scan.head.name, scan.head.notes);
    let some = |text: &str| Some(text.to_owned());
    let edited = scans
        .edit(&id, &edit(" Hall, n\u{f6}rdlich ", Some("a\nb")))
        .unwrap();
    assert_eq!(
        texts(edited.unwrap()),
        (some("Hall, n\u{f6}rdlich"), some("a\nb"))
    );
    // Absent keys change nothing.
    scans.edit(&id, &edit("Hall", None)).unwrap();
    let again = Scans::open(folder.path()).unwrap();
    assert_eq!(
        texts(again.view(&id).unwrap()),
        (some("Hall"), some("a\nb"))
    );
    again.edit(&id, &edit("", Some(" "))).unwrap();
    assert_eq!(texts(again.view(&id).unwrap()), (None, None));
    assert_eq!(again.edit("none", &edit("x", None)).unwrap(), None);
    // A record that cannot be written: its folder is gone.
    fs::rename(again.place(&id), folder.path().join(".elsewhere")).unwrap();
    again.edit(&id, &edit("x", Some("y"))).unwrap_err();
    assert_eq!(texts(again.view(&id).unwrap()), (None, None));
}
