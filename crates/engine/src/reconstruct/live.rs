//! The live cloud of a log, and its distance from the cloud that replaces it.

use std::collections::HashMap;

use cloud::{Fields, Points, Sink, SinkError};
use scanner::Live;
use units::{Lidar, Span, Stamp};

use super::failures::scan_failure;
use super::replay::Reconstruction;
use super::report::LiveReport;
use crate::failure::Failure;
use crate::output::sink_failure;

/// Stride of the compared firings of the live points: one in this many, which bounds the memory.
const STRIDE: i64 = 8;

/// Identity of a point: device time of its firing, laser, echo.
type PointKey = (Stamp<Lidar>, u8, u8);

const KEY: Fields = Fields::DEVICE_TIME.union(Fields::LASER).union(Fields::ECHO);

fn keyed(batch: &Points) -> impl Iterator<Item = (PointKey, [f64; 3])> + '_ {
    let firings = batch.device_time().iter().zip(batch.laser());
    let keys = firings.zip(batch.echo());
    batch
        .positions()
        .zip(keys)
        .map(|(position_m, ((&time, &laser), &echo))| ((time, laser, echo), position_m))
        // Firings are at least 2 us apart.
        .filter(|((time, ..), _)| (time.as_nanos() / 2_000) % STRIDE == 0)
}

/// The points that the live view shows of a log.
#[derive(Default)]
pub struct LivePoints {
    positions: HashMap<PointKey, [f64; 3]>,
    placed: u64,
    lag: Span,
}

impl Sink for LivePoints {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        batch.fields().require(KEY)?;
        self.positions.extend(keyed(batch));
        Ok(())
    }

    fn fields(&self) -> Fields {
        KEY
    }
}

impl LivePoints {
    /// Places the points of a recording by the steps of the live view.
    ///
    /// # Errors
    /// As [`super::replay::make`].
    pub fn of(request: &Reconstruction<'_>) -> Result<Self, Failure> {
        let source = request.recording;
        let config = source.config()?;
        let mut points = Self::default();
        let mut lag = Span::ZERO;
        let mut live = Live::new(&config, request.options.clone(), &mut points)
            .map_err(|error| scan_failure(source.path(), None, &error))?;
        let wrong = |error: SinkError| sink_failure(source.path(), &error);
        source.read(|record| {
            live.observe(record).map_err(wrong)?;
            lag = lag.max(live.lag().unwrap_or_default());
            request.check_interrupt()
        })?;
        let (counts, _) = live.finish().map_err(wrong)?;
        points.placed = counts.points;
        points.lag = lag;
        Ok(points)
    }
}

/// The distance of a cloud from the live points, of one firing in eight.
pub struct LiveDifference {
    live: LivePoints,
    compared: u64,
    squares_m2: f64,
    worst_m: f64,
}

impl LiveDifference {
    /// Compares with these points.
    #[must_use]
    pub const fn new(live: LivePoints) -> Self {
        Self {
            live,
            compared: 0,
            squares_m2: 0.0,
            worst_m: 0.0,
        }
    }

    /// The result.
    #[must_use]
    pub fn report(&self) -> LiveReport {
        let is_compared = self.compared > 0;
        LiveReport {
            points: self.live.placed,
            rms_m: is_compared.then(|| (self.squares_m2 / self.compared as f64).sqrt()),
            worst_m: is_compared.then_some(self.worst_m),
            lag_s: self.live.lag.as_secs_f64(),
        }
    }
}

impl Sink for LiveDifference {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        batch.fields().require(KEY)?;
        for (key, position_m) in keyed(batch) {
            if let Some(live_m) = self.live.positions.get(&key) {
                let offsets = position_m.iter().zip(live_m).map(|(a, b)| a - b);
                let square_m2: f64 = offsets.map(|offset_m| offset_m * offset_m).sum();
                self.compared += 1;
                self.squares_m2 += square_m2;
                self.worst_m = self.worst_m.max(square_m2.sqrt());
            }
        }
        Ok(())
    }

    fn fields(&self) -> Fields {
        KEY
    }
}
