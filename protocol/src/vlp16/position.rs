//! The position packet: the sensor's own time, the state of its PPS input and the last NMEA sentence (manual 9.3.3).
//!
//! Of the sentence, time, date and validity are read ([`Rmc`]). Deliberately absent: where the receiver is and how it moves,
//! and the inertial data of the HDL-32E's first 198 bytes.

use thiserror::Error;

use super::PacketError;

/// Length of a position packet's UDP payload in bytes.
pub const POSITION_LEN: usize = 512;

const LAYER: &str = "lidar position packet";
const TIMESTAMP_AT: usize = 198;
const PPS_AT: usize = 202;
const NMEA_AT: usize = 206;

// Manual table 9-3: timestamp, PPS status and three reserved bytes precede the sentence.
const _: () = assert!(TIMESTAMP_AT + 4 == PPS_AT && PPS_AT + 1 + 3 == NMEA_AT);

/// A position packet's payload, found to have the right length.
#[derive(Clone, Copy, Debug)]
pub struct PositionPacket<'a> {
    status: &'a [u8; NMEA_AT - TIMESTAMP_AT],
    sentence: &'a [u8],
}

/// State of the pulse-per-second input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pps {
    /// 0: no pulse; the clock runs free.
    Absent,
    /// 1: pulses seen, not yet locked.
    Synchronising,
    /// 2: the clock follows the pulse.
    Locked,
    /// 3: the pulse is in error.
    Error,
    /// A state that is not listed.
    Unknown(u8),
}

impl<'a> PositionPacket<'a> {
    /// Checks the length. Nothing else in the packet can be checked: unused bytes are not always zero.
    ///
    /// # Errors
    /// [`PacketError::Length`].
    pub fn new(payload: &'a [u8]) -> Result<Self, PacketError> {
        Self::view(payload).ok_or(PacketError::Length {
            layer: LAYER,
            expected: POSITION_LEN,
            got: payload.len(),
        })
    }

    fn view(payload: &'a [u8]) -> Option<Self> {
        let payload: &[u8; POSITION_LEN] = payload.try_into().ok()?;
        let (_, rest) = payload.split_at_checked(TIMESTAMP_AT)?;
        let (status, sentence) = rest.split_first_chunk()?;
        Some(Self { status, sentence })
    }

    /// When the packet was put together: microseconds past the hour. It may be out of order with the data packets'.
    #[must_use]
    pub const fn timestamp_us(&self) -> u32 {
        let [a, b, c, d, ..] = *self.status;
        u32::from_le_bytes([a, b, c, d])
    }

    /// State of the PPS input.
    #[must_use]
    pub const fn pps(&self) -> Pps {
        match self.status[PPS_AT - TIMESTAMP_AT] {
            0 => Pps::Absent,
            1 => Pps::Synchronising,
            2 => Pps::Locked,
            3 => Pps::Error,
            other => Pps::Unknown(other),
        }
    }

    /// The NMEA sentence without its line end; empty without a receiver. Not promised to be text.
    #[must_use]
    pub fn nmea(&self) -> &'a [u8] {
        self.sentence
            .split(|&byte| matches!(byte, b'\r' | b'\n' | 0))
            .next()
            .unwrap_or_default()
    }

    /// What the sentence says of time.
    ///
    /// # Errors
    /// [`NmeaError`], with offsets into the payload.
    pub fn rmc(&self) -> Result<Rmc, NmeaError> {
        Rmc::parse(self.nmea())
    }
}

const NMEA: &str = "NMEA sentence";
/// Seconds of a day.
const DAY_S: i64 = 86_400;
/// Two-digit years from here on are of the twentieth century: GPS time begins in 1980.
const FIRST_YEAR: u16 = 80;

/// Date, time and validity of an RMC sentence (`$GPRMC`, or of another talker such as `$GNRMC`), its checksum verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rmc {
    /// Whether the receiver vouches for it: status A, not V.
    pub valid: bool,
    /// Date and time; `None` where the receiver knows neither, which only a sentence of status V may leave out.
    pub utc: Option<UtcTime>,
}

/// A date and time of day, UTC, that exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct UtcTime {
    /// 1980 to 2079: the sentence has two digits.
    pub year: u16,
    /// 1 to 12.
    pub month: u8,
    /// 1 to 31.
    pub day: u8,
    /// 0 to 23.
    pub hour: u8,
    /// 0 to 59.
    pub minute: u8,
    /// 0 to 60: a leap second is the 60th.
    pub second: u8,
    /// Below a thousand million.
    pub nanosecond: u32,
}

/// Why a sentence says nothing of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NmeaError {
    /// There is none: no receiver is connected.
    #[error("{layer} offset {offset}: expected a sentence, got none")]
    Absent {
        /// What was read.
        layer: &'static str,
        /// Offset in the position packet's payload in bytes.
        offset: usize,
    },
    /// It does not begin like an RMC sentence.
    #[error("{layer} offset {offset}: expected $..RMC, got {:?}", core::str::from_utf8(got).unwrap_or("bytes that are no text"))]
    NotRmc {
        /// What was read.
        layer: &'static str,
        /// Offset in the position packet's payload in bytes.
        offset: usize,
        /// How it begins, filled up with blanks.
        got: [u8; 6],
    },
    /// It ends without `*` and two hexadecimal digits.
    #[error("{layer} offset {offset}: expected a checksum, got the end of the sentence")]
    NoChecksum {
        /// What was read.
        layer: &'static str,
        /// Offset in the position packet's payload in bytes.
        offset: usize,
    },
    /// Its checksum is not that of its bytes.
    #[error("{layer} offset {offset}: expected checksum {expected:02X}, got {got:02X}")]
    Checksum {
        /// What was read.
        layer: &'static str,
        /// Offset in the position packet's payload in bytes.
        offset: usize,
        /// The checksum of its bytes.
        expected: u8,
        /// The one it carries.
        got: u8,
    },
    /// A field is not what it has to be.
    #[error("{layer} offset {offset}: expected {expected}")]
    Field {
        /// What was read.
        layer: &'static str,
        /// Offset of the field in the position packet's payload in bytes.
        offset: usize,
        /// What belongs there.
        expected: &'static str,
    },
}

impl Rmc {
    /// Reads a sentence without its line end, as NMEA 0183 has it: `$GPRMC,hhmmss.ss,A,...,ddmmyy,...*hh`.
    ///
    /// # Errors
    /// [`NmeaError`]; its offsets are of a sentence at its place in a position packet.
    pub fn parse(sentence: &[u8]) -> Result<Self, NmeaError> {
        let body = Self::checked(sentence)?;
        // $ttRMC, time, status, latitude, N/S, longitude, E/W, speed, course, date.
        let mut offset = NMEA_AT + 1;
        let mut fields = body.split(|&byte| byte == b',').map(|field| {
            let at = offset;
            offset += field.len() + 1;
            (at, field)
        });
        let absent = (NMEA_AT + sentence.len(), &[][..]);
        let (time_at, time) = fields.nth(1).unwrap_or(absent);
        let (status_at, status) = fields.next().unwrap_or(absent);
        let (date_at, date) = fields.nth(6).unwrap_or(absent);
        let valid = match status {
            b"A" => true,
            b"V" => false,
            _ => return Err(wrong(status_at, "status A or V")),
        };
        let utc = if !valid && (time.is_empty() || date.is_empty()) {
            None
        } else {
            Some(UtcTime::new((time_at, time), (date_at, date))?)
        };
        Ok(Self { valid, utc })
    }

    /// The bytes between `$` and `*`, found to be an RMC sentence with the checksum that it carries.
    fn checked(sentence: &[u8]) -> Result<&[u8], NmeaError> {
        let Some((&first, rest)) = sentence.split_first() else {
            return Err(NmeaError::Absent {
                layer: NMEA,
                offset: NMEA_AT,
            });
        };
        if first != b'$' || rest.get(2..5) != Some(b"RMC") || rest.get(5) != Some(&b',') {
            let mut got = [b' '; 6];
            for (to, from) in got.iter_mut().zip(sentence) {
                *to = *from;
            }
            return Err(NmeaError::NotRmc {
                layer: NMEA,
                offset: NMEA_AT,
                got,
            });
        }
        let star = rest.iter().position(|&byte| byte == b'*');
        let (body, sum) = rest.split_at(star.unwrap_or(rest.len()));
        let offset = NMEA_AT + 1 + body.len();
        let &[b'*', high, low] = sum else {
            return Err(NmeaError::NoChecksum {
                layer: NMEA,
                offset,
            });
        };
        let (Some(high), Some(low)) = (hex(high), hex(low)) else {
            return Err(wrong(offset, "two hexadecimal digits after *"));
        };
        let expected = body.iter().fold(0, |sum, byte| sum ^ byte);
        let got = high << 4 | low;
        if got == expected {
            Ok(body)
        } else {
            Err(NmeaError::Checksum {
                layer: NMEA,
                offset,
                expected,
                got,
            })
        }
    }
}

impl UtcTime {
    /// From `hhmmss` with or without a fraction, and `ddmmyy`, each with its offset.
    fn new(
        (time_at, time): (usize, &[u8]),
        (date_at, date): (usize, &[u8]),
    ) -> Result<Self, NmeaError> {
        const TIME: &str = "a time hhmmss or hhmmss.sss below 24 hours";
        const DATE: &str = "a date ddmmyy that exists";
        let (hhmmss, fraction) = time.split_at_checked(6).ok_or(wrong(time_at, TIME))?;
        let (Some([hour, minute, second]), Some(nanosecond)) =
            (pairs(hhmmss), nanoseconds(fraction))
        else {
            return Err(wrong(time_at, TIME));
        };
        if hour > 23 || minute > 59 || second > 60 {
            return Err(wrong(time_at, TIME));
        }
        let [day, month, yy] = pairs(date).ok_or(wrong(date_at, DATE))?;
        let yy = u16::from(yy);
        let year = if yy >= FIRST_YEAR {
            1900 + yy
        } else {
            2000 + yy
        };
        if day == 0 || day > days_of(year, month) {
            return Err(wrong(date_at, DATE));
        }
        Ok(Self {
            year,
            month,
            day,
            hour,
            minute,
            second,
            nanosecond,
        })
    }

    /// Nanoseconds since 1970-01-01 UTC, as Unix counts them: a leap second is the first second of the next day.
    #[must_use]
    pub fn unix_nanos(&self) -> i64 {
        let seconds =
            i64::from(self.hour) * 3_600 + i64::from(self.minute) * 60 + i64::from(self.second);
        let day_s = self.days_since_1970() * DAY_S;
        (day_s + seconds) * 1_000_000_000 + i64::from(self.nanosecond)
    }

    fn days_since_1970(&self) -> i64 {
        let years = i64::from(self.year) - 1970;
        // 1972 was a leap year, and every fourth year from it to 2079 is: 2000 is one of the 400th.
        let leap_days = (years + 1).div_euclid(4);
        let months = (1..self.month).map(|month| i64::from(days_of(self.year, month)));
        years * 365 + leap_days + months.sum::<i64>() + i64::from(self.day) - 1
    }
}

/// Days of a month; 0 for a month that is none.
const fn days_of(year: u16, month: u8) -> u8 {
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400)) => {
            29
        }
        2 => 28,
        _ => 0,
    }
}

/// Three numbers of two digits.
fn pairs(digits: &[u8]) -> Option<[u8; 3]> {
    let &[a, b, c, d, e, f] = digits else {
        return None;
    };
    let number = |high: u8, low: u8| Some(10 * decimal(high)? + decimal(low)?);
    Some([number(a, b)?, number(c, d)?, number(e, f)?])
}

/// A fraction of a second, its point included, or nothing at all; digits beyond the ninth count for nothing.
fn nanoseconds(fraction: &[u8]) -> Option<u32> {
    let Some((&point, digits)) = fraction.split_first() else {
        return Some(0);
    };
    let (mut ns, mut unit) = (0, 100_000_000);
    for &digit in digits {
        ns += u32::from(decimal(digit)?) * unit;
        unit /= 10;
    }
    (point == b'.').then_some(ns)
}

const fn decimal(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        _ => None,
    }
}

const fn hex(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    }
}

const fn wrong(offset: usize, expected: &'static str) -> NmeaError {
    NmeaError::Field {
        layer: NMEA,
        offset,
        expected,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::format;
    use std::string::{String, ToString};
    use std::vec;

    /// A sentence with its checksum.
    fn sentence(time: &str, status: &str, date: &str) -> String {
        let body = format!("GPRMC,{time},{status},3649.7,N,00224.4,W,0.0,0.0,{date},0.0,E");
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${body}*{sum:02X}")
    }

    fn unix_s(time: &str, date: &str) -> Option<i64> {
        let rmc = Rmc::parse(sentence(time, "A", date).as_bytes()).ok()?;
        let ns = rmc.utc?.unix_nanos();
        assert_eq!(ns % 1_000_000_000, 0);
        Some(ns / 1_000_000_000)
    }

    #[test]
    fn a_sentence_from_the_wire_is_a_time() {
        // Two sentences that texts on NMEA 0183 print, checksums included; seconds from `date -u -d`.
        let at = |wire: &[u8]| {
            let rmc = Rmc::parse(wire).unwrap();
            assert!(rmc.valid);
            rmc.utc.unwrap().unix_nanos() / 1_000_000_000
        };
        let wire = b"$GPRMC,225446,A,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E*68";
        assert_eq!(at(wire), 785_285_686);
        let wire = b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A";
        assert_eq!(at(wire), 764_426_119);
        // Another talker: N for P.
        let wire = b"$GNRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*74";
        assert_eq!(at(wire), 764_426_119);
        // Any fraction is kept to the nanosecond.
        let rmc = Rmc::parse(sentence("101112.0000000019", "A", "131015").as_bytes()).unwrap();
        assert_eq!(rmc.utc.unwrap().nanosecond, 1);
    }

    #[test]
    fn years_have_two_digits_and_february_sometimes_29_days() {
        // Each from `date -u -d`.
        assert_eq!(unix_s("000000", "060180"), Some(315_964_800)); // GPS time begins
        assert_eq!(unix_s("235959", "311299"), Some(946_684_799));
        assert_eq!(unix_s("000000", "010100"), Some(946_684_800));
        assert_eq!(unix_s("120000", "290200"), Some(951_825_600));
        assert_eq!(unix_s("000000.000", "010300"), Some(951_868_800));
        assert_eq!(unix_s("000000", "290224"), Some(1_709_164_800));
        assert_eq!(unix_s("000000", "311279"), Some(3_471_206_400));
        for no_date in [
            "290223", "300200", "310416", "000116", "010016", "011316", "10116", "",
        ] {
            assert_eq!(unix_s("000000", no_date), None, "{no_date}");
        }
    }

    #[test]
    fn a_leap_second_is_the_next_days_first() {
        assert_eq!(unix_s("235960", "311216"), Some(1_483_228_800));
        assert_eq!(unix_s("000000", "010117"), Some(1_483_228_800));
        for no_time in [
            "235961", "240000", "006000", "2359", "235959,5", "23595a", "235959x5",
        ] {
            assert_eq!(unix_s(no_time, "311216"), None, "{no_time}");
        }
    }

    #[test]
    fn a_receiver_without_a_fix_is_no_error_and_not_valid() {
        let rmc = Rmc::parse(sentence("", "V", "").as_bytes()).unwrap();
        assert_eq!((rmc.valid, rmc.utc), (false, None));
        let rmc = Rmc::parse(sentence("101112.5", "V", "131415").as_bytes());
        assert!(rmc.is_err(), "month 14");
        let rmc = Rmc::parse(sentence("101112.5", "V", "131015").as_bytes()).unwrap();
        assert!(!rmc.valid && rmc.utc.is_some());
        // One that vouches for a time has to have it.
        assert!(Rmc::parse(sentence("", "A", "131015").as_bytes()).is_err());
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let good = sentence("101112", "A", "131015");
        let said = |text: &str| Rmc::parse(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            said(""),
            "NMEA sentence offset 206: expected a sentence, got none"
        );
        assert_eq!(
            said("$GPGGA,1"),
            "NMEA sentence offset 206: expected $..RMC, got \"$GPGGA\""
        );
        assert_eq!(
            said(good.split('*').next().unwrap()),
            "NMEA sentence offset 261: expected a checksum, got the end of the sentence"
        );
        let flipped = good.replacen("101112", "101113", 1);
        assert!(said(&flipped).starts_with("NMEA sentence offset 261: expected checksum "));
        assert_eq!(
            said(&sentence("101112", "B", "131015")),
            "NMEA sentence offset 220: expected status A or V"
        );
        assert_eq!(
            said(&sentence("101112", "A", "311115")),
            "NMEA sentence offset 249: expected a date ddmmyy that exists"
        );
    }

    use super::*;

    #[test]
    fn golden_bytes_read_as_the_manual_says() {
        let mut bytes = [0u8; POSITION_LEN];
        bytes[198..202].copy_from_slice(&[0x01, 0x02, 0x03, 0x04]);
        bytes[202] = 2;
        let sentence = b"$GPRMC,083124,A,3650.4,N,00228.1,W,0.0,0.0,210116,1.1,W*63";
        bytes[206..206 + sentence.len()].copy_from_slice(sentence);
        bytes[206 + sentence.len()..][..2].copy_from_slice(b"\r\n");
        let packet = PositionPacket::new(&bytes).unwrap();
        assert_eq!(packet.timestamp_us(), 0x0403_0201);
        assert_eq!(packet.pps(), Pps::Locked);
        assert_eq!(packet.nmea(), sentence);
    }

    #[test]
    fn without_a_receiver_there_is_no_sentence() {
        let packet = PositionPacket::new(&[0; POSITION_LEN]).unwrap();
        assert_eq!((packet.pps(), packet.nmea()), (Pps::Absent, &b""[..]));
    }

    #[test]
    fn a_sentence_that_fills_the_packet_ends_with_it() {
        let bytes = [b'A'; POSITION_LEN];
        let packet = PositionPacket::new(&bytes).unwrap();
        assert_eq!(packet.nmea().len(), 306);
        assert_eq!(packet.pps(), Pps::Unknown(b'A'));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn a_flipped_bit_is_never_another_time(at in 0usize..60, bit in 0u8..8) {
            let good = sentence("101112.25", "A", "131015");
            let mut bytes = good.clone().into_bytes();
            prop_assert!(bytes.len() >= 60);
            bytes[at] ^= 1 << bit;
            if let Ok(rmc) = Rmc::parse(&bytes) {
                // Another talker, or the checksum's own letter case.
                prop_assert_eq!(rmc, Rmc::parse(good.as_bytes()).unwrap());
            }
        }

        #[test]
        fn days_follow_each_other(day in 0i64..36_524) {
            // The calendar counted one day at a time from 1980-01-01, 3652 days after 1970-01-01.
            let (mut year, mut month, mut left) = (1980u16, 1u8, day);
            while left >= i64::from(days_of(year, month)) {
                left -= i64::from(days_of(year, month));
                (year, month) = if month == 12 { (year + 1, 1) } else { (year, month + 1) };
            }
            let date = format!("{:02}{month:02}{:02}", left + 1, year % 100);
            prop_assert_eq!(unix_s("000000", &date), Some((3_652 + day) * 86_400));
        }

        #[test]
        fn any_sentence_is_read_or_refused(text in prop::collection::vec(any::<u8>(), 0..80), rmc: bool) {
            let mut bytes = text;
            if rmc {
                bytes.splice(0..0, *b"$GPRMC,");
                let sum = bytes.iter().skip(1).fold(0, |sum, byte| sum ^ byte);
                bytes.extend(format!("*{sum:02X}").bytes());
            }
            let _ = Rmc::parse(&bytes);
        }

        #[test]
        fn bytes_of_any_length_never_panic(len in 0usize..1300, byte: u8) {
            let bytes = vec![byte; len];
            match PositionPacket::new(&bytes) {
                Ok(packet) => prop_assert!(len == 512 && packet.nmea().len() <= 306),
                Err(error) => prop_assert_eq!(error, PacketError::Length {
                    layer: LAYER, expected: 512, got: len,
                }),
            }
        }
    }
}
