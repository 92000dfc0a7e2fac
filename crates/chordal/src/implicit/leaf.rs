//! `Leaf`: a part of a field that is not an expression, such as a grid, a mesh or a user's function.
use crate::budget::Evidence;
use crate::math::{Box3, Interval, add_up, greater, mul_up, sub_up};
use std::fmt;
use std::sync::Arc;

/// Whether a leaf answered a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeafAnswer {
    /// The answer is in `out`.
    Given,
    /// There is no answer; `out` has no meaning.
    None,
}

/// A bound on how fast a function changes: `|f(p) − f(q)| ≤ constant · |p − q| + 2 error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lipschitz {
    /// The largest slope, ≥ 0.
    pub constant: f64,
    /// The largest error of a returned value against a function with that slope, ≥ 0.
    pub error: f64,
}

/// A function of points, for use in expressions.
///
/// Every query covers many points at once, so that a leaf with expensive calls (a Python function, a separate
/// processor) is called seldom. A call may fail, and its error ends the work.
///
/// Values are signed: negative means inside. NaN means outside.
pub trait Leaf: Send + Sync + fmt::Debug {
    /// The value at each point.
    ///
    /// # Errors
    /// Any error of the leaf's own function.
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError>;

    /// The gradient at each point, if the leaf knows it.
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn gradient_at(&self, _points: &[[f64; 3]], _out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        Ok(LeafAnswer::None)
    }

    /// The step of the differences that replace a missing gradient, in the leaf's own units: four samples at
    /// the corners of a tetrahedron, each moved by this step along every axis.
    fn difference_step(&self) -> f64 {
        1.0 / 65_536.0
    }

    /// An interval of all values in each box. It is trusted, see [`Leaf::evidence`]. By default it is
    /// computed from the value at the middle and [`Leaf::lipschitz`].
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        let Some(Lipschitz { constant, error }) = self.lipschitz() else { return Ok(LeafAnswer::None) };
        let middles: Vec<[f64; 3]> = boxes.iter().map(Box3::centre).collect();
        let mut values = vec![0.0; boxes.len()];
        self.at(&middles, &mut values)?;
        for (k, bounds) in boxes.iter().enumerate() {
            let reach = add_up(mul_up(constant, radius_around(bounds, middles[k])), error);
            let around = Interval::new(-reach, reach).unwrap_or(Interval::UNKNOWN);
            // If there is an error, the value may jump by it.
            let value = Interval::point(values[k]) + around;
            out[k] = if error == 0.0 { value } else { value.undefined() };
        }
        Ok(LeafAnswer::Given)
    }

    /// An interval of each partial derivative in each box, if the leaf knows it. At kinks it covers all
    /// generalized gradients (Clarke's).
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn gradient_over(&self, _boxes: &[Box3], _out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        Ok(LeafAnswer::None)
    }

    /// A bound on how fast the function changes, if known.
    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    /// The evidence of proofs that depend on [`Leaf::over`], [`Leaf::gradient_over`] and [`Leaf::lipschitz`]:
    /// proved, proved if the user's promise holds, or only measured because none of these is available.
    fn evidence(&self) -> Evidence;

    /// For a region at `x ≥ axis` with a part of its boundary at `x = axis`: the function of the region
    /// joined with its mirror image, so that this part is no longer a boundary. For profiles that are
    /// revolved.
    fn without_axis(&self, _axis: f64) -> Option<Arc<dyn Leaf>> {
        None
    }

    /// A material number at each point, if the leaf has materials.
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn material_at(&self, _points: &[[f64; 3]], _out: &mut [u32]) -> Result<LeafAnswer, LeafError> {
        Ok(LeafAnswer::None)
    }

    /// The leaf itself, for leaves that search an expression for others of their type. By default a leaf
    /// cannot be found.
    fn as_any(&self) -> Option<&dyn std::any::Any> {
        None
    }

    /// The smallest number of points that a call should have, if there are that many.
    fn preferred_batch(&self) -> usize {
        1 << 16
    }
}

/// The largest distance from `middle` to a point of the box, rounded up.
fn radius_around(bounds: &Box3, middle: [f64; 3]) -> f64 {
    let reach = |k: usize| {
        let (low, high) = (sub_up(middle[k], bounds.min[k]), sub_up(bounds.max[k], middle[k]));
        greater(low, high)
    };
    Box3 { min: [0.0; 3], max: [reach(0), reach(1), reach(2)] }.diagonal()
}

/// The reason why a leaf returned no values.
#[derive(Clone, Debug)]
pub struct LeafError {
    /// One sentence.
    pub message: String,
    /// The error of the leaf's own language, if it has one.
    pub cause: Option<Arc<dyn std::error::Error + Send + Sync>>,
}

impl LeafError {
    /// An error of one sentence.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), cause: None }
    }
}

impl fmt::Display for LeafError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for LeafError {}
