//! From a field of the plane to closed polylines: the outline itself if it consists of lines and arcs; otherwise the
//! squares that its curve may pass, the lines in them, and the proof of their distance.
mod near_stretches;
mod outline_lines;
mod plane_function;
mod plane_outline;
mod prove;
mod search;
mod straight_runs;
mod trace;

pub(super) use outline_lines::outline_lines;
pub(super) use search::{ContourGoal, search};
