//! Studies: choices, what is measured of them, and how.

use std::fmt;

use cloud::SinkError;
use serde::Serialize;
use units::{Host, Span, Stamp};
use utoipa::ToSchema;

use super::{StudyFindings, TimingPlan, TimingSpread, Work, in_rounds};
use crate::draw::number::short;

/// A comparison of several ways to do one thing.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Name on the command line and of its files: lower-case letters and hyphens.
    pub name: &'static str,
    /// The compared choice in one line.
    pub title: &'static str,
    /// Heading of the choices' names.
    pub choice: &'static str,
    /// The measured quantities: key in JSON, which ends with the unit, and heading with the unit.
    pub columns: &'static [(&'static str, &'static str)],
    /// The traded columns.
    pub trades: &'static [Trade],
    /// The finding in a sentence: the title of the figure.
    pub finding: fn(&StudyFindings) -> String,
    /// Measures the choices.
    pub measure: fn(&mut Bench<'_>) -> Result<StudyRows, StudyError>,
}

/// Paragraphs on the workload and the columns, and the choices.
pub type StudyRows = (Vec<String>, Vec<Row>);

/// The studies of `all` with the names `only`, in their own order; all of them if `only` is empty.
///
/// # Errors
/// [`UnknownStudy`] if a name belongs to no study.
pub fn select(all: &[Study], only: &[String]) -> Result<Vec<Study>, UnknownStudy> {
    if let Some(name) = only.iter().find(|name| all.iter().all(|s| s.name != *name)) {
        return Err(UnknownStudy {
            name: name.clone(),
            known: all.iter().map(|study| study.name).collect(),
        });
    }
    let is_selected =
        |study: &&Study| only.is_empty() || only.iter().any(|name| name == study.name);
    Ok(all.iter().filter(is_selected).copied().collect())
}

/// A name that belongs to no study.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no study {name:?}")]
#[non_exhaustive]
pub struct UnknownStudy {
    /// The unknown name.
    pub name: String,
    /// Names of all studies.
    pub known: Vec<&'static str>,
}

/// Reason why a study failed.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A sink refused points.
    #[error(transparent)]
    Sink(#[from] SinkError),
    /// The workload could not be set up.
    #[error("workload: {0}")]
    Workload(Box<dyn std::error::Error + Send + Sync>),
}

impl StudyError {
    /// A workload that could not be set up.
    pub fn workload(error: impl fmt::Display) -> Self {
        Self::Workload(error.to_string().into())
    }
}

/// Size of the workloads and number of rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// Smaller workloads and fewer rounds.
    Quick,
    /// For published figures.
    Full,
}

/// The environment of a measurement.
pub struct Bench<'a> {
    /// The clock.
    pub clock: &'a mut dyn FnMut() -> Stamp<Host>,
    /// Size of the workloads.
    pub effort: Effort,
    /// Receives progress messages.
    pub say: &'a mut dyn FnMut(&str),
}

/// A choice to be timed.
pub struct TimedChoice<'a> {
    /// Its row without the first value, which is the time.
    pub row: Row,
    /// Factor from seconds to the unit of the first column.
    pub scale: f64,
    /// The work to be timed.
    pub work: Work<'a>,
}

impl Bench<'_> {
    /// `quick` or `full`, by the effort.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        match self.effort {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// A timing plan with measurements of at least 2 ms; reports the size of the workload and the
    /// number of rounds.
    pub fn plan(&mut self, workload: &str, quick: usize, full: usize) -> TimingPlan {
        let rounds = self.pick(quick, full);
        (self.say)(&format!("{workload}, {rounds} rounds"));
        TimingPlan {
            rounds,
            least: Span::from_micros(2_000),
        }
    }

    /// The rows of choices with their times.
    ///
    /// # Errors
    /// The first error of any work.
    pub fn rows(
        &mut self,
        plan: TimingPlan,
        choices: Vec<TimedChoice<'_>>,
    ) -> Result<Vec<Row>, StudyError> {
        let (mut work, rows): (Vec<_>, Vec<_>) = choices
            .into_iter()
            .map(|choice| (choice.work, (choice.row, choice.scale)))
            .unzip();
        let times = in_rounds(self.clock, plan, &mut work)?;
        let timed = rows.into_iter().zip(times).map(|((mut row, scale), time)| {
            row.values.insert(0, Measurement::Timed(time.times(scale)));
            row
        });
        Ok(timed.collect())
    }
}

/// A measured value. Smaller is better wherever values are traded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Measurement {
    /// Computed, and equal in every run.
    Computed(f64),
    /// Timed in several runs.
    Timed(TimingSpread),
}

impl Measurement {
    /// The value, or the median of several.
    #[must_use]
    pub const fn middle(&self) -> f64 {
        match self {
            Self::Computed(x) => *x,
            Self::Timed(spread) => spread.median,
        }
    }

    /// The value in a table, with the minimum and the maximum of a timed one.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Computed(x) => short(*x),
            Self::Timed(TimingSpread {
                median, min, max, ..
            }) => format!("{} ({}..{})", short(*median), short(*min), short(*max)),
        }
    }

    /// The value, or the minimum of several.
    #[must_use]
    pub const fn best(&self) -> f64 {
        match self {
            Self::Computed(x) => *x,
            Self::Timed(spread) => spread.min,
        }
    }
}

/// A choice and its measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Unique name.
    pub name: String,
    /// Short label in the figure.
    pub label: String,
    /// Kind of choice; its colour in the figure.
    pub group: &'static str,
    /// One value per column.
    pub values: Vec<Measurement>,
}

impl Row {
    /// A row of computed values; the name occurs once per study.
    pub fn new(
        name: impl Into<String>,
        label: impl Into<String>,
        group: &'static str,
        computed: impl IntoIterator<Item = f64>,
    ) -> Self {
        Self {
            name: name.into(),
            label: label.into(),
            group,
            values: computed.into_iter().map(Measurement::Computed).collect(),
        }
    }
}

/// Two columns that are traded: a plot with a Pareto front.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Trade {
    /// Index of the column on the x axis.
    pub cost: usize,
    /// Index of the column on the y axis.
    pub loss: usize,
    /// Whether a line joins the choices of one group.
    pub joined: bool,
    /// Whether groups are circumstances that cannot be chosen, each with a front of its own.
    pub by_group: bool,
    /// Loss below which differences do not matter: smaller ones are drawn there.
    pub least: Option<f64>,
}

impl Trade {
    /// A trade of the column `loss` for the column `cost`, with one front over all rows.
    #[must_use]
    pub const fn new(cost: usize, loss: usize) -> Self {
        Self {
            cost,
            loss,
            joined: false,
            by_group: false,
            least: None,
        }
    }

    /// The same with a line that joins the choices of each group.
    #[must_use]
    pub const fn joined(self) -> Self {
        Self {
            joined: true,
            ..self
        }
    }

    /// The same with losses below `least` drawn there.
    #[must_use]
    pub const fn down_to(self, least: f64) -> Self {
        Self {
            least: Some(least),
            ..self
        }
    }

    /// The same with one front per group.
    #[must_use]
    pub const fn by_group(self) -> Self {
        Self {
            by_group: true,
            ..self
        }
    }
}
