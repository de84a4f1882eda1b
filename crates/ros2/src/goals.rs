//! Goals and their states, as `rcl_action` serves them.
//!
//! Each accepted goal runs on a thread of its own. Calls are served where they arrive, with a lock
//! that is held for moments only: a cancellation stops the axis before it is answered, and waits
//! for nothing. Answers leave through a queue of the bridge.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cloud::messages::Time;
use cloud::messages::actions::{
    CancelCode, GoalId, GoalInfo, GoalStatus, cancel_response, goal_response, goal_status_array,
};
use cloud::messages::cdr::Cdr;
use engine::failure::{Failure, Kind};
use engine::service::StopSignal;
use tokio::sync::Notify;
use tokio::sync::mpsc::{Receiver, Sender, channel};

use crate::actions::Action;
use crate::calls::text_of;
use crate::goal_request::{GoalRequest, GoalResult, read, read_goal, result_response};

/// Goals that are kept, with those under way. `rclcpp` forgets results after 10 s.
const GOALS: usize = 16;
/// Calls that wait for the end of one goal.
const WAITING: usize = 8;
/// Answers that wait for the network. Further ones are dropped, and a goal whose answer has no room
/// does not begin.
const ANSWERS: usize = 2 * GOALS * WAITING;

/// The end of a goal: what it reached, and why that is not all it asked for.
pub(crate) type GoalEnd = (Option<GoalResult>, Option<Failure>);

/// Runs goals.
pub(crate) trait GoalRunner: Send + Sync + 'static {
    /// Checks a goal as the daemon does before it moves.
    fn check(&self, request: &GoalRequest) -> Result<(), Failure>;

    /// Runs a goal to its end. Calls `begun` once it holds the axis, which `stop` stops from then
    /// on; a goal that is stopped earlier does not begin.
    fn run(&self, request: GoalRequest, stop: &StopSignal, begun: &dyn Fn()) -> GoalEnd;

    /// The signal of a goal that is received now.
    fn stop_signal(&self) -> StopSignal;

    /// Whether the axis moves for the goal that `stop` stops.
    fn is_moved_until(&self, stop: &StopSignal) -> bool;

    /// Reports a rejected goal.
    fn report(&self, text: String);
}

/// Answers to be sent, each with its call.
pub(crate) type Answers<C> = Receiver<(C, Cdr)>;

/// A goal that was accepted.
struct Goal<C> {
    action: Action,
    info: GoalInfo,
    status: GoalStatus,
    stop: StopSignal,
    /// Whether it has held the axis.
    has_begun: bool,
    /// Response of `get_result`, once it has ended.
    result: Cdr,
    /// Calls of `get_result` that are answered at its end.
    waiting: Vec<C>,
}

/// The goals of all actions. `C` is a call that waits for its answer.
pub(crate) struct Goals<C> {
    runner: Box<dyn GoalRunner>,
    goals: Mutex<VecDeque<Goal<C>>>,
    answers: Sender<(C, Cdr)>,
    changed: Notify,
}

impl<C: Send + 'static> Goals<C> {
    pub(crate) fn new(runner: Box<dyn GoalRunner>) -> (Self, Answers<C>) {
        let (answers, outgoing) = channel(ANSWERS);
        let goals = Self {
            runner,
            goals: Mutex::default(),
            answers,
            changed: Notify::new(),
        };
        (goals, outgoing)
    }

    fn locked(&self) -> MutexGuard<'_, VecDeque<Goal<C>>> {
        self.goals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn answer(&self, call: C, response: Cdr) {
        if self.answers.try_send((call, response)).is_err() {
            tracing::debug!("ROS 2: an answer about a goal was dropped");
        }
    }

    /// Waits until the states of goals have changed since the last wait.
    pub(crate) async fn changed(&self) {
        self.changed.notified().await;
    }

    /// States of all goals of an action.
    pub(crate) fn states(&self, action: Action) -> Cdr {
        let goals = self.locked();
        let of_action = goals.iter().filter(|goal| goal.action == action);
        let states: Vec<_> = of_action.map(|goal| (goal.info, goal.status)).collect();
        goal_status_array(&states)
    }

    /// Accepts a goal and begins it, or rejects it and reports why.
    pub(crate) fn send_goal(self: &Arc<Self>, action: Action, payload: &[u8], call: C) {
        let Ok(room) = self.answers.try_reserve() else {
            tracing::debug!("ROS 2: a goal was dropped");
            return;
        };
        let accepted = Time::of(io::clock::now()).unwrap_or_default();
        let goal = read_goal(action, payload);
        let begun = goal.and_then(|(id, request)| {
            self.runner.check(&request)?;
            self.begin(action, GoalInfo { id, accepted }, request)
        });
        let goals = match begun {
            Ok(goals) => goals,
            Err(failure) => {
                let reason = text_of(failure);
                let text = format!("ROS 2: {}: goal rejected: {reason}", action.name());
                self.runner.report(text);
                return room.send((call, goal_response(false, accepted)));
            }
        };
        // Before its thread, which waits for the lock, can end it.
        room.send((call, goal_response(true, accepted)));
        drop(goals);
        self.changed.notify_one();
    }

    /// Starts the thread of a goal. Returns the goals, which that thread waits for.
    fn begin(
        self: &Arc<Self>,
        action: Action,
        info: GoalInfo,
        request: GoalRequest,
    ) -> Result<MutexGuard<'_, VecDeque<Goal<C>>>, Failure> {
        let refused = |text| Err(Failure::new(Kind::Limit, text));
        if info.id == [0; 16] {
            return refused("an id of zeros is that of no goal");
        }
        let mut goals = self.locked();
        if goals.iter().any(|goal| goal.info.id == info.id) {
            return refused("its id is that of another goal");
        }
        if goals.len() >= GOALS {
            let Some(oldest) = goals.iter().position(|goal| !goal.status.is_active()) else {
                return refused("too many goals at once");
            };
            goals.remove(oldest);
        }
        let stop = self.runner.stop_signal();
        let (own, own_stop) = (Arc::clone(self), stop.clone());
        engine::spawn("goal", "a goal of ROS 2", move || {
            let begun = || own.change(info.id, |goal| goal.has_begun = true);
            let run = AssertUnwindSafe(|| own.runner.run(request, &own_stop, &begun));
            let end = catch_unwind(run).unwrap_or_else(|_| {
                // A goal that has ended cannot be cancelled, and its motion must not go on.
                own_stop.request(None);
                let what = "the thread of the goal panicked; a stop of its motion was requested";
                (None, Some(Failure::new(Kind::Incomplete, what)))
            });
            own.end(info.id, end);
        })?;
        goals.push_back(Goal {
            action,
            info,
            status: GoalStatus::Executing,
            stop,
            has_begun: false,
            result: Cdr::new(),
            waiting: Vec::new(),
        });
        Ok(goals)
    }

    fn change(&self, id: GoalId, change: impl FnOnce(&mut Goal<C>)) {
        if let Some(goal) = self.locked().iter_mut().find(|goal| goal.info.id == id) {
            change(goal);
        }
    }

    /// Ends a goal and answers the calls for its result.
    fn end(&self, id: GoalId, (result, failure): GoalEnd) {
        let mut goals = self.locked();
        let Some(goal) = goals.iter_mut().find(|goal| goal.info.id == id) else {
            return;
        };
        goal.status = match (&failure, goal.status) {
            (None, _) => GoalStatus::Succeeded,
            // The axis has not moved for it, or is known to be at rest.
            (Some(failure), GoalStatus::Canceling)
                if !goal.has_begun || failure.kind == Kind::Interrupted =>
            {
                GoalStatus::Canceled
            }
            _ => GoalStatus::Aborted,
        };
        let message = failure.map(text_of).unwrap_or_default();
        goal.result = result_response(goal.action, goal.status, result.as_ref(), &message);
        for call in std::mem::take(&mut goal.waiting) {
            self.answer(call, goal.result.clone());
        }
        self.changed.notify_one();
    }

    /// Stops goals, each by its own signal: no other motion stops.
    pub(crate) fn cancel(&self, action: Action, payload: &[u8], call: C) {
        let Ok(request) = read(payload, GoalInfo::read) else {
            return self.answer(call, cancel_response(CancelCode::Rejected, &[]));
        };
        let is_one = request.accepted == Time::default() && request.id != [0; 16];
        let mut code = match is_one {
            true => CancelCode::UnknownGoal,
            false => CancelCode::Rejected,
        };
        let mut cancelled = Vec::new();
        let mut goals = self.locked();
        let matching = |goal: &Goal<C>| goal.action == action && request.cancels(&goal.info);
        for goal in goals.iter_mut().filter(|goal| matching(goal)) {
            if !goal.status.is_active() {
                code = if is_one { CancelCode::Ended } else { code };
            } else if !goal.has_begun || self.runner.is_moved_until(&goal.stop) {
                goal.stop.request(None);
                goal.status = GoalStatus::Canceling;
                cancelled.push(goal.info);
            } else {
                // Its motion has ended: its cloud is being made.
                code = CancelCode::Rejected;
            }
        }
        if !cancelled.is_empty() {
            code = CancelCode::Accepted;
        }
        if !cancelled.is_empty() {
            self.changed.notify_one();
        }
        self.answer(call, cancel_response(code, &cancelled));
    }

    /// Answers now if the goal has ended or is unknown, or if too many calls wait; else at its end.
    pub(crate) fn get_result(&self, action: Action, payload: &[u8], call: C) {
        let id = read(payload, |cdr| cdr.array::<16>()).ok();
        let mut goals = self.locked();
        let mut goals = goals.iter_mut().filter(|goal| goal.action == action);
        let message = match goals.find(|goal| Some(goal.info.id) == id) {
            Some(goal) if !goal.status.is_active() => {
                return self.answer(call, goal.result.clone());
            }
            Some(goal) if goal.waiting.len() < WAITING => return goal.waiting.push(call),
            Some(_) => "too many calls wait for this result; ask again",
            None => "there is no such goal",
        };
        let response = result_response(action, GoalStatus::Unknown, None, message);
        self.answer(call, response);
    }

    /// The goal for which the axis moves.
    pub(crate) fn moving(&self) -> Option<(Action, GoalId)> {
        let goals = self.locked();
        let mut active = goals.iter().filter(|goal| goal.status.is_active());
        let goal = active.find(|goal| self.runner.is_moved_until(&goal.stop))?;
        Some((goal.action, goal.info.id))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;

    const POLL: Duration = Duration::from_millis(1);

    /// An axis, and the place where goals wait for it.
    #[derive(Default)]
    struct Axis {
        is_ready: AtomicBool,
        begun: AtomicUsize,
        panics: AtomicBool,
        /// The motion under way.
        stop: Mutex<Option<StopSignal>>,
        /// End of the motion; without one it goes on.
        end: Mutex<Option<GoalEnd>>,
        reports: Mutex<Vec<String>>,
    }

    impl GoalRunner for Arc<Axis> {
        fn check(&self, request: &GoalRequest) -> Result<(), Failure> {
            match request {
                GoalRequest::Move(_) => Ok(()),
                GoalRequest::Capture(_) => Err(Failure::new(Kind::Usage, "too fast")),
            }
        }

        fn run(&self, _: GoalRequest, stop: &StopSignal, begun: &dyn Fn()) -> GoalEnd {
            while !self.is_ready.load(Ordering::SeqCst) {
                std::thread::sleep(POLL);
            }
            if stop.is_requested() {
                // As of an axis that is busy, too: nothing moved.
                return (None, Some(Failure::new(Kind::Busy, "the axis is busy")));
            }
            *self.stop.lock().unwrap() = Some(stop.clone());
            begun();
            self.begun.fetch_add(1, Ordering::SeqCst);
            loop {
                assert!(!self.panics.load(Ordering::SeqCst), "as a fault would");
                if let Some(end) = self.end.lock().unwrap().clone() {
                    return end;
                }
                std::thread::sleep(POLL);
            }
        }

        fn stop_signal(&self) -> StopSignal {
            StopSignal::default()
        }

        fn is_moved_until(&self, stop: &StopSignal) -> bool {
            // One motion at a time, as the axis is leased.
            let moving = self.stop.lock().unwrap();
            moving.is_some() && !stop.is_requested()
        }

        fn report(&self, text: String) {
            self.reports.lock().unwrap().push(text);
        }
    }

    struct Client {
        axis: Arc<Axis>,
        goals: Arc<Goals<&'static str>>,
        outgoing: Answers<&'static str>,
    }

    impl Client {
        fn new() -> Self {
            let axis = Arc::new(Axis::default());
            let (goals, outgoing) = Goals::new(Box::new(Arc::clone(&axis)));
            Self {
                axis,
                goals: Arc::new(goals),
                outgoing,
            }
        }

        /// The next answer.
        fn answer(&mut self) -> (&'static str, Vec<u8>) {
            let (call, cdr) = self.outgoing.blocking_recv().unwrap();
            (call, cdr.bytes()[4..].to_vec())
        }

        /// Sends a goal to home. Returns whether it was accepted.
        fn send(&mut self, id: u8) -> bool {
            let mut cdr = Cdr::new();
            cdr.array(&[id; 16]);
            cdr.u8(1);
            cdr.length(0);
            cdr.length(0);
            self.goals.send_goal(Action::MoveTilt, cdr.bytes(), "send");
            self.answer().1[0] == 1
        }

        /// Cancels a goal. Returns the code, and the number of cancelled goals.
        fn cancel(&mut self, id: u8) -> (u8, u8) {
            let mut cdr = Cdr::new();
            cdr.array(&[id; 16]);
            cdr.i32(0);
            cdr.u32(0);
            self.goals.cancel(Action::MoveTilt, cdr.bytes(), "cancel");
            let (call, response) = self.answer();
            assert_eq!(call, "cancel");
            (response[0], response[4])
        }

        fn ask(&self, id: u8, call: &'static str) {
            let mut cdr = Cdr::new();
            cdr.array(&[id; 16]);
            self.goals.get_result(Action::MoveTilt, cdr.bytes(), call);
        }

        fn status(&mut self, id: u8) -> u8 {
            self.ask(id, "status");
            let (call, response) = self.answer();
            assert_eq!(call, "status");
            response[0]
        }

        fn end(&self, kind: Option<Kind>) {
            let failure = kind.map(|kind| Failure::new(kind, "ended"));
            *self.axis.end.lock().unwrap() = Some((None, failure));
        }

        fn begin(&self) {
            self.axis.is_ready.store(true, Ordering::SeqCst);
            while self.axis.begun.load(Ordering::SeqCst) == 0 {
                std::thread::sleep(POLL);
            }
        }
    }

    #[test]
    fn a_goal_that_is_cancelled_while_it_waits_never_begins() {
        let mut client = Client::new();
        assert!(client.send(1) && client.send(2));
        // Answered while both wait, and will not begin.
        assert_eq!(client.cancel(1), (CancelCode::Accepted as u8, 1));
        assert_eq!(client.cancel(2), (CancelCode::Accepted as u8, 1));
        client.axis.is_ready.store(true, Ordering::SeqCst);
        for goal in [1, 2] {
            assert_eq!(client.status(goal), GoalStatus::Canceled as u8);
        }
        assert_eq!(client.axis.begun.load(Ordering::SeqCst), 0);
        assert_eq!(client.cancel(1), (CancelCode::Ended as u8, 0));
        assert_eq!(client.cancel(9), (CancelCode::UnknownGoal as u8, 0));
    }

    #[test]
    fn cancelled_goals_are_canceled_only_where_the_axis_is_at_rest() {
        for (is_cancelled, kind, status) in [
            (true, Some(Kind::Interrupted), GoalStatus::Canceled),
            (true, Some(Kind::DeviceFault), GoalStatus::Aborted),
            (true, Some(Kind::Incomplete), GoalStatus::Aborted),
            (true, None, GoalStatus::Succeeded),
            // Another client has stopped it.
            (false, Some(Kind::Interrupted), GoalStatus::Aborted),
            (false, None, GoalStatus::Succeeded),
        ] {
            let mut client = Client::new();
            assert!(client.send(1));
            client.begin();
            if is_cancelled {
                assert_eq!(client.cancel(1).0, CancelCode::Accepted as u8);
            }
            client.end(kind);
            assert_eq!(client.status(1), status as u8, "{is_cancelled} {kind:?}");
        }
    }

    #[test]
    fn a_cancellation_stops_no_other_motion() {
        let mut client = Client::new();
        assert!(client.send(1));
        client.begin();
        let first = client.axis.stop.lock().unwrap().clone().unwrap();
        client.axis.is_ready.store(false, Ordering::SeqCst);
        assert!(client.send(2));
        assert_eq!(client.cancel(2).0, CancelCode::Accepted as u8);
        assert!(!first.is_requested());
        // The motion of the first has ended, and its goal has not: another may use the axis now.
        *client.axis.stop.lock().unwrap() = None;
        assert_eq!(client.cancel(1), (CancelCode::Rejected as u8, 0));
        assert!(!first.is_requested());
        client.axis.is_ready.store(true, Ordering::SeqCst);
        client.end(None);
    }

    #[test]
    fn every_call_for_a_result_is_answered() {
        let mut client = Client::new();
        assert!(client.send(1));
        client.begin();
        for _ in 0..WAITING {
            client.ask(1, "waits");
        }
        for _ in 0..3 {
            client.ask(1, "refused");
            let (call, response) = client.answer();
            assert_eq!((call, response[0]), ("refused", GoalStatus::Unknown as u8));
            let text = String::from_utf8_lossy(&response).into_owned();
            assert!(text.contains("too many calls"), "{text}");
        }
        client.end(None);
        for _ in 0..WAITING {
            let (call, response) = client.answer();
            assert_eq!((call, response[0]), ("waits", GoalStatus::Succeeded as u8));
        }
        assert_eq!(client.status(1), GoalStatus::Succeeded as u8);
        assert_eq!(client.status(9), GoalStatus::Unknown as u8);
    }

    #[test]
    fn a_goal_whose_thread_panics_is_aborted_and_its_motion_stopped() {
        let mut client = Client::new();
        assert!(client.send(1));
        client.begin();
        client.ask(1, "waits");
        client.axis.panics.store(true, Ordering::SeqCst);
        let (call, response) = client.answer();
        assert_eq!((call, response[0]), ("waits", GoalStatus::Aborted as u8));
        let stop = client.axis.stop.lock().unwrap().clone();
        assert!(stop.unwrap().is_requested());
    }

    /// A client that calls without end, and a network that takes nothing.
    #[test]
    fn answers_that_do_not_leave_are_bounded_and_the_last_states_are_sent() {
        let mut client = Client::new();
        assert!(client.send(1));
        client.begin();
        let waits = || tokio::runtime::Builder::new_current_thread().build();
        waits().unwrap().block_on(client.goals.changed());
        for _ in 0..ANSWERS + 10 {
            client.ask(9, "unknown");
        }
        let mut cdr = Cdr::new();
        cdr.array(&[2; 16]);
        cdr.u8(1);
        (0..2).for_each(|_| cdr.length(0));
        let goals = &client.goals;
        goals.send_goal(Action::MoveTilt, cdr.bytes(), "dropped");
        assert_eq!(client.axis.begun.load(Ordering::SeqCst), 1);
        client.end(None);
        // Goals change their states whatever waits to be sent.
        waits().unwrap().block_on(client.goals.changed());
        let states = client.goals.states(Action::MoveTilt);
        assert_eq!(states.bytes().last(), Some(&(GoalStatus::Succeeded as u8)));
        for _ in 0..ANSWERS {
            assert_eq!(client.answer().0, "unknown");
        }
        assert_eq!(client.status(1), GoalStatus::Succeeded as u8);
        assert_eq!(client.status(2), GoalStatus::Unknown as u8);
    }

    #[test]
    fn rejected_goals_are_reported_with_the_reason() {
        let mut client = Client::new();
        assert!(!client.send(0));
        for goal in 0..GOALS {
            assert!(client.send(1 + goal as u8));
        }
        assert!(!client.send(1) && !client.send(99));
        let mut capture = Cdr::new();
        capture.array(&[100; 16]);
        capture.length(1);
        capture.f64(1e9);
        (0..7).for_each(|_| capture.length(0));
        let bytes = capture.bytes();
        for payload in [bytes, &bytes[..9], &[], &[0; 5_000]] {
            client.goals.send_goal(Action::Capture, payload, "send");
            assert_eq!(client.answer().1[0], 0);
            client
                .goals
                .cancel(Action::MoveTilt, &payload[..payload.len().min(9)], "cancel");
            assert_eq!(client.answer().1[0], CancelCode::Rejected as u8);
        }
        let reports = client.axis.reports.lock().unwrap().join("\n");
        for reason in [
            "of no goal",
            "another goal",
            "too many goals",
            "too fast",
            "bytes, got",
            "at most 4096",
        ] {
            assert!(reports.contains(reason), "{reason}: {reports}");
        }
        client.axis.is_ready.store(true, Ordering::SeqCst);
        client.end(None);
    }
}
