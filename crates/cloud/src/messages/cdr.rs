//! CDR, the wire format of ROS 2 messages (OMG DDS-XTypes 1.3, section 7.4: plain CDR, version 1),
//! little-endian.
//!
//! Four bytes of encapsulation header, then the members of a message in their order, each number at
//! a multiple of its own size, counted from the end of that header. Big-endian messages and
//! parameter lists are not supported.

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

    /// A `uint64`.
    pub fn u64(&mut self, value: u64) {
        self.number(value.to_le_bytes());
    }

    /// An `int64`.
    pub fn i64(&mut self, value: i64) {
        self.number(value.to_le_bytes());
    }

    /// An array of bytes.
    pub fn array(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
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

/// A message, or a part of one, that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("CDR message, byte {offset}: expected {expected}, got {got}")]
#[non_exhaustive]
pub struct CdrError {
    /// Offset in the message.
    pub offset: usize,
    /// What was expected.
    pub expected: String,
    /// What was found.
    pub got: String,
}

impl CdrError {
    pub(crate) fn new(offset: usize, expected: &str, got: impl ToString) -> Self {
        Self {
            offset,
            expected: expected.to_owned(),
            got: got.to_string(),
        }
    }
}

/// Reads a message from its beginning.
#[derive(Clone, Debug)]
pub struct CdrReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> CdrReader<'a> {
    /// Begins behind the encapsulation header.
    ///
    /// # Errors
    /// [`CdrError`] where the message is not plain CDR, little-endian.
    pub fn new(bytes: &'a [u8]) -> Result<Self, CdrError> {
        let mut reader = Self { bytes, at: 0 };
        match reader.take(ENCAPSULATION.len())? {
            [0, 1, ..] => Ok(reader),
            other => {
                let got = format!("{other:02x?}");
                Err(CdrError::new(0, "CDR, little-endian", got))
            }
        }
    }

    /// Offset of the next byte in the message.
    #[must_use]
    pub const fn offset(&self) -> usize {
        self.at
    }

    /// The next bytes.
    ///
    /// # Errors
    /// [`CdrError`], as for all reads, where the message ends before.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let left = self.bytes.get(self.at..).unwrap_or_default();
        let taken = left.get(..count);
        let taken =
            taken.ok_or_else(|| CdrError::new(self.at, &format!("{count} bytes"), left.len()))?;
        self.at += count;
        Ok(taken)
    }

    /// An array of bytes.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        Ok(self.take(N)?.first_chunk().copied().unwrap_or([0; N]))
    }

    /// A `uint8`, `byte` or `bool`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn u8(&mut self) -> Result<u8, CdrError> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    /// An `int32`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn i32(&mut self) -> Result<i32, CdrError> {
        Ok(i32::from_le_bytes(self.number()?))
    }

    /// A `uint32`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn u32(&mut self) -> Result<u32, CdrError> {
        Ok(u32::from_le_bytes(self.number()?))
    }

    /// An `int64`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn i64(&mut self) -> Result<i64, CdrError> {
        Ok(i64::from_le_bytes(self.number()?))
    }

    /// A `uint64`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn u64(&mut self) -> Result<u64, CdrError> {
        Ok(u64::from_le_bytes(self.number()?))
    }

    /// A `float64`.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn f64(&mut self) -> Result<f64, CdrError> {
        Ok(f64::from_le_bytes(self.number()?))
    }

    /// A `float64` that is finite.
    ///
    /// # Errors
    /// [`CdrError`], also for NaN and infinities.
    pub fn finite(&mut self) -> Result<f64, CdrError> {
        let value = self.f64()?;
        match value.is_finite() {
            true => Ok(value),
            false => Err(CdrError::new(self.at - 8, "a finite number", value)),
        }
    }

    /// A sequence of bytes, or a string with its zero.
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn sequence(&mut self) -> Result<&'a [u8], CdrError> {
        let length = self.u32()? as usize;
        self.take(length)
    }

    /// A `string`.
    ///
    /// # Errors
    /// [`CdrError`], also where it is not UTF-8.
    pub fn string(&mut self) -> Result<String, CdrError> {
        let at = self.at;
        let text = self.sequence()?;
        let text = text.strip_suffix(&[0]).unwrap_or(text);
        let text = str::from_utf8(text).map_err(|error| CdrError::new(at, "UTF-8", error))?;
        Ok(text.to_owned())
    }

    /// A sequence of at most one element.
    ///
    /// # Errors
    /// [`CdrError`], also for a longer one.
    pub fn optional<T>(
        &mut self,
        element: impl FnOnce(&mut Self) -> Result<T, CdrError>,
    ) -> Result<Option<T>, CdrError> {
        let at = self.at;
        match self.u32()? {
            0 => Ok(None),
            1 => element(self).map(Some),
            more => Err(CdrError::new(at, "at most one element", more)),
        }
    }

    /// A sequence of elements that have at least one byte each.
    ///
    /// # Errors
    /// [`CdrError`]. Memory is for the elements that are there, whatever the length says.
    pub fn list<T>(
        &mut self,
        mut element: impl FnMut(&mut Self) -> Result<T, CdrError>,
    ) -> Result<Vec<T>, CdrError> {
        let length = self.u32()?;
        let mut elements = Vec::new();
        for _ in 0..length {
            elements.push(element(self)?);
        }
        Ok(elements)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        let behind = self.at - ENCAPSULATION.len();
        self.take(behind.next_multiple_of(N) - behind)?;
        self.array()
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
    fn the_reader_returns_what_was_written() {
        let mut cdr = Cdr::new();
        cdr.u8(7);
        cdr.f64(-1.5);
        cdr.string("déjà");
        cdr.i32(-9);
        cdr.i64(-7);
        cdr.u64(u64::MAX);
        cdr.f64s(&[0.5, 1.5]);
        cdr.length(1);
        cdr.f64(2.5);
        cdr.length(0);
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        assert_eq!(reader.u8(), Ok(7));
        assert_eq!(reader.f64(), Ok(-1.5));
        assert_eq!(reader.string(), Ok("déjà".to_owned()));
        assert_eq!(reader.i32(), Ok(-9));
        assert_eq!((reader.i64(), reader.u64()), (Ok(-7), Ok(u64::MAX)));
        assert_eq!(reader.list(CdrReader::f64), Ok(vec![0.5, 1.5]));
        assert_eq!(reader.optional(CdrReader::f64), Ok(Some(2.5)));
        assert_eq!(reader.optional(CdrReader::f64), Ok(None));
        assert_eq!(reader.offset(), cdr.bytes().len());
    }

    #[test]
    fn damaged_messages_are_errors_with_their_offset() {
        let of = |bytes: &[u8]| CdrReader::new(bytes).map(|reader| reader.offset());
        assert_eq!(of(&[0, 1, 0]), Err(CdrError::new(0, "4 bytes", 3)));
        assert_eq!(
            of(&[0, 0, 0, 0]).unwrap_err().expected,
            "CDR, little-endian"
        );
        fn reader(bytes: &[u8]) -> CdrReader<'_> {
            CdrReader::new(bytes).unwrap()
        }
        let long = [0, 1, 0, 0, 255, 255, 255, 255, 1];
        let error = reader(&long).sequence().unwrap_err();
        assert_eq!(error, CdrError::new(8, "4294967295 bytes", 1));
        for value in [f64::NAN, f64::INFINITY] {
            let mut cdr = Cdr::new();
            cdr.f64(value);
            let error = reader(cdr.bytes()).finite().unwrap_err();
            assert_eq!(
                (error.offset, error.expected.as_str()),
                (4, "a finite number")
            );
        }
        let two = [0, 1, 0, 0, 2, 0, 0, 0];
        let error = reader(&two).optional(CdrReader::u8).unwrap_err();
        assert_eq!(error, CdrError::new(4, "at most one element", 2));
        let binary = [0, 1, 0, 0, 1, 0, 0, 0, 255];
        assert_eq!(reader(&binary).string().unwrap_err().expected, "UTF-8");
    }

    #[test]
    fn a_cleared_message_equals_a_new_one() {
        let mut cdr = Cdr::new();
        cdr.string("something");
        cdr.clear();
        assert_eq!(cdr, Cdr::new());
    }
}
