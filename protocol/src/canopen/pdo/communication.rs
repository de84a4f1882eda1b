//! Communication parameters of a PDO: its identifier (140x:1, 180x:1) and its transmission type
//! (140x:2, 180x:2).

use crate::canopen::cob_id::CobId;
use crate::canopen::frame::{CanId, ExtendedId};

/// Flags in the value of the identifier.
const INVALID: u32 = 1 << 31;
const NO_REMOTE: u32 = 1 << 30;
const EXTENDED: u32 = 1 << 29;

/// Identifier of a PDO with its flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommunicationId {
    /// The PDO is in use (bit 31 is clear).
    pub valid: bool,
    /// Remote frames may request it (bit 30 is clear).
    pub remote: bool,
    /// Its identifier (bit 29: 29 bits instead of 11).
    pub id: CanId,
}

impl CommunicationId {
    /// The value of the object.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        let invalid = if self.valid { 0 } else { INVALID };
        let no_remote = if self.remote { 0 } else { NO_REMOTE };
        let extended = match self.id {
            CanId::Standard(_) => 0,
            CanId::Extended(_) => EXTENDED,
        };
        invalid | no_remote | extended | self.id.raw()
    }

    /// The meaning of the value; without bit 29 only the low 11 bits of the identifier count.
    #[must_use]
    pub const fn from_u32(value: u32) -> Self {
        Self {
            valid: value & INVALID == 0,
            remote: value & NO_REMOTE == 0,
            id: if value & EXTENDED == 0 {
                CanId::Standard(CobId::masked(value))
            } else {
                CanId::Extended(ExtendedId::masked(value))
            },
        }
    }
}

/// The event that sends a PDO, or lets a received one take effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransmissionType {
    /// 0: at the next SYNC after an event.
    SyncOnEvent,
    /// 1 to 240: at every n-th SYNC. For a received PDO: at the next.
    EverySync(u8),
    /// 252: sampled at SYNC, sent on request.
    RemoteLatched,
    /// 253: sent on request.
    Remote,
    /// 254: at a manufacturer-specific event.
    Event,
    /// 255: at an event of the device profile (a change of a mapped value).
    ProfileEvent,
    /// 241 to 251.
    Reserved(u8),
}

impl TransmissionType {
    /// At every SYNC.
    pub const EACH_SYNC: Self = Self::EverySync(1);

    /// The value of the object, also for an `EverySync` out of range.
    #[must_use]
    pub const fn to_u8(self) -> u8 {
        match self {
            Self::SyncOnEvent => 0,
            Self::EverySync(value) | Self::Reserved(value) => value,
            Self::RemoteLatched => 252,
            Self::Remote => 253,
            Self::Event => 254,
            Self::ProfileEvent => 255,
        }
    }

    /// The meaning of the value.
    #[must_use]
    pub const fn from_u8(value: u8) -> Self {
        match value {
            0 => Self::SyncOnEvent,
            1..=240 => Self::EverySync(value),
            241..=251 => Self::Reserved(value),
            252 => Self::RemoteLatched,
            253 => Self::Remote,
            254 => Self::Event,
            255 => Self::ProfileEvent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canopen::{CommunicationObject, NodeId, PdoNumber};
    use proptest::prelude::*;

    /// Defaults of the device description for node 1: TPDO1 in use, TPDO2 to 4 not, no remote
    /// frames.
    #[test]
    fn defaults_match_a_real_unit() {
        let node = NodeId::new(1).unwrap();
        let values = [0x4000_0181, 0xC000_0281, 0xC000_0381, 0xC000_0481];
        for (value, number) in values.into_iter().zip(PdoNumber::ALL) {
            let id = CommunicationId {
                valid: number == PdoNumber::One,
                remote: false,
                id: CommunicationObject::TransmitPdo(number, node)
                    .cob_id()
                    .into(),
            };
            assert_eq!(id.to_u32(), value);
            assert_eq!(CommunicationId::from_u32(value), id);
        }
        assert_eq!(
            TransmissionType::from_u8(0xFF),
            TransmissionType::ProfileEvent
        );
        assert_eq!(TransmissionType::from_u8(1), TransmissionType::EACH_SYNC);
    }

    #[test]
    fn types_round_trip() {
        for value in 0..=255 {
            assert_eq!(TransmissionType::from_u8(value).to_u8(), value);
        }
    }

    proptest! {
        #[test]
        fn identifiers_round_trip(value in any::<u32>()) {
            let id = CommunicationId::from_u32(value);
            prop_assert_eq!(CommunicationId::from_u32(id.to_u32()), id);
            let ignored = if value & EXTENDED == 0 { 0x1FFF_F800 } else { 0 };
            prop_assert_eq!(id.to_u32(), value & !ignored);
        }
    }
}
