//! State of a simulated drive, read without using its line.

use firmware_sim::epos2::SimulatedDrive;
use protocol::epos2::cia402::DeviceState;

/// Whether its shaft moves in this control cycle.
#[must_use]
pub fn moves(node: &SimulatedDrive) -> bool {
    let segment = node.segment();
    segment.start != segment.end
}

/// Whether its power stage is on.
#[must_use]
pub fn is_powered(node: &SimulatedDrive) -> bool {
    matches!(
        node.state(),
        DeviceState::OperationEnabled
            | DeviceState::QuickStopActive
            | DeviceState::FaultReactionEnabled
    )
}
