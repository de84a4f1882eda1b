//! Checks of the device in use: opens the drive's port, asks the drive who it is, listens to the
//! lidar. Nothing moves.

use std::sync::Arc;
use std::time::Duration;

use daemon::client::Client;
use daemon::local::{LocalService, LocalTask};
use engine::capture::jog::JogRequest;
use engine::capture::run;
use engine::config::{Config, Device};
use engine::devices::lidar_sockets::listen_config;
use engine::devices::profile;
use engine::failure::Failure;
use engine::service::axis_report::{AxisReport, StopAnswer};
use engine::service::lidar_stats;
use engine::service::status::LidarStatus;

use super::super::device_backend::jog_locally;
use super::super::guard_axis::environment;
use super::{Finding, Verdict, finding};

/// Time for which the lidar is listened to: 754 packets of a VLP-16.
const LISTENING: Duration = Duration::from_secs(1);

/// Checks drive and lidar of the device.
pub(super) fn check(config: &Config, (name, device): (String, Device)) -> Vec<Finding> {
    if profile::simulated(&device) {
        return vec![finding(
            format!("device {name}"),
            Verdict::Ok,
            "simulated devices: nothing to open",
        )];
    }
    let lidar = format!("lidar of {name}");
    match Client::find(&name, &device) {
        Some(client) => {
            let socket = client.socket.display();
            let owner = finding(
                format!("device {name}"),
                Verdict::Ok,
                format!("in use by the program that answers at {socket}"),
            );
            let status: Result<serde_json::Value, Failure> = client.get("/api/v1/status");
            vec![
                owner,
                drive(&name, client.get("/api/v1/tilt")),
                match status {
                    Ok(status) => finding(lidar, Verdict::Ok, served(&status["lidar"])),
                    Err(failure) => problem(lidar, failure),
                },
            ]
        }
        None => {
            let listening = lidar_stats::listen(&device, LISTENING);
            let own = (name.clone(), device.clone());
            vec![
                drive(&name, report(config, own)),
                match listening {
                    Ok(status) if status.received == 0 => {
                        problem(lidar, run::silence(&listen_config(&device), LISTENING))
                    }
                    Ok(status) => finding(lidar, Verdict::Ok, summary(&status)),
                    Err(failure) => problem(lidar, failure),
                },
            ]
        }
    }
}

fn problem(what: String, failure: Failure) -> Finding {
    let finding = finding(what, Verdict::Problem, failure.message);
    match failure.help {
        Some(help) => finding.todo(help),
        None => finding,
    }
}

/// The drive's report, from a service that opens its port.
fn report(config: &Config, device: (String, Device)) -> Result<AxisReport, Failure> {
    let local = LocalService::start(
        config.clone(),
        device,
        LocalTask::Read,
        &Arc::default(),
        environment(),
    )?;
    let answer = jog_locally(&local, JogRequest::Status);
    local.stop();
    match answer? {
        StopAnswer::Report(report) => Ok(*report),
        StopAnswer::Command(_) => Ok(AxisReport::default()),
    }
}

fn drive(name: &str, report: Result<AxisReport, Failure>) -> Finding {
    let what = format!("drive of {name}");
    match report {
        Err(failure) => problem(what, failure),
        Ok(report) => {
            let homed = if report.referenced {
                "homed"
            } else {
                "not homed"
            };
            let found = match report.unit.as_str() {
                // Another program has the drive and is moving it.
                "" => format!("{}, {homed}; in use by another program", report.state),
                unit => format!("{unit}; {}, {homed}", report.state),
            };
            match report.faults.first().filter(|_| report.is_in_fault()) {
                None => finding(what, Verdict::Ok, found),
                Some(fault) => {
                    let name = fault.name.as_deref().unwrap_or("unknown error");
                    let found = format!("{found}: {} {name}", fault.code);
                    let remedy = fault.remedy.as_deref().unwrap_or_default();
                    finding(what, Verdict::Warning, found).todo(format!(
                        "{remedy}\nvelomotion tilt faults --clear clears it, and so does homing"
                    ))
                }
            }
        }
    }
}

fn summary(status: &LidarStatus) -> String {
    let rpm = status.rpm.map_or("?".to_owned(), |rpm| format!("{rpm:.0}"));
    format!(
        "{}, {} return, {rpm} rpm, {:.0} packets/s, {} lost",
        status.model.unwrap_or("unknown model"),
        status.return_mode.as_deref().unwrap_or("unknown"),
        status.packets_per_s,
        status.lost_packets
    )
}

/// The lidar in the status of the program that listens to it.
fn served(lidar: &serde_json::Value) -> String {
    let text = |key: &str| lidar[key].as_str().unwrap_or("unknown").to_owned();
    let rate = lidar["packets_per_s"].as_f64().unwrap_or(0.0);
    format!("{}: {}, {rate:.0} packets/s", text("state"), text("model"))
}
