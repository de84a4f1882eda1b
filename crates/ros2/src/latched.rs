//! The last message of a topic, kept for later subscribers (durability "transient local").
//!
//! `rmw_zenoh` uses the advanced publisher of `zenoh-ext` for this. Its protocol is kept: a token
//! and a queryable at `KEY/@adv/pub/ZID/uhlc/_`, queried by later subscribers, which tell samples
//! apart by their timestamps. Numbered samples and their recovery are left out: one message over
//! TCP needs none.

use std::sync::{Arc, Mutex, PoisonError};

use zenoh::liveliness::LivelinessToken;
use zenoh::query::{Query, Queryable};
use zenoh::time::Timestamp;
use zenoh::{Session, Wait};

use crate::link::Error;

/// The message kept.
#[derive(Default)]
struct LatchedMessage {
    bytes: Vec<u8>,
    attachment: Vec<u8>,
    time: Option<Timestamp>,
}

/// Answers later subscribers.
pub struct LatchedMessages {
    kept: Arc<Mutex<LatchedMessage>>,
    _queryable: Queryable<()>,
    _token: LivelinessToken,
}

impl LatchedMessages {
    /// For messages that the session `zid` sends with `key`.
    pub fn declare(session: &Session, zid: &str, key: &str) -> Result<Self, Error> {
        let kept = Arc::new(Mutex::new(LatchedMessage::default()));
        let place = format!("{key}/@adv/pub/{zid}/uhlc/_");
        let (answers, answered) = (Arc::clone(&kept), key.to_owned());
        let queryable = session
            .declare_queryable(place.clone())
            .callback(move |query| {
                if let Err(error) = answer(&query, &answered, &answers) {
                    tracing::debug!("{answered}: {error}");
                }
            })
            .wait()?;
        let token = session.liveliness().declare_token(place).wait()?;
        Ok(Self {
            kept,
            _queryable: queryable,
            _token: token,
        })
    }

    /// Keeps the last message.
    pub fn keep(&self, bytes: &[u8], attachment: &[u8], time: Timestamp) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = LatchedMessage {
            bytes: bytes.to_vec(),
            attachment: attachment.to_vec(),
            time: Some(time),
        };
    }
}

fn answer(query: &Query, key: &str, kept: &Mutex<LatchedMessage>) -> Result<(), Error> {
    let (bytes, attachment, time) = {
        let kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(time) = kept.time else {
            return Ok(());
        };
        (kept.bytes.clone(), kept.attachment.clone(), time)
    };
    let reply = query.reply(key, bytes).attachment(attachment);
    reply.timestamp(time).wait()
}
