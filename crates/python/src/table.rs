//! Bytes of rows as structured numpy arrays, and JSON as Python's objects.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

/// Fields of a row: name, format of numpy, and bytes from the row's start.
pub(crate) type RowField = (&'static str, &'static str, usize);

/// Rows of bytes for one numpy array.
#[derive(Debug)]
pub(crate) struct Table {
    pub fields: &'static [RowField],
    pub row_bytes: usize,
    pub bytes: Vec<u8>,
}

/// The data type of rows.
pub(crate) fn row_type<'py>(
    py: Python<'py>,
    fields: &[RowField],
    row_bytes: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let column = |pick: fn(&RowField) -> &'static str| fields.iter().map(pick).collect::<Vec<_>>();
    let offsets: Vec<usize> = fields.iter().map(|field| field.2).collect();
    let layout = PyDict::new(py);
    layout.set_item("names", column(|field| field.0))?;
    layout.set_item("formats", column(|field| field.1))?;
    layout.set_item("offsets", offsets)?;
    layout.set_item("itemsize", row_bytes)?;
    py.import("numpy")?.getattr("dtype")?.call1((layout,))
}

/// Moves rows into a numpy array, without a copy.
pub(crate) fn to_numpy<'py>(
    bytes: Vec<u8>,
    row_type: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_vec(row_type.py(), bytes);
    flat.call_method1("view", (row_type,))
}

impl Table {
    /// Moves the rows into a numpy array, without a copy.
    pub fn into_numpy(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        to_numpy(self.bytes, &row_type(py, self.fields, self.row_bytes)?)
    }
}

/// A JSON value as Python's `json` reads it.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    let text = value.to_string();
    py.import("json")?.getattr("loads")?.call1((text,))
}
