//! Samples of the position stream on a CAN bus.

use std::future::poll_fn;
use std::task::Poll;

use units::Span;

use crate::event::ShaftSample;

use super::{Ops, lock};

/// Time without a sample after which the position is polled: 20 SYNC periods at 1 kHz.
const STREAM_TIMEOUT: Span = Span::from_millis(20);

impl Ops {
    /// The next sample of the stream; `None` without a stream, while it is stalled, and at an
    /// alarm.
    pub(super) async fn next_streamed(&self) -> Option<ShaftSample> {
        self.on_can(|can, now| can.request_samples(now))
            .filter(|expected| *expected)?;
        let until = self.now().saturating_add(STREAM_TIMEOUT);
        poll_fn(|_| {
            let mut core = lock(&self.core);
            let has_ended = core.now >= until || self.is_interrupted(&core);
            let sample = core.can.as_mut().and_then(|can| can.latest.take());
            core.wake = Some(until).filter(|_| sample.is_none() && !has_ended);
            if let (None, true, Some(can)) = (sample, has_ended, &mut core.can) {
                can.stalled = true;
            }
            if sample.is_some() || has_ended {
                Poll::Ready(sample)
            } else {
                Poll::Pending
            }
        })
        .await
    }
}
