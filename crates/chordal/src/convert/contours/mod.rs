//! From a field of the plane to closed polylines: the squares that its curve may pass, the lines, and the
//! proof.
mod prove;
mod search;
mod trace;

pub(super) use search::{ContourGoal, search};
