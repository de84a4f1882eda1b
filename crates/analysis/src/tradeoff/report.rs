//! All findings of one run.

use super::{Bench, Effort, Machine, Measurement, Study, StudyError, StudyFindings};
#[cfg(test)]
use super::{Row, StudyRows, TimingSpread, Trade};

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

    /// Whether any of the values are times.
    #[must_use]
    pub fn is_timed(&self) -> bool {
        let rows = self.studies.iter().flat_map(|study| &study.rows);
        let mut values = rows.flat_map(|row| &row.values);
        values.any(|value| matches!(value, Measurement::Timed(_)))
    }

    /// Reasons to distrust the figures, one sentence each.
    #[must_use]
    pub fn cautions(&self) -> Vec<&'static str> {
        let mut cautions = Vec::new();
        if self.effort == Effort::Quick {
            cautions
                .push("A quick look at less than all. Leave --quick out for figures to rely on.");
        }
        if self.is_timed() && self.machine.build != "release" {
            cautions
                .push("Built without optimisation: the times say nothing about a release build.");
        }
        cautions
    }
}

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
                    ("time_ns", "ns per point"),
                    ("error_mm", "worst error, mm"),
                    ("size_bytes", "bytes"),
                ],
                trades: const { &[Trade::new(0, 1).joined(), Trade::new(2, 1)] },
                finding: StudyFindings::ends_of_front,
                measure: |_| Ok(StudyRows::default()),
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
    fn quick_runs_and_debug_builds_are_reported() {
        let mut report = example();
        assert_eq!(report.cautions().len(), 1);
        report.machine.build = "debug";
        assert_eq!(report.cautions().len(), 2);
        report.effort = Effort::Full;
        report.machine.build = "release";
        assert!(report.cautions().is_empty());
    }
}
