//! Reports as tables for the terminal.

use std::path::Path;

use cloud::formats::Format;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table};
use engine::reconstruct::report::{
    Contents, InfoReport, LiveReport, Reception, ScanReport, SensorReport, SweepReport,
};
use engine::words::counted;

use crate::terminal::width_of;

/// Label and value of a table row.
type Row = (&'static str, String);

/// The contents of a file as a table.
#[must_use]
pub fn info_table(report: &InfoReport) -> String {
    let contents = &report.contents;
    let mut rows = vec![("file", report.file.clone())];
    rows.extend(report.start_s.map(|start_s| ("start", utc_time(start_s))));
    rows.extend(contents_rows(contents));
    rows.extend(
        report
            .sensor
            .iter()
            .map(|sensor| ("address", sensor.clone())),
    );
    if let Some(position) = contents.gps.as_ref().and_then(|gps| gps.position) {
        let (latitude, longitude) = (position.latitude_deg, position.longitude_deg);
        rows.push((
            "position",
            format!("{latitude:.6}, {longitude:.6} deg (WGS 84)"),
        ));
    }
    if let Some(config) = &report.configuration {
        let (device, version) = (&config.device, &config.velomotion);
        let d_m = config.mount.d_m;
        rows.push((
            "device",
            format!("{device}, lidar {d_m} m above the axis; by velomotion {version}"),
        ));
        if let Some(simulation) = &config.simulation {
            let (scene, seed) = (&simulation.scene, &simulation.seed);
            rows.push(("scene", format!("{scene}, seed {seed}")));
            let effects = match simulation.effects.is_empty() {
                true => "none".to_owned(),
                false => simulation.effects.join(", "),
            };
            rows.push(("effects", effects));
        }
    }
    rows.extend(sweep_rows(&report.sweeps));
    rows.extend(warning_rows(contents));
    table(rows)
}

/// Date and time of Unix seconds, UTC.
fn utc_time(unix_s: f64) -> String {
    let since = std::time::Duration::try_from_secs_f64(unix_s).unwrap_or_default();
    let time = std::time::UNIX_EPOCH + since;
    humantime::format_rfc3339_millis(time).to_string()
}

fn contents_rows(contents: &Contents) -> Vec<Row> {
    let p = contents.packets;
    let mut rows = vec![
        ("lidar", lidar_line(contents)),
        (
            "packets",
            format!(
                "{} data, {} position, {} malformed, {} other",
                p.data, p.position, p.malformed, p.other
            ),
        ),
        ("returns", contents.returns.to_string()),
        ("lost packets", contents.lost_packets.to_string()),
        ("duration", format!("{:.3} s", contents.duration_s)),
    ];
    if let Some(gps) = &contents.gps {
        rows.push(("gps", format!("{}; pulse {}", gps.state, gps.pps)));
    }
    rows.extend(contents.sensors.iter().map(|s| ("sensor", sensor_line(s))));
    if let Some(tilt) = &contents.tilt {
        let tilt = format!("{} samples over {}", tilt.samples, tilt.transport);
        rows.push(("tilt", tilt));
    }
    if contents.simulated {
        rows.insert(
            0,
            ("SIMULATED", "simulated devices, not a real scan".to_owned()),
        );
    }
    if let Some(truncated) = &contents.truncated {
        rows.push(("cut off", truncated.clone()));
    }
    rows
}

fn lidar_line(contents: &Contents) -> String {
    let Some(model) = &contents.model else {
        return "none".to_owned();
    };
    let mode = contents.return_mode.as_deref().unwrap_or("unknown");
    let rpm = contents
        .rpm
        .map_or("unknown".to_owned(), |rpm| format!("{rpm:.0}"));
    format!("{model}, {mode} return, {rpm} rpm")
}

fn sensor_line(sensor: &SensorReport) -> String {
    let model = sensor.model.as_deref().unwrap_or("unknown model");
    let mode = sensor.return_mode.as_deref().unwrap_or("unknown");
    format!(
        "{}: {model}, {mode} return, {} packets, {} returns, {} lost",
        sensor.name, sensor.data, sensor.returns, sensor.lost_packets
    )
}

fn reception_line(reception: &Reception) -> String {
    let others = match reception.from_others {
        0 => String::new(),
        n => format!(", {n} of other senders omitted"),
    };
    format!(
        "{}, {} dropped by the kernel{others}; {} dropped by the log",
        counted(reception.received, "lidar packet"),
        reception.dropped_by_kernel,
        counted(reception.dropped_by_log, "record")
    )
}

fn live_line(live: &LiveReport) -> String {
    let off = match live.rms_m.zip(live.worst_m) {
        Some((rms_m, worst_m)) => format!(
            "RMS {:.2} mm, worst {:.2} mm from the cloud",
            rms_m * 1e3,
            worst_m * 1e3
        ),
        None => "no point in common with the cloud".to_owned(),
    };
    format!(
        "{} points, {off}; at most {:.0} ms late",
        live.points,
        live.lag_s * 1e3
    )
}

fn warning_rows(contents: &Contents) -> impl Iterator<Item = Row> + '_ {
    contents
        .warnings
        .iter()
        .map(|warning| ("warning", warning.clone()))
}

fn cloud_line(scan: &ScanReport) -> String {
    match scan.clouds {
        None => scan.output.clone(),
        Some(clouds) if Format::from_path(Path::new(&scan.output)) == Ok(Format::Mcap) => {
            format!("{} in {}", counted(clouds, "frame"), scan.output)
        }
        Some(clouds) => format!(
            "{}, numbered from the name {}",
            counted(clouds, "frame"),
            scan.output
        ),
    }
}

/// The report on a scan as a table.
#[must_use]
pub fn scan_table(scan: &ScanReport) -> String {
    let mut rows = contents_rows(&scan.contents);
    rows.extend(sweep_rows(&scan.sweeps));
    let sync = &scan.sync;
    let moved = sync.clock_bound_deg.zip(sync.clock_bound_mm_at_20m);
    let moved = moved.map_or(String::new(), |(deg, mm)| {
        format!(" ({deg:.4} deg, {mm:.1} mm at 20 m)")
    });
    rows.push((
        "clock",
        format!(
            "{}, within {:.0} us{moved}, packets {:.0} us above it, drift {:.1} ppm",
            sync.clock_method, sync.clock_bound_us, sync.clock_residual_us, sync.clock_drift_ppm
        ),
    ));
    let bound = sync
        .angle_bound_deg
        .map_or(String::new(), |bound| format!(", within {bound:.4} deg"));
    let rms = sync.angle_rms_deg.map_or(String::new(), |rms| {
        format!(", samples agree to {rms:.4} deg RMS")
    });
    rows.push(("angle", format!("{}{bound}{rms}", sync.angle_method)));
    if sync.angle_gaps > 0 {
        rows.push((
            "",
            format!(
                "{} between samples, the longest {:.2} s",
                counted(sync.angle_gaps, "gap"),
                sync.longest_angle_gap_s
            ),
        ));
    }
    if let Some(tolerance) = &sync.tolerance {
        for (line, why) in tolerance.why.split("; ").enumerate() {
            rows.push((if line == 0 { "tolerance" } else { "" }, why.to_owned()));
        }
    }
    let because = scan.left_out_because.iter();
    let because: String = because.map(|why| format!(": {why}")).collect();
    rows.push((
        "points",
        format!(
            "{} ({} returns omitted{because})",
            scan.points, scan.left_out
        ),
    ));
    if let Some(truth) = scan.truth {
        rows.push((
            "against truth",
            format!(
                "RMS {:.2} mm, worst {:.2} mm",
                truth.rms_m * 1e3,
                truth.worst_m * 1e3
            ),
        ));
    }
    rows.extend(scan.live.iter().map(|live| ("live view", live_line(live))));
    if let Some(georeference) = &scan.georeference {
        rows.extend(georeference.frame());
        let clauses: Vec<&str> = georeference.accuracy_clauses().collect();
        rows.push(("accuracy", clauses.join("\n")));
    }
    rows.push(("cloud", cloud_line(scan)));
    rows.push(("log", scan.log.clone()));
    if let Some(reception) = &scan.reception {
        rows.push(("recorded", reception_line(reception)));
    }
    rows.extend(warning_rows(&scan.contents));
    table(rows)
}

fn sweep_rows(sweeps: &[SweepReport]) -> impl Iterator<Item = Row> + '_ {
    sweeps.iter().map(|sweep| {
        let line = format!(
            "{:.3} to {:.3} deg in {:.3} s, {}\ncruise {:.3}, mean {:.3} deg/s",
            sweep.from_deg,
            sweep.to_deg,
            sweep.duration_s,
            frames(sweep.frames),
            sweep.cruise_deg_s,
            sweep.mean_deg_s
        );
        ("sweep", line)
    })
}

fn frames(frames: Option<f64>) -> String {
    frames.map_or("lidar speed unknown".to_owned(), |n| {
        format!("{n:.1} frames")
    })
}

/// Aligned labels and values.
#[must_use]
pub fn table(rows: Vec<(&'static str, String)>) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING);
    if let Some(width) = width_of(std::io::stdout()) {
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_width(u16::try_from(width).unwrap_or(u16::MAX));
    }
    for (name, value) in rows {
        table.add_row(vec![name.to_owned(), value]);
    }
    if let Some(names) = table.column_mut(0) {
        names.set_cell_alignment(CellAlignment::Right);
        names.set_constraint(ColumnConstraint::ContentWidth);
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_packets_are_in_the_summary() {
        let reception = Reception {
            received: 700,
            dropped_by_kernel: 3,
            dropped_by_log: 2,
            ..Reception::default()
        };
        assert_eq!(
            reception_line(&reception),
            "700 lidar packets, 3 dropped by the kernel; 2 records dropped by the log"
        );
        let others = Reception {
            from_others: 9,
            ..Reception::default()
        };
        assert_eq!(
            reception_line(&others),
            "0 lidar packets, 0 dropped by the kernel, 9 of other senders omitted; 0 records dropped by the log"
        );
    }
}
