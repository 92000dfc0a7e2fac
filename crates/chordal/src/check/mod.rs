//! The judge: measures and proves, builds nothing.
mod comb;
mod deviation;
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
pub use deviation::{Deviation, Goal, OneSided, deviation};
pub use distance::surface_at_least;
pub use finding::{Finding, MAX_WITNESSES, Place, Witness};
pub use flat::{has_zero_area, is_collinear};
pub use gap::{Gap, distance_to_polyline, largest_gap};
pub use joins::{Join, join, joins};
pub use measure::{Measure, measure};
pub use t_junctions::t_junctions;
pub use validity::{Validity, validity};
