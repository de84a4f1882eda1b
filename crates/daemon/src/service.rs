//! The daemon: its threads, from the start to the stop.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use engine::config::Config;
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::service::{DeviceService, DeviceThread, Environment, Lifetime, ServiceOptions};
use engine::spawn;

use crate::http::server::{self, Server};
use crate::http::unix_socket::UnixSocket;
use crate::http::{api, tls};
use crate::limits::Waits;
use crate::scans::{self, Scans};
use crate::state::{DaemonState, FreeBytes};
use crate::{cloud_builder, health_monitor, ros2_bridge, sockets};

/// Between two looks whether the cloud builder has ended.
const POLL: Duration = Duration::from_millis(20);

/// Options of a daemon.
#[derive(Clone)]
pub struct Options {
    /// The configuration.
    pub config: Config,
    /// Name of the device's profile, where it is not the configuration's.
    pub device: Option<String>,
    /// The address, where it is not the configuration's.
    pub listen: Option<SocketAddr>,
    /// Commit of the program; empty if unknown.
    pub commit: &'static str,
    /// Folder of the Unix socket, where it is not the default.
    pub runtime: Option<PathBuf>,
    /// Time limits.
    pub waits: Waits,
    /// The machine's devices and clocks.
    pub environment: Environment,
    /// Free bytes on the disk of a path.
    pub free_bytes: Arc<FreeBytes>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            config: Config::default(),
            device: None,
            listen: None,
            commit: "",
            runtime: None,
            waits: Waits::default(),
            environment: Environment::default(),
            free_bytes: Arc::new(io::files::free_bytes),
        }
    }
}

/// A running daemon.
pub struct Daemon {
    state: Arc<DaemonState>,
    server: Server,
    address: SocketAddr,
    devices: DeviceThread,
    cloud_builder: JoinHandle<()>,
    health_monitor: JoinHandle<()>,
    health_monitor_end: Sender<()>,
    stop_ros2: Option<ros2_bridge::StopBridge>,
    /// Keeps other daemons out of the scans folder.
    _lock: std::fs::File,
}

impl Daemon {
    /// Starts everything. Absent devices are waited for.
    ///
    /// # Errors
    /// [`Kind::Usage`] where the address is not allowed or this build lacks a configured feature,
    /// [`Kind::BadInput`] for a wrong configuration or a folder that cannot be written,
    /// [`Kind::NoDevice`] where another daemon has the device.
    pub fn start(options: Options) -> Result<Self, Failure> {
        let mut config = options.config;
        let credentials = std::env::var_os("CREDENTIALS_DIRECTORY").map(PathBuf::from);
        config.daemon.load_credentials(credentials.as_deref())?;
        let listen = options.listen.unwrap_or(config.daemon.listen);
        config.daemon.check(listen)?;
        ros2_bridge::check(config.daemon.ros2.as_ref())?;
        let tls = tls::acceptor(&config.daemon)?;
        let (name, device) = profile::choose(&config, options.device.as_deref())?;
        let runtime = options.runtime.unwrap_or_else(sockets::folder);
        let socket = runtime.join(sockets::name(&name, &device)?);
        let folder = config.daemon.folder()?;
        // The sockets first: the scans folder may be that of another daemon.
        let unix = UnixSocket::bind(&socket)?;
        let (tcp, address) = server::bind_tcp(listen)?;
        let lock = scans::lock(&folder)?;
        let scans = Scans::open(&folder)?;
        let (service, devices) = DeviceService::start(ServiceOptions {
            config,
            name,
            device,
            lifetime: Lifetime::Resident,
            environment: options.environment,
        })?;
        let (jobs, queue) = channel();
        let mut state = DaemonState::new(service, scans, options.free_bytes, jobs.clone());
        state.commit = options.commit;
        let state = Arc::new(state);
        state.refresh_disk();
        let stop_ros2 = ros2_bridge::start(&state)?;
        for unfinished in cloud_builder::unfinished(&state) {
            // The receiver is `queue`.
            let _ = jobs.send(unfinished);
        }
        drop(jobs);
        let building = Arc::clone(&state);
        let cloud_builder = spawn("clouds", "clouds", move || {
            cloud_builder::run(&building, &queue);
        })?;
        let (health_monitor_end, end) = channel();
        let monitored = Arc::clone(&state);
        let health_monitor = spawn("health", "health", move || {
            health_monitor::run(&monitored, &end);
        })?;
        let server = api::serve(&state, (tcp, address), tls, unix, options.waits)?;
        Ok(Self {
            state,
            server,
            address,
            devices,
            cloud_builder,
            health_monitor,
            health_monitor_end,
            stop_ros2,
            _lock: lock,
        })
    }

    /// The TCP address.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The shared state.
    #[must_use]
    pub fn state(&self) -> &Arc<DaemonState> {
        &self.state
    }

    /// Whether the device thread has ended, which is a defect.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.devices.is_finished()
    }

    /// Stops the axis, finishes log and cloud, disconnects the clients. Once `hurry` returns true,
    /// clouds are left to the next start.
    ///
    /// # Errors
    /// [`Kind::DeviceFault`] where a thread had panicked.
    pub fn stop(self, hurry: impl Fn() -> bool) -> Result<(), Failure> {
        let state = &self.state;
        state.service.shut_down(
            Failure::new(
                Kind::Interrupted,
                "the daemon was stopped in the middle of this scan",
            )
            .help("scan again for the rest"),
        );
        let devices = self.devices.join();
        state.close_cloud_jobs();
        while !self.cloud_builder.is_finished() {
            if hurry() {
                state.abandon.store(true, Ordering::Release);
            }
            std::thread::sleep(POLL);
        }
        let clouds = self.cloud_builder.join().is_ok();
        let ros2 = self.stop_ros2.is_none_or(|stop| stop());
        drop(self.health_monitor_end);
        let health = self.health_monitor.join().is_ok();
        let events = Arc::clone(state.events());
        self.server.stop(events.clients_gone());
        if !(devices && clouds && ros2 && health) {
            return Err(
                Failure::new(Kind::DeviceFault, "a thread of the daemon had panicked")
                    .help("check that the axis is at rest; run with -vv and report the messages"),
            );
        }
        Ok(())
    }
}
