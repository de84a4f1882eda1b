//! Sinks of points.
//!
//! A sink declares its columns and takes batches; producers compute only declared columns. A
//! writer, a live view, a message queue and a comparison with the truth are all sinks.

use crate::{Diagnostic, Fields, Metadata, Points, SinkError, Summary, TiltTrack};

/// A small file to be stored next to a sink's own.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Companion {
    /// File name, in the same folder.
    pub name: String,
    /// Content.
    pub text: String,
}

impl Companion {
    /// The text beside a file that has no place for its metadata. The first line tells which file
    /// it belongs to, as in the list of files of a bag.
    pub(crate) fn metadata(file_name: &str, columns: &str, lines: &[String]) -> Self {
        let lines = lines.join("\n");
        Self {
            name: format!("{file_name}.txt"),
            text: format!("- {file_name}\ncolumns: {columns}\n{lines}\n"),
        }
    }
}

/// A revolution of the lidar, which ends at an azimuth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Revolution {
    /// Number from 0.
    pub index: u64,
    /// Number of firings.
    pub firings: u64,
    /// Whether it extends from cut to cut.
    pub whole: bool,
}

/// A consumer of points. Only [`Sink::points`] is required. The order of calls is begin, tilt,
/// points and revolution (any number), diagnostics, finish, companion.
pub trait Sink {
    /// Takes a batch with at least the columns of [`Sink::fields`]. The batch is reused afterwards.
    ///
    /// # Errors
    /// [`SinkError`] if the batch cannot be stored. The producer stops then, and still calls
    /// [`Sink::finish`].
    fn points(&mut self, batch: &Points) -> Result<(), SinkError>;

    /// The columns that the sink requests; none by default.
    fn fields(&self) -> Fields {
        Fields::NONE
    }

    /// Called once before the first batch; does nothing by default.
    ///
    /// # Errors
    /// [`SinkError`] if the sink cannot start.
    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        let _ = metadata;
        Ok(())
    }

    /// Whether the sink uses [`Sink::tilt`]; not by default.
    fn wants_tilt(&self) -> bool {
        false
    }

    /// Called at most once, after begin and before the first batch; does nothing by default.
    ///
    /// # Errors
    /// [`SinkError`] if the track cannot be stored.
    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        let _ = track;
        Ok(())
    }

    /// Ends a revolution of the lidar; does nothing by default.
    ///
    /// # Errors
    /// [`SinkError`] if the points so far cannot be stored.
    fn revolution(&mut self, revolution: &Revolution) -> Result<(), SinkError> {
        let _ = revolution;
        Ok(())
    }

    /// Called at most once, after the last batch, with the diagnostics of the scan; does nothing by
    /// default.
    ///
    /// # Errors
    /// [`SinkError`] if they cannot be stored.
    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        let _ = diagnostics;
        Ok(())
    }

    /// A further file for the folder of `file_name`, the sink's own; called after finish. None by
    /// default.
    fn companion(&self, file_name: &str) -> Option<Companion> {
        let _ = file_name;
        None
    }

    /// Called once after the last batch. Returns the summary of the stored points; empty by
    /// default.
    ///
    /// # Errors
    /// [`SinkError`] if the output could not be completed.
    fn finish(&mut self) -> Result<Summary, SinkError> {
        Ok(Summary::default())
    }
}

/// Collects the whole cloud in memory, with its own columns.
impl Sink for Points {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        Ok(self.append(batch)?)
    }

    fn fields(&self) -> Fields {
        Points::fields(self)
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        Ok(self.summary())
    }
}

/// Passes every batch to both. The summary is that of the first; both are finished even if the
/// first fails.
impl<A: Sink, B: Sink> Sink for (A, B) {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.0.points(batch)?;
        self.1.points(batch)
    }

    fn fields(&self) -> Fields {
        self.0.fields() | self.1.fields()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.0.begin(metadata)?;
        self.1.begin(metadata)
    }

    fn wants_tilt(&self) -> bool {
        self.0.wants_tilt() || self.1.wants_tilt()
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.0.tilt(track)?;
        self.1.tilt(track)
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), SinkError> {
        self.0.revolution(revolution)?;
        self.1.revolution(revolution)
    }

    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        self.0.diagnostics(diagnostics)?;
        self.1.diagnostics(diagnostics)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        self.0
            .companion(file_name)
            .or_else(|| self.1.companion(file_name))
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        let first = self.0.finish();
        self.1.finish()?;
        first
    }
}

macro_rules! forward {
    ($pointer:ty) => {
        impl<S: Sink + ?Sized> Sink for $pointer {
            fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
                (**self).points(batch)
            }

            fn fields(&self) -> Fields {
                (**self).fields()
            }

            fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
                (**self).begin(metadata)
            }

            fn wants_tilt(&self) -> bool {
                (**self).wants_tilt()
            }

            fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
                (**self).tilt(track)
            }

            fn revolution(&mut self, revolution: &Revolution) -> Result<(), SinkError> {
                (**self).revolution(revolution)
            }

            fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
                (**self).diagnostics(diagnostics)
            }

            fn companion(&self, file_name: &str) -> Option<Companion> {
                (**self).companion(file_name)
            }

            fn finish(&mut self) -> Result<Summary, SinkError> {
                (**self).finish()
            }
        }
    };
}

forward!(&mut S);
forward!(Box<S>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;

    /// A sink with only the required method.
    struct Count(usize);

    impl Sink for Count {
        fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
            self.0 += batch.len();
            Ok(())
        }
    }

    #[test]
    fn a_sink_needs_only_one_method() {
        let mut sink = Count(0);
        let mut batch = Points::new(sink.fields());
        assert_eq!(batch.fields(), Fields::NONE);
        batch.push(Point::default());
        sink.begin(&Metadata::default()).unwrap();
        sink.points(&batch).unwrap();
        assert_eq!(sink.finish().unwrap(), Summary::default());
        assert_eq!(sink.0, 1);
    }

    #[test]
    fn a_pair_of_sinks_requests_the_columns_of_both_and_feeds_both() {
        let mut whole = Points::new(Fields::RING);
        let mut pair: Box<dyn Sink + '_> =
            Box::new((&mut whole, (Count(0), Points::new(Fields::TIME))));
        assert_eq!(pair.fields(), Fields::RING | Fields::TIME);
        let mut batch = Points::new(pair.fields());
        batch.push(Point::default());
        batch.push(Point::default());
        pair.points(&batch).unwrap();
        assert_eq!(pair.finish().unwrap().points, 2);
        drop(pair);
        assert_eq!((whole.len(), whole.fields()), (2, Fields::RING));
    }

    #[test]
    fn calls_without_points_reach_both_sinks_of_a_pair() {
        #[derive(Default)]
        struct CallCounter(usize);
        impl Sink for CallCounter {
            fn points(&mut self, _: &Points) -> Result<(), SinkError> {
                Ok(())
            }
            fn wants_tilt(&self) -> bool {
                true
            }
            fn tilt(&mut self, _: &TiltTrack) -> Result<(), SinkError> {
                self.0 += 1;
                Ok(())
            }
            fn revolution(&mut self, _: &Revolution) -> Result<(), SinkError> {
                self.0 += 10;
                Ok(())
            }
            fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
                self.0 += 100 * (1 + diagnostics.len());
                Ok(())
            }
            fn companion(&self, file_name: &str) -> Option<Companion> {
                let text = file_name.to_owned();
                Some(Companion {
                    name: "beside".to_owned(),
                    text,
                })
            }
        }
        let (mut first, mut second) = (CallCounter::default(), CallCounter::default());
        let mut pair: Box<dyn Sink + '_> =
            Box::new((&mut first, (Points::new(Fields::NONE), &mut second)));
        assert!(pair.wants_tilt());
        pair.tilt(&TiltTrack::default()).unwrap();
        pair.revolution(&Revolution::default()).unwrap();
        pair.diagnostics(&[]).unwrap();
        assert_eq!(pair.companion("scan").unwrap().text, "scan");
        drop(pair);
        assert_eq!((first.0, second.0), (111, 111));
        let plain = Points::new(Fields::NONE);
        assert!(!plain.wants_tilt() && plain.companion("scan").is_none());
    }

    #[test]
    fn the_second_sink_is_finished_if_the_first_fails() {
        struct Broken;
        impl Sink for Broken {
            fn points(&mut self, _: &Points) -> Result<(), SinkError> {
                Ok(())
            }
            fn finish(&mut self) -> Result<Summary, SinkError> {
                Err(SinkError::Other("broken".into()))
            }
        }
        struct Flag(bool);
        impl Sink for Flag {
            fn points(&mut self, _: &Points) -> Result<(), SinkError> {
                Ok(())
            }
            fn finish(&mut self) -> Result<Summary, SinkError> {
                self.0 = true;
                Ok(Summary::default())
            }
        }
        let mut flag = Flag(false);
        let error = (Broken, &mut flag).finish().unwrap_err();
        assert_eq!(error.to_string(), "broken");
        assert!(flag.0);
    }
}
