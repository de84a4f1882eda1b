//! A cable that is unplugged for seconds while its adapter stays: the port exists but transfers
//! nothing.

use std::os::unix::fs::symlink;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

use firmware_sim::epos2::{SimulatedDrive, SimulatedDriveConfig, UsbServer};
use io::port::{Port, Pty};
use protocol::epos2::cia402::DeviceState;
use serde_json::json;
use units::Span;

use super::devices::{bench, drive};
use super::rig::{Rig, post, wait};

/// A simulated drive in this process whose cable can be cut.
struct Cable {
    cut: Arc<AtomicBool>,
    end: Arc<AtomicBool>,
    /// State of the drive and position of its shaft, in quadcounts.
    seen: Arc<Mutex<(DeviceState, i64)>>,
    thread: Option<JoinHandle<()>>,
}

impl Cable {
    fn plug(link: &Path, config: SimulatedDriveConfig) -> Self {
        let mut pty = Pty::open().unwrap();
        symlink(pty.path(), link).unwrap();
        let mut node = SimulatedDrive::new(config);
        let cut = Arc::new(AtomicBool::new(false));
        let end = Arc::new(AtomicBool::new(false));
        let seen = Arc::new(Mutex::new((node.state(), 0)));
        let (is_cut, ends, sees) = (Arc::clone(&cut), Arc::clone(&end), Arc::clone(&seen));
        let thread = std::thread::spawn(move || {
            let mut server = UsbServer::new(1);
            let mut cycles = 0;
            let begin = Instant::now();
            while !ends.load(Ordering::Acquire) {
                let mut buffer = [0; 512];
                let count = pty.read(&mut buffer, Span::from_millis(1)).unwrap();
                let count = count.map_or(0, |(count, _)| count);
                while cycles < begin.elapsed().as_millis() {
                    node.tick();
                    cycles += 1;
                }
                *sees.lock().unwrap() = (node.state(), node.segment().end);
                if is_cut.load(Ordering::Acquire) {
                    continue;
                }
                let mut answer = Vec::new();
                server.input(&mut node, &buffer[..count], &mut |bytes: &[u8]| {
                    answer.extend_from_slice(bytes);
                });
                pty.write_frame(&answer).unwrap();
            }
        });
        Self {
            cut,
            end,
            seen,
            thread: Some(thread),
        }
    }

    fn seen(&self) -> (DeviceState, i64) {
        *self.seen.lock().unwrap()
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[test]
fn an_unstopped_axis_is_reported_as_moving_until_it_is_at_rest() {
    let table = tempfile::tempdir().unwrap();
    let link = table.path().join("epos");
    let axis = engine::config::Config::default().axis;
    let axis = engine::devices::profile::axis(&axis).unwrap();
    let cable = Cable::plug(&link, engine::devices::simulated::node(&axis));
    let rig = Rig::with("", |options| {
        bench(options, &format!("port = '{}'", link.display()));
    });
    drive(&rig, "connected");
    assert_eq!(rig.post("/api/v1/tilt/home", &json!({})).status, 200);

    let address = rig.address;
    let goto = std::thread::spawn(move || {
        let to = json!({"to_deg": -40.0, "speed_deg_s": 1.0});
        post(address, "/api/v1/tilt/goto", &to)
    });
    let home = cable.seen().1;
    wait("a move", || (cable.seen().1 != home).then_some(()));
    cable.cut.store(true, Ordering::Release);
    let refused = goto.join().unwrap();
    assert!(refused.status >= 400, "{}", refused.text());
    let printed = refused.refused(refused.status, "stopped");
    assert!(
        printed["message"]
            .as_str()
            .unwrap()
            .contains("stopping the axis failed"),
        "{printed}"
    );
    // The axis moves on, and the status reports it after every retry.
    let (state, was) = cable.seen();
    assert_eq!(
        state,
        DeviceState::OperationEnabled,
        "no request reached the drive"
    );
    wait("it goes on", || (cable.seen().1 != was).then_some(()));
    let connecting = || rig.status()["activity"]["doing"] == "connecting";
    wait("a try to reach it", || connecting().then_some(()));
    wait("its end", || (!connecting()).then_some(()));
    let problem = rig.status()["drive"].clone();
    assert_eq!(problem["state"], "fault", "{problem}");
    assert_eq!(
        problem["problem"]["message"], printed["message"],
        "{problem}"
    );
    assert!(
        problem["problem"]["help"]
            .as_str()
            .unwrap()
            .contains("supply"),
        "{problem}"
    );

    // The cable is back. Without a request the daemon stops the axis first and then reports the
    // drive as connected.
    cable.cut.store(false, Ordering::Release);
    let well = drive(&rig, "connected");
    assert_eq!(well["problem"], json!(null));
    let (state, at) = cable.seen();
    assert_eq!(state, DeviceState::SwitchOnDisabled);
    let gearing = axis.gearing;
    let angle = well["angle_deg"].as_f64().unwrap();
    assert!(
        angle > -39.0,
        "the axis reached its target: {angle} deg, {at}, {gearing:?}"
    );
}
