//! Process data to the node: RPDO 1 to 4 (1400 to 1403, 1600 to 1603), applied at once or at the
//! next SYNC.

use protocol::canopen::pdo::{MAX_ENTRIES, PdoLayout, TransmissionType};
use protocol::canopen::{CanFrame, PdoNumber};
use protocol::epos2::objects::Address;
use protocol::epos2::{BoundedVec, DeviceError};

use super::parameters;
use crate::epos2::mapping;
use crate::epos2::node::SimulatedDrive;

/// Index of the parameters of RPDO 1.
const FIRST: u16 = 0x1400;

/// The values of a PDO.
type Values = BoundedVec<u64, MAX_ENTRIES>;

/// State of one receive PDO.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReceivePdo {
    /// Applied at the next SYNC.
    pending: Option<Values>,
}

impl ReceivePdo {
    /// Takes any data frame of the bus. A frame shorter than the mapping is error 8210.
    pub fn on_frame(&mut self, node: &mut SimulatedDrive, number: PdoNumber, frame: &CanFrame) {
        let index = parameters(FIRST, number);
        let id = mapping::identifier(&node.dictionary, index);
        if !id.valid || id.id != frame.id() {
            return;
        }
        let layout = mapping::layout(&node.dictionary, index);
        let Ok(values) = layout.unpack(frame.data()) else {
            node.fail(DeviceError::PDO_LENGTH);
            return;
        };
        let kind = node.dictionary.raw(Address::new(index, 2)) as u8;
        match TransmissionType::from_u8(kind) {
            TransmissionType::EverySync(_) | TransmissionType::SyncOnEvent => {
                self.pending = Some(values);
            }
            _ => apply(node, &layout, &values),
        }
    }

    /// A SYNC.
    pub fn on_sync(&mut self, node: &mut SimulatedDrive, number: PdoNumber) {
        if let Some(values) = self.pending.take() {
            let layout = mapping::layout(&node.dictionary, parameters(FIRST, number));
            apply(node, &layout, &values);
        }
    }
}

/// Writes the values in the order of the mapping. A PDO cannot report a rejected value.
fn apply(node: &mut SimulatedDrive, layout: &PdoLayout, values: &[u64]) {
    for (entry, value) in layout.entries().iter().zip(values) {
        let bytes = value.to_le_bytes();
        let len = usize::from(entry.bits / 8);
        let _ = node.write_bytes(entry.address, bytes.get(..len).unwrap_or_default());
    }
}
