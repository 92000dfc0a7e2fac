//! How a budget is met: `within_budget`, the search that arrows with a length and a count share, the length that a
//! budget allows for those that take nothing else, and the length that pixels allow.
use crate::budget::{Bounded, Budget, Failure, PixelBudget, Pixels, RefusalCode, Tolerance};
use crate::math::Box3;

/// A shape that can be approximated by pieces: triangles or segments.
///
/// The limits of the job are the arrow's own: it refuses what they cannot hold, and never returns more.
pub(super) trait Approximation {
    /// The pieces.
    type Shape;

    /// The approximation that keeps the length, pixels and angle of the budget; `None` if it has more than `most`
    /// pieces.
    ///
    /// # Errors
    /// If the limits of the job are exceeded, or lengths are below rounding.
    fn by_error(&self, most: u64) -> Result<Option<Bounded<Self::Shape>>, Failure<Self::Shape>>;

    /// The best approximation with at most `most` pieces.
    ///
    /// # Errors
    /// [`Failure::Unmet`] if even the coarsest one has more.
    fn by_count(&self, most: u64) -> Result<Bounded<Self::Shape>, Failure<Self::Shape>>;

    /// The number of pieces.
    fn count(shape: &Self::Shape) -> u64;
}

/// The approximation that meets a budget. `most` is its limit on the number of pieces.
///
/// If it limits the number alone, the best with so few is the result. If it limits the error as well and the
/// approximation for that error has too many pieces, the best with so few may still be within it, since bounds
/// are often smaller than the lengths that they were built for.
///
/// # Errors
/// [`Failure::Unmet`] with the best; those of the arrow.
pub(super) fn within_budget<A: Approximation>(
    arrow: &A,
    budget: &Budget,
    most: Option<u64>,
) -> Result<Bounded<A::Shape>, Failure<A::Shape>> {
    let most = most.unwrap_or(u64::MAX);
    if budget.length.is_none() && budget.pixels.is_none() {
        let best = arrow.by_count(most)?;
        let is_met = budget.is_met_by(&best.bound);
        return best.met_if(is_met);
    }
    if let Some(fine) = arrow.by_error(most)? {
        return Ok(fine);
    }
    let best = arrow.by_count(most).or_else(Failure::best_effort)?;
    let is_met = A::count(&best.shape) <= most && budget.is_met_by(&best.bound);
    best.met_if(is_met)
}

/// The length that a budget allows everywhere in a place, for arrows that take nothing else. `noun` is the shape in
/// the sentence if it is too close to the eye; `None` if the budget limits neither length nor pixels.
pub(super) fn length_within<T>(
    budget: &Budget,
    place: &Box3,
    noun: &str,
) -> Result<Option<Tolerance>, Failure<T>> {
    if budget.length.is_none() && budget.pixels.is_none() {
        return Ok(None);
    }
    let length = budget.length_in(place).and_then(|length| Tolerance::new(length).ok());
    length.map(Some).ok_or_else(|| too_close(noun))
}

/// The refusal of a budget in pixels for a shape that reaches the eye.
pub(super) fn too_close<T>(noun: &str) -> Failure<T> {
    let message = format!("the {noun} comes so close to the eye that there is no bound in pixels");
    Failure::refused(RefusalCode::TooClose, message)
}

/// The length that a budget in pixels allows anywhere within that length of the box: a mesh may stick out so far.
pub(super) fn length_from_pixels<T>(bounds: &Box3, px: &PixelBudget) -> Result<f64, Failure<T>> {
    let too_close = || too_close("shape");
    let in_box = px.view.length_of(px.pixels, bounds).ok_or_else(too_close)?;
    let around = Box3 { min: bounds.min.map(|x| x - in_box), max: bounds.max.map(|x| x + in_box) };
    px.view.length_of(px.pixels, &around).ok_or_else(too_close)
}

/// Halvings of an interval of pixels. Chosen: a millionth of it is left.
const HALVINGS: usize = 20;

/// The rest of a budget of pixels after a step that loses a length in a box.
pub(super) fn remaining_pixels(px: &PixelBudget, lost: f64, bounds: &Box3) -> Option<PixelBudget> {
    let allowed = px.pixels.get();
    let spent = px.view.pixels_of(lost, bounds)?;
    let fits = |rest: f64| px.view.pixels_of_two_steps(rest, spent).is_some_and(|total| total <= allowed);
    // Bisection, because two steps together cost a little more than the sum of their pixels.
    let (mut fitting, mut beyond) = (0.0, allowed);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fitting + beyond);
        *(if fits(middle) { &mut fitting } else { &mut beyond }) = middle;
    }
    Some(PixelBudget { pixels: Pixels::new(fitting).ok()?, ..*px })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::{Bound, Reference};

    /// A shape whose approximation by n pieces is off by at most 1/n.
    struct Harmonic {
        length: Option<f64>,
        fewest: u64,
    }

    fn pieces(count: u64) -> Bounded<u64> {
        Bounded { shape: count, bound: Bound::proved(0.0, 1.0 / count as f64, Reference::Curves) }
    }

    impl Approximation for Harmonic {
        type Shape = u64;

        // Cautious: it takes twice as many pieces as it needs.
        fn by_error(&self, most: u64) -> Result<Option<Bounded<u64>>, Failure<u64>> {
            let count = (2.0 / self.length.unwrap_or(1.0)).ceil() as u64;
            Ok((count <= most).then(|| pieces(count)))
        }

        fn by_count(&self, most: u64) -> Result<Bounded<u64>, Failure<u64>> {
            pieces(most.max(self.fewest)).met_if(most >= self.fewest)
        }

        fn count(shape: &u64) -> u64 {
            *shape
        }
    }

    fn search(length: Option<f64>, most: Option<u64>) -> Result<u64, Option<u64>> {
        let budget =
            Budget { length: length.and_then(|length| Tolerance::new(length).ok()), ..Budget::default() };
        match within_budget(&Harmonic { length, fewest: 3 }, &budget, most) {
            Ok(best) => Ok(best.shape),
            Err(Failure::Unmet(best)) => Err(Some(best.shape)),
            Err(_) => Err(None),
        }
    }

    #[test]
    fn takes_the_best_that_every_limit_allows() {
        assert_eq!(search(None, Some(7)), Ok(7));
        assert_eq!(search(Some(0.1), None), Ok(20));
        assert_eq!(search(Some(0.1), Some(20)), Ok(20));
        // Fewer pieces than the length is built with, but within it all the same.
        assert_eq!(search(Some(0.1), Some(12)), Ok(12));
    }

    #[test]
    fn returns_the_best_of_a_budget_that_is_not_met() {
        assert_eq!(search(Some(0.1), Some(9)), Err(Some(9)));
        assert_eq!(search(None, Some(2)), Err(Some(3)));
        assert_eq!(search(Some(0.4), Some(2)), Err(Some(3)));
    }
}
