//! The software EPOS2 alone, in real time: its control cycle follows the host's clock, its frames come and go on a pseudo-terminal.

use std::sync::atomic::{AtomicBool, Ordering};

use firmware_sim::epos2::{Node, NodeConfig, Rs232Server, UsbServer};
use io::port::{Port, PortError, Pty};
use units::{Host, Span, Stamp};

/// What it speaks.
pub enum Server {
    /// EPOS2 USB frames.
    Usb(UsbServer),
    /// EPOS2 RS232 frames.
    Rs232(Rs232Server),
}

const CYCLE: Span = Span::from_millis(1);
/// After a pause longer than this (a suspended machine) the drive goes on from now instead of living through it.
const LONGEST_PAUSE: Span = Span::from_secs(1);

/// Runs the drive on `pty` until `stop`.
///
/// # Errors
/// Where the pseudo-terminal fails.
pub fn run(
    config: NodeConfig,
    mut server: Server,
    pty: &mut Pty,
    stop: &AtomicBool,
) -> Result<(), PortError> {
    let mut node = Node::new(config);
    let mut cycle: Stamp<Host> = io::clock::now();
    let mut buffer = [0; 512];
    while !stop.load(Ordering::Relaxed) {
        let wait = (cycle + CYCLE).saturating_since(io::clock::now());
        let read = pty
            .read(&mut buffer, wait.clamp(Span::ZERO, CYCLE))?
            .map_or(0, |(count, _)| count);
        let now = io::clock::now();
        if now.saturating_since(cycle) > LONGEST_PAUSE || now < cycle {
            cycle = now;
        }
        while now.saturating_since(cycle) >= CYCLE {
            node.tick();
            cycle += CYCLE;
        }
        let phase_us = now.saturating_since(cycle).as_nanos() / 1_000;
        node.set_phase_us(u32::try_from(phase_us).unwrap_or(0));
        let mut answers: Vec<u8> = Vec::new();
        let bytes = buffer.get(..read).unwrap_or_default();
        let mut answer = |bytes: &[u8]| answers.extend_from_slice(bytes);
        match &mut server {
            Server::Usb(server) => server.input(&mut node, bytes, &mut answer),
            Server::Rs232(server) => server.input(&mut node, bytes, &mut answer),
        }
        if !answers.is_empty() {
            match pty.write_frame(&answers) {
                // A client that does not read loses its answers, as on a real line.
                Ok(_) | Err(PortError::WriteTimeout { .. }) => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(())
}
