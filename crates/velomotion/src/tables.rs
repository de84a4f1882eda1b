//! Reports as tables for the terminal.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use engine::reconstruct::report::{Contents, Reception, ScanReport, SensorReport};

/// Label and value of a table row.
type Row = (&'static str, String);

/// The contents of a file as a table.
#[must_use]
pub fn contents_table(contents: &Contents) -> String {
    let mut rows = contents_rows(contents);
    rows.extend(warning_rows(contents));
    table(rows)
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
        "{} lidar packets, {} dropped by the kernel{others}; {} records dropped by the log",
        reception.packets, reception.dropped_by_kernel, reception.dropped_by_log
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
        Some(clouds) if scan.output.ends_with(".mcap") => {
            format!("{clouds} frames in {}", scan.output)
        }
        Some(clouds) => format!("{clouds} frames, numbered from the name {}", scan.output),
    }
}

/// The report on a scan as a table.
#[must_use]
pub fn scan_table(scan: &ScanReport) -> String {
    let mut rows = contents_rows(&scan.contents);
    for sweep in &scan.sweeps {
        rows.push((
            "sweep",
            format!(
                "{:.3} to {:.3} deg in {:.3} s, {}\ncruise {:.3}, mean {:.3} deg/s",
                sweep.from_deg,
                sweep.to_deg,
                sweep.duration_s,
                frames(sweep.frames),
                sweep.cruise_deg_s,
                sweep.mean_deg_s
            ),
        ));
    }
    let sync = &scan.sync;
    rows.push((
        "clock",
        format!(
            "{}, within {:.0} us, packets {:.0} us above it, drift {:.1} ppm",
            sync.clock_method, sync.clock_bound_us, sync.clock_residual_us, sync.clock_drift_ppm
        ),
    ));
    let rms = sync.angle_rms_deg.map_or(String::new(), |rms| {
        format!(", samples agree to {rms:.4} deg RMS")
    });
    rows.push(("angle", format!("{}{rms}", sync.angle_method)));
    if let Some(tolerance) = &sync.tolerance {
        for (line, why) in tolerance.why.split("; ").enumerate() {
            rows.push((if line == 0 { "tolerance" } else { "" }, why.to_owned()));
        }
    }
    rows.push((
        "points",
        format!("{} ({} returns omitted)", scan.points, scan.left_out),
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
    rows.push(("cloud", cloud_line(scan)));
    rows.push(("log", scan.log.clone()));
    if let Some(reception) = &scan.reception {
        rows.push(("recorded", reception_line(reception)));
    }
    rows.extend(warning_rows(&scan.contents));
    table(rows)
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
    for (name, value) in rows {
        table.add_row(vec![name.to_owned(), value]);
    }
    if let Some(names) = table.column_mut(0) {
        names.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_packets_are_in_the_summary() {
        let reception = Reception {
            packets: 700,
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
