//! Parsers of the values of arguments.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use engine::lidars::{CAPTURED, LIDARS, LidarSheet};
use protocol::vlp16::LidarModel;

use super::ALL;

/// Names of the effects, and [`ALL`].
pub(super) fn effect_or_all() -> PossibleValuesParser {
    let names = sim::effect_models::EffectsConfig::NAMES.iter().copied();
    PossibleValuesParser::new(names.chain([ALL]))
}

/// Parses the name of a lidar whose packets velomotion reads.
pub(super) fn captured_model() -> impl TypedValueParser<Value = &'static LidarModel> {
    let captured = CAPTURED.into_iter().filter_map(LidarSheet::named);
    let names = captured.map(|lidar| PossibleValue::new(lidar.name).help(lidar.title));
    PossibleValuesParser::new(names).try_map(|name| {
        let lidar = LidarSheet::named(&name).and_then(|lidar| lidar.model);
        lidar.ok_or("expected the name of a lidar")
    })
}

/// Parses the name of a lidar that may be planned with.
pub(super) fn lidar_sheet() -> impl TypedValueParser<Value = &'static LidarSheet> {
    let names = PossibleValuesParser::new(LIDARS.map(|lidar| lidar.name));
    names.try_map(|name| LidarSheet::named(&name).ok_or("expected the name of a lidar"))
}

/// Parses two times, milliseconds.
pub(super) fn two_times(text: &str) -> Result<(u16, u16), String> {
    text.split_once(',')
        .and_then(|(open, close)| Some((open.parse().ok()?, close.parse().ok()?)))
        .ok_or_else(|| "expected two times from 0 to 65535 ms: OPEN,CLOSE".to_owned())
}

/// Parses an acceleration of the axis, deg/s2; 1e6 is far beyond any motor.
pub(super) fn acceleration(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= 1e6 => Ok(value),
        _ => Err("expected an acceleration from -1000000 to 1000000 deg/s2".to_owned()),
    }
}

/// Parses a deceleration of the axis, deg/s2.
pub(super) fn deceleration(text: &str) -> Result<f64, String> {
    acceleration(text)
        .ok()
        .filter(|value| *value >= 0.0)
        .ok_or_else(|| "expected a deceleration from 0 to 1000000 deg/s2".to_owned())
}

/// Parses a number of any use as an angle, speed, acceleration or factor.
pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        // Later checks print the number: 1e300 would have 301 digits.
        Ok(number) if number.is_nan() || number.abs() <= 1e6 => Ok(number),
        _ => Err("expected a number from -1e6 to 1e6, such as 56.25".to_owned()),
    }
}

/// Parser of a whole number of a range.
pub(super) fn whole<N: TryFrom<u64>>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync {
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        let number = number.and_then(|number| N::try_from(number).ok());
        let (first, last) = (range.start(), range.end());
        number.ok_or_else(|| format!("expected a whole number from {first} to {last}"))
    }
}

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let number: u64 = whole(1..=u16::MAX.into())(text)?;
    let number = usize::try_from(number).ok().and_then(NonZeroUsize::new);
    number.ok_or_else(|| "expected a whole number above 0".to_owned())
}

/// Parses an address with a port.
pub(super) fn address_and_port(text: &str) -> Result<SocketAddr, String> {
    let expected = |_| "expected an address and a port, such as 127.0.0.1:8016".to_owned();
    text.parse().map_err(expected)
}

/// Parses a share below 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0 (every pair is counted) to below 1".to_owned()),
    }
}

/// Parses a position, metres.
pub(super) fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|number| number.trim().parse().ok())
        .filter(|number: &f64| number.is_finite())
        .collect();
    match (numbers.try_into(), text.split(',').count()) {
        (Ok(place), 3) => Ok(place),
        _ => Err("expected three numbers, metres: X,Y,Z".to_owned()),
    }
}

/// Parses an azimuth, degrees.
pub(super) fn azimuth(text: &str) -> Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "expected degrees".to_owned())?;
    if (-360.0..=360.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err("expected an azimuth from -360 to 360 degrees".to_owned())
    }
}

/// Parses a heading, degrees: `30deg` or `30`.
pub(super) fn heading(text: &str) -> Result<f64, String> {
    azimuth(text.strip_suffix("deg").unwrap_or(text).trim_end())
        .map_err(|_| "expected a heading from -360 to 360 degrees, such as 30deg".to_owned())
}

/// Parses a length, metres: `20m`, `5mm` or `2cm`; a number alone is in metres.
pub(super) fn metres(text: &str) -> Result<f64, String> {
    quantity(text, &[("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1.0)])
}

/// The same; a number alone is in millimetres.
pub(super) fn millimetres(text: &str) -> Result<f64, String> {
    quantity(text, &[("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1e-3)])
}

/// Parses an angle, degrees: `0.3deg` or `0.3`.
pub(super) fn degrees(text: &str) -> Result<f64, String> {
    quantity(text, &[("deg", 1.0), ("", 1.0)])
}

/// Parses a time, seconds: `10s` or `10`.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    quantity(text, &[("s", 1.0), ("", 1.0)])
}

/// Parses a number above 0 with one of these units, the first that fits; the last is for a number
/// alone.
fn quantity(text: &str, units: &[(&str, f64)]) -> Result<f64, String> {
    units
        .iter()
        .find_map(|(unit, factor)| {
            let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
            Some(number * factor)
        })
        .filter(|number| (1e-9..=1e6).contains(number))
        .ok_or_else(|| {
            let names = units.iter().map(|(unit, _)| *unit);
            let names: Vec<&str> = names.filter(|unit| !unit.is_empty()).collect();
            format!(
                "expected a number above 0, up to a million, without or with a unit: {}",
                names.join(", ")
            )
        })
}
