//! Findings of a study: its table, its fronts and a sentence on each.

use super::front::{front, front_within_spread};
use super::{Measurement, Row, Study, Trade};
use crate::draw::number::short;

/// Largest number of choices in a sentence.
const MOST_NAMED: usize = 6;

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

    /// Costs and losses of the cheapest and the best choice on the front of the first trade, for
    /// each circumstance: the finding of a study without one of its own.
    #[must_use]
    pub fn ends_of_front(&self) -> String {
        let Some(trade) = self.study.trades.first() else {
            return self.study.title.to_owned();
        };
        let (cost, loss) = (self.column(trade.cost).1, self.column(trade.loss).1);
        let ends = self.circumstances(trade).into_iter().filter_map(|group| {
            let on = self.on_front(trade, group);
            let (first, last) = (on.first()?, on.last()?);
            let place = group.map_or(String::new(), |group| format!("{group}: "));
            let values = |column: usize| {
                let (a, b) = (middle(first, column), middle(last, column));
                (short(a), short(b))
            };
            let ((cheap, dear), (worse, better)) = (values(trade.cost), values(trade.loss));
            let (first, last) = (&first.label, &last.label);
            Some(match on.len() {
                1 => format!("{place}{first} is best: {cheap} {cost}, {loss} {worse}"),
                _ => format!(
                    "{place}{cheap} to {dear} {cost}, {loss} {worse} ({first}) to {better} ({last})"
                ),
            })
        });
        ends.collect::<Vec<String>>().join("; ")
    }

    /// The middle of a value, for the finding of a study; no number if there is none.
    #[must_use]
    pub fn value(&self, row: &str, column: usize) -> f64 {
        let found = self.rows.iter().find(|found| found.name == row);
        found.map_or(f64::NAN, |row| middle(row, column))
    }

    /// The same as text.
    #[must_use]
    pub fn text(&self, row: &str, column: usize) -> String {
        short(self.value(row, column))
    }

    /// Rows on the front of a trade, of one group or of all, in the order of cost.
    fn on_front(&self, trade: &Trade, group: Option<&str>) -> Vec<&Row> {
        let rows = self.rows.iter().zip(self.front(trade));
        let own = rows.filter(|(row, on)| *on && group.is_none_or(|group| row.group == group));
        let mut on: Vec<&Row> = own.map(|(row, _)| row).collect();
        on.sort_by(|a, b| middle(a, trade.cost).total_cmp(&middle(b, trade.cost)));
        on
    }

    fn verdict(&self, trade: &Trade, group: Option<&str>) -> String {
        let on = self.on_front(trade, group);
        let named = on.iter().map(|row| {
            let cost = short(middle(row, trade.cost));
            let loss = short(middle(row, trade.loss));
            format!("{} ({cost}; {loss})", row.name)
        });
        let named: Vec<String> = named.collect();
        let names = match named.as_slice() {
            [first, .., last] if named.len() > MOST_NAMED => {
                let rows = self.rows.iter();
                let all = rows.filter(|row| group.is_none_or(|group| row.group == group));
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

fn middle(row: &Row, column: usize) -> f64 {
    row.values.get(column).map_or(f64::NAN, Measurement::middle)
}

fn costs(rows: &[&Row], trade: &Trade, of: impl Fn(&Measurement) -> f64) -> Vec<Vec<f64>> {
    let value = |row: &Row, column: usize| row.values.get(column).map_or(f64::NAN, &of);
    let pair = |row: &&Row| vec![value(row, trade.cost), value(row, trade.loss)];
    rows.iter().map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    #[test]
    fn fronts_are_marked_by_number_and_described() {
        let report = example();
        let findings = &report.studies[0];
        assert_eq!(findings.marks(), ["1", "1,2", "1,2", "2"]);
        assert_eq!(
            findings.verdicts()[0],
            "Pareto front of ns per point and worst error, mm: coarse <&> way (2; 130), \
             fine <&> way (9; 1e-6), exact <&> way (20; 0)."
        );
    }

    #[test]
    fn the_usual_finding_has_the_ends_of_the_front() {
        let mut report = example();
        let findings = &mut report.studies[0];
        let found = "2 to 20 ns per point, worst error, mm 130 (coarse) to 0 (exact)";
        assert_eq!(findings.ends_of_front(), found);
        findings.rows.truncate(1);
        let alone = "coarse is best: 2 ns per point, worst error, mm 130";
        assert_eq!(findings.ends_of_front(), alone);
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
}
