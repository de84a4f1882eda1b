//! `velomotion info`: what a log or recording holds.

use io::recording::{DatagramKind, Sensor};
use lidar::{Decoder, Options, Stats, UtcClock, UtcState};
use protocol::record::{DriveLink, Record, Wire};
use protocol::vlp16::{PositionPacket, Pps, ReturnMode};
use scanner::steps::{ClockStep, SetClock};
use scanner::{ScanConfig, Survey};

use super::failures::scan_failure;
use crate::failure::Failure;
use crate::reconstruct::report::{Contents, Gps, Packets, SensorReport, Tilt};
use crate::reconstruct::source::{self as recordings, Pass, Source};

/// Reads the whole recording and lists what it holds, with the error of a file that ends early.
///
/// # Errors
/// [`Kind::BadInput`](crate::failure::Kind::BadInput) for a file that is not a recording.
pub fn read_contents(
    source: &Source,
    options: Options,
) -> Result<(Contents, Option<String>), Failure> {
    let config = source.config()?;
    let mut ears = Ears::new(options.clone());
    let mut survey =
        Survey::new(&config, options).map_err(|error| scan_failure(source.path(), &error))?;
    let pass = source.read_all(|record| {
        ears.hear(record);
        if ears.is_of_the_first(record) {
            survey.observe(record);
        }
        Ok(())
    })?;
    let contents = ears.contents(&config, survey.drive(), &pass, &survey.steps());
    Ok((contents, pass.truncated))
}

/// One ear a sensor.
struct Ears {
    options: Options,
    ears: Vec<Ear>,
    /// For what is no sensor's.
    rest: Decoder,
}

/// Listens to one sensor.
struct Ear {
    source: [u8; 4],
    /// Of its data; `None` until one came.
    port: Option<u16>,
    decoder: Decoder,
    utc: UtcClock,
    pps: Option<Pps>,
}

/// Sensors that are listened to; of more, only the packets are counted.
const MOST_SENSORS: usize = 64;

impl Ears {
    fn new(options: Options) -> Self {
        Self {
            options: options.clone(),
            ears: Vec::new(),
            rest: Decoder::new(options),
        }
    }

    fn hear(&mut self, record: &Record<'_>) {
        let Wire::Lidar {
            source,
            port,
            payload,
        } = record.wire
        else {
            return;
        };
        match DatagramKind::of(payload) {
            DatagramKind::Position => {
                if !self.ears.iter().any(|ear| ear.source == source) {
                    self.add(source, None);
                }
                for ear in self.ears.iter_mut().filter(|ear| ear.source == source) {
                    ear.position(record, payload);
                }
            }
            DatagramKind::Data => match self.ear(source, port) {
                Some(ear) => ear.data(record, payload),
                None => self.rest.packet(record.host, payload, &mut |_| {}),
            },
            // A stranger with a lidar's marks is no sensor of its own.
            DatagramKind::Damaged => {
                let known = |ear: &&mut Ear| ear.source == source && ear.port == Some(port);
                match self.ears.iter_mut().find(known) {
                    Some(ear) => ear.data(record, payload),
                    None => self.rest.packet(record.host, payload, &mut |_| {}),
                }
            }
            DatagramKind::Foreign => self.rest.packet(record.host, payload, &mut |_| {}),
        }
    }

    /// Whether a record is of the drive, or of the lidar that the report is of.
    fn is_of_the_first(&self, record: &Record<'_>) -> bool {
        match record.wire {
            Wire::Drive { .. } => true,
            Wire::Lidar { source, port, .. } => self
                .first()
                .is_some_and(|ear| ear.source == source && ear.port.is_none_or(|own| own == port)),
        }
    }

    /// The sensor that the report is of: the first that sent data, else the first that sent anything.
    fn first(&self) -> Option<&Ear> {
        let with_data = self.ears.iter().find(|ear| ear.port.is_some());
        with_data.or(self.ears.first())
    }

    /// Of the sensor that sends data from `source` to `port`.
    fn ear(&mut self, source: [u8; 4], port: u16) -> Option<&mut Ear> {
        let is = |wanted: Option<u16>| move |ear: &Ear| ear.source == source && ear.port == wanted;
        let at = self.ears.iter().position(is(Some(port)));
        // What sent position packets before its data.
        let at = at.or_else(|| self.ears.iter().position(is(None)));
        let at = match at {
            Some(at) => at,
            None => self.add(source, Some(port))?,
        };
        let ear = self.ears.get_mut(at)?;
        ear.port = Some(port);
        Some(ear)
    }

    fn add(&mut self, source: [u8; 4], port: Option<u16>) -> Option<usize> {
        if self.ears.len() >= MOST_SENSORS {
            return None;
        }
        self.ears.push(Ear {
            source,
            port,
            decoder: Decoder::new(self.options.clone()),
            utc: UtcClock::new(),
            pps: None,
        });
        Some(self.ears.len() - 1)
    }

    /// What was heard: of the first sensor, and where there are several, of each.
    fn contents(
        mut self,
        config: &ScanConfig,
        drive: Option<(DriveLink, u64)>,
        pass: &Pass,
        steps: &[ClockStep],
    ) -> Contents {
        for ear in &mut self.ears {
            ear.decoder.finish(&mut |_| {});
        }
        let sensor = |ear: &Ear| -> Option<Sensor> {
            let known = |s: &&Sensor| s.source == ear.source && s.data_port == ear.port;
            pass.sensors.iter().find(known).cloned()
        };
        let nothing = Stats::default();
        let first = self.first();
        let mut contents = contents(
            config,
            first.map_or(&nothing, |ear| ear.decoder.stats()),
            drive,
            pass,
            steps,
        );
        contents.gps = first.and_then(Ear::gps);
        let strange = self.rest.stats();
        contents.packets.malformed += strange.malformed;
        if let Some(error) = &strange.first_malformed {
            contents.warnings.push(format!(
                "{} packets that look like a lidar's are of no lidar here, the first: {error}",
                strange.malformed
            ));
        }
        if self.ears.len() > 1 {
            contents.sensors = self
                .ears
                .iter()
                .filter_map(|ear| {
                    let name = recordings::name(&sensor(ear)?).to_string();
                    Some(SensorReport::new(name, ear.decoder.stats(), ear.gps()))
                })
                .collect();
        }
        contents
    }
}

impl Ear {
    fn data(&mut self, record: &Record<'_>, payload: &[u8]) {
        let utc = &mut self.utc;
        self.decoder.packet(record.host, payload, &mut |firing| {
            utc.data(firing.start);
        });
    }

    fn position(&mut self, record: &Record<'_>, payload: &[u8]) {
        self.decoder.packet(record.host, payload, &mut |_| {});
        if let Ok(packet) = PositionPacket::new(payload) {
            self.pps = Some(packet.pps());
            self.utc.position(record.host, &packet);
        }
    }

    /// What is known of the receiver; `None` without position packets.
    fn gps(&self) -> Option<Gps> {
        let pps = self.pps?;
        let state = self.utc.state();
        let locked = matches!(state, UtcState::Locked { .. });
        let said = match self.utc.ends() {
            ends if locked && ends > 0 => format!("{state}; the lock was lost {ends} times before"),
            _ => state.to_string(),
        };
        Some(Gps {
            pps: pps_name(pps),
            locked,
            state: said,
        })
    }
}

fn pps_name(pps: Pps) -> String {
    match pps {
        Pps::Absent => "absent".to_owned(),
        Pps::Synchronising => "synchronising".to_owned(),
        Pps::Locked => "locked".to_owned(),
        Pps::Error => "error".to_owned(),
        Pps::Unknown(byte) => format!("unknown (0x{byte:02x})"),
    }
}

/// What was found, for the report.
#[must_use]
pub fn contents(
    config: &ScanConfig,
    stats: &Stats,
    drive: Option<(DriveLink, u64)>,
    pass: &Pass,
    steps: &[ClockStep],
) -> Contents {
    let counts = &pass.counts;
    let tilt = drive.map(|(link, samples)| Tilt {
        samples,
        transport: transport(link).to_owned(),
    });
    Contents {
        model: stats.model.map(|model| model.name.to_owned()),
        return_mode: stats.return_mode.map(return_mode_name),
        packets: Packets {
            data: stats.data,
            position: stats.position,
            malformed: stats.malformed + counts.malformed,
            other: stats.other + counts.other + counts.fragments,
        },
        gps: None,
        sensors: Vec::new(),
        returns: stats.returns,
        lost_packets: stats.lost_packets,
        duration_s: stats.duration.as_secs_f64(),
        rpm: stats.rpm,
        tilt,
        truncated: pass.truncated.clone(),
        simulated: config.simulated,
        warnings: warnings(stats, pass, steps),
    }
}

fn warnings(stats: &Stats, pass: &Pass, steps: &[ClockStep]) -> Vec<String> {
    let mut warnings: Vec<String> = stats.conflicts.iter().map(ToString::to_string).collect();
    warnings.extend(steps.iter().map(ToString::to_string));
    let lidar_was_set = steps.iter().any(|step| step.clock == SetClock::Lidar);
    if let Some(malformed) = &pass.counts.first_malformed {
        warnings.push(format!(
            "{} records are damaged, the first at byte {}: {}",
            pass.counts.malformed, malformed.offset, malformed.fault
        ));
    }
    if let Some(error) = &stats.first_malformed {
        warnings.push(format!(
            "{} lidar packets are damaged, the first: {error}",
            stats.malformed
        ));
    }
    let said = [
        (stats.lost_packets, "lidar packets are missing"),
        (
            stats.duplicates,
            "lidar packets came twice and were used once",
        ),
        (
            stats.reordered,
            "lidar packets came out of order and were put back",
        ),
        (
            stats.late,
            "lidar packets came too late to be put back in order and were left out",
        ),
        (
            stats.unidentified,
            "lidar packets are of a model that nothing tells and were left out: give --model",
        ),
        (
            // Said above, if it was found.
            if lidar_was_set { 0 } else { stats.clock_steps },
            "times the lidar's clock was set",
        ),
        (
            pass.counts.fragments,
            "IP fragments could not be put together",
        ),
        (
            pass.counts.reassembled,
            "packets came in IP fragments and were put together",
        ),
        (
            pass.counts.snapped,
            "packets were recorded only in part: record again with the full snap length",
        ),
        (
            pass.counts.damaged,
            "stretches of the file are damaged and were left out",
        ),
    ];
    let said = said.iter().filter(|(count, _)| *count > 0);
    warnings.extend(said.map(|(count, what)| format!("{count} {what}")));
    warnings
}

fn transport(link: DriveLink) -> &'static str {
    match link {
        DriveLink::Usb => "usb",
        DriveLink::Rs232 => "rs232",
        DriveLink::Can => "can",
    }
}

/// A return mode as reports call it.
#[must_use]
pub fn return_mode_name(mode: ReturnMode) -> String {
    match mode {
        ReturnMode::Strongest => "strongest".to_owned(),
        ReturnMode::Last => "last".to_owned(),
        ReturnMode::Dual => "dual".to_owned(),
        ReturnMode::Unknown(code) => format!("unknown (0x{code:02x})"),
    }
}
