//! The position packet: fields equal the bytes for any content; a second parser confirms a
//! sentence's time.

use firmware_sim::vlp16::position_packet;
use lidar::{Decoder, Options};
use protocol::vlp16::{NmeaError, POSITION_LEN, PositionPacket, Pps, Rmc, UtcTime};
use units::Stamp;

use super::input::Input;

/// Mode 0: any payload, parsed twice and counted once. 1: a generated packet, read back. 2: any
/// sentence with a valid checksum. Else a sentence of any date and time.
pub fn holds(data: &[u8]) {
    let mut input = Input::new(data);
    match input.u8() % 4 {
        0 => any_payload(input.rest()),
        1 => own_packet(&mut input),
        2 => any_sentence(&summed(input.rest())),
        _ => own_sentence(&mut input),
    }
}

fn any_payload(payload: &[u8]) {
    let packet = PositionPacket::new(payload);
    assert_eq!(packet.is_ok(), payload.len() == POSITION_LEN);
    counted_once(payload);
    let Ok(packet) = packet else { return };
    // Manual 9.3.3: time at 198, PPS at 202, the sentence from 206.
    assert_eq!(packet.timestamp_us().to_le_bytes(), payload[198..202]);
    let state = match packet.pps() {
        Pps::Absent => 0,
        Pps::Synchronising => 1,
        Pps::Locked => 2,
        Pps::Error => 3,
        Pps::Unknown(state) => state,
    };
    assert_eq!(state, payload[202]);
    let nmea = packet.nmea();
    assert!(payload[206..].starts_with(nmea));
    assert!(!nmea.iter().any(|byte| b"\r\n\0".contains(byte)));
    assert!(
        payload
            .get(206 + nmea.len())
            .is_none_or(|byte| b"\r\n\0".contains(byte))
    );
    assert_eq!(packet.rmc(), Rmc::parse(nmea));
    any_sentence(nmea);
}

/// `body` as a sentence with checksum.
fn summed(body: &[u8]) -> Vec<u8> {
    let sum = body.iter().fold(0, |sum, byte| sum ^ byte);
    [b"$", body, format!("*{sum:02X}").as_bytes()].concat()
}

fn any_sentence(sentence: &[u8]) {
    let rmc = match Rmc::parse(sentence) {
        Ok(rmc) => rmc,
        Err(error) => return offset_is_inside(&error, sentence.len()),
    };
    let star = sentence.len() - 3;
    let (body, sum) = sentence.split_at(star);
    assert_eq!(
        summed(&body[1..])[star..].to_ascii_uppercase(),
        sum.to_ascii_uppercase()
    );
    assert!(rmc.utc.is_some() || !rmc.valid);
    let fields: Vec<_> = body.split(|&byte| byte == b',').collect();
    assert_eq!(fields[2], if rmc.valid { b"A" } else { b"V" });
    let Some(utc) = rmc.utc else { return };
    let (time, date) = (fields[1], fields[9]);
    let text = format!("{:02}{:02}{:02}", utc.hour, utc.minute, utc.second);
    assert_eq!(&time[..6], text.as_bytes());
    let text = format!("{:02}{:02}{:02}", utc.day, utc.month, utc.year % 100);
    assert_eq!(date, text.as_bytes());
    date_counts_back(&utc);
}

/// An error points into the sentence or to its end.
fn offset_is_inside(error: &NmeaError, len: usize) {
    assert!((206..=206 + len).contains(&error.offset), "{error}");
    assert!(!error.to_string().is_empty());
}

/// The date of a Unix time, computed in eras of 400 years from March on, equals the original.
fn date_counts_back(utc: &UtcTime) {
    let nanos = utc.unix_nanos();
    assert_eq!(nanos.rem_euclid(1_000_000_000), i64::from(utc.nanosecond));
    // A leap second is the first second of the next minute.
    let seconds = nanos.div_euclid(1_000_000_000) - i64::from(utc.second);
    let of_day = seconds.rem_euclid(86_400);
    assert_eq!(
        of_day / 60,
        i64::from(utc.hour) * 60 + i64::from(utc.minute)
    );
    let (year, month, day) = civil(seconds.div_euclid(86_400));
    let expected = (utc.year.into(), utc.month.into(), utc.day.into());
    assert_eq!((year, month, day), expected);
}

/// Year, month and day of a number of days after 1970-01-01.
fn civil(days: i64) -> (i64, i64, i64) {
    // Days since 0000-03-01.
    let days = days + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    (400 * era + year + i64::from(month <= 2), month, day)
}

/// Digits of a date and a time, possibly invalid ones.
fn own_sentence(input: &mut Input<'_>) {
    let mut two = || input.u8() % 100;
    let [hour, minute, second, day, month, year] = std::array::from_fn(|_| two());
    let status = if input.u8() & 1 == 0 { "A" } else { "V" };
    let body = format!(
        "GNRMC,{hour:02}{minute:02}{second:02}.5,{status},,,,,,,{day:02}{month:02}{year:02},,"
    );
    let year = i64::from(year) + if year >= 80 { 1900 } else { 2000 };
    let wanted = (year, i64::from(month), i64::from(day));
    let around = 365 * (wanted.0 - 1970) + 30 * wanted.1;
    let exists = (around - 70..around + 70)
        .map(civil)
        .any(|date| date == wanted);
    let sound = exists && hour < 24 && minute < 60 && second <= 60;
    let rmc = Rmc::parse(&summed(body.as_bytes()));
    let utc = rmc.ok().and_then(|rmc| rmc.utc);
    assert_eq!(utc.is_some(), sound, "{body}");
    if let Some(utc) = utc {
        assert_eq!(utc.nanosecond, 500_000_000);
        assert_eq!(i64::from(utc.year), year);
        date_counts_back(&utc);
    }
}

/// Any payload: the decoder counts it in one class and emits nothing.
fn counted_once(payload: &[u8]) {
    let mut decoder = Decoder::new(Options::default());
    let mut firings = 0;
    decoder.packet(Stamp::from_nanos(0), payload, &mut |_| firings += 1);
    let stats = decoder.stats();
    let counts = [stats.data, stats.position, stats.malformed, stats.other];
    assert_eq!(counts.iter().sum::<u64>(), 1);
    assert_eq!(firings, 0, "a packet is held until its successor is there");
    // A payload of this length that starts like a data packet is a damaged data packet.
    if payload.len() == POSITION_LEN && !payload.starts_with(&[0xFF, 0xEE]) {
        assert_eq!(stats.position, 1);
    }
}

fn own_packet(input: &mut Input<'_>) {
    let timestamp_us = input.u32();
    let pps = [Pps::Absent, Pps::Synchronising, Pps::Locked, Pps::Error];
    let pps = pps[usize::from(input.u8() % 4)];
    let nmea = input.rest();
    let payload = position_packet(timestamp_us, pps, nmea);
    let packet = PositionPacket::new(&payload).expect("of the right length");
    assert_eq!(packet.timestamp_us(), timestamp_us % 3_600_000_000);
    assert_eq!(packet.pps(), pps);
    let kept = &nmea[..nmea.len().min(128)];
    let end = kept.iter().position(|byte| b"\r\n\0".contains(byte));
    assert_eq!(packet.nmea(), &kept[..end.unwrap_or(kept.len())]);
    any_payload(&payload);
}
