//! With arbitrary actions on every interface the state machine makes only the transitions of the
//! specification.

extern crate std;
use std::vec;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::canopen::nmt::{Nmt, NmtCommand};
use protocol::canopen::sdo::{Expedited, Initiate, SdoRequest};
use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::DeviceState::{self, *};
use protocol::epos2::objects::{self, Address};

use super::super::table::TABLE;
use super::super::{CanServer, SimulatedDrive, SimulatedDriveConfig, UsbServer};
use super::{get, state};

/// Cause of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    Shutdown,
    SwitchOn,
    Enable,
    DisableVoltage,
    Quick,
    Reset,
    /// A motion, a brake delay or a fault reaction has ended.
    Time,
    Error,
    /// The quick-stop input.
    Input,
    PowerOn,
}
use Cause::*;

/// The legal transitions by the figure and tables of "Device Control" in the Firmware
/// Specification.
const LEGAL: [(DeviceState, Cause, DeviceState); 41] = [
    (SwitchOnDisabled, Shutdown, ReadyToSwitchOn),
    (ReadyToSwitchOn, SwitchOn, SwitchedOn),
    (ReadyToSwitchOn, Enable, MeasureInit),
    (ReadyToSwitchOn, DisableVoltage, SwitchOnDisabled),
    (ReadyToSwitchOn, Quick, SwitchOnDisabled),
    (SwitchedOn, Shutdown, ReadyToSwitchOn),
    (SwitchedOn, Enable, MeasureInit),
    (SwitchedOn, DisableVoltage, SwitchOnDisabled),
    (SwitchedOn, Quick, SwitchOnDisabled),
    (MeasureInit, Time, OperationEnabled),
    (MeasureInit, Shutdown, ReadyToSwitchOn),
    (MeasureInit, SwitchOn, SwitchedOn),
    (MeasureInit, DisableVoltage, SwitchOnDisabled),
    (MeasureInit, Quick, SwitchOnDisabled),
    (OperationEnabled, Time, ReadyToSwitchOn),
    (OperationEnabled, Time, SwitchedOn),
    (OperationEnabled, DisableVoltage, SwitchOnDisabled),
    (OperationEnabled, Quick, QuickStopActive),
    (OperationEnabled, Input, QuickStopActive),
    (QuickStopActive, Enable, OperationEnabled),
    (QuickStopActive, DisableVoltage, SwitchOnDisabled),
    (SwitchOnDisabled, Error, Fault),
    (ReadyToSwitchOn, Error, Fault),
    (SwitchedOn, Error, Fault),
    (MeasureInit, Error, FaultReactionEnabled),
    (MeasureInit, Error, FaultReactionDisabled),
    (OperationEnabled, Error, FaultReactionEnabled),
    (OperationEnabled, Error, FaultReactionDisabled),
    (QuickStopActive, Error, FaultReactionEnabled),
    (QuickStopActive, Error, FaultReactionDisabled),
    (FaultReactionEnabled, Time, Fault),
    (FaultReactionDisabled, Time, Fault),
    (Fault, Reset, SwitchOnDisabled),
    (Fault, PowerOn, SwitchOnDisabled),
    (ReadyToSwitchOn, PowerOn, SwitchOnDisabled),
    (SwitchedOn, PowerOn, SwitchOnDisabled),
    (OperationEnabled, PowerOn, SwitchOnDisabled),
    (MeasureInit, PowerOn, SwitchOnDisabled),
    (QuickStopActive, PowerOn, SwitchOnDisabled),
    (FaultReactionEnabled, PowerOn, SwitchOnDisabled),
    (FaultReactionDisabled, PowerOn, SwitchOnDisabled),
];

/// The command of a controlword: bits 7, 3, 2, 1, 0, masked as in the table "Device Control
/// Commands".
fn command_of(word: u32) -> Cause {
    const MASKS: [(u32, u32, Cause); 6] = [
        (0x80, 0x80, Reset),
        (0x87, 0x06, Shutdown),
        (0x8F, 0x07, SwitchOn),
        (0x8F, 0x0F, Enable),
        (0x82, 0x00, DisableVoltage),
        (0x86, 0x02, Quick),
    ];
    let found = MASKS.iter().find(|(mask, value, _)| word & mask == *value);
    found
        .map(|(.., by)| *by)
        .expect("the masks cover all words")
}

#[derive(Clone, Debug)]
enum Action {
    Write(Address, u32),
    Control(u16),
    /// The same by RPDO 1, whose default mapping is the controlword.
    ControlByPdo(u16),
    /// The same by SDO.
    ControlBySdo(u16),
    Network(NmtCommand),
    Frame(u16, Vec<u8>),
    Serial(Vec<u8>),
    Block(bool),
    Tick(u8),
    Phase(u32),
    Inject(u16),
}

impl Action {
    /// The transitions that it may cause.
    fn causes(&self) -> Vec<Cause> {
        let control = |word: u32| vec![command_of(word), Error];
        match self {
            Self::Write(address, raw) if *address == objects::CONTROLWORD.address => control(*raw),
            Self::Control(word) | Self::ControlByPdo(word) | Self::ControlBySdo(word) => {
                control(u32::from(*word))
            }
            Self::Network(NmtCommand::ResetNode) => vec![PowerOn],
            Self::Tick(_) => vec![Time, Error, Input],
            // The PDO may have any mapping, so it may be any command.
            Self::Frame(..) => vec![
                Shutdown,
                SwitchOn,
                Enable,
                DisableVoltage,
                Quick,
                Reset,
                Error,
                PowerOn,
            ],
            Self::Inject(_) => vec![Error],
            Self::Write(..)
            | Self::Network(_)
            | Self::Serial(_)
            | Self::Block(_)
            | Self::Phase(_) => vec![],
        }
    }
}

fn control_word() -> impl Strategy<Value = u16> {
    const WORDS: &[u16] = &[
        0x00, 0x06, 0x06, 0x07, 0x0F, 0x0F, 0x0F, 0x1F, 0x1F, 0x3F, 0x5F, 0x7F, 0x0B, 0x02, 0x80,
        0x10F,
    ];
    prop_oneof![8 => prop::sample::select(WORDS), 1 => any::<u16>()]
}

fn action() -> impl Strategy<Value = Action> {
    let any_entry =
        || prop::sample::select(TABLE.iter().map(|entry| entry.address).collect::<Vec<_>>());
    let nmt = prop::sample::select(vec![
        NmtCommand::Start,
        NmtCommand::Start,
        NmtCommand::Start,
        NmtCommand::Stop,
        NmtCommand::EnterPreOperational,
        NmtCommand::ResetCommunication,
        NmtCommand::ResetNode,
    ]);
    let ids = prop_oneof![
        Just(0x80u16),
        Just(0x201),
        Just(0x301),
        Just(0x401),
        Just(0x601),
        Just(0x701),
        Just(0x77F),
        0u16..0x800
    ];
    prop_oneof![
        2 => (any_entry(), any::<u32>()).prop_map(|(address, raw)| Action::Write(address, raw)),
        2 => (any_entry(), 0u32..100).prop_map(|(address, raw)| Action::Write(address, raw)),
        1 => (any::<u16>(), any::<u8>(), any::<u32>()).prop_map(|(i, s, raw)| Action::Write(Address::new(i, s), raw)),
        6 => control_word().prop_map(Action::Control),
        2 => control_word().prop_map(Action::ControlByPdo),
        2 => control_word().prop_map(Action::ControlBySdo),
        1 => nmt.prop_map(Action::Network),
        1 => (ids, prop::collection::vec(any::<u8>(), 0..=8)).prop_map(|(id, data)| Action::Frame(id, data)),
        1 => prop::collection::vec(0x90u8..0x93, 0..6).prop_map(Action::Serial),
        1 => any::<bool>().prop_map(Action::Block),
        6 => (0u8..80).prop_map(Action::Tick),
        1 => any::<u32>().prop_map(Action::Phase),
        1 => any::<u16>().prop_map(Action::Inject),
    ]
}

/// The drive with its interfaces and the checks of its transitions.
struct World {
    node: SimulatedDrive,
    can: CanServer,
    usb: UsbServer,
    last: DeviceState,
    /// Commands out of "operation enabled" since it was entered.
    expected: Vec<Cause>,
}

impl World {
    fn new(stops: [Option<i32>; 2]) -> Self {
        let node = SimulatedDrive::new(SimulatedDriveConfig {
            fault_at_power_on: DeviceError::NONE,
            initial_position: 0,
            hard_stops: stops,
            ..SimulatedDriveConfig::default()
        });
        Self {
            last: state(&node),
            node,
            can: CanServer::new(),
            usb: UsbServer::new(3),
            expected: Vec::new(),
        }
    }

    fn check_transition(&mut self, causes: &[Cause], what: &Action) {
        let now = state(&self.node);
        assert_eq!(now, self.node.state());
        let from = core::mem::replace(&mut self.last, now);
        if now == from {
            return;
        }
        let legal = LEGAL
            .iter()
            .any(|(a, by, b)| (*a, *b) == (from, now) && causes.contains(by));
        assert!(legal, "{from} -> {now} by {what:?}");
        let left = [(ReadyToSwitchOn, Shutdown), (SwitchedOn, SwitchOn)];
        if let Some((_, by)) = left
            .iter()
            .find(|(to, _)| from == OperationEnabled && now == *to)
        {
            assert!(self.expected.contains(by), "{now} has no cause");
        }
        self.expected.clear();
    }

    fn frame(&mut self, id: u16, data: &[u8]) {
        let frame = CanFrame::new(CobId::new(id).unwrap(), data).unwrap();
        self.can.input(&mut self.node, &frame, &mut |_| {});
    }

    fn act(&mut self, what: &Action) {
        let causes = what.causes();
        if let Some(by) = causes.first().filter(|_| self.last == OperationEnabled) {
            self.expected.push(*by);
        }
        if matches!(what, Action::Frame(..)) {
            self.expected.extend([Shutdown, SwitchOn]);
        }
        match what {
            Action::Write(address, raw) => {
                let before = self.node.read(*address);
                if self.node.write(*address, *raw).is_err() {
                    assert_eq!(before, self.node.read(*address));
                }
            }
            Action::Control(word) => self
                .node
                .write(objects::CONTROLWORD.address, u32::from(*word))
                .unwrap(),
            Action::ControlByPdo(word) => {
                // The default mapping may have been changed.
                let mapped = self.node.read(Address::new(0x1600, 1)).unwrap().raw();
                let count = self.node.read(Address::new(0x1600, 0)).unwrap().raw();
                let id = self.node.read(Address::new(0x1400, 1)).unwrap().raw();
                if (mapped, count, id) == (Some(0x6040_0010), Some(1), Some(0x201)) {
                    self.frame(0x201, &word.to_le_bytes());
                }
            }
            Action::ControlBySdo(word) => {
                let request = SdoRequest::InitiateDownload {
                    address: objects::CONTROLWORD.address,
                    transfer: Initiate::Expedited(Expedited::of(*word)),
                };
                self.frame(0x601, &request.to_bytes());
            }
            Action::Network(command) => {
                let nmt = Nmt {
                    node: NodeId::new(1),
                    command: *command,
                };
                self.can.input(&mut self.node, &nmt.to_frame(), &mut |_| {});
            }
            Action::Frame(id, data) => self.frame(*id, data),
            Action::Serial(bytes) => self.usb.input(&mut self.node, bytes, &mut |_| {}),
            Action::Block(true) => self.node.block(),
            Action::Block(false) => self.node.unblock(),
            Action::Tick(n) => {
                for _ in 0..*n {
                    self.tick(&causes, what);
                }
            }
            Action::Phase(phase) => self.node.set_phase_us(*phase),
            Action::Inject(code) => self.node.inject(DeviceError(*code)),
        }
        self.check_transition(&causes, what);
        let powered = !matches!(
            self.last,
            SwitchOnDisabled | ReadyToSwitchOn | SwitchedOn | Fault
        );
        let still = get(&self.node, objects::VELOCITY_DEMAND) == 0;
        assert!(powered || still, "the demand moves without power");
    }

    fn tick(&mut self, causes: &[Cause], what: &Action) {
        let before = self.node.segment().end;
        self.node.tick();
        assert_eq!(
            self.node.segment().start,
            before,
            "the shaft's position has a gap"
        );
        self.check_transition(causes, what);
        self.can.poll(&mut self.node, &mut |_| {});
        self.check_transition(&[Error], what);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(384))]

    #[test]
    fn arbitrary_sequences_do_not_panic_or_leave_the_state_machine(
        doings in prop::collection::vec(action(), 1..150),
        stops in prop::option::of((-20_000i32..0, 0i32..20_000)),
    ) {
        let mut world = World::new(stops.map_or([None; 2], |(low, high)| [Some(low), Some(high)]));
        for what in &doings {
            world.act(what);
        }
    }
}
