//! Chordal: shapes into triangles under one budget, the error that may be seen.
//!
//! Every lossy step takes a [`Budget`] and returns a [`Bounded`] shape: the triangles and a [`Bound`] on how
//! far they are from the true shape, together with how that is known ([`Evidence`]).
//!
//! ```
//! use chordal::{Budget, Job, Tolerance, convert, explicit::Patch};
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
//! The modules, lowest first; imports only go down: [`math`], [`budget`], [`explicit`] and [`implicit`],
//! [`check`], [`convert`], [`lod`], [`mend`], [`render`]. ARCHITECTURE.md has the picture.

pub mod budget;
pub mod check;
pub mod convert;
pub mod explicit;
pub mod implicit;
pub mod lod;
pub mod math;
pub mod mend;
pub mod render;

pub use budget::{Bound, Bounded, Budget, Evidence, Failure, Job, Tolerance, View};
pub use explicit::{Bezier, Curve, Mesh, Patch, Polyline};

/// The examples of README.md and of the pages in `docs/` run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
#[doc = include_str!("../../../docs/bound.md")]
#[doc = include_str!("../../../docs/budget.md")]
#[doc = include_str!("../../../docs/cage_to_mesh.md")]
#[doc = include_str!("../../../docs/curve_to_polyline.md")]
#[doc = include_str!("../../../docs/deviation.md")]
#[doc = include_str!("../../../docs/enclosure.md")]
#[doc = include_str!("../../../docs/fields.md")]
#[doc = include_str!("../../../docs/field_to_mesh.md")]
#[doc = include_str!("../../../docs/formats.md")]
#[doc = include_str!("../../../docs/grid_to_mesh.md")]
#[doc = include_str!("../../../docs/inspect.md")]
#[doc = include_str!("../../../docs/lod.md")]
#[doc = include_str!("../../../docs/mend.md")]
#[doc = include_str!("../../../docs/normals.md")]
#[doc = include_str!("../../../docs/gpu_buffers.md")]
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
