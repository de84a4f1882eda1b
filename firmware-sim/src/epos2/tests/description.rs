//! The object dictionary against the device description (EDS) of an EPOS2 70/10, entry by entry, as
//! a client reads it: existence, type, access, default value, limits and mappability, each with its
//! abort code. `objects.txt` is the description without names; the dictionary's own table is not
//! used here.

extern crate std;
use std::collections::BTreeMap;
use std::vec::Vec;

use protocol::epos2::objects::Address;

use super::super::{AbortCode, SimulatedDrive};
use super::healthy;

/// An entry of the description.
struct Described {
    address: Address,
    /// Bytes of a number; 0 for a text or a domain.
    bytes: usize,
    signed: bool,
    domain: bool,
    access: &'static str,
    /// For node 1.
    default: Option<i64>,
    low: Option<i64>,
    high: Option<i64>,
    mappable: bool,
}

fn described() -> Vec<Described> {
    let text = include_str!("objects.txt");
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let field: Vec<&'static str> = line.split(' ').collect();
            let [index, sub, ty, access, default, low, high, mappable] = field[..] else {
                panic!("{line}");
            };
            let bits: usize = ty[1..].parse().unwrap_or(0);
            let signed = ty.starts_with('I');
            // The description writes negative numbers as bits.
            let number = |text: &str| {
                (text != "-").then(|| {
                    let value = number(text);
                    if signed && bits > 0 && value >= 1 << (bits - 1) {
                        value - (1 << bits)
                    } else {
                        value
                    }
                })
            };
            Described {
                address: Address::new(
                    u16::from_str_radix(index, 16).unwrap(),
                    u8::from_str_radix(sub, 16).unwrap(),
                ),
                bytes: bits / 8,
                signed,
                domain: ty == "DOMAIN",
                access,
                default: number(default),
                low: number(low),
                high: number(high),
                mappable: mappable == "1",
            }
        })
        .collect()
}

/// Decimal or hexadecimal, possibly negative, with the node id added where stated.
fn number(text: &str) -> i64 {
    let (text, plus) = match text.strip_prefix("$NODEID+") {
        Some(rest) => (rest, 1),
        None => (text, 0),
    };
    let hex = text.strip_prefix("0x").or(text.strip_prefix("0X"));
    plus + hex.map_or_else(
        || text.parse().unwrap(),
        |hex| i64::from_str_radix(hex, 16).unwrap(),
    )
}

fn value(node: &SimulatedDrive, entry: &Described) -> i64 {
    let value = node.read(entry.address).unwrap();
    let mut bytes = [0; 8];
    bytes[..entry.bytes].copy_from_slice(value.bytes());
    let raw = i64::from_le_bytes(bytes);
    let unused = 64 - 8 * entry.bytes as u32;
    if entry.signed {
        raw << unused >> unused
    } else {
        raw
    }
}

/// Writes a number with this many bytes.
fn write(
    node: &mut SimulatedDrive,
    entry: &Described,
    number: i64,
    bytes: usize,
) -> Result<(), AbortCode> {
    node.write_bytes(entry.address, &number.to_le_bytes()[..bytes])
}

/// Writes refused although type, access and limits allow them: signatures, enabled process data,
/// entries without storage.
fn has_other_refusals(entry: &Described) -> bool {
    matches!(
        entry.address.index,
        0x1010 | 0x1011 | 0x1600..=0x1603 | 0x1A00..=0x1A03 | 0x2FFF
    ) || entry.bytes == 8
}

#[test]
fn exactly_the_described_objects_exist() {
    let node = healthy();
    let mut subs = BTreeMap::<u16, Vec<u8>>::new();
    for entry in described() {
        let Address { index, sub } = entry.address;
        subs.entry(index).or_default().push(sub);
    }
    assert_eq!(subs.values().map(Vec::len).sum::<usize>(), 430);
    for index in 0..=u16::MAX {
        let Some(subs) = subs.get(&index) else {
            let found = node.read(Address::new(index, 0)).unwrap_err();
            assert_eq!(found, AbortCode::NO_OBJECT, "{index:04X}");
            continue;
        };
        for sub in 0..=u8::MAX {
            let found = node.read(Address::new(index, sub)).err();
            let missing = found == Some(AbortCode::NO_SUB);
            assert_eq!(missing, !subs.contains(&sub), "{index:04X}:{sub:02X}");
        }
    }
}

#[test]
fn values_have_their_width_and_factory_default() {
    let node = healthy();
    for entry in described() {
        let read = node.read(entry.address);
        match (entry.access, entry.bytes) {
            ("wo", _) => assert_eq!(read, Err(AbortCode::WRITE_ONLY), "{}", entry.address),
            _ if entry.domain => assert_eq!(read, Err(AbortCode::STATE), "{}", entry.address),
            (_, 0) => assert_eq!(read.unwrap().bytes(), b"EPOS2"),
            (_, bytes) => assert_eq!(read.unwrap().bytes().len(), bytes, "{}", entry.address),
        }
        // 1010:1 reads as "saves on command" (CiA 301).
        let is_state = entry.address == Address::new(0x1010, 1);
        if let Some(default) = entry.default
            && entry.access != "wo"
            && !is_state
        {
            assert_eq!(value(&node, &entry), default, "{}", entry.address);
        }
    }
}

#[test]
fn writes_respect_access_length_and_limits() {
    for entry in described() {
        let mut node = healthy();
        let (at, bytes) = (entry.address, entry.bytes);
        if matches!(entry.access, "ro" | "const") {
            for bytes in 1..=8 {
                let refused = write(&mut node, &entry, 0, bytes);
                assert_eq!(refused, Err(AbortCode::READ_ONLY), "{at}");
            }
            continue;
        }
        if bytes == 0 {
            assert!(write(&mut node, &entry, 0, 1).is_err(), "{at}");
            continue;
        }
        let fits = entry.default.or(entry.low).unwrap_or(0);
        for wrong in (1..=8).filter(|&wrong| wrong != bytes) {
            let expected = if wrong > bytes {
                AbortCode::TOO_LONG
            } else {
                AbortCode::TOO_SHORT
            };
            let refused = write(&mut node, &entry, fits, wrong);
            assert_eq!(refused, Err(expected), "{at} in {wrong} bytes");
        }
        for (outside, expected) in [
            (entry.high.map(|high| high + 1), AbortCode::TOO_HIGH),
            (entry.low.map(|low| low - 1), AbortCode::TOO_LOW),
        ] {
            // Values outside the type's range cannot be written.
            let bits = 8 * bytes - usize::from(entry.signed);
            let least = if entry.signed { -(1 << bits) } else { 0 };
            let Some(outside) = outside.filter(|it| (least..1 << bits).contains(it)) else {
                continue;
            };
            let refused = write(&mut node, &entry, outside, bytes);
            assert_eq!(refused, Err(expected), "{at} = {outside}");
        }
        if has_other_refusals(&entry) {
            continue;
        }
        for fits in [entry.default, entry.low, entry.high].into_iter().flatten() {
            assert_eq!(
                write(&mut node, &entry, fits, bytes),
                Ok(()),
                "{at} = {fits}"
            );
        }
    }
}

#[test]
fn process_data_carries_exactly_the_mappable_objects() {
    for entry in described() {
        let Address { index, sub } = entry.address;
        let mapped = (u32::from(index) << 16) | (u32::from(sub) << 8) | (8 * entry.bytes as u32);
        for (parameters, mapping, access) in [
            (0x1803, 0x1A03, ["ro", "rw", "rww", "const"].as_slice()),
            (0x1403, 0x1603, &["rww", "wo"]),
        ] {
            let mut node = healthy();
            let id = node.read(Address::new(parameters, 1)).unwrap();
            let out_of_use = id.raw().unwrap() | 1 << 31;
            node.write(Address::new(parameters, 1), out_of_use).unwrap();
            node.write(Address::new(mapping, 0), 0).unwrap();
            let taken = node.write(Address::new(mapping, 1), mapped);
            let expected = if entry.mappable && access.contains(&entry.access) {
                Ok(())
            } else {
                Err(AbortCode::PDO_MAPPING)
            };
            assert_eq!(taken, expected, "{} in {mapping:04X}", entry.address);
        }
    }
}
