//! Options of a service.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use io::discover::ConnectedDevices;
use units::Span;

use super::status::AxisTask;
use crate::config::{Config, Device};

/// Functions of the machine. Tests replace them.
#[derive(Clone)]
pub struct Environment {
    /// Lists the devices that are plugged in.
    pub plugged: Arc<dyn Fn() -> ConnectedDevices + Send + Sync>,
    /// Time that the machine has been suspended since it was booted.
    pub suspended: Arc<dyn Fn() -> Span + Send + Sync>,
    /// Program of the guardian process, which stops the axis on USB and RS232 if this process dies
    /// or hangs: started with [`guardian::ARGUMENT`](crate::devices::guardian::ARGUMENT), it calls
    /// [`guardian::run`](crate::devices::guardian::run).
    pub guardian: Option<PathBuf>,
    /// Called on the device thread at every heartbeat.
    pub heartbeat: Arc<dyn Fn(AxisTask) + Send + Sync>,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            plugged: Arc::new(io::discover::discover),
            suspended: Arc::new(io::clock::suspended),
            guardian: None,
            heartbeat: Arc::new(|_| {}),
        }
    }
}

/// Period for which the service keeps its devices.
#[derive(Clone)]
pub enum Lifetime {
    /// Until it ends: absent devices are waited for, lost ones are opened again.
    Resident,
    /// For one command: devices are opened once, at the start, and errors end the command.
    Command {
        /// Whether the lidar is needed.
        lidar: bool,
        /// Flag that stops the axis, such as that of Ctrl-C.
        interrupt: Arc<AtomicBool>,
    },
}

/// Parts of a service.
pub struct ServiceOptions {
    /// The configuration.
    pub config: Config,
    /// Name of the device's profile.
    pub name: String,
    /// The device.
    pub device: Device,
    /// Period for which the devices are kept.
    pub lifetime: Lifetime,
    /// The machine.
    pub environment: Environment,
}
