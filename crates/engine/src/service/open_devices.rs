//! Opening the devices: the drive's port, the lidar's sockets, and simulated devices.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use io::udp::ListenConfig;

use super::device_thread::{Backoff, Worker};
use super::drive_connection::DriveConnection;
use super::events::MessageLevel;
use super::status::{DeviceHealth, DriveSnapshot};
use super::{DeviceService, Lifetime};
use crate::config::DeviceKind;
use crate::devices::drive_port::{self, GuardianOptions, Search};
use crate::devices::lidar_receiver::LidarReceiver;
use crate::devices::lidar_sockets::{LidarSockets, listen_config};
use crate::devices::simulated::{self, LidarPorts, SimulatedDevices};
use crate::failure::{Failure, Kind};
use crate::reconstruct::contents::link_name;

/// UDP port that nothing reads (discard, RFC 863), for a simulated lidar that is not needed.
const DISCARD: LidarPorts = LidarPorts {
    data: 9,
    position: 9,
};

impl Worker {
    /// Opens the devices of one command.
    pub(super) fn open_once(&mut self, lidar: bool) -> Result<DriveConnection, Failure> {
        let service = Arc::clone(&self.service);
        if service.simulated() && !lidar {
            self.simulated = Some(SimulatedDevices::start(rig(&service), DISCARD)?);
            return self.open_drive();
        }
        if service.simulated() {
            self.open_lidar()?;
            return self.open_drive();
        }
        // A drive that is not found is reported before a lidar that cannot be listened to.
        let place = drive_port::port_path(
            &service.name,
            &service.device,
            Search::Once,
            &*service.environment.plugged,
        )?;
        if lidar {
            self.open_lidar()?;
        }
        self.open_port(&place)
    }

    /// Makes sure that the lidar's sockets are open and simulated devices run.
    pub(super) fn keep_lidar_open(&mut self) {
        let receiver = self.service.receiver();
        if receiver.is_some_and(|receiver| receiver.is_sound())
            && !self
                .simulated
                .as_ref()
                .is_some_and(SimulatedDevices::failed)
        {
            return;
        }
        if !self.lidar_retry.left().is_zero() {
            return;
        }
        match self.open_lidar() {
            Ok(()) => self.lidar_retry = Backoff::new(),
            Err(failure) => {
                self.lidar_retry.failed();
                self.service.set_receiver(None);
                self.service.update_lidar(|lidar| {
                    lidar.state = DeviceHealth::Fault;
                    lidar.problem = Some(failure);
                });
            }
        }
    }

    fn open_lidar(&mut self) -> Result<(), Failure> {
        let service = Arc::clone(&self.service);
        // The old sockets are closed first: the new ones may have the same ports.
        service.set_receiver(None);
        let config = match service.simulated() {
            true => ListenConfig {
                address: service.device.lidar,
                data_port: 0,
                position_port: Some(0),
                ..ListenConfig::default()
            },
            false => listen_config(&service.device),
        };
        let sockets = LidarSockets::bind(&config)?;
        if service.simulated() {
            let started = SimulatedDevices::start(rig(&service), sockets.ports)?;
            if let Some(old) = self.simulated.replace(started) {
                drop(old.stop());
            }
        }
        let receiver = LidarReceiver::start(sockets, service.packet_tap())?;
        service.set_receiver(Some(Arc::new(receiver)));
        Ok(())
    }

    pub(super) fn open_drive(&self) -> Result<DriveConnection, Failure> {
        let service = &self.service;
        let place = match &self.simulated {
            Some(devices) => devices.port.clone(),
            None if service.device.kind == DeviceKind::Sim => {
                return Err(
                    Failure::new(Kind::NoDevice, "the simulated devices do not run")
                        .help("see the status of the lidar"),
                );
            }
            None => drive_port::port_path(
                &service.name,
                &service.device,
                Search::UntilFound,
                &*service.environment.plugged,
            )?,
        };
        self.open_port(&place)
    }

    fn open_port(&self, place: &std::path::Path) -> Result<DriveConnection, Failure> {
        let service = &self.service;
        let opened = drive_port::open(
            &service.device,
            place,
            service
                .environment
                .guardian
                .as_deref()
                .map(|program| GuardianOptions {
                    program,
                    axis: &service.config.axis,
                })
                .as_ref(),
        )?;
        service.update_drive(|drive| {
            drive.port = Some(place.display().to_string());
            drive.link = Some(link_name(opened.link));
        });
        if let Some(warning) = &opened.warning {
            let events = service.events();
            events.message(MessageLevel::Warning, warning.clone(), None);
        }
        service.connects.fetch_add(1, Ordering::Relaxed);
        let stale = matches!(service.lifetime, Lifetime::Resident);
        Ok(DriveConnection::new(opened, stale))
    }

    /// Forgets what is known of a drive that is absent, or may be another one.
    pub(super) fn drive_absent(&self, problem: Option<Failure>) {
        self.service.set_report(None);
        self.service.update_drive(|drive| {
            *drive = DriveSnapshot {
                state: DeviceHealth::Absent,
                problem,
                port: drive.port.take(),
                ..DriveSnapshot::default()
            };
        });
    }

    /// Closes the lidar's sockets, which are opened again. Simulated devices go on.
    pub(super) fn forget_lidar(&self) {
        if self.simulated.is_none() && matches!(self.service.lifetime, Lifetime::Resident) {
            self.service.set_receiver(None);
        }
    }
}

fn rig(service: &DeviceService) -> sim::RigConfig {
    let scan = scanner::ScanConfig {
        mount: service.config.mount.pose(),
        ..scanner::ScanConfig::default()
    };
    simulated::rig(&service.axis, &scan, io::clock::now())
}
