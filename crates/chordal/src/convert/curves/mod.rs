//! Flattening curves into polylines: the deviation bound of a chord, and the placement of its ends.
pub(super) mod batch;
pub(super) mod chord;
mod cubic_spread;
pub(super) mod density;
pub(super) mod flatten;
pub(super) mod greedy;
pub(super) mod piece;
mod rational_chord;
mod rational_spread;
