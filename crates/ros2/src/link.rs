//! The session with the router: a node, its publishers and its services.
//!
//! Messages wait for the network (`CongestionControl::Block`, at most zenoh's 5 s, after which the
//! connection is opened again) on threads that do nothing else. Clouds of sweeps have the lowest
//! priority, then live clouds and raw packets, then all small messages.

use std::collections::BTreeMap;
use std::io::Read;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use cloud::messages::{MessageType, Topic};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::{Session, Wait};

use engine::config::ros2::Ros2;

use crate::actions::{self, Action};
use crate::calls::{self, Service};
use crate::goal_request::LONGEST;
use crate::goals::Goals;
use crate::latched::LatchedMessages;
use crate::parameters;
use crate::rmw::{self, Entity, Gid, QualityOfService};
use crate::{Context, Counts, dds_bridge};

/// Wait for a router before the bridge looks whether it ends.
const CONNECT_MS: u32 = 2_000;
/// First and longest interval between connection attempts.
const RETRY_MS: (u32, u32) = (250, 2_000);

/// An error of zenoh.
pub type Error = zenoh::Error;

/// QoS of services (`rmw_qos_profile_services_default`).
pub const SERVICES: QualityOfService = QualityOfService {
    reliable: true,
    latched: false,
    depth: 10,
};

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
    /// Feedback and status of each action.
    actions: Vec<(Action, Channel, Channel)>,
    /// Declare the node, publishers and services until dropped.
    _offers: Vec<LivelinessToken>,
}

/// A publisher.
pub struct Channel {
    publisher: Publisher<'static>,
    gid: Gid,
    /// Number of its last message.
    number: Mutex<i64>,
    latched: Option<LatchedMessages>,
}

/// Declares a node, and its publishers and services with their numbers from 1.
pub struct Declarer<'a> {
    session: &'a Session,
    settings: &'a Ros2,
    zid: String,
    id: u32,
    offers: Vec<LivelinessToken>,
}

impl RouterLink {
    /// Connects and declares everything; calls go to `calls`, those of actions to `goals`, those
    /// of parameters to `parameters`.
    pub fn open(
        context: &Context,
        calls: &calls::Inbox,
        goals: &Arc<Goals<Call>>,
        parameters: &parameters::Inbox,
    ) -> Result<Self, Error> {
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
        let mut declarer = Declarer::new(&session, settings)?;
        let mut channels = BTreeMap::new();
        for topic in Topic::ALL {
            let (name, kind) = (name(settings, topic), topic.message_type());
            let quality = (quality(topic), priority(topic));
            channels.insert(topic, declarer.publisher(&name, &kind, quality)?);
        }
        for service in Service::offered(settings) {
            calls::declare(&mut declarer, service, context.devices(), calls)?;
        }
        parameters::declare(&mut declarer, parameters)?;
        let mut actions = Vec::new();
        for action in Action::offered(settings) {
            let (feedback, status) = actions::declare(&mut declarer, *action, goals)?;
            actions.push((*action, feedback, status));
        }
        let offers = declarer.offers;
        Ok(Self {
            counts: Arc::clone(&context.counts),
            session,
            channels,
            actions,
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
        self.channels.get(&topic).is_some_and(Channel::is_watched)
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
        let Some(channel) = self.channels.get(&topic) else {
            return Ok(false);
        };
        if !self.publish(channel, bytes)? {
            return Ok(false);
        }
        match topic {
            Topic::Points => self.counts.clouds.fetch_add(1, Ordering::Relaxed),
            Topic::LivePoints => self.counts.frames.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
        Ok(true)
    }

    /// Feedback and status of each action.
    pub fn actions(&self) -> &[(Action, Channel, Channel)] {
        &self.actions
    }

    /// Sends a message to a publisher with subscribers. Returns whether it was sent.
    pub fn publish(&self, channel: &Channel, bytes: &[u8]) -> Result<bool, Error> {
        if !channel.is_watched() {
            return Ok(false);
        }
        channel.send(&self.session, bytes)?;
        self.counts.messages.fetch_add(1, Ordering::Relaxed);
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

impl<'a> Declarer<'a> {
    fn new(session: &'a Session, settings: &'a Ros2) -> Result<Self, Error> {
        let zid = session.zid().to_string();
        let token = session.liveliness().declare_token(match settings.dds {
            true => dds_bridge::bridge_token(&zid),
            false => rmw::node_token(settings, &zid),
        });
        Ok(Self {
            session,
            settings,
            zid,
            id: 0,
            offers: vec![token.wait()?],
        })
    }

    /// The configuration.
    pub const fn settings(&self) -> &'a Ros2 {
        self.settings
    }

    /// Announces an entity and returns its gid, zeros if it has no token of its own.
    fn announce(
        &mut self,
        entity: Entity,
        named: (&str, &MessageType),
        quality: QualityOfService,
    ) -> Result<Gid, Error> {
        self.id += 1;
        let token = match self.settings.dds {
            true => dds_bridge::token(&self.zid, entity, named, quality),
            false => {
                let numbered = (self.id, entity);
                Some(rmw::token(
                    self.settings,
                    &self.zid,
                    numbered,
                    named,
                    quality,
                ))
            }
        };
        let Some(token) = token else {
            return Ok(Gid::default());
        };
        let gid = rmw::gid(&token);
        let token = self.session.liveliness().declare_token(token).wait()?;
        self.offers.push(token);
        Ok(gid)
    }

    fn key(&self, name: &str, kind: &MessageType) -> String {
        match self.settings.dds {
            true => dds_bridge::key(name),
            false => rmw::key(self.settings, name, kind),
        }
    }

    /// Declares a publisher of the topic with this full name.
    pub fn publisher(
        &mut self,
        name: &str,
        kind: &MessageType,
        (quality, priority): (QualityOfService, Priority),
    ) -> Result<Channel, Error> {
        let key = self.key(name, kind);
        let latched = match quality.latched {
            true => Some(LatchedMessages::declare(self.session, &self.zid, &key)?),
            false => None,
        };
        let publisher = self
            .session
            .declare_publisher(key)
            .congestion_control(CongestionControl::Block)
            .priority(priority)
            .wait()?;
        let gid = self.announce(Entity::Publisher, (name, kind), quality)?;
        Ok(Channel {
            publisher,
            gid,
            number: Mutex::new(0),
            latched,
        })
    }

    /// Declares a service with this full name. `take` gets its calls on a thread of zenoh, which
    /// must not wait.
    pub fn service(
        &mut self,
        name: &str,
        kind: &MessageType,
        quality: QualityOfService,
        take: impl Fn(Call) + Send + Sync + 'static,
    ) -> Result<(), Error> {
        self.session
            .declare_queryable(self.key(name, kind))
            .complete(true)
            .callback(move |query| {
                if let Some(call) = Call::new(query) {
                    take(call);
                }
            })
            .background()
            .wait()?;
        self.announce(Entity::Service, (name, kind), quality)?;
        Ok(())
    }
}

impl Channel {
    /// Whether it has subscribers, now or later.
    pub fn is_watched(&self) -> bool {
        let matching = || self.publisher.matching_status().wait();
        self.latched.is_some() || matching().is_ok_and(|status| status.matching())
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

/// A call of a service that waits for its answer.
pub struct Call {
    query: Query,
    request: (i64, Gid),
}

impl Call {
    /// A query with an attachment of `rmw_zenoh` or the bridge to DDS; others are refused.
    fn new(query: Query) -> Option<Self> {
        let attachment = query.attachment().map(|attachment| attachment.to_bytes());
        let request = attachment
            .and_then(|bytes| rmw::request_of(&bytes).or_else(|| dds_bridge::request_of(&bytes)));
        if let Some(request) = request {
            return Some(Self { query, request });
        }
        refuse(
            &query,
            "expected an attachment of rmw_zenoh (number, time, gid: 33 bytes) or zenoh-bridge-ros2dds (20 bytes)",
        );
        None
    }

    /// The request, encapsulation header included; its first bytes if it is longer than any that
    /// is served.
    pub fn payload(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Some(payload) = self.query.payload() {
            let most = LONGEST as u64 + 1;
            // Bytes in memory are always read.
            let _ = payload.reader().take(most).read_to_end(&mut bytes);
        }
        bytes
    }

    /// Refuses a call that no response of its type answers. A client's `rmw_zenoh` logs the text.
    pub fn refuse(&self, text: &str) {
        refuse(&self.query, text);
    }

    /// Answers the call with its own number and gid.
    pub fn answer(&self, bytes: &[u8]) {
        let (number, gid) = self.request;
        let attachment = rmw::attachment(number, io::clock::now().as_nanos(), &gid);
        let reply = self.query.reply(self.query.key_expr().clone(), bytes);
        if let Err(error) = reply.attachment(attachment).wait() {
            tracing::debug!("ROS 2: {error}");
        }
    }
}

fn refuse(query: &Query, text: &str) {
    if let Err(error) = query.reply_err(text).wait() {
        tracing::debug!("ROS 2: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A subscriber that asks for more than is offered gets nothing.
    #[test]
    fn the_view_of_rviz_subscribes_as_the_topics_are_published() {
        let view = include_str!("../../../packaging/ros/velomotion16.rviz");
        let fields = |key: &str| -> Vec<String> {
            let values = view
                .lines()
                .filter_map(|line| line.trim().strip_prefix(key));
            values.map(str::to_owned).collect()
        };
        let topics = fields("Value: /");
        let asked = fields("Reliability Policy: ").into_iter();
        let asked: Vec<_> = asked.zip(fields("Durability Policy: ")).collect();
        assert_eq!((topics.len(), asked.len()), (2, 2));
        for (topic, (reliability, durability)) in topics.iter().zip(asked) {
            let name = format!("/{topic}");
            let published = Topic::ALL.into_iter().find(|topic| topic.name() == name);
            let offered = quality(published.unwrap());
            assert!(offered.reliable || reliability == "Best Effort", "{name}");
            assert!(offered.latched || durability == "Volatile", "{name}");
        }
        let frames = fields("Fixed Frame: ");
        assert_eq!(frames, ["base_link"]);
    }
}
