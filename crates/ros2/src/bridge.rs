//! The bridge's threads, and the router's connection.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use engine::config::ros2::Ros2 as Ros2Config;
use engine::failure::Failure;
use engine::service::events::MessageLevel;
use tokio::runtime::{Builder, Runtime};

use crate::link::{self, RouterLink};
use crate::parameters::NodeParameters;
use crate::{
    Context, Counts, ScanService, actions, calls, check_capture, clouds, events, packets,
    parameters,
};

/// Between two attempts to reach a router.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// Between two looks whether the bridge ends.
pub(crate) const STOP_POLL: Duration = Duration::from_millis(100);

/// Set once, when the bridge ends.
#[derive(Clone, Default)]
pub(crate) struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }

    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.0
    }

    /// Waits for this time, or until the bridge ends.
    fn wait(&self, time: Duration) {
        let polls = time.as_millis() / STOP_POLL.as_millis();
        for _ in 0..polls {
            if self.is_set() {
                return;
            }
            std::thread::sleep(STOP_POLL);
        }
    }
}

/// A running bridge.
pub struct Bridge {
    stop: StopFlag,
    thread: JoinHandle<()>,
}

/// A runtime for waits of one thread.
pub(crate) fn runtime() -> std::io::Result<Runtime> {
    Builder::new_current_thread().enable_time().build()
}

impl Bridge {
    /// Starts the bridge. An absent router is waited for.
    ///
    /// # Errors
    /// [`engine::Kind::Usage`] where `[daemon.ros2.capture]` is invalid,
    /// [`engine::Kind::NoDevice`] where there is no thread.
    pub fn start(
        scans: &Arc<dyn ScanService>,
        settings: Ros2Config,
        counts: Arc<Counts>,
    ) -> Result<Self, Failure> {
        let devices = scans.devices();
        if let Some(request) = &settings.capture {
            let checked = check_capture(request, devices.config(), devices.device());
            checked.map_err(|failure| Failure {
                message: format!("[daemon.ros2.capture]: {}", failure.message),
                ..failure
            })?;
        }
        let no_thread = |error: std::io::Error| engine::no_resource("thread", "ROS 2", &error);
        let runtimes = [
            runtime().map_err(no_thread)?,
            runtime().map_err(no_thread)?,
            runtime().map_err(no_thread)?,
            runtime().map_err(no_thread)?,
        ];
        let stop = StopFlag::default();
        let context = Context {
            scans: Arc::clone(scans),
            parameters: NodeParameters::new(&settings, devices),
            settings,
            counts,
            stop: stop.clone(),
        };
        let thread = engine::spawn("ros2", "ROS 2", move || run(&context, &runtimes))?;
        Ok(Self { stop, thread })
    }

    /// Ends the bridge; queued messages are dropped. Returns false if a thread panicked.
    #[must_use]
    pub fn stop(self) -> bool {
        self.stop.0.store(true, Ordering::Release);
        self.thread.join().is_ok()
    }
}

fn run(context: &Context, runtimes: &[Runtime; 4]) {
    let [calls_runtime, events_runtime, scans_runtime, goals_runtime] = runtimes;
    let router = &context.settings.router;
    let events = context.devices().events();
    let (goals, mut outgoing) = actions::start(context);
    let mut reported = false;
    while !context.stop.is_set() {
        let (inbox, waiting) = calls::queue();
        let (parameters_inbox, parameter_calls) = parameters::queue();
        let link = match RouterLink::open(context, &inbox, &goals, &parameters_inbox) {
            Ok(link) => link,
            Err(error) => {
                if !reported {
                    reported = true;
                    let text = format!("ROS 2: no zenoh router at {router}");
                    tracing::debug!("{text}: {error}");
                    let program = match context.settings.dds {
                        true => "zenoh-bridge-ros2dds",
                        false => "ros2 run rmw_zenoh_cpp rmw_zenohd",
                    };
                    let help = format!(
                        "start one ({program}), or name it with router = \"tcp/HOST:PORT\" under [daemon.ros2]; \
                         it is tried again every second"
                    );
                    events.message(MessageLevel::Warning, text, Some(help));
                }
                context.stop.wait(RETRY_INTERVAL);
                continue;
            }
        };
        reported = false;
        report_connection(context, &link);
        std::thread::scope(|scope| {
            let link = &link;
            let (finished, queue) = clouds::queue();
            scope.spawn(move || clouds::queue_finished(context, scans_runtime, &finished));
            scope.spawn(move || clouds::run(context, link, queue));
            scope.spawn(move || calls::run(context, &waiting, calls_runtime));
            scope.spawn(move || parameters::run(context, &parameter_calls));
            let (goals, outgoing) = (&goals, &mut outgoing);
            scope.spawn(move || actions::run(context, link, goals, outgoing, goals_runtime));
            // The other threads go on without one of these.
            let warn = |error: link::Error| {
                events.message(MessageLevel::Warning, format!("ROS 2: {error}"), None);
            };
            scope.spawn(move || packets::run(context, link).unwrap_or_else(warn));
            events::run(context, link, events_runtime).unwrap_or_else(warn);
        });
        link.close();
    }
}

/// Reports a change of the router's connection.
pub(crate) fn report_connection(context: &Context, link: &RouterLink) {
    let before = context.counts.is_connected();
    let now = link.update_connection();
    let router = &context.settings.router;
    let events = context.devices().events();
    match (before, now) {
        (false, true) => {
            let text = format!("ROS 2: connected to the zenoh router at {router}");
            events.message(MessageLevel::Info, text, None);
        }
        (true, false) => {
            let text = format!("ROS 2: the zenoh router at {router} is gone");
            let help = "it is connected to again when it comes back";
            events.message(MessageLevel::Warning, text, Some(help.to_owned()));
        }
        _ => {}
    }
}
