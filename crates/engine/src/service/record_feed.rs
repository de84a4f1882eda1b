//! Records of the devices for another thread, which is never waited for.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};

use io::log::OwnedRecord;
use protocol::record::Record;

use super::locked;

/// The sending end of a bounded queue of records. Clones share it.
#[derive(Clone, Debug)]
pub struct RecordQueue {
    sender: SyncSender<OwnedRecord>,
    left_out: Arc<AtomicU64>,
}

impl RecordQueue {
    /// A queue in which this many records may wait, and its receiving end.
    #[must_use]
    pub fn new(records: usize) -> (Self, Receiver<OwnedRecord>) {
        let (sender, receiver) = sync_channel(records);
        let queue = Self {
            sender,
            left_out: Arc::default(),
        };
        (queue, receiver)
    }

    /// Counter of the records that were left out because the queue was full.
    #[must_use]
    pub const fn left_out(&self) -> &Arc<AtomicU64> {
        &self.left_out
    }
}

/// Passes records on to a queue, if there is one. Clones share it.
#[derive(Clone, Default)]
pub(super) struct RecordFeed {
    queue: Arc<Mutex<Option<RecordQueue>>>,
}

impl RecordFeed {
    /// Passes a record on without waiting. A queue whose receiving end is gone is dropped.
    pub(super) fn record(&self, record: &Record<'_>) {
        let mut slot = locked(&self.queue);
        let Some(queue) = &*slot else { return };
        match queue.sender.try_send(record.into()) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                queue.left_out.fetch_add(1, Ordering::Relaxed);
            }
            Err(TrySendError::Disconnected(_)) => *slot = None,
        }
    }

    /// Changes the queue.
    pub(super) fn set(&self, queue: Option<RecordQueue>) {
        *locked(&self.queue) = queue;
    }
}

#[cfg(test)]
mod tests {
    use protocol::record::Wire;
    use units::Stamp;

    use super::*;

    fn record(feed: &RecordFeed, number: i64) {
        feed.record(&Record {
            host: Stamp::from_nanos(number),
            wire: Wire::Lidar {
                source: [127, 0, 0, 1],
                port: 2368,
                payload: &[7; 3],
            },
        });
    }

    #[test]
    fn a_full_queue_is_not_waited_for_and_an_abandoned_one_is_dropped() {
        let feed = RecordFeed::default();
        record(&feed, 0);
        let (queue, receiver) = RecordQueue::new(2);
        let left_out = Arc::clone(queue.left_out());
        feed.set(Some(queue));
        (1..=5).for_each(|number| record(&feed, number));
        let received: Vec<i64> = receiver
            .try_iter()
            .map(|record| record.as_record().host.as_nanos())
            .collect();
        assert_eq!(received, [1, 2]);
        assert_eq!(left_out.load(Ordering::Relaxed), 3);
        drop(receiver);
        record(&feed, 6);
        assert!(locked(&feed.queue).is_none());
        assert_eq!(left_out.load(Ordering::Relaxed), 3);
    }
}
