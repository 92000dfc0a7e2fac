//! Non-uniform rational B-splines: curves and surfaces of any degree, as CAD and USD files hold them.
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., 1997; blossoms: L. Ramshaw, *Blossoming: a
//! connect-the-dots approach to splines*, 1987.
mod bernstein;
mod curve;
mod knots;
mod rational;
mod revolved;
mod surface;
mod trimmed;

pub(crate) use bernstein::{BernsteinRow, binomials};
pub(crate) use curve::HEAVIEST;
pub use curve::NurbsCurve;
pub use knots::{InvalidNurbs, KnotVector};
pub use rational::RationalBezier;
pub use surface::NurbsSurface;
pub(crate) use surface::{BezierNet, SurfaceJet};
pub use trimmed::{InvalidTrim, TrimmedSurface};
