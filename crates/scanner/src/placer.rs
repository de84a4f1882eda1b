//! Second pass over the records: decodes every firing and hands its points to a sink.

use cloud::{Points, Sink, SinkError};
use drive::record::{Record, Wire};
use lidar::{Decoder, Options, Stats};

use crate::alignment::{Alignment, PlacementCounts};
use crate::fast::{FiringBlockPlacer, MAX_PACKET_POINTS};
use crate::receive_order::ReceiveOrder;

/// Second pass: places every firing and hands the points to a sink in batches.
pub struct Placer<'a> {
    blocks: FiringBlockPlacer<'a>,
    decoder: Decoder,
    batch: Points,
    counts: PlacementCounts,
    receive_order: ReceiveOrder,
    sink: &'a mut dyn Sink,
}

/// Points per batch: few enough to stay in the processor's cache.
const BATCH_POINTS: usize = 1 << 12;

impl<'a> Placer<'a> {
    /// A placer into `sink`, which has begun.
    pub fn new(alignment: &'a Alignment, options: Options, sink: &'a mut dyn Sink) -> Self {
        Self {
            blocks: FiringBlockPlacer::new(alignment),
            decoder: Decoder::new(options),
            batch: Points::with_capacity(sink.fields(), BATCH_POINTS + MAX_PACKET_POINTS),
            counts: PlacementCounts::default(),
            receive_order: ReceiveOrder::default(),
            sink,
        }
    }

    /// Takes one record.
    ///
    /// # Errors
    /// Returns the errors of the sink.
    pub fn observe(&mut self, record: &Record<'_>) -> Result<(), SinkError> {
        let Wire::Lidar { payload, .. } = record.wire else {
            return Ok(());
        };
        let host = self.receive_order.distinct(record.host);
        let (blocks, batch, counts) = (&mut self.blocks, &mut self.batch, &mut self.counts);
        self.decoder.decode_blocks(host, payload, &mut |block| {
            blocks.place(block, batch, counts);
        });
        if self.batch.len() >= BATCH_POINTS {
            self.flush()?;
        }
        Ok(())
    }

    /// Places what the decoder still holds. The caller finishes the sink.
    ///
    /// # Errors
    /// Returns the errors of the sink.
    pub fn finish(mut self) -> Result<(PlacementCounts, Stats), SinkError> {
        let (blocks, batch, counts) = (&mut self.blocks, &mut self.batch, &mut self.counts);
        self.decoder
            .finish_blocks(&mut |block| blocks.place(block, batch, counts));
        self.flush()?;
        Ok((self.counts, self.decoder.stats().clone()))
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.sink.points(&self.batch)?;
        self.batch.clear();
        Ok(())
    }
}
