//! The judge: measures and proves, builds nothing.
mod comb;
mod distance;
mod duplicates;
mod fans;
mod finding;
mod flat;
mod gap;
mod joins;
mod measure;
mod parallel;
mod pieces;
mod point_tree;
mod surface;
mod t_junctions;
mod validity;

pub use comb::{Tooth, curvature_comb};
pub use distance::surface_at_least;
pub use finding::{Finding, MAX_WITNESSES, Place, Witness};
pub use flat::{has_zero_area, is_collinear};
pub use gap::{Gap, distance_to_polyline, largest_gap};
pub use joins::{Join, join, joins};
pub use measure::{Measure, measure};
pub(crate) use point_tree::PointTree;
pub use t_junctions::t_junctions;
pub(crate) use t_junctions::vertices_in_edges;
pub use validity::{Validity, validity};
