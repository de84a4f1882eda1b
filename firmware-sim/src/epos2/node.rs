//! The unit as a whole: its parts, its clock, and its shaft.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{State, mode, status};
use protocol::epos2::message::NmtCommand;
use protocol::epos2::objects;

use super::config::NodeConfig;
use super::control::Sequence;
use super::dictionary::Dictionary;
use super::errors::Errors;
use super::fixed::{Fine, MAX_QC_PER_TURN, fine, floor_qc, q32};
use super::generator::Generator;
use super::homing::Homing;
use super::objects::is_powered;
use super::position_mode::PositionMode;

/// The shaft's way through one millisecond, a straight line; world positions in 2^-32 qc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// At the beginning of the millisecond.
    pub start: i64,
    /// At its end, which is the beginning of the next.
    pub end: i64,
}

/// A simulated EPOS2 with its axis.
///
/// Time passes in [`Node::tick`]; everything else happens at the present instant, which [`Node::set_phase_us`] refines.
#[derive(Clone, Debug)]
pub struct Node {
    pub(super) config: NodeConfig,
    pub(super) dictionary: Dictionary,
    /// What "save" keeps over power-off.
    pub(super) saved: Dictionary,
    pub(super) errors: Errors,
    pub(super) generator: Generator,
    pub(super) state: State,
    pub(super) controlword: u16,
    pub(super) sequence: Sequence,
    pub(super) brake_released: bool,
    /// Mode in effect (6061).
    pub(super) mode: i8,
    /// World qc of the place that the unit calls 0.
    pub(super) origin: i64,
    pub(super) referenced: bool,
    pub(super) position_mode: PositionMode,
    pub(super) homing: Homing,
    /// 2071:1 as of the last control cycle.
    pub(super) inputs: u16,
    operational: bool,
    segment: Segment,
    ticks: u64,
    phase_us: u32,
    timestamp_base_us: u32,
}

impl Node {
    /// A unit that has just finished booting: "switch-on disabled", or "fault" with the configured error.
    #[must_use]
    pub fn new(config: NodeConfig) -> Self {
        let saved = factory(&config);
        let position = fine(config.initial_position.into());
        Self::boot(config, saved, position)
    }

    fn boot(config: NodeConfig, saved: Dictionary, position: Fine) -> Self {
        let qc_per_turn = saved.get(objects::ENCODER_LINES).saturating_mul(4);
        let at = q32(position);
        let mut node = Self {
            generator: Generator::new(position, qc_per_turn),
            errors: Errors::default(),
            state: State::SwitchOnDisabled,
            controlword: 0,
            sequence: Sequence::Idle,
            brake_released: false,
            mode: saved.get(objects::MODE),
            origin: floor_qc(position),
            referenced: false,
            position_mode: PositionMode::default(),
            homing: Homing::default(),
            inputs: 0,
            // NMT pre-operational: nobody has started the node.
            operational: false,
            segment: Segment { start: at, end: at },
            ticks: 0,
            phase_us: 0,
            timestamp_base_us: 0,
            dictionary: saved.clone(),
            saved,
            config,
        };
        node.inputs = node.sense();
        let fault = node.config.fault_at_power_on;
        node.fail(fault);
        node
    }

    /// Power off and on: back to the saved parameters, the position is 0 again wherever the shaft is.
    pub fn power_cycle(&mut self) {
        let (config, saved) = (self.config.clone(), self.saved.clone());
        *self = Self::boot(config, saved, self.generator.position());
    }

    /// One control cycle: 1 ms. Settles what the shaft does in the coming millisecond.
    pub fn tick(&mut self) {
        self.ticks += 1;
        self.phase_us = 0;
        // Sequences first: each state they lead to, and each fault reaction, lasts a cycle at least.
        self.advance_sequence();
        self.watch_inputs();
        self.watch_software_limits();
        if self.state == State::OperationEnabled && self.sequence == Sequence::Idle {
            match self.mode {
                mode::HOMING => self.advance_homing(),
                _ => self.advance_position_mode(),
            }
        }
        let start = q32(self.generator.position());
        self.generator.step();
        let end = q32(self.generator.position());
        self.segment = Segment { start, end };
    }

    /// The shaft's way in the millisecond that the last [`Node::tick`] began.
    #[must_use]
    pub const fn segment(&self) -> Segment {
        self.segment
    }

    /// Says how far into the millisecond it is, 0..1000 us; more is taken for 1000.
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

    /// Node id as configured now (2000).
    #[must_use]
    pub fn node_id(&self) -> u8 {
        self.dictionary.get(objects::NODE_ID)
    }

    /// State of the CiA 402 machine.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Makes a device error happen, as a fault of the world around the unit would.
    pub fn inject(&mut self, error: DeviceError) {
        self.fail(error);
    }

    /// Network management: start, stop and pre-operational show in bit 9 of the statusword; a reset of the node is a power cycle.
    pub fn nmt(&mut self, command: NmtCommand) {
        match command {
            NmtCommand::Start => self.operational = true,
            NmtCommand::Stop | NmtCommand::EnterPreOperational | NmtCommand::ResetCommunication => {
                self.operational = false;
            }
            NmtCommand::ResetNode => self.power_cycle(),
            NmtCommand::Unknown(_) => {}
        }
    }

    /// 6041.
    pub(super) fn statusword(&self) -> u16 {
        let remote = if self.operational { status::REMOTE } else { 0 };
        let referenced = if self.referenced {
            status::REFERENCED
        } else {
            0
        };
        let of_mode = match self.mode {
            mode::HOMING => self.homing.status_bits(),
            _ => self.position_mode.status_bits(),
        };
        self.state.pattern() | remote | referenced | of_mode
    }

    /// 6064: the encoder's counter at this instant. The specification does not say whether a unit latches it once a control
    /// cycle; a counter in hardware is read when it is asked for.
    pub(super) fn position_actual(&self) -> i32 {
        (self.world_count() - self.origin) as i32
    }

    /// The encoder's count at this instant, world qc.
    fn world_count(&self) -> i64 {
        let Segment { start, end } = self.segment;
        let moved = (i128::from(end) - i128::from(start)) * i128::from(self.phase_us) / 1000;
        ((i128::from(start) + moved) >> 32) as i64
    }

    /// 2020: counts since power-on.
    pub(super) fn encoder_counter(&self) -> u32 {
        (self.world_count() - i64::from(self.config.initial_position)) as u32
    }

    /// 6062: where the demand will be at the end of this control cycle, and what relative moves count from.
    pub(super) fn position_demand(&self) -> i32 {
        (floor_qc(self.generator.position()) - self.origin) as i32
    }

    /// 1013.
    pub(super) fn timestamp_us(&self) -> u32 {
        (self.time_us() as u32).wrapping_add(self.timestamp_base_us)
    }

    pub(super) fn set_timestamp_us(&mut self, now_us: u32) {
        self.timestamp_base_us = now_us.wrapping_sub(self.time_us() as u32);
    }

    /// Back to factory values.
    pub(super) fn restore(&mut self) {
        self.dictionary = factory(&self.config);
        self.mode = self.dictionary.get(objects::MODE);
        let lines = self.dictionary.get(objects::ENCODER_LINES);
        self.generator.set_qc_per_turn(lines.saturating_mul(4));
    }

    pub(super) fn is_powered(&self) -> bool {
        is_powered(self.state)
    }
}

/// Factory values, with the encoder that the unit is built in with.
fn factory(config: &NodeConfig) -> Dictionary {
    let mut dictionary = Dictionary::factory(config.node_id);
    let qc_per_turn = config.qc_per_turn.clamp(4, MAX_QC_PER_TURN);
    dictionary.set(objects::ENCODER_LINES.address, qc_per_turn / 4);
    dictionary
}
