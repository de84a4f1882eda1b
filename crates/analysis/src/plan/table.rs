//! The table of a plan: what more time gives.

use rayon::prelude::*;

use super::search::NEARLY_LEAST;
use super::{PlanRow, PlannedScan, ScanPredictor};
use crate::tradeoff::front::front;

/// Rows at most.
const ROWS: usize = 12;
/// Stride through the directions that rank scans of alike times.
const RANKING_STRIDE: usize = 12;
/// Classes of time from the fastest scan to the slowest, each a constant factor longer than the one
/// before: 12 % for times of 2 to 1800 s. Of each the scan with the least gap is compared with
/// others by all directions.
const TIMES: usize = 60;

/// The class of a value, of so many classes between two values, each wider by the same factor.
fn class(value: f64, (from, to): (f64, f64), count: usize) -> usize {
    let share = (value / from).ln() / (to / from).ln();
    // Where both ends are alike there is one class.
    let share = if share.is_finite() { share } else { 0.0 };
    (share * count as f64).clamp(0.0, count as f64 - 1.0) as usize
}

/// The first of each class, of so many.
fn first_of_each<T>(values: Vec<T>, count: usize, class_of: impl Fn(&T) -> usize) -> Vec<T> {
    let mut taken = vec![false; count];
    let is_first = |value: &T| {
        let taken = taken.get_mut(class_of(value));
        taken.is_some_and(|taken| !std::mem::replace(taken, true))
    };
    values.into_iter().filter(is_first).collect()
}

impl ScanPredictor {
    /// Rows that no other row beats in time, 99 % gap and error at once: the fastest scan of each
    /// of 11 classes of gap, and of those that reach the least that there is, in the order of time.
    #[must_use]
    pub fn table(&self, scans: &[PlannedScan]) -> Vec<PlanRow> {
        let ranked = scans.par_iter();
        let ranked = ranked.map(|scan| {
            let gap_deg = self.rough_p99_deg(scan, RANKING_STRIDE);
            (scan, gap_deg)
        });
        let mut ranked: Vec<(&PlannedScan, f64)> = ranked.collect();
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.scan_s.total_cmp(&b.0.scan_s)));
        let times = || scans.iter().map(|scan| scan.scan_s);
        let ends_s = (
            times().fold(f64::INFINITY, f64::min),
            times().fold(0.0, f64::max),
        );
        let of_time = |(scan, _): &(&PlannedScan, f64)| class(scan.scan_s, ends_s, TIMES);
        let compared = first_of_each(ranked, TIMES, of_time).into_par_iter();
        let compared = compared.map(|(scan, _)| (scan, self.rough_p99_deg(scan, 1)));
        let mut compared: Vec<(&PlannedScan, f64)> = compared.collect();
        compared.sort_by(|a, b| a.0.scan_s.total_cmp(&b.0.scan_s));
        let gaps = || compared.iter().map(|(_, gap_deg)| *gap_deg);
        let ends_deg = (
            gaps().fold(0.0, f64::max),
            gaps().fold(f64::INFINITY, f64::min),
        );
        let of_gap = |(_, gap_deg): &(&PlannedScan, f64)| match *gap_deg {
            least if least <= NEARLY_LEAST * ends_deg.1 => ROWS - 1,
            gap_deg => class(gap_deg, ends_deg, ROWS - 1),
        };
        let fastest = first_of_each(compared, ROWS, of_gap).into_par_iter();
        let rows = fastest.map(|(scan, _)| self.capture_row(scan));
        let rows: Vec<PlanRow> = rows.collect();
        let costs = rows
            .iter()
            .map(|row| vec![row.scan_s, row.gap_deg.p99, row.error_mm.total]);
        let kept = front(&costs.collect::<Vec<_>>());
        let kept = rows.into_iter().zip(kept).filter(|(_, kept)| *kept);
        kept.map(|(row, _)| row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::search::tests::{predictor, scans};
    use super::*;

    #[test]
    fn tables_are_fronts_in_the_order_of_time() {
        let rows = predictor(None).table(&scans());
        assert!((4..=ROWS).contains(&rows.len()), "{rows:?}");
        for pair in rows.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            assert!(a.scan_s < b.scan_s, "{a:?} {b:?}");
            assert!(
                b.gap_deg.p99 < a.gap_deg.p99 || b.error_mm.total < a.error_mm.total,
                "{a:?} {b:?}"
            );
        }
    }
}
