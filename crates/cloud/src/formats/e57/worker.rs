//! The thread that owns the library's writers.

use std::io::{Read, Seek, Write};
use std::iter;
use std::sync::mpsc::Receiver;

use e57::{DateTime, Extension, Quaternion, Transform, Translation};
use units::{Host, Stamp};

use super::attributes::{NAMESPACE, PointAttributes, URL};
use crate::{EastNorthUp, Metadata, Points};

/// Commands to the thread.
pub(super) enum WorkerCommand {
    /// Write these points, with times relative to a stamp.
    Points(Box<Points>, Stamp<Host>),
    /// Complete the scan of the points so far.
    EndScan(ScanEnding),
}

/// Attributes of a scan known at its end.
pub(super) struct ScanEnding {
    /// Number of its sweep from 1; `None` for the only scan of a file.
    pub(super) sweep: Option<usize>,
    /// Its identifier.
    pub(super) identity: String,
    /// The identifier of the file, if this is its last scan.
    pub(super) file: Option<String>,
    /// Begin and end of acquisition, GPS seconds; `None` without times.
    pub(super) start_gps_s: Option<f64>,
    pub(super) end_gps_s: Option<f64>,
}

/// Attributes of all scans.
pub(super) struct CloudDescription {
    simulated: bool,
    description: String,
    sensor: String,
    software: String,
    /// Rotation of the pose of every scan, (x, y, z, w).
    rotation: [f64; 4],
}

impl CloudDescription {
    pub(super) fn new(metadata: &Metadata) -> Self {
        Self {
            simulated: metadata.simulated,
            description: text(&description(metadata).join("\n")),
            sensor: text(&metadata.source),
            software: text(&metadata.software),
            rotation: metadata
                .east_north_up
                .map_or([0.0, 0.0, 0.0, 1.0], EastNorthUp::rotation),
        }
    }

    fn name(&self, sweep: Option<usize>) -> String {
        let mark = if self.simulated { "SIMULATED " } else { "" };
        match sweep {
            Some(number) => format!("{mark}sweep {number}"),
            None => format!("{mark}scan"),
        }
    }
}

/// The metadata. Points of a georeferenced cloud are in the scanner's axes before the pose.
pub(super) fn description(metadata: &Metadata) -> Vec<String> {
    let mut lines = metadata.lines();
    if metadata.east_north_up.is_some() {
        let frames = lines.iter_mut().filter(|line| line.starts_with("frame: "));
        frames.for_each(|line| line.push_str(", after the pose"));
    }
    lines
}

/// Text for a CDATA section, without its end mark.
fn text(text: &str) -> String {
    text.replace("]]>", "]] >")
}

/// Placeholder of identifiers, which are known at the end.
const PLACEHOLDER: &str = "{00000000-0000-8000-8000-000000000000}";
/// The XML after an identifier. [`text`] removes `]]>`, so that no description contains it.
const GUID_END: &str = "]]></guid>";

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
    let mut identities = Vec::new();
    loop {
        let Some(ending) = write_scan(&mut file, attributes, about, commands)? else {
            return Ok(());
        };
        identities.push(ending.identity);
        if let Some(identity) = ending.file {
            return file
                .finalize_customized_xml(|xml| Ok(identified(&xml, &identity, &identities)));
        }
    }
}

/// The XML with its identifiers: first that of the file, then those of its scans.
fn identified(xml: &str, file: &str, scans: &[String]) -> String {
    let placeholder = format!("{PLACEHOLDER}{GUID_END}");
    let mut parts = xml.split(&placeholder);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let identities = iter::once(file).chain(scans.iter().map(String::as_str));
    for (identity, part) in identities.zip(parts) {
        text.extend([identity, GUID_END, part]);
    }
    text
}

/// Writes one scan; `None` if the sender is dropped.
fn write_scan<W: Read + Write + Seek>(
    file: &mut e57::E57Writer<W>,
    attributes: &PointAttributes,
    about: &CloudDescription,
    commands: &Receiver<WorkerCommand>,
) -> e57::Result<Option<ScanEnding>> {
    let mut cloud = file.add_pointcloud(PLACEHOLDER, attributes.prototype())?;
    cloud.set_description(Some(about.description.clone()));
    cloud.set_sensor_model(some(&about.sensor));
    cloud.set_sensor_sw_version(some(&about.software));
    let [x, y, z, w] = about.rotation;
    cloud.set_transform(Some(Transform {
        rotation: Quaternion { w, x, y, z },
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
            Ok(WorkerCommand::EndScan(ending)) => break ending,
            Err(_) => return Ok(None),
        }
    };
    let time = |gps_time| DateTime {
        gps_time,
        atomic_reference: false,
    };
    cloud.set_name(Some(about.name(ending.sweep)));
    cloud.set_acquisition_start(ending.start_gps_s.map(time));
    cloud.set_acquisition_end(ending.end_gps_s.map(time));
    cloud.finalize()?;
    Ok(Some(ending))
}

fn some(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}
