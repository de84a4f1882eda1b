//! The stream of positions on a CAN bus, as the procedures take from it.

use std::future::poll_fn;
use std::task::Poll;

use units::Span;

use crate::bus::Bus;
use crate::event::ShaftSample;

use super::{Ops, lock};

/// A stream that has been silent for so long is helped along by asking.
const STREAM_SILENCE: Span = Span::from_millis(20);

impl Ops {
    /// The next position of the stream; `None` without one, while it is silent, and at an alarm.
    pub(super) async fn streamed(&self) -> Option<ShaftSample> {
        let asked = self.on_bus(|bus, now| {
            bus.sample(now);
            bus.streaming && (!bus.mute || bus.has_fresh())
        });
        asked.filter(|streaming| *streaming)?;
        let until = self.now().saturating_add(STREAM_SILENCE);
        poll_fn(|_| {
            let mut core = lock(&self.core);
            let over = core.now >= until || (self.watching && core.has_alarm());
            let fresh = core.bus.as_mut().and_then(Bus::take_fresh);
            core.wake = Some(until).filter(|_| fresh.is_none() && !over);
            if let (None, true, Some(bus)) = (fresh, over, &mut core.bus) {
                bus.mute = true;
            }
            if fresh.is_some() || over {
                Poll::Ready(fresh)
            } else {
                Poll::Pending
            }
        })
        .await
    }
}
