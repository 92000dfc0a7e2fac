//! `MeshRequest`: a budget for one shape and one format, and how a conversion runs within it.
use crate::formats::{in_words, names_where};
use crate::output::format_rounding::snap_with_bound;
use crate::output::format_rounding::{RoundingTarget, lattice_within, length_for_lattice};
use crate::{MeshFailure, OutputForm};
use chordal::budget::{Bound, Bounded, Budget, Failure, PixelBudget, Pixels, RefusalCode, Tolerance};
use chordal::convert::Spacing;
use chordal::lod::count::Effort;
use chordal::math::{Box3, greater, sub_down, sub_up};
use chordal::{Job, Mesh};
use chordal_io::Format;
use chordal_io::glb::{GltfPacking, PositionLattice};

/// The target of a conversion: the budget, resolved for the shape, and the format.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshRequest {
    pub budget: Budget,
    pub to: Format,
    pub packing: GltfPacking,
    /// The lattice of positions, if the file is quantized and the budget leaves room for it.
    pub lattice: Option<PositionLattice>,
    /// The bounding box of the shape.
    pub bounds: Box3,
    /// The same box, grown by the rounding of evaluated points.
    reach: Box3,
    /// How segment ends are spaced on curves.
    pub spacing: Spacing,
    /// The work that a triangle count is worth when triangles are simplified.
    pub effort: Effort,
}

impl MeshRequest {
    pub fn new(budget: Budget, to: impl Into<OutputForm>, bounds: Box3) -> Self {
        let form: OutputForm = to.into();
        let OutputForm { format: to, packing } = form;
        let reach = widen_box(&bounds);
        let allowed = budget.length_in(&bounds).unwrap_or(0.0);
        let lattice = if form.is_quantized() {
            lattice_within(&reach, length_for_lattice(allowed, &budget.attributes))
        } else {
            None
        };
        Self {
            budget,
            to,
            packing,
            lattice,
            bounds,
            reach,
            spacing: Spacing::default(),
            effort: Effort::default(),
        }
    }

    /// The format, and how its numbers are packed.
    pub fn form(&self) -> OutputForm {
        OutputForm { format: self.to, packing: self.packing }
    }

    /// Runs a conversion so that the budget holds for the file as a reader gets it: first reserves the possible
    /// rounding to the format, then runs the conversion within the rest, and adds the actual rounding to the bound.
    ///
    /// If the budget is missed, returns the best result that was reached; `output/finish.rs` checks the total against the
    /// budget.
    ///
    /// # Errors
    /// When rounding alone may exceed the budget; as for the conversion.
    pub fn run(
        &self,
        job: &Job,
        arrow: impl FnOnce(&Budget) -> Result<Bounded<Mesh>, Failure<Mesh>>,
    ) -> Result<Bounded<Mesh>, MeshFailure> {
        let converted = arrow(&self.reserve_rounding(self.rounding())?).or_else(Failure::best_effort)?;
        self.snap(&converted.shape, converted.bound, job)
    }

    /// The same request for a box grown by the rounding of evaluated points.
    pub fn widened(self) -> Self {
        Self { bounds: self.reach, ..self }
    }

    /// The same request for a shape that may leave the box by a length.
    #[cfg(feature = "booleans")]
    pub fn with_reach(self, length: f64) -> Self {
        let Box3 { min, max } = self.reach;
        Self { reach: Box3 { min: min.map(|x| x - length), max: max.map(|x| x + length) }, ..self }
    }

    pub fn with_spacing(self, spacing: Spacing) -> Self {
        Self { spacing, ..self }
    }

    pub fn with_effort(self, effort: Effort) -> Self {
        Self { effort, ..self }
    }

    pub fn with_budget(self, budget: Budget) -> Self {
        Self { budget, ..self }
    }

    /// The largest distance by which rounding to the format moves a point of the result.
    pub fn rounding(&self) -> f64 {
        RoundingTarget::new(self.to, self.lattice).worst(&self.reach)
    }

    /// The budget of a conversion: the user's, less the length that rounding to the format may take.
    ///
    /// # Errors
    /// If nothing is left of it, or the shape reaches the eye.
    pub fn reserve_rounding(&self, lost: f64) -> Result<Budget, MeshFailure> {
        let Self { budget, to, bounds, .. } = self;
        // Rounding makes no triangle more, so that a count has nothing to reserve.
        if lost == 0.0 || budget.length.is_none() && budget.pixels.is_none() {
            return Ok(*budget);
        }
        let too_small = |requested: String, lost: String| {
            let message = format!(
                "{requested} is less than what rounding to the single precision of {to} may cost here, {lost}; \
                 {} keep every digit",
                in_words(&names_where(Format::keeps_every_digit), "and")
            );
            MeshFailure::refused(RefusalCode::BelowPrecision, message)
        };
        let mut inner = *budget;
        if let Some(length) = budget.length {
            let left = Tolerance::new(sub_down(length.get(), lost));
            inner.length = Some(left.map_err(|_| too_small(length.to_string(), format!("{lost:.3e}")))?);
        }
        if let Some(PixelBudget { pixels, view }) = budget.pixels {
            let lost_px = view.pixels_of(lost, bounds).ok_or_else(|| {
                MeshFailure::refused(
                    RefusalCode::TooClose,
                    "the shape comes so close to the eye that there is no bound in pixels",
                )
            })?;
            // The pixels of two steps may be more than their sum, so that subtracting `lost_px` is not enough.
            let sum = view.pixels_of_two_steps(pixels.get(), lost_px).unwrap_or(f64::INFINITY);
            let left = Pixels::new(sub_down(pixels.get(), sub_up(sum, pixels.get())));
            let pixels = left.map_err(|_| too_small(pixels.to_string(), format!("{lost_px:.3e}px")))?;
            inner.pixels = Some(PixelBudget { pixels, view });
        }
        Ok(inner)
    }

    /// Rounds a mesh to the precision of the format and adds the displacement to the bound: see
    /// [`snap_with_bound`].
    pub fn snap(&self, mesh: &Mesh, bound: Bound, job: &Job) -> Result<Bounded<Mesh>, MeshFailure> {
        snap_with_bound(mesh, bound, RoundingTarget::new(self.to, self.lattice), self.budget.pixels, job)
    }
}

/// The box grown by the rounding of evaluated points, which may leave the hull of their control points: an evaluation
/// has fewer than 32 roundings of half a step each.
fn widen_box(bounds: &Box3) -> Box3 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    let margin = 16.0 * f64::EPSILON * reach;
    Box3 { min: bounds.min.map(|x| x - margin), max: bounds.max.map(|x| x + margin) }
}
