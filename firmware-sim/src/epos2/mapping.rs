//! Configuration of process data: checks of writes to 140x, 160x, 180x and 1A0x (CiA 301, "PDO
//! mapping procedure").
//!
//! A PDO must be disabled (bit 31 of its identifier) while its mapping changes, and the count of
//! the mapping must be 0 while its entries change; the count then activates them. The strictness of
//! a real drive is not documented.

use protocol::canopen::CanId;
use protocol::canopen::pdo::{CommunicationId, LayoutError, MAX_ENTRIES, MappedObject, PdoLayout};
use protocol::epos2::BoundedVec;
use protocol::epos2::objects::Address;

use super::AbortCode;
use super::dictionary::Dictionary;

/// First indices; each object exists four times.
const RECEIVE: u16 = 0x1400;
const RECEIVE_MAPPING: u16 = 0x1600;
const TRANSMIT: u16 = 0x1800;
const TRANSMIT_MAPPING: u16 = 0x1A00;
/// From a PDO's parameters to its mapping.
const TO_MAPPING: u16 = RECEIVE_MAPPING - RECEIVE;

/// Whether an object configures a PDO.
pub(super) fn is_pdo(address: Address) -> bool {
    [RECEIVE, RECEIVE_MAPPING, TRANSMIT, TRANSMIT_MAPPING].contains(&(address.index & !3))
}

/// Identifier of the PDO with parameters at `index`.
pub(super) fn identifier(dictionary: &Dictionary, index: u16) -> CommunicationId {
    CommunicationId::from_u32(dictionary.raw(Address::new(index, 1)))
}

/// Layout of the PDO with parameters at `index`; empty if its entries are invalid.
pub(super) fn layout(dictionary: &Dictionary, index: u16) -> PdoLayout {
    let mapping = index + TO_MAPPING;
    let count = dictionary.raw(Address::new(mapping, 0)) as u8;
    PdoLayout::new(&entries(dictionary, mapping, count)).unwrap_or_default()
}

fn entries(
    dictionary: &Dictionary,
    mapping: u16,
    count: u8,
) -> BoundedVec<MappedObject, MAX_ENTRIES> {
    let mut entries = BoundedVec::new();
    let raw = (1..=count).map(|sub| dictionary.raw(Address::new(mapping, sub)));
    entries.extend(raw.map(MappedObject::from_u32));
    entries
}

/// Checks a write to one of these objects.
pub(super) fn check(dictionary: &Dictionary, address: Address, raw: u32) -> Result<(), AbortCode> {
    let Address { index, sub } = address;
    match (index & !3, sub) {
        (RECEIVE | TRANSMIT, 1) => check_identifier(identifier(dictionary, index), raw),
        // 241 to 251 are reserved.
        (RECEIVE | TRANSMIT, 2) if (241..=251).contains(&raw) => Err(AbortCode::RANGE),
        (RECEIVE | TRANSMIT, _) => Ok(()),
        _ if identifier(dictionary, index - TO_MAPPING).valid => Err(AbortCode::STATE),
        (_, 0) => {
            let entries = entries(dictionary, index, raw as u8);
            match PdoLayout::new(&entries) {
                Ok(_) => Ok(()),
                Err(LayoutError::Empty { .. }) => Err(AbortCode::PDO_MAPPING),
                Err(_) => Err(AbortCode::PDO_LENGTH),
            }
        }
        _ if dictionary.raw(Address::new(index, 0)) != 0 => Err(AbortCode::STATE),
        (direction, _) => check_entry(MappedObject::from_u32(raw), direction == TRANSMIT_MAPPING),
    }
}

/// The identifier of a PDO in use does not change, and identifiers that CiA 301 reserves for other
/// services are rejected.
fn check_identifier(old: CommunicationId, raw: u32) -> Result<(), AbortCode> {
    let new = CommunicationId::from_u32(raw);
    let is_free = match new.id {
        CanId::Standard(id) => {
            matches!(id.get(), 0x081..=0x0FF | 0x181..=0x580 | 0x680..=0x6DF)
        }
        CanId::Extended(_) => false,
    };
    let moves = old.valid && new.valid && old.id != new.id;
    if (is_free || !new.valid) && !moves && new.to_u32() == raw {
        Ok(())
    } else {
        Err(AbortCode::RANGE)
    }
}

/// Checks that an object may be mapped, in its whole length; 0 is no object.
fn check_entry(mapping: MappedObject, sent: bool) -> Result<(), AbortCode> {
    if mapping.to_u32() == 0 {
        return Ok(());
    }
    let entry = Dictionary::entry(mapping.address)?;
    let allowed = if sent {
        entry.is_sendable()
    } else {
        entry.is_receivable()
    };
    if allowed && usize::from(mapping.bits) == 8 * entry.ty.bytes() {
        Ok(())
    } else {
        Err(AbortCode::PDO_MAPPING)
    }
}
