//! The software EPOS2 alone in real time: its control cycle follows the host's clock, and its
//! frames pass over a port.

use std::sync::atomic::{AtomicBool, Ordering};

use firmware_sim::epos2::{CanServer, Node, NodeConfig, Rs232Server, SlcanServer, UsbServer};
use io::can::{CanError, CanPort, SocketCan};
use io::port::{Port, PortError, Pty};
use protocol::canopen::CanFrame;
use protocol::epos2::DeviceError;
use thiserror::Error;
use units::{Host, Span, Stamp};

/// Protocol and port of the drive.
pub enum Interface {
    /// EPOS2 USB frames on a pseudo-terminal.
    Usb(UsbServer, Pty),
    /// EPOS2 RS232 frames on a pseudo-terminal.
    Rs232(Rs232Server, Pty),
    /// CANopen behind an SLCAN adapter on a pseudo-terminal.
    Slcan(SlcanServer, Pty),
    /// CANopen on an interface of the kernel.
    Can(CanServer, SocketCan),
}

/// Why the drive stopped.
#[derive(Debug, Error)]
pub enum SoftwareDriveError {
    /// The pseudo-terminal failed.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The CAN interface failed.
    #[error(transparent)]
    Can(#[from] CanError),
}

const CYCLE: Span = Span::from_millis(1);
/// After a longer pause, such as a suspension, the drive continues from now.
const LONGEST_PAUSE: Span = Span::from_secs(1);
/// Bus frames per cycle: more than 1 Mbit/s carries in a millisecond.
const FRAMES_A_CYCLE: usize = 32;

/// Runs the drive until `stop`.
///
/// # Errors
/// Returns the failure of its port.
pub fn run(
    config: NodeConfig,
    mut interface: Interface,
    stop: &AtomicBool,
) -> Result<(), SoftwareDriveError> {
    let mut node = Node::new(NodeConfig {
        fault_at_power_on: interface.fault_at_power_on(),
        ..config
    });
    let mut cycle: Stamp<Host> = io::clock::now();
    while !stop.load(Ordering::Relaxed) {
        let wait = (cycle + CYCLE).saturating_since(io::clock::now());
        let received = interface.receive(wait.clamp(Span::ZERO, CYCLE))?;
        let now = io::clock::now();
        if now.saturating_since(cycle) > LONGEST_PAUSE || now < cycle {
            cycle = now;
        }
        while now.saturating_since(cycle) >= CYCLE {
            node.tick();
            cycle += CYCLE;
            interface.poll(&mut node)?;
        }
        let phase_us = now.saturating_since(cycle).as_nanos() / 1_000;
        node.set_phase_us(u32::try_from(phase_us).unwrap_or(0));
        interface.answer(&mut node, &received)?;
    }
    Ok(())
}

/// Input: bytes of a serial line, or frames of a bus.
#[derive(Default)]
struct Received {
    bytes: Vec<u8>,
    frames: Vec<CanFrame>,
}

impl Interface {
    /// The error at power-on of a unit without a CAN bus.
    fn fault_at_power_on(&self) -> DeviceError {
        match self {
            Self::Usb(..) | Self::Rs232(..) => DeviceError::CAN_PASSIVE,
            Self::Slcan(..) | Self::Can(..) => DeviceError::NONE,
        }
    }

    fn receive(&mut self, wait: Span) -> Result<Received, SoftwareDriveError> {
        let mut received = Received::default();
        match self {
            Self::Usb(_, pty) | Self::Rs232(_, pty) | Self::Slcan(_, pty) => {
                let mut buffer = [0; 512];
                let count = pty.read(&mut buffer, wait)?.map_or(0, |(count, _)| count);
                received
                    .bytes
                    .extend(buffer.get(..count).unwrap_or_default());
            }
            Self::Can(_, bus) => {
                let mut wait = wait;
                while let Some((frame, _)) = bus.read(wait)? {
                    received.frames.push(frame);
                    wait = Span::ZERO;
                    if received.frames.len() >= FRAMES_A_CYCLE {
                        break;
                    }
                }
            }
        }
        Ok(received)
    }

    fn answer(&mut self, node: &mut Node, received: &Received) -> Result<(), SoftwareDriveError> {
        let mut out = Vec::new();
        let mut bytes = |bytes: &[u8]| out.extend_from_slice(bytes);
        match self {
            Self::Usb(server, pty) => {
                server.input(node, &received.bytes, &mut bytes);
                send(pty, &out)?;
            }
            Self::Rs232(server, pty) => {
                server.input(node, &received.bytes, &mut bytes);
                send(pty, &out)?;
            }
            Self::Slcan(server, pty) => {
                server.input(node, &received.bytes, &mut bytes);
                send(pty, &out)?;
            }
            Self::Can(server, bus) => {
                let mut frames = Vec::new();
                for frame in &received.frames {
                    server.input(node, frame, &mut |answer: &CanFrame| frames.push(*answer));
                }
                transmit(bus, &frames)?;
            }
        }
        Ok(())
    }

    /// Sends unsolicited frames of the drive after a control cycle.
    fn poll(&mut self, node: &mut Node) -> Result<(), SoftwareDriveError> {
        match self {
            Self::Usb(..) | Self::Rs232(..) => {}
            Self::Slcan(server, pty) => {
                let mut out = Vec::new();
                server.poll(node, &mut |bytes: &[u8]| out.extend_from_slice(bytes));
                send(pty, &out)?;
            }
            Self::Can(server, bus) => {
                let mut frames = Vec::new();
                server.poll(node, &mut |frame: &CanFrame| frames.push(*frame));
                transmit(bus, &frames)?;
            }
        }
        Ok(())
    }
}

fn send(pty: &mut Pty, bytes: &[u8]) -> Result<(), PortError> {
    if bytes.is_empty() {
        return Ok(());
    }
    match pty.write_frame(bytes) {
        // A client that does not read loses its answers, as on a real line.
        Ok(_) | Err(PortError::WriteTimeout { .. }) => Ok(()),
        Err(error) => Err(error),
    }
}

fn transmit(bus: &mut SocketCan, frames: &[CanFrame]) -> Result<(), CanError> {
    for frame in frames {
        bus.write_frame(frame)?;
    }
    Ok(())
}
