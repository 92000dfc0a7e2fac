//! Flattening curves into polylines: the deviation bound of a chord, and the placement of its ends.
pub(super) mod batch;
pub(super) mod chord;
pub(super) mod density;
pub(super) mod flatten;
pub(super) mod greedy;
pub(super) mod piece;
mod rational_chord;
