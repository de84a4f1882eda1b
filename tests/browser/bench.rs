//! A software scanner that the daemon takes for hardware: a drive on a pseudo-terminal, a lidar on loopback, and a hand on the axis.

use std::net::{Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use io::port::{Port, Pty};
use sim::{Rig, RigConfig};
use units::Span;
use velomotion::config::{Axis, Config, Device, DeviceKind};
use velomotion::{devices, simulated};

/// Devices that run until dropped.
pub struct Bench {
    /// A configuration that names them.
    pub config: Config,
    held: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bench {
    /// Switches them on.
    pub fn start() -> Self {
        let axis = Axis {
            brake_output: Some(1),
            ..Axis::default()
        };
        let pty = Pty::open().unwrap();
        let (data, position) = (free_port(), free_port());
        let device = Device {
            kind: DeviceKind::Usb,
            port: Some(pty.path().to_owned()),
            data_port: Some(data),
            position_port: Some(position),
            ..Device::simulator()
        };
        let config = Config {
            device: velomotion::config::Devices {
                default: Some("bench".to_owned()),
                profiles: [("bench".to_owned(), device)].into(),
            },
            axis,
            ..Config::default()
        };
        let rig = RigConfig {
            drive: simulated::node(&devices::axis(&axis).unwrap()),
            ..RigConfig::new(io::clock::now())
        };
        let (held, stop) = (Arc::default(), Arc::default());
        let (holding, stopping) = (Arc::clone(&held), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            run(Rig::new(rig), pty, (data, position), &holding, &stopping)
        });
        Self {
            config,
            held,
            stop,
            thread: Some(thread),
        }
    }

    /// A hand that holds the axis, or lets it go.
    pub fn hold(&self, held: bool) {
        self.held.store(held, Ordering::Relaxed);
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn free_port() -> u16 {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    socket.local_addr().unwrap().port()
}

fn run(
    mut rig: Rig,
    mut pty: Pty,
    (data, position): (u16, u16),
    held: &AtomicBool,
    stop: &AtomicBool,
) {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let mut buffer = [0; 512];
    let mut holding = false;
    while !stop.load(Ordering::Relaxed) {
        let nap = rig.next_event().saturating_since(io::clock::now());
        let nap = nap.clamp(Span::ZERO, Span::from_millis(1));
        let read = pty
            .read(&mut buffer, nap)
            .unwrap()
            .map_or(0, |(count, _)| count);
        rig.advance(io::clock::now());
        if held.load(Ordering::Relaxed) != holding {
            holding = !holding;
            match holding {
                true => rig.drive_mut().block(),
                false => rig.drive_mut().unblock(),
            }
        }
        rig.drive_input(&buffer[..read]);
        while let Some(sent) = rig.drive_output() {
            pty.write_frame(&sent.bytes).unwrap();
        }
        while let Some(datagram) = rig.poll_datagram() {
            let port = match datagram.port {
                velomotion::recording::DATA_PORT => data,
                _ => position,
            };
            // Nobody listens before the daemon does.
            let _ = socket.send_to(&datagram.payload, (Ipv4Addr::LOCALHOST, port));
        }
    }
}
