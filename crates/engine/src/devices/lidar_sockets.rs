//! The lidar's UDP sockets.

use io::udp::{LidarListener, ListenConfig};

use crate::config::Device;
use crate::devices::lidar_receiver::lidar_failure;
use crate::devices::simulated::LidarPorts;
use crate::failure::Failure;

/// UDP port of data packets (VLP-16 manual, section 9).
pub const DATA_PORT: u16 = 2368;
/// UDP port of position packets.
pub const POSITION_PORT: u16 = 8308;

/// The lidar's bound sockets.
pub struct LidarSockets {
    pub(crate) listener: LidarListener,
    /// The local ports.
    pub ports: LidarPorts,
}

/// Network settings of a device's lidar.
#[must_use]
pub fn listen_config(device: &Device) -> ListenConfig {
    ListenConfig {
        address: device.lidar,
        data_port: device.data_port.unwrap_or(DATA_PORT),
        position_port: Some(device.position_port.unwrap_or(POSITION_PORT)),
        group: device.lidar_group,
        sources: device.lidar_source.into_iter().collect(),
        ..ListenConfig::default()
    }
}

impl LidarSockets {
    /// Binds the sockets.
    ///
    /// # Errors
    /// Returns [`Kind::NoDevice`](crate::failure::Kind::NoDevice) if another program has the ports,
    /// or the address is not this machine's.
    pub fn bind(config: &ListenConfig) -> Result<Self, Failure> {
        let listener = LidarListener::bind(config).map_err(|error| lidar_failure(&error))?;
        let mut local = listener.sockets().iter().map(|s| s.address.port());
        let ports = LidarPorts {
            data: local.next().unwrap_or(DATA_PORT),
            position: local.next().unwrap_or(POSITION_PORT),
        };
        Ok(Self { listener, ports })
    }
}
