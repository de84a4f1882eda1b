//! Stretches of a recording between steps of the clocks, and the lines under them.
//!
//! A step of known size does not interrupt a line: the rate of the device's clock is the same on
//! both sides, and a few packets on one side share the line of many on the other.

use units::{Host, Lidar, Span, Stamp};

use super::Arrival;
use super::device::ClockPiece;
use super::envelope::Envelope;

/// Arrivals between two steps of a clock.
pub(crate) struct Stretch<C = Lidar> {
    /// All arrivals, in order of device time.
    pub all: Vec<Arrival<C>>,
    /// Those that certainly belong to it, in order of device time.
    pub sure: Vec<Arrival<C>>,
    /// First and last device time of all arrivals.
    pub first: Stamp<C>,
    pub last: Stamp<C>,
    /// Device time where the stretch begins in the recording.
    pub join: Stamp<C>,
    /// Receive time there, by the host's clock of that time.
    pub received: Stamp<Host>,
}

/// Event between two stretches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Joint {
    /// The host's clock was set; host times continue from the stretch before.
    HostWasSet,
    /// The device's clock was set, or the device started again.
    DeviceWasSet,
    /// The device's clock was set forward by so much: its rate is the same on both sides.
    DeviceWasSetBy(Span),
}

/// Stretches with one line, as the steps between them are known.
pub(super) struct Run<'a, C> {
    /// Each with the sum of the steps before it in the run.
    stretches: Vec<(&'a Stretch<C>, i64)>,
}

/// Fewest arrivals that determine a line without uncertain ones.
const MIN_SURE: usize = 16;
/// Error of a known step: stamps are whole microseconds.
const STAMP_NS: f64 = 1e3;

/// Groups stretches across known steps of the device's clock.
pub(super) fn runs<'a, C>(stretches: &'a [Stretch<C>], joints: &[Joint]) -> Vec<Run<'a, C>> {
    let mut runs: Vec<Run<'a, C>> = Vec::new();
    for (i, stretch) in stretches.iter().enumerate() {
        let joint = i.checked_sub(1).and_then(|i| joints.get(i));
        match (runs.last_mut(), joint) {
            (Some(run), Some(Joint::DeviceWasSetBy(by))) => {
                let before = run.stretches.last().map_or(0, |last| last.1);
                run.stretches
                    .push((stretch, before.saturating_add(by.as_nanos())));
            }
            _ => runs.push(Run {
                stretches: vec![(stretch, 0)],
            }),
        }
    }
    runs
}

impl<C: Copy> Run<'_, C> {
    /// Fits one envelope, by the device's clock as it was before the steps.
    pub fn fit(&self, origin_ns: i64) -> Option<Vec<ClockPiece>> {
        let sure = self.stretches.iter().map(|(stretch, _)| stretch.sure.len());
        let is_few = sure.sum::<usize>() < MIN_SURE;
        let arrivals = |stretch: &'_ Stretch<C>| match is_few && !stretch.all.is_empty() {
            true => stretch.all.clone(),
            false => stretch.sure.clone(),
        };
        let mut whole = None;
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (stretch, by) in &self.stretches {
            points.extend(arrivals(stretch).iter().map(|arrival| {
                let device = arrival.device.as_nanos().saturating_sub(*by);
                let y = arrival.host.as_nanos().wrapping_sub(device);
                let whole = *whole.get_or_insert(y);
                (
                    device.saturating_sub(origin_ns) as f64,
                    y.wrapping_sub(whole) as f64,
                )
            }));
        }
        let whole: i64 = whole?;
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Envelope { lines, cells } = Envelope::below(&points);
        let pieces = self.stretches.iter().map(|(stretch, by)| {
            let since_origin = |device: Stamp<C>| device.as_nanos().saturating_sub(origin_ns);
            let (mut lines, mut cells) = (lines.clone(), cells.clone());
            for line in &mut lines {
                line.centre_ns += *by as f64;
            }
            for cell in &mut cells {
                cell.from_ns += *by as f64;
                cell.bound_ns += if *by == 0 { 0.0 } else { STAMP_NS };
            }
            ClockPiece {
                from_ns: since_origin(stretch.first) as f64,
                to_ns: since_origin(stretch.last) as f64,
                end_ns: stretch.last.as_nanos(),
                received: stretch.received,
                whole: whole.wrapping_sub(*by),
                set_by: 0,
                lines,
                cells,
            }
        });
        Some(pieces.collect())
    }
}
