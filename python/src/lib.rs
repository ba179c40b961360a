//! The native half of the Python package `cones`: what [`cones`], [`geom`] and [`topo`] do, on numpy's arrays.
//!
//! Everything here is plain: arrays that lie in memory as Rust reads them, options as a dictionary that serde knows. What a user sees
//! (checks of shapes, names of options, documentation) is written in Python, in `cones/*.py`.
//!
//! | file | what |
//! |---|---|
//! | `threads` | the pool that work runs on; a new one after a fork |
//! | `watched` | work without the interpreter's lock, that Ctrl-C stops and a callable hears of |
//! | `error` | errors as exceptions |
//! | `array` | numpy's arrays as slices and back |
//! | `mesh` | models: files in, files out |
//! | `analysis`, `atlas` | [`cones::Analysis`], and its maps as dictionaries of arrays |
//! | `quality`, `uv` | measuring, parting and packing maps of any origin |
//! | `field` | persistence |

mod analysis;
mod array;
mod atlas;
mod error;
mod field;
mod mesh;
mod threads;
mod uv;
mod watched;

use pyo3::prelude::*;

#[pymodule]
fn _cones(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add("METHODS", cones::Placement::ALL.map(cones::Placement::name).to_vec())?;
    module.add_function(wrap_pyfunction!(threads::thread_count, module)?)?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<analysis::Analysis>()?;
    module.add_class::<analysis::Cones>()?;
    module.add_function(wrap_pyfunction!(mesh::shape, module)?)?;
    module.add_function(wrap_pyfunction!(uv::measure, module)?)?;
    module.add_function(wrap_pyfunction!(uv::part, module)?)?;
    module.add_function(wrap_pyfunction!(uv::pack, module)?)?;
    field::register(module)
}
