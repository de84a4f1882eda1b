//! Search for the next valid pcapng block after damage. A block is recognised by its type and by
//! equal lengths at its start and end; in parsed blocks the content must fit the length.
//!
//! Blocks of up to 128 KiB are recognised (a packet has at most 64 KiB), and each byte is examined
//! once. Classic pcap has no such marks.

use std::io::{self, Read};

use super::pcapng::{BYTE_ORDER_MAGIC, FRAMING_LEN, PACKET_DATA_OFFSET, SECTION_HEADER};
use super::window::Window;
use pcap_parser::pcapng::{EPB_MAGIC, IDB_MAGIC, SPB_MAGIC};

/// Longest block that is recognised.
const MAX_LEN: usize = 128 << 10;
/// Consecutive valid blocks that count as certain.
const CHAIN_LEN: usize = 3;
/// Blocks of which only the framing is checked: name resolution, interface statistics, systemd
/// journal, decryption secrets, the two custom blocks.
const OTHERS: [u32; 6] = [4, 5, 9, 10, 0x0BAD, 0x4000_0BAD];

/// A valid block after damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ValidBlock {
    /// Bytes skipped.
    pub(super) skipped: u64,
    /// Byte order of the block.
    pub(super) big_endian: bool,
}

/// Moves the window to the next valid block after its first byte; `None` if the stream has none.
pub(super) fn resync<R: Read>(
    window: &mut Window<R>,
    big_endian: bool,
) -> io::Result<Option<ValidBlock>> {
    let mut skipped = 0;
    let mut from = 1;
    loop {
        let bytes = window.fill(MAX_LEN * 2)?;
        // A fixed length, so that the result does not depend on how the reader delivers bytes.
        let bytes = bytes.get(..MAX_LEN * 2).unwrap_or(bytes);
        let ended = bytes.len() < MAX_LEN * 2;
        let to = if ended { bytes.len() } else { MAX_LEN };
        for at in from..to {
            let rest = bytes.get(at..).unwrap_or_default();
            if valid_len(rest, false).is_none() && valid_len(rest, true).is_none() {
                continue;
            }
            let (at, big_endian) = likeliest(bytes, at, big_endian);
            window.consume(at);
            return Ok(Some(ValidBlock {
                skipped: skipped + at as u64,
                big_endian,
            }));
        }
        if ended {
            return Ok(None);
        }
        window.consume(to);
        skipped += to as u64;
        from = 0;
    }
}

/// The most likely start of a block within three bytes after `first`, and its byte order.
///
/// Shifted by up to three bytes, a block among zeros resembles one of the other byte order, but the
/// blocks after it do not. Otherwise the current order is kept.
fn likeliest(bytes: &[u8], first: usize, big_endian: bool) -> (usize, bool) {
    let mut best = (0, first, big_endian);
    for order in [big_endian, !big_endian] {
        for at in first..first + 4 {
            let chain = chain(bytes.get(at..).unwrap_or_default(), order);
            if chain > best.0 {
                best = (chain, at, order);
            }
        }
    }
    (best.1, best.2)
}

/// Number of consecutive valid blocks, up to [`CHAIN_LEN`]; the end of the bytes counts as valid.
fn chain(mut bytes: &[u8], big_endian: bool) -> usize {
    for blocks in 0..CHAIN_LEN {
        if bytes.is_empty() && blocks > 0 {
            break;
        }
        let next = valid_len(bytes, big_endian).and_then(|length| bytes.get(length..));
        match next {
            Some(next) => bytes = next,
            None => return blocks,
        }
    }
    CHAIN_LEN
}

/// The length of the valid block of this byte order at the start of `bytes`.
fn valid_len(bytes: &[u8], big_endian: bool) -> Option<usize> {
    let word = |at: usize| word(bytes, at, big_endian);
    let kind = word(0)?;
    let front = word(4)?;
    let length = usize::try_from(front).ok()?;
    // Bytes of the fixed parts, framing included (draft-ietf-opsawg-pcapng, section 4).
    let least = match kind {
        SECTION_HEADER => 28,
        IDB_MAGIC => 20,
        SPB_MAGIC => 16,
        EPB_MAGIC => PACKET_DATA_OFFSET + 4,
        _ if OTHERS.contains(&kind) => FRAMING_LEN as usize,
        _ => return None,
    };
    let framed = (least..=MAX_LEN).contains(&length)
        && length.is_multiple_of(4)
        && word(length - 4) == Some(front);
    let fits = match kind {
        SECTION_HEADER => word(8)? == BYTE_ORDER_MAGIC,
        EPB_MAGIC => word(20)? as usize <= length.saturating_sub(least),
        _ => true,
    };
    (framed && fits).then_some(length)
}

fn word(bytes: &[u8], at: usize, big_endian: bool) -> Option<u32> {
    let field = *bytes.get(at..)?.first_chunk()?;
    Some(if big_endian {
        u32::from_be_bytes(field)
    } else {
        u32::from_le_bytes(field)
    })
}
