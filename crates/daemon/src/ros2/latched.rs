//! The last message of a topic, kept for subscribers that come later (durability "transient local").
//!
//! `rmw_zenoh` uses the advanced publisher of `zenoh-ext` for that, whose agreement with its subscribers is kept here: a token and a queryable at
//! `KEY/@adv/pub/ZID/uhlc/_`, asked by whoever subscribes later or finds the token later, and samples told apart by their timestamps. Left out: numbered
//! samples and their recovery, which one message over TCP does not need.

use std::sync::{Arc, Mutex, PoisonError};

use zenoh::liveliness::LivelinessToken;
use zenoh::query::{Query, Queryable};
use zenoh::time::Timestamp;
use zenoh::{Session, Wait};

use super::link::Error;

/// What is kept.
#[derive(Default)]
struct Kept {
    bytes: Vec<u8>,
    attachment: Vec<u8>,
    time: Option<Timestamp>,
}

/// Answers those who come later.
pub struct Latched {
    kept: Arc<Mutex<Kept>>,
    _queryable: Queryable<()>,
    _token: LivelinessToken,
}

impl Latched {
    /// For what is sent with `key` by the session `zid`.
    pub fn declare(session: &Session, zid: &str, key: &str) -> Result<Self, Error> {
        let kept = Arc::new(Mutex::new(Kept::default()));
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

    /// This is the last message.
    pub fn keep(&self, bytes: &[u8], attachment: &[u8], time: Timestamp) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = Kept {
            bytes: bytes.to_vec(),
            attachment: attachment.to_vec(),
            time: Some(time),
        };
    }
}

fn answer(query: &Query, key: &str, kept: &Mutex<Kept>) -> Result<(), Error> {
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
