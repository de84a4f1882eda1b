//! Node ids, 11-bit identifiers, and their default assignment to services (CiA 301, "Predefined
//! connection set").
//!
//! Objects of a node can assign other identifiers (1005, 1014, 140x, 180x); the caller compares
//! identifiers then.

use core::fmt;

/// A node id, 1 to 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u8);

impl NodeId {
    /// The highest node id.
    pub const MAX: Self = Self(127);

    /// The node `id`; `None` outside 1 to 127 (0 means "all nodes" where it is allowed).
    #[must_use]
    pub const fn new(id: u8) -> Option<Self> {
        match id {
            1..=127 => Some(Self(id)),
            _ => None,
        }
    }

    /// The number.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// An 11-bit CAN identifier, as CANopen uses them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CobId(u16);

impl CobId {
    /// NMT commands.
    pub const NMT: Self = Self(0x000);
    /// Synchronisation.
    pub const SYNC: Self = Self(0x080);
    /// Time stamp.
    pub const TIME: Self = Self(0x100);
    /// The highest identifier.
    pub const MAX: Self = Self(0x7FF);

    /// The identifier `id`; `None` above 11 bits.
    #[must_use]
    pub const fn new(id: u16) -> Option<Self> {
        if id <= Self::MAX.0 {
            Some(Self(id))
        } else {
            None
        }
    }

    /// The low 11 bits of `word`.
    pub(super) const fn masked(word: u32) -> Self {
        Self((word & Self::MAX.0 as u32) as u16)
    }

    /// The number.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }
}

impl fmt::Display for CobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:03X}", self.0)
    }
}

/// Number of a PDO in its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PdoNumber {
    /// PDO 1.
    One,
    /// PDO 2.
    Two,
    /// PDO 3.
    Three,
    /// PDO 4.
    Four,
}

impl PdoNumber {
    /// All four.
    pub const ALL: [Self; 4] = [Self::One, Self::Two, Self::Three, Self::Four];

    /// 0 to 3: offset of its objects from those of PDO 1.
    #[must_use]
    pub const fn offset(self) -> u16 {
        self as u16
    }
}

/// The communication object (CiA 301) of an identifier; directions are those of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CommunicationObject {
    /// 000: commands to nodes.
    Nmt,
    /// 080: synchronisation.
    Sync,
    /// 080 + node: errors of a node.
    Emergency(NodeId),
    /// 100: time stamp.
    Time,
    /// 180, 280, 380, 480 + node: process data from a node.
    TransmitPdo(PdoNumber, NodeId),
    /// 200, 300, 400, 500 + node: process data to a node.
    ReceivePdo(PdoNumber, NodeId),
    /// 580 + node: answers of a node's SDO server.
    SdoResponse(NodeId),
    /// 600 + node: requests to a node's SDO server.
    SdoRequest(NodeId),
    /// 700 + node: boot-up and heartbeat of a node.
    Heartbeat(NodeId),
    /// Not in the predefined connection set.
    Other(CobId),
}

impl CommunicationObject {
    /// The communication object of an identifier.
    #[must_use]
    pub const fn of(id: CobId) -> Self {
        match id {
            CobId::NMT => return Self::Nmt,
            CobId::SYNC => return Self::Sync,
            CobId::TIME => return Self::Time,
            _ => {}
        }
        let Some(node) = NodeId::new((id.0 & 0x7F) as u8) else {
            return Self::Other(id);
        };
        match id.0 & !0x7F {
            0x080 => Self::Emergency(node),
            0x180 => Self::TransmitPdo(PdoNumber::One, node),
            0x200 => Self::ReceivePdo(PdoNumber::One, node),
            0x280 => Self::TransmitPdo(PdoNumber::Two, node),
            0x300 => Self::ReceivePdo(PdoNumber::Two, node),
            0x380 => Self::TransmitPdo(PdoNumber::Three, node),
            0x400 => Self::ReceivePdo(PdoNumber::Three, node),
            0x480 => Self::TransmitPdo(PdoNumber::Four, node),
            0x500 => Self::ReceivePdo(PdoNumber::Four, node),
            0x580 => Self::SdoResponse(node),
            0x600 => Self::SdoRequest(node),
            0x700 => Self::Heartbeat(node),
            _ => Self::Other(id),
        }
    }

    /// The identifier of the communication object.
    #[must_use]
    pub const fn cob_id(self) -> CobId {
        let (base, node) = match self {
            Self::Nmt => return CobId::NMT,
            Self::Sync => return CobId::SYNC,
            Self::Time => return CobId::TIME,
            Self::Other(id) => return id,
            Self::Emergency(node) => (0x080, node),
            Self::TransmitPdo(number, node) => (0x180 + 0x100 * number.offset(), node),
            Self::ReceivePdo(number, node) => (0x200 + 0x100 * number.offset(), node),
            Self::SdoResponse(node) => (0x580, node),
            Self::SdoRequest(node) => (0x600, node),
            Self::Heartbeat(node) => (0x700, node),
        };
        CobId(base + node.0 as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_and_channels_round_trip() {
        for id in 0..=0x7FF {
            let id = CobId::new(id).unwrap();
            assert_eq!(CommunicationObject::of(id).cob_id(), id);
        }
        assert_eq!(CobId::new(0x800), None);
    }

    #[test]
    fn only_1_to_127_are_valid_nodes() {
        let nodes = (0..=255).filter_map(NodeId::new).map(NodeId::get);
        assert!(nodes.eq(1..=127));
    }

    #[test]
    fn the_predefined_connection_set_of_node_1_matches_cia_301() {
        let node = NodeId::new(1).unwrap();
        let expected = [
            (0x000, CommunicationObject::Nmt),
            (0x080, CommunicationObject::Sync),
            (0x081, CommunicationObject::Emergency(node)),
            (0x100, CommunicationObject::Time),
            (
                0x181,
                CommunicationObject::TransmitPdo(PdoNumber::One, node),
            ),
            (0x201, CommunicationObject::ReceivePdo(PdoNumber::One, node)),
            (
                0x281,
                CommunicationObject::TransmitPdo(PdoNumber::Two, node),
            ),
            (0x301, CommunicationObject::ReceivePdo(PdoNumber::Two, node)),
            (
                0x381,
                CommunicationObject::TransmitPdo(PdoNumber::Three, node),
            ),
            (
                0x401,
                CommunicationObject::ReceivePdo(PdoNumber::Three, node),
            ),
            (
                0x481,
                CommunicationObject::TransmitPdo(PdoNumber::Four, node),
            ),
            (
                0x501,
                CommunicationObject::ReceivePdo(PdoNumber::Four, node),
            ),
            (0x581, CommunicationObject::SdoResponse(node)),
            (0x601, CommunicationObject::SdoRequest(node)),
            (0x701, CommunicationObject::Heartbeat(node)),
        ];
        for (id, channel) in expected {
            assert_eq!(CommunicationObject::of(CobId::new(id).unwrap()), channel);
            assert_eq!(channel.cob_id().get(), id);
        }
    }
}
