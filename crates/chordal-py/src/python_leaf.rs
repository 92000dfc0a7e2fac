//! `PythonLeaf`: a Python function as a leaf of a field.
use chordal::budget::Evidence;
use chordal::implicit::Lipschitz;
use chordal::implicit::leaves::{Leaf, LeafAnswer, LeafError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::HashMap;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// A log of the calls of a function.
#[derive(Debug, Default)]
pub(crate) struct CallLog {
    /// The exception that it raised, until it is passed on.
    raised: Mutex<Option<PyErr>>,
    /// The number of points at which it was evaluated.
    points: AtomicU64,
}

impl CallLog {
    /// Takes the exception.
    pub fn take(&self) -> Option<PyErr> {
        self.raised.lock().ok().and_then(|mut slot| slot.take())
    }

    /// The number of points at which it was evaluated so far.
    pub fn points(&self) -> u64 {
        self.points.load(Ordering::Relaxed)
    }
}

/// The first values of a function at points where it is nearly zero.
///
/// A network in single precision may return different last digits for the same point in different batches. If
/// that changes the sign, neighbouring cells would disagree about their shared corner, so there the first
/// value counts.
#[derive(Debug, Default)]
pub(crate) struct FirstAnswers {
    answers: Mutex<HashMap<[u64; 3], f64>>,
    /// The bits of the largest absolute value so far. Bits of positive numbers are ordered like the numbers.
    largest: AtomicU64,
}

impl FirstAnswers {
    /// The relative size, beside the largest value, of values that count as nearly zero. Chosen: 64 units of
    /// single precision cover the rounding of sums of many terms.
    const NEAR: f64 = 64.0 * f32::EPSILON as f64;
    /// The most points that are kept, about 70 MB. Chosen: more would take too much memory; values at further
    /// points are used as returned.
    const MOST: usize = 1 << 20;

    /// Replaces values that are nearly zero by the first values of their points.
    fn keep(&self, points: &[[f64; 3]], values: &mut [f64]) {
        let sizes = values.iter().map(|value| value.abs()).filter(|size| size.is_finite());
        let largest = sizes.fold(0.0, |a: f64, b| if b > a { b } else { a });
        let largest_before = f64::from_bits(self.largest.fetch_max(largest.to_bits(), Ordering::Relaxed));
        let near = Self::NEAR * if largest_before > largest { largest_before } else { largest };
        // Locked only for points near the surface, so that threads seldom wait for each other.
        let mut close = values.iter_mut().zip(points).filter(|(value, _)| value.abs() <= near).peekable();
        if close.peek().is_none() {
            return;
        }
        let Ok(mut answers) = self.answers.lock() else { return };
        for (value, point) in close {
            // Adding zero removes the sign of −0, which is the same point.
            let key = point.map(|x| (x + 0.0).to_bits());
            if answers.len() < Self::MOST {
                *value = *answers.entry(key).or_insert(*value);
            } else if let Some(first) = answers.get(&key) {
                *value = *first;
            }
        }
    }
}

/// A function from the bytes of points to the bytes of values. It is called from threads of the pool, with
/// the GIL.
pub(crate) struct PythonLeaf {
    pub call: Py<PyAny>,
    /// The same for the bytes of gradients.
    pub gradient: Option<Py<PyAny>>,
    pub lipschitz: Option<f64>,
    pub calls: Arc<CallLog>,
    pub first: FirstAnswers,
}

impl PythonLeaf {
    /// Calls one of the functions, which has to return as many numbers as `out` has.
    fn evaluate(&self, call: &Py<PyAny>, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        if points.is_empty() {
            return Ok(());
        }
        self.calls.points.fetch_add(points.len() as u64, Ordering::Relaxed);
        let bytes: Vec<u8> = points.as_flattened().iter().flat_map(|x| x.to_ne_bytes()).collect();
        let values = Python::attach(|py| -> PyResult<Vec<u8>> {
            call.bind(py).call1((PyBytes::new(py, &bytes),))?.extract()
        });
        match values {
            Ok(values) if values.len() == 8 * out.len() => {
                for (value, bytes) in out.iter_mut().zip(values.chunks_exact(8)) {
                    *value = f64::from_ne_bytes(std::array::from_fn(|i| bytes[i]));
                }
                Ok(())
            }
            Ok(_) => Err(LeafError::new("the function returned another number of values than points")),
            Err(error) => {
                let message = format!("the function raised {error}");
                if let Ok(mut slot) = self.calls.raised.lock() {
                    // Several threads may fail before the work stops: the user gets the first exception.
                    slot.get_or_insert(error);
                }
                Err(LeafError::new(message))
            }
        }
    }
}

impl fmt::Debug for PythonLeaf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a Python function")
    }
}

impl Leaf for PythonLeaf {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        self.evaluate(&self.call, points, out)?;
        self.first.keep(points, out);
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        let Some(gradient) = &self.gradient else { return Ok(LeafAnswer::None) };
        self.evaluate(gradient, points, out.as_flattened_mut()).map(|()| LeafAnswer::Given)
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
