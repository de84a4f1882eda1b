//! The checksum of EPOS2 serial frames: CRC-16/XMODEM over 16-bit words (Communication Guide, "CRC Calculation").
//!
//! Which words are fed, and in which order the header's two bytes, differs between USB and RS232 and is said there.

/// A checksum under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crc(pub(super) u16);

/// Generator x^16 + x^12 + x^5 + 1.
const POLYNOMIAL: u16 = 0x1021;

impl Crc {
    /// Feeds one word, high byte first.
    #[must_use]
    pub const fn word(self, word: u16) -> Self {
        let mut crc = self.0 ^ word;
        let mut bit = 0;
        while bit < 16 {
            crc = if crc & 0x8000 != 0 {
                (crc << 1) ^ POLYNOMIAL
            } else {
                crc << 1
            };
            bit += 1;
        }
        Self(crc)
    }

    /// The checksum of what has been fed.
    #[must_use]
    pub const fn value(self) -> u16 {
        self.0
    }
}

/// The checksum of `words`.
pub fn crc16(words: impl Iterator<Item = u16>) -> u16 {
    words.fold(Crc::default(), Crc::word).value()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same polynomial byte by byte, written the other way round: shifted in at the bottom with 16 zero bits at the end,
    /// as the guide's own listing does it.
    fn by_the_guide(bytes: &[u8]) -> u16 {
        let mut crc: u32 = 0;
        for byte in bytes.iter().chain(&[0, 0]) {
            for bit in (0..8).rev() {
                crc = (crc << 1) | u32::from((byte >> bit) & 1);
                if crc & 0x1_0000 != 0 {
                    crc ^= 0x1_1021;
                }
            }
        }
        crc as u16
    }

    #[test]
    fn the_catalogues_check_value() {
        // CRC-16/XMODEM of "123456789" is 31C3; eight digits fill four words.
        let words = [0x3132, 0x3334, 0x3536, 0x3738];
        assert_eq!(crc16(words.into_iter()), by_the_guide(b"12345678"));
        assert_eq!(by_the_guide(b"123456789"), 0x31C3);
    }

    proptest::proptest! {
        #[test]
        fn both_ways_agree(words: [u16; 9]) {
            let mut bytes = [0; 18];
            for (pair, word) in bytes.chunks_exact_mut(2).zip(words) {
                pair.copy_from_slice(&word.to_be_bytes());
            }
            proptest::prop_assert_eq!(crc16(words.into_iter()), by_the_guide(&bytes));
        }
    }
}
