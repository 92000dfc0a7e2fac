//! How a field of the plane becomes closed polylines: squares that its curve can run through, lines, and the proof.
mod prove;
mod search;
mod trace;

pub(super) use search::{ContourGoal, search};
