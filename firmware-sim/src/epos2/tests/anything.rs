//! Whatever is done to it.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::State;
use protocol::epos2::objects::{self, Address};

use super::super::Node;
use super::super::table::TABLE;
use super::{command, get, healthy, state};

/// The legal transitions of CiA 402 as this unit shows them between two looks.
fn is_legal(from: State, to: State) -> bool {
    use State as S;
    from == to
        || match from {
            S::SwitchOnDisabled => matches!(to, S::ReadyToSwitchOn | S::Fault),
            S::ReadyToSwitchOn => matches!(
                to,
                S::SwitchedOn | S::MeasureInit | S::SwitchOnDisabled | S::Fault
            ),
            S::SwitchedOn => matches!(
                to,
                S::MeasureInit | S::ReadyToSwitchOn | S::SwitchOnDisabled | S::Fault
            ),
            S::MeasureInit => !matches!(to, S::QuickStopActive | S::Fault),
            S::OperationEnabled => !matches!(to, S::MeasureInit | S::Fault),
            S::QuickStopActive => matches!(
                to,
                S::OperationEnabled
                    | S::SwitchOnDisabled
                    | S::FaultReactionEnabled
                    | S::FaultReactionDisabled
            ),
            S::FaultReactionEnabled | S::FaultReactionDisabled => to == S::Fault,
            S::Fault => to == S::SwitchOnDisabled,
            S::Start | S::NotReadyToSwitchOn | S::Refresh => false,
        }
}

#[derive(Clone, Debug)]
enum Doing {
    Write(Address, u32),
    Control(u16),
    Tick(u8),
    Phase(u32),
    Inject(u16),
}

fn doing() -> impl Strategy<Value = Doing> {
    const WORDS: &[u16] = &[
        0x00, 0x06, 0x06, 0x07, 0x0F, 0x0F, 0x0F, 0x1F, 0x1F, 0x3F, 0x5F, 0x7F, 0x0B, 0x02, 0x80,
        0x10F,
    ];
    prop_oneof![
        2 => (prop::sample::select(TABLE.iter().map(|entry| entry.address).collect::<Vec<_>>()), any::<u32>())
            .prop_map(|(address, raw)| Doing::Write(address, raw)),
        2 => (prop::sample::select(TABLE.iter().map(|entry| entry.address).collect::<Vec<_>>()), 0u32..100)
            .prop_map(|(address, raw)| Doing::Write(address, raw)),
        1 => (any::<u16>(), any::<u8>(), any::<u32>()).prop_map(|(i, s, raw)| Doing::Write(Address::new(i, s), raw)),
        8 => prop::sample::select(WORDS).prop_map(Doing::Control),
        1 => any::<u16>().prop_map(Doing::Control),
        6 => any::<u8>().prop_map(Doing::Tick),
        1 => any::<u32>().prop_map(Doing::Phase),
        1 => any::<u16>().prop_map(Doing::Inject),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn no_sequence_panics_or_leaves_the_state_machine(doings in prop::collection::vec(doing(), 1..120)) {
        let mut node = healthy();
        let mut last = state(&node);
        let mut look = |node: &Node, what: &Doing| {
            let now = state(node);
            assert!(is_legal(last, now), "{last} -> {now} by {what:?}");
            assert_eq!(now, node.state());
            last = now;
        };
        for what in &doings {
            match *what {
                Doing::Write(address, raw) => {
                    let before = node.read(address);
                    if node.write(address, raw).is_err() {
                        prop_assert_eq!(before, node.read(address));
                    }
                }
                Doing::Control(word) => command(&mut node, word),
                Doing::Tick(n) => {
                    for _ in 0..n {
                        let before = node.segment().end;
                        node.tick();
                        prop_assert_eq!(node.segment().start, before, "a gap in the shaft's way");
                        look(&node, what);
                    }
                }
                Doing::Phase(phase) => node.set_phase_us(phase),
                Doing::Inject(code) => node.inject(DeviceError(code)),
            }
            look(&node, what);
            let powered = !matches!(state(&node), State::SwitchOnDisabled | State::ReadyToSwitchOn | State::SwitchedOn | State::Fault);
            prop_assert!(powered || get(&node, objects::VELOCITY_ACTUAL) == 0, "moves without power");
            for entry in &TABLE {
                prop_assert!(node.read(entry.address).is_ok());
            }
        }
    }
}
