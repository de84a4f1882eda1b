//! Studies and their findings.

use std::fmt;

use cloud::SinkError;
use serde::Serialize;
use units::Span;

use super::front::{front, front_within_spread};
use super::{Scale, StudyClock, TimingPlan, TimingSpread};
use crate::draw::number::short;

/// A comparison of several ways to do one thing.
pub trait Study {
    /// Name on the command line and of its files: lower-case letters and hyphens.
    fn name(&self) -> &'static str;

    /// The compared choice in one line.
    fn title(&self) -> &'static str;

    /// Measures the choices.
    ///
    /// # Errors
    /// [`StudyError`] if a choice fails.
    fn measure(&self, bench: &mut Bench<'_>) -> Result<StudyFindings, StudyError>;
}

/// The studies of `all` with the names `only`, in their own order; all of them if `only` is empty.
///
/// # Errors
/// [`UnknownStudy`] if a name belongs to no study.
pub fn select<'a>(
    all: &[&'a dyn Study],
    only: &[String],
) -> Result<Vec<&'a dyn Study>, UnknownStudy> {
    if let Some(name) = only
        .iter()
        .find(|name| all.iter().all(|s| s.name() != *name))
    {
        return Err(UnknownStudy {
            name: name.clone(),
            known: all.iter().map(|study| study.name()).collect(),
        });
    }
    let selected = |name| only.is_empty() || only.iter().any(|wanted| wanted == name);
    Ok(all
        .iter()
        .copied()
        .filter(|study| selected(study.name()))
        .collect())
}

/// A name that belongs to no study.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no study {name:?}")]
pub struct UnknownStudy {
    /// The unknown name.
    pub name: String,
    /// Names of all studies.
    pub known: Vec<&'static str>,
}

/// Why a study failed.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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
    pub clock: &'a mut dyn StudyClock,
    /// Size of the workloads.
    pub effort: Effort,
    /// Receives progress messages.
    pub say: &'a mut dyn FnMut(&str),
}

impl Bench<'_> {
    /// `quick` or `full`, by the effort.
    #[must_use]
    pub const fn size(&self, quick: usize, full: usize) -> usize {
        match self.effort {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// A timing plan with measurements of at least 2 ms.
    #[must_use]
    pub const fn plan(&self, quick: usize, full: usize) -> TimingPlan {
        TimingPlan {
            rounds: self.size(quick, full),
            least: Span::from_micros(2_000),
        }
    }
}

/// A measured quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyColumn {
    /// Name in JSON; ends with the unit.
    pub key: &'static str,
    /// Heading with the unit.
    pub heading: &'static str,
    /// Scale of its axis.
    pub scale: Scale,
}

impl StudyColumn {
    /// A column on a logarithmic axis.
    #[must_use]
    pub const fn log((key, heading): (&'static str, &'static str)) -> Self {
        Self {
            key,
            heading,
            scale: Scale::Log,
        }
    }
}

/// A measured value. Smaller is better wherever values are traded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    /// A row of the table; the name occurs once per study.
    pub fn new(
        name: impl Into<String>,
        label: impl Into<String>,
        group: &'static str,
        values: Vec<Measurement>,
    ) -> Self {
        Self {
            name: name.into(),
            label: label.into(),
            group,
            values,
        }
    }
}

/// Two columns that are traded: a plot with a Pareto front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trade {
    /// Index of the column on the x axis.
    pub cost: usize,
    /// Index of the column on the y axis.
    pub loss: usize,
    /// Whether a line joins the choices of one group.
    pub joined: bool,
    /// Whether groups are circumstances that cannot be chosen, each with a front of its own.
    pub by_group: bool,
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

    /// The same with one front per group.
    #[must_use]
    pub const fn by_group(self) -> Self {
        Self {
            by_group: true,
            ..self
        }
    }
}

/// Findings of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyFindings {
    /// Name of the study.
    pub name: &'static str,
    /// Title of the study.
    pub title: &'static str,
    /// Paragraphs on the workload and the columns.
    pub about: Vec<String>,
    /// Heading of the choices' names.
    pub choice: &'static str,
    /// The measured quantities.
    pub columns: Vec<StudyColumn>,
    /// The choices.
    pub rows: Vec<Row>,
    /// The traded columns.
    pub trades: Vec<Trade>,
}

impl StudyFindings {
    /// The value of a row in a column.
    #[must_use]
    pub fn value(&self, row: usize, column: usize) -> Option<&Measurement> {
        self.rows.get(row)?.values.get(column)
    }

    /// Heading of a column.
    #[must_use]
    pub fn heading(&self, column: usize) -> &'static str {
        self.columns.get(column).map_or("", |c| c.heading)
    }

    /// Whether each row is on the front of a trade: the medians of no other row dominate its
    /// minima. With fronts by group, only rows of the same group compete.
    #[must_use]
    pub fn front(&self, trade: &Trade) -> Vec<bool> {
        self.by_group(trade, |rows| {
            front_within_spread(
                &costs(rows, trade, Measurement::middle),
                &costs(rows, trade, Measurement::best),
            )
        })
    }

    /// The same with medians alone: the steps of a figure.
    #[must_use]
    pub fn steps(&self, trade: &Trade) -> Vec<bool> {
        self.by_group(trade, |rows| {
            front(&costs(rows, trade, Measurement::middle))
        })
    }

    /// The groups in their order, or `[None]` for one front over all rows.
    #[must_use]
    pub fn circumstances(&self, trade: &Trade) -> Vec<Option<&'static str>> {
        if !trade.by_group {
            return vec![None];
        }
        let mut groups = Vec::new();
        for row in &self.rows {
            if !groups.contains(&Some(row.group)) {
                groups.push(Some(row.group));
            }
        }
        groups
    }

    fn by_group(&self, trade: &Trade, front: impl Fn(&[&Row]) -> Vec<bool>) -> Vec<bool> {
        let mut on = vec![false; self.rows.len()];
        for group in self.circumstances(trade) {
            let of_group = |row: &Row| group.is_none_or(|group| row.group == group);
            let rows: Vec<&Row> = self.rows.iter().filter(|row| of_group(row)).collect();
            let places = self
                .rows
                .iter()
                .zip(&mut on)
                .filter(|(row, _)| of_group(row));
            for ((_, place), found) in places.zip(front(&rows)) {
                *place = found;
            }
        }
        on
    }

    /// Marks of each row: a star for the only front, otherwise the numbers of the figures whose
    /// fronts contain it.
    #[must_use]
    pub fn marks(&self) -> Vec<String> {
        let mut marks = vec![String::new(); self.rows.len()];
        for (number, trade) in self.trades.iter().enumerate() {
            let mark = match self.trades.len() {
                1 => "*".to_owned(),
                _ => (number + 1).to_string(),
            };
            let on = self.front(trade).into_iter();
            for (marks, _) in marks.iter_mut().zip(on).filter(|(_, on)| *on) {
                if !marks.is_empty() {
                    marks.push(',');
                }
                marks.push_str(&mark);
            }
        }
        marks
    }

    /// A sentence on each front, with its choices in order of cost.
    #[must_use]
    pub fn verdicts(&self) -> Vec<String> {
        let trades = self.trades.iter();
        trades
            .flat_map(|trade| {
                let groups = self.circumstances(trade).into_iter();
                groups.map(|group| self.verdict(trade, group))
            })
            .collect()
    }

    fn verdict(&self, trade: &Trade, group: Option<&str>) -> String {
        let middle =
            |row: &Row, column: usize| row.values.get(column).map_or(f64::NAN, Measurement::middle);
        let rows = self.rows.iter().zip(self.front(trade));
        let all = rows.filter(|(row, _)| group.is_none_or(|group| row.group == group));
        let mut on: Vec<&Row> = all
            .clone()
            .filter_map(|(row, on)| on.then_some(row))
            .collect();
        on.sort_by(|a, b| middle(a, trade.cost).total_cmp(&middle(b, trade.cost)));
        let named = on.iter().map(|row| {
            let cost = short(middle(row, trade.cost));
            let loss = short(middle(row, trade.loss));
            format!("{} ({cost}; {loss})", row.name)
        });
        let named: Vec<String> = named.collect();
        let names = match named.as_slice() {
            [first, .., last] if named.len() > MOST_NAMED => {
                let (on, all) = (named.len(), all.count());
                format!("{on} of {all} choices, from {first} to {last}")
            }
            _ => named.join(", "),
        };
        format!(
            "Pareto front of {} and {}{}: {names}.",
            self.heading(trade.cost),
            self.heading(trade.loss),
            group.map_or(String::new(), |group| format!(", {group}")),
        )
    }
}

fn costs(rows: &[&Row], trade: &Trade, of: impl Fn(&Measurement) -> f64) -> Vec<Vec<f64>> {
    let value = |row: &Row, column: usize| row.values.get(column).map_or(f64::NAN, &of);
    let pair = |row: &&Row| vec![value(row, trade.cost), value(row, trade.loss)];
    rows.iter().map(pair).collect()
}

/// The machine of a measurement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Processor.
    pub cpu: String,
    /// Number of usable cores.
    pub cores: usize,
    /// Operating system.
    pub os: String,
    /// Build profile: `release` or `debug`.
    pub build: &'static str,
}

impl Machine {
    /// This machine; `read` returns the text of a system file if it exists.
    #[must_use]
    pub fn current(read: impl Fn(&str) -> Option<String>) -> Self {
        let read = |path| read(path).unwrap_or_default();
        let cpu = cpu_name(&read("/proc/cpuinfo"));
        Self {
            cpu: cpu.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: os_name(
                &read("/etc/os-release"),
                &read("/proc/sys/kernel/osrelease"),
            ),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            },
        }
    }

    /// The machine in one line.
    #[must_use]
    pub fn line(&self) -> String {
        let cores = match self.cores {
            1 => "1 core".to_owned(),
            n => format!("{n} cores"),
        };
        format!("{}, {cores}, {}", self.cpu, self.os)
    }
}

/// Name of the processor. ARM kernels report the board instead.
fn cpu_name(cpuinfo: &str) -> Option<String> {
    let of = |key: &str| {
        let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        let (_, value) = lines.find(|(name, _)| name.trim() == key)?;
        Some(value.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    of("model name").or_else(|| of("Model"))
}

fn os_name(os_release: &str, kernel: &str) -> String {
    let mut lines = os_release.lines();
    let name = lines.find_map(|line| line.strip_prefix("PRETTY_NAME="));
    let name = name.map_or(std::env::consts::OS, |name| name.trim_matches('"'));
    match kernel.trim() {
        "" => name.to_owned(),
        kernel => format!("{name}, kernel {kernel}"),
    }
}

/// All findings of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyReport {
    /// Name and version of the program.
    pub program: String,
    /// Size of the workloads.
    pub effort: Effort,
    /// The machine.
    pub machine: Machine,
    /// Findings of the studies.
    pub studies: Vec<StudyFindings>,
}

impl StudyReport {
    /// Reasons to distrust the figures, one sentence each.
    #[must_use]
    pub fn cautions(&self) -> Vec<&'static str> {
        let mut cautions = Vec::new();
        if self.effort == Effort::Quick {
            cautions.push("A quick look: small workloads and few rounds. Leave --quick out for figures to rely on.");
        }
        if self.machine.build != "release" {
            cautions
                .push("Built without optimisation: the times say nothing about a release build.");
        }
        cautions
    }
}

/// Largest number of choices in a sentence.
const MOST_NAMED: usize = 6;

/// Findings of every kind, for tests.
#[cfg(test)]
pub(crate) fn example() -> StudyReport {
    let timed = |median: f64| {
        Measurement::Timed(TimingSpread {
            median,
            min: median * 0.9,
            max: median * 1.7,
            runs: 5,
        })
    };
    let row = |name: &str, group: &'static str, cost: f64, loss: f64, size: f64| Row {
        name: format!("{name} <&> way"),
        label: name.to_owned(),
        group,
        values: vec![
            timed(cost),
            Measurement::Computed(loss),
            Measurement::Computed(size),
        ],
    };
    let column = |key, heading, scale| StudyColumn {
        key,
        heading,
        scale,
    };
    StudyReport {
        program: "velomotion 0.0.0".to_owned(),
        effort: Effort::Quick,
        machine: Machine {
            cpu: "Processor <4>".to_owned(),
            cores: 2,
            os: "Linux".to_owned(),
            build: "release",
        },
        studies: vec![StudyFindings {
            name: "example",
            title: "Ways & means",
            about: vec!["What is <measured> here, in a sentence that is long enough to need a second line of text.".to_owned()],
            choice: "way",
            columns: vec![
                column("time_ns", "ns a point", Scale::Log),
                column("error_mm", "worst error, mm", Scale::Log),
                column("size_bytes", "bytes", Scale::Linear),
            ],
            rows: vec![
                row("coarse", "plain", 2.0, 130.0, 10.0),
                row("fine", "plain", 9.0, 1e-6, 12.0),
                row("exact", "clever", 20.0, 0.0, 14.0),
                row("bad", "clever", 21.0, 1.0, 9.0),
            ],
            trades: vec![
                Trade { cost: 0, loss: 1, joined: true, by_group: false },
                Trade { cost: 2, loss: 1, joined: false, by_group: false },
            ],
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fronts_are_marked_by_number_and_described() {
        let report = example();
        let findings = &report.studies[0];
        assert_eq!(findings.marks(), ["1", "1,2", "1,2", "2"]);
        assert_eq!(
            findings.verdicts()[0],
            "Pareto front of ns a point and worst error, mm: coarse <&> way (2; 130), \
             fine <&> way (9; 1e-6), exact <&> way (20; 0)."
        );
    }

    #[test]
    fn separate_groups_have_separate_fronts() {
        let mut report = example();
        let findings = &mut report.studies[0];
        findings.trades.truncate(1);
        findings.trades[0].by_group = true;
        findings.rows[2].values[0] = Measurement::Computed(10.0);
        assert_eq!(findings.marks(), ["*", "*", "*", ""]);
        findings.rows[2].values[0] = Measurement::Computed(50.0);
        assert_eq!(findings.marks(), ["*", "*", "*", "*"]);
        let verdicts = findings.verdicts();
        assert_eq!(verdicts.len(), 2);
        assert!(
            verdicts[1].contains(", clever: bad <&> way (21; 1), exact <&> way (50; 0)."),
            "{verdicts:?}"
        );
    }

    #[test]
    fn quick_runs_and_debug_builds_are_reported() {
        let mut report = example();
        assert_eq!(report.cautions().len(), 1);
        report.machine.build = "debug";
        assert_eq!(report.cautions().len(), 2);
        report.effort = Effort::Full;
        report.machine.build = "release";
        assert!(report.cautions().is_empty());
    }

    #[test]
    fn processors_are_named_on_both_architectures() {
        let x86 = "processor\t: 0\nmodel\t\t: 17\nmodel name\t: Some  CPU @ 3GHz\n";
        assert_eq!(cpu_name(x86).as_deref(), Some("Some CPU @ 3GHz"));
        let arm = "processor\t: 0\nBogoMIPS\t: 108.00\n\nModel\t\t: A Board Rev 1.1\n";
        assert_eq!(cpu_name(arm).as_deref(), Some("A Board Rev 1.1"));
        assert_eq!(cpu_name(""), None);
    }

    #[test]
    fn the_system_is_named_with_its_kernel() {
        let release = "NAME=\"X\"\nPRETTY_NAME=\"X 12 (y)\"\n";
        assert_eq!(os_name(release, "6.1.0\n"), "X 12 (y), kernel 6.1.0");
        assert_eq!(os_name("", ""), std::env::consts::OS);
    }
}
