//! Chordal: shapes into triangles under one budget, the error that may be seen.
//!
//! Every lossy step takes a [`Budget`] and returns a [`Bounded`] shape: the result, and a [`Bound`] on its
//! distance from the true shape that says how it is known ([`Evidence`]). You bring a budget, you leave with
//! a bound.
//!
//! # A tour
//! **A curve becomes a polyline.** The budget is a length, pixels at a view, a number of segments, or
//! several.
//!
//! ```
//! use chordal::prelude::*;
//!
//! let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
//! let budget = Budget::length(Tolerance::new(1e-3)?);
//! let bounded = convert::curve_to_polyline(&arch.into(), &budget, &Job::default()).expect("reachable");
//! assert!(bounded.shape.points.len() < 32);
//! assert!(*bounded.bound.evidence() == Evidence::Proved && bounded.bound.at_most().unwrap() <= 1e-3);
//! # Ok::<(), chordal::budget::InvalidTolerance>(())
//! ```
//!
//! **Patches become a mesh** without cracks, with as many triangles as each place needs.
//!
//! ```
//! use chordal::prelude::*;
//!
//! // A bicubic Bézier patch over the unit square, lifted in the middle.
//! let mut patch = Patch::flat([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
//! for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
//!     patch.control[i][j][2] = 0.5;
//! }
//! let budget = Budget::length(Tolerance::new(1e-3)?);
//! let bounded = convert::patches_to_mesh(&[patch], &budget, &Job::default()).expect("reachable");
//! assert!(bounded.bound.at_most().unwrap() <= 1e-3);
//! # Ok::<(), chordal::budget::InvalidTolerance>(())
//! ```
//!
//! **A field becomes a mesh**, closed and manifold. Shapes combine by union, intersection and difference, and
//! their edges stay sharp.
//!
//! ```
//! use chordal::implicit::shapes::{cuboid, cylinder};
//! use chordal::prelude::*;
//!
//! let block = cuboid([2.0, 2.0, 1.0])?.difference(&cylinder(0.4, 2.0)?);
//! let budget = Budget::length(Tolerance::new(0.01)?);
//! let bounded = convert::field_to_mesh(&block, &budget, &Job::default()).expect("reachable");
//! assert!(bounded.shape.faces().len() < 200 && bounded.bound.at_most().unwrap() <= 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **A mesh becomes a smaller mesh**, within a length of the original. **Two surfaces are compared** in both
//! directions, by proof and not by samples.
//!
//! ```
//! use chordal::explicit::Topology;
//! use chordal::implicit::shapes::sphere;
//! use chordal::prelude::*;
//!
//! let job = Job::default();
//! let length = |length| Tolerance::new(length).map(Budget::length);
//! let fine = convert::field_to_mesh(&sphere(1.0)?, &length(0.005)?, &job).expect("reachable").shape;
//! let bounded = lod::simplify(&fine, &length(0.05)?, Topology::Indices, &job).expect("reachable");
//! assert!(2 * bounded.shape.mesh.faces().len() < fine.faces().len());
//!
//! let deviation = check::deviation(&bounded.shape.mesh, &fine, &check::Goal::default(), &job)?;
//! assert!(deviation.bound.at_least() <= 0.05 && deviation.bound.at_most().unwrap() < 0.056);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to go on
//! The modules, lowest first; imports only go down: [`math`], [`budget`], [`explicit`] and [`implicit`],
//! [`check`], [`convert`], [`lod`], [`mend`], [`render`]. Items that most programs need are in these modules
//! themselves; items for experts are in their submodules, such as [`explicit::query`] for rays and closest
//! points, [`explicit::subdivision`] and [`implicit::evaluation`]. ARCHITECTURE.md has the picture,
//! GLOSSARY.md the words, and `docs/` a page for each arrow.

#[cfg(feature = "booleans")]
pub mod boolean;
pub mod budget;
pub mod check;
pub mod convert;
pub mod explicit;
pub mod implicit;
pub mod lod;
pub mod math;
pub mod mend;
pub mod prelude;
pub mod render;

pub use budget::{Bound, Bounded, Budget, Evidence, Failure, Job, Tolerance, View};
pub use explicit::{Bezier, Curve, Mesh, Patch, Polyline};

/// The examples of README.md and of the pages in `docs/` run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
#[doc = include_str!("../../../docs/bound.md")]
#[doc = include_str!("../../../docs/booleans.md")]
#[doc = include_str!("../../../docs/budget.md")]
#[doc = include_str!("../../../docs/cage_to_mesh.md")]
#[doc = include_str!("../../../docs/curve_to_polyline.md")]
#[doc = include_str!("../../../docs/deviation.md")]
#[doc = include_str!("../../../docs/enclosure.md")]
#[doc = include_str!("../../../docs/fields.md")]
#[doc = include_str!("../../../docs/field_to_mesh.md")]
#[doc = include_str!("../../../docs/fitting.md")]
#[doc = include_str!("../../../docs/formats.md")]
#[doc = include_str!("../../../docs/grid_to_mesh.md")]
#[doc = include_str!("../../../docs/inspect.md")]
#[doc = include_str!("../../../docs/lod.md")]
#[doc = include_str!("../../../docs/mend.md")]
#[doc = include_str!("../../../docs/normals.md")]
#[doc = include_str!("../../../docs/gpu_buffers.md")]
#[doc = include_str!("../../../docs/offset.md")]
#[doc = include_str!("../../../docs/outlines_to_mesh.md")]
#[doc = include_str!("../../../docs/overshade.md")]
#[doc = include_str!("../../../docs/patches_to_mesh.md")]
#[doc = include_str!("../../../docs/polygons.md")]
#[doc = include_str!("../../../docs/segments.md")]
#[doc = include_str!("../../../docs/simplify.md")]
#[doc = include_str!("../../../docs/splines.md")]
#[doc = include_str!("../../../docs/triangle.md")]
#[doc = include_str!("../../../docs/view.md")]
struct Pages;
