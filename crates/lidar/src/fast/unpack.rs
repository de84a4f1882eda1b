//! SIMD unpacking of a packet's channels into distances, reflectivities and bits of returns.
//!
//! Packets have three bytes per channel. All twelve blocks are unpacked together, in the
//! processor's widest registers. The plain definition is [`DataPacket::blocks`].

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, u8x64, u16x32};
use protocol::vlp16::{BLOCKS, CHANNELS, DataPacket};

/// The channels of a block as in the packet.
pub(crate) type RawChannels = [[u8; 3]; CHANNELS];

/// The channels of one block.
///
/// Aligned to cache lines, so that no register spans two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct UnpackedBlock {
    /// Distances in the model's unit.
    pub counts: [f64; CHANNELS],
    pub reflectivities: [u8; CHANNELS],
    /// Bit c is set if channel c has a distance.
    pub returns: u32,
    /// Bit c is set if channel c has another distance than in the block before.
    pub changed: u32,
}

/// All channels of a packet.
#[derive(Clone, Debug)]
pub(crate) struct UnpackedPacket {
    level: Level,
    pub blocks: [UnpackedBlock; BLOCKS],
}

impl Default for UnpackedBlock {
    fn default() -> Self {
        Self {
            counts: [0.0; CHANNELS],
            reflectivities: [0; CHANNELS],
            returns: 0,
            changed: 0,
        }
    }
}

impl UnpackedPacket {
    pub(crate) fn new() -> Self {
        Self {
            level: Level::new(),
            blocks: [UnpackedBlock::default(); BLOCKS],
        }
    }

    /// Unpacks a packet.
    pub(crate) fn set(&mut self, packet: &DataPacket<'_>) {
        dispatch!(self.level, simd => unpack(simd, packet, &mut self.blocks));
    }
}

/// Indices of the distance bytes of [`RawChannels`].
const COUNTS: [u8; 2 * CHANNELS] = {
    let mut bytes = [0; 2 * CHANNELS];
    let mut i = 0;
    while i < bytes.len() {
        let swapped = cfg!(target_endian = "big") as usize;
        bytes[i] = joined_index(3 * (i / 2) + ((i % 2) ^ swapped));
        i += 1;
    }
    bytes
};

/// Indices of the reflectivity bytes, each twice.
const REFLECTIVITIES: [u8; 2 * CHANNELS] = {
    let mut bytes = [0; 2 * CHANNELS];
    let mut i = 0;
    while i < bytes.len() {
        bytes[i] = joined_index(3 * (i % CHANNELS) + 2);
        i += 1;
    }
    bytes
};

/// Index of a byte of [`RawChannels`] in its first 64 bytes followed by its last 64.
const fn joined_index(byte: usize) -> u8 {
    let place = if byte < 64 { byte } else { byte + 32 };
    place as u8
}

#[inline(always)]
fn unpack<S: Simd>(simd: S, packet: &DataPacket<'_>, blocks: &mut [UnpackedBlock; BLOCKS]) {
    let counts_of = u8x64::simd_from(simd, COUNTS);
    let reflectivities_of = u8x64::simd_from(simd, REFLECTIVITIES);
    let mut before = u16x32::splat(simd, 0);
    for (unpacked, block) in blocks.iter_mut().zip(packet.blocks()) {
        let raw = block.raw_channels().as_flattened();
        let (head, tail) = (raw.first_chunk(), raw.last_chunk());
        let (Some(head), Some(tail)) = (head, tail) else {
            continue;
        };
        let (head, tail) = (
            u8x64::load_array_ref(simd, head),
            u8x64::load_array_ref(simd, tail),
        );
        let counts: u16x32<S> = head.concat_swizzle_dyn(tail, counts_of).bitcast();
        let (reflectivities, _) = head.concat_swizzle_dyn(tail, reflectivities_of).split();
        reflectivities.store_array(&mut unpacked.reflectivities);
        widen(simd, counts, &mut unpacked.counts);
        unpacked.returns = counts.simd_ne(0).to_bitmask() as u32;
        unpacked.changed = counts.simd_ne(before).to_bitmask() as u32;
        before = counts;
    }
}

/// Converts to f64 through f32, which represents 16 bits exactly.
#[inline(always)]
fn widen<S: Simd>(simd: S, counts: u16x32<S>, to: &mut [f64; CHANNELS]) {
    let froms = counts.as_slice().chunks_exact(S::u16s::LEN);
    for (from, to) in froms.zip(to.chunks_exact_mut(S::u16s::LEN)) {
        let (low, high) = S::u16s::from_slice(simd, from).widen();
        let (low, high) = (
            S::f32s::float_from(low).widen(),
            S::f32s::float_from(high).widen(),
        );
        let quarters = to.chunks_exact_mut(S::f64s::LEN);
        for (to, from) in quarters.zip([low.0, low.1, high.0, high.1]) {
            from.store_slice(to);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use protocol::vlp16::DATA_LEN;

    use super::*;

    proptest! {
        #[test]
        fn every_simd_level_agrees_with_the_plain_definition(
            noise in prop::collection::vec(prop_oneof![Just(0), any::<u8>()], DATA_LEN),
        ) {
            let mut bytes = noise;
            for block in bytes.chunks_mut(100) {
                let header = [0xFF, 0xEE, 0, 0];
                let length = block.len().min(4);
                block[..length].copy_from_slice(&header[..length]);
            }
            let packet = DataPacket::new(&bytes).unwrap();
            let detected = Level::new();
            let mut levels = vec![detected, Level::baseline()];
            #[cfg(target_arch = "x86_64")]
            levels.extend([
                detected.as_sse4_2().map(Level::Sse4_2),
                detected.as_avx2().map(Level::Avx2),
            ].into_iter().flatten());
            for level in levels {
                let mut unpacked = UnpackedPacket { level, ..UnpackedPacket::new() };
                unpacked.set(&packet);
                let mut before = [0; CHANNELS];
                for (unpacked, block) in unpacked.blocks.iter().zip(packet.blocks()) {
                    for (c, channel) in block.channels().enumerate() {
                        prop_assert_eq!(unpacked.counts[c], f64::from(channel.distance_raw));
                        prop_assert_eq!(unpacked.reflectivities[c], channel.reflectivity);
                        prop_assert_eq!(unpacked.returns >> c & 1 != 0, channel.distance_raw != 0);
                        prop_assert_eq!(unpacked.changed >> c & 1 != 0, channel.distance_raw != before[c]);
                        before[c] = channel.distance_raw;
                    }
                }
            }
        }
    }
}
