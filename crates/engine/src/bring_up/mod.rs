//! The first hour with a real drive: steps that measure it and judge what they find, from its
//! identity to stops in mid-move. docs/src/bring-up.md explains each.

mod at_rest;
mod moving;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drive::config::AxisConfig;
use drive::{CommandOutcome, DriveClient, DriveCommand, DriveError, DriveEvent, ShaftSample};
use io::port::Port;
use serde::Serialize;
use units::{DegPerS2, Span};
use utoipa::ToSchema;

use crate::devices::drive_port::OpenPort;
use crate::devices::drive_session::{Session, SessionError};

/// Judgement of a measured value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Judgement {
    /// As it should be.
    Good,
    /// To be corrected before the axis is used.
    Problem,
    /// No limit applies.
    Noted,
    /// Not checked yet: the operator did not look.
    Unchecked,
}

/// A measured value.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct BringUpResult {
    /// What was measured.
    pub name: String,
    /// The value with its unit.
    pub value: String,
    /// Judgement.
    pub judgement: Judgement,
    /// What to do about a problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<String>,
}

/// A step of the bring-up.
#[derive(Clone, Copy)]
pub struct BringUpStep {
    /// Title.
    pub title: &'static str,
    /// Description for the operator at the supply switch.
    pub plan: &'static str,
    /// Whether the axis gets power.
    pub moves: bool,
    run: fn(&mut BringUp<'_>, &mut dyn Operator) -> Result<(), SessionError>,
}

/// All steps, in order. Steps after a failed one still make sense.
pub const STEPS: [BringUpStep; 10] = [
    at_rest::IDENTITY,
    at_rest::OBJECTS,
    at_rest::CONNECTION,
    at_rest::LINK,
    at_rest::SWITCHES,
    moving::HOMING,
    moving::OTHER_SWITCH,
    moving::QUICK_STOP,
    moving::BRAKE,
    moving::FOLLOWING,
];

/// The person at the axis.
pub trait Operator {
    /// Asks for an action; returns whether it was done. It is not if there is no operator.
    fn has_done(&mut self, request: &str) -> bool;
}

/// The drive during the bring-up.
pub struct BringUp<'a> {
    /// The axis.
    pub axis: AxisConfig,
    /// Acceleration of moves.
    pub acceleration: DegPerS2,
    /// The open port.
    pub(crate) opened: &'a mut OpenPort,
    /// Set to stop the axis.
    pub interrupt: Arc<AtomicBool>,
    found: Vec<BringUpResult>,
}

/// The end of a step.
#[derive(Debug, Serialize, ToSchema)]
pub struct BringUpStepReport {
    /// Title of the step.
    pub step: &'static str,
    /// What it measured.
    pub measurements: Vec<BringUpResult>,
    /// Whether the axis may still move.
    pub may_move: bool,
}

impl BringUpStep {
    /// Runs the step. Its failure is one of its measurements.
    pub fn run(
        &self,
        bring_up: &mut BringUp<'_>,
        operator: &mut dyn Operator,
    ) -> BringUpStepReport {
        bring_up.found.clear();
        let result = (self.run)(bring_up, operator);
        let may_move = result.as_ref().is_err_and(SessionError::may_move);
        if let Err(error) = result {
            bring_up.problem("step", error.to_string(), error.help().unwrap_or_default());
        }
        BringUpStepReport {
            step: self.title,
            measurements: std::mem::take(&mut bring_up.found),
            may_move,
        }
    }
}

impl BringUpStepReport {
    /// The report of a step that the person skips.
    #[must_use]
    pub fn skipped(step: &'static str) -> Self {
        Self {
            step,
            measurements: vec![BringUpResult {
                name: "step".to_owned(),
                value: "skipped".to_owned(),
                judgement: Judgement::Unchecked,
                advice: None,
            }],
            may_move: false,
        }
    }
}

impl<'a> BringUp<'a> {
    /// A bring-up of the drive at an open port.
    pub fn new(
        axis: AxisConfig,
        acceleration: DegPerS2,
        opened: &'a mut OpenPort,
        interrupt: Arc<AtomicBool>,
    ) -> Self {
        Self {
            axis,
            acceleration,
            opened,
            interrupt,
            found: Vec::new(),
        }
    }

    /// Runs commands of one session, the axis being that of the configuration.
    fn run(&mut self, commands: &[DriveCommand]) -> Result<SessionRecord, SessionError> {
        let axis = self.axis.clone();
        self.run_as(axis, commands, &mut |_| false)
    }

    /// Runs commands of one session for `axis`. An event for which `stop_at` is true stops the
    /// axis as a user would.
    fn run_as(
        &mut self,
        axis: AxisConfig,
        commands: &[DriveCommand],
        stop_at: &mut dyn FnMut(&DriveEvent) -> bool,
    ) -> Result<SessionRecord, SessionError> {
        let client = DriveClient::new(axis, self.opened.link);
        let stop = Arc::new(AtomicBool::new(false));
        let opened = &mut *self.opened;
        let mut session = Session::new(client, &mut *opened.port, Arc::clone(&stop))
            .guarded_by(opened.guardian.as_mut())
            .keeping_awake(true);
        let mut recording = SessionRecord::default();
        for command in commands {
            let command = match *command {
                // Written as a duration.
                DriveCommand::Hold { until } => DriveCommand::Hold {
                    until: session
                        .port()
                        .now()
                        .saturating_add(Span::from_nanos(until.as_nanos())),
                },
                command => command,
            };
            let end = session.run(command, &mut |event| {
                if let DriveEvent::Sample(sample) = event {
                    recording.samples.push(*sample);
                }
                let stops = stop_at(event);
                if stops && recording.stopped_at.is_none() {
                    recording.stopped_at = Some(recording.samples.len());
                }
                if stops || self.interrupt.load(Ordering::Relaxed) {
                    stop.store(true, Ordering::Relaxed);
                }
                recording.events.push(event.clone());
            });
            match end {
                Ok(outcome) => recording.outcome = Some(outcome),
                // The stop of the step itself.
                Err(SessionError::Interrupted)
                    if recording.stopped_at.is_some()
                        && !self.interrupt.load(Ordering::Relaxed) =>
                {
                    return Ok(recording);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(recording)
    }

    /// Reads an object's bytes; `None` if the drive refuses.
    fn read(
        &mut self,
        address: protocol::epos2::objects::Address,
    ) -> Result<Option<Vec<u8>>, SessionError> {
        match self.run(&[DriveCommand::Read(address)]) {
            Ok(SessionRecord {
                outcome: Some(CommandOutcome::Read { bytes, .. }),
                ..
            }) => Ok(Some(bytes)),
            Ok(_) | Err(SessionError::Drive(DriveError::Refused { .. })) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn push(&mut self, name: &str, value: String, judgement: Judgement, advice: Option<String>) {
        self.found.push(BringUpResult {
            name: name.to_owned(),
            value,
            judgement,
            advice,
        });
    }

    fn note(&mut self, name: &str, value: impl Into<String>) {
        self.push(name, value.into(), Judgement::Noted, None);
    }

    fn unchecked(&mut self, name: &str, value: impl Into<String>) {
        self.push(name, value.into(), Judgement::Unchecked, None);
    }

    fn problem(&mut self, name: &str, value: impl Into<String>, advice: impl Into<String>) {
        let advice = Some(advice.into());
        self.push(name, value.into(), Judgement::Problem, advice);
    }

    /// Good if `is_good`, else a problem with this advice.
    fn judge(&mut self, name: &str, value: impl Into<String>, is_good: bool, advice: &str) {
        match is_good {
            true => self.push(name, value.into(), Judgement::Good, None),
            false => self.problem(name, value, advice),
        }
    }
}

/// Reports of a session's commands.
#[derive(Default)]
struct SessionRecord {
    samples: Vec<ShaftSample>,
    events: Vec<DriveEvent>,
    outcome: Option<CommandOutcome>,
    /// Number of samples before the stop.
    stopped_at: Option<usize>,
}
