//! A whole capture in virtual time: the log file that the program would have written, and its
//! reconstruction.

mod log;
mod rejoin;
mod setting;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use analysis::truth::TruthReport;
use cloud::{Fields, Points};
use drive::{DriveClient, Observation};
use engine::capture::moves as motion;
use engine::capture::plan::scan_config;
use engine::capture::run_moves;
use engine::config::{AxisSettings, Config};
use engine::devices::drive_port::BusLine;
use engine::devices::drive_session::{Session, SessionError};
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::failure::Failure;
use engine::output::Target;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;
use io::can::Slcan;
use io::port::{Port, RecordingPort};
use protocol::canopen::slcan::Bitrate;
use protocol::epos2::DeviceError;
use protocol::epos2::message::WriteObject;
use protocol::epos2::rs232;
use protocol::record::{DriveLink, Record, Wire};
use scanner::{Alignment, RangeAccuracy, TiltSource};
use sim::cast::{Object, Sphere};

use sim::{Attachment, Rig, Scene};
use tempfile::TempDir;
use units::{Degrees, Host, Span, Stamp};

use crate::inject::{Fault, FaultInjector};
use crate::port::VirtualPort;
use log::{Owned, add_noise, set_lidar, write_log};
use rejoin::rejoin;

pub use rejoin::Rejoined;
pub use setting::{PacketLoss, Setting};

/// The log's name of an attachment.
#[must_use]
pub fn link(attached: Attachment) -> DriveLink {
    match attached {
        Attachment::Usb => DriveLink::Usb,
        Attachment::Rs232 => DriveLink::Rs232,
        Attachment::Slcan | Attachment::Can => DriveLink::Can,
    }
}

/// A finished capture.
pub struct Captured {
    link: DriveLink,
    folder: TempDir,
    records: usize,
    data_packets: u64,
    lost_packets: (u64, u64),
    rejoined: Option<Rejoined>,
    truth: sim::Truth,
}

/// Bytes that identify a record.
enum Mark {
    /// The whole record.
    Whole(Vec<u8>),
    /// A part of the record.
    Within(Vec<u8>),
}

impl Mark {
    fn is_in(&self, frame: &[u8]) -> bool {
        match self {
            Self::Whole(bytes) => bytes == frame,
            Self::Within(bytes) => frame.windows(bytes.len()).any(|part| part == bytes),
        }
    }
}

impl Captured {
    /// Runs a capture that must succeed.
    #[must_use]
    pub fn new(setting: Setting) -> Self {
        let (captured, ended) = Self::run(setting);
        ended.unwrap();
        captured
    }

    /// Runs a capture. Returns it with its result.
    pub fn run(setting: Setting) -> (Self, Result<(), SessionError>) {
        // With the brake of the repository's configuration.
        let mut axis = devices::axis(&AxisSettings {
            brake_output: Some(1),
            ..AxisSettings::default()
        })
        .unwrap();
        axis.timing.poll_period = setting.poll_period.unwrap_or(axis.timing.poll_period);
        let steps = motion::steps(&setting.sweep_request, &axis, Degrees(0.0)).unwrap();
        let mut config = scan_config(
            &Config::default(),
            "sim",
            true,
            &setting.sweep_request,
            &steps,
        );
        config.rs232_baud = (setting.links.attached == Attachment::Rs232).then_some(115_200);
        let mut rig = simulated::rig(&axis, &config, setting.start);
        if let Some(range_sd_m) = setting.range_sd_m {
            config.lidar = RangeAccuracy { range_sd_m };
        }
        rig.lidar.clock_at_start_us = setting.lidar_clock_us;
        rig.lidar.rpm = setting.lidar_rpm;
        if let Some(radius_m) = setting.sphere_m {
            let sphere = Object::new(Sphere { radius_m });
            rig.scene = Arc::new(Scene::new().with(sphere, 50).unwrap());
        }
        rig.attached = setting.links.attached;
        rig.drive.servo = setting.servo;
        rig.drive.latches_position = setting.latches_position;
        rig.ripple = setting.ripple;
        if setting.links.attached != Attachment::Usb && setting.links.attached != Attachment::Rs232
        {
            // A unit on a CAN bus reports no error at power-on.
            rig.drive.fault_at_power_on = DeviceError::NONE;
        }
        let port = VirtualPort::new(Rig::new(rig), setting.start, setting.links);

        let drive: Rc<RefCell<Vec<Owned>>> = Rc::default();
        let sink = Rc::clone(&drive);
        let (fault, fault_after) = setting
            .fault
            .unwrap_or((Fault::AnswersLost(Span::ZERO), Span::ZERO));
        let hurt = FaultInjector::new(
            port.clone(),
            setting.links.attached,
            fault,
            setting.start + fault_after,
            setting.links.seed,
        );
        let link = link(setting.links.attached);
        let line: Box<dyn Port> = match setting.links.attached {
            Attachment::Slcan => Box::new(BusLine(Slcan::open(hurt, Bitrate::Kbit1000).unwrap())),
            Attachment::Usb | Attachment::Rs232 | Attachment::Can => Box::new(hurt),
        };
        let recorder = RecordingPort::new(line, link, move |record: &Record<'_>| {
            if let Wire::Drive {
                link,
                direction,
                frame,
            } = record.wire
            {
                sink.borrow_mut().push(Owned {
                    host: record.host,
                    link,
                    direction,
                    frame: frame.to_vec(),
                });
            }
        });
        let client = DriveClient::new(axis.clone(), link);
        let interrupt = Arc::new(AtomicBool::new(false));
        if let Some(after) = setting.interrupt_after {
            port.interrupt_at(setting.start + after, Arc::clone(&interrupt));
        }
        let mut session = Session::new(client, recorder, interrupt);
        let ended = run_moves::run(&mut session, &steps, &mut |_| {});
        drop(session);
        // The lidar runs on for a moment, as in a capture.
        let mut tail = port.clone();
        io::port::Port::read(&mut tail, &mut [0; 1], Span::from_millis(20)).unwrap();
        let ended_at = tail.now() + Span::from_millis(20);

        let rejoined = setting
            .rejoined_after
            .map(|after| rejoin(&port, (axis, link), setting.links.attached, after));
        let (mut packets, truth) = port.end();
        packets.retain(|packet| packet.host <= ended_at);
        let lost_packets = setting.packets_lost.map_or((0, 0), |loss| {
            loss.drop_packets(&mut packets, setting.start, setting.links.seed)
        });
        if let Some(range_sd_m) = setting.range_sd_m {
            add_noise(&mut packets, range_sd_m, setting.links.seed);
        }
        if let Some((after, by)) = setting.lidar_set {
            set_lidar(&mut packets, setting.start + after, by);
        }
        let folder = tempfile::tempdir().unwrap();
        let drive = drive.take();
        let records = write_log(
            &folder.path().join("scan.pcapng"),
            &config,
            link,
            &drive,
            &packets,
            setting
                .host_set
                .map(|(after, by)| (setting.start + after, by)),
        );
        let data_packets = packets
            .iter()
            .filter(|p| p.datagram.port == sim::DATA_PORT)
            .count() as u64;
        let captured = Self {
            link,
            folder,
            records,
            data_packets,
            lost_packets,
            rejoined,
            truth,
        };
        (captured, ended)
    }

    /// Path of the log file.
    #[must_use]
    pub fn log(&self) -> PathBuf {
        self.folder.path().join("scan.pcapng")
    }

    /// Number of records in the log.
    #[must_use]
    pub fn records(&self) -> usize {
        self.records
    }

    /// Number of lidar data packets in the log.
    #[must_use]
    pub fn data_packets(&self) -> u64 {
        self.data_packets
    }

    /// Number of data packets that the network lost.
    #[must_use]
    pub fn lost_packets(&self) -> u64 {
        self.lost_packets.0
    }

    /// Number of lost packets between two received ones.
    #[must_use]
    pub fn missed_packets(&self) -> u64 {
        self.lost_packets.1
    }

    /// Motion of the drive until the next client had it.
    #[must_use]
    pub fn rejoined(&self) -> Option<Rejoined> {
        self.rejoined
    }

    /// Whether the last statusword in the log shows the power stage off, so that the brake holds.
    #[must_use]
    pub fn brake_is_set(&self) -> bool {
        use drive::cia402::DeviceState;
        let mut last = None;
        self.listen(&mut |seen| {
            if let Observation::Statusword { value, .. } = seen {
                last = DeviceState::from_statusword(value);
            }
        });
        // An axis that was interrupted before its power stage was first on has no brake to set.
        !matches!(
            last,
            Some(
                DeviceState::OperationEnabled
                    | DeviceState::QuickStopActive
                    | DeviceState::FaultReactionEnabled
            )
        )
    }

    /// Time of the first quick stop after `begin`, answered or not.
    #[must_use]
    pub fn stop_sent(&self, begin: Stamp<Host>) -> Option<Stamp<Host>> {
        let stop = [
            drive::cia402::control::QUICK_STOP,
            drive::cia402::control::DISABLE_VOLTAGE,
        ];
        let wanted: Vec<_> = stop.iter().flat_map(|word| self.control(*word)).collect();
        let mut recording = io::recording::Recording::open(self.log()).unwrap();
        while let Some(record) = recording.next_record().unwrap() {
            if let Wire::Drive { frame, .. } = record.wire
                && record.host >= begin
                && wanted.iter().any(|wanted| wanted.is_in(frame))
            {
                return Some(record.host);
            }
        }
        None
    }

    /// Bytes that identify a write of the controlword.
    fn control(&self, word: u16) -> Vec<Mark> {
        let write = WriteObject {
            node: 1,
            address: drive::objects::CONTROLWORD.address,
            value: u32::from(word),
        };
        match self.link {
            DriveLink::Usb => {
                let bytes = protocol::epos2::usb::to_bytes(&write.to_frame());
                vec![Mark::Whole(bytes.to_vec())]
            }
            // If the unit answers the opcode, the body follows, and nothing else is written while
            // the axis moves. Otherwise the body is sent without waiting.
            DriveLink::Rs232 => {
                let mut body = Vec::new();
                rs232::encode_body(&write.to_frame(), &mut body).unwrap();
                vec![Mark::Whole(vec![WriteObject::OPCODE]), Mark::Within(body)]
            }
            // SDO download of two bytes (CiA 301, 7.2.4.3.3).
            DriveLink::Can => {
                let [low, high] = word.to_le_bytes();
                vec![Mark::Within(vec![0x2B, 0x40, 0x60, 0x00, low, high, 0, 0])]
            }
        }
    }

    /// End of the last sweep that the drive received and finished.
    #[must_use]
    pub fn last_sweep_end(&self) -> Option<Stamp<Host>> {
        self.sweep_spans().last().map(|span| span.1)
    }

    /// Begin and end of each sweep that the drive received and finished; none of a log without a
    /// cloud.
    #[must_use]
    pub fn sweep_spans(&self) -> Vec<(Stamp<Host>, Stamp<Host>)> {
        let sweeps = self.try_alignment().map(|alignment| alignment.sweeps);
        let sweeps = sweeps.unwrap_or_default();
        sweeps
            .iter()
            .map(|sweep| (sweep.start, sweep.end))
            .collect()
    }

    fn try_alignment(&self) -> Option<Alignment> {
        let source = Source::open(&self.log(), None).ok()?;
        let mut survey =
            scanner::Survey::new(&source.config().ok()?, lidar::Options::default()).ok()?;
        source
            .read(|record| {
                survey.observe(record);
                Ok(())
            })
            .ok()?;
        let config = source.config().ok()?;
        survey
            .solve(&config, &TiltSource::Log, scanner::Accuracy::Best)
            .ok()
    }

    /// Begin and end of the first sweep.
    #[must_use]
    pub fn sweep_span(&self) -> (Stamp<Host>, Stamp<Host>) {
        let cloud = self.cloud();
        let times = cloud.time();
        (*times.first().unwrap(), *times.last().unwrap())
    }

    fn listen(&self, emit: &mut impl FnMut(Observation)) {
        let mut listener = drive::DriveListener::new(1);
        let mut recording = io::recording::Recording::open(self.log()).unwrap();
        while let Some(record) = recording.next_record().unwrap() {
            if let Wire::Drive {
                link,
                direction,
                frame,
            } = record.wire
            {
                listener.observe(link, direction, frame, record.host, emit);
            }
        }
    }

    /// The truth of the devices.
    #[must_use]
    pub fn truth(&self) -> &sim::Truth {
        &self.truth
    }

    /// The cloud in memory with every column.
    #[must_use]
    pub fn cloud(&self) -> Points {
        self.scan().1
    }

    /// The report and the cloud.
    #[must_use]
    pub fn scan(&self) -> (ScanReport, Points) {
        self.try_scan().unwrap()
    }

    /// The report and the cloud.
    ///
    /// # Errors
    /// Returns the failure if the log holds no cloud.
    pub fn try_scan(&self) -> Result<(ScanReport, Points), Failure> {
        let mut points = Points::new(Fields::ALL);
        let request = Reconstruction {
            recording: &Source::open(&self.log(), None).unwrap(),
            tilt: TiltSource::Log,
            options: lidar::Options::default(),
            time: engine::reconstruct::replay::TimeReference::Host,
            accuracy: scanner::Accuracy::Best,
            pace: None,
            truth: None,
            live: false,
            lost_records: 0,
            georeference: None,
            interrupt: &AtomicBool::new(false),
        };
        let scan = replay::scan(&request, &mut points, Path::new("memory"))?;
        Ok((scan, points))
    }

    /// Distances between the cloud and the truth.
    #[must_use]
    pub fn error(&self) -> TruthReport {
        let truth = |time: Stamp<units::Lidar>, laser| self.truth.point(time.as_nanos(), laser);
        analysis::truth::compare(&self.cloud(), truth).unwrap()
    }

    /// Writes the cloud next to the log.
    #[must_use]
    pub fn cloud_file(&self, name: &str) -> PathBuf {
        self.file(name, TiltSource::Log)
    }

    /// Writes every return in the sensor frame next to the log.
    #[must_use]
    pub fn sensor_frame(&self, name: &str) -> PathBuf {
        self.file(name, TiltSource::None)
    }

    fn file(&self, name: &str, tilt: TiltSource) -> PathBuf {
        let path = self.folder.path().join(name);
        let request = Reconstruction {
            recording: &Source::open(&self.log(), None).unwrap(),
            tilt,
            options: lidar::Options::default(),
            time: engine::reconstruct::replay::TimeReference::Host,
            accuracy: scanner::Accuracy::Best,
            pace: None,
            truth: None,
            live: false,
            lost_records: 0,
            georeference: None,
            interrupt: &AtomicBool::new(false),
        };
        replay::make(&request, Target::open(&path, Fields::FILE, false).unwrap()).unwrap();
        path
    }
}
