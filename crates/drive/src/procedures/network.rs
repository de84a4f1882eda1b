//! Configuration of a CAN bus: NMT state, heartbeats both ways, the stream of positions. Does
//! nothing on other links.
//!
//! The node monitors the host's heartbeat (1016) from before the axis is powered until its power is
//! off, or it is held as configured. The EPOS2 has no such monitoring on USB and RS232.

use protocol::canopen::heartbeat::ConsumerEntry;
use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::pdo::{self, TransmissionType};
use protocol::canopen::{CanId, NodeId};
use protocol::epos2::cia402::status;
use protocol::epos2::objects::{self, Address, TypedObject};

use crate::can_services::{self, STREAM};
use crate::config::whole_ms;
use crate::error::DriveError;
use crate::event::AngleSource;
use crate::ops::Ops;

use super::power::wait_for;

/// Enters the NMT state in which process data can be configured.
pub(super) fn enter_pre_operational(ops: &Ops) {
    ops.on_can(|can, _| can.send_nmt(NmtCommand::EnterPreOperational));
}

/// Resets the services. A boot-up message before this only shows that the drive was switched on.
pub(super) fn reset(ops: &Ops) {
    ops.on_can(|can, _| can.reset());
}

/// Configures heartbeats and stream, then starts the node.
pub(super) async fn configure(ops: &Ops) -> Result<(AngleSource, bool), DriveError> {
    let Some(node) = ops.on_can(|can, _| can.node) else {
        return Ok((AngleSource::Polls, false));
    };
    let period = whole_ms(ops.config.can.node_heartbeat);
    let period = u16::try_from(period).unwrap_or(u16::MAX);
    is_supported(
        ops.write_verified(objects::PRODUCER_HEARTBEAT, period)
            .await,
    )?;
    let monitors_host = is_known(
        ops.write_verified(objects::CONSUMER_HEARTBEAT, NO_CONSUMER)
            .await,
    )?;
    let obeys_option = is_known(
        ops.write_verified(objects::ABORT_CONNECTION_OPTION, abort_option(ops))
            .await,
    )?;
    let streaming = is_supported(map_stream(ops, node).await)?;
    ops.on_can(|can, _| {
        can.monitors_host = monitors_host;
        can.obeys_abort_option = obeys_option;
        can.streaming = streaming;
        can.send_nmt(NmtCommand::Start);
    });
    wait_for(ops, "NMT operational (bit 9)", |word| {
        word & status::REMOTE != 0
    })
    .await?;
    if ops.on_can(|can, _| can.restarted) == Some(true) {
        return Err(DriveError::Restarted { error: None });
    }
    let angle = if streaming {
        AngleSource::Stream
    } else {
        AngleSource::Polls
    };
    Ok((angle, monitors_host))
}

/// The drive's reaction to a missing heartbeat of the host (6007): 1, that to a device error (605E:
/// ramp, then power off and brake), or 3, a quick stop that keeps the axis powered. Firmware
/// without these values has the reaction of 605E.
fn abort_option(ops: &Ops) -> i16 {
    match ops.config.holds() {
        true => 3,
        false => 1,
    }
}

/// 1016: no heartbeat is monitored.
const NO_CONSUMER: u32 = 0;

/// Whether the firmware supports a setting that not every version has.
fn is_supported(result: Result<(), DriveError>) -> Result<bool, DriveError> {
    match result {
        Ok(()) => Ok(true),
        Err(DriveError::Refused { .. } | DriveError::NotTaken { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// Whether the firmware has an object on which the stop of the axis depends if the host dies. A
/// value that it confirms and does not take is an error: the axis might run on.
fn is_known(result: Result<(), DriveError>) -> Result<bool, DriveError> {
    match result {
        Err(error @ DriveError::NotTaken { .. }) => Err(error),
        result => is_supported(result),
    }
}

async fn map_stream(ops: &Ops, node: NodeId) -> Result<(), DriveError> {
    let configuration = can_services::stream_configuration();
    for write in pdo::configuration(STREAM, node, &configuration) {
        let width = write.data.as_slice().len() as u8;
        let written = ops
            .write_raw(write.address, write.data.to_u32(), width)
            .await;
        // Not every firmware has the inhibit time, and CiA 301 does not apply it to synchronous
        // PDOs.
        if write.address == Address::new(STREAM.communication(), 3) {
            is_supported(written)?;
        } else {
            written?;
        }
    }
    verify_mapping(ops, node).await
}

/// Verifies the reaction to a lost host, and the stream, before a move: a log of the move then
/// contains the mapping, and a change by another master is detected.
pub(super) async fn verify(ops: &Ops) -> Result<(), DriveError> {
    if ops.on_can(|can, _| can.obeys_abort_option) == Some(true) {
        ops.verify(objects::ABORT_CONNECTION_OPTION, abort_option(ops))
            .await?;
    }
    match ops.on_can(|can, _| (can.streaming, can.node)) {
        Some((true, node)) => verify_mapping(ops, node).await,
        _ => Ok(()),
    }
}

async fn verify_mapping(ops: &Ops, node: NodeId) -> Result<(), DriveError> {
    let (communication, mapping) = (STREAM.communication(), STREAM.mapping());
    let id = ops
        .read(TypedObject::<u32>::new(communication, 1, "COB-ID"))
        .await?;
    let got = pdo::CommunicationId::from_u32(id);
    let expected = STREAM.channel(node).cob_id();
    if !got.valid || got.id != CanId::Standard(expected) {
        return Err(DriveError::NotTaken {
            address: Address::new(communication, 1),
            expected: u32::from(expected.get()),
            got: id,
        });
    }
    let each_sync = TransmissionType::EACH_SYNC.to_u8();
    ops.verify(TypedObject::<u8>::new(communication, 2, "type"), each_sync)
        .await?;
    let layout = can_services::layout();
    let entries = layout.entries();
    let count = TypedObject::<u8>::new(mapping, 0, "count");
    ops.verify(count, entries.len() as u8).await?;
    for (sub, entry) in (1..).zip(entries) {
        let object = TypedObject::<u32>::new(mapping, sub, "entry");
        ops.verify(object, entry.to_u32()).await?;
    }
    Ok(())
}

/// Starts the monitoring: the node stops on its own if the host's heartbeat is missing. A node that
/// cannot is not moved: no other process stops the axis on a bus.
pub(super) async fn arm(ops: &Ops) -> Result<(), DriveError> {
    let can = ops.config.can;
    let monitors_host = ops.on_can(|can, now| {
        if can.monitors_host {
            can.start_heartbeat(now);
        }
        can.monitors_host
    });
    if monitors_host == Some(false) {
        return Err(DriveError::HostNotMonitored);
    }
    let (Some(true), Some(node)) = (monitors_host, NodeId::new(can.host_node)) else {
        return Ok(());
    };
    let time_ms = u16::try_from(whole_ms(can.host_limit)).unwrap_or(u16::MAX);
    let entry = ConsumerEntry { node, time_ms };
    ops.write_verified(objects::CONSUMER_HEARTBEAT, entry.to_u32())
        .await?;
    // The node monitors from the first heartbeat on: one goes out before anything can move.
    ops.on_can(|can, now| {
        can.next_heartbeat = Some(now);
        can.host_silence = None;
    });
    Ok(())
}

/// Ends the monitoring.
pub(super) async fn disarm(ops: &Ops) -> Result<(), DriveError> {
    if ops.on_can(|can, _| can.next_heartbeat.is_some()) != Some(true) {
        return Ok(());
    }
    ops.write_idempotent(objects::CONSUMER_HEARTBEAT, NO_CONSUMER)
        .await?;
    ops.on_can(|can, _| can.next_heartbeat = None);
    Ok(())
}
