//! Contents of a log or recording.

use io::recording::DatagramKind;
use lidar::{Decoder, Options, PacketGap, Stats, UtcClock, UtcState};
use protocol::record::{DriveLink, Record, Wire};
use protocol::vlp16::{PositionPacket, ReturnMode};
use scanner::clock_steps::{ClockStep, SetClock};
use scanner::{Accuracy, ScanConfig, Survey, TiltSource};

use super::failures::scan_failure;
use super::satellite::{SatelliteReceiver, pps_name};
use super::warnings::incomplete_sweeps;
use crate::failure::Failure;
use crate::reconstruct::report::{
    Contents, Gps, InfoReport, MissingPackets, PacketCounts, SensorReport, SweepReport, TiltReport,
};
use crate::reconstruct::source::{PassSummary, SensorAddress, Source};
use crate::words::counted;

/// Reads the whole recording and lists what it holds.
///
/// # Errors
/// [`Kind::BadInput`](crate::failure::Kind::BadInput) for a file that is not a recording.
pub fn read_contents(source: &Source, options: Options) -> Result<InfoReport, Failure> {
    let config = source.config()?;
    let mut start = None;
    let mut sensors = SensorSurveys::new(options.clone());
    let mut survey =
        Survey::new(&config, options).map_err(|error| scan_failure(source.path(), None, &error))?;
    let pass = source.read_all(|record| {
        start.get_or_insert(record.host);
        sensors.observe(record);
        if sensors.is_reported(record) {
            survey.observe(record);
        }
        Ok(())
    })?;
    let sensor = sensors.first().map(|survey| survey.name().to_string());
    let mut contents = sensors.contents(&config, survey.drive(), &pass, &survey.steps());
    let (mut sweeps, mut incomplete) = (Vec::new(), Vec::new());
    if survey.drive().is_some() && contents.packets.data > 0 {
        match survey.solve(&config, &TiltSource::Log, Accuracy::Best) {
            Ok(alignment) => {
                let found = alignment.sweeps.iter();
                sweeps = found
                    .map(|sweep| SweepReport::new(sweep, contents.rpm))
                    .collect();
                incomplete = incomplete_sweeps(&config, &alignment);
                contents.warnings.extend(incomplete.iter().cloned());
            }
            Err(error) => contents.warnings.push(error.to_string()),
        }
    }
    Ok(InfoReport {
        contents,
        file: source.path().display().to_string(),
        start_s: start.map(|start| start.as_secs_f64()),
        sensor,
        sweeps,
        incomplete_sweeps: incomplete,
        configuration: source.has_config()?.then_some(config),
    })
}

/// One survey per sensor.
struct SensorSurveys {
    options: Options,
    sensors: Vec<SensorSurvey>,
    /// Packets that belong to no sensor.
    unassigned: Decoder,
}

/// Statistics of one sensor.
struct SensorSurvey {
    source: [u8; 4],
    /// Port of its data packets; `None` until the first arrives.
    port: Option<u16>,
    decoder: Decoder,
    utc: UtcClock,
    receiver: SatelliteReceiver,
}

/// Sensors with statistics of their own. Packets of further sensors are only counted.
const MAX_SENSORS: usize = 64;

impl SensorSurveys {
    fn new(options: Options) -> Self {
        Self {
            options: options.clone(),
            sensors: Vec::new(),
            unassigned: Decoder::new(options),
        }
    }

    fn observe(&mut self, record: &Record<'_>) {
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
                if !self.sensors.iter().any(|survey| survey.source == source) {
                    self.add(source, None);
                }
                for survey in self
                    .sensors
                    .iter_mut()
                    .filter(|survey| survey.source == source)
                {
                    survey.position(record, payload);
                }
            }
            DatagramKind::Data => match self.survey(source, port) {
                Some(survey) => survey.data(record, payload),
                None => self.unassigned.packet(record.host, payload, &mut |_| {}),
            },
            // A damaged packet of an unknown sender does not count as a sensor.
            DatagramKind::Damaged => {
                let known = |survey: &&mut SensorSurvey| {
                    survey.source == source && survey.port == Some(port)
                };
                match self.sensors.iter_mut().find(known) {
                    Some(survey) => survey.data(record, payload),
                    None => self.unassigned.packet(record.host, payload, &mut |_| {}),
                }
            }
            DatagramKind::Foreign => self.unassigned.packet(record.host, payload, &mut |_| {}),
        }
    }

    /// Whether the record belongs to the drive or to the reported lidar.
    fn is_reported(&self, record: &Record<'_>) -> bool {
        match record.wire {
            Wire::Drive { .. } => true,
            Wire::Lidar { source, port, .. } => self.first().is_some_and(|survey| {
                survey.source == source && survey.port.is_none_or(|own| own == port)
            }),
        }
    }

    /// The reported sensor: the first that sent data, else the first that sent anything.
    fn first(&self) -> Option<&SensorSurvey> {
        let with_data = self.sensors.iter().find(|survey| survey.port.is_some());
        with_data.or(self.sensors.first())
    }

    /// Survey of the sensor that sends data from `source` to `port`.
    fn survey(&mut self, source: [u8; 4], port: u16) -> Option<&mut SensorSurvey> {
        let is = |wanted: Option<u16>| {
            move |survey: &SensorSurvey| survey.source == source && survey.port == wanted
        };
        let at = self.sensors.iter().position(is(Some(port)));
        // A sensor whose position packets arrived before its data.
        let at = at.or_else(|| self.sensors.iter().position(is(None)));
        let at = match at {
            Some(at) => at,
            None => self.add(source, Some(port))?,
        };
        let survey = self.sensors.get_mut(at)?;
        survey.port = Some(port);
        Some(survey)
    }

    fn add(&mut self, source: [u8; 4], port: Option<u16>) -> Option<usize> {
        if self.sensors.len() >= MAX_SENSORS {
            return None;
        }
        self.sensors.push(SensorSurvey {
            source,
            port,
            decoder: Decoder::new(self.options.clone()),
            utc: UtcClock::new(),
            receiver: SatelliteReceiver::default(),
        });
        Some(self.sensors.len() - 1)
    }

    /// Contents with the first sensor's values, and one report per sensor if there are several.
    fn contents(
        mut self,
        config: &ScanConfig,
        drive: Option<(DriveLink, u64)>,
        pass: &PassSummary,
        steps: &[ClockStep],
    ) -> Contents {
        for survey in &mut self.sensors {
            survey.decoder.finish(&mut |_| {});
        }
        let empty = Stats::default();
        let first = self.first();
        let mut contents = contents(
            config,
            first.map_or(&empty, |survey| survey.decoder.stats()),
            drive,
            pass,
            steps,
        );
        contents.gps = first.and_then(SensorSurvey::gps);
        let unassigned = self.unassigned.stats();
        contents.packets.malformed += unassigned.malformed;
        if let Some(error) = &unassigned.first_malformed {
            contents.warnings.push(format!(
                "{} like a lidar's without a lidar here, the first: {error}",
                counted(unassigned.malformed, "packet")
            ));
        }
        if self.sensors.len() > 1 {
            contents.sensors = self.sensors.iter().map(SensorSurvey::report).collect();
        }
        contents
    }
}

impl SensorSurvey {
    fn data(&mut self, record: &Record<'_>, payload: &[u8]) {
        let utc = &mut self.utc;
        self.decoder.packet(record.host, payload, &mut |firing| {
            utc.data(firing.start);
        });
    }

    fn position(&mut self, record: &Record<'_>, payload: &[u8]) {
        self.decoder.packet(record.host, payload, &mut |_| {});
        if let Ok(packet) = PositionPacket::new(payload) {
            self.receiver.observe(&packet);
            self.utc.position(record.host, &packet);
        }
    }

    fn name(&self) -> SensorAddress {
        SensorAddress {
            address: self.source.into(),
            port: self.port,
        }
    }

    fn report(&self) -> SensorReport {
        let stats = self.decoder.stats();
        SensorReport {
            name: self.name().to_string(),
            model: stats.model.map(|model| model.name.to_owned()),
            return_mode: stats.return_mode.map(return_mode_name),
            data: stats.data,
            returns: stats.returns,
            lost_packets: stats.lost_packets,
            rpm: stats.rpm,
            gps: self.gps(),
        }
    }

    /// State of the satellite receiver; `None` without position packets.
    fn gps(&self) -> Option<Gps> {
        let pps = self.receiver.pps?;
        let state = self.utc.state();
        let locked = matches!(state, UtcState::Locked { .. });
        let counts_with_text = match self.utc.ends() {
            ends if locked && ends > 0 => format!("{state}; the lock was lost {ends} times"),
            _ => state.to_string(),
        };
        Some(Gps {
            pps: pps_name(pps),
            locked,
            state: counts_with_text,
            position: self.receiver.position(),
        })
    }
}

/// Contents from the decoder's and the file's statistics.
#[must_use]
pub fn contents(
    config: &ScanConfig,
    stats: &Stats,
    drive: Option<(DriveLink, u64)>,
    pass: &PassSummary,
    steps: &[ClockStep],
) -> Contents {
    let counts = &pass.counts;
    let tilt = drive.map(|(link, samples)| TiltReport {
        samples,
        transport: link_name(link).to_owned(),
    });
    Contents {
        model: stats.model.map(|model| model.name.to_owned()),
        return_mode: stats.return_mode.map(return_mode_name),
        packets: PacketCounts {
            data: stats.data,
            position: stats.position,
            malformed: stats.malformed + counts.malformed,
            other: stats.other + counts.other + counts.fragments,
        },
        gps: None,
        sensors: Vec::new(),
        returns: stats.returns,
        lost_packets: lost_packets(stats, steps),
        packet_gaps: packet_gaps(stats, steps),
        duration_s: stats.duration.as_secs_f64(),
        rpm: stats.rpm,
        tilt,
        truncated: pass.truncated.clone(),
        simulated: config.simulated,
        warnings: warnings(stats, pass, steps),
    }
}

/// Packets that are missing, not those that a step of the lidar's clock pretends.
fn lost_packets(stats: &Stats, steps: &[ClockStep]) -> u64 {
    let phantoms = steps.iter().map(|step| step.phantom_packets);
    phantoms.fold(stats.lost_packets, u64::saturating_sub)
}

/// Gaps in the packets, without the steps of the lidar's clock that look like gaps.
fn packet_gaps(stats: &Stats, steps: &[ClockStep]) -> Vec<MissingPackets> {
    let mut gaps = stats.gaps.clone();
    for step in steps.iter().filter(|step| step.phantom_packets > 0) {
        let is_step = |gap: &PacketGap| gap.packets == step.phantom_packets;
        if let Some(place) = gaps.iter().position(is_step) {
            gaps.remove(place);
        }
    }
    let report = |gap: PacketGap| MissingPackets {
        at_s: gap.at.as_secs_f64(),
        missing: gap.packets,
    };
    gaps.into_iter().map(report).collect()
}

fn warnings(stats: &Stats, pass: &PassSummary, steps: &[ClockStep]) -> Vec<String> {
    let mut warnings: Vec<String> = stats.conflicts.iter().map(ToString::to_string).collect();
    warnings.extend(steps.iter().map(ToString::to_string));
    let lidar_was_set = steps.iter().any(|step| step.clock == SetClock::Lidar);
    if let Some(malformed) = &pass.counts.first_malformed {
        warnings.push(format!(
            "{} damaged, the first at byte {}: {}",
            counted(pass.counts.malformed, "record"),
            malformed.offset,
            malformed.fault
        ));
    }
    if let Some(error) = &stats.first_malformed {
        warnings.push(format!(
            "{} damaged, the first: {error}",
            counted(stats.malformed, "lidar packet")
        ));
    }
    let counts_with_text = [
        (lost_packets(stats, steps), "lidar packets are missing"),
        (
            stats.duplicates + pass.doubled_packets,
            "lidar packets arrived twice and were used once",
        ),
        (
            pass.doubled_frames,
            "records of the drive are in the file twice and were used once",
        ),
        (
            stats.reordered,
            "lidar packets arrived out of order and were reordered",
        ),
        (
            stats.late,
            "lidar packets arrived too late to be reordered and were omitted",
        ),
        (
            stats.unidentified,
            "lidar packets are of an unknown model and were omitted: set --model",
        ),
        (
            // Reported above if the step was found.
            if lidar_was_set { 0 } else { stats.clock_steps },
            "steps of the lidar's clock",
        ),
        (
            pass.counts.fragments,
            "IP fragments could not be reassembled",
        ),
        (
            pass.counts.reassembled,
            "packets were reassembled from IP fragments",
        ),
        (
            pass.counts.snapped,
            "packets were truncated by the recorder: record with the full snap length",
        ),
        (
            pass.counts.damaged,
            "parts of the file are damaged and were skipped",
        ),
    ];
    let counts_with_text = counts_with_text.iter().filter(|(count, _)| *count > 0);
    warnings.extend(counts_with_text.map(|(count, what)| format!("{count} {what}")));
    warnings
}

/// Name of a link.
#[must_use]
pub const fn link_name(link: DriveLink) -> &'static str {
    match link {
        DriveLink::Usb => "usb",
        DriveLink::Rs232 => "rs232",
        DriveLink::Can => "can",
    }
}

/// Name of a return mode in reports.
#[must_use]
pub fn return_mode_name(mode: ReturnMode) -> String {
    match mode {
        ReturnMode::Strongest => "strongest".to_owned(),
        ReturnMode::Last => "last".to_owned(),
        ReturnMode::Dual => "dual".to_owned(),
        ReturnMode::Unknown(code) => format!("unknown (0x{code:02x})"),
    }
}
