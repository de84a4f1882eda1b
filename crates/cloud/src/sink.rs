//! Where points go.
//!
//! A sink declares its columns and takes batches; producers compute only what is declared. Nothing
//! here knows files: a writer, a live view, a message queue and a comparison with the truth are all
//! sinks.

use crate::{Diagnostic, Fields, Metadata, Points, SinkError, Summary, TiltTrack};

/// A small file that belongs beside a sink's own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// Its name, in the same folder.
    pub name: &'static str,
    /// What is in it.
    pub text: String,
}

/// Where points go. Only [`Sink::points`] is required. Calls come in the order begin, tilt, points
/// and turn (any number), checks, finish, companion.
pub trait Sink {
    /// Takes a batch, which has at least the columns of [`Sink::fields`]. The batch is reused
    /// afterwards.
    ///
    /// # Errors
    /// [`SinkError`] where the batch cannot be kept; the producer stops then and still calls
    /// [`Sink::finish`].
    fn points(&mut self, batch: &Points) -> Result<(), SinkError>;

    /// The columns that the sink wants beside the position; by default none.
    fn fields(&self) -> Fields {
        Fields::NONE
    }

    /// Called once before the first batch; by default does nothing.
    ///
    /// # Errors
    /// [`SinkError`] where the sink cannot start.
    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        let _ = metadata;
        Ok(())
    }

    /// Whether [`Sink::tilt`] is worth calling; by default not.
    fn wants_tilt(&self) -> bool {
        false
    }

    /// Called at most once, after begin and before the first batch; by default does nothing.
    ///
    /// # Errors
    /// [`SinkError`] where it cannot be kept.
    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        let _ = track;
        Ok(())
    }

    /// What came since the last time, or since the begin, is a turn of the lidar and what comes is
    /// another; by default does nothing.
    ///
    /// # Errors
    /// [`SinkError`] where it cannot be kept.
    fn revolution(&mut self) -> Result<(), SinkError> {
        Ok(())
    }

    /// Called at most once, after the last batch: what was found out about the scan; by default
    /// does nothing.
    ///
    /// # Errors
    /// [`SinkError`] where it cannot be kept.
    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        let _ = diagnostics;
        Ok(())
    }

    /// What belongs beside the file `file_name` that the sink wrote; to be asked after finish. By
    /// default nothing.
    fn companion(&self, file_name: &str) -> Option<Companion> {
        let _ = file_name;
        None
    }

    /// Called once after the last batch: what the sink stored. By default nothing.
    ///
    /// # Errors
    /// [`SinkError`] where what was taken could not be completed.
    fn finish(&mut self) -> Result<Summary, SinkError> {
        Ok(Summary::default())
    }
}

/// Collects the whole cloud in memory, with the columns that it was made with.
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

/// Gives every batch to both. The summary is the first one's; both are finished even if the first
/// fails.
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

    fn revolution(&mut self) -> Result<(), SinkError> {
        self.0.revolution()?;
        self.1.revolution()
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

            fn revolution(&mut self) -> Result<(), SinkError> {
                (**self).revolution()
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

    /// A sink with the one required method.
    struct Count(usize);

    impl Sink for Count {
        fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
            self.0 += batch.len();
            Ok(())
        }
    }

    #[test]
    fn one_method_makes_a_sink() {
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
    fn a_pair_wants_what_both_want_and_gives_to_both() {
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
    fn what_is_not_about_points_reaches_both_of_a_pair() {
        #[derive(Default)]
        struct Heard(usize);
        impl Sink for Heard {
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
            fn revolution(&mut self) -> Result<(), SinkError> {
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
                    name: "beside",
                    text,
                })
            }
        }
        let (mut first, mut second) = (Heard::default(), Heard::default());
        let mut pair: Box<dyn Sink + '_> =
            Box::new((&mut first, (Points::new(Fields::NONE), &mut second)));
        assert!(pair.wants_tilt());
        pair.tilt(&TiltTrack::default()).unwrap();
        pair.revolution().unwrap();
        pair.diagnostics(&[]).unwrap();
        assert_eq!(pair.companion("scan").unwrap().text, "scan");
        drop(pair);
        assert_eq!((first.0, second.0), (111, 111));
        let plain = Points::new(Fields::NONE);
        assert!(!plain.wants_tilt() && plain.companion("scan").is_none());
    }

    #[test]
    fn the_second_is_finished_though_the_first_fails() {
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
