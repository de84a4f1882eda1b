//! Every study in its quick form.

use std::collections::BTreeSet;

use analysis::tradeoff::{Bench, Effort, Measurement, StudyFindings};

use crate::STUDIES;

#[test]
fn every_study_is_complete() {
    for study in STUDIES {
        let mut bench = Bench {
            clock: &mut io::clock::steady,
            effort: Effort::Quick,
            say: &mut |_| (),
        };
        let (about, rows) = (study.measure)(&mut bench).unwrap();
        check_complete(&StudyFindings { study, about, rows });
    }
}

/// Every row has every column, spreads are in order, and every trade has a front.
fn check_complete(findings: &StudyFindings) {
    assert!(findings.rows.len() > 3 && findings.study.columns.len() > 1);
    let names: BTreeSet<&str> = findings.rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names.len(), findings.rows.len(), "{names:?}");
    for row in &findings.rows {
        assert_eq!(row.values.len(), findings.study.columns.len(), "{row:?}");
        for value in &row.values {
            match value {
                Measurement::Timed(spread) => {
                    assert!(0.0 < spread.min && spread.min <= spread.median, "{row:?}");
                    assert!(spread.median <= spread.max && spread.runs > 1, "{row:?}");
                }
                // An unknown bound is infinite, a share of nothing no number.
                Measurement::Computed(x) => assert!(x.is_nan() || *x >= 0.0, "{row:?}"),
            }
        }
    }
    for trade in findings.study.trades {
        assert!(findings.front(trade).contains(&true), "{trade:?}");
    }
}
