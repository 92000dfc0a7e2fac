//! `lod`: levels of detail of any surface, each with its own bound, as one glTF or as 3D Tiles.
mod gltf_levels;
mod lens;
mod level_finisher;
mod level_mesh;
mod outcome;
mod part_tiles;
mod scene_levels;
mod source;
mod tile_hierarchy;
mod tileset;

use crate::output::finish::NOT_MET;
use crate::output::format_rounding::single_precision_note;
use crate::output::notes::packing_note;
use crate::output::notes::too_fine_note;
use crate::provenance::geometry_digest::written_digest;
use crate::report::{
    BoundFacts, BudgetFacts, Certificate, CountedTriangles, OpenPlacesFacts, Output, VerbFacts,
};
use crate::{BudgetSpec, Input, MeshFailure, Normals, OutputForm, Shape};
use chordal::Job;
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::camera::MinDistanceView;
use chordal::budget::{Bound, Budget, Length, Pixels, RefusalCode, Tolerance, View};
use chordal::lod::selection::SwitchDistances;
use chordal_io::glb::GltfPacking;
use chordal_io::tiles::GeoPlace;
use chordal_io::{Format, Warning, losses};
use level_finisher::LevelFinisher;
use outcome::LodLayout;
use scene_levels::SceneLevels;
use source::{LevelSource, SourceLevels};
use tile_hierarchy::TileHierarchy;

pub use lens::LodLens;
pub use outcome::LodOutcome;
pub use part_tiles::{PartTile, TileEntry, part_tile, part_tileset, rounded_part};

/// Options for levels of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct LodSpec {
    /// The largest error on the screen.
    pub pixels: Pixels,
    /// The lens and the screen for which distances are computed; its own distance is ignored.
    pub lens: MinDistanceView,
    /// The nearest distance of the eye to the box: the finest level is fine enough there.
    pub nearest: Option<f64>,
    /// The tolerance of the finest level, overriding `nearest`.
    pub length: Option<Length>,
    /// Additional distances for the table, beside the switch distances and the distances at which the shape covers few
    /// pixels.
    pub distances: Vec<f64>,
    /// The normals of the triangles.
    pub normals: Normals,
    /// The error that tiles declare.
    pub errors: TileErrors,
    /// The most triangles of a tile: a finest level with more is cut in space. `None` for no tiles.
    pub tile_triangles: Option<u64>,
    /// The largest deviations of the attributes of every level from those of the input.
    pub attributes: AttributeLimits,
    /// Whether the parts of a scene have levels of their own.
    pub parts: LodParts,
    /// The place of a tileset's origin on the Earth. There x of the scene is east; if z is up, y is north, and if y is up,
    /// -z is north.
    pub place: Option<GeoPlace>,
    /// How the numbers of all files are stored.
    pub packing: GltfPacking,
}

/// The treatment of the parts of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LodParts {
    /// Each part has levels of its own, and the nodes that show it are kept.
    #[default]
    Separate,
    /// All parts become one mesh, so that small parts can vanish into others.
    Merged,
}

/// The error that tiles declare, from which viewers choose levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TileErrors {
    /// Large enough that viewers, whose formula holds in the middle of the screen, keep the pixels everywhere on the screen.
    #[default]
    Scaled,
    /// The proved error itself.
    Plain,
}

/// Builds levels of detail of a surface: see [`chordal::lod::chain`].
///
/// The finest level is within `spec.length`, or loses at most `spec.pixels` at `spec.nearest`. If neither is given, it loses
/// at most that at the distance at which the box fills the height of the screen. [`LodOutcome::unmet`] says why if it is
/// farther off, as by rounding to single precision. Each level is proved against the shape itself, in the form in which it
/// will be written: positions in single precision, or on one lattice for all levels and tiles of a part if `spec.packing`
/// is quantized.
///
/// The parts of a scene have levels of their own, within tolerances that hold after the largest scale of any of their
/// instances, unless `spec.parts` merges them or a finest level is cut in space. A level of the scene shows each part in its
/// coarsest level that is within the error.
///
/// # Errors
/// As for [`crate::mesh()`]; [`MeshFailure::Usage`] for curves, which have no levels, for parallel rays, and if there would
/// be more than 20,000 tiles.
pub fn lod(input: Input, spec: &LodSpec, job: &Job) -> Result<LodOutcome, MeshFailure> {
    if matches!(input.shape, Shape::Drawing(_) | Shape::Curves(_)) {
        return Err(MeshFailure::Usage("levels of detail are for surfaces, and these are curves".into()));
    }
    if spec.lens.focal_px().is_none() {
        let message = "levels change with the distance, which has no effect with parallel rays: give the view a field of view";
        return Err(MeshFailure::Usage(message.into()));
    }
    if spec.attributes.is_set() && !matches!(input.shape, Shape::Scene(_)) {
        let message =
            "limits on texture coordinates and normals apply only to triangles that have these attributes";
        return Err(MeshFailure::refused(RefusalCode::Budget, message));
    }
    let mut certificate = Certificate::from_input(&input);
    let diagonal = input.shape.diagonal()?;
    let finest = finest(&input.shape, spec, &mut certificate)?;
    let budget = Budget { attributes: spec.attributes, ..Budget::length(finest) };
    certificate.budget = Some(BudgetFacts::new(&budget));
    let (frame, from) = (*input.shape.frame(), input.format);
    if let Shape::Scene(scene) = &input.shape {
        let form = OutputForm { format: Format::Glb, packing: spec.packing };
        certificate.notes.extend(packing_note(scene.stored, form));
        certificate.notes.extend(losses(scene, Format::Glb)?.iter().map(Warning::counted));
    }
    let source = LevelSource { spec, finest, job };
    let levels = source.levels(input.shape, &mut certificate.notes)?;
    let assets = levels.assets();
    let finisher = LevelFinisher::new(spec, from, frame, assets);
    let layout = match levels {
        SourceLevels::Chains(chains) => {
            LodLayout::Levels(Box::new(SceneLevels::new(*chains, &finisher, &mut certificate.notes, job)?))
        }
        SourceLevels::TooLarge { finest, cut, .. } => {
            let cut = TileHierarchy::build(*finest, &finisher, cut, &mut certificate.notes, job)?;
            LodLayout::Cut(Box::new(cut))
        }
    };
    let bound = layout.finest_bound();
    let bound =
        bound.ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "there is no triangle to show"))?;
    certificate.bound = Some(BoundFacts::new(bound));
    let is_met = bound.at_most().is_some_and(|most| most <= finest.get());
    let unmet = (!is_met).then(|| unmet(bound, finest));
    if !is_met {
        certificate.notes.push(NOT_MET.into());
    }
    let shown = layout.finest_scene();
    let counted = CountedTriangles::from_scene(shown, Format::Glb)?;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    if spec.tile_triangles.is_some() {
        certificate.notes.extend(tileset::unused_note(shown)?);
    }
    let levels = layout.counts();
    let errors: Vec<f64> = levels.iter().map(|level| level.at_most).collect();
    let switches = SwitchDistances::new(&errors, spec.lens, spec.pixels);
    if let Some(distance) = switches.distance(0).filter(|d| *d > 0.0 && d.is_finite()) {
        let seen = Budget::pixels(spec.pixels, View::MinDistance(MinDistanceView { distance, ..spec.lens }));
        certificate.notes.extend(too_fine_note(shown, &seen, job)?);
    }
    if spec.packing.is_quantized {
        certificate.notes.extend(single_precision_note(&shown.parts));
    }
    certificate.notes.dedup();
    let mut outcome = LodOutcome { layout, switches, spec: spec.clone(), diagonal, unmet, certificate };
    // Before the digests: they are of levels as they are written, and a packing changes the order of faces.
    outcome.pack(spec.packing);
    let mut levels = levels;
    for (k, level) in levels.iter_mut().enumerate() {
        level.geometry = outcome.level(k).and_then(|(scene, _)| written_digest(&scene, Format::Glb));
    }
    let finest = || written_digest(outcome.layout.finest_scene(), Format::Glb);
    let geometry = levels.first().and_then(|level| level.geometry.clone()).or_else(finest);
    outcome.certificate.verb = VerbFacts::Levels { levels: outcome.facts(levels) };
    outcome.certificate.conclude(("triangles", Format::Glb), geometry);
    Ok(outcome)
}

/// The message if the finest level is farther off than the budget allows, with the reason if its proof failed.
fn unmet(bound: &Bound, finest: Tolerance) -> Message {
    let message =
        format!("the budget of the finest level, {finest}, was not met; the best reached is {bound}");
    let Some(open) = bound.open.as_deref() else { return message.into() };
    let why = OpenPlacesFacts::new(open).why_unproved();
    // For surfaces that touch, the reason includes the advice.
    let advice = match open.tangent() {
        Some(_) => "",
        None => {
            "; allow a larger error, or mesh the shape by itself and make levels of that mesh, whose errors are then counted \
             from its triangles"
        }
    };
    format!("{message}: levels need a proved bound, and within less the shape is {why}{advice}").into()
}

/// The tolerance of the finest level.
fn finest(shape: &Shape, spec: &LodSpec, certificate: &mut Certificate) -> Result<Tolerance, MeshFailure> {
    if let Some(length) = spec.length {
        let spec = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
        let (budget, note) = spec.resolve(shape)?;
        certificate.notes.extend(note);
        return budget
            .length
            .ok_or_else(|| MeshFailure::refused(RefusalCode::Budget, "the budget has no length"));
    }
    let diagonal = shape.diagonal()?;
    let focal = spec.lens.focal_px().unwrap_or(f64::INFINITY);
    // At this distance the diagonal covers the height of the screen, in its middle.
    let distance = spec.nearest.unwrap_or(diagonal * focal / f64::from(spec.lens.screen.height_px));
    if spec.nearest.is_none() {
        certificate.notes.push(format!(
            "no nearest distance of the eye is given: the finest level is for {distance:.6}, where the box fills the \
             height of the screen"
        ).into());
    }
    let view = View::MinDistance(MinDistanceView { distance, ..spec.lens });
    let length = view.length_of(spec.pixels, &shape.bounds()?).and_then(|length| Tolerance::new(length).ok());
    length.ok_or_else(|| {
        MeshFailure::refused(
            RefusalCode::TooClose,
            "the shape has no size, or the eye is so close that no length is small enough",
        )
    })
}
