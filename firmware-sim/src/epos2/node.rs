//! The whole drive: its parts, its clock, and its shaft.

use protocol::canopen::nmt::NmtState;
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, mode, status};
use protocol::epos2::objects;

use super::config::SimulatedDriveConfig;
use super::control::Sequence;
use super::dictionary::Dictionary;
use super::errors::Errors;
use super::fixed::{fine, floor_qc, q32};
use super::generator::Generator;
use super::homing::HomingState;
use super::load::BrakeArmature;
use super::network::NetworkState;
use super::objects::is_powered;
use super::position_mode::PositionMode;
use super::shaft::MotorShaft;
use super::storage::factory;
use super::velocity_mode::VelocityMode;

/// Linear motion of the shaft during one millisecond; world positions in 2^-32 qc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaftSegment {
    /// At the beginning of the millisecond.
    pub start: i64,
    /// At its end, the beginning of the next.
    pub end: i64,
}

/// A simulated EPOS2 with its axis.
///
/// [`SimulatedDrive::tick`] advances time; all other methods act at the present instant, which
/// [`SimulatedDrive::set_phase_us`] refines.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    pub(super) config: SimulatedDriveConfig,
    pub(super) dictionary: Dictionary,
    /// Parameters that survive power-off.
    pub(super) saved: Dictionary,
    pub(super) errors: Errors,
    /// The demand.
    pub(super) generator: Generator,
    /// The shaft, which follows the demand.
    pub(super) shaft: MotorShaft,
    pub(super) state: DeviceState,
    pub(super) controlword: u16,
    pub(super) sequence: Sequence,
    pub(super) brake_released: bool,
    pub(super) armature: BrakeArmature,
    /// Mode in effect (6061).
    pub(super) mode: i8,
    /// World qc of the drive's position 0.
    pub(super) origin: i64,
    pub(super) referenced: bool,
    /// Bit 13 in profile position mode: the last fault was a following error.
    pub(super) lost_demand: bool,
    pub(super) position_mode: PositionMode,
    pub(super) velocity_mode: VelocityMode,
    pub(super) homing: HomingState,
    /// 2071:1 as of the last control cycle.
    pub(super) inputs: u16,
    pub(super) network: NetworkState,
    /// The node id in use: that of 2000 at power-on.
    id: u8,
    segment: ShaftSegment,
    ticks: u64,
    phase_us: u32,
    timestamp_base_us: u32,
}

impl SimulatedDrive {
    /// A drive after booting: "switch-on disabled", or "fault" with the configured error.
    #[must_use]
    pub fn new(config: SimulatedDriveConfig) -> Self {
        let saved = factory(&config);
        let shaft = MotorShaft::new(
            fine(config.initial_position.into()),
            config.hard_stops,
            config.servo,
        );
        Self::boot(config, saved, shaft, NetworkState::started(1))
    }

    fn boot(
        config: SimulatedDriveConfig,
        saved: Dictionary,
        shaft: MotorShaft,
        network: NetworkState,
    ) -> Self {
        let qc_per_turn = saved.get(objects::ENCODER_LINES).saturating_mul(4);
        let at = q32(shaft.position);
        let mut node = Self {
            generator: Generator::new(shaft.position, qc_per_turn),
            errors: Errors::default(),
            state: DeviceState::SwitchOnDisabled,
            controlword: 0,
            sequence: Sequence::Idle,
            brake_released: false,
            armature: BrakeArmature::default(),
            mode: saved.get(objects::MODE),
            origin: floor_qc(shaft.position),
            referenced: false,
            lost_demand: false,
            position_mode: PositionMode::default(),
            velocity_mode: VelocityMode::default(),
            homing: HomingState::default(),
            inputs: 0,
            network,
            id: saved.get(objects::NODE_ID),
            segment: ShaftSegment { start: at, end: at },
            ticks: 0,
            phase_us: 0,
            timestamp_base_us: 0,
            dictionary: saved.clone(),
            saved,
            shaft,
            config,
        };
        node.inputs = node.sense();
        let fault = node.config.fault_at_power_on;
        node.fail(fault);
        node
    }

    /// Power off and on: the saved parameters apply, and the present position becomes 0.
    pub fn power_cycle(&mut self) {
        let (config, saved) = (self.config.clone(), self.saved.clone());
        let network = NetworkState::started(self.network.starts.wrapping_add(1));
        *self = Self::boot(config, saved, self.shaft.at_power_on(), network);
    }

    /// One control cycle: 1 ms. Determines the motion of the coming millisecond.
    pub fn tick(&mut self) {
        self.ticks += 1;
        self.phase_us = 0;
        // Sequences first: each of their states and each fault reaction lasts at least one cycle.
        self.advance_sequence();
        self.watch_inputs();
        self.watch_software_limits();
        self.watch_following();
        if self.state == DeviceState::OperationEnabled && self.sequence == Sequence::Idle {
            match self.mode {
                mode::HOMING => self.advance_homing(),
                mode::PROFILE_VELOCITY => self.advance_velocity_mode(),
                mode::POSITION => self.advance_position_setting(),
                mode::VELOCITY => self.advance_velocity_setting(),
                _ => self.advance_position_mode(),
            }
        }
        let start = q32(self.shaft.position);
        self.advance_brake();
        match self.config.load {
            Some(load) if !self.is_powered() => self.coast(load),
            _ => {
                self.generator.step();
                self.shaft
                    .follow(self.generator.position, self.generator.qc_per_turn);
                self.follow_shaft();
            }
        }
        let end = q32(self.shaft.position);
        self.segment = ShaftSegment { start, end };
    }

    /// Motion of the shaft in the millisecond that the last [`SimulatedDrive::tick`] began.
    #[must_use]
    pub const fn segment(&self) -> ShaftSegment {
        self.segment
    }

    /// Sets the time since the last tick, 0..1000 us; larger values count as 1000.
    pub fn set_phase_us(&mut self, phase_us: u32) {
        self.phase_us = phase_us.min(1000);
    }

    /// Microseconds since power-on.
    #[must_use]
    pub fn time_us(&self) -> u64 {
        self.ticks
            .wrapping_mul(1000)
            .wrapping_add(self.phase_us.into())
    }

    /// Node id in use. A new one (2000) must be saved and takes effect at the next power-on.
    #[must_use]
    pub const fn node_id(&self) -> u8 {
        self.id
    }

    /// State of the CiA 402 machine.
    #[must_use]
    pub const fn state(&self) -> DeviceState {
        self.state
    }

    /// Raises a device error, as a fault in the environment of the drive would.
    pub fn inject(&mut self, error: DeviceError) {
        self.fail(error);
    }

    /// Blocks the shaft in place until [`SimulatedDrive::unblock`], through power-off too.
    pub fn block(&mut self) {
        self.shaft.jammed = true;
    }

    /// Releases a blocked shaft.
    pub fn unblock(&mut self) {
        self.shaft.jammed = false;
    }

    /// Statusword (6041).
    pub(super) fn statusword(&self) -> u16 {
        let of_mode = match self.mode {
            mode::HOMING => self.homing.status_bits(),
            mode::PROFILE_VELOCITY => self.velocity_mode.status_bits(self.velocity_actual_rpm()),
            mode::VELOCITY => 0,
            _ => self.position_mode.status_bits() | bit(self.lost_demand, status::FOLLOWING_ERROR),
        };
        self.state.pattern()
            | bit(self.nmt_state() == NmtState::Operational, status::REMOTE)
            | bit(self.referenced, status::REFERENCED)
            | of_mode
    }

    /// 6064: the encoder count at this instant, or at the beginning of the control cycle. The
    /// specification does not say which.
    pub(super) fn position_actual(&self) -> i32 {
        let phase_us = match self.config.latches_position {
            true => 0,
            false => self.phase_us,
        };
        (self.count_at(phase_us) - self.origin) as i32
    }

    /// The encoder count at this instant, world qc.
    fn world_count(&self) -> i64 {
        self.count_at(self.phase_us)
    }

    /// The encoder count so many microseconds after the beginning of the control cycle, world qc.
    fn count_at(&self, phase_us: u32) -> i64 {
        let ShaftSegment { start, end } = self.segment;
        let moved = (i128::from(end) - i128::from(start)) * i128::from(phase_us) / 1000;
        ((i128::from(start) + moved) >> 32) as i64 + self.dither_qc()
    }

    /// 2020: counts since power-on.
    pub(super) fn encoder_counter(&self) -> u32 {
        (self.world_count() - i64::from(self.config.initial_position)) as u32
    }

    /// 6062: the demand at the end of this control cycle, and the base of relative moves.
    pub(super) fn position_demand(&self) -> i32 {
        (floor_qc(self.generator.position) - self.origin) as i32
    }

    /// Clock of the drive (1013).
    pub(super) fn timestamp_us(&self) -> u32 {
        (self.time_us() as u32).wrapping_add(self.timestamp_base_us)
    }

    pub(super) fn set_timestamp_us(&mut self, now_us: u32) {
        self.timestamp_base_us = now_us.wrapping_sub(self.time_us() as u32);
    }

    pub(super) fn is_powered(&self) -> bool {
        is_powered(self.state)
    }
}

/// These bits of a word if they are on.
pub(super) const fn bit(on: bool, bits: u16) -> u16 {
    if on { bits } else { 0 }
}
