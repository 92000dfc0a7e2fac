//! `Array`: numbers that numpy sees in place.
//!
//! numpy's array interface (version 3) names an address, and numpy keeps the object that named it. So an
//! array lives as long as anybody looks at it, nothing is copied, and no line here is unsafe: what is shown
//! never changes, and numpy is told that it may not write. Nor can a user allow it: numpy asks the owner, and
//! this one offers no buffer.
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// Numbers in rows, as they lie in memory.
pub(crate) struct ArrayData {
    start: *const u8,
    n_numbers: usize,
    /// Numbers in a row; 1 for a plain list.
    width: usize,
    /// The type of one number in numpy's words, without the order of its bytes.
    kind: &'static str,
}

impl ArrayData {
    pub(crate) fn from_f64(numbers: &[f64], width: usize) -> Self {
        Self { start: numbers.as_ptr().cast(), n_numbers: numbers.len(), width, kind: "f8" }
    }

    pub(crate) fn from_i64(numbers: &[i64]) -> Self {
        Self { start: numbers.as_ptr().cast(), n_numbers: numbers.len(), width: 1, kind: "i8" }
    }

    /// Numbers below 2³¹, whose bits are the same with a sign.
    pub(crate) fn from_u32_below_sign(numbers: &[u32], width: usize) -> Self {
        Self { start: numbers.as_ptr().cast(), n_numbers: numbers.len(), width, kind: "i4" }
    }

    fn shape(&self) -> Vec<usize> {
        if self.width == 1 { vec![self.n_numbers] } else { vec![self.n_numbers / self.width, self.width] }
    }
}

/// Numbers that numpy sees in place: `numpy.asarray` copies nothing.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Array(Box<dyn Fn() -> ArrayData + Send + Sync>);

impl Array {
    /// Some numbers of an owner that stays as long as the array does. That it is shared keeps it from
    /// changing.
    pub(crate) fn new<T: Send + Sync + 'static>(owner: &Arc<T>, rows: fn(&T) -> ArrayData) -> Self {
        let owner = Arc::clone(owner);
        Self(Box::new(move || rows(&owner)))
    }
}

#[pymethods]
impl Array {
    /// What numpy asks for: the shape, the type, and the address, which is for reading only.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        let rows = (self.0)();
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", format!("{order}{}", rows.kind))?;
        interface.set_item("shape", PyTuple::new(py, rows.shape())?)?;
        interface.set_item("data", (rows.start as usize, true))?;
        Ok(interface)
    }
}
