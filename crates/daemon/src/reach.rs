//! How the keeper reaches the devices: the drive's port, the lidar's sockets, and the software ones. Left out: when it tries.

use std::sync::Arc;

use io::udp::ListenConfig;
use protocol::record::DriveLink;

use super::hub::Level;
use super::keeper::{Backoff, Keeper};
use super::line::Line;
use super::shared::Counters;
use super::view::{DeviceState, DriveView};
use engine::config::DeviceKind;
use engine::devices::drive_port::{self as ports, Looks};
use engine::devices::lidar_receiver::LidarReceiver;
use engine::devices::lidar_sockets::LidarSockets;
use engine::devices::simulated::{self, Simulated};
use engine::failure::{Failure, Kind};

impl Keeper {
    /// Makes sure that the lidar is listened to, and that software devices run.
    pub(super) fn listen(&mut self) {
        if self
            .shared
            .hearing()
            .is_some_and(|hearing| hearing.is_sound())
            && !self.devices.as_ref().is_some_and(Simulated::failed)
        {
            return;
        }
        if !self.lidar_again.left().is_zero() {
            return;
        }
        match self.start_listening() {
            Ok(()) => self.lidar_again = Backoff::new(),
            Err(failure) => {
                self.lidar_again.failed();
                self.shared.set_hearing(None);
                self.shared.set_lidar(|lidar| {
                    lidar.state = DeviceState::Fault;
                    lidar.problem = Some(failure);
                });
            }
        }
    }

    fn start_listening(&mut self) -> Result<(), Failure> {
        let simulated = self.shared.simulated();
        // The old sockets first: the new ones may be the same.
        self.shared.set_hearing(None);
        let config = match simulated {
            true => ListenConfig {
                address: self.shared.device.lidar,
                data_port: 0,
                position_port: Some(0),
                ..ListenConfig::default()
            },
            false => self.shared.listen_config(),
        };
        let ear = LidarSockets::bind(&config)?;
        if simulated {
            let scan = scanner::ScanConfig {
                mount: self.shared.config.mount,
                ..scanner::ScanConfig::default()
            };
            let rig = simulated::rig(&self.axis, &scan, io::clock::now());
            if let Some(old) = self.devices.replace(Simulated::start(rig, ear.ports())?) {
                drop(old.stop());
            }
        }
        let shared = Arc::clone(&self.shared);
        let hearing = LidarReceiver::start(
            ear,
            Box::new(move |record| {
                shared
                    .monitor
                    .lock()
                    .unwrap_or_else(std::sync::PoisonError::into_inner)
                    .observe(record);
                shared.feed.record(record);
            }),
        )?;
        self.shared.set_hearing(Some(Arc::new(hearing)));
        Ok(())
    }

    pub(super) fn open(&self) -> Result<Line, Failure> {
        let place = match &self.devices {
            Some(devices) => devices.port().to_owned(),
            None if self.shared.device.kind == DeviceKind::Sim => {
                return Err(
                    Failure::new(Kind::NoDevice, "the software devices do not run")
                        .help("see what is said of the lidar"),
                );
            }
            None => ports::place(
                &self.shared.name,
                &self.shared.device,
                Looks::On,
                &*self.shared.world.plugged,
            )?,
        };
        let opened = ports::open(&self.shared.device, &place)?;
        self.shared.set_drive(|drive| {
            drive.port = Some(place.display().to_string());
            drive.link = Some(match opened.link {
                DriveLink::Usb => "usb",
                DriveLink::Rs232 => "rs232",
                DriveLink::Can => "can",
            });
        });
        if let Some(warning) = &opened.warning {
            self.shared.hub.say(Level::Warning, warning.clone(), None);
        }
        Counters::count(&self.shared.counters.connects);
        Ok(Line::new(opened))
    }

    /// The drive is not there.
    pub(super) fn absent(&self, failure: Failure) {
        self.unknown(Some(failure));
    }

    /// Nothing holds of the devices any more: cables may have come out, and the axis may have been moved by hand. Software goes on as it was.
    pub(super) fn forget(&self) {
        self.unknown(None);
        self.forget_lidar();
    }

    pub(super) fn forget_lidar(&self) {
        if self.devices.is_none() {
            self.shared.set_hearing(None);
        }
    }

    fn unknown(&self, problem: Option<Failure>) {
        // Whoever comes back may have been without power.
        self.shared.set_report(None);
        self.shared.set_drive(|drive| {
            *drive = DriveView {
                state: DeviceState::Absent,
                problem,
                port: drive.port.take(),
                ..DriveView::default()
            };
        });
    }
}
