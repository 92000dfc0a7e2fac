//! What nearly every program uses: `use chordal::prelude::*;`.
pub use crate::budget::{Bound, Bounded, Budget, Evidence, Failure, Job, Pixels, Tolerance, View};
pub use crate::explicit::{Bezier, Cage, Curve, CurveSegment, Mesh, Outline, Patch, Polyline};
pub use crate::implicit::{Field, Grid};
pub use crate::{check, convert, lod, mend, render};
