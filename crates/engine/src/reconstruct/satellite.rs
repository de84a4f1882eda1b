//! Place and pulse of the lidar's satellite receiver, from its position packets.

use protocol::vlp16::{GpsPosition, PositionPacket, Pps};

use super::report::GpsReport;

/// Last values of the position packets.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SatelliteReceiver {
    pub pps: Option<Pps>,
    position: Option<GpsPosition>,
    /// The last position that the receiver declares valid.
    fix: Option<GpsPosition>,
}

impl SatelliteReceiver {
    /// Takes a position packet. Sentences without a position leave the last one.
    pub fn observe(&mut self, packet: &PositionPacket<'_>) {
        self.pps = Some(packet.pps());
        let Ok(rmc) = packet.rmc() else {
            return;
        };
        self.position = rmc.position.or(self.position);
        if rmc.valid {
            self.fix = rmc.position.or(self.fix);
        }
    }

    /// Place of the antenna, perhaps remembered from before the receiver had a fix.
    pub fn position(&self) -> Option<GpsReport> {
        self.position.map(|position| GpsReport {
            latitude_deg: position.latitude_deg,
            longitude_deg: position.longitude_deg,
        })
    }

    /// Comment in a cloud's metadata; `None` without a fix.
    ///
    /// Neither height nor heading is in the packets, so that the cloud stays in its local frame. A
    /// receiver without corrections is right to metres.
    pub fn comment(&self) -> Option<String> {
        let position = self.fix?;
        let pps = self.pps.map_or_else(|| "unknown".to_owned(), pps_name);
        Some(format!(
            "satellite receiver at {:.6}, {:.6} deg (WGS 84, to metres), pulse {pps}; coordinates are local",
            position.latitude_deg, position.longitude_deg
        ))
    }
}

/// Word for the state of the pulse per second.
pub(super) fn pps_name(pps: Pps) -> String {
    match pps {
        Pps::Absent => "absent".to_owned(),
        Pps::Synchronising => "synchronising".to_owned(),
        Pps::Locked => "locked".to_owned(),
        Pps::Error => "error".to_owned(),
        Pps::Unknown(byte) => format!("unknown (0x{byte:02x})"),
    }
}

#[cfg(test)]
mod tests {
    use firmware_sim::vlp16::position_packet;

    use super::*;

    fn sentence(status: char) -> String {
        let body =
            format!("GPRMC,101112,{status},4807.038,N,01131.000,E,022.4,084.4,230326,003.1,W");
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${body}*{sum:02X}\r\n")
    }

    #[test]
    fn a_remembered_place_without_a_fix_is_in_no_cloud() {
        let mut receiver = SatelliteReceiver::default();
        for (status, comment) in [
            ('V', None),
            (
                'A',
                Some(
                    "satellite receiver at 48.117300, 11.516667 deg (WGS 84, to metres), pulse locked; coordinates are local",
                ),
            ),
        ] {
            let bytes = position_packet(17, Pps::Locked, sentence(status).as_bytes());
            receiver.observe(&PositionPacket::new(&bytes).unwrap());
            assert!(receiver.position().is_some());
            assert_eq!(receiver.comment().as_deref(), comment);
        }
    }
}
