//! Process data from the node: TPDO 1 to 4 (1800 to 1803, 1A00 to 1A03), by SYNC, by event or on
//! request.
//!
//! All values are read at the instant of the SYNC or event: position and time stamp (1013) in one
//! PDO belong together.

use protocol::canopen::pdo::{CommunicationId, MAX_ENTRIES, PdoLayout, TransmissionType};
use protocol::canopen::{CanFrame, CanId, CobId, PdoNumber};
use protocol::epos2::BoundedVec;
use protocol::epos2::objects::Address;

use super::parameters;
use crate::epos2::mapping;
use crate::epos2::node::SimulatedDrive;

/// Index of the parameters of TPDO 1.
const FIRST: u16 = 0x1800;

/// The data of a PDO.
type Data = BoundedVec<u8, 8>;

/// State of one transmit PDO.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TransmitPdo {
    /// SYNCs since the last transmission.
    syncs: u8,
    /// Data of the last transmission; `None` since the node became operational.
    sent: Option<Data>,
    sent_us: u64,
    /// Sampled at the last SYNC (type 252).
    latched: Option<Data>,
}

/// The configuration of a PDO in use.
struct ConfiguredPdo {
    id: CommunicationId,
    kind: TransmissionType,
    layout: PdoLayout,
    inhibit_us: u64,
}

impl ConfiguredPdo {
    fn of(node: &SimulatedDrive, number: PdoNumber) -> Option<Self> {
        let index = parameters(FIRST, number);
        let id = mapping::identifier(&node.dictionary, index);
        if !id.valid {
            return None;
        }
        let parameter = |sub| node.dictionary.raw(Address::new(index, sub));
        let layout = mapping::layout(&node.dictionary, index);
        (!layout.is_empty()).then(|| Self {
            id,
            kind: TransmissionType::from_u8(parameter(2) as u8),
            layout,
            inhibit_us: 100 * u64::from(parameter(3) as u16),
        })
    }

    /// The mapped values at this instant.
    fn sample(&self, node: &SimulatedDrive) -> Option<Data> {
        let mut values = BoundedVec::<u64, MAX_ENTRIES>::new();
        for entry in self.layout.entries() {
            let value = node.read(entry.address).ok()?;
            let bytes = value.bytes().iter().rev();
            values.extend([bytes.fold(0, |all, byte| all << 8 | u64::from(*byte))]);
        }
        self.layout.pack(&values).ok()
    }

    fn frame(&self, data: &Data) -> Option<CanFrame> {
        match self.id.id {
            CanId::Standard(id) => CanFrame::new(id, data).ok(),
            CanId::Extended(_) => None,
        }
    }
}

impl TransmitPdo {
    /// A SYNC.
    pub fn on_sync(
        &mut self,
        node: &SimulatedDrive,
        number: PdoNumber,
        out: &mut impl FnMut(&CanFrame),
    ) {
        let Some(configured) = ConfiguredPdo::of(node, number) else {
            return;
        };
        let Some(data) = configured.sample(node) else {
            return;
        };
        match configured.kind {
            TransmissionType::EverySync(every) => {
                self.syncs = self.syncs.saturating_add(1);
                if self.syncs >= every {
                    self.syncs = 0;
                    self.send(node, &configured, data, out);
                }
            }
            TransmissionType::SyncOnEvent if self.sent != Some(data) => {
                self.send(node, &configured, data, out);
            }
            TransmissionType::RemoteLatched => self.latched = Some(data),
            _ => {}
        }
    }

    /// Sends changed data, not before the inhibit time (180x:3) has elapsed.
    pub fn on_event(
        &mut self,
        node: &SimulatedDrive,
        number: PdoNumber,
        now_us: u64,
        out: &mut impl FnMut(&CanFrame),
    ) {
        let Some(configured) = ConfiguredPdo::of(node, number) else {
            return;
        };
        let by_event = matches!(
            configured.kind,
            TransmissionType::Event | TransmissionType::ProfileEvent
        );
        let inhibited = self.sent.is_some() && now_us < self.sent_us + configured.inhibit_us;
        if by_event
            && !inhibited
            && let Some(data) = configured.sample(node)
            && self.sent != Some(data)
        {
            self.send(node, &configured, data, out);
        }
    }

    /// A remote frame with identifier `requested`.
    pub fn on_request(
        &mut self,
        node: &SimulatedDrive,
        number: PdoNumber,
        requested: CobId,
        out: &mut impl FnMut(&CanFrame),
    ) {
        let Some(configured) = ConfiguredPdo::of(node, number) else {
            return;
        };
        if configured.id.id != CanId::Standard(requested) || !configured.id.remote {
            return;
        }
        let data = match configured.kind {
            TransmissionType::RemoteLatched => self.latched,
            _ => configured.sample(node),
        };
        if let Some(data) = data {
            self.send(node, &configured, data, out);
        }
    }

    fn send(
        &mut self,
        node: &SimulatedDrive,
        configured: &ConfiguredPdo,
        data: Data,
        out: &mut impl FnMut(&CanFrame),
    ) {
        self.sent = Some(data);
        self.sent_us = node.time_us();
        if let Some(frame) = configured.frame(&data) {
            out(&frame);
        }
    }
}
