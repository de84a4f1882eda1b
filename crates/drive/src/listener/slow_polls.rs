//! Polls that are further apart than a master waits for a reply.
//!
//! After a missing reply two polls are outstanding, and every later reply fits both the poll before
//! it and its own. Where a timeout may lie between polls, their timing alone does not show that the
//! first one was answered ([`RequestMatcher::retire_answered`]). A reply to the newer poll comes
//! within the usual time and has the position that the axis has by then. If the position does not
//! show it, the silence after the reply does: a drive with two requests answers both in a row.
//!
//! [`RequestMatcher::retire_answered`]: crate::request_matcher::RequestMatcher::retire_answered

use protocol::epos2::objects;
use units::{Host, Span, Stamp};

use super::Observation;
use super::recent_times::RecentTimes;
use crate::event::ShaftSample;
use crate::exchange::{ObjectAccess, Reply};
use crate::request_matcher::SentRequest;

/// Positions of an axis at rest differ by at most this.
const REST_COUNTS: f64 = 2.0;
/// Greatest deviation from the expected position, relative to the way between two polls.
const MAX_DEVIATION: f64 = 0.25;

/// The last replies and positions, and a reply that fits several polls.
#[derive(Clone, Debug, Default)]
pub(super) struct SlowPolls {
    reply_times: RecentTimes,
    /// The last two samples, the newer one second.
    samples: [Option<ShaftSample>; 2],
    /// The newest poll that an unmatched reply fits, and when that reply came.
    unmatched: Option<(u64, Stamp<Host>)>,
}

impl SlowPolls {
    pub fn learn(&mut self, seen: Option<&Observation>, reply_time: Span) {
        self.reply_times.learn(reply_time);
        self.unmatched = None;
        if let Some(Observation::Sample(sample)) = seen {
            self.samples = [self.samples[1], Some(*sample)];
        }
    }

    /// Whether a reply that fits two polls belongs to the newer one.
    pub fn is_of_newer(
        &self,
        [older, newer]: [&SentRequest; 2],
        reply: &Reply,
        host: Stamp<Host>,
    ) -> bool {
        let is_poll = |request: &SentRequest| {
            request.access == ObjectAccess::Read
                && request.address == objects::POSITION_ACTUAL.address
        };
        let usual = self.reply_times.usual();
        if !is_poll(older) || !is_poll(newer) || !reply.error().is_none() {
            return false;
        }
        let (Some(value), Some((shortest, longest))) = (reply.value(), usual) else {
            return false;
        };
        let reply_time = host.saturating_since(newer.sent);
        let position = f64::from(objects::POSITION_ACTUAL.decode(value));
        (shortest..=longest).contains(&reply_time)
            && self
                .expected(older.sent)
                .zip(self.expected(newer.sent))
                .is_some_and(|(at_older, at_newer)| {
                    let way = (at_newer - at_older).abs();
                    (position - at_newer).abs() <= (MAX_DEVIATION * way).max(REST_COUNTS)
                })
    }

    /// Notes a reply that is matched to none of several requests.
    pub fn note_unmatched(&mut self, newest: &SentRequest, host: Stamp<Host>) {
        self.unmatched = Some((newest.id, host));
    }

    /// The request that is certainly no longer outstanding at `next`: no second reply followed the
    /// unmatched one.
    pub fn settled(&self, next: Stamp<Host>) -> Option<u64> {
        let (id, host) = self.unmatched?;
        let (_, longest) = self.reply_times.usual()?;
        (next.saturating_since(host) > longest).then_some(id)
    }

    /// The position at an even rate, from the last two.
    fn expected(&self, at: Stamp<Host>) -> Option<f64> {
        let [Some(first), Some(second)] = self.samples else {
            return None;
        };
        let seconds = |from: Stamp<Host>, to: Stamp<Host>| to.saturating_since(from).as_secs_f64();
        let length = seconds(first.request, second.request);
        let rate = f64::from(second.position.0.saturating_sub(first.position.0)) / length;
        (length > 0.0).then(|| f64::from(second.position.0) + rate * seconds(second.request, at))
    }
}
