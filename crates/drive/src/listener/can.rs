//! Passive decoder of a CAN bus: requests and responses of the node, its process data and
//! emergencies.
//!
//! The mapping of the process data is learnt from confirmed writes and reads of the mapping
//! objects. Until all of it is known, the data is not decoded. The identifier, not the direction of
//! the record, tells whose frame it is, as other masters may be on the bus.

use std::collections::BTreeMap;

use protocol::canopen::nmt::NmtState;
use protocol::canopen::pdo::{
    CommunicationId, MAX_ENTRIES, MappedObject, PdoLayout, TransmissionType,
};
use protocol::canopen::{BusMessage, CanFrame, CanId, CommunicationObject, NodeId};
use protocol::epos2::DeviceError;
use protocol::epos2::objects::{Address, TIMESTAMP};
use units::{Host, Stamp};

use crate::can_services::{STREAM, is_stream};
use crate::event::SampleTrigger;
use crate::exchange::{ObjectAccess, Reply, TransferRequest, TransferResponse};
use crate::request_matcher::SentRequest;
use crate::sync_matcher::SyncMatcher;

use super::{Observation, ValueOrigin};

/// Decodes the bus traffic of one node.
#[derive(Clone, Debug)]
pub(super) struct CanListener {
    node: u8,
    syncs: SyncMatcher,
    /// Known values of the stream's communication and mapping objects.
    known: BTreeMap<Address, u32>,
}

/// Result of a frame, other than the observations emitted at once.
pub(super) enum CanEvent {
    Noise,
    Request(Address, ObjectAccess),
    Response(Reply),
}

impl CanListener {
    pub fn new(node: u8) -> Self {
        Self {
            node,
            syncs: SyncMatcher::default(),
            known: BTreeMap::new(),
        }
    }

    /// Processes a `struct can_frame`.
    pub fn observe(
        &mut self,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) -> Option<CanEvent> {
        self.syncs.observe(host);
        let Some((frame, message)) = CanFrame::from_socketcan(bytes)
            .ok()
            .and_then(|frame| Some((frame, BusMessage::parse(&frame).ok()?)))
        else {
            return Some(CanEvent::Noise);
        };
        let is_own = |node: NodeId| node.get() == self.node;
        match message {
            BusMessage::Sync(_) => self.syncs.handle_sync(host),
            BusMessage::SdoRequest(node, request) if is_own(node) => {
                let request = TransferRequest::from_bytes(request.to_bytes());
                let address = request.address().unwrap_or_default();
                let access = ObjectAccess::of_sdo(request)?;
                return Some(CanEvent::Request(address, access));
            }
            BusMessage::SdoResponse(node, response) if is_own(node) => {
                return Some(match TransferResponse::from_bytes(response.to_bytes()) {
                    TransferResponse::Unknown(_) => CanEvent::Noise,
                    response => CanEvent::Response(Reply::Sdo(response)),
                });
            }
            BusMessage::Emergency(emergency) if is_own(emergency.node) => {
                let error = DeviceError(emergency.code);
                emit(Observation::Emergency { error, host });
            }
            BusMessage::Heartbeat(message)
                if is_own(message.node) && message.state == NmtState::BootUp =>
            {
                self.known.clear();
                self.syncs.restart();
                emit(Observation::Restarted { host });
            }
            BusMessage::TransmitPdo(number, node, data)
                if is_own(node)
                    && is_stream(CommunicationObject::TransmitPdo(number, node), node) =>
            {
                return self.handle_pdo(&frame, &data, host, emit);
            }
            _ => {}
        }
        None
    }

    /// Updates the known mapping from a reply.
    pub fn learn_mapping(&mut self, sent: &SentRequest, reply: &Reply) {
        let index = sent.address.index;
        if (index != STREAM.communication() && index != STREAM.mapping())
            || !reply.error().is_none()
        {
            return;
        }
        let value = match sent.access {
            ObjectAccess::Write { value, .. } => Some(value),
            ObjectAccess::Transfer(TransferRequest::InitiateUpload { .. }) => reply.value(),
            _ => None,
        };
        let Some(value) = value else {
            return;
        };
        let is_id = sent.address == Address::new(STREAM.communication(), 1);
        match sent.access {
            // The stream is disabled for configuration; the client also restarts with a single
            // SYNC.
            _ if is_id && !CommunicationId::from_u32(value).valid => self.syncs.restart(),
            ObjectAccess::Write { .. } if is_id => self.syncs.handle_enabled(),
            _ => {}
        }
        self.known.insert(sent.address, value);
    }

    fn handle_pdo(
        &mut self,
        frame: &CanFrame,
        data: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) -> Option<CanEvent> {
        let layout = self.layout(frame)?;
        let drive_us = layout.get(TIMESTAMP, data).ok()??;
        let (Some(sync), Ok(values)) = (self.syncs.handle_pdo(drive_us, host), layout.unpack(data))
        else {
            return Some(CanEvent::Noise);
        };
        let origin = ValueOrigin {
            request: sync,
            answer: host,
            trigger: SampleTrigger::Sync,
            drive_us: Some(drive_us),
        };
        // The drive's time goes first, so that it is known when the sample arrives.
        let entries = || layout.entries().iter().zip(values.iter());
        let is_time = |entry: &MappedObject| entry.address == TIMESTAMP.address;
        let ordered = entries()
            .filter(|(entry, _)| is_time(entry))
            .chain(entries().filter(|(entry, _)| !is_time(entry)));
        for (entry, content) in ordered.filter(|(entry, _)| entry.bits <= 32) {
            emit(origin.observation(entry.address, *content as u32));
        }
        None
    }

    /// The mapping, if it is completely known and the frame was sent by it at each SYNC.
    fn layout(&self, frame: &CanFrame) -> Option<PdoLayout> {
        let known = |index, sub| self.known.get(&Address::new(index, sub)).copied();
        let id = CommunicationId::from_u32(known(STREAM.communication(), 1)?);
        let kind = TransmissionType::from_u8(known(STREAM.communication(), 2)? as u8);
        let count = known(STREAM.mapping(), 0)? as u8;
        let is_sent = id.valid && id.id == CanId::Standard(frame.cob_id()?);
        if !is_sent || kind != TransmissionType::EACH_SYNC || usize::from(count) > MAX_ENTRIES {
            return None;
        }
        let entries: Option<Vec<MappedObject>> = (1..=count)
            .map(|sub| known(STREAM.mapping(), sub).map(MappedObject::from_u32))
            .collect();
        PdoLayout::new(&entries?).ok()
    }
}
