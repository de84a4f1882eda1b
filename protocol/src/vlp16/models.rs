//! The models as tables: direction and firing time of each laser, scale of distances.
//!
//! A new model is a new table; decoders do not branch on models. The calibration of a single sensor
//! is not included.

use super::data::{BLOCKS, CHANNELS, Product, ReturnMode};

/// One laser of a model, in firing order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Laser {
    /// Angle above the sensor's horizon in degrees.
    pub elevation_deg: f64,
    /// Height of the ray's origin above the sensor's origin in metres; added to z.
    pub vertical_offset_m: f64,
    /// Angle added to the azimuth of its firing, in degrees.
    pub azimuth_offset_deg: f64,
    /// Rank by elevation, 0 the lowest.
    pub ring: u8,
    /// Time from the start of its firing in nanoseconds.
    pub delay_ns: u32,
}

/// A sensor model.
#[derive(Debug, PartialEq)]
pub struct LidarModel {
    /// Name by the manufacturer.
    pub name: &'static str,
    /// Its factory byte.
    pub product: Product,
    /// Its lasers in firing order, which is also the order of the channels.
    pub lasers: &'static [Laser],
    /// Time from one firing of all lasers to the next, in nanoseconds.
    pub firing_period_ns: u32,
    /// Time from one laser (or pair) to the next within a firing, in nanoseconds.
    pub laser_period_ns: u32,
    /// Firings of all lasers that one block holds.
    pub firings_per_block: usize,
    /// Distance of one count, in metres.
    pub distance_unit_m: f64,
}

impl LidarModel {
    /// The model of a factory byte.
    #[must_use]
    pub fn of(product: Product) -> Option<&'static Self> {
        ALL.into_iter().find(|model| model.product == product)
    }

    /// Time from one block to the next block of another firing, in nanoseconds.
    #[must_use]
    pub const fn block_period_ns(&self) -> u32 {
        self.firing_period_ns * self.firings_per_block as u32
    }

    /// Blocks of a packet with different firings: 12, or 6 with dual returns.
    #[must_use]
    pub const fn distinct_blocks(dual: bool) -> usize {
        if dual { BLOCKS / 2 } else { BLOCKS }
    }

    /// Time from one packet to the next in a return mode, in nanoseconds; also the time to fill a
    /// packet.
    #[must_use]
    pub const fn packet_period_ns(&self, dual: bool) -> u32 {
        self.block_period_ns() * Self::distinct_blocks(dual) as u32
    }
}

impl ReturnMode {
    /// Whether two blocks share a firing; `None` for an unknown byte.
    #[must_use]
    pub const fn is_dual(self) -> Option<bool> {
        match self {
            Self::Strongest | Self::Last => Some(false),
            Self::Dual => Some(true),
            Self::Unknown(_) => None,
        }
    }
}

/// All models.
pub static ALL: [&LidarModel; 4] = [&VLP_16, &PUCK_HI_RES, &HDL_32E, &VLP_32C];

/// VLP-16 and Puck LITE (manual 63-9243, table 9-1 and figure 9-9).
pub static VLP_16: LidarModel = LidarModel {
    name: "VLP-16",
    product: Product::Vlp16,
    lasers: &VLP_16_LASERS,
    firing_period_ns: 55_296,
    laser_period_ns: 2_304,
    firings_per_block: 2,
    distance_unit_m: 0.002,
};

/// Puck Hi-Res (manual 63-9243, table 9-1): a VLP-16 with its lasers closer together.
pub static PUCK_HI_RES: LidarModel = LidarModel {
    name: "Puck Hi-Res",
    product: Product::PuckHiRes,
    lasers: &PUCK_HI_RES_LASERS,
    firing_period_ns: 55_296,
    laser_period_ns: 2_304,
    firings_per_block: 2,
    distance_unit_m: 0.002,
};

/// HDL-32E (its manual, "Laser firing sequence"): 4/3 degree steps, printed to two decimals and
/// used as printed; no azimuth offsets. Where its rays start is in the maker's drawing 86-0106
/// (revision B, sheet 2), not in the manual.
///
/// Appendix E of the manual's early editions gives a laser's time as -542.592 us plus 46.08 us per
/// block plus 1.152 us per laser: one after the other, not in pairs, and from a timestamp written
/// when the packet ended. The times here count from the first firing, like the other models' and as
/// the maker's viewer has it.
pub static HDL_32E: LidarModel = LidarModel {
    name: "HDL-32E",
    product: Product::Hdl32e,
    lasers: &HDL_32E_LASERS,
    firing_period_ns: 46_080,
    laser_period_ns: 1_152,
    firings_per_block: 1,
    distance_unit_m: 0.002,
};

/// VLP-32C (manual 63-9325, table 9-2, section 9.5): lasers fire in pairs, off the centre line by
/// one of four angles.
///
/// The maker's XML calibration has the azimuth offsets with the opposite sign because VeloView
/// subtracts them; here they are as in the manual and are added. Neither the manual nor that
/// calibration says how high the rays start: all start in one point here. The manual's sample code
/// multiplies the pair's time by the laser's number, which would make the last pair fire after the
/// next firing began; pairs are counted here, as its figure 9-7 has it.
pub static VLP_32C: LidarModel = LidarModel {
    name: "VLP-32C",
    product: Product::Vlp32c,
    lasers: &VLP_32C_LASERS,
    firing_period_ns: 55_296,
    laser_period_ns: 2_304,
    firings_per_block: 1,
    distance_unit_m: 0.004,
};

static VLP_16_LASERS: [Laser; 16] = lasers(
    [
        -15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0,
        15.0,
    ],
    [
        11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1, 5.1, -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2,
    ],
    [0.0; 16],
    2_304,
    1,
);

static PUCK_HI_RES_LASERS: [Laser; 16] = lasers(
    [
        -10.0, 0.67, -8.67, 2.0, -7.33, 3.33, -6.0, 4.67, -4.67, 6.0, -3.33, 7.33, -2.0, 8.67,
        -0.67, 10.0,
    ],
    [
        7.4, -0.9, 6.5, -1.8, 5.5, -2.7, 4.6, -3.7, 3.7, -4.6, 2.7, -5.5, 1.8, -6.5, 0.9, -7.4,
    ],
    [0.0; 16],
    2_304,
    1,
);

static HDL_32E_LASERS: [Laser; 32] = lasers(
    [
        -30.67, -9.33, -29.33, -8.0, -28.0, -6.67, -26.67, -5.33, -25.33, -4.0, -24.0, -2.67,
        -22.67, -1.33, -21.33, 0.0, -20.0, 1.33, -18.67, 2.67, -17.33, 4.0, -16.0, 5.33, -14.67,
        6.67, -13.33, 8.0, -12.0, 9.33, -10.67, 10.67,
    ],
    [
        17.17, 4.76, 16.27, 4.07, 15.4, 3.38, 14.54, 2.7, 13.71, 2.02, 12.89, 1.35, 12.09, 0.67,
        11.31, 0.0, 10.54, -0.67, 9.78, -1.35, 9.04, -2.02, 8.3, -2.7, 7.58, -3.38, 6.86, -4.07,
        6.15, -4.76, 5.45, -5.45,
    ],
    [0.0; 32],
    1_152,
    1,
);

static VLP_32C_LASERS: [Laser; 32] = lasers(
    [
        -25.0, -1.0, -1.667, -15.639, -11.31, 0.0, -0.667, -8.843, -7.254, 0.333, -0.333, -6.148,
        -5.333, 1.333, 0.667, -4.0, -4.667, 1.667, 1.0, -3.667, -3.333, 3.333, 2.333, -2.667, -3.0,
        7.0, 4.667, -2.333, -2.0, 15.0, 10.333, -1.333,
    ],
    [0.0; 32],
    [
        1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
        1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4,
    ],
    2_304,
    2,
);

/// Lasers from the columns of the manual; ring and delay are derived.
const fn lasers<const N: usize>(
    elevations_deg: [f64; N],
    vertical_offsets_mm: [f64; N],
    azimuth_offsets_deg: [f64; N],
    period_ns: u32,
    at_once: usize,
) -> [Laser; N] {
    let mut table = [Laser {
        elevation_deg: 0.0,
        vertical_offset_m: 0.0,
        azimuth_offset_deg: 0.0,
        ring: 0,
        delay_ns: 0,
    }; N];
    let mut i = 0;
    while i < N {
        let mut ring = 0;
        let mut other = 0;
        while other < N {
            if elevations_deg[other] < elevations_deg[i] {
                ring += 1;
            }
            other += 1;
        }
        table[i] = Laser {
            elevation_deg: elevations_deg[i],
            vertical_offset_m: vertical_offsets_mm[i] / 1000.0,
            azimuth_offset_deg: azimuth_offsets_deg[i],
            ring,
            delay_ns: (i / at_once) as u32 * period_ns,
        };
        i += 1;
    }
    table
}

/// Checks the firing period against the printed recharge time.
const fn timing_is_consistent(model: &LidarModel, groups: u32, recharge_ns: u32) -> bool {
    groups * model.laser_period_ns + recharge_ns == model.firing_period_ns
        && model.lasers.len() * model.firings_per_block == CHANNELS
}

const _: () = assert!(timing_is_consistent(&VLP_16, 16, 18_432));
const _: () = assert!(timing_is_consistent(&PUCK_HI_RES, 16, 18_432));
const _: () = assert!(timing_is_consistent(&HDL_32E, 32, 9_216));
const _: () = assert!(timing_is_consistent(&VLP_32C, 16, 18_432));
const _: () = assert!(VLP_16.block_period_ns() == 110_592);
// HDL-32E, appendix E: from a packet's first laser to its last.
const _: () = assert!(11 * HDL_32E.block_period_ns() + HDL_32E_LASERS[31].delay_ns == 542_592);
const _: () = assert!(HDL_32E.packet_period_ns(true) == 276_480);
const _: () = assert!(VLP_32C.packet_period_ns(false) == 663_552);
const _: () = assert!(VLP_32C.packet_period_ns(true) == 331_776);
// 753.5 packets a second, the manual's 754 rounded.
const _: () = assert!(VLP_16.packet_period_ns(false) == 1_327_104);
const _: () = assert!(VLP_16.packet_period_ns(true) == 663_552);
const _: () = assert!(HDL_32E.packet_period_ns(false) == 552_960);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_number_the_elevations_from_below() {
        for model in ALL {
            let mut by_ring = [f64::NAN; 32];
            for laser in model.lasers {
                by_ring[usize::from(laser.ring)] = laser.elevation_deg;
            }
            let rings = &by_ring[..model.lasers.len()];
            assert!(
                rings.is_sorted_by(|a, b| a < b),
                "{}: {rings:?}",
                model.name
            );
        }
        assert_eq!(VLP_16.lasers[0].ring, 0);
        assert_eq!(VLP_16.lasers[1].ring, 8);
        assert_eq!(VLP_16.lasers[15].ring, 15);
    }

    #[test]
    fn delays_match_the_manual() {
        assert_eq!(VLP_16.lasers[15].delay_ns, 34_560); // figure 9-9
        assert_eq!(HDL_32E.lasers[31].delay_ns, 35_712);
        assert_eq!(VLP_32C.lasers[0].delay_ns, VLP_32C.lasers[1].delay_ns);
        assert_eq!(VLP_32C.lasers[31].delay_ns, 34_560); // pairs, figure 9-7
        for model in ALL {
            let last = model.lasers.last().unwrap().delay_ns;
            assert!(last + model.laser_period_ns <= model.firing_period_ns);
        }
    }

    #[test]
    fn the_tables_have_the_symmetry_of_the_optics() {
        // Table 9-1: laser i and laser 15 - i mirror each other about the horizon.
        for model in [&VLP_16, &PUCK_HI_RES] {
            for (low, high) in model.lasers.iter().zip(model.lasers.iter().rev()) {
                assert_eq!(low.elevation_deg, -high.elevation_deg);
                assert_eq!(low.vertical_offset_m, -high.vertical_offset_m);
            }
        }
        for model in ALL {
            for laser in model.lasers {
                // A ray that points down starts high: all rays cross near one place.
                assert!(laser.elevation_deg * laser.vertical_offset_m <= 0.0);
            }
        }
        // HDL-32E: 4/3 degree steps, and all rays cross 28.95 mm in front of the axis.
        for laser in HDL_32E.lasers {
            let exact = -92.0 / 3.0 + 4.0 / 3.0 * f64::from(laser.ring);
            assert!((laser.elevation_deg - exact).abs() < 0.0051, "{laser:?}");
            let crossing_m = 0.02895 * -laser.elevation_deg.to_radians().tan();
            assert!(
                (laser.vertical_offset_m - crossing_m).abs() < 1.1e-5,
                "{laser:?}"
            );
        }
        // VLP-32C table 9-6: no two neighbours in elevation share a column.
        let column = |ring: u8| VLP_32C.lasers.iter().find(|l| l.ring == ring).unwrap();
        for ring in 6..26 {
            let (a, b) = (column(ring), column(ring + 1));
            assert_ne!(a.azimuth_offset_deg, b.azimuth_offset_deg, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_factory_byte_names_its_model() {
        for model in ALL {
            assert!(core::ptr::eq(LidarModel::of(model.product).unwrap(), model));
        }
        assert!(LidarModel::of(Product::Unknown(0x63)).is_none());
    }
}
