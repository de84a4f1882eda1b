//! Behind a damaged pcapng block: where the next sound one begins. A block is known by its type and
//! by the length that stands in front and behind; in one that we look into, its parts must fit that
//! length too.
//!
//! Deliberately not for classic pcap, where nothing marks the start of a record. Bounded: blocks of
//! up to 128 KiB are recognised (a packet has 64 KiB at most), each byte is looked at once, and no
//! more is held than for reading.

use std::io::{self, Read};

use super::pcapng::{BYTE_ORDER_MAGIC, FRAMING_LEN, PACKET_DATA_OFFSET, SECTION_HEADER};
use super::window::Window;
use pcap_parser::pcapng::{EPB_MAGIC, IDB_MAGIC, SPB_MAGIC};

/// The longest block that is recognised.
const MAX_LEN: usize = 128 << 10;
/// Blocks in a row that leave no doubt.
const CHAIN_LEN: usize = 3;
/// Name resolution, interface statistics, systemd's journal, decryption secrets, the two custom
/// blocks: only their frame is looked at.
const OTHERS: [u32; 6] = [4, 5, 9, 10, 0x0BAD, 0x4000_0BAD];

/// Where reading can go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sound {
    /// Bytes passed over.
    pub(super) skipped: u64,
    /// The byte order of the block found.
    pub(super) big_endian: bool,
}

/// Moves the window to the next sound block behind its first byte; `None`: there is none up to the
/// end of the stream.
pub(super) fn resync<R: Read>(
    window: &mut Window<R>,
    big_endian: bool,
) -> io::Result<Option<Sound>> {
    let mut skipped = 0;
    let mut from = 1;
    loop {
        let bytes = window.fill(MAX_LEN * 2)?;
        // Not more, though there may be: what is found must not depend on how the bytes came.
        let bytes = bytes.get(..MAX_LEN * 2).unwrap_or(bytes);
        let ended = bytes.len() < MAX_LEN * 2;
        let to = if ended { bytes.len() } else { MAX_LEN };
        for at in from..to {
            let rest = bytes.get(at..).unwrap_or_default();
            if sound(rest, false).is_none() && sound(rest, true).is_none() {
                continue;
            }
            let (at, big_endian) = likeliest(bytes, at, big_endian);
            window.consume(at);
            return Ok(Some(Sound {
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

/// Of what looks like a block within the three bytes behind `first`: where one begins, and its byte
/// order.
///
/// Seen three bytes too early or too late, a block among zeros looks like one of the other byte
/// order. What comes behind it then does not; if it does, the order that was good so far is kept.
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

/// Sound blocks in a row, up to [`CHAIN_LEN`]; the end of what is known is as good as any.
fn chain(mut bytes: &[u8], big_endian: bool) -> usize {
    for blocks in 0..CHAIN_LEN {
        if bytes.is_empty() && blocks > 0 {
            break;
        }
        let next = sound(bytes, big_endian).and_then(|length| bytes.get(length..));
        match next {
            Some(next) => bytes = next,
            None => return blocks,
        }
    }
    CHAIN_LEN
}

/// The length of the sound block of this byte order that begins here.
fn sound(bytes: &[u8], big_endian: bool) -> Option<usize> {
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
