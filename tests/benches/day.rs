//! A day of scans, one a minute, through what a daemon keeps in memory: the list of scans, their clouds and pictures, the live view, the
//! lidar's monitor, and the events of nine clients, one of whom never reads. How much memory the process has, hour by hour.
//!
//! Left out: devices and sockets. Times are those of the day that is made up, not of a clock.
//!
//! `cargo bench -p velomotion-tests --bench day [-- SCANS]`; it fails where memory grows after the second hour.

use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use daemon::hub::{Event, Hub};
use daemon::maker::{self, Making};
use daemon::points::Watching;
use daemon::scans::{LOG, ScanState, Scans};
use daemon::shared::{Shared, World};
use engine::capture::request::CaptureRequest;
use engine::config::Config;
use engine::devices::profile as devices;
use io::log::OwnedRecord;
use io::recording::Recording;
use scanner::Accuracy;
use units::{DegPerS, Degrees};
use velomotion_tests::capture::{Captured, Setting};

/// Scans of a day.
const DAY: usize = 1_440;
/// How much more memory may be in use at the end than after two hours.
const GROWTH: f64 = 1.1;

fn main() {
    let scans = std::env::args().filter_map(|word| word.parse().ok()).next();
    let scans: usize = scans.unwrap_or(DAY);
    let (folder, log) = (tempfile::tempdir().unwrap(), log());
    let records = records(&log);
    let mut config: Config =
        toml::from_str("device = 'sim'\n[daemon]\nkeep_scans = 100\nreserve_bytes = 1000").unwrap();
    config.daemon.scans = Some(folder.path().to_owned());
    let device = devices::choose(&config, None).unwrap();
    let (orders, _inbox) = channel();
    let kept = Scans::open(folder.path()).unwrap();
    let shared = Arc::new(Shared::new(config, device, kept, World::default(), orders));
    let (logs, wanted) = channel();
    let making = Arc::clone(&shared);
    let maker = std::thread::spawn(move || maker::run(&making, &wanted));
    let readers: Vec<_> = (0..8).map(|_| reader(&shared.hub)).collect();

    let begin = Instant::now();
    let mut after_two_hours = None;
    println!("| scans | kept | memory, MB | clients dropped |\n|---|---|---|---|");
    for number in 0..scans {
        let idle = shared.hub.subscribe(true);
        let id = one(&shared, &log, &records);
        let making = Making {
            id: id.clone(),
            accuracy: Accuracy::Best,
            truth: None,
            lost_records: 0,
        };
        logs.send(making).unwrap();
        // A minute of the pulse, while the cloud is made.
        (0..60).for_each(|_| shared.tell_status());
        finished(&shared, &id);
        drop(idle);
        if (number + 1) % (scans / 12).max(1) == 0 {
            let memory = memory_mb();
            println!(
                "| {} | {} | {memory:.0} | {} |",
                number + 1,
                shared.scans.list().len(),
                shared.hub.dropped()
            );
            if number + 1 >= scans / 6 {
                after_two_hours.get_or_insert(memory);
            }
        }
    }
    let (first, last) = (after_two_hours.unwrap(), memory_mb());
    println!("{scans} scans in {:.0} s", begin.elapsed().as_secs_f64());
    assert!(
        last <= first * GROWTH,
        "memory grew from {first:.0} to {last:.0} MB"
    );
    drop(logs);
    maker.join().unwrap();
    assert!(shared.scans.list().len() <= 100, "more scans than are kept");
    assert_eq!(
        readers.len(),
        shared.hub.len(),
        "a client that read was dropped"
    );
}

/// A short sweep.
fn log() -> Captured {
    let mut setting = Setting::default();
    setting.wish.to = Degrees(-5.0);
    setting.wish.speed = DegPerS(56.25);
    Captured::new(setting)
}

fn records(log: &Captured) -> Vec<OwnedRecord> {
    let mut recording = Recording::open(log.log()).unwrap();
    let mut records = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        records.push(OwnedRecord::from(&record));
    }
    records
}

/// One capture, as the keeper tells of it.
fn one(shared: &Shared, log: &Captured, records: &[OwnedRecord]) -> String {
    let asked = CaptureRequest {
        speed_deg_s: 56.25,
        ..CaptureRequest::default()
    };
    let id = shared.scans.begin(&asked, true).unwrap().id.clone();
    std::fs::copy(log.log(), shared.scans.place(&id).join(LOG)).unwrap();
    let config = scanner::ScanConfig::default();
    let watching = Watching::start(&id, &config, &shared.feed, &shared.hub);
    for (number, record) in records.iter().enumerate() {
        let record = record.as_record();
        shared.monitor.lock().unwrap().observe(&record);
        shared.feed.record(&record);
        if number % 50 == 0 {
            shared.hub.tell(Event::Motion {
                angle_deg: 0.0,
                speed_deg_s: 56.25,
                left_s: None,
                packets: number as u64,
                at: record.host,
            });
            shared.scans.say(&id, "warning: something is said");
        }
    }
    drop(watching);
    shared.change_scan(&id, |record| record.state = ScanState::Making);
    id
}

fn finished(shared: &Shared, id: &str) {
    let begin = Instant::now();
    while !shared.scans.view(id).unwrap().state.is_final() {
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "{id} is never made"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    let state = shared.scans.view(id).unwrap();
    assert_eq!(state.state, ScanState::Whole, "{:?}", state.why);
}

/// A client that reads everything.
fn reader(hub: &Arc<Hub>) -> std::thread::JoinHandle<()> {
    let mut subscription = hub.subscribe(true).unwrap();
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .build()
            .unwrap();
        runtime.block_on(async {
            while let Some(told) = subscription.next().await {
                // As a socket wants them.
                drop((told.json(), told.points(1)));
            }
        });
    })
}

/// What of the process is in memory, by Linux.
fn memory_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = text.lines().find(|line| line.starts_with("VmRSS")).unwrap();
    let kb: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kb / 1e3
}
