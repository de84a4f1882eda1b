//! numpy's `.npz`: a zip archive, not compressed, of the metadata as text and of one structured
//! array, `points`, with the columns of PLY (numpy.lib.format 1.0; ZIP APPNOTE 6.3.10).
//!
//! The headers before the rows hold their count and checksum, which are known at the end. Their
//! length is constant, so the encoder seeks back. After a failed batch there is no file. Sizes have
//! 64 bits, as in numpy's own archives: a cloud may exceed 4 GiB. The archive has no date, as the
//! same log must give the same bytes.

use std::io::{Seek, SeekFrom, Write};

use crc32fast::Hasher;

use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use super::layout::RowLayout;
use crate::rows::NumberType;
use crate::{Fields, Metadata, Points, Summary};

/// Name of the array in the archive.
pub(crate) const POINTS: &str = "points.npy";
const METADATA: &str = "metadata.txt";

/// Signatures of the parts of an archive (APPNOTE 4.3).
pub(crate) const LOCAL: u32 = 0x0403_4b50;
pub(crate) const CENTRAL: u32 = 0x0201_4b50;
pub(crate) const END: u32 = 0x0605_4b50;
pub(crate) const END_64: u32 = 0x0606_4b50;
pub(crate) const LOCATOR_64: u32 = 0x0706_4b50;
/// A size or offset that is in a field of 64 bits instead.
pub(crate) const IN_64: u32 = u32::MAX;
/// Identifier of the fields of 64 bits.
pub(crate) const EXTRA_64: u16 = 1;
/// Version of ZIP with fields of 64 bits.
const VERSION: u16 = 45;
/// 1 January 1980, the earliest date of an archive.
const NO_DATE: u16 = 0x21;

/// Begins an array, before its version.
pub(crate) const MAGIC: [u8; 6] = *b"\x93NUMPY";
/// The rows of an array begin at a multiple of it.
const ALIGNMENT: usize = 64;

/// Writes `.npz` to an output that seeks. Each batch is one write: the output needs no buffer.
pub(super) type NpzWriter<W> = FileSink<NpzEncoder<W>>;

/// Encoder of [`NpzWriter`].
#[derive(Debug)]
pub(super) struct NpzEncoder<W> {
    output: W,
    layout: RowLayout,
    /// Checksum and number of the bytes of the rows.
    rows: Hasher,
    row_bytes: u64,
    metadata: ArchiveMember,
    /// Offset of the array in the archive.
    points_offset: u64,
}

/// A file of the archive.
#[derive(Clone, Copy, Debug, Default)]
struct ArchiveMember {
    name: &'static str,
    offset: u64,
    size: u64,
    crc: u32,
}

impl ArchiveMember {
    fn of(name: &'static str, offset: u64, content: Hasher, size: u64) -> Self {
        let crc = content.finalize();
        Self {
            name,
            offset,
            size,
            crc,
        }
    }

    /// Fields that the local file header and the central directory header share.
    fn common(&self, out: &mut Vec<u8>, extra_bytes: u16) {
        // Flags, and how it is compressed: not at all.
        for field in [VERSION, 0, 0, 0, NO_DATE] {
            out.extend(field.to_le_bytes());
        }
        for field in [self.crc, IN_64, IN_64] {
            out.extend(field.to_le_bytes());
        }
        for field in [self.name.len() as u16, extra_bytes] {
            out.extend(field.to_le_bytes());
        }
    }

    /// The fields of 64 bits.
    fn extra(fields: &[u64]) -> Vec<u8> {
        let mut extra = EXTRA_64.to_le_bytes().to_vec();
        extra.extend((8 * fields.len() as u16).to_le_bytes());
        extra.extend(fields.iter().flat_map(|field| field.to_le_bytes()));
        extra
    }

    /// The local file header.
    fn header(&self) -> Vec<u8> {
        let extra = Self::extra(&[self.size, self.size]);
        let mut out = LOCAL.to_le_bytes().to_vec();
        self.common(&mut out, extra.len() as u16);
        out.extend(self.name.as_bytes());
        out.extend(extra);
        out
    }

    /// The central directory header.
    fn central_header(&self) -> Vec<u8> {
        let extra = Self::extra(&[self.size, self.size, self.offset]);
        let mut out = CENTRAL.to_le_bytes().to_vec();
        out.extend(VERSION.to_le_bytes());
        self.common(&mut out, extra.len() as u16);
        // No comment, the first disk, no attributes.
        out.extend([0; 10]);
        out.extend(IN_64.to_le_bytes());
        out.extend(self.name.as_bytes());
        out.extend(extra);
        out
    }
}

/// The end of an archive whose central directory is at `offset`.
fn end(offset: u64, directory: &[u8]) -> Vec<u8> {
    const ENTRIES: u16 = 2;
    let size = directory.len() as u64;
    let mut out = END_64.to_le_bytes().to_vec();
    // Bytes that follow.
    out.extend(44_u64.to_le_bytes());
    out.extend([VERSION, VERSION].map(u16::to_le_bytes).concat());
    out.extend([0; 8]);
    for field in [u64::from(ENTRIES), u64::from(ENTRIES), size, offset] {
        out.extend(field.to_le_bytes());
    }
    out.extend(LOCATOR_64.to_le_bytes());
    out.extend(0_u32.to_le_bytes());
    out.extend((offset + size).to_le_bytes());
    out.extend(1_u32.to_le_bytes());
    out.extend(END.to_le_bytes());
    out.extend([0, 0, ENTRIES, ENTRIES].map(u16::to_le_bytes).concat());
    out.extend((size as u32).to_le_bytes());
    out.extend(u32::try_from(offset).unwrap_or(IN_64).to_le_bytes());
    out.extend(0_u16.to_le_bytes());
    out
}

/// The header of an array of `count` rows.
fn array_header(layout: &RowLayout, count: u64) -> Vec<u8> {
    const DIGITS: usize = 20; // of u64::MAX
    let columns = layout.properties().map(|(name, kind)| {
        let kind = match kind {
            NumberType::F32 => "<f4",
            NumberType::F64 => "<f8",
            NumberType::U16 => "<u2",
            NumberType::U8 => "|u1",
        };
        format!("('{name}', '{kind}')")
    });
    let columns = columns.collect::<Vec<_>>().join(", ");
    let count = count.to_string();
    let slack = DIGITS.saturating_sub(count.len());
    let text = format!("{{'descr': [{columns}], 'fortran_order': False, 'shape': ({count},), }}");
    // The version, the length, and a line end.
    let fixed = MAGIC.len() + 4;
    let bytes = (fixed + text.len() + slack + 1).next_multiple_of(ALIGNMENT);
    let width = bytes - fixed;
    let mut header = MAGIC.to_vec();
    header.extend([1, 0]);
    header.extend((width as u16).to_le_bytes());
    header.extend(format!("{text:<0$}\n", width - 1).into_bytes());
    header
}

impl<W: Write + Seek> NpzWriter<W> {
    /// A writer into `output`, which is empty, with the columns `fields`.
    pub(super) fn new(output: W, fields: Fields) -> Self {
        let encoder = NpzEncoder {
            output,
            layout: RowLayout::new(fields),
            rows: Hasher::new(),
            row_bytes: 0,
            metadata: ArchiveMember::default(),
            points_offset: 0,
        };
        Self::of(encoder, fields)
    }
}

impl<W: Write + Seek> NpzEncoder<W> {
    /// The array in the archive, and its header, for a number of points.
    fn array(&self, points: u64) -> (ArchiveMember, Vec<u8>) {
        let header = array_header(&self.layout, points);
        let mut content = Hasher::new();
        content.update(&header);
        content.combine(&self.rows);
        let size = header.len() as u64 + self.row_bytes;
        (
            ArchiveMember::of(POINTS, self.points_offset, content, size),
            header,
        )
    }
}

impl<W: Write + Seek> FormatEncoder for NpzEncoder<W> {
    fn format(&self) -> &'static str {
        "npz"
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        let text = metadata.lines().join("\n") + "\n";
        let mut content = Hasher::new();
        content.update(text.as_bytes());
        self.metadata = ArchiveMember::of(METADATA, 0, content, text.len() as u64);
        let mut file = self.metadata.header();
        file.extend(text.into_bytes());
        self.points_offset = file.len() as u64;
        let (entry, header) = self.array(0);
        file.extend(entry.header());
        file.extend(header);
        Ok(self.output.write_all(&file)?)
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        let rows = self.layout.encode(batch);
        self.rows.update(rows);
        self.row_bytes += rows.len() as u64;
        Ok(self.output.write_all(rows)?)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError> {
        if self.row_bytes
            != summary
                .points
                .saturating_mul(self.layout.row_bytes() as u64)
        {
            return Err(EncodeError::library("a batch was written in part"));
        }
        let (entry, header) = self.array(summary.points);
        self.output.seek(SeekFrom::Start(self.points_offset))?;
        self.output.write_all(&[entry.header(), header].concat())?;
        let offset = self.output.seek(SeekFrom::End(0))?;
        let directory = [self.metadata.central_header(), entry.central_header()].concat();
        let end = end(offset, &directory);
        self.output.write_all(&[directory, end].concat())?;
        Ok(self.output.flush()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows may not move when their count becomes known.
    #[test]
    fn headers_of_an_array_have_one_length() {
        for fields in [Fields::NONE, Fields::FILE, Fields::ALL] {
            let layout = RowLayout::new(fields);
            let lengths = [0, 9, 10, 29_000_000, u64::MAX].map(|count| {
                let header = array_header(&layout, count);
                assert_eq!(header.last(), Some(&b'\n'));
                header.len()
            });
            assert!(
                lengths.iter().all(|length| *length == lengths[0]),
                "{lengths:?}"
            );
            assert_eq!(lengths[0] % ALIGNMENT, 0);
        }
    }

    /// After a cloud of more than 4 GiB.
    #[test]
    fn an_offset_beyond_32_bits_is_in_the_end_of_64() {
        let offset = 5 << 32;
        let end = end(offset, &[0; 100]);
        let field = |from: usize| u64::from_le_bytes(end[from..from + 8].try_into().unwrap());
        assert_eq!(
            (field(40), field(48), field(64)),
            (100, offset, offset + 100)
        );
        assert_eq!(end[end.len() - 6..end.len() - 2], IN_64.to_le_bytes());
    }
}
