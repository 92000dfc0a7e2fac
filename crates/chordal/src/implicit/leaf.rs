//! `Leaf`: a part of a field that is not an expression: a grid, a mesh, a function of the user's.
use crate::budget::Evidence;
use crate::math::{Box3, Interval, add_up, mul_up, sub_up};
use std::fmt;
use std::sync::Arc;

/// Whether a leaf had an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It is in `out`.
    Given,
    /// There is none; what is in `out` says nothing.
    None,
}

/// How fast a function can change: `|f(p) − f(q)| ≤ constant · |p − q| + 2 error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lipschitz {
    /// The largest slope, ≥ 0.
    pub constant: f64,
    /// How far a returned value may be from a function with that slope, ≥ 0.
    pub error: f64,
}

/// A function of points that expressions can use.
///
/// Everything is asked for many points at once, so that a leaf which pays for each call (a Python function, a
/// processor of its own) is called seldom. A call may fail, and its error ends the work.
///
/// Values are signed: negative is inside. A value that is NaN is outside.
pub trait Leaf: Send + Sync + fmt::Debug {
    /// The value at each point.
    ///
    /// # Errors
    /// Whatever the leaf's own function says.
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError>;

    /// The gradient at each point, if the leaf knows it.
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn gradient_at(&self, _points: &[[f64; 3]], _out: &mut [[f64; 3]]) -> Result<Answer, LeafError> {
        Ok(Answer::None)
    }

    /// By how much differences that stand for a missing gradient step to each side, in the leaf's own units: four
    /// samples at the corners of a tetrahedron of that radius.
    fn difference_step(&self) -> f64 {
        1.0 / 65_536.0
    }

    /// A range of all values in each box. What it says is taken as true, see [`Leaf::evidence`]; unless said otherwise
    /// it comes from the middle and [`Leaf::lipschitz`].
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<Answer, LeafError> {
        let Some(Lipschitz { constant, error }) = self.lipschitz() else { return Ok(Answer::None) };
        let middles: Vec<[f64; 3]> = boxes.iter().map(Box3::centre).collect();
        let mut values = vec![0.0; boxes.len()];
        self.at(&middles, &mut values)?;
        for (k, bounds) in boxes.iter().enumerate() {
            let reach = add_up(mul_up(constant, radius_around(bounds, middles[k])), error);
            let around = Interval::new(-reach, reach).unwrap_or(Interval::UNKNOWN);
            // With an error the value may jump by it.
            let value = Interval::point(values[k]) + around;
            out[k] = if error == 0.0 { value } else { value.undefined() };
        }
        Ok(Answer::Given)
    }

    /// A range of each partial derivative in each box, if the leaf knows it: of all generalized gradients (Clarke's)
    /// where the function has a kink.
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn gradient_over(&self, _boxes: &[Box3], _out: &mut [[Interval; 3]]) -> Result<Answer, LeafError> {
        Ok(Answer::None)
    }

    /// How fast the function changes, if that is known.
    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    /// What proofs that rest on [`Leaf::over`], [`Leaf::gradient_over`] and [`Leaf::lipschitz`] are worth: proved, proved if
    /// the user's word holds, or only measured because there is nothing to prove with.
    fn evidence(&self) -> Evidence;

    /// Where the function is that of a region at `x ≥ axis` with a part of its boundary at `x = axis`: a function of the region
    /// and its mirror image together, which that part of the boundary does not end any more. For profiles that are revolved.
    fn without_axis(&self, _axis: f64) -> Option<Arc<dyn Leaf>> {
        None
    }

    /// A number for the material at each point, if the leaf has materials.
    ///
    /// # Errors
    /// As for [`Leaf::at`].
    fn material_at(&self, _points: &[[f64; 3]], _out: &mut [u32]) -> Result<Answer, LeafError> {
        Ok(Answer::None)
    }

    /// How many points a call should have, at least, where there are so many.
    fn preferred_batch(&self) -> usize {
        1 << 16
    }
}

/// The farthest that a point of the box is from `middle`, rounded up.
fn radius_around(bounds: &Box3, middle: [f64; 3]) -> f64 {
    let far = |k: usize| {
        let (low, high) = (sub_up(middle[k], bounds.min[k]), sub_up(bounds.max[k], middle[k]));
        if low > high { low } else { high }
    };
    Box3 { min: [0.0; 3], max: [far(0), far(1), far(2)] }.diagonal()
}

/// Why a leaf has no values.
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
