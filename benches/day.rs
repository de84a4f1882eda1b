//! A day of scans, one per minute, through the daemon's state in memory: the list of scans, their
//! clouds and thumbnails, the live preview, the lidar's statistics, and the events of nine clients,
//! one of which never reads. Prints the memory of the process every hour.
//!
//! Devices and sockets are not used. Times are those of the simulated day, not of a clock.
//!
//! `cargo bench -p velomotion-tests --bench day [-- SCANS]`; it fails if memory grows after the
//! second hour.

use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use daemon::cloud_builder::{self, CloudJob};
use daemon::scans::{LOG, Scans};
use daemon::state::DaemonState;
use engine::capture_request::CaptureRequest;
use engine::config::Config;
use engine::devices::profile;
use engine::service::events::{Event, Events, PointsRequest};
use engine::service::scan_record::ScanState;
use engine::service::{DeviceService, Environment, Lifetime, ServiceOptions};
use io::log::OwnedRecord;
use io::recording::Recording;
use scanner::Accuracy;
use units::{DegPerS, Degrees};
use velomotion_tests::capture::{Captured, Setting};

/// Scans of a day.
const DAY: usize = 1_440;
/// Limit of the growth of memory between the second hour and the end.
const GROWTH: f64 = 1.1;

fn main() {
    let scans = std::env::args().filter_map(|word| word.parse().ok()).next();
    let scans: usize = scans.unwrap_or(DAY);
    let (folder, log) = (tempfile::tempdir().unwrap(), log());
    let records = records(&log);
    let mut config: Config =
        toml::from_str("device = 'sim'\n[daemon]\nkeep_scans = 100\nreserve_bytes = 1000").unwrap();
    config.daemon.scans = Some(folder.path().to_owned());
    let (name, device) = profile::choose(&config, None).unwrap();
    let (service, _thread) = DeviceService::start(ServiceOptions {
        config,
        name,
        device,
        lifetime: Lifetime::Command {
            lidar: false,
            interrupt: Arc::default(),
        },
        environment: Environment::default(),
    })
    .unwrap();
    let kept = Scans::open(folder.path()).unwrap();
    let (jobs, queue) = channel();
    let free_bytes = Arc::new(io::files::free_bytes);
    let state = Arc::new(DaemonState::new(service, kept, free_bytes, jobs.clone()));
    let building = Arc::clone(&state);
    let builder = std::thread::spawn(move || cloud_builder::run(&building, &queue));
    let readers: Vec<_> = (0..8).map(|_| reader(state.events())).collect();
    let _points = PointsRequest::new(state.events(), true);

    let begin = Instant::now();
    let mut after_two_hours = None;
    println!("| scans | kept | memory, MB | idle client lags |\n|---|---|---|---|");
    for number in 0..scans {
        let idle = state.events().subscribe_client().unwrap();
        let id = one(&state, &log, &records);
        let job = CloudJob {
            id: id.clone(),
            accuracy: Accuracy::Best,
            truth: None,
            lost_records: 0,
        };
        jobs.send(job).unwrap();
        // A minute of status events, while the cloud is made.
        (0..60).for_each(|_| state.service.send_status());
        finished(&state, &id);
        let lags = idle.has_lagged();
        drop(idle);
        if (number + 1) % (scans / 12).max(1) == 0 {
            let memory = memory_mb();
            println!(
                "| {} | {} | {memory:.0} | {} |",
                number + 1,
                state.scans.list().len(),
                lags
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
    drop(jobs);
    state.close_cloud_jobs();
    builder.join().unwrap();
    assert!(state.scans.list().len() <= 100, "more scans than the limit");
    assert_eq!(
        readers.len(),
        state.events().clients(),
        "a reading client was disconnected"
    );
}

/// A short sweep.
fn log() -> Captured {
    let mut setting = Setting::default();
    setting.sweep_request.to = Degrees(-5.0);
    setting.sweep_request.speed = DegPerS(56.25);
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

/// One capture, with the events of its motion.
fn one(state: &DaemonState, log: &Captured, records: &[OwnedRecord]) -> String {
    let capture = CaptureRequest {
        speed_deg_s: 56.25,
        ..CaptureRequest::default()
    };
    let id = state.scans.begin(&capture, true).unwrap().id.clone();
    std::fs::copy(log.log(), state.scans.place(&id).join(LOG)).unwrap();
    let config = scanner::ScanConfig::default();
    let preview = state.service.start_preview(&id, &config);
    let mut tap = state.service.packet_tap();
    for (number, record) in records.iter().enumerate() {
        let record = record.as_record();
        tap(&record);
        if number % 50 == 0 {
            state.events().send(Event::Motion {
                angle_deg: 0.0,
                speed_deg_s: 56.25,
                left_s: None,
                received: number as u64,
                at: record.host,
            });
            state.scans.say(&id, "warning: a message");
        }
    }
    drop(preview);
    state.change_scan(&id, |record| record.state = ScanState::Making);
    id
}

fn finished(state: &DaemonState, id: &str) {
    let begin = Instant::now();
    while !state.scans.view(id).unwrap().state.is_final() {
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "{id} is never finished"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    let scan = state.scans.view(id).unwrap();
    assert_eq!(scan.state, ScanState::Whole, "{:?}", scan.why);
}

/// A client that reads everything.
fn reader(events: &Arc<Events>) -> std::thread::JoinHandle<()> {
    let mut subscription = events.subscribe_client().unwrap();
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .build()
            .unwrap();
        runtime.block_on(async {
            while let Ok(event) = subscription.next().await {
                // The form that a socket sends.
                match &*event {
                    Event::Points(frame) => drop(frame.bytes(1)),
                    event => drop(serde_json::to_string(event)),
                }
            }
        });
    })
}

/// Resident memory of the process, by Linux.
fn memory_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = text.lines().find(|line| line.starts_with("VmRSS")).unwrap();
    let kb: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kb / 1e3
}
