//! Checks that a LAS or LAZ file declares no more than its bytes can hold.
//!
//! The libraries reserve what a header, a table or a chunk declares before they read it; one byte
//! of a file could otherwise take all memory.

/// A little-endian number within bytes.
trait ReadLe: Sized {
    /// The number at an offset; `None` if the bytes end before it.
    fn take(bytes: &[u8], at: usize) -> Option<Self>;
}

macro_rules! read_le {
    ($($number:ty),*) => {$(
        impl ReadLe for $number {
            fn take(bytes: &[u8], at: usize) -> Option<Self> {
                Some(Self::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
            }
        }
    )*};
}

read_le!(u16, u32, u64);

/// Offset of an error, expected and actual content.
pub(super) type Wrong = (usize, &'static str, String);

/// Offsets in the header.
const MINOR: usize = 25;
const HEADER_SIZE: usize = 94;
const DATA_AT: usize = 96;
const RECORDS: usize = 100;
const POINT_FORMAT: usize = 104;
const POINT_SIZE: usize = 105;
const EXTENDED_AT: usize = 235;
const EXTENDED: usize = 243;
/// Bits of the format that mark compressed points.
const COMPRESSED: u8 = 0xC0;
/// Sizes of the headers of a record and of an extended one, and offsets of their lengths.
const HEAD: usize = 54;
const HEAD_LENGTH: usize = 20;
const EXTENDED_HEAD: usize = 60;
/// The record that describes the compression.
const LASZIP: (&[u8], u16) = (b"laszip encoded\0\0", 22_204);
/// Its compressor for points of format 6 and above.
const LAYERED: u16 = 3;
/// Items of a point: number, bytes if given, whether they are layered, and number of layers; if not
/// given, a layer per byte.
const ITEMS: [(u16, Option<u16>, bool, Option<u16>); 10] = [
    (0, None, false, Some(0)),
    (6, Some(20), false, Some(0)),
    (7, Some(8), false, Some(0)),
    (8, Some(6), false, Some(0)),
    (9, Some(29), false, Some(0)),
    (10, Some(30), true, Some(9)),
    (11, Some(6), true, Some(1)),
    (12, Some(8), true, Some(2)),
    (13, Some(29), true, Some(1)),
    (14, None, true, None),
];

/// Checks everything that is reserved by declared sizes; `points` is the declared number.
pub(super) fn kept(bytes: &[u8], points: u64) -> Result<(), Wrong> {
    let header = LasHeader::read(bytes).ok_or((
        bytes.len(),
        "a header of LAS",
        format!("{} bytes", bytes.len()),
    ))?;
    extended(bytes, &header)?;
    if header.compressed {
        return compressed(bytes, &header);
    }
    let there = bytes.len().saturating_sub(header.data) as u64;
    let size = u64::from(header.point_size);
    match points.checked_mul(size).is_some_and(|all| all <= there) {
        true => Ok(()),
        false => {
            let got = format!("{there} bytes for {points} of {size} bytes");
            Err((header.data, "the points that the header promises", got))
        }
    }
}

struct LasHeader {
    minor: u8,
    size: usize,
    data: usize,
    records: u32,
    compressed: bool,
    point_size: u16,
}

impl LasHeader {
    fn read(bytes: &[u8]) -> Option<Self> {
        Some(Self {
            minor: *bytes.get(MINOR)?,
            size: usize::from(u16::take(bytes, HEADER_SIZE)?),
            data: u32::take(bytes, DATA_AT)? as usize,
            records: u32::take(bytes, RECORDS)?,
            compressed: bytes.get(POINT_FORMAT)? & COMPRESSED != 0,
            point_size: u16::take(bytes, POINT_SIZE)?,
        })
    }
}

/// Extended records after the points.
fn extended(bytes: &[u8], header: &LasHeader) -> Result<(), Wrong> {
    if header.minor < 4 {
        return Ok(());
    }
    let announced = || Some((u64::take(bytes, EXTENDED_AT)?, u32::take(bytes, EXTENDED)?));
    let Some((start, count)) = announced().filter(|(_, count)| *count > 0) else {
        return Ok(());
    };
    let mut at = usize::try_from(start).unwrap_or(usize::MAX);
    for _ in 0..count {
        let end = || {
            let length = u64::take(bytes, at.checked_add(HEAD_LENGTH)?)?;
            let end = at
                .checked_add(EXTENDED_HEAD)?
                .checked_add(usize::try_from(length).ok()?)?;
            (end <= bytes.len()).then_some(end)
        };
        at = end().ok_or((
            at.min(bytes.len()),
            "an extended record within the file",
            format!("{count} of them in {} bytes", bytes.len()),
        ))?;
    }
    Ok(())
}

/// Contents of the compression record.
struct Compressor {
    kind: u16,
    /// Bytes of a point, item by item.
    point: usize,
    /// Layers of a chunk.
    layers: usize,
}

fn compressed(bytes: &[u8], header: &LasHeader) -> Result<(), Wrong> {
    let compressor = compressor(bytes, header).ok_or((
        header.size,
        "a record of LASzip",
        "none that is whole".to_owned(),
    ))?;
    // The offset of the table is before the chunks, or at the end of the file if it could not be
    // written.
    let table_at = |at: usize| u64::take(bytes, at).filter(|&table| table > header.data as u64);
    let table = table_at(header.data)
        .or_else(|| table_at(bytes.len().checked_sub(8)?))
        .and_then(|table| usize::try_from(table).ok())
        .filter(|table| *table < bytes.len());
    let chunks = table.and_then(|table| Some((table, u32::take(bytes, table.checked_add(4)?)?)));
    let missing = (
        header.data,
        "the place of a table of chunks",
        "none within the file".to_owned(),
    );
    let (table, chunks) = chunks.ok_or(missing)?;
    // Every chunk has at least one uncompressed point.
    let start = header.data.saturating_add(8);
    let there = table.saturating_sub(start);
    if (chunks as usize)
        .checked_mul(compressor.point)
        .is_none_or(|least| least > there)
    {
        let got = format!("{chunks} in {there} bytes");
        return Err((table, "chunks of a point and more", got));
    }
    if compressor.kind == LAYERED {
        layers(bytes, &compressor, chunks, start, table)?;
    }
    Ok(())
}

fn compressor(bytes: &[u8], header: &LasHeader) -> Option<Compressor> {
    let mut at = header.size;
    for _ in 0..header.records {
        let length = usize::from(u16::take(bytes, at.checked_add(HEAD_LENGTH)?)?);
        let name = bytes.get(at.checked_add(2)?..)?.get(..16)?;
        let id = u16::take(bytes, at + 18)?;
        let held = bytes.get(at + HEAD..)?.get(..length)?;
        if (name, id) == LASZIP {
            let items = held
                .get(34..)?
                .chunks_exact(6)
                .take(usize::from(u16::take(held, 32)?));
            let kind = u16::take(held, 0)?;
            let (mut point, mut layers) = (0, 0);
            for item in items {
                let (item, size) = (u16::take(item, 0)?, u16::take(item, 2)?);
                let known = ITEMS
                    .iter()
                    .find(|(id, known, ..)| *id == item && known.is_none_or(|known| known == size));
                let (_, _, is_layered, own) = known?;
                // Items of later formats are layered, earlier ones are not.
                if *is_layered != (kind == LAYERED) {
                    return None;
                }
                point += usize::from(size);
                layers += usize::from(own.unwrap_or(size));
            }
            return (point > 0).then_some(Compressor {
                kind,
                point,
                layers,
            });
        }
        at += HEAD + length;
    }
    None
}

/// Consecutive chunks: an uncompressed point, the number of points, the length of each layer, and
/// the layers.
fn layers(
    bytes: &[u8],
    compressor: &Compressor,
    chunks: u32,
    start: usize,
    end: usize,
) -> Result<(), Wrong> {
    let mut at = start;
    for _ in 0..chunks {
        let sizes = at.saturating_add(compressor.point).saturating_add(4);
        let mut next = sizes.saturating_add(compressor.layers.saturating_mul(4));
        for layer in 0..compressor.layers {
            let size = u32::take(bytes, sizes.saturating_add(4 * layer)).unwrap_or(u32::MAX);
            next = next.saturating_add(size as usize);
        }
        if next > end {
            let got = format!("{} bytes up to the table", end.saturating_sub(at));
            return Err((at, "a chunk with its layers", got));
        }
        at = next;
    }
    Ok(())
}
