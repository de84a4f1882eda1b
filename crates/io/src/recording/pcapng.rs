//! pcapng: sections of blocks, each framed by its length in front and behind, so that a block whose
//! inside is wrong can be passed over. Only section headers, interface descriptions and packets are
//! looked into. Where the framing itself is wrong, reading goes on at the next block that is sound.

use std::io::{self, Read};
use std::path::Path;

use pcap_parser::pcapng::{
    EPB_MAGIC, IDB_MAGIC, InterfaceDescriptionBlock, OptionCode, PcapNGOption, SHB_MAGIC,
    SPB_MAGIC, parse_enhancedpacketblock_be, parse_enhancedpacketblock_le,
    parse_interfacedescriptionblock_be, parse_interfacedescriptionblock_le,
    parse_sectionheaderblock,
};
use protocol::record::Direction;
use units::{Host, Stamp};

use super::error::{End, Fault, RecordingError};
use super::link::LinkType;
use super::resync::resync;
use super::window::Window;
use super::{Packet, Step};

/// The longest block believed; Wireshark's limit.
const MAX_BLOCK_LEN: u32 = 16 << 20;
/// Type and two lengths.
pub(super) const FRAMING_LEN: u32 = 12;
/// Reads the same in both byte orders.
pub(super) const SECTION_HEADER: u32 = SHB_MAGIC;
/// Byte-order magic of a section in this machine-independent order (draft-ietf-opsawg-pcapng,
/// section 4.1).
pub(super) const BYTE_ORDER_MAGIC: u32 = 0x1A2B_3C4D;
/// Packet data in an enhanced packet block starts behind type, length, interface, two halves of the
/// time, two lengths.
pub(super) const PACKET_DATA_OFFSET: usize = 28;
/// Option codes of the draft that pcap-parser does not name for this block.
const EPB_FLAGS: OptionCode = OptionCode(2);

/// Interfaces beyond these are not kept: their packets count as malformed.
const MAX_INTERFACES: usize = 4096;

/// The section being read.
#[derive(Debug, Default)]
pub(super) struct Section {
    big_endian: bool,
    interfaces: Vec<Interface>,
}

#[derive(Debug)]
struct Interface {
    /// `None`: a link type that carries nothing for us.
    link: Option<LinkType>,
    /// `if_tsresol`: bit 7 set: 2^-n s, else 10^-n s.
    resolution: u8,
    /// `if_tsoffset`, s.
    offset_s: i64,
}

/// What cannot be understood, in the place of its number.
const UNKNOWN: Interface = Interface {
    link: None,
    resolution: 6,
    offset_s: 0,
};

/// Whether a file that starts so is pcapng. The block type reads the same in both byte orders.
pub(super) fn is_section_header(start: &[u8]) -> bool {
    start.starts_with(&SHB_MAGIC.to_le_bytes())
}

impl Section {
    /// Reads the first section header; its comment.
    pub(super) fn open<R: Read>(
        &mut self,
        window: &mut Window<R>,
        path: &Path,
    ) -> Result<Option<String>, RecordingError> {
        let foreign = |got: String| RecordingError::Foreign {
            path: path.to_owned(),
            got,
        };
        match self.frame(window) {
            Err(source) => Err(RecordingError::Read {
                path: path.to_owned(),
                offset: window.offset(),
                source,
            }),
            Ok(Err(End::Truncated { expected, got, .. })) => Err(RecordingError::Short {
                path: path.to_owned(),
                expected,
                got,
            }),
            Ok(Err(End::Unreadable { fault, .. })) => Err(foreign(format!(
                "the start of a pcapng section, but: {fault}"
            ))),
            Ok(Err(End::Complete)) => Err(RecordingError::Empty {
                path: path.to_owned(),
            }),
            Ok(Ok((_, length))) => {
                let block = window.bytes().get(..length).unwrap_or_default();
                let Ok((_, header)) = parse_sectionheaderblock(block) else {
                    let fault = Fault::Block { kind: SHB_MAGIC };
                    return Err(foreign(format!(
                        "the start of a pcapng section, but: {fault}"
                    )));
                };
                let comment = option(&header.options, OptionCode::Comment)
                    .and_then(|bytes| std::str::from_utf8(bytes).ok())
                    .map(|text| text.trim_end_matches('\0').to_owned());
                window.consume(length);
                Ok(comment)
            }
        }
    }

    /// Reads the next block into the window.
    pub(super) fn step<R: Read>(&mut self, window: &mut Window<R>) -> io::Result<Step> {
        let (kind, length) = match self.frame(window)? {
            Ok(framed) => framed,
            Err(End::Complete) => return Ok(Step::End(End::Complete)),
            Err(end) => return self.go_on_behind(window, end),
        };
        let block = window.bytes().get(..length).unwrap_or_default();
        Ok(match kind {
            SHB_MAGIC => {
                self.interfaces.clear();
                Step::Skip { length }
            }
            IDB_MAGIC => {
                self.describe(block);
                Step::Skip { length }
            }
            EPB_MAGIC => match self.packet(block) {
                Ok(packet) => Step::Packet(packet),
                Err(fault) => Step::Malformed { length, fault },
            },
            SPB_MAGIC => Step::Malformed {
                length,
                fault: Fault::Timeless,
            },
            _ => Step::Skip { length },
        })
    }

    /// Where no block can be framed: to the next that can. A file that was merely cut off has none,
    /// and ends as `end` says.
    fn go_on_behind<R: Read>(&mut self, window: &mut Window<R>, end: End) -> io::Result<Step> {
        let (offset, fault) = match &end {
            End::Complete => return Ok(Step::End(end)),
            &End::Truncated {
                offset,
                expected,
                got,
            } => (offset, Fault::Cut { expected, got }),
            End::Unreadable { offset, fault } => (*offset, fault.clone()),
        };
        // A damaged description keeps its number, so that those behind it keep theirs; a damaged
        // section is a section.
        match words(window.bytes()).map(|[kind, _, _]| self.u32(kind)) {
            Some(IDB_MAGIC) => self.keep(UNKNOWN),
            Some(SHB_MAGIC) => self.interfaces.clear(),
            _ => {}
        }
        let Some(found) = resync(window, self.big_endian)? else {
            return Ok(Step::End(end));
        };
        if found.big_endian != self.big_endian {
            // The header of a section in the other byte order was among what is damaged.
            self.big_endian = found.big_endian;
            self.interfaces.clear();
        }
        Ok(Step::Damaged {
            offset,
            bytes: found.skipped,
            fault,
        })
    }

    /// Brings the next whole block into the window: its type and length, or why there is none.
    fn frame<R: Read>(&mut self, window: &mut Window<R>) -> io::Result<Result<(u32, usize), End>> {
        let offset = window.offset();
        let truncated = |expected: u32, got: usize| {
            Ok(Err(End::Truncated {
                offset,
                expected: expected.into(),
                got: got as u64,
            }))
        };
        let unreadable = |fault| Ok(Err(End::Unreadable { offset, fault }));
        let start = window.fill(FRAMING_LEN as usize)?;
        if start.is_empty() {
            return Ok(Err(End::Complete));
        }
        let Some([kind, length, third]) = words(start) else {
            return truncated(FRAMING_LEN, start.len());
        };
        if kind == SHB_MAGIC.to_le_bytes() {
            // A section header tells the byte order of everything up to the next one, itself
            // included.
            self.big_endian = match third {
                magic if magic == BYTE_ORDER_MAGIC.to_le_bytes() => false,
                magic if magic == BYTE_ORDER_MAGIC.to_be_bytes() => true,
                magic => {
                    return unreadable(Fault::Header(format!(
                        "byte-order magic: expected 1A 2B 3C 4D either way round, got {magic:02X?}"
                    )));
                }
            };
        }
        let kind = self.u32(kind);
        let front = self.u32(length);
        if !(FRAMING_LEN..=MAX_BLOCK_LEN).contains(&front) || !front.is_multiple_of(4) {
            return unreadable(Fault::Length {
                expected: "12 to 16777216, a multiple of 4",
                got: front.into(),
            });
        }
        let bytes = window.fill(front as usize)?;
        let Some(block) = bytes.get(..front as usize) else {
            return truncated(front, bytes.len());
        };
        let back = block.last_chunk().map_or(0, |&back| self.u32(back));
        if back != front {
            return unreadable(Fault::Lengths { front, back });
        }
        Ok(Ok((kind, front as usize)))
    }

    fn describe(&mut self, block: &[u8]) {
        let parse = if self.big_endian {
            parse_interfacedescriptionblock_be
        } else {
            parse_interfacedescriptionblock_le
        };
        // An interface that cannot be understood keeps its number, so that those behind it keep
        // theirs.
        let interface = match parse(block) {
            Ok((_, described)) => self.interface(&described),
            Err(_) => UNKNOWN,
        };
        self.keep(interface);
    }

    fn keep(&mut self, interface: Interface) {
        if self.interfaces.len() < MAX_INTERFACES {
            self.interfaces.push(interface);
        }
    }

    fn interface(&self, described: &InterfaceDescriptionBlock<'_>) -> Interface {
        let name = option(&described.options, OptionCode::IfName)
            .and_then(|bytes| std::str::from_utf8(bytes).ok());
        let resolution =
            option(&described.options, OptionCode::IfTsresol).and_then(|bytes| bytes.first());
        let offset_s = option(&described.options, OptionCode::IfTsoffset)
            .and_then(|bytes| bytes.first_chunk())
            .map_or(0, |&bytes| {
                if self.big_endian {
                    i64::from_be_bytes(bytes)
                } else {
                    i64::from_le_bytes(bytes)
                }
            });
        Interface {
            link: u32::try_from(described.linktype.0)
                .ok()
                .and_then(|number| LinkType::from_number(number, name)),
            resolution: resolution.copied().unwrap_or(6),
            offset_s,
        }
    }

    fn packet(&self, block: &[u8]) -> Result<Packet, Fault> {
        let parse = match self.big_endian {
            true => parse_enhancedpacketblock_be,
            false => parse_enhancedpacketblock_le,
        };
        let (_, packet) = parse(block).map_err(|_| Fault::Block { kind: EPB_MAGIC })?;
        let interface = usize::try_from(packet.if_id)
            .ok()
            .and_then(|id| self.interfaces.get(id))
            .ok_or(Fault::Interface {
                got: packet.if_id,
                described: self.interfaces.len(),
            })?;
        let ticks = (u64::from(packet.ts_high) << 32) | u64::from(packet.ts_low);
        Ok(Packet {
            host: interface.time(ticks),
            length: block.len(),
            data: PACKET_DATA_OFFSET..PACKET_DATA_OFFSET.saturating_add(packet.caplen as usize),
            link: interface.link.unwrap_or(LinkType::Unused),
            direction: self.direction(&packet.options),
            original: packet.origlen,
        })
    }

    /// Bits 0 and 1 of `epb_flags`: 1 inbound, 2 outbound.
    fn direction(&self, options: &[PcapNGOption<'_>]) -> Option<Direction> {
        let flags = self.u32(*option(options, EPB_FLAGS)?.first_chunk()?);
        match flags & 3 {
            1 => Some(Direction::FromDevice),
            2 => Some(Direction::ToDevice),
            _ => None,
        }
    }

    fn u32(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        }
    }
}

impl Interface {
    /// The packet's time, held at the ends of the range of `i64` nanoseconds.
    fn time(&self, units: u64) -> Stamp<Host> {
        let units = u128::from(units);
        let exponent = u32::from(self.resolution & 0x7F);
        let ns = if self.resolution & 0x80 != 0 {
            (units * 1_000_000_000) >> exponent
        } else if exponent <= 9 {
            units * 10_u128.pow(9 - exponent)
        } else {
            // Beyond 10^38 per second no 64-bit count reaches a nanosecond.
            10_u128
                .checked_pow(exponent - 9)
                .map_or(0, |divisor| units / divisor)
        };
        // At most 2^64 * 10^9, far inside i128.
        let ns = ns as i128 + i128::from(self.offset_s) * 1_000_000_000;
        Stamp::from_nanos(i64::try_from(ns).unwrap_or(if ns < 0 { i64::MIN } else { i64::MAX }))
    }
}

/// The value of the first option of a code.
fn option<'a>(options: &'a [PcapNGOption<'_>], code: OptionCode) -> Option<&'a [u8]> {
    options
        .iter()
        .find(|option| option.code == code)
        .and_then(|option| option.as_bytes().ok())
}

fn words(bytes: &[u8]) -> Option<[[u8; 4]; 3]> {
    let (first, rest) = bytes.split_first_chunk()?;
    let (second, rest) = rest.split_first_chunk()?;
    let (third, _) = rest.split_first_chunk()?;
    Some([*first, *second, *third])
}
