//! The owner of the devices: one thread runs captures and jogs, one after the other, for every
//! client.
//!
//! A client that moves the axis holds its [`AxisLease`]; dropping the lease makes the axis idle.
//! [`DeviceService::stop`] stops the motion of any holder. Status is a `watch`, events are a
//! `broadcast`: neither makes the device thread wait.

pub mod axis_report;
mod device_thread;
mod drive_connection;
pub mod events;
mod execute;
mod lease;
pub mod lidar_stats;
pub mod live_preview;
mod motion_reporter;
mod open_devices;
mod options;
pub mod record_feed;
pub mod scan_record;
mod service_state;
pub mod status;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::time::{Duration, Instant};

use sim::Truth;
use tokio::sync::{oneshot, watch};
use units::Span;

pub use device_thread::DeviceThread;
use lease::StopCount;
pub use lease::{AxisLease, LeaseError, StopSignal};
pub use options::{Environment, Lifetime, ServiceOptions};

use crate::capture::jog::{self, JogRequest};
use crate::capture::plan::CapturePlan;
use crate::capture::run::Outcome;
use crate::config::{Config, Device};
use crate::devices::lidar_receiver::{LidarReceiver, PacketTap};
use crate::devices::profile;
use crate::failure::{Failure, Kind};
use axis_report::{AxisReport, StopAnswer, StoppedCommand};
use device_thread::ThreadRequest;
use events::Events;
use lidar_stats::LidarStats;
use live_preview::LivePreview;
use record_feed::{RecordFeed, RecordQueue};
use service_state::ServiceState;
use status::{AxisTask, DeviceHealth};

/// Wait for a lidar that may have been switched on a moment ago; it is looked for every second.
const LIDAR_WAIT: Duration = Duration::from_secs(3);
const LIDAR_POLL: Duration = Duration::from_millis(50);
/// Wait for a request that only reads the drive's state.
const READ_WAIT: Duration = Duration::from_secs(5);
/// Attempts of a stop while other clients begin moves.
const STOP_ATTEMPTS: usize = 16;
/// Suspensions shorter than this are the difference of two clock readings.
const SHORTEST_SUSPENSION: Span = Span::from_millis(500);

/// The end of a capture whose motion began.
pub struct CaptureEnd {
    /// Result of the recording.
    pub outcome: Outcome,
    /// The simulator's truth, where the devices are simulated.
    pub truth: Option<Truth>,
}

/// The end of a capture, or why nothing was recorded.
pub type CaptureResult = Result<CaptureEnd, Failure>;

/// The devices and their status.
pub struct DeviceService {
    config: Config,
    name: String,
    device: Device,
    axis: drive::AxisConfig,
    lifetime: Lifetime,
    environment: Environment,
    events: Arc<Events>,
    state: watch::Sender<ServiceState>,
    preview: RecordFeed,
    packets: RecordFeed,
    receiver: Mutex<Option<Arc<LidarReceiver>>>,
    lidar_stats: Arc<Mutex<LidarStats>>,
    requests: mpsc::Sender<ThreadRequest>,
    ending: AtomicBool,
    connects: AtomicU64,
    stops: AtomicU64,
    capture_stops: AtomicU64,
    started: Instant,
    started_s: f64,
    /// Last heartbeat of the device thread, milliseconds after the start.
    heartbeat_ms: AtomicU64,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_s() -> f64 {
    io::clock::now().as_nanos() as f64 * 1e-9
}

impl DeviceService {
    /// Starts the device thread. A service for one command has its devices open when this returns.
    ///
    /// # Errors
    /// [`Kind::BadInput`] where the configuration describes no valid axis; for one command, also
    /// where a device cannot be opened.
    pub fn start(options: ServiceOptions) -> Result<(Arc<Self>, DeviceThread), Failure> {
        let (requests, inbox) = mpsc::channel();
        let axis = profile::axis(&options.config.axis)?;
        // A command prints its own messages.
        let resident = matches!(options.lifetime, Lifetime::Resident);
        let service = Arc::new(Self {
            config: options.config,
            name: options.name,
            device: options.device,
            axis,
            lifetime: options.lifetime,
            environment: options.environment,
            events: Arc::new(Events::new(resident)),
            state: watch::Sender::new(ServiceState::default()),
            preview: RecordFeed::default(),
            packets: RecordFeed::default(),
            receiver: Mutex::default(),
            lidar_stats: Arc::default(),
            requests,
            ending: AtomicBool::new(false),
            connects: AtomicU64::new(0),
            stops: AtomicU64::new(0),
            capture_stops: AtomicU64::new(0),
            started: Instant::now(),
            started_s: now_s(),
            heartbeat_ms: AtomicU64::new(0),
        });
        let thread = DeviceThread::start(&service, inbox)?;
        Ok((service, thread))
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The name of the device's profile, and the device.
    #[must_use]
    pub fn device(&self) -> (&str, &Device) {
        (&self.name, &self.device)
    }

    /// Whether the devices are simulated.
    #[must_use]
    pub fn simulated(&self) -> bool {
        profile::simulated(&self.device)
    }

    /// The events.
    #[must_use]
    pub fn events(&self) -> &Arc<Events> {
        &self.events
    }

    /// Whether the service is ending.
    #[must_use]
    pub fn is_ending(&self) -> bool {
        self.ending.load(Ordering::Acquire)
    }

    /// Times that the drive's port was opened.
    #[must_use]
    pub fn connects(&self) -> u64 {
        self.connects.load(Ordering::Relaxed)
    }

    /// Stops of the axis that clients have requested.
    #[must_use]
    pub fn stops(&self) -> u64 {
        self.stops.load(Ordering::Acquire)
    }

    fn stop_count(&self) -> StopCount {
        StopCount {
            axis: self.stops(),
            captures: self.capture_stops.load(Ordering::Acquire),
        }
    }

    /// The signal of a motion that a client asks for now, or for which it asked when it knew of so
    /// many stops of the axis ([`status::ServiceStatus`]): its request may arrive late. A later
    /// stop of any client prevents the motion if it has not begun.
    #[must_use]
    pub fn stop_signal(&self, known_stops: Option<u64>) -> StopSignal {
        let now = self.stop_count();
        StopSignal::after(StopCount {
            axis: known_stops.unwrap_or(now.axis),
            ..now
        })
    }

    /// Time since the last heartbeat of the device thread.
    #[must_use]
    pub fn time_since_heartbeat(&self) -> Duration {
        let last = Duration::from_millis(self.heartbeat_ms.load(Ordering::Relaxed));
        self.started.elapsed().saturating_sub(last)
    }

    /// Total time that the machine has been suspended.
    #[must_use]
    pub fn suspended(&self) -> Span {
        (self.environment.suspended)()
    }

    fn heartbeat(&self) {
        let now = u64::try_from(self.started.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.heartbeat_ms.store(now, Ordering::Relaxed);
        let task = self.state.borrow().activity.doing;
        (self.environment.heartbeat)(task);
    }

    /// Plans a capture into these files.
    ///
    /// # Errors
    /// As [`CapturePlan::of`].
    pub fn plan(
        &self,
        request: &crate::capture_request::CaptureRequest,
        cloud: std::path::PathBuf,
        log: std::path::PathBuf,
    ) -> Result<CapturePlan, Failure> {
        CapturePlan::of(request, &self.config, self.device(), cloud, log)
    }

    // Leases and motion.

    /// Takes the axis for a task, if it is idle.
    ///
    /// # Errors
    /// [`LeaseError`] where the axis is busy, the drive is not connected, or the service is ending.
    pub fn lease(self: &Arc<Self>, task: AxisTask) -> Result<AxisLease, LeaseError> {
        match &self.lifetime {
            Lifetime::Resident => self.lease_until(task, &StopSignal::default()),
            Lifetime::Command { interrupt, .. } => {
                AxisLease::take(self, task, StopSignal::of_command(interrupt, task))
            }
        }
    }

    /// Takes the axis of a daemon for a task that `stop` stops, if it is idle.
    ///
    /// # Errors
    /// As [`DeviceService::lease`], and [`Kind::Interrupted`] where a stop was requested before.
    pub fn lease_until(
        self: &Arc<Self>,
        task: AxisTask,
        stop: &StopSignal,
    ) -> Result<AxisLease, LeaseError> {
        if stop.is_requested() {
            let failure = Failure::new(Kind::Interrupted, "cancelled before it began");
            return Err(failure.help("nothing has moved").into());
        }
        self.require_drive()?;
        AxisLease::take(self, task, stop.clone())
    }

    /// Whether the motion under way is the one that `stop` stops.
    #[must_use]
    pub fn is_moved_until(&self, stop: &StopSignal) -> bool {
        let state = self.state.borrow();
        state.stop.as_ref().is_some_and(|lease| stop.is_of(lease))
    }

    /// # Errors
    /// [`LeaseError`] where the drive is not connected.
    pub fn require_drive(&self) -> Result<(), LeaseError> {
        let drive = &self.state.borrow().drive;
        let is_ready = drive.state != DeviceHealth::Absent;
        require(is_ready, &drive.problem, "the drive is not connected yet")
    }

    /// # Errors
    /// [`LeaseError`] where the lidar sends nothing.
    pub fn require_lidar(&self) -> Result<(), LeaseError> {
        let lidar = &self.state.borrow().lidar;
        let is_ready = lidar.state == DeviceHealth::Connected;
        let missing = "no packet of the lidar has arrived yet";
        require(is_ready, &lidar.problem, missing)
    }

    /// Begins a capture with the axis leased. It goes on if the receiver is dropped.
    ///
    /// # Errors
    /// [`LeaseError`] where the device thread is gone.
    pub fn capture(
        &self,
        lease: AxisLease,
        plan: CapturePlan,
    ) -> Result<oneshot::Receiver<CaptureResult>, LeaseError> {
        let (answer, result) = oneshot::channel();
        let plan = Box::new(plan);
        self.request(ThreadRequest::Capture {
            lease,
            plan,
            answer,
        })?;
        Ok(result)
    }

    /// Begins a jog, in a daemon one that `stop` stops. It goes on if the receiver is dropped.
    ///
    /// # Errors
    /// [`LeaseError`]; [`Kind::Usage`] for a move that the axis cannot make.
    pub fn jog(
        self: &Arc<Self>,
        request: JogRequest,
        stop: Option<&StopSignal>,
    ) -> Result<oneshot::Receiver<Result<AxisReport, Failure>>, LeaseError> {
        let commands = jog::commands(request, &self.config, &self.device)?;
        let task = match request {
            JogRequest::Home => AxisTask::Homing,
            JogRequest::Goto(_) => AxisTask::Moving,
            JogRequest::Status | JogRequest::Stop | JogRequest::ClearFaults => AxisTask::Stopping,
        };
        let lease = match stop {
            Some(stop) => self.lease_until(task, stop)?,
            None => self.lease(task)?,
        };
        if matches!(request, JogRequest::Status) {
            self.update_activity(|activity| activity.reads_only = true);
        }
        let (answer, report) = oneshot::channel();
        self.request(ThreadRequest::Jog {
            lease,
            commands,
            answer,
        })?;
        Ok(report)
    }

    /// Runs a jog, which `stop` stops if it moves, to its end.
    ///
    /// # Errors
    /// As [`DeviceService::jog`], and where the motion failed.
    pub async fn run_jog(
        self: &Arc<Self>,
        request: JogRequest,
        stop: Option<&StopSignal>,
    ) -> Result<AxisReport, LeaseError> {
        let commands = jog::commands(request, &self.config, &self.device);
        commands?;
        if !matches!(request, JogRequest::Status) {
            self.wait_for_reads().await;
        }
        match self.jog(request, stop)?.await {
            Ok(report) => Ok(report?),
            Err(_) => Err(LeaseError::Failure(
                Failure::new(Kind::Interrupted, "the daemon is ending")
                    .help("the axis is stopped; start the daemon again"),
            )),
        }
    }

    /// Stops the motion under way. Returns whether anything did.
    pub fn stop(&self, reason: Option<Failure>) -> bool {
        let stop = self.state.borrow().stop.clone();
        if let Some(stop) = &stop {
            stop.request(reason);
        }
        stop.is_some()
    }

    /// Stops the motion under way, waits until it is at rest, and sets the brake.
    ///
    /// # Errors
    /// [`LeaseError`] where the axis could not be stopped.
    pub async fn stop_axis(self: &Arc<Self>) -> Result<StopAnswer, LeaseError> {
        self.stops.fetch_add(1, Ordering::AcqRel);
        self.send_status();
        if let Lifetime::Command { .. } = self.lifetime {
            self.stop(None);
            self.wait_idle().await;
            let state = self.state.borrow();
            return match state.may_move {
                false => Ok(StopAnswer::Command(StoppedCommand {
                    device: self.name.clone(),
                    stopped: true,
                    state: state
                        .statusword
                        .map_or("unknown".to_owned(), axis_report::state_name),
                    power: state.statusword.is_some_and(axis_report::has_power),
                })),
                true => Err(LeaseError::Failure(
                    Failure::new(
                        Kind::DeviceFault,
                        "the command that uses the drive could not stop the axis",
                    )
                    .help("switch the motor's supply off if the axis moves"),
                )),
            };
        }
        let mut attempts = 0;
        loop {
            attempts += 1;
            self.stop(None);
            self.wait_idle().await;
            match self.run_jog(JogRequest::Stop, None).await {
                // Another client was quicker: its motion is stopped, too.
                Err(LeaseError::Busy(_)) if attempts < STOP_ATTEMPTS => {}
                done => return done.map(|report| StopAnswer::Report(Box::new(report))),
            }
        }
    }

    /// Stops a capture and waits until the axis is at rest; other motion goes on. Returns whether
    /// there was a capture, and the scan's id.
    pub async fn stop_capture(&self) -> (bool, Option<String>) {
        self.capture_stops.fetch_add(1, Ordering::AcqRel);
        let mut state = self.state.subscribe();
        // The signal of the capture, which stops no motion that begins from here on.
        let capture = {
            let state = state.borrow();
            let is_capture = state.activity.doing == AxisTask::Capturing;
            state.stop.clone().filter(|_| is_capture)
        };
        let Some(stop) = capture else {
            return (false, None);
        };
        stop.request(None);
        // A capture that began a moment ago has no id yet.
        let mut scan: Option<String> = None;
        loop {
            {
                let state = state.borrow_and_update();
                let is_under_way = state.stop.as_ref().is_some_and(|lease| stop.is_of(lease));
                if !is_under_way {
                    break;
                }
                scan = scan.or_else(|| state.activity.scan.clone());
            }
            // The sender lives as long as `self`.
            if state.changed().await.is_err() {
                break;
            }
        }
        (true, scan)
    }

    /// Waits until the axis is idle. All motion has time limits of its own.
    async fn wait_idle(&self) {
        let mut state = self.state.subscribe();
        let idle = |state: &ServiceState| state.activity.doing == AxisTask::Idle;
        let _ = state.wait_for(idle).await;
    }

    /// Waits for requests that only read the drive's state, and for the connection: they must not
    /// have a motion refused.
    pub async fn wait_for_reads(&self) {
        let mut state = self.state.subscribe();
        let none = state.wait_for(|state| {
            !state.activity.reads_only && state.activity.doing != AxisTask::Connecting
        });
        let _ = tokio::time::timeout(READ_WAIT, none).await;
    }

    /// [`DeviceService::known_report`], after the first report of a drive that a command moves.
    pub async fn wait_for_report(&self) -> Option<AxisReport> {
        let mut state = self.state.subscribe();
        let known = state.wait_for(|state| {
            state.activity.doing == AxisTask::Idle
                || state.reported_at.is_some()
                || state.live_at.is_some()
        });
        let _ = tokio::time::timeout(READ_WAIT, known).await;
        self.known_report()
    }

    /// Waits for the first packet of a lidar that is not known to be silent.
    pub async fn wait_for_lidar(&self) {
        let unknown = || {
            let state = self.state.borrow();
            state.lidar.state == DeviceHealth::Absent && state.lidar.problem.is_none()
        };
        let mut left = LIDAR_WAIT;
        while unknown() && !left.is_zero() {
            tokio::time::sleep(LIDAR_POLL).await;
            left = left.saturating_sub(LIDAR_POLL);
        }
    }

    /// Ends the service: stops the axis for `reason`, refuses new leases. [`DeviceThread::join`]
    /// waits for the end.
    pub fn shut_down(&self, reason: Failure) {
        // Before the stop: a lease taken later sees the flag, one taken earlier is stopped.
        self.ending.store(true, Ordering::Release);
        self.stop(Some(reason));
        // A device thread that is gone needs no waking.
        let _ = self.request(ThreadRequest::Wake);
    }

    /// Opens the devices again: the machine was suspended, and they may be others now.
    pub fn reopen(&self, reason: Failure) {
        self.stop(Some(reason));
        // A device thread that is gone has no devices.
        let _ = self.request(ThreadRequest::Reopen);
    }

    fn request(&self, request: ThreadRequest) -> Result<(), LeaseError> {
        self.requests
            .send(request)
            .map_err(|_| LeaseError::ending())
    }

    // The lidar.

    /// Takes records of the lidar into its statistics, the preview and the queue of
    /// [`DeviceService::feed_packets`].
    #[must_use]
    pub fn packet_tap(&self) -> PacketTap {
        let stats = Arc::clone(&self.lidar_stats);
        let (preview, packets) = (self.preview.clone(), self.packets.clone());
        Box::new(move |record| {
            locked(&stats).observe(record);
            preview.record(record);
            packets.record(record);
        })
    }

    /// Passes all records of the lidar on to `queue` from now on, also between captures, or to
    /// none.
    pub fn feed_packets(&self, queue: Option<RecordQueue>) {
        self.packets.set(queue);
    }

    /// Starts the preview of a scan. `None` where there is no thread for it.
    #[must_use]
    pub fn start_preview(&self, scan: &str, config: &scanner::ScanConfig) -> Option<LivePreview> {
        LivePreview::start(scan, config, &self.preview, &self.events)
    }

    /// The receiver of the lidar's packets.
    #[must_use]
    pub fn receiver(&self) -> Option<Arc<LidarReceiver>> {
        locked(&self.receiver).clone()
    }

    fn set_receiver(&self, receiver: Option<Arc<LidarReceiver>>) {
        let old = std::mem::replace(&mut *locked(&self.receiver), receiver);
        // Joins its thread, without the lock.
        drop(old);
    }
}

/// Refuses a device that is not ready: with its problem, or as `missing`.
fn require(is_ready: bool, problem: &Option<Failure>, missing: &str) -> Result<(), LeaseError> {
    if is_ready {
        return Ok(());
    }
    Err(LeaseError::Failure(problem.clone().unwrap_or_else(|| {
        Failure::new(Kind::NoDevice, missing).help("wait a moment, and look at the status")
    })))
}

/// The failure of a capture during which the machine was suspended, from the total time suspended
/// before and after it.
#[must_use]
pub fn suspension(before: Span, after: Span) -> Option<Failure> {
    let suspended = after - before;
    (suspended >= SHORTEST_SUSPENSION).then(|| {
        Failure::new(
            Kind::Incomplete,
            format!(
                "the machine was suspended for {:.0} s",
                suspended.as_secs_f64()
            ),
        )
        .help("scan again; see whether the machine may sleep while it scans (systemd-inhibit)")
    })
}
