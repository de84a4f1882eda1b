//! Layer setting services (CiA 305): a master finds nodes by their identity (1018) and sets their
//! node id. As on the EPOS4, whose guide describes them in detail, they answer in the NMT state
//! stopped only.
//!
//! The node id is object 2000, which takes effect at the next power-on if it is stored. A bit rate
//! is taken, and changes nothing.

use protocol::canopen::nmt::NmtState;
use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::objects::{self, Address};

use crate::epos2::node::SimulatedDrive;

/// From the master, and to it.
const REQUEST: u16 = 0x7E5;
const ANSWER: CobId = match CobId::new(0x7E4) {
    Some(id) => id,
    None => CobId::MAX,
};

/// Command specifiers.
mod command {
    pub const SWITCH_GLOBAL: u8 = 0x04;
    pub const CONFIGURE_NODE_ID: u8 = 0x11;
    pub const CONFIGURE_BIT_TIMING: u8 = 0x13;
    pub const STORE: u8 = 0x17;
    pub const SWITCH_SELECTIVE: u8 = 0x40;
    pub const SWITCHED: u8 = 0x44;
    pub const IDENTIFY: u8 = 0x46;
    pub const IDENTIFY_UNCONFIGURED: u8 = 0x4C;
    pub const IDENTIFIED: u8 = 0x4F;
    pub const INQUIRE: u8 = 0x5A;
    pub const INQUIRE_NODE_ID: u8 = 0x5E;
}

/// Indices of bit rates in table 0: 1000, 800, 500, 250, 125, 50 and 20 kbit/s.
const BIT_RATES: [u8; 7] = [0, 1, 2, 3, 4, 6, 7];

/// The services' state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LayerSetting {
    /// In the state "configuration", else "waiting".
    is_configuring: bool,
    /// Parts of an identity that matched, in their order: of a selection, and of a search.
    selected: u8,
    identified: u8,
}

impl LayerSetting {
    /// Executes a frame of the bus; returns the answer.
    pub fn execute(&mut self, node: &mut SimulatedDrive, frame: &CanFrame) -> Option<CanFrame> {
        let id = frame.cob_id()?.get();
        let data: [u8; 8] = frame.data().try_into().ok()?;
        if id != REQUEST || node.nmt_state() != NmtState::Stopped {
            return None;
        }
        let [specifier, first, second, ..] = data;
        let [_, low @ .., _, _, _] = data;
        let value = u32::from_le_bytes(low);
        let answer = |specifier, data: [u8; 5]| {
            let [a, b, c, d, e] = data;
            Some(CanFrame::of(ANSWER, [specifier, a, b, c, d, e, 0, 0]))
        };
        let error = |is_error: bool| answer(specifier, [u8::from(is_error), 0, 0, 0, 0]);
        match specifier {
            command::SWITCH_GLOBAL => {
                *self = Self::default();
                self.is_configuring = first == 1;
                None
            }
            command::SWITCH_SELECTIVE..command::SWITCHED if !self.is_configuring => {
                let part = specifier - command::SWITCH_SELECTIVE;
                let is_next = self.selected == part || part == 0;
                self.selected = match is_next && identity(node, part) == value {
                    true => part + 1,
                    false => 0,
                };
                self.is_configuring = self.selected == 4;
                if self.is_configuring {
                    self.selected = 0;
                }
                match self.is_configuring {
                    true => answer(command::SWITCHED, [0; 5]),
                    false => None,
                }
            }
            // Vendor, product, then the lowest and highest revision and serial number.
            command::IDENTIFY..command::IDENTIFY_UNCONFIGURED => {
                let step = specifier - command::IDENTIFY;
                let is_so = match step {
                    0 | 1 => identity(node, step) == value,
                    2 | 4 => identity(node, step / 2 + 1) >= value,
                    _ => identity(node, step / 2 + 1) <= value,
                };
                let is_next = self.identified == step || step == 0;
                self.identified = if is_next && is_so { step + 1 } else { 0 };
                match self.identified {
                    6 => answer(command::IDENTIFIED, [0; 5]),
                    _ => None,
                }
            }
            command::CONFIGURE_NODE_ID if self.is_configuring => {
                let is_valid = NodeId::new(first).is_some();
                if is_valid {
                    node.dictionary.set(objects::NODE_ID.address, first.into());
                }
                error(!is_valid)
            }
            command::CONFIGURE_BIT_TIMING if self.is_configuring => {
                error(first != 0 || !BIT_RATES.contains(&second))
            }
            command::STORE if self.is_configuring => {
                let id = node.dictionary.raw(objects::NODE_ID.address);
                node.saved.set(objects::NODE_ID.address, id);
                error(false)
            }
            command::INQUIRE..command::INQUIRE_NODE_ID if self.is_configuring => {
                let part = identity(node, specifier - command::INQUIRE);
                let [a, b, c, d] = part.to_le_bytes();
                answer(specifier, [a, b, c, d, 0])
            }
            command::INQUIRE_NODE_ID if self.is_configuring => {
                answer(specifier, [node.node_id(), 0, 0, 0, 0])
            }
            _ => None,
        }
    }
}

/// Vendor, product, revision and serial number (1018:1 to 4), counted from 0.
fn identity(node: &SimulatedDrive, part: u8) -> u32 {
    let read = node.read(Address::new(0x1018, part + 1));
    read.ok().and_then(|value| value.raw()).unwrap_or_default()
}
