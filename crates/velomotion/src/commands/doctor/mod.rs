//! `velomotion doctor`: checks the scanner setup of this machine and suggests fixes.

pub(crate) mod bring_up;
mod devices;

use std::fs;
use std::path::Path;

use io::can::CanInterface;
use io::discover::{ConnectedDevices, Epos2Found, discover};
use serde::Serialize;
use utoipa::ToSchema;

use super::CommandOutput;
use crate::cli::{Common, Doctor};
use crate::terminal::{width_of, wrapped};
use engine::config::{self, AxisSettings, Config, DeviceKind};
use engine::devices::profile;
use engine::failure::{Failure, Kind};

/// Result of one check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
struct Finding {
    /// Item checked.
    what: String,
    /// `ok`, `warning` or `problem`.
    verdict: Verdict,
    /// Finding.
    found: String,
    /// Suggested fix.
    #[serde(skip_serializing_if = "Option::is_none")]
    todo: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
enum Verdict {
    Ok,
    Warning,
    Problem,
}

/// Report of `doctor`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct DoctorReport {
    /// What was found, in the order of the checks.
    findings: Vec<Finding>,
}

/// Reads a file of sysfs; `None` if it does not exist.
type Sysfs<'a> = &'a dyn Fn(&Path) -> Option<String>;

/// Runs the command.
///
/// # Errors
/// An unreadable configuration. A problem found is a failure with a result.
pub fn run(arguments: &Doctor, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let chosen = profile::choose(&config, arguments.device.name.as_deref())?;
    if arguments.bring_up {
        return bring_up::run(arguments, common, &config, chosen);
    }
    let read = |path: &Path| {
        fs::read_to_string(path)
            .ok()
            .map(|text| text.trim().to_owned())
    };
    let mut findings = vec![configuration(common)];
    findings.extend(drives(&discover(), &read));
    let interfaces = io::can::interfaces();
    findings.extend(can_interfaces(&interfaces));
    findings.extend(profiles(&config, &chosen.0, &interfaces));
    let axis = axis(&config.axis);
    let is_valid = axis.verdict == Verdict::Ok;
    findings.push(axis);
    findings.push(receive_buffer(&read));
    if is_valid {
        findings.extend(devices::check(&config, chosen));
    }
    let report = DoctorReport { findings };
    let text = text(&report);
    let is_problem = |finding: &&Finding| finding.verdict == Verdict::Problem;
    let failure = match report.findings.iter().filter(is_problem).count() {
        0 => None,
        1 => Some("1 problem found".to_owned()),
        count => Some(format!("{count} problems found")),
    };
    Ok(CommandOutput {
        failure: failure.map(|message| {
            Failure::new(Kind::NoDevice, message).help("the lines marked PROBLEM say what to do")
        }),
        ..CommandOutput::result(&report, text)
    })
}

/// The configuration that was read.
fn configuration(common: &Common) -> Finding {
    let path = common.config.clone().or_else(config::usual_place);
    let found = path.map_or("none found: defaults".to_owned(), |path| {
        path.display().to_string()
    });
    finding("configuration", Verdict::Ok, found)
}

fn finding(what: impl Into<String>, verdict: Verdict, found: impl Into<String>) -> Finding {
    Finding {
        what: what.into(),
        verdict,
        found: found.into(),
        todo: None,
    }
}

impl Finding {
    fn todo(mut self, todo: impl Into<String>) -> Self {
        self.todo = Some(todo.into());
        self
    }
}

fn drives(found: &ConnectedDevices, read: Sysfs<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = found.epos2.iter().map(|unit| epos2(unit, read)).collect();
    if findings.is_empty() {
        findings.push(
            finding("EPOS2 on USB", Verdict::Warning, "none (0403:A8B0)")
                .todo("connect it and switch it on; a drive on RS232 or CAN is not listed here"),
        );
    }
    for port in &found.serial_ports {
        let usb = port.usb.as_ref().map_or("no USB device".to_owned(), |usb| {
            format!("USB {:04x}:{:04x}", usb.vendor, usb.product)
        });
        findings.push(finding(
            format!("serial port {}", port.path.display()),
            Verdict::Ok,
            usb,
        ));
    }
    findings.extend(
        found
            .problems
            .iter()
            .map(|problem| finding("device search", Verdict::Problem, problem)),
    );
    findings
}

fn epos2(unit: &Epos2Found, read: Sysfs<'_>) -> Finding {
    let what = format!("EPOS2 on USB {}", unit.bus_place);
    let Some(port) = &unit.port else {
        return finding(what, Verdict::Problem, "no serial port: the driver ftdi_sio does not know its id").todo(
            "as root:\n  modprobe ftdi_sio && echo 0403 a8b0 > /sys/bus/usb-serial/drivers/ftdi_sio/new_id\n\
             for good, in /etc/udev/rules.d/99-epos2.rules:\n\
             ACTION==\"add\", SUBSYSTEM==\"usb\", ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"a8b0\", \
             RUN+=\"/bin/sh -c 'modprobe ftdi_sio; echo 0403 a8b0 > /sys/bus/usb-serial/drivers/ftdi_sio/new_id'\"",
        );
    };
    let name = port.file_name().unwrap_or_default();
    let timer = Path::new("/sys/bus/usb-serial/devices")
        .join(name)
        .join("latency_timer");
    match read(&timer) {
        Some(ms) if ms != "1" => finding(
            what,
            Verdict::Warning,
            format!(
                "{}, latency timer {ms} ms: every answer may be delayed by that",
                port.display()
            ),
        )
        .todo(format!("as root:\n  echo 1 > {}", timer.display())),
        _ => finding(what, Verdict::Ok, port.display().to_string()),
    }
}

fn can_interfaces(interfaces: &[CanInterface]) -> Vec<Finding> {
    interfaces
        .iter()
        .map(|interface| {
            let what = format!("CAN interface {}", interface.name);
            if interface.up {
                finding(what, Verdict::Ok, "up")
            } else {
                // A problem of the device that uses it alone.
                finding(what, Verdict::Warning, "down").todo(format!(
                    "as root:\n  {}",
                    io::can::up_command(&interface.name)
                ))
            }
        })
        .collect()
}

/// Checks the profiles; a device that is not `chosen` may be absent.
fn profiles(config: &Config, chosen: &str, interfaces: &[CanInterface]) -> Vec<Finding> {
    let mut findings = vec![finding("device in use", Verdict::Ok, chosen)];
    for (name, device) in &config.device.profiles {
        let what = format!("[device.{name}]");
        let mut found = match (&device.kind, &device.port) {
            (DeviceKind::Sim, _) => finding(what, Verdict::Ok, "simulated devices"),
            (DeviceKind::Can, _) => match &device.interface {
                Some(name) => can_profile(what, name, interfaces),
                None => finding(what, Verdict::Problem, "no interface configured")
                    .todo("add interface = \"can0\" (or its actual value)"),
            },
            (_, Some(port)) if port.exists() => {
                finding(what, Verdict::Ok, port.display().to_string())
            }
            (_, Some(port)) => finding(
                what,
                Verdict::Problem,
                format!("{} is not there", port.display()),
            )
            .todo("connect the drive, or correct `port` in the configuration"),
            (DeviceKind::Usb, None) => finding(what, Verdict::Ok, "the EPOS2 found on USB"),
            (_, None) => finding(what, Verdict::Problem, "names no port")
                .todo("add port = \"/dev/ttyUSB0\" (or its actual value)"),
        };
        if name != chosen && found.verdict == Verdict::Problem {
            found.verdict = Verdict::Warning;
        }
        findings.push(found);
    }
    findings
}

/// Checks the interface of a CAN profile. An interface that is down has a finding of its own.
fn can_profile(what: String, name: &str, interfaces: &[CanInterface]) -> Finding {
    if interfaces.iter().any(|interface| interface.name == name) {
        return finding(what, Verdict::Ok, format!("CAN interface {name}"));
    }
    finding(what, Verdict::Problem, format!("there is no CAN interface {name}")).todo(format!(
        "connect the adapter, or correct `interface` in the configuration;\n\
         without an adapter, as root:\n  modprobe vcan && ip link add {name} type vcan && ip link set {name} up"
    ))
}

/// Checks the axis configuration. The limit switch that homing finds (methods 17 and 18) is outside
/// the range: a move that reaches it is stopped.
fn axis(configured: &AxisSettings) -> Finding {
    let AxisSettings { homing, .. } = configured;
    let expected = match homing.method {
        17 if homing.at_deg > configured.min_deg => "axis.min_deg or less",
        18 if homing.at_deg < configured.max_deg => "axis.max_deg or more",
        _ => "",
    };
    match profile::axis(configured) {
        Ok(_) if !expected.is_empty() => finding(
            "[axis]",
            Verdict::Problem,
            format!(
                "axis.homing.at_deg: expected {expected}, where method {} has its limit switch, got {}",
                homing.method, homing.at_deg
            ),
        )
        .todo("correct at_deg, or the range of the axis: a move that reaches the switch is stopped"),
        Ok(_) => finding("[axis]", Verdict::Ok, "axis configuration is valid"),
        Err(failure) => finding("[axis]", Verdict::Problem, failure.to_string()).todo(
            "correct that value in the configuration; velomotion help wiring describes every key",
        ),
    }
}

/// Checks the limit on socket buffers: the lidar's socket requests 8 MiB and gets at most the
/// limit.
fn receive_buffer(read: Sysfs<'_>) -> Finding {
    const WANTED: u64 = 8 << 20;
    let what = "UDP receive buffer";
    let limit: Option<u64> =
        read(Path::new("/proc/sys/net/core/rmem_max")).and_then(|text| text.parse().ok());
    match limit {
        Some(limit) if limit < WANTED => finding(
            what,
            Verdict::Warning,
            format!(
                "at most {} KiB: packets are lost in a long pause of this machine",
                limit >> 10
            ),
        )
        .todo(format!("as root:\n  sysctl -w net.core.rmem_max={WANTED}")),
        Some(limit) => finding(what, Verdict::Ok, format!("up to {} KiB", limit >> 10)),
        None => finding(what, Verdict::Ok, "limit not known"),
    }
}

fn text(report: &DoctorReport) -> String {
    /// Width of the marks.
    const INDENTATION: &str = "         ";
    let width = width_of(std::io::stdout());
    let mut lines = Vec::new();
    for finding in &report.findings {
        let mark = match finding.verdict {
            Verdict::Ok => "ok       ",
            Verdict::Warning => "warning  ",
            Verdict::Problem => "PROBLEM  ",
        };
        let found = format!("{}: {}", finding.what, finding.found);
        lines.push(wrapped(&found, width, mark, INDENTATION));
        for line in finding.todo.iter().flat_map(|todo| todo.lines()) {
            lines.push(wrapped(line, width, INDENTATION, INDENTATION));
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn unit(port: Option<&str>) -> Epos2Found {
        Epos2Found {
            bus_place: "1-4".to_owned(),
            port: port.map(PathBuf::from),
        }
    }

    #[test]
    fn an_epos2_without_a_port_gets_the_udev_rule() {
        let finding = epos2(&unit(None), &|_| None);
        assert_eq!(finding.verdict, Verdict::Problem);
        let todo = finding.todo.unwrap();
        assert!(
            todo.contains("udev") && todo.contains("0403 a8b0"),
            "{todo}"
        );
    }

    #[test]
    fn a_slow_latency_timer_is_reported_with_its_remedy() {
        let finding = epos2(&unit(Some("/dev/ttyUSB3")), &|path| {
            assert!(path.ends_with("ttyUSB3/latency_timer"), "{path:?}");
            Some("16".to_owned())
        });
        assert_eq!(finding.verdict, Verdict::Warning);
        assert!(finding.todo.unwrap().contains("echo 1 > "));
        let fast = epos2(&unit(Some("/dev/ttyUSB3")), &|_| Some("1".to_owned()));
        assert_eq!(fast.verdict, Verdict::Ok);
    }

    #[test]
    fn a_can_interface_that_is_down_gets_the_ip_command() {
        let interfaces = [("can0", false), ("vcan0", true)].map(|(name, up)| CanInterface {
            name: name.to_owned(),
            up,
        });
        let findings = can_interfaces(&interfaces);
        assert_eq!(findings[0].verdict, Verdict::Warning);
        assert!(findings[0].todo.as_ref().unwrap().contains("can0"));
        assert_eq!(findings[1].verdict, Verdict::Ok);
    }

    #[test]
    fn a_missing_can_interface_is_a_problem() {
        let there = [CanInterface {
            name: "can0".to_owned(),
            up: true,
        }];
        let of = |name| {
            let text = format!("[device.bus]\nkind = 'can'\ninterface = '{name}'");
            let config: Config = toml::from_str(&text).unwrap();
            profiles(&config, "bus", &there).remove(1)
        };
        assert_eq!(of("can0").verdict, Verdict::Ok);
        let missing = of("can1");
        assert_eq!(missing.verdict, Verdict::Problem);
        assert!(missing.found.contains("can1"), "{missing:?}");
        assert!(missing.todo.is_some());
    }

    #[test]
    fn an_invalid_axis_configuration_is_a_problem() {
        let wrong = AxisSettings {
            min_deg: 10.0,
            ..AxisSettings::default()
        };
        let mut switch_in_range = AxisSettings::default();
        switch_in_range.homing.at_deg = -20.0;
        for configured in [wrong, switch_in_range] {
            assert_eq!(axis(&configured).verdict, Verdict::Problem);
        }
        assert_eq!(axis(&AxisSettings::default()).verdict, Verdict::Ok);
    }
}
