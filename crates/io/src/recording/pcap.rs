//! Classic pcap: a 24-byte header, then records, in microseconds or nanoseconds and either byte
//! order. Nothing marks the start of a record, so a wrong length ends the reading.

use std::io::{self, Read};
use std::path::Path;

use pcap_parser::pcap::{PcapHeader, parse_pcap_frame, parse_pcap_frame_be, parse_pcap_header};
use units::Stamp;

use super::error::{End, PacketFault, RecordingError};
use super::link::LinkType;
use super::window::Window;
use super::{CapturedPacket, FileItem};

/// Bytes of the file header.
pub(super) const HEADER_LEN: usize = 24;
/// Bytes of a record header.
const RECORD_HEADER_LEN: usize = 16;

/// Longest valid record. libpcap's limit is 256 KiB; USB captures reach 128 MiB, but carry no
/// lidar.
const MAX_PACKET_LEN: u32 = 1 << 20;

/// The file header.
#[derive(Debug)]
pub(super) struct PcapFile {
    link: LinkType,
    nanoseconds: bool,
    big_endian: bool,
}

impl PcapFile {
    /// Reads the header at the start of a file.
    pub(super) fn parse(start: &[u8], path: &Path) -> Result<Self, RecordingError> {
        let header = match parse_pcap_header(start) {
            Ok((_, header)) if !header.is_modified_format() => header,
            Err(pcap_parser::nom::Err::Incomplete(_)) => {
                return Err(RecordingError::Short {
                    path: path.to_owned(),
                    expected: HEADER_LEN as u64,
                    got: start.len() as u64,
                });
            }
            _ => {
                return Err(RecordingError::Foreign {
                    path: path.to_owned(),
                    got: describe(start),
                });
            }
        };
        let got = link_number(&header);
        let link = LinkType::from_number(got, None).ok_or_else(|| RecordingError::Link {
            path: path.to_owned(),
            offset: 20,
            got,
        })?;
        Ok(Self {
            link,
            nanoseconds: header.is_nanosecond_precision(),
            big_endian: header.is_bigendian(),
        })
    }

    /// Reads the next record into the window.
    pub(super) fn step<R: Read>(&self, window: &mut Window<R>) -> io::Result<FileItem> {
        let offset = window.offset();
        let bytes = window.fill(RECORD_HEADER_LEN)?;
        if bytes.is_empty() {
            return Ok(FileItem::End(End::Complete));
        }
        let truncated = |expected: usize, got: usize| {
            FileItem::End(End::Truncated {
                offset,
                expected: expected as u64,
                got: got as u64,
            })
        };
        let captured = match bytes.get(8..12).and_then(|b| <[u8; 4]>::try_from(b).ok()) {
            Some(field) if self.big_endian => u32::from_be_bytes(field),
            Some(field) => u32::from_le_bytes(field),
            None => return Ok(truncated(RECORD_HEADER_LEN, bytes.len())),
        };
        if captured > MAX_PACKET_LEN {
            let fault = PacketFault::Length {
                expected: "at most 1048576",
                got: captured.into(),
            };
            return Ok(FileItem::End(End::Unreadable { offset, fault }));
        }
        let length = RECORD_HEADER_LEN + captured as usize;
        let bytes = window.fill(length)?;
        let Some(record) = bytes.get(..length) else {
            return Ok(truncated(length, bytes.len()));
        };
        let parse = match self.big_endian {
            true => parse_pcap_frame_be,
            false => parse_pcap_frame,
        };
        let Ok((_, frame)) = parse(record) else {
            return Ok(truncated(length, bytes.len()));
        };
        let fraction_ns = if self.nanoseconds { 1 } else { 1_000 };
        let ns = i64::from(frame.ts_sec) * 1_000_000_000 + i64::from(frame.ts_usec) * fraction_ns;
        Ok(FileItem::Packet(CapturedPacket {
            host: Stamp::from_nanos(ns),
            length,
            data: RECORD_HEADER_LEN..length,
            link: self.link,
            direction: None,
            original: frame.origlen,
        }))
    }
}

/// The link type without the flags in its field (length of the frame check sequence).
fn link_number(header: &PcapHeader) -> u32 {
    u32::from_ne_bytes(header.network.0.to_ne_bytes()) & 0xFFFF
}

/// Describes the first bytes of a file that is no recording.
fn describe(start: &[u8]) -> String {
    let known: [(&[u8], &str); 10] = [
        (b"\x1F\x8B", "gzip (unpack it first)"),
        (b"\xFD7zXZ", "xz (unpack it first)"),
        (b"\x28\xB5\x2F\xFD", "zstd (unpack it first)"),
        (
            b"PK\x03\x04",
            "a zip archive (unpack it first) or a cloud of numpy",
        ),
        (
            b"\x34\xCD\xB2\xA1",
            "modified pcap (convert it with editcap)",
        ),
        (b"ply", "a PLY cloud"),
        (b"LASF", "a LAS or LAZ cloud"),
        (b"#ROSBAG", "a ROS 1 bag"),
        (b"\x89MCAP", "an MCAP bag"),
        (b"# .PCD", "a PCD cloud"),
    ];
    for (magic, name) in known {
        if start.starts_with(magic) {
            return name.to_owned();
        }
    }
    let shown: Vec<String> = start.iter().take(8).map(|b| format!("{b:02X}")).collect();
    format!("a file that starts {}", shown.join(" "))
}
