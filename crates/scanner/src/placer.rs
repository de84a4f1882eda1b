//! Second pass over the records: decodes every firing and hands its points to a sink.

use cloud::{Points, Revolution, Sink, SinkError};
use drive::record::{Record, Wire};
use lidar::{Decoder, FiringBlock, FrameCutter, Options, RevolutionFrame, Stats};

use crate::alignment::{Alignment, PlacementCounts};
use crate::fast::{FiringBlockPlacer, MAX_PACKET_POINTS};
use crate::receive_order::ReceiveOrder;

/// Second pass: places every firing and hands the points to a sink in batches.
pub struct Placer<'a> {
    decoder: Decoder,
    receive_order: ReceiveOrder,
    batches: BatchWriter<'a>,
}

/// Collects points in batches for a sink.
struct BatchWriter<'a> {
    blocks: FiringBlockPlacer<'a>,
    /// Finds the ends of revolutions, if the sink gets them.
    cutter: Option<FrameCutter>,
    batch: Points,
    counts: PlacementCounts,
    sink: &'a mut dyn Sink,
    /// First error of the sink within a packet.
    error: Option<SinkError>,
}

/// Points per batch: few enough to stay in the processor's cache.
const BATCH_POINTS: usize = 1 << 12;

impl<'a> Placer<'a> {
    /// A placer into `sink`, which has begun.
    pub fn new(alignment: &'a Alignment, options: Options, sink: &'a mut dyn Sink) -> Self {
        Self {
            decoder: Decoder::new(options),
            receive_order: ReceiveOrder::default(),
            batches: BatchWriter {
                blocks: FiringBlockPlacer::new(alignment),
                cutter: None,
                batch: Points::with_capacity(sink.fields(), BATCH_POINTS + MAX_PACKET_POINTS),
                counts: PlacementCounts::default(),
                sink,
                error: None,
            },
        }
    }

    /// Also calls [`Sink::revolution`] at the end of each revolution that `cutter` finds.
    #[must_use]
    pub fn by_revolution(mut self, cutter: FrameCutter) -> Self {
        self.batches.cutter = Some(cutter);
        self
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
        let batches = &mut self.batches;
        self.decoder
            .decode_blocks(host, payload, &mut |block| batches.add(block));
        if batches.batch.len() >= BATCH_POINTS {
            batches.flush();
        }
        batches.error.take().map_or(Ok(()), Err)
    }

    /// Places what the decoder still holds. The caller finishes the sink.
    ///
    /// # Errors
    /// Returns the errors of the sink.
    pub fn finish(mut self) -> Result<(PlacementCounts, Stats), SinkError> {
        let mut batches = self.batches;
        self.decoder.finish_blocks(&mut |block| batches.add(block));
        let last = batches.cutter.as_mut().and_then(FrameCutter::finish);
        match last {
            Some(frame) => batches.end_revolution(&frame),
            None => batches.flush(),
        }
        match batches.error {
            Some(error) => Err(error),
            None => Ok((batches.counts, self.decoder.stats().clone())),
        }
    }
}

impl BatchWriter<'_> {
    fn add(&mut self, block: &FiringBlock<'_>) {
        let Some(cutter) = &mut self.cutter else {
            return self.blocks.place(block, &mut self.batch, &mut self.counts);
        };
        let firings = block.firings();
        let count = firings.len();
        let cuts = firings.enumerate();
        let cuts: Vec<(usize, RevolutionFrame)> = cuts
            .filter_map(|(n, firing)| Some((n, cutter.firing(&firing)?)))
            .collect();
        if cuts.is_empty() {
            return self.blocks.place(block, &mut self.batch, &mut self.counts);
        }
        let mut placed = 0;
        for (cut, frame) in cuts {
            self.place_firings(block, placed..cut);
            self.end_revolution(&frame);
            placed = cut;
        }
        self.place_firings(block, placed..count);
    }

    fn place_firings(&mut self, block: &FiringBlock<'_>, firings: std::ops::Range<usize>) {
        self.blocks
            .place_firings(block, firings, &mut self.batch, &mut self.counts);
    }

    fn end_revolution(&mut self, frame: &RevolutionFrame) {
        self.flush();
        if let Err(error) = self.sink.revolution(&revolution_of(frame)) {
            self.error.get_or_insert(error);
        }
    }

    fn flush(&mut self) {
        if let Err(error) = self.sink.points(&self.batch) {
            self.error.get_or_insert(error);
        }
        self.batch.clear();
    }
}

/// A frame as sinks get it.
#[must_use]
pub const fn revolution_of(frame: &RevolutionFrame) -> Revolution {
    Revolution {
        index: frame.index,
        firings: frame.firings,
        whole: frame.whole,
    }
}
