//! A CAN bus by looking on: requests and answers of the node, its process data, its emergencies.
//!
//! What the process data carries is learnt from the traffic itself: from the writes and reads of the mapping that were
//! acknowledged. As long as any of it is unknown the data says nothing. Whose frame it is is told by its identifier, not by
//! the direction, as other masters may be on the bus.

use std::collections::BTreeMap;

use protocol::canopen::nmt::NmtState;
use protocol::canopen::pdo::{CommunicationId, Layout, MAX_ENTRIES, Mapping, TransmissionType};
use protocol::canopen::{CanFrame, CanId, Channel, Message, NodeId};
use protocol::epos2::DeviceError;
use units::{Host, Stamp};

use crate::beat::Beats;
use crate::bus::{STREAM, is_stream};
use crate::codec::{Reply, sdo_asked, sdo_decode};
use crate::event::Taken;
use crate::objects::{Address, TIMESTAMP};
use crate::pairing::{Access, Asked};

use super::{Given, Observation};

/// Looks on at the bus of one node.
#[derive(Clone, Debug)]
pub(super) struct BusWatch {
    node: u8,
    beats: Beats,
    /// What the stream's objects were seen to hold.
    known: BTreeMap<Address, u32>,
}

/// What a frame is.
pub(super) enum Said {
    Nothing,
    Noise,
    Request(Address, Access),
    Answer(Reply),
}

impl BusWatch {
    pub fn new(node: u8) -> Self {
        Self {
            node,
            beats: Beats::default(),
            known: BTreeMap::new(),
        }
    }

    /// Takes a `struct can_frame`.
    pub fn hear(
        &mut self,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) -> Said {
        self.beats.watch(host);
        let Some((frame, message)) = CanFrame::from_socketcan(bytes)
            .ok()
            .and_then(|frame| Some((frame, Message::parse(&frame).ok()?)))
        else {
            return Said::Noise;
        };
        let ours = |node: NodeId| node.get() == self.node;
        match message {
            Message::Sync(_) => self.beats.sent(host),
            Message::SdoRequest(node, request) if ours(node) => {
                if let Some((address, access)) = sdo_asked(&request) {
                    return Said::Request(address, access);
                }
            }
            Message::SdoAnswer(node, answer) if ours(node) => {
                return sdo_decode(&answer).map_or(Said::Noise, Said::Answer);
            }
            Message::Emergency(emergency) if ours(emergency.node) => {
                let error = DeviceError(emergency.code);
                emit(Observation::Emergency { error, host });
            }
            Message::Heartbeat(beat) if ours(beat.node) && beat.state == NmtState::BootUp => {
                self.known.clear();
                self.beats.forget();
                emit(Observation::Restarted { host });
            }
            Message::TransmitPdo(number, node, data)
                if ours(node) && is_stream(Channel::TransmitPdo(number, node), node) =>
            {
                return self.stream(&frame, &data, host, emit);
            }
            _ => {}
        }
        Said::Nothing
    }

    /// Takes an answer with the request it belongs to.
    pub fn learn(&mut self, asked: &Asked, reply: &Reply) {
        let index = asked.address.index;
        if (index != STREAM.communication() && index != STREAM.mapping()) || !reply.error.is_none()
        {
            return;
        }
        match (asked.access, reply.value) {
            (Access::Write(value), _) | (Access::Open, Some(value)) => {
                let is_id = asked.address == Address::new(STREAM.communication(), 1);
                if is_id && !CommunicationId::from_u32(value).valid {
                    // The stream is switched off to be configured: the client begins with a lone beat, too.
                    self.beats.forget();
                }
                self.known.insert(asked.address, value);
            }
            _ => {}
        }
    }

    fn stream(
        &mut self,
        frame: &CanFrame,
        data: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) -> Said {
        let Some(layout) = self.layout(frame) else {
            return Said::Nothing;
        };
        let Ok(Some(device_us)) = layout.get(TIMESTAMP, data) else {
            return Said::Nothing;
        };
        let (Some(beat), Ok(values)) = (self.beats.answered(device_us, host), layout.unpack(data))
        else {
            return Said::Noise;
        };
        let given = Given {
            request: beat,
            answer: host,
            taken: Taken::AtSync,
            device_us: Some(device_us),
        };
        // The drive's time first: whoever takes the sample has it then.
        let entries = || layout.entries().iter().zip(values.iter());
        let is_time = |entry: &Mapping| entry.address == TIMESTAMP.address;
        let ordered = entries()
            .filter(|(entry, _)| is_time(entry))
            .chain(entries().filter(|(entry, _)| !is_time(entry)));
        for (entry, content) in ordered.filter(|(entry, _)| entry.bits <= 32) {
            emit(given.value(entry.address, *content as u32));
        }
        Said::Nothing
    }

    /// The mapping, if all of it is known and the frame is sent by it at each SYNC.
    fn layout(&self, frame: &CanFrame) -> Option<Layout> {
        let known = |index, sub| self.known.get(&Address::new(index, sub)).copied();
        let id = CommunicationId::from_u32(known(STREAM.communication(), 1)?);
        let kind = TransmissionType::from_u8(known(STREAM.communication(), 2)? as u8);
        let count = known(STREAM.mapping(), 0)? as u8;
        let sent = id.valid && id.id == CanId::Standard(frame.cob_id()?);
        if !sent || kind != TransmissionType::EACH_SYNC || usize::from(count) > MAX_ENTRIES {
            return None;
        }
        let entries: Option<Vec<Mapping>> = (1..=count)
            .map(|sub| known(STREAM.mapping(), sub).map(Mapping::from_u32))
            .collect();
        Layout::new(&entries?).ok()
    }
}
