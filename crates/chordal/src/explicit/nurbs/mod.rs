//! Non-uniform rational B-splines: curves and surfaces of any degree, as CAD and USD files hold them.
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., 1997; blossoms: L. Ramshaw, *Blossoming: a
//! connect-the-dots approach to splines*, 1987.
mod bernstein;
mod compatible;
mod conics;
mod coons;
mod curve;
mod cut;
mod elevate;
mod enclosed;
mod from_path;
mod insert;
mod interpolate;
mod knots;
mod loft;
mod rational;
mod remove;
mod revolved;
mod surface;
mod trimmed;

pub(crate) use bernstein::{BernsteinRow, binomials};
pub use compatible::compatible;
pub(crate) use curve::HEAVIEST;
pub use curve::NurbsCurve;
pub(crate) use enclosed::binomials as interval_binomials;
pub(crate) use enclosed::{BernsteinFactors, EnclosedPiece, IntervalRow, arc_pieces};
pub use knots::{InvalidNurbs, KnotVector};
pub use rational::RationalBezier;
pub use surface::NurbsSurface;
pub(crate) use surface::{BezierNet, SurfaceJet};
pub use trimmed::{InvalidTrim, TrimmedSurface};
