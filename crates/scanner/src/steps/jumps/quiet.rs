//! How small a jump of the delays is no chance.
//!
//! On a quiet network, whose least delays hardly vary from window to window and whose packets are
//! usually hardly later than the least delayed ones, jumps from 0.1 ms on count.

use super::{SMALL_WINDOW, SMALLEST_OF_HOST_NS};

/// The smallest jump on a quiet network: steps by 0.1 ms, less the drift that is not known.
const SMALLEST_ON_QUIET_NS: i64 = 75_000;
/// Spreads of the least delays that a jump must exceed.
pub(super) const MIN_SPREADS: i64 = 3;
/// Windows that show the spread of the least delays, and the packets of one in a short recording.
const MIN_SPREAD_WINDOWS: usize = 8;
const SHORT_WINDOW: usize = 64;

/// The offsets without the mean drift of the clocks, and the smallest jump that is no chance: the
/// least delays of windows of packets vary by less.
pub(super) fn without_drift(offsets: &[i64]) -> (Vec<i64>, i64) {
    let windows = [SMALL_WINDOW, SMALL_WINDOW / 2, SHORT_WINDOW];
    let found = windows
        .into_iter()
        .find_map(|window| Some((window, spread(offsets, window)?)));
    let Some((window, (drift, spread))) = found else {
        return (offsets.to_vec(), SMALLEST_OF_HOST_NS);
    };
    let smallest = (MIN_SPREADS.saturating_mul(spread))
        .max(usual_excess(offsets))
        .clamp(SMALLEST_ON_QUIET_NS, SMALLEST_OF_HOST_NS);
    let per_packet = drift as f64 / window as f64;
    let level = offsets
        .iter()
        .enumerate()
        .map(|(at, offset)| offset.saturating_sub((at as f64 * per_packet) as i64));
    (level.collect(), smallest)
}

/// By how much a packet is later than the least delayed of its window: the median.
fn usual_excess(offsets: &[i64]) -> i64 {
    let mut excess: Vec<i64> = offsets
        .chunks(SHORT_WINDOW)
        .filter_map(|window| Some((window, *window.iter().min()?)))
        .flat_map(|(window, least)| window.iter().map(move |ns| ns.saturating_sub(least)))
        .collect();
    let middle = excess.len() / 2;
    match excess.is_empty() {
        true => 0,
        false => *excess.select_nth_unstable(middle).1,
    }
}

/// Drift of the least offsets from window to window of so many packets, and the median deviation
/// from it; `None` with few windows.
pub(super) fn spread(offsets: &[i64], window: usize) -> Option<(i64, i64)> {
    let least: Vec<i64> = offsets
        .chunks_exact(window)
        .filter_map(|window| window.iter().min().copied())
        .collect();
    let mut rises: Vec<i64> = least
        .windows(2)
        .filter_map(|pair| Some(pair.last()?.saturating_sub(*pair.first()?)))
        .collect();
    if rises.len() < MIN_SPREAD_WINDOWS {
        return None;
    }
    let middle = rises.len() / 2;
    let drift = *rises.select_nth_unstable(middle).1;
    for rise in &mut rises {
        *rise = rise.saturating_sub(drift).saturating_abs();
    }
    Some((drift, *rises.select_nth_unstable(middle).1))
}
