//! Python bindings: recordings to numpy arrays, and the functions of the commands.
//!
//! Every function checks its arguments, works in a thread of its own without Python's lock
//! (`work`), and moves its result into numpy without a copy (`table`). The package around this
//! module is in `velomotion/`.

mod analysis_functions;
mod arguments;
mod binding_error;
mod commands;
mod frames;
mod log_file;
mod read;
mod rows;
mod table;
mod work;

use pyo3::prelude::*;

#[pymodule]
fn _velomotion(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<log_file::LogFile>()?;
    module.add_class::<frames::FrameIterator>()?;
    module.add_function(wrap_pyfunction!(read::read, module)?)?;
    module.add_function(wrap_pyfunction!(read::frames, module)?)?;
    module.add_function(wrap_pyfunction!(analysis_functions::density, module)?)?;
    module.add_function(wrap_pyfunction!(analysis_functions::k, module)?)?;
    module.add_function(wrap_pyfunction!(commands::plan, module)?)?;
    module.add_function(wrap_pyfunction!(commands::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(commands::simulate, module)?)?;
    Ok(())
}
