//! The verbs that every front end calls: bytes in, a verb, a report out. Front ends only translate; nothing
//! here reads a path or prints.
//!
//! ```
//! use chordal_io::Format;
//! use chordal_verbs::{BudgetSpec, FormatHint, load, mesh};
//!
//! // One flat patch in Newell's text: the 16 points of a patch as indices, then the points.
//! let patch = "1\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n16\n\
//!     0,0,0\n1,0,0\n2,0,0\n3,0,0\n0,1,0\n1,1,1\n2,1,1\n3,1,0\n\
//!     0,2,0\n1,2,1\n2,2,1\n3,2,0\n0,3,0\n1,3,0\n2,3,0\n3,3,0\n";
//! let input = load(patch.as_bytes(), FormatHint::default(), &Default::default())?;
//! let spec = BudgetSpec { length: Some("0.1%".parse()?), ..BudgetSpec::default() };
//! let outcome = mesh(input, &spec, Format::Glb, &Default::default())?;
//! let budget = outcome.certificate.budget.as_ref().unwrap().length.unwrap();
//! assert!(outcome.bound.at_most().unwrap() <= budget);
//! let mut glb = Vec::new();
//! outcome.write(&mut glb)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod bake;
#[cfg(feature = "booleans")]
mod boolean;
mod convert;
mod deviation;
mod failure;
pub mod formats;
mod input;
mod inspect;
mod lod;
mod mend;
mod mesh;
pub mod options;
mod outcome;
mod output;
mod provenance;
mod render;
pub mod report;
mod scene;
mod simplify;
mod spec;
mod spell;
mod verify;

pub use bake::{BakeOutcome, BakeResolution, BakeSpec, BakedVolume, bake};
#[cfg(feature = "booleans")]
pub use boolean::{BooleanOperand, mesh_boolean};
pub use chordal::convert::{Border, Inside, Spacing};
pub use chordal::lod::count::Effort;
pub use chordal::mend::nesting::NestedShells;
pub use chordal::mend::{Duplicates, HoleSelection};
pub use chordal_io::{Axis, Curves, Drawing, Frame, PolygonSurface, Polygons, Polylines, Scene};
pub use convert::certified::convert_certified;
pub use convert::{
    ConvertOutcome, ConvertedShape, ShaderOutcome, convert, convert_within, field_shader, needs_mesh,
    polygons_lose_no_more, written_names,
};
pub use deviation::{DeviationSpec, deviation};
pub use failure::MeshFailure;
pub use input::carried::{carried_sources, load_carried};
pub use input::drawing_to_field::drawing_to_field;
pub use input::file_extension::extension;
pub use input::implicit::{ImplicitShape, LineShape, Parameter, ShapeBody, ShapeLine};
pub use input::load::{FormatHint, Input, InputDigest, InputFile, load, load_with, load_within};
pub use input::scene_to_field::{SceneField, scene_to_field};
pub use input::shape::Shape;
pub use input::smoothing_width::SmoothingWidth;
pub use input::volume::{LabelSelection, SuggestedLevel, SurfaceSpec, ValueRange, VolumeShape};
pub use inspect::{SurfaceDepth, inspect, inspect_deeply, inspect_surface};
pub use lod::{LodLens, LodOutcome, LodParts, LodSpec, TileErrors, lod};
pub use lod::{PartTile, TileEntry, part_tile, part_tileset, rounded_part};
pub use mend::{MendSpec, WeldTolerance, mend};
pub use mesh::cage::{ControlMesh, RefineOutcome, refine, refined_cage};
pub use mesh::offset::SolidOffset;
pub use mesh::{mesh, needs_budget};
pub use outcome::{MeshOutcome, Tessellation};
pub use output::normals::{InvalidNormals, Normals};
pub use output::output_form::OutputForm;
pub use provenance::compose::{compose_input, history_of, join_input, made_of, transform_input};
pub use provenance::composed::Composed;
pub use provenance::digest::{sha256, sha256_of};
pub use provenance::geometry_digest::geometry_digest;
pub use provenance::seal::seal_of;
pub use render::{PictureTolerance, RenderOutcome, USUAL_SCREEN, render, render_against, render_comb};
pub use scene::transform::{MovedScene, Stretch, composed_bound, transform};
pub use spec::{BudgetSpec, parse_time, time_limit};
pub use verify::{
    ClaimFacts, ClaimVerdict, VERIFY_SCHEMA, VerifyReport, inputs_to_verify, n_coarser_levels, verify,
    verify_levels,
};

/// Compiles the examples of the page in `docs/` with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/volumes.md")]
struct Volumes;

/// The examples of the page on cages.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/cages.md")]
struct Cages;
