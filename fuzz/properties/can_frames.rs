//! CAN frames from an input, mostly with identifiers of the simulated unit.

use protocol::canopen::{CanFrame, CanId, CobId, ExtendedId};

use super::input::Input;

/// Identifiers with a meaning for node 1.
const KNOWN: [u16; 16] = [
    0x000, 0x080, 0x081, 0x100, 0x181, 0x201, 0x281, 0x301, 0x381, 0x401, 0x481, 0x501, 0x581,
    0x601, 0x701, 0x77F,
];

/// Builds a frame from the next bytes: identifier, data or remote, length, data.
pub fn frame(input: &mut Input<'_>) -> CanFrame {
    let head = input.u8();
    let id = match head >> 6 {
        0 | 1 => standard(KNOWN[usize::from(head & 0xF)]),
        2 => standard(input.u16() & 0x7FF),
        _ => CanId::Extended(
            ExtendedId::new(input.u32() & ExtendedId::MAX.get()).expect("29 bits are one"),
        ),
    };
    let len = (head >> 4 & 3) + 5;
    if head >> 6 == 1 && head & 0x20 != 0 {
        return CanFrame::remote(id, len).expect("no more than eight bytes");
    }
    CanFrame::new(id, input.take(usize::from(len))).expect("no more than eight bytes")
}

fn standard(id: u16) -> CanId {
    CanId::Standard(CobId::new(id).expect("11 bits are one"))
}
