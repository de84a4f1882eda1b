//! Computed values of single objects, and side effects of writes.
//!
//! Objects that are not named here are plain storage.

use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::{self, Address};

use super::AbortCode;
use super::dictionary::Dictionary;
use super::entry::Type;
use super::node::SimulatedDrive;
use super::storage::{RESTORE_COB_IDS, RESTORE_FACTORY};
use super::value::ObjectValue;

/// Encoder counter.
const ENCODER_COUNTER: Address = Address::new(0x2020, 0);
/// Averaged current.
const CURRENT_AVERAGED: Address = Address::new(0x2027, 0);
/// Current demand.
const CURRENT_DEMAND: Address = Address::new(0x2031, 0);
/// Following error.
const FOLLOWING_ERROR: Address = Address::new(0x20F4, 0);
/// Velocity sensor.
const VELOCITY_SENSOR: Address = Address::new(0x6069, 0);
/// 1010:1 reads as "saves on command" (CiA 301).
const SAVES_ON_COMMAND: u32 = 1;
/// 6502: of the modes of a real drive (003F0065) those simulated: profile position, profile
/// velocity, homing; position and velocity mode (-1, -2) are the first two of bits 16 to 21.
const MODES: u32 = 1 << 0 | 1 << 2 | 1 << 5 | 1 << 16 | 1 << 17;

impl SimulatedDrive {
    /// Reads an object.
    ///
    /// # Errors [`AbortCode::NO_OBJECT`], [`AbortCode::NO_SUB`], [`AbortCode::WRITE_ONLY`];
    /// [`AbortCode::STATE`] for the data recorder's buffer, as nothing is ever recorded.
    pub fn read(&self, address: Address) -> Result<ObjectValue, AbortCode> {
        let entry = Dictionary::entry(address)?;
        entry.check_read()?;
        match entry.ty {
            Type::Text => Ok(ObjectValue::text("EPOS2")),
            Type::Domain => Err(AbortCode::STATE),
            ty => {
                let raw = self
                    .computed(address)
                    .unwrap_or_else(|| self.dictionary.raw(address).into());
                Ok(ObjectValue::number(ty, raw))
            }
        }
    }

    /// Objects whose value is not what was last written.
    fn computed(&self, address: Address) -> Option<u64> {
        const STATUSWORD: Address = objects::STATUSWORD.address;
        let raw = match address {
            STATUSWORD => self.statusword().into(),
            a if a.index == objects::ERROR_COUNT.address.index => self.errors.history(a.sub),
            a if a == objects::ERROR_REGISTER.address => self.errors.register().into(),
            a if a == objects::STORE_ALL.address => SAVES_ON_COMMAND,
            a if a == objects::TIMESTAMP.address => self.timestamp_us(),
            a if a == objects::SERIAL_NUMBER.address => self.config.identity.serial_number as u32,
            a if a == objects::SERIAL_NUMBER_64 => return Some(self.config.identity.serial_number),
            a if a == objects::PRODUCT_CODE.address => self.config.identity.product_code,
            a if a == objects::REVISION.address => self.config.identity.revision,
            a if a == objects::SOFTWARE_VERSION.address => self.config.identity.revision >> 16,
            a if a == objects::HARDWARE_VERSION.address => self.config.identity.product_code >> 16,
            a if a == objects::INPUT_STATE.address => self.inputs.into(),
            a if a == objects::OUTPUT_STATE.address => self.output_state().into(),
            a if a == objects::MODE_DISPLAY.address => self.mode as u32,
            a if a == objects::SUPPORTED_MODES.address => MODES,
            a => return self.motion_value(a),
        };
        Some(raw.into())
    }

    /// Objects that say where the shaft is and what the motor does.
    fn motion_value(&self, address: Address) -> Option<u64> {
        let raw = match address {
            ENCODER_COUNTER => self.encoder_counter(),
            a if a == objects::POSITION_ACTUAL.address => self.position_actual() as u32,
            a if a == objects::POSITION_DEMAND.address => self.position_demand() as u32,
            a if a == objects::VELOCITY_DEMAND.address => self.generator.speed.to_rpm() as u32,
            a if a == objects::VELOCITY_AVERAGED.address
                || a == objects::VELOCITY_ACTUAL.address
                || a == VELOCITY_SENSOR =>
            {
                self.velocity_actual_rpm() as u32
            }
            FOLLOWING_ERROR => i32::from(self.following_error_actual()) as u32,
            a if a == objects::CURRENT_ACTUAL.address
                || a == CURRENT_AVERAGED
                || a == CURRENT_DEMAND =>
            {
                i32::from(self.current_actual_ma()) as u32
            }
            _ => return None,
        };
        Some(raw.into())
    }

    /// Writes an object; what is above its width is ignored.
    ///
    /// # Errors
    /// [`AbortCode`] with the code that the drive would answer; nothing is changed then.
    pub fn write(&mut self, address: Address, raw: u32) -> Result<(), AbortCode> {
        let entry = Dictionary::entry(address)?;
        entry.check_access()?;
        self.check_storable(entry)?;
        entry.check_limits(raw)?;
        let number = entry.ty.number(raw);
        self.check(address, number)?;
        self.dictionary.set(address, number as u32);
        self.written(address, number as u32);
        Ok(())
    }

    /// Writes an object from bytes, low byte first.
    ///
    /// # Errors As [`SimulatedDrive::write`]; [`AbortCode::TOO_LONG`], [`AbortCode::TOO_SHORT`]
    /// unless they are as many as the object has.
    pub fn write_bytes(&mut self, address: Address, bytes: &[u8]) -> Result<(), AbortCode> {
        self.check_download(address, bytes.len())?;
        let mut raw = [0; 4];
        for (to, from) in raw.iter_mut().zip(bytes) {
            *to = *from;
        }
        self.write(address, u32::from_le_bytes(raw))
    }

    /// The side effect of a write.
    fn written(&mut self, address: Address, raw: u32) {
        match address {
            a if a == objects::CONTROLWORD.address => self.command(raw as u16),
            a if a == objects::MODE.address => self.set_mode(raw as i8),
            a if a == objects::ERROR_COUNT.address => self.errors.clear_history(),
            a if a == objects::TIMESTAMP.address => self.set_timestamp_us(raw),
            a if a == objects::ENCODER_LINES.address => {
                self.generator.qc_per_turn = raw.saturating_mul(4);
            }
            a if a == objects::STORE_ALL.address => {
                self.dictionary.set(a, 0);
                self.save();
            }
            a if a == objects::RESTORE_ALL.address || a == RESTORE_FACTORY => self.restore(),
            a if a == RESTORE_COB_IDS => {
                self.dictionary.set(a, 0);
                self.restore_cob_ids();
            }
            _ => {}
        }
    }
}

/// States with current in the motor.
pub(super) const fn is_powered(state: DeviceState) -> bool {
    matches!(
        state,
        DeviceState::Refresh
            | DeviceState::MeasureInit
            | DeviceState::OperationEnabled
            | DeviceState::QuickStopActive
            | DeviceState::FaultReactionEnabled
    )
}
