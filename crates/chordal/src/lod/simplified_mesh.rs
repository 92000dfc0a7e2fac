//! `SimplifiedMesh`: a mesh with fewer triangles, and its bound from its deviation.
use super::reduction::ReductionStats;
use crate::budget::{Bound, Bounded, Failure, Reference};
use crate::check::findings::AttributeDeviation;
use crate::check::{Deviation, OneSidedDistance};
use crate::explicit::Mesh;

/// A simplified mesh, with details in addition to the bound.
#[derive(Clone, Debug, PartialEq)]
pub struct SimplifiedMesh {
    /// The triangles.
    pub mesh: Mesh,
    /// The worst pair of points: one on one surface, and the closest point on the other. `None` if no point
    /// was found to deviate.
    pub worst: Option<OneSidedDistance>,
    /// Parts that could not be collapsed, and parts that were dropped.
    pub stats: ReductionStats,
    /// The deviation of attributes from those of the original, measured if the budget limits them.
    pub attributes: Vec<AttributeDeviation>,
}

/// Why there is no simplified mesh.
pub(super) type SimplifyFailure = Failure<SimplifiedMesh>;

/// The fraction of the tolerance that collapses may use. Chosen: the remainder covers rounding and the slack
/// of the final proof over the thorough checks.
pub(super) const SHARE: f64 = 0.99;
/// The fraction of a length, or of the diagonal if that is less, by which both ends of a bound may differ.
/// Chosen: a smaller one takes more time for the bound alone.
pub(super) const CLOSE: f64 = 0.01;
/// The fraction of the diagonal below which a distance counts as rounding, as of positions that were computed
/// in flat parts. Chosen: a smaller one takes time to resolve rounding errors.
pub(super) const ROUNDINGS: f64 = 1024.0 * f64::EPSILON;

/// The original itself, whose distance is 0.
pub(super) fn unchanged(mesh: &Mesh, stats: ReductionStats) -> Bounded<SimplifiedMesh> {
    let bound = Bound::proved(0.0, 0.0, Reference::InputTriangles);
    Bounded {
        shape: SimplifiedMesh { mesh: mesh.clone(), worst: None, stats, attributes: Vec::new() },
        bound,
    }
}

/// The bound by [`deviation`](crate::check::deviation). Another proof of the same distance, `at_most`, may
/// lower its upper end. Two proofs that contradict each other prove nothing, so an upper end below the proved
/// lower end is ignored.
pub(super) fn bounded(
    mesh: Mesh,
    deviation: &Deviation,
    at_most: f64,
    stats: ReductionStats,
) -> Bounded<SimplifiedMesh> {
    let worst = (deviation.bound.at_least() > 0.0).then(|| *deviation.worst());
    let least = deviation.bound.at_least();
    let most = deviation.bound.at_most().unwrap_or(f64::INFINITY);
    let most = if least <= at_most && at_most < most { at_most } else { most };
    let mut bound = Bound::proved(least, most, Reference::InputTriangles);
    bound.at = deviation.bound.at;
    Bounded { shape: SimplifiedMesh { mesh, worst, stats, attributes: Vec::new() }, bound }
}
