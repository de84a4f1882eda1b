//! Frames as grids: one row per ring, one column per firing, one cell per shot with or without a
//! return.
//!
//! Columns are the actual firings, so their number varies slightly between revolutions. Resampling
//! to a fixed number would move or drop points.

use std::ptr;

use protocol::vlp16::LidarModel;
use units::{Lidar, Span, Stamp};

use crate::firing::{Firing, ReturnKind, SensorPoint};
use crate::frames::LidarFrameError;

/// One firing of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiringColumn {
    /// Firing time of laser 0.
    pub start: Stamp<Lidar>,
    /// Azimuth at `start` in degrees, 0 to 360, clockwise from y seen from above.
    pub azimuth_deg: f64,
}

/// The returns of firings of one sensor, by ring and firing.
///
/// Layer 0 holds the strongest or last return of a single-return mode, and of dual mode the
/// last. Layer 1 holds dual mode's second return; a pulse whose two returns are one has it in
/// both layers.
#[derive(Clone, Debug, Default)]
pub struct OrganisedFrame {
    model: Option<&'static LidarModel>,
    columns: Vec<FiringColumn>,
    /// One `Vec` per layer, by firing and then by ring. The second is empty until it is needed.
    layers: [Vec<Option<SensorPoint>>; 2],
}

impl OrganisedFrame {
    /// Creates a frame without firings.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a firing as the next column.
    ///
    /// # Errors
    /// [`LidarFrameError::Model`] for a firing of another model; the frame is unchanged.
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
        let [first_layer, second_layer] = &mut self.layers;
        first_layer.resize(end, None);
        if !second_layer.is_empty() {
            second_layer.resize(end, None);
        }
        for point in firing.points() {
            let (in_first, in_second) = match point.echo {
                ReturnKind::Strongest | ReturnKind::Last | ReturnKind::Unknown => (true, false),
                ReturnKind::StrongestOrSecond => (false, true),
                ReturnKind::LastAndStrongest => (true, true),
            };
            let at = first + usize::from(point.ring);
            if in_first && let Some(cell) = first_layer.get_mut(at) {
                *cell = Some(point);
            }
            if in_second {
                second_layer.resize(end, None);
                if let Some(cell) = second_layer.get_mut(at) {
                    *cell = Some(point);
                }
            }
        }
        Ok(())
    }

    /// Removes the firings and keeps the memory.
    pub fn clear(&mut self) {
        self.model = None;
        self.columns.clear();
        self.layers.iter_mut().for_each(Vec::clear);
    }

    /// Height of the grid: number of rings, 0 without firings.
    #[must_use]
    pub fn rings(&self) -> usize {
        self.model.map_or(0, |model| model.lasers.len())
    }

    /// The grid's columns in order of firing.
    #[must_use]
    pub fn columns(&self) -> &[FiringColumn] {
        &self.columns
    }

    /// Number of layers: 2 with dual returns, else 1.
    #[must_use]
    pub const fn layers(&self) -> usize {
        if self.layers[1].is_empty() { 1 } else { 2 }
    }

    /// The return of a shot; `None` without one or outside the grid. Ring 0 is the lowest.
    #[must_use]
    pub fn cell(&self, layer: usize, ring: usize, column: usize) -> Option<&SensorPoint> {
        if ring >= self.rings() {
            return None;
        }
        let at = column.checked_mul(self.rings())?.checked_add(ring)?;
        self.layers.get(layer)?.get(at)?.as_ref()
    }

    /// Firing time of a shot with or without a return; `None` outside the grid.
    #[must_use]
    pub fn time(&self, ring: usize, column: usize) -> Option<Stamp<Lidar>> {
        let lasers = self.model?.lasers;
        let laser = lasers
            .iter()
            .find(|laser| usize::from(laser.ring) == ring)?;
        let delay = Span::from_nanos(i64::from(laser.delay_ns));
        Some(self.columns.get(column)?.start.saturating_add(delay))
    }

    /// The cells of a ring in order of firing; empty outside the grid.
    pub fn row(&self, layer: usize, ring: usize) -> impl Iterator<Item = Option<&SensorPoint>> {
        let columns = if ring < self.rings() && layer < self.layers() {
            self.columns.len()
        } else {
            0
        };
        (0..columns).map(move |column| self.cell(layer, ring, column))
    }
}
