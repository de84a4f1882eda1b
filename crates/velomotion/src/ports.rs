//! The drive's serial port: its speed, and what to do where it cannot be had.

use io::port::PortError;

use crate::failure::{Failure, Kind};

/// EPOS2 on USB: 1 Mbaud by the Communication Guide.
pub const USB_BAUD: u32 = 1_000_000;

/// A port that cannot be had, with what to do about it.
#[must_use]
pub fn failure(error: &PortError) -> Failure {
    let help = match error {
        PortError::Permission { .. } => {
            "add yourself to the group that owns the port (dialout on Debian), or install a udev rule for it"
        }
        PortError::Busy { .. } => {
            "close the other program that uses the drive; tilt stop stops a capture that runs"
        }
        _ => {
            "see whether the drive is plugged in and switched on, and what its port is called (velomotion doctor);\n\
             --device sim needs no hardware"
        }
    };
    Failure::new(Kind::NoDevice, error.to_string()).help(help)
}
