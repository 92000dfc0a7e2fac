//! `Callable`: a Python function as a part of a field.
use chordal::budget::Evidence;
use chordal::implicit::{Leaf, LeafError, Lipschitz};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::fmt;
use std::sync::{Arc, Mutex};

/// What a function raised, until somebody passes it on.
pub(crate) type Raised = Arc<Mutex<Option<PyErr>>>;

/// A function from the bytes of points to the bytes of values. It is called from threads of our own, with Python's lock.
pub(crate) struct Callable {
    pub call: Py<PyAny>,
    pub lipschitz: Option<f64>,
    pub raised: Raised,
}

impl fmt::Debug for Callable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a Python function")
    }
}

impl Leaf for Callable {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        if points.is_empty() {
            return Ok(());
        }
        let asked: Vec<u8> = points.as_flattened().iter().flat_map(|x| x.to_ne_bytes()).collect();
        let values = Python::attach(|py| -> PyResult<Vec<u8>> {
            self.call.bind(py).call1((PyBytes::new(py, &asked),))?.extract()
        });
        match values {
            Ok(values) if values.len() == 8 * out.len() => {
                for (value, bytes) in out.iter_mut().zip(values.chunks_exact(8)) {
                    *value = f64::from_ne_bytes(std::array::from_fn(|i| bytes[i]));
                }
                Ok(())
            }
            Ok(_) => Err(LeafError::new("the function gave back another number of values than points")),
            Err(error) => {
                let message = format!("the function raised {error}");
                if let Ok(mut slot) = self.raised.lock() {
                    slot.get_or_insert(error);
                }
                Err(LeafError::new(message))
            }
        }
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        self.lipschitz.map(|constant| Lipschitz { constant, error: 0.0 })
    }

    fn evidence(&self) -> Evidence {
        match self.lipschitz {
            Some(slope) => Evidence::ProvedIf(vec![format!(
                "the Python function changes by no more than {slope} times the distance between points"
            )]),
            None => Evidence::Measured { samples: 0 },
        }
    }
}
