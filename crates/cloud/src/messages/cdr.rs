//! CDR, the wire format of ROS 2 messages (OMG DDS-XTypes 1.3, section 7.4: plain CDR, version 1),
//! little-endian.
//!
//! Four bytes of encapsulation header, then the members of a message in their order, each number at
//! a multiple of its own size, counted from the end of that header. Big-endian messages, parameter
//! lists and reading are not supported.

/// A message being written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cdr {
    bytes: Vec<u8>,
}

/// Plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    /// An empty message: its encapsulation header alone.
    #[must_use]
    pub fn new() -> Self {
        Self {
            bytes: ENCAPSULATION.to_vec(),
        }
    }

    /// Removes the message and keeps the memory.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.bytes.extend_from_slice(&ENCAPSULATION);
    }

    /// The message, encapsulation header included.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// A `uint8`, `byte` or `bool`.
    pub fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// An `int32`.
    pub fn i32(&mut self, value: i32) {
        self.number(value.to_le_bytes());
    }

    /// A `uint32`; also the length before a sequence.
    pub fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    /// A `float64`.
    pub fn f64(&mut self, value: f64) {
        self.number(value.to_le_bytes());
    }

    /// A `string`: its length with the terminating zero, its bytes, the zero. Text after a zero is
    /// dropped, as readers in C would not see it.
    pub fn string(&mut self, text: &str) {
        let text = text.split('\0').next().unwrap_or_default();
        self.length(text.len().saturating_add(1));
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// The length of a sequence, before its elements; at most [`u32::MAX`].
    pub fn length(&mut self, elements: usize) {
        self.u32(u32::try_from(elements).unwrap_or(u32::MAX));
    }

    /// A sequence of `float64`.
    pub fn f64s(&mut self, values: &[f64]) {
        self.length(values.len());
        for value in values {
            self.f64(*value);
        }
    }

    /// Appends `count` elements to a byte sequence whose length is written elsewhere.
    pub(super) fn room(&mut self, count: usize) -> &mut [u8] {
        let start = self.bytes.len();
        self.bytes.resize(start + count, 0);
        self.bytes.get_mut(start..).unwrap_or_default()
    }

    /// Reserves a number to be filled in later, and returns its offset.
    pub(super) fn placeholder(&mut self) -> usize {
        self.u32(0);
        self.bytes.len() - 4
    }

    /// Replaces the number written at `offset`.
    pub(super) fn set_u32(&mut self, offset: usize, value: u32) {
        if let Some(place) = self.bytes.get_mut(offset..offset + 4) {
            place.copy_from_slice(&value.to_le_bytes());
        }
    }

    fn number<const N: usize>(&mut self, value: [u8; N]) {
        let behind = self.bytes.len() - ENCAPSULATION.len();
        let at = ENCAPSULATION.len() + behind.next_multiple_of(N);
        self.bytes.resize(at, 0);
        self.bytes.extend_from_slice(&value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_to_their_size_after_the_header() {
        let mut cdr = Cdr::new();
        cdr.u8(7);
        cdr.u32(0x0102_0304);
        cdr.u8(9);
        cdr.f64(1.0);
        assert_eq!(
            cdr.bytes(),
            [
                0, 1, 0, 0, // encapsulation
                7, 0, 0, 0, 4, 3, 2, 1, // u8, padding, u32
                9, 0, 0, 0, 0, 0, 0, 0, // u8, padding to 16, not to 8 after the header
                0, 0, 0, 0, 0, 0, 0xF0, 0x3F,
            ]
        );
    }

    #[test]
    fn string_lengths_include_the_terminating_zero() {
        let mut cdr = Cdr::new();
        cdr.string("ab");
        cdr.string("");
        cdr.string("c\0d");
        assert_eq!(
            cdr.bytes().get(4..),
            Some(
                &[
                    3, 0, 0, 0, b'a', b'b', 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, b'c', 0
                ][..]
            )
        );
    }

    #[test]
    fn a_cleared_message_equals_a_new_one() {
        let mut cdr = Cdr::new();
        cdr.string("something");
        cdr.clear();
        assert_eq!(cdr, Cdr::new());
    }
}
