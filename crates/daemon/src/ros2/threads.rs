//! The threads, and the router's coming and going.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use tokio::runtime::{Builder, Runtime};

use super::link::Link;
use super::{calls, clouds, events};
use crate::hub::Level;
use crate::plan;
use crate::shared::Shared;
use engine::config::ros2::Ros2 as Ros2Config;
use engine::failure::{Failure, Kind};

/// Between two tries to reach a router.
const AGAIN: Duration = Duration::from_secs(1);

/// Set once: it ends.
#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Whether it ends.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }

    /// The flag itself.
    pub fn flag(&self) -> &AtomicBool {
        &self.0
    }

    /// Waits so long, or until it ends.
    fn wait(&self, pause: Duration) {
        let looks = pause.as_millis() / events::LOOK.as_millis();
        for _ in 0..looks {
            if self.is_set() {
                return;
            }
            std::thread::sleep(events::LOOK);
        }
    }
}

/// What sends to ROS 2.
pub struct Ros2 {
    stop: Stop,
    thread: JoinHandle<()>,
}

impl Ros2 {
    /// Begins.
    ///
    /// # Errors
    /// As [`super::start`].
    pub fn start(shared: &Arc<Shared>, settings: Ros2Config) -> Result<Self, Failure> {
        if let Some(asked) = &settings.capture {
            let setup = plan::setup(shared, asked, "cloud".into(), "log".into());
            setup.map_err(|failure| Failure {
                message: format!("[daemon.ros2.capture]: {}", failure.message),
                ..failure
            })?;
        }
        let none = |error: std::io::Error| {
            Failure::new(Kind::NoDevice, format!("no thread for ROS 2: {error}"))
                .help("end other programs; see ulimit -u")
        };
        let runtime = Builder::new_current_thread().build().map_err(none)?;
        let stop = Stop::default();
        let (shared, stopped) = (Arc::clone(shared), stop.clone());
        let builder = std::thread::Builder::new().name("ros2".to_owned());
        let thread = builder
            .spawn(move || run(&shared, &settings, &runtime, &stopped))
            .map_err(none)?;
        Ok(Self { stop, thread })
    }

    /// Ends it; whether all went well. What was not sent is not sent.
    pub fn stop(self) -> bool {
        self.stop.0.store(true, Ordering::Release);
        self.thread.join().is_ok()
    }
}

fn run(shared: &Arc<Shared>, settings: &Ros2Config, runtime: &Runtime, stop: &Stop) {
    let router = settings.router.endpoint();
    let mut said = false;
    while !stop.is_set() {
        let (inbox, waiting) = calls::queue();
        let link = match Link::open(shared, settings, &inbox) {
            Ok(link) => link,
            Err(error) => {
                if !said {
                    said = true;
                    let text = format!("ROS 2: no zenoh router at {router}: {error}");
                    let help = "start one (ros2 run rmw_zenoh_cpp rmw_zenohd), or name it with router = \"tcp/HOST:PORT\" \
                                under [daemon.ros2]; it is tried again every second";
                    shared.hub.say(Level::Warning, text, Some(help.to_owned()));
                }
                stop.wait(AGAIN);
                continue;
            }
        };
        said = false;
        tell_connection(shared, settings, &link);
        std::thread::scope(|scope| {
            scope.spawn(|| clouds::run(shared, settings, &link, stop));
            scope.spawn(move || calls::run(shared, settings, &waiting, runtime, stop));
            if let Err(error) = events::run(shared, settings, &link, stop) {
                // The other threads go on; scans and calls need no events.
                shared
                    .hub
                    .say(Level::Warning, format!("ROS 2: {error}"), None);
            }
        });
        link.close();
    }
}

/// Looks whether the router is connected, and says what has changed.
pub fn tell_connection(shared: &Shared, settings: &Ros2Config, link: &Link) {
    let before = shared.ros2.is_connected();
    let now = link.look();
    let router = settings.router.endpoint();
    match (before, now) {
        (false, true) => {
            let text = format!("ROS 2: connected to the zenoh router at {router}");
            shared.hub.say(Level::Info, text, None);
        }
        (true, false) => {
            let text = format!("ROS 2: the zenoh router at {router} is gone");
            let help = "it is connected to again when it comes back";
            shared.hub.say(Level::Warning, text, Some(help.to_owned()));
        }
        _ => {}
    }
}
