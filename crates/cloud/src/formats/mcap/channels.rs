//! The channels of a recording, one per topic, declared with the first message.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::records::MessageHeader;
use mcap::{McapResult, Writer};
use units::{Host, Stamp};

use super::bag;
use crate::messages::Topic;

/// Messages written per topic.
#[derive(Clone, Debug, Default)]
pub(super) struct McapChannels {
    by_topic: BTreeMap<Topic, McapChannel>,
    times: Option<(u64, u64)>,
}

#[derive(Clone, Copy, Debug)]
struct McapChannel {
    id: u16,
    messages: u32,
}

impl McapChannels {
    /// Writes a message complete at `at`, not before 1970.
    pub(super) fn write<W: Write + Seek>(
        &mut self,
        writer: &mut Writer<W>,
        topic: Topic,
        at: Stamp<Host>,
        bytes: &[u8],
    ) -> McapResult<()> {
        let mut channel = match self.by_topic.get(&topic) {
            Some(channel) => *channel,
            None => McapChannel {
                id: declare(writer, topic)?,
                messages: 0,
            },
        };
        let log_time = u64::try_from(at.as_nanos()).unwrap_or(0);
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.messages,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, bytes)?;
        channel.messages = channel.messages.saturating_add(1);
        self.by_topic.insert(topic, channel);
        let (first, last) = self.times.unwrap_or((log_time, log_time));
        self.times = Some((first.min(log_time), last.max(log_time)));
        Ok(())
    }

    /// Topics with messages, and their number.
    pub(super) fn counts(&self) -> impl Iterator<Item = (Topic, u32)> + '_ {
        self.by_topic
            .iter()
            .map(|(topic, channel)| (*topic, channel.messages))
    }

    /// Log times of the first and the last message, nanoseconds since 1970.
    pub(super) const fn times(&self) -> Option<(u64, u64)> {
        self.times
    }
}

fn declare<W: Write + Seek>(writer: &mut Writer<W>, topic: Topic) -> McapResult<u16> {
    let kind = topic.message_type();
    let schema = writer.add_schema(kind.name, "ros2msg", kind.definition.as_bytes())?;
    let quality = ("offered_qos_profiles".to_owned(), bag::quality(topic));
    writer.add_channel(schema, topic.name(), "cdr", &BTreeMap::from([quality]))
}
