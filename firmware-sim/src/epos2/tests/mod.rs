//! The drive through its object dictionary, as seen by a client.

mod access;
mod anything;
mod blocked;
mod description;
mod golden;
mod homing;
mod limits;
mod load;
mod position;
mod setting_modes;
mod states;
mod storage;
mod velocity;

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, status};
use protocol::epos2::objects::{self, Scalar, TypedObject};

use super::{SimulatedDrive, SimulatedDriveConfig};

/// A drive without fault, at world 0.
fn healthy() -> SimulatedDrive {
    SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        ..SimulatedDriveConfig::default()
    })
}

fn get<T: Scalar>(node: &SimulatedDrive, object: TypedObject<T>) -> T {
    object.decode(node.read(object.address).unwrap().raw().unwrap())
}

fn set<T: Scalar>(node: &mut SimulatedDrive, object: TypedObject<T>, value: T) {
    node.write(object.address, object.encode(value)).unwrap();
}

fn command(node: &mut SimulatedDrive, word: u16) {
    set(node, objects::CONTROLWORD, word);
}

fn state(node: &SimulatedDrive) -> DeviceState {
    DeviceState::from_statusword(get(node, objects::STATUSWORD)).expect("a legal statusword")
}

fn has(node: &SimulatedDrive, bits: u16) -> bool {
    get(node, objects::STATUSWORD) & bits == bits
}

fn ticks(node: &mut SimulatedDrive, n: usize) {
    for _ in 0..n {
        node.tick();
    }
}

/// Ticks until `done`. Returns the number of ticks.
fn until(node: &mut SimulatedDrive, most: usize, done: impl Fn(&SimulatedDrive) -> bool) -> usize {
    for n in 0..most {
        if done(node) {
            return n;
        }
        node.tick();
    }
    panic!(
        "not done after {most} ms: statusword {:04X}",
        get(node, objects::STATUSWORD)
    );
}

fn enable(node: &mut SimulatedDrive) {
    command(node, control::SHUTDOWN);
    command(node, control::ENABLE_OPERATION);
    until(node, 100, |node| {
        state(node) == DeviceState::OperationEnabled
    });
}

fn enabled() -> SimulatedDrive {
    let mut node = healthy();
    enable(&mut node);
    node
}

fn go(node: &mut SimulatedDrive, target: i32, word: u16) {
    set(node, objects::TARGET_POSITION, target);
    command(node, control::ENABLE_OPERATION);
    command(node, word);
}

fn arrive(node: &mut SimulatedDrive) -> usize {
    until(node, 100_000, |node| has(node, status::TARGET_REACHED))
}

fn position(node: &SimulatedDrive) -> i32 {
    get(node, objects::POSITION_ACTUAL)
}
