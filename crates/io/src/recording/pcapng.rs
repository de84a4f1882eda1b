//! pcapng: sections of blocks with their length at the start and the end, so that blocks with
//! invalid content can be skipped. Only section headers, interface descriptions and enhanced packet
//! blocks are parsed. After invalid framing, reading continues at the next valid block.

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

use super::error::{End, PacketFault, RecordingError};
use super::link::LinkType;
use super::resync::resync;
use super::window::Window;
use super::{CapturedPacket, FileItem};

/// Longest valid block (Wireshark's limit).
const MAX_BLOCK_LEN: u32 = 16 << 20;
/// Bytes of type and two lengths.
pub(super) const FRAMING_LEN: u32 = 12;
/// Block type of a section header, the same in both byte orders.
pub(super) const SECTION_HEADER: u32 = SHB_MAGIC;
/// Byte-order magic of a section (draft-ietf-opsawg-pcapng, section 4.1).
pub(super) const BYTE_ORDER_MAGIC: u32 = 0x1A2B_3C4D;
/// Offset of the packet data in an enhanced packet block: type, length, interface, two
/// halves of the time, two lengths.
pub(super) const PACKET_DATA_OFFSET: usize = 28;
/// Option code of `epb_flags`, which pcap-parser does not name.
const EPB_FLAGS: OptionCode = OptionCode(2);

/// Limit of interfaces; packets of further ones count as malformed.
const MAX_INTERFACES: usize = 4096;

/// The current section.
#[derive(Debug, Default)]
pub(super) struct PcapngSection {
    big_endian: bool,
    interfaces: Vec<CaptureInterface>,
}

#[derive(Debug)]
struct CaptureInterface {
    /// `None` for an unsupported link type.
    link: Option<LinkType>,
    /// `if_tsresol`: bit 7 set: 2^-n s, else 10^-n s.
    resolution: u8,
    /// `if_tsoffset`, s.
    offset_s: i64,
}

/// Placeholder of an invalid description.
const UNKNOWN: CaptureInterface = CaptureInterface {
    link: None,
    resolution: 6,
    offset_s: 0,
};

/// Whether the first bytes are those of pcapng.
pub(super) fn is_section_header(start: &[u8]) -> bool {
    start.starts_with(&SHB_MAGIC.to_le_bytes())
}

impl PcapngSection {
    /// Reads the first section header and returns its comment.
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
                "an invalid pcapng section header: {fault}"
            ))),
            Ok(Err(End::Complete)) => Err(RecordingError::Empty {
                path: path.to_owned(),
            }),
            Ok(Ok((_, length))) => {
                let block = window.bytes().get(..length).unwrap_or_default();
                let Ok((_, header)) = parse_sectionheaderblock(block) else {
                    let fault = PacketFault::Block { kind: SHB_MAGIC };
                    return Err(foreign(format!(
                        "an invalid pcapng section header: {fault}"
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
    pub(super) fn step<R: Read>(&mut self, window: &mut Window<R>) -> io::Result<FileItem> {
        let (kind, length) = match self.frame(window)? {
            Ok(framed) => framed,
            Err(End::Complete) => return Ok(FileItem::End(End::Complete)),
            Err(end) => return self.skip_damage(window, end),
        };
        let block = window.bytes().get(..length).unwrap_or_default();
        Ok(match kind {
            SHB_MAGIC => {
                self.interfaces.clear();
                FileItem::Section { length }
            }
            IDB_MAGIC => {
                self.describe(block);
                FileItem::Skip { length }
            }
            EPB_MAGIC => match self.packet(block) {
                Ok(packet) => FileItem::Packet(packet),
                Err(fault) => FileItem::Malformed { length, fault },
            },
            SPB_MAGIC => FileItem::Malformed {
                length,
                fault: PacketFault::Timeless,
            },
            _ => FileItem::Skip { length },
        })
    }

    /// Skips to the next valid block after invalid framing. A truncated file has none and ends with
    /// `end`.
    fn skip_damage<R: Read>(&mut self, window: &mut Window<R>, end: End) -> io::Result<FileItem> {
        let (offset, fault) = match &end {
            End::Complete => return Ok(FileItem::End(end)),
            &End::Truncated {
                offset,
                expected,
                got,
            } => (offset, PacketFault::Cut { expected, got }),
            End::Unreadable { offset, fault } => (*offset, fault.clone()),
        };
        // A damaged description keeps its number, so that later ones keep theirs. A damaged section
        // header still starts a section.
        match words(window.bytes()).map(|[kind, _, _]| self.u32(kind)) {
            Some(IDB_MAGIC) => self.push_interface(UNKNOWN),
            Some(SHB_MAGIC) => self.interfaces.clear(),
            _ => {}
        }
        let Some(found) = resync(window, self.big_endian)? else {
            return Ok(FileItem::End(end));
        };
        if found.big_endian != self.big_endian {
            // The damage includes the header of a section in the other byte order.
            self.big_endian = found.big_endian;
            self.interfaces.clear();
        }
        Ok(FileItem::Damaged {
            offset,
            bytes: found.skipped,
            fault,
        })
    }

    /// Reads the next block into the window and returns its type and length, or the end.
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
            // A section header sets the byte order from itself up to the next one.
            self.big_endian = match third {
                magic if magic == BYTE_ORDER_MAGIC.to_le_bytes() => false,
                magic if magic == BYTE_ORDER_MAGIC.to_be_bytes() => true,
                magic => {
                    return unreadable(PacketFault::Header(format!(
                        "byte-order magic: expected 1A 2B 3C 4D in either order, got {magic:02X?}"
                    )));
                }
            };
        }
        let kind = self.u32(kind);
        let front = self.u32(length);
        if !(FRAMING_LEN..=MAX_BLOCK_LEN).contains(&front) || !front.is_multiple_of(4) {
            return unreadable(PacketFault::Length {
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
            return unreadable(PacketFault::Lengths { front, back });
        }
        Ok(Ok((kind, front as usize)))
    }

    fn describe(&mut self, block: &[u8]) {
        let parse = if self.big_endian {
            parse_interfacedescriptionblock_be
        } else {
            parse_interfacedescriptionblock_le
        };
        // An invalid description keeps its number, so that later ones keep theirs.
        let interface = match parse(block) {
            Ok((_, described)) => self.interface(&described),
            Err(_) => UNKNOWN,
        };
        self.push_interface(interface);
    }

    fn push_interface(&mut self, interface: CaptureInterface) {
        if self.interfaces.len() < MAX_INTERFACES {
            self.interfaces.push(interface);
        }
    }

    fn interface(&self, described: &InterfaceDescriptionBlock<'_>) -> CaptureInterface {
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
        CaptureInterface {
            link: u32::try_from(described.linktype.0)
                .ok()
                .and_then(|number| LinkType::from_number(number, name)),
            resolution: resolution.copied().unwrap_or(6),
            offset_s,
        }
    }

    fn packet(&self, block: &[u8]) -> Result<CapturedPacket, PacketFault> {
        let parse = match self.big_endian {
            true => parse_enhancedpacketblock_be,
            false => parse_enhancedpacketblock_le,
        };
        let (_, packet) = parse(block).map_err(|_| PacketFault::Block { kind: EPB_MAGIC })?;
        let interface = usize::try_from(packet.if_id)
            .ok()
            .and_then(|id| self.interfaces.get(id))
            .ok_or(PacketFault::Interface {
                got: packet.if_id,
                described: self.interfaces.len(),
            })?;
        let ticks = (u64::from(packet.ts_high) << 32) | u64::from(packet.ts_low);
        Ok(CapturedPacket {
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
            1 => Some(Direction::FromDrive),
            2 => Some(Direction::ToDrive),
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

impl CaptureInterface {
    /// The packet's time, limited to the range of `i64` nanoseconds.
    fn time(&self, ticks: u64) -> Stamp<Host> {
        let ticks = u128::from(ticks);
        let exponent = u32::from(self.resolution & 0x7F);
        let ns = if self.resolution & 0x80 != 0 {
            (ticks * 1_000_000_000) >> exponent
        } else if exponent <= 9 {
            ticks * 10_u128.pow(9 - exponent)
        } else {
            // Above 10^38 ticks per second a 64-bit count stays below a nanosecond.
            10_u128
                .checked_pow(exponent - 9)
                .map_or(0, |divisor| ticks / divisor)
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
