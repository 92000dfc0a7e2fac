//! What curves and their polylines share: the certificate of a chord, and where to put its ends.
pub(super) mod batch;
pub(super) mod chord;
pub(super) mod density;
pub(super) mod flatten;
pub(super) mod greedy;
pub(super) mod piece;
