//! A device service in the process of one command, reachable over the Unix socket that a daemon of
//! the device would have.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::config::{Config, Device};
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::service::{DeviceService, DeviceThread, Environment, Lifetime, ServiceOptions};

use crate::http::api::command_router;
use crate::http::server::Server;
use crate::http::unix_socket::UnixSocket;
use crate::limits::{LOCAL_CONNECTIONS, Waits};
use crate::sockets;

/// Task of a command on its devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalTask {
    /// Read the drive's state.
    Read,
    /// Move or stop the axis.
    Jog,
    /// Record the lidar while the axis moves.
    Capture,
}

/// A device service of one command.
pub struct LocalService {
    /// The service.
    pub service: Arc<DeviceService>,
    /// Its thread, with the warning about the port.
    pub thread: DeviceThread,
    server: Option<Server>,
}

impl LocalService {
    /// Opens the devices that `task` needs. `interrupt` stops the axis.
    ///
    /// # Errors
    /// Returns the failure of a device that cannot be opened.
    pub fn start(
        config: Config,
        (name, device): (String, Device),
        task: LocalTask,
        interrupt: &Arc<AtomicBool>,
        environment: Environment,
    ) -> Result<Self, Failure> {
        // Simulated devices belong to their command alone. A command that only reads ends at once,
        // and others wait for the port.
        let socket = match task == LocalTask::Read || profile::simulated(&device) {
            true => None,
            false => Some(sockets::folder().join(sockets::name(&name, &device)?)),
        };
        let port_owner = (name.clone(), device.clone());
        let (service, thread) = DeviceService::start(ServiceOptions {
            config,
            name,
            device,
            lifetime: Lifetime::Command {
                lidar: task == LocalTask::Capture,
                interrupt: Arc::clone(interrupt),
            },
            environment,
        })?;
        let server = socket.and_then(|socket| {
            serve(&service, &socket)
                .inspect(|_| sockets::share_with_port(&socket, &port_owner.0, &port_owner.1))
                .inspect_err(|failure| {
                    tracing::debug!("other commands cannot stop the axis: {failure}");
                })
                .ok()
        });
        Ok(Self {
            service,
            thread,
            server,
        })
    }

    /// Closes the devices and the socket, after the answers under way.
    pub fn stop(self) {
        self.service
            .shut_down(Failure::new(Kind::Interrupted, "the command has ended"));
        // A panic has been reported by the order that it ended.
        let _ = self.thread.join();
        if let Some(server) = self.server {
            server.stop(std::future::ready(()));
        }
    }
}

fn serve(service: &Arc<DeviceService>, socket: &std::path::Path) -> Result<Server, Failure> {
    let waits = Waits::default();
    let unix = UnixSocket::bind(socket)?;
    let mut server = Server::start(waits)?;
    server.accept_unix(unix, command_router(service, waits), LOCAL_CONNECTIONS)?;
    Ok(server)
}
