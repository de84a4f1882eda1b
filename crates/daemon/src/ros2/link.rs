//! The session with the router, and what is offered there: a node, its publishers and its services.
//!
//! Every message is sent so that it waits for the network (`CongestionControl::Block`, at most zenoh's 5 s, after which the connection is begun
//! anew), by threads that have nothing else to do. Clouds of sweeps give way to live ones, and those to all that is small.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use cloud::messages::Topic;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::{Session, Wait};

use super::latched::Latched;
use super::rmw::{self, Entity, Gid, Quality};
use super::{calls, calls::Service};
use crate::hub::inside::{SweepRequest, Wants};
use crate::shared::Shared;
use engine::config::ros2::Ros2;

/// How long a router is waited for before the daemon looks whether it ends.
const CONNECT_MS: u32 = 2_000;
/// Between two tries meanwhile, and while a lost router is waited for.
const RETRY_MS: (u32, u32) = (250, 2_000);

/// What zenoh says when something cannot be.
pub type Error = zenoh::Error;

/// Number of a request, and who sent it.
pub type Request = (i64, Gid);

/// What each topic offers: as ROS 2's own drivers, broadcasters and updaters do.
const fn quality(topic: Topic) -> Quality {
    let (reliable, latched, depth) = match topic {
        Topic::Points | Topic::JointStates | Topic::Diagnostics => (true, false, 10),
        Topic::LivePoints => (false, false, 5),
        Topic::Transforms => (true, false, 100),
        Topic::StaticTransforms => (true, true, 1),
    };
    Quality {
        reliable,
        latched,
        depth,
    }
}

const fn priority(topic: Topic) -> Priority {
    match topic {
        Topic::Points => Priority::DataLow,
        Topic::LivePoints => Priority::Data,
        _ => Priority::DataHigh,
    }
}

/// The topic's full name: what belongs to the whole robot by convention is in no namespace.
fn name(settings: &Ros2, topic: Topic) -> String {
    match topic {
        Topic::Transforms | Topic::StaticTransforms | Topic::Diagnostics => topic.name().to_owned(),
        _ => settings.namespace.resolve(topic.name()),
    }
}

/// A session.
pub struct Link {
    shared: Arc<Shared>,
    session: Session,
    channels: BTreeMap<Topic, Channel>,
    /// Held for what it offers.
    _offers: Vec<LivelinessToken>,
}

/// A publisher.
struct Channel {
    publisher: Publisher<'static>,
    gid: Gid,
    /// Number of its last message.
    number: Mutex<i64>,
    latched: Option<Latched>,
}

impl Link {
    /// Connects and declares everything; calls of services go to `calls`.
    pub fn open(
        shared: &Arc<Shared>,
        settings: &Ros2,
        inbox: &calls::Inbox,
    ) -> Result<Self, Error> {
        let config = serde_json::json!({
            "mode": "client",
            "connect": {
                "endpoints": [settings.router.endpoint()],
                "timeout_ms": CONNECT_MS,
                "retry": {
                    "period_init_ms": RETRY_MS.0,
                    "period_max_ms": RETRY_MS.1,
                    "period_increase_factor": 2,
                },
            },
            "scouting": { "multicast": { "enabled": false }, "gossip": { "enabled": false } },
            // What is kept for later subscribers is told apart by its time.
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
            shared: Arc::clone(shared),
            session,
            channels,
            _offers: offers,
        })
    }

    /// Whether a router is connected; it is remembered for others.
    pub fn look(&self) -> bool {
        let info = self.session.info();
        // The other side may be a peer as well.
        let connected =
            info.routers_zid().wait().next().is_some() || info.peers_zid().wait().next().is_some();
        let counts = &self.shared.ros2;
        counts.connected.store(connected, Ordering::Relaxed);
        connected
    }

    /// Whether anybody subscribes to it.
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

    /// Has `wish` want points while anybody subscribes to them.
    pub fn follow(&self, wish: &SweepRequest) -> Result<(), Error> {
        let Some(channel) = self.channels.get(&Topic::LivePoints) else {
            return Ok(());
        };
        let change = {
            let wish = wish.clone();
            move |watched| {
                wish.set(match watched {
                    true => Wants::Points,
                    false => Wants::Events,
                });
            }
        };
        let first = channel.publisher.matching_status().wait()?;
        change(first.matching());
        let listener = channel.publisher.matching_listener();
        let listener = listener.callback(move |status| change(status.matching()));
        listener.background().wait()
    }

    /// Sends a message, where anybody subscribes to it; whether it was sent.
    pub fn send(&self, topic: Topic, bytes: &[u8]) -> Result<bool, Error> {
        if !self.is_watched(topic) {
            return Ok(false);
        }
        let Some(channel) = self.channels.get(&topic) else {
            return Ok(false);
        };
        channel.send(&self.session, bytes)?;
        let counts = &self.shared.ros2;
        counts.messages.fetch_add(1, Ordering::Relaxed);
        match topic {
            Topic::Points => counts.clouds.fetch_add(1, Ordering::Relaxed),
            Topic::LivePoints => counts.frames.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
        Ok(true)
    }

    /// Takes everything back.
    pub fn close(self) {
        let connected = &self.shared.ros2.connected;
        connected.store(false, Ordering::Relaxed);
        // Whoever is on the other side finds out otherwise, too.
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
            true => Some(Latched::declare(session, zid, &key)?),
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

/// Who asks; `None`, after that was said, where it is no client of `rmw_zenoh`.
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
