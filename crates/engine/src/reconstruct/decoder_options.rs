//! Decoder options from a user's request: model, equal returns, calibration of the individual
//! sensor.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lidar::calibration::{from_ros_yaml, from_toml};
use lidar::{Corrections, Decoder, Duplicates, Options};
use protocol::record::Wire;
use protocol::vlp16::LidarModel;
use scanner::config::DeviceCalibration;

use crate::failure::{Failure, Kind};
use crate::reconstruct::source::Source;

/// Data packets within which the decoder settles on a model.
const ENOUGH: u64 = 200;
/// Bytes of the largest calibration file; those of 64 lasers have some 30 kB.
const MAX_CALIBRATION: u64 = 1 << 20;
/// Characters of the longest message on a calibration.
const MAX_MESSAGE: usize = 200;

/// Options of a user for decoding packets.
#[derive(Clone, Debug, Default)]
pub struct DecoderRequest {
    /// Model, if the packets do not tell it right.
    pub model: Option<&'static LidarModel>,
    /// Calibration file of the individual lidar: `.yaml` (ROS) or `.toml`.
    pub calibration: Option<PathBuf>,
    /// Equal returns of a dual-return packet.
    pub duplicates: Duplicates,
    /// Whether all rays start in one point instead of at the height of their laser.
    pub one_origin: bool,
}

/// The decoder's options for `source`.
///
/// # Errors
/// [`Kind::BadInput`] for an unusable calibration.
pub fn decoder_options(request: &DecoderRequest, source: &Source) -> Result<Options, Failure> {
    let plain = Options {
        model: request.model,
        duplicates: request.duplicates,
        vertical_offsets: !request.one_origin,
        ..Options::default()
    };
    let corrections = match &request.calibration {
        Some(path) => Some(calibration(path, model(&plain, source)?)?),
        None => match source
            .config()?
            .calibration
            .filter(|all| !all.laser.is_empty())
        {
            Some(all) => {
                let model = model(&plain, source)?;
                let of_model = all.corrections(model.name, Corrections::from(model));
                Some(of_model.ok_or_else(|| other_model(&all, model))?)
            }
            None => None,
        },
    };
    Ok(Options {
        corrections: corrections.map(Arc::new),
        ..plain
    })
}

pub(crate) fn other_model(calibration: &DeviceCalibration, model: &LidarModel) -> Failure {
    let calibrated = calibration.model.as_deref().unwrap_or("unknown model");
    Failure::new(
        Kind::BadInput,
        format!(
            "the calibration is of a {calibrated}, and the lidar is a {}",
            model.name
        ),
    )
    .help("name the mount of this lidar with --mount")
}

/// Model of the first packets, which the calibration must match.
fn model(options: &Options, source: &Source) -> Result<&'static LidarModel, Failure> {
    let mut decoder = Decoder::new(options.clone());
    source.read_until(|record| {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.packet(record.host, payload, &mut |_| {});
        }
        decoder.stats().data < ENOUGH
    })?;
    decoder.finish(&mut |_| {});
    decoder.stats().model.ok_or_else(|| {
        Failure::new(
            Kind::BadInput,
            format!(
                "{}: the model of the calibrated lidar is unknown",
                source.path().display()
            ),
        )
        .help("set it with --model")
    })
}

/// One line of a message that may quote a whole file.
fn brief(message: &str) -> String {
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(MAX_MESSAGE) {
        None => line,
        Some((end, _)) => format!("{}...", &line[..end]),
    }
}

/// Reads a calibration: ROS YAML or our TOML.
fn calibration(path: &Path, model: &'static LidarModel) -> Result<Corrections, Failure> {
    let wrong = |what: String| {
        Failure::new(Kind::BadInput, format!("{}: {}", path.display(), brief(&what))).help(
            "use a velodyne_pointcloud calibration (.yaml), or a file with one [[laser]] table per laser (.toml; docs, Replay)",
        )
    };
    if std::fs::metadata(path).is_ok_and(|there| there.len() > MAX_CALIBRATION) {
        return Err(wrong("larger than any calibration file".to_owned()));
    }
    let text =
        std::fs::read_to_string(path).map_err(|error| wrong(format!("cannot read: {error}")))?;
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "toml" {
        return from_toml(&text, model).map_err(|error| wrong(error.to_string()));
    }
    let read = from_ros_yaml(&text, model).map_err(|error| wrong(error.to_string()))?;
    for ignored in &read.ignored {
        tracing::warn!(
            "{} line {}: {} is not applied",
            path.display(),
            ignored.line,
            ignored.key
        );
    }
    Ok(read.corrections)
}
