//! Captures in real time: a daemon in its own process, devices in this one, and a disk that may be
//! full.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use engine::capture_request::CaptureRequest;
use engine::service::scan_record::{ScanState, ScanView};
use serde_json::Value;
use tempfile::TempDir;
use units::Span;
use velomotion_tests::bench::{Bench, free_port};
use velomotion_tests::random::Random;

use crate::check::{self, Wanted};
use crate::disk::Disk;
use crate::plan::{Plan, Real};
use crate::process::{Process, wait};

/// Time within which a started daemon has the axis at rest with its power stage off.
pub const SAFE: Duration = Duration::from_secs(10);

/// Outcome of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureOutcome {
    /// The scan ended in this state.
    Scan(ScanState),
    /// Not possible on this machine.
    Skipped,
}

/// A capture, and how long the axis had no master.
#[derive(Clone, Copy, Debug)]
pub struct CaptureResult {
    /// The outcome.
    pub came: CaptureOutcome,
    /// Time from the next daemon's start, or the cable's return, until the axis stood with its
    /// power off.
    pub safe_after: Option<Duration>,
}

/// Devices, a daemon and its folder of scans.
pub struct World {
    daemon: Process,
    bench: Bench,
    scans: PathBuf,
    disk: Option<Disk>,
    /// Dropped last: it holds the disk.
    folder: TempDir,
}

/// Configuration of a daemon for devices at these addresses.
pub fn configuration(link: &str, scans: &str, ports: (u16, u16)) -> String {
    format!(
        "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '{link}'\nlidar = '127.0.0.1'\n\
         data_port = {}\nposition_port = {}\n[axis]\nbrake_output = 1\n\
         [daemon]\nscans = '{scans}'\nreserve_bytes = 1000000\nkeep_scans = 100000\n",
        ports.0, ports.1
    )
}

impl World {
    /// Starts everything. With `small` the scans are on a disk that can be filled.
    pub fn start(small: bool) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let scans = folder.path().join("disk");
        let disk = match small {
            true => Some(Disk::mount(&scans)?),
            false => None,
        };
        let scans = scans.join("scans");
        let bench = Bench::start();
        let text = configuration(
            &bench.link().display().to_string(),
            &scans.display().to_string(),
            bench.ports(),
        );
        std::fs::write(folder.path().join("velomotion.toml"), text)
            .map_err(|error| error.to_string())?;
        let daemon = Process::start(folder.path())?;
        Ok(Self {
            folder,
            scans,
            bench,
            daemon,
            disk,
        })
    }

    /// Makes the capture of a plan and checks every condition.
    pub fn capture(&mut self, plan: &Plan, what: Real) -> Result<CaptureResult, String> {
        if what == Real::DiskFull && self.disk.is_none() {
            return Ok(CaptureResult {
                came: CaptureOutcome::Skipped,
                safe_after: None,
            });
        }
        let made = self.capture_with_fault(plan, what);
        made.map_err(|why| {
            let log = std::fs::read_to_string(self.folder.path().join("daemon.log"));
            let printed = log.unwrap_or_default();
            let last: Vec<&str> = printed.lines().rev().take(12).collect();
            let last: Vec<&str> = last.into_iter().rev().collect();
            format!("{why}; the daemon's log:\n    {}", last.join("\n    "))
        })
    }

    fn capture_with_fault(&mut self, plan: &Plan, what: Real) -> Result<CaptureResult, String> {
        self.ready()?;
        let request = CaptureRequest {
            speed_deg_s: plan.sweep_request.speed.0,
            from_deg: Some(plan.sweep_request.from.0),
            to_deg: Some(plan.sweep_request.to.0),
            accel_deg_s2: Some(plan.sweep_request.acceleration.0),
            sweeps: Some(plan.sweep_request.sweeps),
            both_ways: plan.sweep_request.both_ways,
            tolerance: None,
            name: Some(plan.name()),
        };
        let answer = self
            .daemon
            .client
            .post::<ScanView>("/api/v1/captures", &request);
        if let Err(refused) = answer {
            // The fault has not started.
            return Err(format!("refused: {refused}"));
        }
        pause(plan.after);
        self.inject(plan, what)?;
        pause(plan.mended_after);
        let safe_after = self.repair(what)?;
        let scan = self.over(&plan.name())?;
        self.ready()?;
        if !self.bench.is_safe() {
            return Err("idle, and the axis moves or is powered".to_owned());
        }
        let all = check::list(&self.daemon.client)?;
        check::agree(&all, &self.scans)?;
        // The scan may have ended before the fault, and a busy machine delays devices.
        check::check_scan(&scan, &self.scans, Wanted::Any)?;
        check::check_without_sweep(&scan, &self.scans)?;
        self.check_complete(&scan)?;
        self.daemon
            .client
            .delete(&format!("/api/v1/scans/{}", scan.id))
            .map_err(|failure| failure.to_string())?;
        check::agree(&check::list(&self.daemon.client)?, &self.scans)?;
        Ok(CaptureResult {
            came: CaptureOutcome::Scan(scan.state),
            safe_after,
        })
    }

    /// Checks that a scan marked as complete has all sweeps and packets.
    fn check_complete(&self, scan: &ScanView) -> Result<(), String> {
        if scan.state != ScanState::Whole {
            return Ok(());
        }
        let path = format!("/api/v1/scans/{}", scan.id);
        let whole: Value = self.daemon.client.get(&path).map_err(|f| f.to_string())?;
        let report = &whole["report"];
        let request = scan.request.as_ref().ok_or("the request is unknown")?;
        let sweeps = report["sweeps"].as_array().map_or(0, Vec::len);
        let far = report["sweeps"]
            .as_array()
            .into_iter()
            .flatten()
            .all(|sweep| {
                let angle = |key: &str| sweep[key].as_f64().unwrap_or(f64::NAN);
                let range = (angle("to_deg") - angle("from_deg")).abs();
                (range - request.to_deg.unwrap_or(f64::NAN).abs()).abs() < 0.2
            });
        let lost = report["lost_packets"].as_u64();
        match (sweeps == request.sweeps.unwrap_or(1) as usize, far, lost) {
            (true, true, Some(0)) => Ok(()),
            _ => Err(format!("{}: reported whole: {report}", scan.id)),
        }
    }

    fn inject(&mut self, plan: &Plan, what: Real) -> Result<(), String> {
        match what {
            Real::Nothing => {}
            Real::UsbGone => self.bench.unplug(true),
            Real::LidarGone => self.bench.silence(true),
            Real::PacketsLost => self.bench.lose(2 + plan.seed % 50),
            Real::Killed => self.daemon.kill()?,
            Real::Ended => self.daemon.end()?,
            Real::DiskFull => {
                let left = Random(plan.seed).below(400_000);
                self.disk.as_ref().map_or(Ok(()), |disk| disk.fill(left))?;
            }
        }
        Ok(())
    }

    /// Repairs the fault. Returns how long the axis then was unsafe, if it may have been.
    fn repair(&mut self, what: Real) -> Result<Option<Duration>, String> {
        let begin = Instant::now();
        match what {
            Real::Nothing => return Ok(None),
            Real::LidarGone => self.bench.silence(false),
            Real::PacketsLost => self.bench.lose(0),
            Real::DiskFull => self.disk.as_ref().map_or(Ok(()), Disk::empty)?,
            Real::UsbGone => self.bench.unplug(false),
            Real::Killed | Real::Ended => self.daemon = Process::start(self.folder.path())?,
        }
        if !matches!(what, Real::UsbGone | Real::Killed | Real::Ended) {
            return Ok(None);
        }
        wait("the axis at rest", || self.bench.is_safe().then_some(()))?;
        let took = begin.elapsed();
        match took > SAFE {
            true => Err(format!(
                "the axis was safe after {:.1} s",
                took.as_secs_f64()
            )),
            false => Ok(Some(took)),
        }
    }

    /// Waits until both devices are connected and the axis is idle.
    fn ready(&self) -> Result<(), String> {
        let mut last = Value::Null;
        let ready = wait("both devices", || {
            last = self.daemon.client.get("/api/v1/status").ok()?;
            let connected = |which: &str| last[which]["state"] == "connected";
            let idle = last["activity"]["doing"] == "idle";
            (connected("drive") && connected("lidar") && idle).then_some(())
        });
        ready.map_err(|why| {
            let (drive, lidar) = (&last["drive"], &last["lidar"]);
            format!("{why}: {drive}, {lidar}, {}", last["activity"])
        })
    }

    /// Waits for the final state of the scan of that name, with its record on disk.
    fn over(&self, name: &str) -> Result<ScanView, String> {
        let mut lost = None;
        let over = wait("the end of the scan", || {
            let all = check::list(&self.daemon.client).ok()?;
            match check::named(&all, name) {
                // The disk has space again.
                Ok(scan) if scan.state.is_final() && !scan.waits_for_room => {
                    check::written(scan, &self.scans).then(|| scan.clone())
                }
                Ok(_) => None,
                Err(why) => {
                    lost = Some(why);
                    None
                }
            }
        });
        over.map_err(|why| lost.unwrap_or(why))
    }
}

fn pause(span: Span) {
    std::thread::sleep(Duration::from_nanos(
        u64::try_from(span.as_nanos()).unwrap_or(0),
    ));
}

/// Configuration whose devices do not exist.
pub fn nowhere(scans: &str) -> String {
    configuration("/nonexistent/epos", scans, (free_port(), free_port()))
}
