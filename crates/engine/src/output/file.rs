//! The file behind a sink: buffered, and shared with the commit that names it.

use std::io::{self as stdio, BufWriter, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

use ::io::files::NewFile;

/// Enough for formats that write small pieces (LAZ, E57), and less than a batch of rows, which
/// then bypasses the buffer.
const BUFFER_BYTES: usize = 1 << 16;

/// A file with a write buffer that can also be read.
pub struct BufferedFile<F: Write>(BufWriter<F>);

impl<F: Write> BufferedFile<F> {
    /// Wraps `file`.
    pub fn new(file: F) -> Self {
        Self(BufWriter::with_capacity(BUFFER_BYTES, file))
    }
}

impl<F: Write> Write for BufferedFile<F> {
    fn write(&mut self, bytes: &[u8]) -> stdio::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> stdio::Result<()> {
        self.0.flush()
    }
}

impl<F: Write + Seek> Seek for BufferedFile<F> {
    fn seek(&mut self, to: SeekFrom) -> stdio::Result<u64> {
        self.0.seek(to)
    }

    /// Does not flush the buffer.
    fn stream_position(&mut self) -> stdio::Result<u64> {
        self.0.stream_position()
    }
}

impl<F: Read + Write> Read for BufferedFile<F> {
    fn read(&mut self, bytes: &mut [u8]) -> stdio::Result<usize> {
        self.0.flush()?;
        self.0.get_mut().read(bytes)
    }
}

/// The file, shared by the writer inside a sink and the commit.
#[derive(Clone)]
pub struct SharedFile(Arc<Mutex<Option<NewFile>>>);

impl SharedFile {
    pub(super) fn new(file: NewFile) -> Self {
        Self(Arc::new(Mutex::new(Some(file))))
    }

    /// Takes the file out; later writes fail.
    pub(super) fn release(&self) -> Option<NewFile> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn with<T>(&self, act: impl FnOnce(&mut NewFile) -> stdio::Result<T>) -> stdio::Result<T> {
        match self
            .0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .as_mut()
        {
            Some(file) => act(file),
            None => Err(stdio::Error::other("the file is already complete")),
        }
    }
}

impl Write for SharedFile {
    fn write(&mut self, bytes: &[u8]) -> stdio::Result<usize> {
        self.with(|file| file.write(bytes))
    }

    fn flush(&mut self) -> stdio::Result<()> {
        self.with(NewFile::flush)
    }
}

impl Read for SharedFile {
    fn read(&mut self, bytes: &mut [u8]) -> stdio::Result<usize> {
        self.with(|file| file.read(bytes))
    }
}

impl Seek for SharedFile {
    fn seek(&mut self, to: SeekFrom) -> stdio::Result<u64> {
        self.with(|file| file.seek(to))
    }
}
