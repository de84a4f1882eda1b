//! Options of decoding.

use std::sync::Arc;

use protocol::vlp16::LidarModel;

use crate::corrections::Corrections;
use crate::firing::Duplicates;

/// Options of a [`crate::Decoder`].
#[derive(Clone, Debug)]
pub struct Options {
    /// The model, which otherwise follows from the factory byte and the packet spacing.
    pub model: Option<&'static LidarModel>,
    /// Whether z includes the vertical offset of each laser (manual table 9-1).
    pub vertical_offsets: bool,
    /// Treatment of dual returns at one distance.
    pub duplicates: Duplicates,
    /// Angles, offsets and range corrections of this sensor's lasers, in place of the model's
    /// table. Ignored if their number differs from the model's lasers, which
    /// [`crate::Stats::corrections_refused`] reports.
    pub corrections: Option<Arc<Corrections>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            model: None,
            vertical_offsets: true,
            duplicates: Duplicates::Unique,
            corrections: None,
        }
    }
}
