//! Arrays of points, one per revolution, made by a thread that reads ahead.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};

use cloud::{Fields, Points, Revolution, Sink, SinkError, TiltTrack};
use pyo3::prelude::*;
use units::Degrees;

use crate::binding_error::BindingError;
use crate::read::{Findings, ReadRequest};
use crate::rows::{PointLayout, PointRows};
use crate::table::{row_type, to_numpy};
use crate::work::LOOK_AGAIN;

/// Revolutions that the reader may be ahead.
const AHEAD: usize = 4;

/// Message from the reader.
enum FrameMessage {
    /// The rows of a revolution.
    Rows(Vec<u8>),
    /// The end of the recording, with what is known about it.
    End(Result<Findings, BindingError>),
}

/// Iterator of one array per revolution of the lidar; `frames` makes it.
#[pyclass(module = "velomotion", name = "Frames", frozen)]
pub(crate) struct FrameIterator {
    row_type: Py<PyAny>,
    /// `None` after the end.
    messages: Mutex<Option<Receiver<FrameMessage>>>,
    interrupt: Arc<AtomicBool>,
}

/// Sends the points of each revolution.
struct FrameRows {
    rows: PointRows,
    messages: SyncSender<FrameMessage>,
}

impl Sink for FrameRows {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.rows.add(batch);
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.rows.layout().columns()
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.rows.set_mount(track.mount);
        Ok(())
    }

    fn revolution(&mut self, _: &Revolution) -> Result<(), SinkError> {
        // The next revolution is about as long.
        let room = Vec::with_capacity(self.rows.bytes.len());
        let bytes = std::mem::replace(&mut self.rows.bytes, room);
        match bytes.is_empty() {
            true => Ok(()),
            false => (self.messages.send(FrameMessage::Rows(bytes)))
                .map_err(|_| SinkError::Other("the iterator is gone".into())),
        }
    }
}

impl FrameIterator {
    pub fn start(
        py: Python<'_>,
        request: ReadRequest,
        layout: PointLayout,
        cut: Degrees,
    ) -> PyResult<Self> {
        let row_type = row_type(py, &layout.fields, layout.row_bytes)?.unbind();
        let (sender, messages) = mpsc::sync_channel(AHEAD);
        let interrupt = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupt);
        let thread = engine::spawn("velomotion", "frames for Python", move || {
            let mut rows = FrameRows {
                rows: PointRows::new(layout),
                messages: sender.clone(),
            };
            let ended = request.read(Some(cut), &mut rows, &flag);
            // Sending fails if the iterator is gone.
            drop(sender.send(FrameMessage::End(ended)));
        });
        thread.map_err(|failure| BindingError::from(failure).into_py(py))?;
        Ok(Self {
            row_type,
            messages: Mutex::new(Some(messages)),
            interrupt,
        })
    }

    /// Waits for a message for a while; `None` after the end.
    fn wait(&self) -> Option<Result<FrameMessage, RecvTimeoutError>> {
        let messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        Some(messages.as_ref()?.recv_timeout(LOOK_AGAIN))
    }

    fn end(&self) {
        *self.messages.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl Drop for FrameIterator {
    fn drop(&mut self) {
        self.interrupt.store(true, Ordering::Relaxed);
    }
}

#[pymethods]
impl FrameIterator {
    fn __iter__(frames: PyRef<'_, Self>) -> PyRef<'_, Self> {
        frames
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        loop {
            let Some(waited) = py.detach(|| self.wait()) else {
                return Ok(None);
            };
            let ended = match waited {
                Ok(FrameMessage::Rows(bytes)) => {
                    return to_numpy(bytes, self.row_type.bind(py)).map(Some);
                }
                Err(RecvTimeoutError::Timeout) => {
                    py.check_signals()?;
                    continue;
                }
                Ok(FrameMessage::End(ended)) => ended,
                Err(RecvTimeoutError::Disconnected) => Err(BindingError::internal()),
            };
            self.end();
            ended.map_err(|error| error.into_py(py))?.warn(py)?;
            return Ok(None);
        }
    }
}
