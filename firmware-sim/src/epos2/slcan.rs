//! A serial CAN adapter (SLCAN, Lawicel ASCII) with the drive on its bus.
//!
//! Answers are those of a CANUSB: CR, BEL for a rejected command, `z` for a sent frame. The drive
//! is alone on the bus and accepts any bit rate. Not simulated: filters, bit timing registers, the
//! queue of the adapter.

use protocol::canopen::CanFrame;
use protocol::canopen::CanId;
use protocol::canopen::slcan::{CommandDecoder, Line, SlcanCommand, SlcanReply};
use protocol::epos2::BoundedVec;

use super::can::CanServer;
use super::node::SimulatedDrive;

/// Period of the time stamps of an adapter in milliseconds.
const STAMP_PERIOD_MS: u64 = 60_000;
/// Bytes of the longest reply: a line and its CR.
const LONGEST_REPLY: usize = 128;

/// The adapter and the drive's CAN interface behind it.
#[derive(Clone, Debug, Default)]
pub struct SlcanServer {
    decoder: CommandDecoder,
    channel: AdapterChannel,
    stamps: bool,
    can: CanServer,
}

/// State of the channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum AdapterChannel {
    #[default]
    Closed,
    /// From the bus only.
    Listening,
    Open,
}

impl SlcanServer {
    /// An adapter with a closed channel. Frames that the drive sends meanwhile, such as its boot-up
    /// message, are lost.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes bytes from the host at the present instant of the node; each reply goes to `out` as
    /// one line.
    pub fn input(&mut self, node: &mut SimulatedDrive, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        for &byte in bytes {
            match self.decoder.push(byte) {
                None => {}
                Some(Ok(command)) => self.execute(node, &command, out),
                Some(Err(_)) => reply(&SlcanReply::Refused, out),
            }
        }
    }

    /// Forwards the frames that the drive sends at its present instant. Call it after each
    /// [`SimulatedDrive::tick`].
    pub fn poll(&mut self, node: &mut SimulatedDrive, out: &mut impl FnMut(&[u8])) {
        let stamp_ms = self.stamp_ms(node);
        let channel = self.channel;
        self.can
            .poll(node, &mut |frame| receive(channel, frame, stamp_ms, out));
    }

    fn execute(
        &mut self,
        node: &mut SimulatedDrive,
        command: &SlcanCommand,
        out: &mut impl FnMut(&[u8]),
    ) {
        let closed = self.channel == AdapterChannel::Closed;
        let answer = match command {
            SlcanCommand::Empty => SlcanReply::Done,
            SlcanCommand::Bitrate(_) if closed => SlcanReply::Done,
            SlcanCommand::Stamps(on) if closed => {
                self.stamps = *on;
                SlcanReply::Done
            }
            SlcanCommand::Open if closed => self.switch(AdapterChannel::Open),
            SlcanCommand::OpenListening if closed => self.switch(AdapterChannel::Listening),
            SlcanCommand::Close if !closed => self.switch(AdapterChannel::Closed),
            SlcanCommand::Status if !closed => SlcanReply::Status(0),
            SlcanCommand::Version => SlcanReply::Version(line(b"1013")),
            SlcanCommand::SerialNumber => SlcanReply::SerialNumber(line(b"EPOS")),
            SlcanCommand::Transmit(frame) if self.channel == AdapterChannel::Open => {
                reply(
                    match frame.id() {
                        CanId::Standard(_) => &SlcanReply::Sent,
                        CanId::Extended(_) => &SlcanReply::SentExtended,
                    },
                    out,
                );
                return self.transmit(node, frame, out);
            }
            _ => SlcanReply::Refused,
        };
        reply(&answer, out);
    }

    fn switch(&mut self, channel: AdapterChannel) -> SlcanReply {
        self.channel = channel;
        SlcanReply::Done
    }

    fn transmit(
        &mut self,
        node: &mut SimulatedDrive,
        frame: &CanFrame,
        out: &mut impl FnMut(&[u8]),
    ) {
        let stamp_ms = self.stamp_ms(node);
        self.can.input(node, frame, &mut |frame| {
            receive(AdapterChannel::Open, frame, stamp_ms, out);
        });
    }

    fn stamp_ms(&self, node: &SimulatedDrive) -> Option<u16> {
        // Below a minute, so it fits 16 bits.
        let ms = node.time_us() / 1000 % STAMP_PERIOD_MS;
        self.stamps.then_some(ms as u16)
    }
}

/// Forwards a frame of the bus.
fn receive(
    channel: AdapterChannel,
    frame: &CanFrame,
    stamp_ms: Option<u16>,
    out: &mut impl FnMut(&[u8]),
) {
    if channel != AdapterChannel::Closed {
        let frame = *frame;
        reply(&SlcanReply::Received { frame, stamp_ms }, out);
    }
}

fn reply(reply: &SlcanReply, out: &mut impl FnMut(&[u8])) {
    let mut bytes = BoundedVec::<u8, LONGEST_REPLY>::new();
    reply.encode(&mut bytes);
    out(&bytes);
}

fn line(text: &[u8]) -> Line {
    let mut line = Line::new();
    line.extend(text.iter().copied());
    line
}

#[cfg(test)]
#[path = "slcan_tests.rs"]
mod tests;
