//! The session with the router: a node, its publishers and its services.
//!
//! Messages wait for the network (`CongestionControl::Block`, at most zenoh's 5 s, after which the
//! connection is opened again) on threads that do nothing else. Clouds of sweeps have the lowest
//! priority, then live clouds and raw packets, then all small messages.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use cloud::messages::Topic;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::{Session, Wait};

use engine::config::ros2::Ros2;

use crate::calls::{self, Service};
use crate::latched::LatchedMessages;
use crate::rmw::{self, Entity, Gid, QualityOfService};
use crate::{Context, Counts};

/// Wait for a router before the bridge looks whether it ends.
const CONNECT_MS: u32 = 2_000;
/// First and longest interval between connection attempts.
const RETRY_MS: (u32, u32) = (250, 2_000);

/// An error of zenoh.
pub type Error = zenoh::Error;

/// Number and sender of a request.
pub type Request = (i64, Gid);

/// QoS of a topic, as ROS 2's own drivers, broadcasters and updaters have it.
const fn quality(topic: Topic) -> QualityOfService {
    let (reliable, latched, depth) = match topic {
        Topic::Points | Topic::LidarPackets | Topic::JointStates | Topic::Diagnostics => {
            (true, false, 10)
        }
        Topic::LivePoints => (false, false, 5),
        Topic::Transforms => (true, false, 100),
        Topic::StaticTransforms => (true, true, 1),
    };
    QualityOfService {
        reliable,
        latched,
        depth,
    }
}

const fn priority(topic: Topic) -> Priority {
    match topic {
        Topic::Points => Priority::DataLow,
        Topic::LivePoints | Topic::LidarPackets => Priority::Data,
        _ => Priority::DataHigh,
    }
}

/// Full name of a topic. Topics of the whole robot are in no namespace by convention.
fn name(settings: &Ros2, topic: Topic) -> String {
    match topic {
        Topic::Transforms | Topic::StaticTransforms | Topic::Diagnostics => topic.name().to_owned(),
        _ => settings.resolve(topic.name()),
    }
}

/// A session.
pub struct RouterLink {
    counts: Arc<Counts>,
    session: Session,
    channels: BTreeMap<Topic, Channel>,
    /// Declare the node, publishers and services until dropped.
    _offers: Vec<LivelinessToken>,
}

/// A publisher.
struct Channel {
    publisher: Publisher<'static>,
    gid: Gid,
    /// Number of its last message.
    number: Mutex<i64>,
    latched: Option<LatchedMessages>,
}

impl RouterLink {
    /// Connects and declares everything; calls of services go to `calls`.
    pub fn open(context: &Context, inbox: &calls::Inbox) -> Result<Self, Error> {
        let settings = &context.settings;
        let config = serde_json::json!({
            "mode": "client",
            "connect": {
                "endpoints": [settings.router],
                "timeout_ms": CONNECT_MS,
                "retry": {
                    "period_init_ms": RETRY_MS.0,
                    "period_max_ms": RETRY_MS.1,
                    "period_increase_factor": 2,
                },
            },
            "scouting": { "multicast": { "enabled": false }, "gossip": { "enabled": false } },
            // Messages kept for later subscribers differ by their time.
            "timestamping": { "enabled": true },
        });
        let config = zenoh::Config::from_json5(&config.to_string())?;
        let session = zenoh::open(config).wait()?;
        let zid = session.zid().to_string();
        let token = session
            .liveliness()
            .declare_token(rmw::node_token(settings, &zid));
        let mut offers = vec![token.wait()?];
        let mut channels = BTreeMap::new();
        let mut id = 0;
        for topic in Topic::ALL {
            id += 1;
            let (channel, token) = Channel::declare(&session, settings, (id, &zid), topic)?;
            channels.insert(topic, channel);
            offers.push(token);
        }
        for service in Service::offered(settings) {
            id += 1;
            offers.push(calls::declare(
                &session,
                settings,
                (id, &zid),
                service,
                inbox,
            )?);
        }
        Ok(Self {
            counts: Arc::clone(&context.counts),
            session,
            channels,
            _offers: offers,
        })
    }

    /// Updates and returns whether a router is connected.
    pub fn update_connection(&self) -> bool {
        let info = self.session.info();
        // The other side may be a peer as well.
        let connected =
            info.routers_zid().wait().next().is_some() || info.peers_zid().wait().next().is_some();
        self.counts.connected.store(connected, Ordering::Relaxed);
        connected
    }

    /// Whether a topic has subscribers.
    pub fn is_watched(&self, topic: Topic) -> bool {
        let channel = self.channels.get(&topic);
        channel.is_some_and(|channel| {
            channel.latched.is_some()
                || channel
                    .publisher
                    .matching_status()
                    .wait()
                    .is_ok_and(|status| status.matching())
        })
    }

    /// Calls `change` with whether a topic has subscribers, now and whenever that changes.
    pub fn follow(
        &self,
        topic: Topic,
        change: impl Fn(bool) + Send + Sync + 'static,
    ) -> Result<(), Error> {
        let Some(channel) = self.channels.get(&topic) else {
            return Ok(());
        };
        let first = channel.publisher.matching_status().wait()?;
        change(first.matching());
        let listener = channel.publisher.matching_listener();
        let listener = listener.callback(move |status| change(status.matching()));
        listener.background().wait()
    }

    /// Sends a message to a topic with subscribers. Returns whether it was sent.
    pub fn send(&self, topic: Topic, bytes: &[u8]) -> Result<bool, Error> {
        if !self.is_watched(topic) {
            return Ok(false);
        }
        let Some(channel) = self.channels.get(&topic) else {
            return Ok(false);
        };
        channel.send(&self.session, bytes)?;
        let counts = &self.counts;
        counts.messages.fetch_add(1, Ordering::Relaxed);
        match topic {
            Topic::Points => counts.clouds.fetch_add(1, Ordering::Relaxed),
            Topic::LivePoints => counts.frames.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
        Ok(true)
    }

    /// Closes the session.
    pub fn close(self) {
        let connected = &self.counts.connected;
        connected.store(false, Ordering::Relaxed);
        // The router detects a lost session, too.
        let _ = self.session.close().wait();
    }
}

impl Channel {
    fn declare(
        session: &Session,
        settings: &Ros2,
        (id, zid): (u32, &str),
        topic: Topic,
    ) -> Result<(Self, LivelinessToken), Error> {
        let kind = topic.message_type();
        let (name, quality) = (name(settings, topic), quality(topic));
        let key = rmw::key(settings, &name, &kind);
        let latched = match quality.latched {
            true => Some(LatchedMessages::declare(session, zid, &key)?),
            false => None,
        };
        let publisher = session
            .declare_publisher(key)
            .congestion_control(CongestionControl::Block)
            .priority(priority(topic))
            .wait()?;
        let publisher_id = (id, Entity::Publisher);
        let token = rmw::token(settings, zid, publisher_id, (&name, &kind), quality);
        let gid = rmw::gid(&token);
        let token = session.liveliness().declare_token(token).wait()?;
        let channel = Self {
            publisher,
            gid,
            number: Mutex::new(0),
            latched,
        };
        Ok((channel, token))
    }

    fn send(&self, session: &Session, bytes: &[u8]) -> Result<(), Error> {
        // Held while it is sent, so that numbers go out in their order.
        let mut number = self.number.lock().unwrap_or_else(PoisonError::into_inner);
        *number = number.saturating_add(1);
        let sent_ns = io::clock::now().as_nanos();
        let attachment = rmw::attachment(*number, sent_ns, &self.gid);
        let time = session.new_timestamp();
        if let Some(latched) = &self.latched {
            latched.keep(bytes, &attachment, time);
        }
        let put = self.publisher.put(bytes).attachment(attachment);
        put.timestamp(time).wait()
    }
}

/// Number and sender of a query. Queries without an attachment of `rmw_zenoh` are refused.
pub fn request(query: &Query) -> Option<Request> {
    let attachment = query.attachment().map(|attachment| attachment.to_bytes());
    let request = attachment.and_then(|bytes| rmw::request_of(&bytes));
    if request.is_none() {
        let expected = "expected an attachment of rmw_zenoh: number, time, gid, 33 bytes";
        if let Err(error) = query.reply_err(expected).wait() {
            tracing::debug!("ROS 2: {error}");
        }
    }
    request
}

/// Answers a request with its own number and gid.
pub fn answer(query: &Query, (number, gid): Request, bytes: &[u8]) -> Result<(), Error> {
    let attachment = rmw::attachment(number, io::clock::now().as_nanos(), &gid);
    let reply = query.reply(query.key_expr().clone(), bytes);
    reply.attachment(attachment).wait()
}
