//! The simulated EPOS2 alone in real time: its control cycle follows the host's clock, and its
//! frames pass over a port.

use std::sync::atomic::{AtomicBool, Ordering};

use firmware_sim::epos2::{SimulatedDrive, SimulatedDriveConfig};
use io::can::{CanError, CanPort, SocketCan};
use io::port::{Port, PortError, Pty};
use protocol::canopen::{CanFrame, SOCKETCAN_LEN};
use protocol::epos2::DeviceError;
use sim::{Attachment, DriveServer};
use thiserror::Error;
use units::{Host, Span, Stamp};

/// Port of the drive.
pub enum SimulatedPort {
    /// A pseudo-terminal.
    Serial(Pty),
    /// An interface of the kernel.
    Can(SocketCan),
}

/// Reason for which the drive stopped.
#[derive(Debug, Error)]
pub enum SimulatedDriveError {
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

/// Seed of the drive's own numbers.
const SEED: u64 = 1;

/// Runs the drive at `port` until `stop`.
///
/// # Errors
/// Returns the failure of its port.
pub fn run(
    config: SimulatedDriveConfig,
    attachment: Attachment,
    port: SimulatedPort,
    stop: &AtomicBool,
) -> Result<(), SimulatedDriveError> {
    run_observed(config, attachment, port, stop, &mut |_, _| {})
}

/// Like [`run`]; calls `observe` with the drive and the host time of each control cycle.
///
/// # Errors
/// Returns the failure of its port.
pub fn run_observed(
    config: SimulatedDriveConfig,
    attachment: Attachment,
    mut port: SimulatedPort,
    stop: &AtomicBool,
    observe: &mut dyn FnMut(Stamp<Host>, &SimulatedDrive),
) -> Result<(), SimulatedDriveError> {
    let mut server = DriveServer::new(attachment, SEED);
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        // The error of a drive without a CAN bus.
        fault_at_power_on: match attachment {
            Attachment::Usb | Attachment::Rs232 => DeviceError::CAN_PASSIVE,
            Attachment::Slcan | Attachment::Can => DeviceError::NONE,
        },
        ..config
    });
    let mut cycle: Stamp<Host> = io::clock::now();
    let mut out = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        let wait = (cycle + CYCLE).saturating_since(io::clock::now());
        let received = port.receive(wait.clamp(Span::ZERO, CYCLE))?;
        let now = io::clock::now();
        if now.saturating_since(cycle) > LONGEST_PAUSE || now < cycle {
            cycle = now;
        }
        while now.saturating_since(cycle) >= CYCLE {
            node.tick();
            cycle += CYCLE;
            observe(cycle, &node);
            server.poll(&mut node, &mut |bytes| out.extend_from_slice(bytes));
            port.send(&mut out)?;
        }
        let phase_us = now.saturating_since(cycle).as_nanos() / 1_000;
        node.set_phase_us(u32::try_from(phase_us).unwrap_or(0));
        server.input(&mut node, &received, &mut |bytes| {
            out.extend_from_slice(bytes);
        });
        port.send(&mut out)?;
    }
    Ok(())
}

impl SimulatedPort {
    /// Waits for bytes of the host; those of a bus are whole frames.
    fn receive(&mut self, mut wait: Span) -> Result<Vec<u8>, SimulatedDriveError> {
        let mut received = Vec::new();
        match self {
            Self::Serial(pty) => {
                let mut buffer = [0; 512];
                let count = pty.read(&mut buffer, wait)?.map_or(0, |(count, _)| count);
                received.extend_from_slice(buffer.get(..count).unwrap_or_default());
            }
            Self::Can(bus) => {
                while let Some((frame, _)) = bus.read(wait)? {
                    received.extend_from_slice(&frame.to_socketcan());
                    wait = Span::ZERO;
                    if received.len() >= FRAMES_A_CYCLE * SOCKETCAN_LEN {
                        break;
                    }
                }
            }
        }
        Ok(received)
    }

    /// Sends and clears `bytes`.
    fn send(&mut self, bytes: &mut Vec<u8>) -> Result<(), SimulatedDriveError> {
        match self {
            Self::Serial(_) if bytes.is_empty() => {}
            Self::Serial(pty) => match pty.write_frame(bytes) {
                // A client that does not read loses its answers, as on a real line.
                Ok(_) | Err(PortError::WriteTimeout { .. }) => {}
                Err(error) => return Err(error.into()),
            },
            Self::Can(bus) => {
                for frame in bytes.chunks(SOCKETCAN_LEN) {
                    if let Ok(frame) = CanFrame::from_socketcan(frame) {
                        bus.write_frame(&frame)?;
                    }
                }
            }
        }
        bytes.clear();
        Ok(())
    }
}
