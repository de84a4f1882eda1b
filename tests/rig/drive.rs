//! State of a software drive, read without using its line.

use firmware_sim::epos2::Node;
use protocol::epos2::cia402::DeviceState;

/// Whether its shaft moves in this control cycle.
#[must_use]
pub fn moves(node: &Node) -> bool {
    let segment = node.segment();
    segment.start != segment.end
}

/// Whether its power stage is on.
#[must_use]
pub fn is_powered(node: &Node) -> bool {
    matches!(
        node.state(),
        DeviceState::OperationEnabled
            | DeviceState::QuickStopActive
            | DeviceState::FaultReactionEnabled
    )
}
