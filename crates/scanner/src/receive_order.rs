//! Receive times that tell packets apart.
//!
//! Packets that were held up arrive together and may have one receive time. Where the lidar's clock
//! read the same twice, the receive time decides which packet came after the step.

use units::{Host, Span, Stamp};

/// Makes the receive times of packets in order of recording distinct.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReceiveOrder {
    last: Option<Stamp<Host>>,
}

/// Times that go back by more are of reordered records, or of a clock that was set.
const MOST_BACK: Span = Span::from_micros(1);

impl ReceiveOrder {
    /// The receive time, or one nanosecond more than that of the packet before it.
    pub fn distinct(&mut self, host: Stamp<Host>) -> Stamp<Host> {
        let distinct = match self.last {
            Some(last) if host <= last && last.saturating_since(host) < MOST_BACK => {
                last.saturating_add(Span::from_nanos(1))
            }
            _ => host,
        };
        self.last = Some(distinct);
        distinct
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_times_become_distinct_and_others_stay() {
        let mut order = ReceiveOrder::default();
        let seen = [5_000, 5_000, 5_000, 5_001, 9_000, 3_000, 3_000];
        let distinct = seen.map(|ns| order.distinct(Stamp::from_nanos(ns)).as_nanos());
        assert_eq!(distinct, [5_000, 5_001, 5_002, 5_003, 9_000, 3_000, 3_001]);
    }
}
