//! The checksum of EPOS2 serial frames: CRC-16/XMODEM over 16-bit words (Communication Guide, "CRC
//! Calculation"). USB and RS232 order the two bytes of the header word differently.

/// Generator polynomial x^16 + x^12 + x^5 + 1.
const POLYNOMIAL: u16 = 0x1021;

/// The checksum of `words`, high byte of each first.
pub fn crc16(words: impl IntoIterator<Item = u16>) -> u16 {
    let shift = |crc: u16, _| crc << 1 ^ if crc & 0x8000 == 0 { 0 } else { POLYNOMIAL };
    let word = |crc: u16, word: u16| (0..16).fold(crc ^ word, shift);
    words.into_iter().fold(0, word)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same polynomial byte by byte: bits enter at the bottom and 16 zero bits follow, as in
    /// the listing of the guide.
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
    fn the_crc_has_the_catalogue_check_value() {
        // CRC-16/XMODEM of "123456789" is 31C3; eight digits fill four words.
        let words = [0x3132, 0x3334, 0x3536, 0x3738];
        assert_eq!(crc16(words), by_the_guide(b"12345678"));
        assert_eq!(by_the_guide(b"123456789"), 0x31C3);
    }

    proptest::proptest! {
        #[test]
        fn both_implementations_agree(words: [u16; 9]) {
            let mut bytes = [0; 18];
            for (pair, word) in bytes.chunks_exact_mut(2).zip(words) {
                pair.copy_from_slice(&word.to_be_bytes());
            }
            proptest::prop_assert_eq!(crc16(words), by_the_guide(&bytes));
        }
    }
}
