//! Connect: identify the drive, bring it to rest without fault, and write its settings.

use protocol::epos2::cia402::control;
use protocol::epos2::objects;
use units::Quadcounts;

use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, ConnectionReport};
use crate::ops::Ops;

use super::configure::{configure, verify_safety};
use super::network;
use super::power::{clear_fault, is_held, is_off, is_referenced, wait_for};
use super::report::{history, identify};
use super::stop::halt;

/// Runs [`crate::DriveCommand::Connect`].
pub(crate) async fn connect(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    network::enter_pre_operational(&ops);
    let identity = identify(&ops).await?;
    ops.report(CommandProgress::Identified(identity));
    let history = history(&ops).await?;
    let statusword = ops.read(objects::STATUSWORD).await?;
    if !is_off(statusword) {
        // Left enabled by another master, perhaps moving.
        halt(&mut ops).await?;
    }
    clear_fault(&ops).await?;
    if !is_held(&ops, ops.read(objects::STATUSWORD).await?) {
        ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
            .await?;
        wait_for(&ops, "power off, no fault", is_off).await?;
    }
    network::reset(&ops);
    configure(&ops).await?;
    verify_safety(&ops).await?;
    let (angle, monitors_host) = network::configure(&ops).await?;
    ops.report(CommandProgress::Configured);
    let statusword = ops.read(objects::STATUSWORD).await?;
    let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let referenced = is_referenced(statusword);
    ops.set_referenced(referenced);
    Ok(CommandOutcome::Connected(ConnectionReport {
        identity,
        history,
        referenced,
        position,
        angle,
        monitors_host,
    }))
}
