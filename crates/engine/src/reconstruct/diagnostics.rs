//! Diagnostics of a scan, stored beside its points (`diagnostic_msgs` levels OK and WARN).

use cloud::{Diagnostic, DiagnosticLevel};

use crate::reconstruct::report::{Contents, ScanReport, SyncReport};
use crate::words::counted;

/// Checks of a scan: devices, losses, clock, tilt, cloud.
#[must_use]
pub fn of(scan: &ScanReport) -> Vec<Diagnostic> {
    vec![
        devices(&scan.contents),
        lidar(scan),
        clock(&scan.sync),
        tilt(scan),
        cloud(scan),
    ]
}

/// Names and values of a check, without unknown values.
struct NamedValues(Vec<(String, String)>);

impl NamedValues {
    const fn new() -> Self {
        Self(Vec::new())
    }

    fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.0.push((name.to_owned(), value.to_string()));
        self
    }

    fn with_some(self, name: &str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }
}

fn check(name: &str, problem: Option<String>, fine: &str, values: NamedValues) -> Diagnostic {
    Diagnostic {
        name: format!("velomotion: {name}"),
        level: match problem {
            Some(_) => DiagnosticLevel::Warn,
            None => DiagnosticLevel::Ok,
        },
        message: problem.unwrap_or_else(|| fine.to_owned()),
        values: values.0,
    }
}

fn devices(contents: &Contents) -> Diagnostic {
    let problem = contents
        .simulated
        .then(|| "SIMULATED: simulated devices, not a scan of anything real".to_owned());
    let values = NamedValues::new().with("simulated", contents.simulated);
    check("devices", problem, "real devices", values)
}

fn lidar(scan: &ScanReport) -> Diagnostic {
    let contents = &scan.contents;
    let lost = contents.lost_packets.saturating_add(scan.lost_records);
    let problem = (lost > 0).then(|| format!("{} lost", counted(lost, "packet")));
    let packets = contents.packets;
    let values = NamedValues::new()
        .with_some("model", contents.model.as_ref())
        .with_some("return_mode", contents.return_mode.as_ref())
        .with_some("rpm", contents.rpm)
        .with("data_packets", packets.data)
        .with("position_packets", packets.position)
        .with("malformed_packets", packets.malformed)
        .with("lost_packets", contents.lost_packets)
        .with("lost_records", scan.lost_records)
        .with("returns", contents.returns)
        .with("duration_s", contents.duration_s);
    check("lidar", problem, "nothing was lost", values)
}

fn clock(sync: &SyncReport) -> Diagnostic {
    let steps = sync.steps.len();
    let problem = (steps > 0).then(|| format!("clocks were set {steps} times, which was undone"));
    let values = NamedValues::new()
        .with("method", &sync.clock_method)
        .with("residual_us", sync.clock_residual_us)
        .with("bound_us", sync.clock_bound_us)
        .with("drift_ppm", sync.clock_drift_ppm)
        .with("steps", steps);
    let fine = format!("known within {:.0} us", sync.clock_bound_us);
    check("clock", problem, &fine, values)
}

fn tilt(scan: &ScanReport) -> Diagnostic {
    let sync = &scan.sync;
    let tilt = scan.contents.tilt.as_ref();
    let values = NamedValues::new()
        .with("method", &sync.angle_method)
        .with_some("residual_rms_deg", sync.angle_rms_deg)
        .with_some("bound_deg", sync.angle_bound_deg)
        .with_some("samples", tilt.map(|tilt| tilt.samples))
        .with_some("transport", tilt.map(|tilt| tilt.transport.as_str()))
        .with("sweeps", scan.sweeps.len());
    let fine = match sync.angle_rms_deg {
        Some(rms) => format!("samples agree to {rms:.4} deg RMS"),
        None => "no tilt".to_owned(),
    };
    check("tilt", None, &fine, values)
}

fn cloud(scan: &ScanReport) -> Diagnostic {
    let contents = &scan.contents;
    let mut values = NamedValues::new()
        .with("points", scan.points)
        .with("returns_left_out", scan.left_out);
    let warnings: Vec<&String> = contents
        .truncated
        .iter()
        .chain(&contents.warnings)
        .collect();
    for (number, warning) in warnings.iter().enumerate() {
        values = values.with(&format!("warning {}", number + 1), warning);
    }
    let summary = match warnings.as_slice() {
        [] => None,
        [one] => Some((*one).clone()),
        [first, rest @ ..] => Some(format!("{first}; and {} more", rest.len())),
    };
    check("cloud", summary, "no warnings", values)
}
