//! `Array`: numbers that numpy sees in place.
//!
//! numpy's array interface (version 3) names an address, and numpy keeps the object that named it. So an array lives
//! as long as anybody looks at it, nothing is copied, and no line here is unsafe: what is shown never changes, and
//! numpy is told that it may not write. Nor can a user allow it: numpy asks the owner, and this one offers no buffer.
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// What holds the numbers of an array, and does not move or change them.
pub(crate) trait Holder: Send + Sync {
    /// Where the numbers start.
    fn start(&self) -> *const u8;
    /// Rows and columns; no columns for a plain list.
    fn shape(&self) -> Vec<usize>;
    /// The type of one number: `f8`, `i4` or `i8`.
    fn kind(&self) -> &'static str;
}

/// Numbers that numpy sees in place: `numpy.asarray` copies nothing.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Array(Arc<dyn Holder>);

impl Array {
    pub(crate) fn new(holder: impl Holder + 'static) -> Self {
        Self(Arc::new(holder))
    }
}

#[pymethods]
impl Array {
    /// What numpy asks for: the shape, the type, and the address, which is for reading only.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", format!("{order}{}", self.0.kind()))?;
        interface.set_item("shape", pyo3::types::PyTuple::new(py, self.0.shape())?)?;
        interface.set_item("data", (self.0.start() as usize, true))?;
        Ok(interface)
    }
}
