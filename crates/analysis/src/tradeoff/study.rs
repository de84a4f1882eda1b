//! Studies and their findings.

use std::fmt;

use cloud::SinkError;
use serde::Serialize;
use units::{Host, Span, Stamp};
use utoipa::ToSchema;

use super::front::{front, front_within_spread};
use super::{TimingPlan, TimingSpread, Work, in_rounds};
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
    /// Measures the choices.
    pub measure: fn(&mut Bench<'_>) -> Result<Measured, StudyError>,
}

/// Paragraphs on the workload and the columns, and the choices.
pub type Measured = (Vec<String>, Vec<Row>);

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
#[derive(Clone, Debug)]
pub struct StudyFindings {
    /// The study.
    pub study: Study,
    /// Paragraphs on the workload and the columns.
    pub about: Vec<String>,
    /// The choices.
    pub rows: Vec<Row>,
}

impl StudyFindings {
    /// Key and heading of a column.
    #[must_use]
    pub fn column(&self, column: usize) -> (&'static str, &'static str) {
        self.study.columns.get(column).copied().unwrap_or_default()
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

    /// The groups in their order.
    #[must_use]
    pub fn groups(&self) -> Vec<&'static str> {
        let mut groups = Vec::new();
        for row in &self.rows {
            if !groups.contains(&row.group) {
                groups.push(row.group);
            }
        }
        groups
    }

    /// The groups, or `[None]` for one front over all rows.
    #[must_use]
    pub fn circumstances(&self, trade: &Trade) -> Vec<Option<&'static str>> {
        match trade.by_group {
            true => self.groups().into_iter().map(Some).collect(),
            false => vec![None],
        }
    }

    fn by_group(&self, trade: &Trade, front: impl Fn(&[&Row]) -> Vec<bool>) -> Vec<bool> {
        let mut on = vec![false; self.rows.len()];
        for group in self.circumstances(trade) {
            let both = self.rows.iter().zip(&mut on);
            let own = both.filter(|(row, _)| group.is_none_or(|group| row.group == group));
            let (rows, places): (Vec<&Row>, Vec<&mut bool>) = own.unzip();
            for (place, is_on) in places.into_iter().zip(front(&rows)) {
                *place = is_on;
            }
        }
        on
    }

    /// Marks of each row: a star for the only front, otherwise the numbers of the figures whose
    /// fronts contain it.
    #[must_use]
    pub fn marks(&self) -> Vec<String> {
        let mut marks = vec![String::new(); self.rows.len()];
        for (number, trade) in self.study.trades.iter().enumerate() {
            let mark = match self.study.trades.len() {
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

    /// Headings of the table: of the choices, the columns and the marks.
    #[must_use]
    pub fn headings(&self) -> Vec<&'static str> {
        let columns = self.study.columns.iter().map(|(_, heading)| *heading);
        let headings = [self.study.choice].into_iter().chain(columns);
        headings.chain(["front"]).collect()
    }

    /// Rows of the table: name, values and mark of each choice.
    #[must_use]
    pub fn cells(&self) -> Vec<Vec<String>> {
        let rows = self.rows.iter().zip(self.marks());
        let cells = rows.map(|(row, mark)| {
            let values = row.values.iter().map(Measurement::text);
            let cells = [row.name.clone()].into_iter().chain(values);
            cells.chain([mark]).collect()
        });
        cells.collect()
    }

    /// A sentence on each front, with its choices in order of cost.
    #[must_use]
    pub fn verdicts(&self) -> Vec<String> {
        let trades = self.study.trades.iter();
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
            self.column(trade.cost).1,
            self.column(trade.loss).1,
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
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
#[derive(Clone, Debug)]
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
    /// Measures studies one after the other.
    ///
    /// # Errors
    /// The name of the first study that fails, and its error.
    pub fn measure(
        studies: &[Study],
        machine: Machine,
        bench: Bench<'_>,
    ) -> Result<Self, (&'static str, StudyError)> {
        let mut findings = Vec::with_capacity(studies.len());
        for (index, &study) in studies.iter().enumerate() {
            (bench.say)(&format!(
                "{} of {}: {}",
                index + 1,
                studies.len(),
                study.title
            ));
            let mut indented = Bench {
                clock: &mut *bench.clock,
                effort: bench.effort,
                say: &mut |line| (bench.say)(&format!("  {line}")),
            };
            let (about, rows) =
                (study.measure)(&mut indented).map_err(|error| (study.name, error))?;
            findings.push(StudyFindings { study, about, rows });
        }
        Ok(Self {
            program: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
            effort: bench.effort,
            machine,
            studies: findings,
        })
    }

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
            study: Study {
                name: "example",
                title: "Ways & means",
                choice: "way",
                columns: &[
                    ("time_ns", "ns a point"),
                    ("error_mm", "worst error, mm"),
                    ("size_bytes", "bytes"),
                ],
                trades: const { &[Trade::new(0, 1).joined(), Trade::new(2, 1)] },
                measure: |_| Ok(Measured::default()),
            },
            about: vec!["What is <measured> here, in a sentence that is long enough to need a second line of text.".to_owned()],
            rows: vec![
                row("coarse", "plain", 2.0, 130.0, 10.0),
                row("fine", "plain", 9.0, 1e-6, 12.0),
                row("exact", "clever", 20.0, 0.0, 14.0),
                row("bad", "clever", 21.0, 1.0, 9.0),
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
        findings.study.trades = const { &[Trade::new(0, 1).joined().by_group()] };
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
