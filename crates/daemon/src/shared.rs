//! What the daemon's threads and its clients' requests share.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use io::discover::ConnectedDevices;
use tokio::sync::watch;
use units::{Rpm, Span};

use super::hub::{Event, Hub, Level};
use super::keeper::Order;
use super::monitor::Monitor;
use super::points::Feed;
use super::scans::{ScanRecord, Scans};
use super::view::{
    Activity, AxisView, ClientsView, DeviceState, DiskView, Doing, DriveView, LidarView, Status,
};
use engine::capture::jog as tilting;
use engine::config::daemon::DaemonConfig;
use engine::config::{Config, Device};
use engine::devices::lidar_receiver::LidarReceiver;
use engine::devices::profile as devices;
use engine::failure::{Failure, Kind};

/// Says how many bytes are free on the disk of a path.
pub type FreeBytes = dyn Fn(&Path) -> std::io::Result<u64> + Send + Sync;

/// Says what is plugged in.
pub type Plugged = dyn Fn() -> ConnectedDevices + Send + Sync;

/// What of the machine tests make up.
#[derive(Clone)]
pub struct World {
    /// What is plugged in, where the drive is looked for.
    pub plugged: Arc<Plugged>,
    /// Free bytes on the disk of a path.
    pub free_bytes: Arc<FreeBytes>,
    /// How long the machine has slept since it was started.
    pub suspended: Arc<dyn Fn() -> Span + Send + Sync>,
    /// What happens whenever the keeper shows that it is alive, on its own thread, with what it is doing: nothing.
    pub beat: Arc<dyn Fn(Doing) + Send + Sync>,
}

impl Default for World {
    fn default() -> Self {
        Self {
            plugged: Arc::new(io::discover::discover),
            free_bytes: Arc::new(io::files::free_bytes),
            suspended: Arc::new(io::clock::suspended),
            beat: Arc::new(|_| {}),
        }
    }
}

/// Counters since the start.
#[derive(Debug, Default)]
pub struct Counters {
    /// Captures that were begun.
    pub captures: AtomicU64,
    /// Of those: whole.
    pub whole: AtomicU64,
    /// Partial.
    pub partial: AtomicU64,
    /// Failed.
    pub failed: AtomicU64,
    /// Requests that were answered.
    pub requests: AtomicU64,
    /// Of those: refused.
    pub refused: AtomicU64,
    /// Times that the drive's port was opened.
    pub connects: AtomicU64,
}

impl Counters {
    /// One more.
    pub fn count(counter: &AtomicU64) {
        counter.fetch_add(1, Ordering::Relaxed);
    }
}

/// Why something cannot be done now.
#[derive(Clone, Debug)]
pub enum Refused {
    /// The axis is busy.
    Busy(Doing),
    /// Anything else.
    Failure(Failure),
}

/// The shared state. Locks are held for moments only, never while a disk or a device is waited for.
pub struct Shared {
    /// The whole configuration.
    pub config: Config,
    /// Name of the device's profile.
    pub name: String,
    /// The device.
    pub device: Device,
    /// Everybody who is told.
    pub hub: Arc<Hub>,
    /// The scans.
    pub scans: Scans,
    /// Counters.
    pub counters: Counters,
    /// What was sent to ROS 2.
    pub ros2: super::ros2::counts::Counts,
    /// The machine.
    pub world: World,
    /// Where records go while a scan is watched.
    pub feed: Feed,
    /// What the lidar's packets show.
    pub monitor: Mutex<Monitor>,
    /// Set by whoever wants the axis to stop.
    pub interrupt: Arc<AtomicBool>,
    /// Set once: the daemon ends.
    pub ending: AtomicBool,
    /// Set once more: what is being made is not waited for.
    pub abandon: AtomicBool,
    started_s: f64,
    slowest_deg_s: f64,
    activity: watch::Sender<Activity>,
    drive: Mutex<DriveView>,
    lidar: Mutex<LidarView>,
    /// As it was last seen.
    disk: Mutex<DiskView>,
    hearing: Mutex<Option<Arc<LidarReceiver>>>,
    report: Mutex<Option<tilting::Report>>,
    /// When it was said, if nothing has happened since.
    reported: Mutex<Option<Instant>>,
    stop_reason: Mutex<Option<Failure>>,
    orders: Mutex<Sender<Order>>,
    /// When the keeper was last seen alive.
    alive: Mutex<Instant>,
}

/// So long what the drive has said is not asked for again.
const FRESH: Duration = Duration::from_millis(500);

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Seconds of the system's clock.
#[must_use]
pub fn now_s() -> f64 {
    io::clock::now().as_nanos() as f64 * 1e-9
}

impl Shared {
    /// Nothing is known yet of the devices.
    #[must_use]
    pub fn new(
        config: Config,
        (name, device): (String, Device),
        scans: Scans,
        world: World,
        orders: Sender<Order>,
    ) -> Self {
        // An axis that cannot be is refused where the keeper is made.
        let slowest = |axis: drive::AxisConfig| axis.gearing.rate(Rpm(1)).0.abs();
        let slowest_deg_s = devices::axis(&config.axis).map_or(0.0, slowest);
        Self {
            config,
            name,
            device,
            hub: Arc::default(),
            scans,
            counters: Counters::default(),
            ros2: super::ros2::counts::Counts::default(),
            world,
            feed: Feed::default(),
            monitor: Mutex::default(),
            interrupt: Arc::default(),
            ending: AtomicBool::new(false),
            abandon: AtomicBool::new(false),
            started_s: now_s(),
            slowest_deg_s,
            activity: watch::Sender::new(Activity::default()),
            drive: Mutex::default(),
            lidar: Mutex::default(),
            disk: Mutex::default(),
            hearing: Mutex::default(),
            report: Mutex::default(),
            reported: Mutex::default(),
            stop_reason: Mutex::default(),
            orders: Mutex::new(orders),
            alive: Mutex::new(Instant::now()),
        }
    }

    /// `[daemon]`.
    #[must_use]
    pub fn settings(&self) -> &DaemonConfig {
        &self.config.daemon
    }

    /// Whether the devices are software.
    #[must_use]
    pub fn simulated(&self) -> bool {
        devices::simulated(&self.device)
    }

    /// Whether the daemon ends.
    #[must_use]
    pub fn is_ending(&self) -> bool {
        self.ending.load(Ordering::Acquire)
    }

    /// What is being done.
    #[must_use]
    pub fn activity(&self) -> Activity {
        self.activity.borrow().clone()
    }

    /// What is being done, followed.
    #[must_use]
    pub fn follow(&self) -> watch::Receiver<Activity> {
        self.activity.subscribe()
    }

    /// Takes the axis for `doing`, if nobody has it.
    ///
    /// # Errors
    /// [`Refused`] where it is busy, or the drive is not there.
    pub fn take(&self, doing: Doing, scan: Option<String>) -> Result<(), Refused> {
        if self.is_ending() {
            return Err(Refused::Failure(
                Failure::new(Kind::Interrupted, "the daemon is ending").help("start it again"),
            ));
        }
        self.drive_is_there()?;
        let mut busy = None;
        self.activity.send_if_modified(|activity| {
            if activity.doing != Doing::Idle {
                busy = Some(activity.doing);
                return false;
            }
            // What stopped the last one does not stop this one. Not later: whoever sees that the axis is taken may stop it at once.
            self.interrupt.store(false, Ordering::Release);
            *locked(&self.stop_reason) = None;
            *activity = Activity {
                doing,
                scan: scan.clone(),
                ..Activity::default()
            };
            true
        });
        match busy {
            Some(doing) => Err(Refused::Busy(doing)),
            None => {
                *locked(&self.reported) = None;
                Ok(())
            }
        }
    }

    /// # Errors
    /// [`Refused`] where the drive is not there.
    pub fn drive_is_there(&self) -> Result<(), Refused> {
        let drive = self.drive();
        if drive.state != DeviceState::Absent {
            return Ok(());
        }
        Err(Refused::Failure(drive.problem.unwrap_or_else(|| {
            Failure::new(Kind::NoDevice, "the drive is not connected yet")
                .help("wait a moment, and look at the status")
        })))
    }

    /// # Errors
    /// [`Refused`] where the lidar is not heard.
    pub fn lidar_is_heard(&self) -> Result<(), Refused> {
        let lidar = self.lidar();
        if lidar.state == DeviceState::Connected {
            return Ok(());
        }
        Err(Refused::Failure(lidar.problem.unwrap_or_else(|| {
            Failure::new(Kind::NoDevice, "the lidar is not heard yet")
                .help("wait a moment, and look at the status")
        })))
    }

    /// Takes the axis for what moves nothing, if nobody has it; whether it was free.
    pub fn claim(&self, doing: Doing) -> bool {
        self.activity.send_if_modified(|activity| {
            let free = activity.doing == Doing::Idle;
            if free {
                activity.doing = doing;
            }
            free
        })
    }

    /// The axis is free: only for who has it.
    pub fn set_idle(&self) {
        self.activity.send_replace(Activity::default());
        self.tell_status();
    }

    /// Changes what is said of what is being done.
    pub fn note(&self, change: impl FnOnce(&mut Activity)) {
        self.activity.send_modify(change);
    }

    /// Sends an order to the keeper.
    ///
    /// # Errors
    /// Where the keeper is gone.
    pub fn order(&self, order: Order) -> Result<(), Refused> {
        locked(&self.orders).send(order).map_err(|_| {
            Refused::Failure(
                Failure::new(Kind::Interrupted, "the daemon is ending").help("start it again"),
            )
        })
    }

    /// Has the axis stopped, if anything moves it; whether anything did.
    pub fn interrupt(&self, reason: Option<Failure>) -> bool {
        if self.activity.borrow().doing == Doing::Idle {
            return false;
        }
        if let Some(reason) = reason {
            locked(&self.stop_reason).get_or_insert(reason);
        }
        self.interrupt.store(true, Ordering::Release);
        true
    }

    /// Why the axis was stopped, where it was not the user.
    #[must_use]
    pub fn stop_reason(&self) -> Option<Failure> {
        locked(&self.stop_reason).clone()
    }

    /// The drive.
    #[must_use]
    pub fn drive(&self) -> DriveView {
        locked(&self.drive).clone()
    }

    /// Changes what is known of the drive; everybody is told of a change of its state.
    pub fn set_drive(&self, change: impl FnOnce(&mut DriveView)) {
        let (before, after) = {
            let mut drive = locked(&self.drive);
            let before = (drive.state, drive.problem.clone());
            change(&mut drive);
            (before, (drive.state, drive.problem.clone()))
        };
        self.device_changed("drive", before, after);
    }

    /// The lidar.
    #[must_use]
    pub fn lidar(&self) -> LidarView {
        locked(&self.lidar).clone()
    }

    /// Changes what is known of the lidar; everybody is told of a change of its state.
    pub fn set_lidar(&self, change: impl FnOnce(&mut LidarView)) {
        let (before, after) = {
            let mut lidar = locked(&self.lidar);
            let before = (lidar.state, lidar.problem.clone());
            change(&mut lidar);
            (before, (lidar.state, lidar.problem.clone()))
        };
        self.device_changed("lidar", before, after);
    }

    fn device_changed(
        &self,
        which: &str,
        before: (DeviceState, Option<Failure>),
        after: (DeviceState, Option<Failure>),
    ) {
        if before == after {
            return;
        }
        *locked(&self.reported) = None;
        match (after.0, after.1) {
            (_, Some(problem)) => {
                let text = format!("{which}: {}", problem.message);
                self.hub.say(Level::Error, text, problem.help);
            }
            (DeviceState::Connected, None) => {
                self.hub
                    .say(Level::Info, format!("{which}: connected"), None);
            }
            (DeviceState::Absent | DeviceState::Fault, None) => {}
        }
        self.tell_status();
    }

    /// What the drive last said about itself.
    #[must_use]
    pub fn report(&self) -> Option<tilting::Report> {
        locked(&self.report).clone()
    }

    /// The drive has said something about itself, or nothing is known any more.
    pub fn set_report(&self, report: Option<tilting::Report>) {
        *locked(&self.reported) = report.is_some().then(Instant::now);
        *locked(&self.report) = report;
    }

    /// The same, if it was said a moment ago and nothing has happened since.
    #[must_use]
    pub fn fresh_report(&self) -> Option<tilting::Report> {
        let is_fresh = |at: &Instant| at.elapsed() < FRESH;
        let fresh = locked(&self.reported).is_some_and(|at| is_fresh(&at));
        self.report().filter(|_| fresh)
    }

    /// Who listens to the lidar.
    #[must_use]
    pub fn hearing(&self) -> Option<Arc<LidarReceiver>> {
        locked(&self.hearing).clone()
    }

    /// Somebody else listens to it from now on, or nobody.
    pub fn set_hearing(&self, hearing: Option<Arc<LidarReceiver>>) {
        let old = std::mem::replace(&mut *locked(&self.hearing), hearing);
        drop(old);
    }

    /// The keeper is alive. Where the daemon ends, whatever it moves is to stop.
    pub fn beat(&self) {
        *locked(&self.alive) = Instant::now();
        let doing = self.activity.borrow().doing;
        (self.world.beat)(doing);
        if self.is_ending() {
            self.interrupt.store(true, Ordering::Release);
        }
    }

    /// How long nothing was seen of the keeper.
    #[must_use]
    pub fn silence(&self) -> Duration {
        locked(&self.alive).elapsed()
    }

    /// Sees what the disk has. Never on the keeper's thread, nor on one that answers: a disk may take seconds, and a stop may not.
    pub fn look_at_disk(&self) {
        let (scans, scans_bytes) = self.scans.size();
        let settings = self.settings();
        let seen = DiskView {
            free_bytes: (self.world.free_bytes)(self.scans.folder()).ok(),
            reserve_bytes: settings.reserve_bytes,
            scans,
            scans_bytes,
            keep_scans: settings.keep_scans,
            keep_bytes: settings.keep_bytes,
        };
        *locked(&self.disk) = seen;
    }

    /// Everything, as it was last seen: nothing is waited for.
    #[must_use]
    pub fn status(&self) -> Status {
        let axis = &self.config.axis;
        Status {
            version: env!("CARGO_PKG_VERSION"),
            device: self.name.clone(),
            simulated: self.simulated(),
            started_s: self.started_s,
            now_s: now_s(),
            activity: self.activity(),
            drive: self.drive(),
            lidar: self.lidar(),
            axis: AxisView {
                min_deg: axis.min_deg,
                max_deg: axis.max_deg,
                max_speed_deg_s: axis.max_speed_deg_s,
                min_speed_deg_s: self.slowest_deg_s,
                max_accel_deg_s2: axis.max_accel_deg_s2,
                accel_deg_s2: self.device.accel_deg_s2,
                home_deg: axis.homing.to_deg,
            },
            disk: *locked(&self.disk),
            clients: ClientsView {
                events: self.hub.len(),
                dropped: self.hub.dropped(),
            },
        }
    }

    /// Tells everybody how everything is.
    pub fn tell_status(&self) {
        if !self.hub.is_empty() {
            let status = Box::new(self.status());
            self.hub.tell(Event::Status { status });
        }
    }

    /// Changes a scan and tells everybody. What the disk does not take is said; the list has it.
    pub fn change_scan(&self, id: &str, change: impl FnOnce(&mut ScanRecord)) {
        let changed = self.scans.change(id, change).unwrap_or_else(|failure| {
            self.hub.say(Level::Error, failure.message, failure.help);
            self.scans.view(id)
        });
        if let Some(scan) = changed {
            self.hub.tell(Event::Scan {
                scan: Box::new(scan),
                deleted: false,
            });
        }
    }

    /// Deletes what is beyond what is kept.
    pub fn retain(&self) {
        let settings = self.settings();
        for scan in self.scans.retain(settings.keep_scans, settings.keep_bytes) {
            self.hub.say(
                Level::Info,
                format!(
                    "the scan {} was deleted to keep no more than is configured",
                    scan.id
                ),
                None,
            );
            self.hub.tell(Event::Scan {
                scan: Box::new(scan),
                deleted: true,
            });
        }
    }

    /// Where the lidar is to be heard.
    #[must_use]
    pub fn listen_config(&self) -> io::udp::ListenConfig {
        engine::devices::lidar_sockets::listen_config(&self.device)
    }

    /// The cloud of a scan.
    #[must_use]
    pub fn cloud(&self, id: &str) -> PathBuf {
        self.scans.place(id).join(super::scans::CLOUD)
    }

    /// The log of a scan.
    #[must_use]
    pub fn log(&self, id: &str) -> PathBuf {
        self.scans.place(id).join(super::scans::LOG)
    }
}
