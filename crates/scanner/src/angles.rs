//! Tilt angles over host time: from shaft samples, or from a table of another rig.

mod latched;
mod outliers;
mod polls;
mod table;

use units::{Degrees, Host, Span, Stamp};

pub(crate) use outliers::{
    MAX_SPEED_DEG_S, OutlierFilter, discard as discard_outliers, is_reached,
};
pub(crate) use polls::{SlowPollFilter, sample, with_shared_sd};
pub use table::{AngleTable, AngleTableError, TableTime};

/// The platform's angle at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleSample {
    /// Middle of request and answer.
    pub host: Stamp<Host>,
    /// Half of the round trip: the angle held within this span of `host`.
    pub bound: Span,
    /// Tilt angle.
    pub angle: Degrees,
}
