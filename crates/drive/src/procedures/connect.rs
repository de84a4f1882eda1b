//! Connect: who is there, is it at rest and without fault, and does it hold the settings that keep the axis safe.

use protocol::epos2::cia402::control;
use units::Quadcounts;

use crate::error::DriveError;
use crate::event::{Connected, Outcome, Progress};
use crate::objects;
use crate::ops::Ops;

use super::configure::{configure, verify_safety};
use super::network;
use super::power::{clear_fault, is_off, is_referenced, wait_for};
use super::report::{history, identify};
use super::stop::halt;

/// [`crate::Command::Connect`]
pub(crate) async fn connect(mut ops: Ops) -> Result<Outcome, DriveError> {
    network::pre_operational(&ops);
    let identity = identify(&ops).await?;
    ops.tell(Progress::Identified(identity));
    let history = history(&ops).await?;
    let found = ops.read(objects::STATUSWORD).await?;
    if !is_off(found) {
        // Somebody left it on, perhaps moving.
        halt(&mut ops).await?;
    }
    clear_fault(&ops).await?;
    ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await?;
    wait_for(&ops, "power off, no fault", is_off).await?;
    network::begin(&ops);
    configure(&ops).await?;
    verify_safety(&ops).await?;
    let (angle, watches_host) = network::set_up(&ops).await?;
    ops.tell(Progress::Configured);
    let statusword = ops.read(objects::STATUSWORD).await?;
    let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let referenced = is_referenced(statusword);
    ops.set_referenced(referenced);
    Ok(Outcome::Connected(Connected {
        identity,
        history,
        referenced,
        position,
        angle,
        watches_host,
    }))
}
