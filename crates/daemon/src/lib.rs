//! `velomotion daemon`: one process that has the drive and the lidar, keeps the scans, and answers whoever asks.
//!
//! Threads of their own do what must not wait: the keeper has the devices, the lidar is heard, the log written, the live view made, clouds made
//! of logs. A small runtime serves HTTP. Nothing that a client does or leaves undone reaches the devices but through [`keeper::Order`].
//! Left out: the page itself (`web/`), and other protocols, which are subscribers of [`hub::Hub`].

pub mod client;
pub mod http;
pub mod hub;
pub mod keeper;
pub mod limits;
pub mod line;
pub mod maker;
pub mod monitor;
pub mod motions;
pub mod orders;
pub mod plan;
pub mod points;
pub mod pulse;
pub mod reach;
pub mod room;
pub mod ros2;
pub mod scans;
pub mod shared;
pub mod sockets;
pub mod thumbnail;
pub mod view;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use engine::config::Config;
use engine::devices::profile as devices;
use engine::failure::{Failure, Kind};
use http::server::Server;
use keeper::{Keeper, Order};
use limits::Waits;
use scans::Scans;
use shared::{Shared, World};

/// How a daemon is to be.
#[derive(Clone, Default)]
pub struct Options {
    /// The configuration.
    pub config: Config,
    /// The device, where it is not the configuration's own.
    pub device: Option<String>,
    /// The address, where it is not the configuration's.
    pub listen: Option<SocketAddr>,
    /// Folder of the Unix socket, where it is not the usual one.
    pub runtime: Option<PathBuf>,
    /// What lasts too long.
    pub waits: Waits,
    /// The machine.
    pub world: World,
}

/// A daemon that runs.
pub struct Daemon {
    shared: Arc<Shared>,
    server: Server,
    keeper: JoinHandle<()>,
    maker: JoinHandle<()>,
    pulse: JoinHandle<()>,
    pulse_end: Sender<()>,
    ros2: Option<ros2::Ros2>,
    /// Keeps other daemons out of the scans folder.
    _lock: std::fs::File,
}

impl Daemon {
    /// Starts everything. Devices that are not there are waited for.
    ///
    /// # Errors
    /// [`Kind::Usage`] where it may not listen there or this build lacks what is configured, [`Kind::BadInput`] for a wrong configuration or a folder that cannot be written,
    /// [`Kind::NoDevice`] where another daemon has the device.
    pub fn start(options: Options) -> Result<Self, Failure> {
        let Options {
            config,
            device,
            listen,
            runtime,
            waits,
            world,
        } = options;
        let listen = listen.unwrap_or(config.daemon.listen);
        config.daemon.check(listen)?;
        ros2::check(config.daemon.ros2.as_ref())?;
        let (name, device) = devices::choose(&config, device.as_deref())?;
        let runtime = runtime.unwrap_or_else(sockets::folder);
        let socket = runtime.join(sockets::name(&name, &device)?);
        let folder = config.daemon.folder()?;
        // Before a scan is touched: the folder may be another daemon's.
        let bound = http::server::Bound::bind(listen, &socket)?;
        let lock = scans::lock(&folder)?;
        let scans = Scans::open(&folder)?;
        let (orders, inbox) = channel();
        let shared = Arc::new(Shared::new(config, (name, device), scans, world, orders));
        shared.look_at_disk();
        let ros2 = ros2::start(&shared)?;
        let (logs, wanted) = channel();
        for left in maker::left_over(&shared) {
            // The other end is right here.
            let _ = logs.send(left);
        }
        let keeper = Keeper::new(&shared, inbox, logs)?;
        let keeper = thread("keeper", move || keeper.run())?;
        let making = Arc::clone(&shared);
        let maker = thread("cloud", move || maker::run(&making, &wanted))?;
        let (pulse_end, end) = channel();
        let looking = Arc::clone(&shared);
        let pulse = thread("pulse", move || pulse::run(&looking, &end))?;
        let server = bound.serve(&shared, waits)?;
        Ok(Self {
            shared,
            server,
            keeper,
            maker,
            pulse,
            pulse_end,
            ros2,
            _lock: lock,
        })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// What its threads share: for other protocols, and for tests.
    #[must_use]
    pub fn shared(&self) -> &Arc<Shared> {
        &self.shared
    }

    /// Whether the thread that has the devices is gone, which it should never be.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.keeper.is_finished()
    }

    /// Stops the axis, finishes the log, makes the cloud, lets the clients go. `hurry` is looked at: true leaves clouds to the next start.
    ///
    /// # Errors
    /// [`Kind::DeviceFault`] where a thread had panicked.
    pub fn stop(self, hurry: impl Fn() -> bool) -> Result<(), Failure> {
        let shared = &self.shared;
        shared.ending.store(true, Ordering::Release);
        let reason = Failure::new(
            Kind::Interrupted,
            "the daemon was stopped in the middle of this scan",
        )
        .help("scan again for the rest");
        shared.interrupt(Some(reason));
        // A keeper that is gone needs no waking.
        let _ = shared.order(Order::Wake);
        let kept = self.keeper.join();
        // The keeper had the only sender of logs: the maker ends after the last one.
        while !self.maker.is_finished() {
            if hurry() {
                shared.abandon.store(true, Ordering::Release);
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let made = self.maker.join();
        let sent = self.ros2.is_none_or(ros2::Ros2::stop);
        drop(self.pulse_end);
        let looked = self.pulse.join();
        self.server.stop();
        if kept.is_err() || made.is_err() || looked.is_err() || !sent {
            return Err(
                Failure::new(Kind::DeviceFault, "a thread of the daemon had panicked")
                    .help("see whether the axis stands; run with -vv and report what it says"),
            );
        }
        Ok(())
    }
}

fn thread(name: &str, run: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, Failure> {
    let builder = std::thread::Builder::new().name(name.to_owned());
    builder.spawn(run).map_err(|error| {
        Failure::new(Kind::NoDevice, format!("no thread for the {name}: {error}"))
            .help("end other programs; see ulimit -u")
    })
}
