//! The actions of `velomotion_msgs`: three services and two topics each.
//!
//! They are offered only if they are switched on: every client of the router can send goals. A goal
//! moves the axis by the same calls as a client of HTTP, and goes on if its client goes away.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use cloud::messages::actions::{ActionType, CANCEL_GOAL, CAPTURE, GOAL_STATUS_ARRAY, MOVE_TILT};
use cloud::messages::cdr::Cdr;
use engine::capture::jog;
use engine::capture_request::CaptureRequest;
use engine::config::ros2::Ros2;
use engine::failure::{Failure, Kind};
use engine::service::StopSignal;
use engine::service::events::{Event, MessageLevel, RecvError};
use engine::service::scan_record::ScanState;
use tokio::runtime::Runtime;
use zenoh::qos::Priority;

use crate::bridge::{self, STOP_POLL, StopFlag};
use crate::goal_request::{GoalRequest, GoalResult, feedback_message};
use crate::goals::{Answers, GoalEnd, GoalRunner, Goals};
use crate::link::{Call, Channel, Declarer, Error, RouterLink, SERVICES};
use crate::rmw::QualityOfService;
use crate::{Context, ScanService, check_capture};

/// Between two looks of a goal whether it is cancelled, or its scan is made.
const GOAL_POLL: Duration = Duration::from_millis(20);
/// Reports of rejected goals in an interval: a client may send goals without end.
const REPORTS: u32 = 5;
const REPORT_INTERVAL: Duration = Duration::from_secs(1);
/// QoS of feedback (`rmw_qos_profile_default`).
const FEEDBACK: QualityOfService = QualityOfService {
    reliable: true,
    latched: false,
    depth: 10,
};
/// QoS of states (`rcl_action_qos_profile_status_default`).
const STATUS: QualityOfService = QualityOfService {
    reliable: true,
    latched: true,
    depth: 1,
};

/// An action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Captures a scan.
    Capture,
    /// Moves the axis.
    MoveTilt,
}

impl Action {
    /// The actions that a configuration offers.
    pub fn offered(settings: &Ros2) -> &'static [Self] {
        match settings.actions {
            true => &[Self::Capture, Self::MoveTilt],
            false => &[],
        }
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Capture => "/velomotion/capture",
            Self::MoveTilt => "/velomotion/move_tilt",
        }
    }

    const fn types(self) -> ActionType {
        match self {
            Self::Capture => CAPTURE,
            Self::MoveTilt => MOVE_TILT,
        }
    }
}

/// The goals of a bridge, and its queue of answers.
pub(crate) fn start(context: &Context) -> (Arc<Goals<Call>>, Answers<Call>) {
    let runner = DaemonRunner {
        scans: Arc::clone(&context.scans),
        stop: context.stop.clone(),
        reports: Mutex::default(),
    };
    let (goals, outgoing) = Goals::new(Box::new(runner));
    (Arc::new(goals), outgoing)
}

/// Offers an action. Returns the publishers of its feedback and of its states.
pub(crate) fn declare(
    declarer: &mut Declarer<'_>,
    action: Action,
    goals: &Arc<Goals<Call>>,
) -> Result<(Channel, Channel), Error> {
    type Serve = fn(&Arc<Goals<Call>>, Action, &[u8], Call);
    let types = action.types();
    let name = declarer.settings().resolve(action.name());
    let services: [(&str, _, Serve); 3] = [
        ("send_goal", types.send_goal, Goals::send_goal),
        (
            "cancel_goal",
            CANCEL_GOAL,
            |goals, action, payload, call| {
                goals.cancel(action, payload, call);
            },
        ),
        (
            "get_result",
            types.get_result,
            |goals, action, payload, call| {
                goals.get_result(action, payload, call);
            },
        ),
    ];
    for (part, kind, serve) in services {
        let goals = Arc::clone(goals);
        let name = format!("{name}/_action/{part}");
        declarer.service(&name, &kind, SERVICES, move |call| {
            let payload = call.payload();
            serve(&goals, action, &payload, call);
        })?;
    }
    let mut publisher = |part, kind, quality| {
        let name = format!("{name}/_action/{part}");
        declarer.publisher(&name, kind, (quality, Priority::DataHigh))
    };
    Ok((
        publisher("feedback", &types.feedback, FEEDBACK)?,
        publisher("status", &GOAL_STATUS_ARRAY, STATUS)?,
    ))
}

/// Sends answers, states and feedback until the bridge ends.
pub(crate) fn run(
    context: &Context,
    link: &RouterLink,
    goals: &Goals<Call>,
    outgoing: &mut Answers<Call>,
    runtime: &Runtime,
) {
    enum Next {
        Answer(Call, Cdr),
        States,
        Event(Result<Arc<Event>, RecvError>),
        Nothing,
    }
    let mut subscription = context.devices().events().subscribe();
    while !context.stop.is_set() {
        // zenoh refuses to send within the runtime.
        let next = runtime.block_on(async {
            tokio::select! {
                Some((call, response)) = outgoing.recv() => Next::Answer(call, response),
                () = goals.changed() => Next::States,
                event = subscription.next() => Next::Event(event),
                () = tokio::time::sleep(STOP_POLL) => Next::Nothing,
            }
        });
        let sent = match next {
            Next::Answer(call, response) => {
                call.answer(response.bytes());
                context.counts.calls.fetch_add(1, Ordering::Relaxed);
                Ok(())
            }
            Next::States => send_states(link, goals),
            Next::Event(Ok(event)) => match *event {
                Event::Motion {
                    angle_deg, left_s, ..
                } => send_feedback(context, link, goals, (angle_deg, left_s)),
                _ => Ok(()),
            },
            // Feedback may have been lost.
            Next::Event(Err(_)) | Next::Nothing => Ok(()),
        };
        if let Err(error) = sent {
            tracing::debug!("ROS 2: {error}");
        }
    }
}

fn send_states(link: &RouterLink, goals: &Goals<Call>) -> Result<(), Error> {
    for (action, _, channel) in link.actions() {
        link.publish(channel, goals.states(*action).bytes())?;
    }
    Ok(())
}

fn send_feedback(
    context: &Context,
    link: &RouterLink,
    goals: &Goals<Call>,
    progress: (f64, Option<f64>),
) -> Result<(), Error> {
    let Some((action, goal)) = goals.moving() else {
        return Ok(());
    };
    let mut actions = link.actions().iter();
    let Some((_, channel, _)) = actions.find(|(known, ..)| *known == action) else {
        return Ok(());
    };
    let activity = context.devices().activity();
    let steps = (activity.step, activity.steps);
    let message = feedback_message(action, &goal, steps, progress);
    link.publish(channel, message.bytes())?;
    Ok(())
}

/// Runs goals as the daemon's HTTP API runs its requests.
struct DaemonRunner {
    scans: Arc<dyn ScanService>,
    stop: StopFlag,
    reports: Mutex<ReportLimit>,
}

/// Limits reports to [`REPORTS`] per [`REPORT_INTERVAL`].
#[derive(Default)]
struct ReportLimit {
    /// Begin of the interval, and reports in it.
    begun: Option<Instant>,
    reports: u32,
    omitted: u64,
}

impl ReportLimit {
    /// The text to report at `now`, unless there were too many.
    fn limit(&mut self, text: String, now: Instant) -> Option<String> {
        let goes_on = |begun| now.saturating_duration_since(begun) < REPORT_INTERVAL;
        if !self.begun.is_some_and(goes_on) {
            (self.begun, self.reports) = (Some(now), 0);
        }
        if self.reports == REPORTS {
            self.omitted += 1;
            return None;
        }
        self.reports += 1;
        match std::mem::take(&mut self.omitted) {
            0 => Some(text),
            omitted => Some(format!("{text}; {omitted} more before it")),
        }
    }
}

impl GoalRunner for DaemonRunner {
    fn check(&self, request: &GoalRequest) -> Result<(), Failure> {
        let devices = self.scans.devices();
        match request {
            GoalRequest::Capture(request) => {
                check_capture(request, devices.config(), devices.device())?;
            }
            GoalRequest::Move(request) => {
                jog::commands(*request, devices.config(), devices.device().1)?;
            }
        }
        Ok(())
    }

    fn run(&self, request: GoalRequest, stop: &StopSignal, begun: &dyn Fn()) -> GoalEnd {
        let runtime = match bridge::runtime() {
            Ok(runtime) => runtime,
            Err(error) => return (None, Some(engine::no_resource("runtime", "a goal", &error))),
        };
        let devices = self.scans.devices();
        runtime.block_on(async {
            let ready = async {
                if matches!(request, GoalRequest::Capture(_)) {
                    devices.wait_for_lidar().await;
                }
                devices.wait_for_reads().await;
            };
            let cancelled = async {
                while !stop.is_requested() {
                    tokio::time::sleep(GOAL_POLL).await;
                }
            };
            tokio::select! {
                () = ready => {}
                () = cancelled => {}
            }
        });
        match request {
            GoalRequest::Capture(request) => self.run_capture(&request, stop, begun),
            GoalRequest::Move(request) => match self.scans.start_move(request, stop) {
                Err(failure) => (None, Some(failure)),
                Ok(end) => {
                    begun();
                    match end.blocking_recv() {
                        Ok(Ok(report)) => {
                            let angle_deg = report.angle_deg.unwrap_or(f64::NAN);
                            (Some(GoalResult::Move { angle_deg }), None)
                        }
                        Ok(Err(failure)) => (None, Some(failure)),
                        Err(_) => (None, Some(ending())),
                    }
                }
            },
        }
    }

    fn stop_signal(&self) -> StopSignal {
        self.scans.devices().stop_signal(None)
    }

    fn is_moved_until(&self, stop: &StopSignal) -> bool {
        self.scans.devices().is_moved_until(stop)
    }

    fn report(&self, text: String) {
        let events = self.scans.devices().events();
        let mut reports = self.reports.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(text) = reports.limit(text, Instant::now()) {
            events.message(MessageLevel::Warning, text, None);
        }
    }
}

impl DaemonRunner {
    /// Captures, and waits for the cloud.
    fn run_capture(
        &self,
        request: &CaptureRequest,
        stop: &StopSignal,
        begun: &dyn Fn(),
    ) -> GoalEnd {
        let id = match self.scans.start_capture(request, stop) {
            Ok(id) => id,
            Err(failure) => return (None, Some(failure)),
        };
        begun();
        let scan = loop {
            match self.scans.scan(&id) {
                Some(scan) if !scan.state.is_final() => std::thread::sleep(GOAL_POLL),
                scan => break scan,
            }
            if self.stop.is_set() {
                break None;
            }
        };
        let result = |state, points| GoalResult::Capture {
            scan: id.clone(),
            state,
            points,
        };
        let Some(scan) = scan else {
            let deleted = || Failure::new(Kind::NotFound, "the scan was deleted");
            let failure = if self.stop.is_set() {
                ending()
            } else {
                deleted()
            };
            return (Some(result("failed", 0)), Some(failure));
        };
        let state = match scan.state {
            ScanState::Whole => "whole",
            ScanState::Partial => "partial",
            _ => "failed",
        };
        let incomplete = || Failure::new(Kind::Incomplete, "the scan is not complete");
        let is_whole = scan.state == ScanState::Whole;
        let why = (!is_whole).then(|| scan.why.clone().unwrap_or_else(incomplete));
        (Some(result(state, scan.points.unwrap_or(0))), why)
    }
}

/// The failure of a goal whose end is not known any more.
fn ending() -> Failure {
    Failure::new(Kind::Incomplete, "the daemon is ending")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_capture_of_the_service_offers_no_action() {
        let of = |text| Action::offered(&toml::from_str(text).unwrap());
        assert!(of("").is_empty());
        assert!(of("[capture]\nspeed_deg_s = 20.0").is_empty());
        assert_eq!(of("actions = true"), [Action::Capture, Action::MoveTilt]);
    }

    #[test]
    fn a_client_that_sends_goals_without_end_is_reported_five_times_a_second() {
        let (mut reports, start) = (ReportLimit::default(), Instant::now());
        let reported: Vec<_> = (0..1_500)
            .filter_map(|ms| reports.limit("no".to_owned(), start + Duration::from_millis(ms)))
            .collect();
        assert_eq!(reported.len(), 10);
        assert_eq!(reported[5], "no; 995 more before it");
        assert_eq!(reported.iter().filter(|text| *text == "no").count(), 9);
    }
}
