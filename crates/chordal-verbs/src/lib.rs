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
mod cage;
mod cage_size;
mod collapsed_faces;
mod compose;
mod composed;
#[cfg(feature = "booleans")]
mod construction_by_booleans;
mod contact_lines;
mod convert;
mod cubic_paths;
mod deviation;
mod digest;
mod drawing_regions;
mod drawing_to_field;
mod drop_attributes;
mod failure;
mod field;
#[cfg(feature = "booleans")]
mod field_by_booleans;
#[cfg(feature = "booleans")]
mod field_by_solids;
mod field_digest;
mod field_looks;
mod field_slack;
mod file_extension;
mod file_rows;
mod filled_regions;
mod finish;
mod flatten;
mod format_rounding;
pub mod formats;
mod frame_nodes;
mod geometry_digest;
#[cfg(feature = "script")]
mod heights_to_mesh;
mod held_faces;
mod implicit;
mod inspect;
mod isosurface;
mod label_looks;
mod load;
mod lod;
mod max_bound;
mod mend;
mod merge;
mod merged_parts;
mod mesh;
mod normals;
mod notes;
pub mod options;
mod origin;
mod outcome;
mod output_form;
mod pass_through;
mod placements;
mod polylines;
mod recommend;
mod render;
pub mod report;
mod request;
mod rounded_mesh;
mod scene_to_field;
mod script;
#[cfg(feature = "script")]
mod script_files;
mod seal;
mod shape;
mod shown_parts;
mod simplified_isosurface;
mod simplify;
mod smoothing;
mod smoothing_width;
#[cfg(feature = "booleans")]
mod solid_cut;
mod spec;
mod spell;
mod straight;
mod tessellate;
mod time_limit;
mod too_fine;
mod transform;
mod verify;
mod volume;
mod zero_set;

pub use bake::{BakeOutcome, BakeResolution, BakeSpec, BakedVolume, bake};
#[cfg(feature = "booleans")]
pub use boolean::{BooleanOperand, mesh_boolean};
pub use cage::{ControlMesh, RefineOutcome, refine, refined_cage};
pub use chordal::convert::{Border, Inside, Spacing};
pub use chordal::lod::count::Effort;
pub use chordal::mend::nesting::NestedShells;
pub use chordal::mend::{Duplicates, HoleSelection};
pub use chordal_io::{Axis, Curves, Drawing, Frame, PolygonSurface, Polygons, Polylines, Scene};
pub use compose::{compose_input, history_of, join_input, made_of, transform_input};
pub use composed::Composed;
pub use convert::{
    ConvertOutcome, ConvertedShape, convert, convert_within, needs_mesh, polygons_lose_no_more, written_names,
};
pub use deviation::{DeviationSpec, deviation};
pub use digest::{sha256, sha256_of};
pub use drawing_to_field::drawing_to_field;
pub use failure::MeshFailure;
pub use file_extension::extension;
pub use geometry_digest::geometry_digest;
pub use implicit::{ImplicitShape, LineShape, Parameter, ShapeBody, ShapeLine};
pub use inspect::{SurfaceDepth, inspect, inspect_deeply, inspect_surface};
pub use load::{FormatHint, Input, InputDigest, InputFile, load, load_with, load_within};
pub use lod::{LodLens, LodOutcome, LodParts, LodSpec, TileErrors, lod};
pub use lod::{PartTile, TileEntry, part_tile, part_tileset, rounded_part};
pub use mend::{MendSpec, WeldTolerance, mend};
pub use mesh::{mesh, needs_budget};
pub use normals::{InvalidNormals, Normals};
pub use outcome::{MeshOutcome, Tessellation};
pub use output_form::OutputForm;
pub use render::{PictureTolerance, RenderOutcome, USUAL_SCREEN, render, render_against, render_comb};
pub use scene_to_field::{SceneField, scene_to_field};
pub use seal::seal_of;
pub use shape::Shape;
pub use smoothing_width::SmoothingWidth;
pub use spec::BudgetSpec;
pub use time_limit::{parse_time, time_limit};
pub use transform::{MovedScene, Stretch, composed_bound, transform};
pub use verify::{
    ClaimFacts, ClaimVerdict, VERIFY_SCHEMA, VerifyReport, inputs_to_verify, n_coarser_levels, verify,
    verify_levels,
};
pub use volume::{LabelSelection, SuggestedLevel, SurfaceSpec, ValueRange, VolumeShape};

/// Compiles the examples of the page in `docs/` with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/volumes.md")]
struct Volumes;

/// The examples of the page on cages.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/cages.md")]
struct Cages;
