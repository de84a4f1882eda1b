//! A frame as a grid: a row a ring, a column a firing, a cell for every shot whether anything came
//! back or not.
//!
//! Columns are firings as they were fired, so that their number varies by a few from turn to turn.
//! Left out: resampling to a fixed number of columns, which would move points or drop them.

use std::ptr;

use protocol::vlp16::Model;
use units::{Lidar, Span, Stamp};

use crate::firing::{Echo, Firing, SensorPoint};
use crate::frames::LidarFrameError;

/// One firing of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiringColumn {
    /// When laser 0 fired.
    pub start: Stamp<Lidar>,
    /// Azimuth at `start` in degrees, 0 up to 360, clockwise from y seen from above.
    pub azimuth_deg: f64,
}

/// The returns of some firings of one sensor, ring by firing.
///
/// ReturnLayer 0 holds the strongest or last return of a single-return mode, and of dual mode the last.
/// ReturnLayer 1 holds dual mode's second return; a pulse whose two returns are one has it in both
/// layers.
#[derive(Clone, Debug, Default)]
pub struct OrganisedFrame {
    model: Option<&'static Model>,
    columns: Vec<FiringColumn>,
    /// Firing by firing, within one from the lowest ring up; a `Vec` a layer, the second empty
    /// until it is needed.
    layers: [Vec<Option<SensorPoint>>; 2],
}

impl OrganisedFrame {
    /// A frame without firings.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a firing as the next column.
    ///
    /// # Errors
    /// [`LidarFrameError::Model`] where it is not of the model of those before it; the frame stays as it
    /// was.
    pub fn push(&mut self, firing: &Firing<'_>) -> Result<(), LidarFrameError> {
        let model = *self.model.get_or_insert(firing.model);
        if !ptr::eq(model, firing.model) {
            return Err(LidarFrameError::Model {
                expected: model.name,
                got: firing.model.name,
            });
        }
        let first = self.columns.len() * self.rings();
        let end = first + self.rings();
        self.columns.push(FiringColumn {
            start: firing.start,
            azimuth_deg: firing.azimuth_deg,
        });
        let [only, second] = &mut self.layers;
        only.resize(end, None);
        if !second.is_empty() {
            second.resize(end, None);
        }
        for point in firing.points() {
            let (in_only, in_second) = match point.echo {
                Echo::Strongest | Echo::Last | Echo::Unknown => (true, false),
                Echo::StrongestOrSecond => (false, true),
                Echo::LastAndStrongest => (true, true),
            };
            let at = first + usize::from(point.ring);
            if in_only && let Some(cell) = only.get_mut(at) {
                *cell = Some(point);
            }
            if in_second {
                second.resize(end, None);
                if let Some(cell) = second.get_mut(at) {
                    *cell = Some(point);
                }
            }
        }
        Ok(())
    }

    /// Forgets the firings and keeps the memory.
    pub fn clear(&mut self) {
        self.model = None;
        self.columns.clear();
        self.layers.iter_mut().for_each(Vec::clear);
    }

    /// Height of the grid: rings of the model, 0 without firings.
    #[must_use]
    pub fn rings(&self) -> usize {
        self.model.map_or(0, |model| model.lasers.len())
    }

    /// The grid's columns in the order of firing; their number is its width.
    #[must_use]
    pub fn columns(&self) -> &[FiringColumn] {
        &self.columns
    }

    /// 2 where a dual-mode return was seen, else 1.
    #[must_use]
    pub const fn layers(&self) -> usize {
        if self.layers[1].is_empty() { 1 } else { 2 }
    }

    /// What a shot brought back; `None` for nothing, and outside the grid. Ring 0 is the lowest.
    #[must_use]
    pub fn cell(&self, layer: usize, ring: usize, column: usize) -> Option<&SensorPoint> {
        if ring >= self.rings() {
            return None;
        }
        let at = column.checked_mul(self.rings())?.checked_add(ring)?;
        self.layers.get(layer)?.get(at)?.as_ref()
    }

    /// When a shot was fired, whether or not anything came back; `None` outside the grid.
    #[must_use]
    pub fn time(&self, ring: usize, column: usize) -> Option<Stamp<Lidar>> {
        let lasers = self.model?.lasers;
        let laser = lasers
            .iter()
            .find(|laser| usize::from(laser.ring) == ring)?;
        let delay = Span::from_nanos(i64::from(laser.delay_ns));
        Some(self.columns.get(column)?.start.saturating_add(delay))
    }

    /// A ring's cells in the order of firing, as many as there are columns; empty outside the grid.
    pub fn row(&self, layer: usize, ring: usize) -> impl Iterator<Item = Option<&SensorPoint>> {
        let columns = if ring < self.rings() && layer < self.layers() {
            self.columns.len()
        } else {
            0
        };
        (0..columns).map(move |column| self.cell(layer, ring, column))
    }
}
