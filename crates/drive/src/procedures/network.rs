//! What a CAN bus asks for beside the settings of the axis: the node's network state, heartbeats both ways, the stream of
//! positions. On the other links each of these does nothing.
//!
//! The node watches the host's heartbeat (1016) only while a command may move the axis: an axis at rest holds, and its owner need
//! not be heard between two commands. The EPOS2 has nothing of the kind on USB and RS232.

use protocol::canopen::heartbeat::ConsumerEntry;
use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::pdo::{self, TransmissionType};
use protocol::canopen::{CanId, NodeId};
use protocol::epos2::cia402::status;
use protocol::epos2::objects::{Address, Object};

use crate::bus::{self, STREAM};
use crate::config::whole_ms;
use crate::error::DriveError;
use crate::event::AngleSource;
use crate::objects;
use crate::ops::Ops;

use super::power::wait_for;

/// The node listens to requests, and takes the settings of its process data, in this state.
pub(super) fn pre_operational(ops: &Ops) {
    ops.on_bus(|bus, _| bus.command(NmtCommand::EnterPreOperational));
}

/// From here on a node that restarts forgets what it was told; before, it may just have been switched on.
pub(super) fn begin(ops: &Ops) {
    ops.on_bus(|bus, _| bus.forget());
}

/// Heartbeats and stream; then the node is started.
pub(super) async fn set_up(ops: &Ops) -> Result<(AngleSource, bool), DriveError> {
    let Some(node) = ops.on_bus(|bus, _| bus.node()) else {
        return Ok((AngleSource::Polls, false));
    };
    let period = whole_ms(ops.config.can.node_heartbeat);
    let period = u16::try_from(period).unwrap_or(u16::MAX);
    taken(ops.set(objects::PRODUCER_HEARTBEAT, period).await)?;
    let watches = taken(ops.set(objects::CONSUMER_HEARTBEAT, NOBODY).await)?;
    let streams = taken(map_stream(ops, node).await)?;
    ops.on_bus(|bus, _| {
        bus.watches_host = watches;
        bus.streaming = streams;
        bus.command(NmtCommand::Start);
    });
    wait_for(ops, "NMT operational (bit 9)", |word| {
        word & status::REMOTE != 0
    })
    .await?;
    if ops.on_bus(|bus, _| bus.has_restarted()) == Some(true) {
        return Err(DriveError::Restarted { error: None });
    }
    let angle = if streams {
        AngleSource::Stream
    } else {
        AngleSource::Polls
    };
    Ok((angle, watches))
}

/// 1016: no heartbeat is expected.
const NOBODY: u32 = 0;

/// Whether a node took a setting that not every firmware has.
fn taken(result: Result<(), DriveError>) -> Result<bool, DriveError> {
    match result {
        Ok(()) => Ok(true),
        Err(DriveError::Refused { .. } | DriveError::NotTaken { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

async fn map_stream(ops: &Ops, node: NodeId) -> Result<(), DriveError> {
    let wanted = bus::configuration();
    for write in pdo::configuration(STREAM, node, &wanted) {
        let width = write.data.as_slice().len() as u8;
        let written = ops
            .write_raw(write.address, write.data.to_u32(), width)
            .await;
        // Its shortest time between two is no part of every firmware, and does not hold for SYNC by CiA 301.
        let inhibit = write.address == Address::new(STREAM.communication(), 3);
        if inhibit {
            taken(written)?;
        } else {
            written?;
        }
    }
    expect_stream(ops, node).await
}

/// The node still sends what it was told to. Done before every move: a log of the move then tells what its stream carries, and a master
/// that changed it is noticed.
pub(super) async fn verify(ops: &Ops) -> Result<(), DriveError> {
    match ops.on_bus(|bus, _| (bus.streaming, bus.node())) {
        Some((true, node)) => expect_stream(ops, node).await,
        _ => Ok(()),
    }
}

async fn expect_stream(ops: &Ops, node: NodeId) -> Result<(), DriveError> {
    let (communication, mapping) = (STREAM.communication(), STREAM.mapping());
    let id = ops
        .read(Object::<u32>::new(communication, 1, "COB-ID"))
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
    let each = TransmissionType::EACH_SYNC.to_u8();
    ops.expect(Object::<u8>::new(communication, 2, "type"), each)
        .await?;
    let layout = bus::layout();
    let entries = layout.entries();
    let count = Object::<u8>::new(mapping, 0, "count");
    ops.expect(count, entries.len() as u8).await?;
    for (sub, entry) in (1..).zip(entries) {
        let object = Object::<u32>::new(mapping, sub, "entry");
        ops.expect(object, entry.to_u32()).await?;
    }
    Ok(())
}

/// From here on the node stops by itself if the host falls silent.
pub(super) async fn arm(ops: &Ops) -> Result<(), DriveError> {
    let can = ops.config.can;
    let watches = ops.on_bus(|bus, now| {
        if bus.watches_host {
            bus.live(now);
        }
        bus.watches_host
    });
    let (Some(true), Some(node)) = (watches, NodeId::new(can.host_node)) else {
        return Ok(());
    };
    let time_ms = u16::try_from(whole_ms(can.host_limit)).unwrap_or(u16::MAX);
    let entry = ConsumerEntry { node, time_ms };
    ops.set(objects::CONSUMER_HEARTBEAT, entry.to_u32()).await
}

/// The host may fall silent.
pub(super) async fn disarm(ops: &Ops) -> Result<(), DriveError> {
    let armed = ops.on_bus(|bus, _| bus.is_living());
    if armed != Some(true) {
        return Ok(());
    }
    let written = ops.write(objects::CONSUMER_HEARTBEAT, NOBODY).await;
    if written.is_ok() {
        ops.on_bus(|bus, _| bus.cease());
    }
    written
}
