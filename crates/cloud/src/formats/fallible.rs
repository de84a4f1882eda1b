//! An output that hides its failures from the libraries that write formats.
//!
//! The `las` crate completes its file when its writer is dropped and panics if that fails, so a
//! full disk would abort the program. Others wrap the system's error, or lose it on a thread.
//! [`ErrorHidingOutput`] keeps the first error and from then on only pretends to write.

use std::error::Error;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

use super::file_sink::EncodeError;

/// The first error of an [`ErrorHidingOutput`].
#[derive(Clone, Default)]
pub(in crate::formats) struct WriteFault(Arc<Mutex<Option<io::Error>>>);

impl WriteFault {
    /// The error, rebuilt for each caller, as an [`io::Error`] cannot be cloned.
    pub(in crate::formats) fn get(&self) -> Option<io::Error> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.as_ref().map(|error| match error.raw_os_error() {
            Some(code) => io::Error::from_raw_os_error(code),
            None => io::Error::new(error.kind(), error.to_string()),
        })
    }

    /// The result of a library. An error of the output takes precedence, as the library does not
    /// see it.
    pub(in crate::formats) fn outcome<T>(
        &self,
        result: Result<T, impl Into<Box<dyn Error + Send + Sync>>>,
    ) -> Result<T, EncodeError> {
        match self.get() {
            Some(source) => Err(EncodeError::Output(source)),
            None => result.map_err(EncodeError::library),
        }
    }

    fn keep(&self, error: io::Error) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(error);
    }
}

/// Passes everything on until the first error.
pub(in crate::formats) struct ErrorHidingOutput<W> {
    inner: W,
    fault: WriteFault,
    /// Position of pretended writes; `None` before the first error.
    pretended: Option<u64>,
}

impl<W: Write + Seek> ErrorHidingOutput<W> {
    pub(in crate::formats) fn new(inner: W) -> (Self, WriteFault) {
        let fault = WriteFault::default();
        let output = Self {
            inner,
            fault: fault.clone(),
            pretended: None,
        };
        (output, fault)
    }

    pub(in crate::formats) fn into_inner(self) -> W {
        self.inner
    }

    fn fail(&mut self, error: io::Error) -> u64 {
        let position = self.inner.stream_position().unwrap_or(0);
        self.fault.keep(error);
        self.pretended = Some(position);
        position
    }
}

impl<W: Write + Seek> Write for ErrorHidingOutput<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.pretended.is_none() {
            match self.inner.write(bytes) {
                Ok(0) if !bytes.is_empty() => self.fail(io::ErrorKind::WriteZero.into()),
                Err(error) if error.kind() != io::ErrorKind::Interrupted => self.fail(error),
                other => return other,
            };
        }
        self.pretended = self
            .pretended
            .map(|at| at.saturating_add(bytes.len() as u64));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.pretended.is_none()
            && let Err(error) = self.inner.flush()
        {
            self.fail(error);
        }
        Ok(())
    }
}

/// For formats that read back. After the first error there is nothing to read.
impl<W: Read + Write + Seek> Read for ErrorHidingOutput<W> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.pretended.is_some() {
            return Ok(0);
        }
        match self.inner.read(bytes) {
            Err(error) if error.kind() != io::ErrorKind::Interrupted => {
                self.fail(error);
                Ok(0)
            }
            other => other,
        }
    }
}

impl<W: Write + Seek> Seek for ErrorHidingOutput<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let here = match self.pretended {
            Some(here) => here,
            None => match self.inner.seek(to) {
                Ok(position) => return Ok(position),
                Err(error) => self.fail(error),
            },
        };
        let there = match to {
            SeekFrom::Start(position) => position,
            SeekFrom::Current(by) | SeekFrom::End(by) => here.saturating_add_signed(by),
        };
        self.pretended = Some(there);
        Ok(there)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::samples::SmallDisk;

    #[test]
    fn writes_after_the_first_error_are_skipped() {
        let (mut output, fault) = ErrorHidingOutput::new(SmallDisk::new(5));
        output.write_all(b"1234").unwrap();
        assert!(fault.get().is_none());
        output.write_all(b"56789").unwrap();
        assert_eq!(output.stream_position().unwrap(), 9);
        assert_eq!(output.seek(SeekFrom::Start(3)).unwrap(), 3);
        output.write_all(b"xx").unwrap();
        assert_eq!(output.stream_position().unwrap(), 5);
        output.flush().unwrap();
        for _ in 0..2 {
            assert_eq!(fault.get().unwrap().kind(), io::ErrorKind::StorageFull);
        }
        assert_eq!(output.read(&mut [0; 4]).unwrap(), 0);
        assert_eq!(output.into_inner().file.into_inner(), b"12345");
    }
}
