//! SLCAN sessions: lines of both directions, and a host that opens the adapter and sends requests
//! to the unit.

use protocol::canopen::sdo::SdoRequest;
use protocol::canopen::slcan::{Bitrate, SlcanCommand, SlcanReply};
use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::objects;

use crate::Seed;

/// Modes of `properties::slcan`.
const BYTES: u8 = 0;
const FRAME: u8 = 1;
const ADAPTER: u8 = 2;

pub fn seeds() -> Vec<Seed> {
    let mut seeds = vec![
        ("host".to_owned(), [&[BYTES], &host()[..]].concat()),
        ("adapter".to_owned(), [&[BYTES], &replies()[..]].concat()),
        (
            "frame".to_owned(),
            [&[FRAME, 0x3D], &[0x40; 8][..], &[0, 1], &host()].concat(),
        ),
    ];
    // Step 3: a number of bytes; step 0: a number of ticks; step 1: a phase.
    let host = host();
    let mut session = vec![ADAPTER];
    for part in host.chunks(200) {
        session.extend([3, part.len() as u8]);
        session.extend(part);
        session.extend([0, 20, 1, 0x10, 0x01]);
    }
    seeds.push(("session".to_owned(), session));
    seeds
}

fn request(node: NodeId) -> CanFrame {
    let address = objects::POSITION_ACTUAL.address;
    SdoRequest::InitiateUpload { address }.to_frame(node)
}

fn host() -> Vec<u8> {
    let node = NodeId::new(1).expect("an id");
    let nmt = CobId::new(0).expect("an id");
    let commands = [
        SlcanCommand::Empty,
        SlcanCommand::Empty,
        SlcanCommand::Close,
        SlcanCommand::Version,
        SlcanCommand::SerialNumber,
        SlcanCommand::Stamps(true),
        SlcanCommand::Bitrate(Bitrate::Kbit1000),
        SlcanCommand::Open,
        SlcanCommand::Status,
        SlcanCommand::Transmit(CanFrame::of(nmt, [1, 1])),
        SlcanCommand::Transmit(request(node)),
        SlcanCommand::Transmit(CanFrame::of(CobId::SYNC, [])),
        SlcanCommand::Close,
        SlcanCommand::OpenListening,
        SlcanCommand::Transmit(request(node)),
    ];
    let mut bytes = Vec::new();
    for command in commands {
        command.encode(&mut bytes);
    }
    bytes
}

fn replies() -> Vec<u8> {
    let mut bytes = Vec::new();
    let frame = request(NodeId::MAX);
    let frames = [None, Some(59_999)].map(|stamp_ms| SlcanReply::Received { frame, stamp_ms });
    let flat = [
        SlcanReply::Done,
        SlcanReply::Refused,
        SlcanReply::Sent,
        SlcanReply::SentExtended,
    ];
    for reply in flat
        .into_iter()
        .chain(frames)
        .chain([SlcanReply::Status(0x24)])
    {
        reply.encode(&mut bytes);
    }
    bytes.extend(b"V1013\rNA123\rxyz\r");
    bytes
}
