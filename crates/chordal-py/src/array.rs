//! `Array`: numbers that numpy reads in place.
//!
//! numpy's array interface (version 3) passes an address, and numpy keeps a reference to the object that
//! passed it. So the numbers live as long as any view of them, nothing is copied, and no code here is unsafe:
//! the numbers never change, and the interface marks them as read-only. A user cannot make them writable
//! either, since for that numpy asks the owner, and this one offers no buffer.
use chordal::implicit::Samples;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// Numbers in memory, the last axis fastest.
pub(crate) struct ArrayData {
    start: *const u8,
    shape: Vec<usize>,
    /// numpy's name of the number type, without the byte order.
    kind: &'static str,
}

impl ArrayData {
    fn new<T>(numbers: &[T], shape: Vec<usize>, kind: &'static str) -> Self {
        debug_assert_eq!(
            shape.iter().product::<usize>(),
            numbers.len(),
            "numpy would read beyond the numbers"
        );
        Self { start: numbers.as_ptr().cast(), shape, kind }
    }

    /// Rows of `width` numbers; a plain list for a width of 1.
    pub(crate) fn from_f64(numbers: &[f64], width: usize) -> Self {
        Self::new(numbers, rows(numbers.len(), width), "f8")
    }

    pub(crate) fn from_i64(numbers: &[i64]) -> Self {
        Self::new(numbers, vec![numbers.len()], "i8")
    }

    /// Numbers below 2³¹, whose bits are the same with a sign.
    pub(crate) fn from_u32_below_sign(numbers: &[u32], width: usize) -> Self {
        Self::new(numbers, rows(numbers.len(), width), "i4")
    }

    /// Bytes, with the lengths of their axes.
    pub(crate) fn from_bytes(bytes: &[u8], shape: Vec<usize>) -> Self {
        Self::new(bytes, shape, "u1")
    }

    /// An empty array.
    pub(crate) fn empty() -> Self {
        Self::from_bytes(&[], vec![0])
    }

    /// Samples of a lattice of `[nx, ny, nz]`, x fastest; `None` for an unknown number type.
    pub(crate) fn from_samples(samples: &Samples, [nx, ny, nz]: [usize; 3]) -> Option<Self> {
        let shape = vec![nz, ny, nx];
        Some(match samples {
            Samples::F32(numbers) => Self::new(numbers, shape, "f4"),
            Samples::F64(numbers) => Self::new(numbers, shape, "f8"),
            Samples::U8(numbers) => Self::new(numbers, shape, "u1"),
            Samples::I8(numbers) => Self::new(numbers, shape, "i1"),
            Samples::U16(numbers) => Self::new(numbers, shape, "u2"),
            Samples::I16(numbers) => Self::new(numbers, shape, "i2"),
            Samples::U32(numbers) => Self::new(numbers, shape, "u4"),
            Samples::I32(numbers) => Self::new(numbers, shape, "i4"),
            _ => return None,
        })
    }
}

fn rows(n_numbers: usize, width: usize) -> Vec<usize> {
    if width == 1 { vec![n_numbers] } else { vec![n_numbers / width, width] }
}

/// Numbers that numpy reads in place: `numpy.asarray` copies nothing.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Array(Box<dyn Fn() -> ArrayData + Send + Sync>);

impl Array {
    /// Some numbers of an owner, which the array keeps alive. A shared owner cannot change.
    pub(crate) fn new<T: Send + Sync + 'static>(
        owner: &Arc<T>,
        rows: impl Fn(&T) -> ArrayData + Send + Sync + 'static,
    ) -> Self {
        let owner = Arc::clone(owner);
        // A function instead of the address: raw pointers are not `Send`.
        Self(Box::new(move || rows(&owner)))
    }
}

#[pymethods]
impl Array {
    /// numpy's array interface: the shape, the type, and the read-only address.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        // The interface has a sign for each of both orders, and none for that of the machine.
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        let rows = (self.0)();
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", format!("{order}{}", rows.kind))?;
        interface.set_item("shape", PyTuple::new(py, &rows.shape)?)?;
        interface.set_item("data", (rows.start as usize, true))?;
        Ok(interface)
    }
}
