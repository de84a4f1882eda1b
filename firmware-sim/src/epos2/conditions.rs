//! Conditions of a write beyond type, access and limits.

use protocol::canopen::nmt::NmtState;
use protocol::epos2::cia402::mode;
use protocol::epos2::objects::{self, Address};

use super::AbortCode;
use super::dictionary::Dictionary;
use super::entry::{DictionaryEntry, Type};
use super::homing_method;
use super::mapping;
use super::node::SimulatedDrive;
use super::storage::{RESTORE_COB_IDS, check_signature};

/// Firmware download.
const DOWNLOAD: u16 = 0x2FFF;

/// Simulated modes; the other modes of a real drive are out of range.
const MODES: [i8; 5] = [
    mode::VELOCITY,
    mode::POSITION,
    mode::PROFILE_POSITION,
    mode::PROFILE_VELOCITY,
    mode::HOMING,
];

impl SimulatedDrive {
    /// Rejects entries that cannot store a value: a download needs the service mode, which the
    /// drive never enters; the buffers of interpolation and recorder need modes that are not
    /// simulated.
    pub(super) fn check_storable(&self, entry: &DictionaryEntry) -> Result<(), AbortCode> {
        if entry.address.index == DOWNLOAD {
            Err(AbortCode::SERVICE_MODE)
        } else if matches!(entry.ty, Type::U64 | Type::Text | Type::Domain) {
            Err(AbortCode::STATE)
        } else {
            Ok(())
        }
    }

    /// Conditions beyond type and limits.
    pub(super) fn check(&self, address: Address, number: i64) -> Result<(), AbortCode> {
        // "Changes only in disable state": the specification gives no code, and this one has no
        // other use.
        if self.is_powered() && needs_power_off(address) {
            return Err(AbortCode::STATE);
        }
        if mapping::is_pdo(address) || address == RESTORE_COB_IDS {
            self.check_pre_operational()?;
        }
        if mapping::is_pdo(address) {
            return mapping::check(&self.dictionary, address, number as u32);
        }
        if let Some(signed) = check_signature(address, number) {
            return signed;
        }
        let limit = |object| i64::from(self.dictionary.get::<i32>(object));
        let allowed = match address {
            a if a == objects::MIN_POSITION.address && number > limit(objects::MAX_POSITION)
                || a == objects::MAX_POSITION.address && number < limit(objects::MIN_POSITION) =>
            {
                return Err(AbortCode::MAX_BELOW_MIN);
            }
            a if a == objects::ERROR_COUNT.address => number == 0,
            a if a == objects::NODE_ID.address => (1..=127).contains(&number),
            a if a.index == 0x2070 || a.index == 0x2079 => (0..=15).contains(&number),
            a if a == objects::MODE.address => MODES.map(i64::from).contains(&number),
            a if a == objects::HOMING_METHOD.address => homing_method::exists(number),
            a if a == objects::PROFILE_TYPE.address => (0..=1).contains(&number),
            _ => true,
        };
        if allowed {
            Ok(())
        } else {
            Err(AbortCode::RANGE)
        }
    }

    fn check_pre_operational(&self) -> Result<(), AbortCode> {
        if self.nmt_state() == NmtState::PreOperational {
            Ok(())
        } else {
            Err(AbortCode::NMT_STATE)
        }
    }

    /// Whether a write of this length may begin; the value is checked when it is complete.
    pub(super) fn check_download(&self, address: Address, bytes: usize) -> Result<(), AbortCode> {
        let entry = Dictionary::entry(address)?;
        entry.check_access()?;
        entry.check_length(bytes)
    }
}

/// Configuration that can only change while the power stage is off.
fn needs_power_off(address: Address) -> bool {
    [0x1011, 0x2008, 0x2210, 0x6402, 0x6410].contains(&address.index)
}
