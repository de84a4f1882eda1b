//! What reads and writes of single objects mean to the node: computed values, conditions, side effects.
//!
//! Objects that are not named here are plain storage.

use protocol::epos2::cia402::{State, mode};
use protocol::epos2::objects::{self, Address};

use super::Abort;
use super::dictionary::{Dictionary, Type};
use super::homing;
use super::node::Node;
use super::value::Value;

/// Restore of factory defaults (1011:4), as 1011:1.
const RESTORE_FACTORY: Address = Address::new(0x1011, 4);
/// Restore of the default PDO identifiers (1011:5).
const RESTORE_COB_IDS: Address = Address::new(0x1011, 5);
/// Encoder counter.
const ENCODER_COUNTER: Address = Address::new(0x2020, 0);
/// Velocity sensor.
const VELOCITY_SENSOR: Address = Address::new(0x6069, 0);

impl Node {
    /// Reads an object.
    ///
    /// # Errors
    /// [`Abort::NO_OBJECT`], [`Abort::NO_SUB`].
    pub fn read(&self, address: Address) -> Result<Value, Abort> {
        let entry = Dictionary::entry(address)?;
        if entry.ty == Type::Text {
            return Ok(Value::text("EPOS2"));
        }
        let raw = self
            .computed(address)
            .unwrap_or_else(|| self.dictionary.raw(address).into());
        Ok(Value::number(entry.ty, raw))
    }

    /// Objects whose value is not what was last written.
    fn computed(&self, address: Address) -> Option<u64> {
        const STATUSWORD: Address = objects::STATUSWORD.address;
        let raw = match address {
            STATUSWORD => self.statusword().into(),
            a if a.index == objects::ERROR_COUNT.address.index => self.errors.history(a.sub),
            a if a == objects::ERROR_REGISTER.address => self.errors.register().into(),
            a if a == objects::TIMESTAMP.address => self.timestamp_us(),
            a if a == objects::SERIAL_NUMBER.address => self.config.identity.serial_number as u32,
            a if a == objects::SERIAL_NUMBER_64 => return Some(self.config.identity.serial_number),
            a if a == objects::PRODUCT_CODE.address => self.config.identity.product_code,
            a if a == objects::REVISION.address => self.config.identity.revision,
            a if a == objects::SOFTWARE_VERSION.address => self.config.identity.revision >> 16,
            a if a == objects::HARDWARE_VERSION.address => self.config.identity.product_code >> 16,
            a if a == ENCODER_COUNTER => self.encoder_counter(),
            a if a == objects::POSITION_ACTUAL.address => self.position_actual() as u32,
            a if a == objects::POSITION_DEMAND.address => self.position_demand() as u32,
            a if a == objects::VELOCITY_AVERAGED.address
                || a == objects::VELOCITY_DEMAND.address
                || a == objects::VELOCITY_ACTUAL.address
                || a == VELOCITY_SENSOR =>
            {
                self.generator.speed().to_rpm() as u32
            }
            a if a == objects::INPUT_STATE.address => self.inputs.into(),
            a if a == objects::OUTPUT_STATE.address => self.output_state().into(),
            a if a == objects::MODE_DISPLAY.address => self.mode as u32,
            _ => return None,
        };
        Some(raw.into())
    }

    /// Writes an object; what is above its width is ignored.
    ///
    /// # Errors
    /// [`Abort`] with the code that the unit would answer; nothing is changed then.
    pub fn write(&mut self, address: Address, raw: u32) -> Result<(), Abort> {
        let entry = Dictionary::entry(address)?;
        entry.check_write(raw)?;
        let number = entry.ty.number(raw);
        self.check(address, number)?;
        self.dictionary.set(address, number as u32);
        self.written(address, number as u32);
        Ok(())
    }

    /// Conditions beyond type and limits.
    fn check(&self, address: Address, number: i64) -> Result<(), Abort> {
        const SIGNATURES: [Address; 4] = [
            objects::STORE_ALL.address,
            objects::RESTORE_ALL.address,
            RESTORE_FACTORY,
            RESTORE_COB_IDS,
        ];
        // "Changes only in disable state": the specification does not give the code; this one exists for nothing else.
        if self.is_powered() && needs_power_off(address) {
            return Err(Abort::STATE);
        }
        let i32_of = |object| i64::from(self.dictionary.get::<i32>(object));
        let allowed = match address {
            a if SIGNATURES.contains(&a) => {
                return self.check_signature(a, number);
            }
            a if a == objects::MIN_POSITION.address && number > i32_of(objects::MAX_POSITION)
                || a == objects::MAX_POSITION.address && number < i32_of(objects::MIN_POSITION) =>
            {
                return Err(Abort::MAX_BELOW_MIN);
            }
            a if a == objects::ERROR_COUNT.address => number == 0,
            a if a.index == 0x2070 || a.index == 0x2079 => (0..=15).contains(&number),
            a if a == objects::MODE.address => [mode::PROFILE_POSITION, mode::HOMING]
                .map(i64::from)
                .contains(&number),
            a if a == objects::HOMING_METHOD.address => homing::is_simulated(number),
            // The sinusoidal profile, 1, is not simulated.
            a if a == objects::PROFILE_TYPE.address => number == 0,
            _ => true,
        };
        if allowed { Ok(()) } else { Err(Abort::RANGE) }
    }

    fn check_signature(&self, address: Address, number: i64) -> Result<(), Abort> {
        let save = address == objects::STORE_ALL.address;
        let signature = if save { objects::SAVE } else { objects::LOAD };
        if number == i64::from(signature) {
            Ok(())
        } else {
            Err(Abort::STORE)
        }
    }

    /// What a write sets off.
    fn written(&mut self, address: Address, raw: u32) {
        match address {
            a if a == objects::CONTROLWORD.address => self.command(raw as u16),
            a if a == objects::MODE.address => self.set_mode(raw as i8),
            a if a == objects::ERROR_COUNT.address => self.errors.clear_history(),
            a if a == objects::TIMESTAMP.address => self.set_timestamp_us(raw),
            a if a == objects::ENCODER_LINES.address => {
                self.generator.set_qc_per_turn(raw.saturating_mul(4));
            }
            a if a == objects::STORE_ALL.address => {
                self.dictionary.set(a, 0);
                self.saved = self.dictionary.clone();
            }
            a if a == objects::RESTORE_ALL.address || a == RESTORE_FACTORY => self.restore(),
            // Nothing to restore: CAN is not simulated.
            a if a == RESTORE_COB_IDS => self.dictionary.set(a, 0),
            _ => {}
        }
    }
}

/// Configuration that a unit takes only while its power stage is off: 1011, 2008, 2210, 6402, 6410.
fn needs_power_off(address: Address) -> bool {
    [0x1011, 0x2008, 0x2210, 0x6402, 0x6410].contains(&address.index)
}

/// States with current in the motor.
pub(super) const fn is_powered(state: State) -> bool {
    matches!(
        state,
        State::Refresh
            | State::MeasureInit
            | State::OperationEnabled
            | State::QuickStopActive
            | State::FaultReactionEnabled
    )
}
