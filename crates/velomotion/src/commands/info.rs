//! `velomotion info`: what a log or recording holds.

use drive::{Listener, Observation};
use lidar::{Decoder, Stats};
use protocol::record::{DriveLink, Record, Wire};
use protocol::vlp16::ReturnMode;
use scanner::ScanConfig;

use super::Said;
use crate::cli;
use crate::failure::{Failure, Kind};
use crate::recordings::{self, Pass};
use crate::report::{Contents, Packets, Tilt};

/// Runs the command.
///
/// # Errors
/// [`Kind::BadInput`] for a file that is no recording.
pub fn run(arguments: &cli::Info) -> Result<Said, Failure> {
    let path = &arguments.file;
    let config = recordings::config(path)?;
    let mut decoder = Decoder::new(lidar::Options::default());
    let mut traffic = Traffic::new(&config);
    let pass = recordings::read(path, |record| {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.packet(record.host, payload, &mut |_| {});
        }
        traffic.observe(record);
        Ok(())
    })?;
    decoder.finish(&mut |_| {});
    let contents = contents(decoder.stats(), &traffic, &pass);
    let failure = pass.truncated.map(|truncated| {
        Failure::new(
            Kind::Incomplete,
            format!("{} is cut off: {truncated}", path.display()),
        )
        .help("what is said above holds for the part that is there; replay makes a cloud of it")
    });
    Ok(Said {
        json: super::json(&contents),
        text: contents.table(),
        failure,
        stdout_taken: false,
    })
}

/// The drive's traffic in a log, counted.
pub struct Traffic {
    listener: Listener,
    link: Option<DriveLink>,
    samples: u64,
}

impl Traffic {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(config: &ScanConfig) -> Self {
        Self {
            listener: Listener::new(config.axis.node),
            link: None,
            samples: 0,
        }
    }

    /// Takes one record.
    pub fn observe(&mut self, record: &Record<'_>) {
        let Wire::Drive {
            link,
            direction,
            frame,
        } = record.wire
        else {
            return;
        };
        self.link = Some(link);
        let samples = &mut self.samples;
        self.listener
            .observe(link, direction, frame, record.host, &mut |seen| {
                if matches!(seen, Observation::Sample(_)) {
                    *samples += 1;
                }
            });
    }

    fn tilt(&self) -> Option<Tilt> {
        let transport = match self.link? {
            DriveLink::Usb => "usb",
            DriveLink::Rs232 => "rs232",
            DriveLink::Can => "can",
        };
        Some(Tilt {
            samples: self.samples,
            transport: transport.to_owned(),
        })
    }
}

/// What was found, for the report.
#[must_use]
pub fn contents(stats: &Stats, traffic: &Traffic, pass: &Pass) -> Contents {
    let counts = &pass.counts;
    Contents {
        model: stats.model.map(|model| model.name.to_owned()),
        return_mode: stats.return_mode.map(return_mode),
        packets: Packets {
            data: stats.data,
            position: stats.position,
            malformed: stats.malformed + counts.malformed,
            other: stats.other + counts.other + counts.fragments,
        },
        returns: stats.returns,
        lost_packets: stats.lost_packets,
        duration_s: stats.duration.as_secs_f64(),
        rpm: stats.rpm,
        tilt: traffic.tilt(),
        truncated: pass.truncated.clone(),
    }
}

fn return_mode(mode: ReturnMode) -> String {
    match mode {
        ReturnMode::Strongest => "strongest".to_owned(),
        ReturnMode::Last => "last".to_owned(),
        ReturnMode::Dual => "dual".to_owned(),
        ReturnMode::Unknown(code) => format!("unknown (0x{code:02x})"),
    }
}
