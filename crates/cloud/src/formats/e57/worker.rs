//! The thread that owns the library's writers.

use std::io::{Read, Seek, Write};
use std::sync::mpsc::Receiver;

use e57::{DateTime, Extension, Quaternion, Transform, Translation};
use units::{Host, Stamp};

use super::attributes::{NAMESPACE, PointAttributes, URL};
use crate::{Metadata, Points};

/// Commands to the thread.
pub(super) enum WorkerCommand {
    /// Write these points, with times relative to a stamp.
    Points(Box<Points>, Stamp<Host>),
    /// Complete the file.
    Finish(FileEnding),
}

/// Attributes known at the end.
pub(super) struct FileEnding {
    /// The file's identifier, in place of [`PLACEHOLDER`].
    pub(super) identity: String,
    /// Begin and end of acquisition, GPS seconds; `None` without times.
    pub(super) start_gps_s: Option<f64>,
    pub(super) end_gps_s: Option<f64>,
}

/// Attributes known at the beginning.
pub(super) struct CloudDescription {
    name: String,
    description: String,
    sensor: String,
    software: String,
}

impl CloudDescription {
    pub(super) fn new(metadata: &Metadata) -> Self {
        let name = if metadata.simulated {
            "SIMULATED scan"
        } else {
            "scan"
        };
        Self {
            name: name.to_owned(),
            description: text(&metadata.lines().join("\n")),
            sensor: text(&metadata.source),
            software: text(&metadata.software),
        }
    }
}

/// Text for a CDATA section, without its end mark.
fn text(text: &str) -> String {
    text.replace("]]>", "]] >")
}

/// Placeholder of the file's identifier.
const PLACEHOLDER: &str = "{00000000-0000-8000-8000-000000000000}";

/// Executes commands until the file is complete. If the sender is dropped, the file stays
/// incomplete.
pub(super) fn run<W: Read + Write + Seek>(
    output: W,
    attributes: &PointAttributes,
    about: &CloudDescription,
    commands: &Receiver<WorkerCommand>,
) -> e57::Result<()> {
    let mut file = e57::E57Writer::new(output, PLACEHOLDER)?;
    if attributes.are_extended() {
        file.register_extension(Extension::new(NAMESPACE, URL))?;
    }
    let mut cloud = file.add_pointcloud(PLACEHOLDER, attributes.prototype())?;
    cloud.set_name(Some(about.name.clone()));
    cloud.set_description(Some(about.description.clone()));
    cloud.set_sensor_model(some(&about.sensor));
    cloud.set_sensor_sw_version(some(&about.software));
    cloud.set_transform(Some(Transform {
        rotation: Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
        translation: Translation {
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
    }));
    let ending = loop {
        match commands.recv() {
            Ok(WorkerCommand::Points(points, start)) => {
                for point in points.iter() {
                    cloud.add_point(attributes.values(&point, start))?;
                }
            }
            Ok(WorkerCommand::Finish(ending)) => break ending,
            Err(_) => return Ok(()),
        }
    };
    let time = |gps_time| DateTime {
        gps_time,
        atomic_reference: false,
    };
    cloud.set_acquisition_start(ending.start_gps_s.map(time));
    cloud.set_acquisition_end(ending.end_gps_s.map(time));
    cloud.finalize()?;
    file.finalize_customized_xml(|xml| Ok(xml.replace(PLACEHOLDER, &ending.identity)))
}

fn some(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}
