//! `velomotion info`: what a log or recording holds.

use lidar::{Decoder, Stats};
use protocol::record::{DriveLink, Wire};
use protocol::vlp16::ReturnMode;
use scanner::{ScanConfig, Survey};

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
    let mut survey = Survey::new(&config, lidar::Options::default())
        .map_err(|error| super::replay::scan_failure(path, &error))?;
    let pass = recordings::read(path, |record| {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.packet(record.host, payload, &mut |_| {});
        }
        survey.observe(record);
        Ok(())
    })?;
    decoder.finish(&mut |_| {});
    let contents = contents(&config, decoder.stats(), survey.drive(), &pass);
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

/// What was found, for the report.
#[must_use]
pub fn contents(
    config: &ScanConfig,
    stats: &Stats,
    drive: Option<(DriveLink, u64)>,
    pass: &Pass,
) -> Contents {
    let counts = &pass.counts;
    let tilt = drive.map(|(link, samples)| Tilt {
        samples,
        transport: transport(link).to_owned(),
    });
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
        tilt,
        truncated: pass.truncated.clone(),
        simulated: config.simulated,
        warnings: warnings(stats, pass),
    }
}

fn warnings(stats: &Stats, pass: &Pass) -> Vec<String> {
    let mut warnings: Vec<String> = stats.conflicts.iter().map(ToString::to_string).collect();
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
    if stats.lost_packets > 0 {
        warnings.push(format!("{} lidar packets are missing", stats.lost_packets));
    }
    warnings
}

fn transport(link: DriveLink) -> &'static str {
    match link {
        DriveLink::Usb => "usb",
        DriveLink::Rs232 => "rs232",
        DriveLink::Can => "can",
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
