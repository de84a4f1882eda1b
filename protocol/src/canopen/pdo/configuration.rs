//! The writes that configure a PDO, in the order that nodes require (CiA 301, "PDO mapping
//! procedure").
//!
//! The caller keeps the node pre-operational meanwhile and starts it afterwards.

use super::communication::{CommunicationId, TransmissionType};
use super::layout::PdoLayout;
use crate::canopen::cob_id::{CommunicationObject, NodeId, PdoNumber};
use crate::canopen::object::{Address, Scalar};
use crate::canopen::sdo::Expedited;

/// One PDO of a node; directions are those of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pdo {
    /// The node sends it.
    Transmit(PdoNumber),
    /// The node receives it.
    Receive(PdoNumber),
}

impl Pdo {
    /// Index of its communication parameters.
    #[must_use]
    pub const fn communication(self) -> u16 {
        match self {
            Self::Receive(number) => 0x1400 + number.offset(),
            Self::Transmit(number) => 0x1800 + number.offset(),
        }
    }

    /// Index of its mapping.
    #[must_use]
    pub const fn mapping(self) -> u16 {
        match self {
            Self::Receive(number) => 0x1600 + number.offset(),
            Self::Transmit(number) => 0x1A00 + number.offset(),
        }
    }

    /// Its identifier in the predefined connection set.
    #[must_use]
    pub const fn channel(self, node: NodeId) -> CommunicationObject {
        match self {
            Self::Receive(number) => CommunicationObject::ReceivePdo(number, node),
            Self::Transmit(number) => CommunicationObject::TransmitPdo(number, node),
        }
    }
}

/// The configuration of a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration {
    /// Event at which it is sent or takes effect.
    pub transmission: TransmissionType,
    /// For a transmit PDO: the shortest interval in 100 us (180x:3). `None` leaves it unchanged. In
    /// CiA 301 it delays events only, not SYNC; 0 is safe for a fast SYNC.
    pub inhibit_100us: Option<u16>,
    /// The mapped objects.
    pub layout: PdoLayout,
}

/// One write to an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Write {
    /// The object.
    pub address: Address,
    /// Its value.
    pub data: Expedited,
}

/// The writes that configure `pdo` of `node` and enable it under its predefined identifier, without
/// remote frames: disable, type, inhibit time, mapping count 0, entries, count, enable.
pub fn configuration(
    pdo: Pdo,
    node: NodeId,
    configuration: &Configuration,
) -> impl Iterator<Item = Write> + '_ {
    let id = |valid| {
        let id = pdo.channel(node).cob_id().into();
        let remote = false;
        let value = CommunicationId { valid, remote, id };
        write(pdo.communication(), 1, value.to_u32())
    };
    let inhibit = configuration
        .inhibit_100us
        .filter(|_| matches!(pdo, Pdo::Transmit(_)))
        .map(|time| write(pdo.communication(), 3, time));
    let entries = configuration.layout.entries();
    let mapped = (1..)
        .zip(entries)
        .map(move |(sub, entry)| write(pdo.mapping(), sub, entry.to_u32()));
    // At most eight entries.
    let count = |count| write(pdo.mapping(), 0, count);
    [
        id(false),
        write(pdo.communication(), 2, configuration.transmission.to_u8()),
    ]
    .into_iter()
    .chain(inhibit)
    .chain([count(0)])
    .chain(mapped)
    .chain([count(entries.len() as u8), id(true)])
}

fn write<T: Scalar>(index: u16, sub: u8, value: T) -> Write {
    Write {
        address: Address::new(index, sub),
        data: Expedited::of(value),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::canopen::pdo::MappedObject;
    use crate::canopen::sdo::{Initiate, SdoRequest};
    use crate::canopen::tests::{POSITION_ACTUAL, TIMESTAMP};
    use std::vec::Vec;

    fn angle() -> Configuration {
        Configuration {
            transmission: TransmissionType::EACH_SYNC,
            inhibit_100us: Some(0),
            layout: PdoLayout::new(&[
                MappedObject::of(POSITION_ACTUAL),
                MappedObject::of(TIMESTAMP),
            ])
            .unwrap(),
        }
    }

    fn messages(pdo: Pdo, wanted: &Configuration) -> Vec<[u8; 8]> {
        configuration(pdo, NodeId::new(1).unwrap(), wanted)
            .map(|Write { address, data }| {
                let transfer = Initiate::Expedited(data);
                SdoRequest::InitiateDownload { address, transfer }.to_bytes()
            })
            .collect()
    }

    #[test]
    fn the_angle_stream_is_configured_in_the_required_order() {
        assert_eq!(
            messages(Pdo::Transmit(PdoNumber::One), &angle()),
            [
                [0x23, 0x00, 0x18, 1, 0x81, 0x01, 0x00, 0xC0], // out of use
                [0x2F, 0x00, 0x18, 2, 0x01, 0, 0, 0],          // at every SYNC
                [0x2B, 0x00, 0x18, 3, 0x00, 0, 0, 0],          // no inhibit time
                [0x2F, 0x00, 0x1A, 0, 0x00, 0, 0, 0],
                [0x23, 0x00, 0x1A, 1, 0x20, 0x00, 0x64, 0x60],
                [0x23, 0x00, 0x1A, 2, 0x20, 0x00, 0x13, 0x10],
                [0x2F, 0x00, 0x1A, 0, 0x02, 0, 0, 0],
                [0x23, 0x00, 0x18, 1, 0x81, 0x01, 0x00, 0x40], // 40000181: in use
            ]
        );
    }

    #[test]
    fn a_received_pdo_has_no_inhibit_time() {
        let messages = messages(Pdo::Receive(PdoNumber::Four), &angle());
        assert_eq!(messages.len(), 7);
        assert_eq!(messages[0], [0x23, 0x03, 0x14, 1, 0x01, 0x05, 0x00, 0xC0]);
        assert_eq!(messages[2], [0x2F, 0x03, 0x16, 0, 0, 0, 0, 0]);
    }
}
