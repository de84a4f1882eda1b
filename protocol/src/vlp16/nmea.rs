//! Date, time and position of NMEA 0183 RMC sentences.

use core::fmt;

use thiserror::Error;

use super::position::NMEA_AT;

/// Seconds of a day.
const DAY_S: i64 = 86_400;
/// Two-digit years from here on belong to the twentieth century: GPS time begins in 1980.
const FIRST_YEAR: u16 = 80;

/// Date, time, position and validity of an RMC sentence (`$GPRMC`, or of another talker such as
/// `$GNRMC`), its checksum verified.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rmc {
    /// Whether the receiver declares the data valid: status A, not V.
    pub valid: bool,
    /// Date and time; `None` where the receiver does not know them, which only status V permits.
    pub utc: Option<UtcTime>,
    /// Position; `None` where the receiver does not know it.
    pub position: Option<GpsPosition>,
}

/// A position in WGS 84.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GpsPosition {
    /// Degrees, positive in the north.
    pub latitude_deg: f64,
    /// Degrees, positive in the east.
    pub longitude_deg: f64,
}

impl GpsPosition {
    /// From `ddmm.mm`, `N` or `S`, `dddmm.mm`, `E` or `W`.
    fn parse([latitude, north, longitude, east]: [&[u8]; 4]) -> Option<Self> {
        let sign = |letter: &[u8], [positive, negative]: [u8; 2]| match letter {
            [letter] if *letter == positive => Some(1.0),
            [letter] if *letter == negative => Some(-1.0),
            _ => None,
        };
        let within = |value: f64, limit: f64| (value.abs() <= limit).then_some(value);
        let latitude_deg = sign(north, *b"NS")? * degrees(latitude, 2)?;
        let longitude_deg = sign(east, *b"EW")? * degrees(longitude, 3)?;
        Some(Self {
            latitude_deg: within(latitude_deg, 90.0)?,
            longitude_deg: within(longitude_deg, 180.0)?,
        })
    }
}

/// Degrees from `digits` digits of degrees, two of minutes, and a fraction of a minute.
fn degrees(field: &[u8], digits: usize) -> Option<f64> {
    let (whole, minutes) = field.split_at_checked(digits)?;
    let [b'0'..=b'5', b'0'..=b'9', ..] = minutes else {
        return None;
    };
    let number = |text| core::str::from_utf8(text).ok()?.parse::<f64>().ok();
    let is_plain = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    if !field.iter().all(is_plain) || whole.contains(&b'.') {
        return None;
    }
    Some(number(whole)? + number(minutes)? / 60.0)
}

/// An existing date and time of day, UTC.
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
    /// 0 to 60: 60 is a leap second.
    pub second: u8,
    /// 0 to 999,999,999.
    pub nanosecond: u32,
}

/// Reason why a sentence gives no time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("NMEA sentence offset {offset}: expected {fault}")]
#[non_exhaustive]
pub struct NmeaError {
    /// Offset in the payload of the position packet in bytes.
    pub offset: usize,
    /// The expected text.
    pub fault: NmeaFault,
}

/// The fault in a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmeaFault {
    /// There is no sentence: no receiver is connected.
    Absent,
    /// It does not begin like an RMC sentence; its first bytes, padded with blanks.
    NotRmc([u8; 6]),
    /// It ends without `*` and two hexadecimal digits.
    NoChecksum,
    /// The checksum does not match.
    Checksum {
        /// The checksum of the bytes.
        expected: u8,
        /// The checksum in the sentence.
        got: u8,
    },
    /// A field has a wrong value; the expected one.
    Field(&'static str),
}

impl fmt::Display for NmeaFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => f.write_str("a sentence, got none"),
            Self::NotRmc(got) => {
                let got = core::str::from_utf8(got).unwrap_or("bytes that are no text");
                write!(f, "$..RMC, got {got:?}")
            }
            Self::NoChecksum => f.write_str("a checksum, got the end of the sentence"),
            Self::Checksum { expected, got } => {
                write!(f, "checksum {expected:02X}, got {got:02X}")
            }
            Self::Field(expected) => f.write_str(expected),
        }
    }
}

impl NmeaFault {
    const fn at(self, offset: usize) -> NmeaError {
        let fault = self;
        NmeaError { offset, fault }
    }
}

impl Rmc {
    /// Parses a sentence without its line end: `$GPRMC,hhmmss.ss,A,...,ddmmyy,...*hh`.
    ///
    /// # Errors
    /// [`NmeaError`]; its offsets assume the place of the sentence in a position packet.
    pub fn parse(sentence: &[u8]) -> Result<Self, NmeaError> {
        let body = Self::checked(sentence)?;
        // $ttRMC, time, status, latitude, N/S, longitude, E/W, speed, course, date.
        let mut next = NMEA_AT + 1;
        let mut fields = body.split(|&byte| byte == b',').map(|field| {
            let offset = next;
            next += field.len() + 1;
            (offset, field)
        });
        let absent = (NMEA_AT + sentence.len(), &[][..]);
        let time = fields.nth(1).unwrap_or(absent);
        let (status_at, status) = fields.next().unwrap_or(absent);
        let position = [(); 4].map(|()| fields.next().unwrap_or(absent).1);
        // Speed and course come before the date.
        let date = fields.nth(2).unwrap_or(absent);
        let valid = match status {
            b"A" => true,
            b"V" => false,
            _ => return Err(NmeaFault::Field("status A or V").at(status_at)),
        };
        let unknown = !valid && (time.1.is_empty() || date.1.is_empty());
        let utc = if unknown {
            None
        } else {
            Some(UtcTime::parse(time, date)?)
        };
        Ok(Self {
            valid,
            utc,
            position: GpsPosition::parse(position),
        })
    }

    /// The bytes between `$` and `*` of an RMC sentence with a matching checksum.
    fn checked(sentence: &[u8]) -> Result<&[u8], NmeaError> {
        let (b"$", [_, _, b'R', b'M', b'C', b',', ..]) = sentence.split_at(sentence.len().min(1))
        else {
            let mut got = [b' '; 6];
            for (to, from) in got.iter_mut().zip(sentence) {
                *to = *from;
            }
            return Err(match sentence {
                [] => NmeaFault::Absent,
                _ => NmeaFault::NotRmc(got),
            }
            .at(NMEA_AT));
        };
        let star = sentence.iter().position(|&byte| byte == b'*');
        let offset = star.unwrap_or(sentence.len());
        let (body, sum) = sentence.split_at(offset);
        let offset = NMEA_AT + offset;
        let &[b'*', high, low] = sum else {
            return Err(NmeaFault::NoChecksum.at(offset));
        };
        let digit = |byte| char::from(byte).to_digit(16);
        let (Some(high), Some(low)) = (digit(high), digit(low)) else {
            return Err(NmeaFault::Field("two hexadecimal digits after *").at(offset));
        };
        let body = body.get(1..).unwrap_or_default();
        let expected = body.iter().fold(0, |sum, byte| sum ^ byte);
        let got = (high << 4 | low) as u8;
        if got != expected {
            return Err(NmeaFault::Checksum { expected, got }.at(offset));
        }
        Ok(body)
    }
}

impl UtcTime {
    /// From `hhmmss` with or without a fraction, and `ddmmyy`, each with its offset.
    fn parse(
        (time_at, time): (usize, &[u8]),
        (date_at, date): (usize, &[u8]),
    ) -> Result<Self, NmeaError> {
        const TIME: NmeaFault = NmeaFault::Field("a time hhmmss or hhmmss.sss below 24 hours");
        const DATE: NmeaFault = NmeaFault::Field("a date ddmmyy that exists");
        let (hhmmss, fraction) = time.split_at_checked(6).ok_or(TIME.at(time_at))?;
        let (Some([hour @ ..=23, minute @ ..=59, second @ ..=60]), Some(nanosecond)) =
            (pairs(hhmmss), nanoseconds(fraction))
        else {
            return Err(TIME.at(time_at));
        };
        let [day, month, yy] = pairs(date).ok_or(DATE.at(date_at))?;
        let yy = u16::from(yy);
        let year = yy + if yy >= FIRST_YEAR { 1900 } else { 2000 };
        if day == 0 || day > days_of(year, month) {
            return Err(DATE.at(date_at));
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

    /// Nanoseconds since 1970-01-01 UTC in Unix time: a leap second equals the first second of the
    /// next day.
    #[must_use]
    pub fn unix_nanos(&self) -> i64 {
        let [hour, minute, second] = [self.hour, self.minute, self.second].map(i64::from);
        let of_day = hour * 3_600 + minute * 60 + second;
        (self.days_since_1970() * DAY_S + of_day) * 1_000_000_000 + i64::from(self.nanosecond)
    }

    fn days_since_1970(&self) -> i64 {
        let years = i64::from(self.year) - 1970;
        // Every fourth year from 1972 to 2079 is a leap year, 2000 included.
        let leap_days = (years + 1).div_euclid(4);
        let months = (1..self.month).map(|month| i64::from(days_of(self.year, month)));
        years * 365 + leap_days + months.sum::<i64>() + i64::from(self.day) - 1
    }
}

/// Days of a month; 0 for a month that does not exist. Leap years as of 1980 to 2079.
const fn days_of(year: u16, month: u8) -> u8 {
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if year.is_multiple_of(4) => 29,
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

/// A fraction of a second with its point, or nothing; digits after the ninth are ignored.
fn nanoseconds(fraction: &[u8]) -> Option<u32> {
    let Some((b'.', digits)) = fraction.split_first() else {
        return fraction.is_empty().then_some(0);
    };
    let (mut ns, mut unit) = (0, 100_000_000);
    for &digit in digits {
        ns += u32::from(decimal(digit)?) * unit;
        unit /= 10;
    }
    Some(ns)
}

fn decimal(digit: u8) -> Option<u8> {
    digit.is_ascii_digit().then(|| digit - b'0')
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::format;
    use std::string::{String, ToString};

    use super::*;

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
    fn published_sentences_give_the_known_times() {
        // Two sentences of the NMEA 0183 literature, checksums included; seconds from `date -u -d`.
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
        // Fractions are kept to the nanosecond.
        let rmc = Rmc::parse(sentence("101112.0000000019", "A", "131015").as_bytes()).unwrap();
        assert_eq!(rmc.utc.unwrap().nanosecond, 1);
    }

    #[test]
    fn positions_are_signed_degrees() {
        let at = |latitude: &str, north: &str, longitude: &str, east: &str| {
            let body =
                format!("GPRMC,123519,A,{latitude},{north},{longitude},{east},0,0,230394,0,W");
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            let rmc = Rmc::parse(format!("${body}*{sum:02X}").as_bytes()).unwrap();
            let position = rmc.position?;
            Some([position.latitude_deg, position.longitude_deg])
        };
        assert_eq!(at("4807.5", "N", "01131.2", "E"), Some([48.125, 11.52]));
        assert_eq!(at("0030", "S", "18000.0", "W"), Some([-0.5, -180.0]));
        for (latitude, longitude) in [
            ("9000.1", "01131.2"),
            ("4807.5", "18000.1"),
            ("4860.0", "01131.2"),
            ("-807.5", "01131.2"),
            ("4807e1", "01131.2"),
            ("48", "01131.2"),
            ("", ""),
        ] {
            assert_eq!(at(latitude, "N", longitude, "E"), None, "{latitude}");
        }
        assert_eq!(at("4807.5", "E", "01131.2", "N"), None);
    }

    #[test]
    fn two_digit_years_and_leap_years() {
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
    fn a_leap_second_equals_the_first_second_of_the_next_day() {
        assert_eq!(unix_s("235960", "311216"), Some(1_483_228_800));
        assert_eq!(unix_s("000000", "010117"), Some(1_483_228_800));
        for no_time in [
            "235961", "240000", "006000", "2359", "235959,5", "23595a", "235959x5",
        ] {
            assert_eq!(unix_s(no_time, "311216"), None, "{no_time}");
        }
    }

    #[test]
    fn a_receiver_without_a_fix_is_not_valid() {
        let rmc = Rmc::parse(sentence("", "V", "").as_bytes()).unwrap();
        assert_eq!((rmc.valid, rmc.utc), (false, None));
        let rmc = Rmc::parse(sentence("101112.5", "V", "131415").as_bytes());
        assert!(rmc.is_err(), "month 14");
        let rmc = Rmc::parse(sentence("101112.5", "V", "131015").as_bytes()).unwrap();
        assert!(!rmc.valid && rmc.utc.is_some());
        // A valid status requires a time.
        assert!(Rmc::parse(sentence("", "A", "131015").as_bytes()).is_err());
    }

    #[test]
    fn errors_name_offset_and_cause() {
        let good = sentence("101112", "A", "131015");
        let message = |text: &str| Rmc::parse(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            message(""),
            "NMEA sentence offset 206: expected a sentence, got none"
        );
        assert_eq!(
            message("$GPGGA,1"),
            "NMEA sentence offset 206: expected $..RMC, got \"$GPGGA\""
        );
        assert_eq!(
            message(good.split('*').next().unwrap()),
            "NMEA sentence offset 261: expected a checksum, got the end of the sentence"
        );
        let flipped = good.replacen("101112", "101113", 1);
        assert!(message(&flipped).starts_with("NMEA sentence offset 261: expected checksum "));
        assert_eq!(
            message(&sentence("101112", "B", "131015")),
            "NMEA sentence offset 220: expected status A or V"
        );
        assert_eq!(
            message(&sentence("101112", "A", "311115")),
            "NMEA sentence offset 249: expected a date ddmmyy that exists"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn a_flipped_bit_never_gives_another_time(at in 0usize..60, bit in 0u8..8) {
            let good = sentence("101112.25", "A", "131015");
            let mut bytes = good.clone().into_bytes();
            prop_assert!(bytes.len() >= 60);
            bytes[at] ^= 1 << bit;
            if let Ok(rmc) = Rmc::parse(&bytes) {
                // Another talker, or the letter case of the checksum.
                prop_assert_eq!(rmc, Rmc::parse(good.as_bytes()).unwrap());
            }
        }

        #[test]
        fn consecutive_days_are_86400_seconds_apart(day in 0i64..36_524) {
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
        fn arbitrary_sentences_do_not_panic(text in prop::collection::vec(any::<u8>(), 0..80), rmc: bool) {
            let mut bytes = text;
            if rmc {
                bytes.splice(0..0, *b"$GPRMC,");
                let sum = bytes.iter().skip(1).fold(0, |sum, byte| sum ^ byte);
                bytes.extend(format!("*{sum:02X}").bytes());
            }
            let _ = Rmc::parse(&bytes);
        }
    }
}
