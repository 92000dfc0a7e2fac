//! From a field of the plane to closed polylines: the outline itself where it consists of lines and arcs; else the
//! squares that its curve may pass, the lines, and the proof.
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
