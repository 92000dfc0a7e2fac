//! `lod`: levels of detail of any surface, each with its own bound, as one glTF or as 3D Tiles.
mod tileset;

use crate::file_rows::to_file_rows;
use crate::finish::too_fine_note;
use crate::flatten::{self, TransformedScene};
use crate::merge::{MergedMesh, merge};
use crate::report::{
    BoundFacts, BudgetFacts, Certificate, CountedTriangles, LevelChoiceFacts, LevelFacts, LevelsFacts,
    Output, ViewFacts,
};
use crate::request::MeshRequest;
use crate::simplify::{summary_notes, without, without_normals};
use crate::{BudgetSpec, Input, MeshFailure, Normals, Shape, cage, field, isosurface};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::camera::MinDistanceView;
use chordal::budget::{
    Bound, Budget, Failure, JobError, Length, Pixels, Reference, Refusal, RefusalCode, Tolerance, View,
};
use chordal::explicit::{Attribute, Semantic, Topology};
use chordal::lod::selection::{HYSTERESIS, SwitchDistances};
use chordal::lod::{self, LodSource, LodSteps};
use chordal::math::{Box3, lesser};
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::{FileSet, Format, Frame, Scene, SceneAssets, WriteError, glb};
use serde_json::{Value, json};
use std::io::Write;
use tileset::TileHierarchy;

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
    /// Additional distances for the table, beside the switch distances and those at which the shape covers
    /// few pixels.
    pub distances: Vec<f64>,
    /// The normals of the triangles.
    pub normals: Normals,
    /// The error that tiles declare.
    pub errors: TileErrors,
    /// The most triangles of a tile: a finest level with more is cut in space. `None` for no tiles.
    pub tile_triangles: Option<u64>,
}

/// The error that tiles declare, by which viewers choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TileErrors {
    /// Large enough that viewers, whose formula holds in the middle of the screen, keep the pixels everywhere
    /// on it.
    #[default]
    Scaled,
    /// The proved error itself.
    Plain,
}

/// How the levels are laid out.
#[derive(Clone, Debug, PartialEq)]
enum LodLayout {
    /// One mesh a level, the finest first.
    Levels(Vec<LevelMesh>),
    /// A hierarchy of tiles over regions.
    Cut(Box<TileHierarchy>),
}

/// One level as it will be written.
#[derive(Clone, Debug, PartialEq)]
struct LevelMesh {
    scene: Scene,
    bound: Bound,
    triangles: u64,
    vertices: u64,
}

/// Levels of detail with their certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct LodOutcome {
    made: LodLayout,
    switches: SwitchDistances,
    spec: LodSpec,
    diagonal: f64,
    /// For the report, and for the file.
    pub certificate: Certificate,
}

/// The diagonals of the box on the screen, in pixels, that get a row in the table.
const COVERED: [f64; 4] = [1000.0, 200.0, 20.0, 2.0];

/// Makes levels of detail of a surface: see [`chordal::lod::chain`].
///
/// The finest level is within `spec.length`, or loses at most `spec.pixels` at `spec.nearest`. Where neither
/// is given, it loses at most that where the box fills the height of the screen. Each level is proved against
/// the shape itself, as it will be written: positions in single precision.
///
/// # Errors
/// As for [`crate::mesh()`]; [`MeshFailure::Usage`] for curves, which have no levels, for parallel rays, and
/// where there would be more than 20,000 tiles.
pub fn lod(input: Input, spec: &LodSpec, job: &Job) -> Result<LodOutcome, MeshFailure> {
    if matches!(input.shape, Shape::Drawing(_) | Shape::Curves(_)) {
        return Err(MeshFailure::Usage("levels of detail are for surfaces, and these are curves".into()));
    }
    if spec.lens.focal_px().is_none() {
        let message =
            "levels change with the distance, which parallel rays do not see: give the view a field of view";
        return Err(MeshFailure::Usage(message.into()));
    }
    let mut certificate = Certificate::from_input(&input);
    let place = input.shape.hull()?;
    let diagonal = input.shape.diagonal()?;
    let finest = finest(&input.shape, spec, &mut certificate)?;
    certificate.budget = Some(BudgetFacts::new(&Budget::length(finest)));
    let frame = *input.shape.frame();
    let from = input.format;
    let assets = match &input.shape {
        Shape::Scene(scene) => {
            let dropped = scene.assets.beside_materials();
            if !dropped.is_empty() {
                let note = format!("levels show triangles alone: left out are {}", dropped.join(", "));
                certificate.notes.push(note.into());
            }
            scene.assets.materials_only()
        }
        _ => SceneAssets::default(),
    };
    // Rounding to single precision is about the same for every level.
    let request = MeshRequest::new(Budget::length(finest), Format::Glb, place);
    let mut inner = request.reserve_rounding(request.rounding())?;
    let has_new_normals = !matches!(spec.normals, Normals::Auto | Normals::Keep);
    let mut maker = LevelMesher { shape: input.shape, notes: Vec::new(), place, has_new_normals, job };
    let triangles = maker.triangles(&mut certificate.notes)?;
    if let Some((_, moved, _)) = &triangles {
        inner = request.with_budget(inner).reserve_rounding(*moved)?;
    }
    let whole = spec.tile_triangles.map_or(usize::MAX, |most| usize::try_from(most).unwrap_or(usize::MAX));
    let mut steps = LodSteps { whole, ..LodSteps::from_finest(inner.length.unwrap_or(finest)) };
    if matches!(maker.shape, Shape::Field(_) | Shape::Volume(_)) {
        steps.share = SHARE_OF_FIELDS;
    }
    let (chain, moved) = match &triangles {
        Some((mesh, moved, topology)) => {
            (lod::chain(LodSource::Triangles(mesh, *topology), &steps, job), *moved)
        }
        None => {
            let mut make = |length: Tolerance| maker.make(length);
            (lod::chain(LodSource::Smooth(&mut make), &steps, job), 0.0)
        }
    };
    let chain = chain.map_err(|stopped| match stopped {
        JobError::Refused(refusal) => MeshFailure::Refused(refusal),
        JobError::Cancelled => MeshFailure::Cancelled,
    })?;
    certificate.notes.append(&mut maker.notes);
    certificate.notes.dedup();
    if let Some(coarsest) = chain.last() {
        certificate.notes.extend(summary_notes(&coarsest.stats));
    }
    let more = Bound::proved(0.0, moved, Reference::InputTriangles);
    let moved = |bound: Bound| if moved > 0.0 { bound.then(&more) } else { bound };
    let looks = LevelShading { normals: spec.normals, from: normals_by(from), frame, assets };
    let is_cut = chain.first().is_some_and(|finest| finest.mesh.faces().len() > whole);
    let made = if is_cut {
        let finest = chain.into_iter().next().map(|level| (level.mesh, moved(level.bound)));
        let (mesh, bound) =
            finest.ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "there is no triangle to show"))?;
        if mesh.faces().len() / whole > MOST_TILES {
            let n = mesh.faces().len();
            let message = format!("{n} triangles in tiles of {whole} are more than {MOST_TILES} files: let ");
            let message = Message::from(message).setting(Setting::TileTriangles).words(" be larger");
            return Err(MeshFailure::Usage(message));
        }
        let cut = TileHierarchy::build(
            Bounded { shape: mesh, bound },
            &looks,
            (whole, &mut certificate.notes),
            job,
        )?;
        LodLayout::Cut(Box::new(cut))
    } else {
        let mut levels: Vec<LevelMesh> = Vec::new();
        for level in chain {
            let mut notes = Vec::new();
            let level = LevelMesh::from_mesh(&level.mesh, moved(level.bound), &looks, &mut notes, job)?;
            certificate.notes.extend(notes.into_iter().filter(|_| levels.is_empty()));
            // Rounding may leave two levels alike.
            if levels.last().is_none_or(|finer| level.error() > finer.error()) {
                levels.push(level);
            }
        }
        LodLayout::Levels(levels)
    };
    let Some(first) = made.finest() else {
        return Err(MeshFailure::refused(RefusalCode::Empty, "there is no triangle to show"));
    };
    certificate.bound = Some(BoundFacts::new(&first.bound));
    let counted = CountedTriangles::from_scene(&first.scene, Format::Glb)?;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    if spec.tile_triangles.is_some() {
        certificate.notes.extend(tileset::unused_note(&first.scene)?);
    }
    let levels = made.counts();
    let errors: Vec<f64> = levels.iter().map(|level| level.at_most).collect();
    let switches = SwitchDistances::new(&errors, spec.lens, spec.pixels);
    if let Some(distance) = switches.distance(0).filter(|d| *d > 0.0 && d.is_finite()) {
        let seen = Budget::pixels(spec.pixels, View::MinDistance(MinDistanceView { distance, ..spec.lens }));
        certificate.notes.extend(too_fine_note(&first.scene, &seen, job)?);
    }
    let mut outcome = LodOutcome { made, switches, spec: spec.clone(), diagonal, certificate };
    outcome.certificate.levels = Some(outcome.facts(levels));
    Ok(outcome)
}

/// The shading of triangles.
struct LevelShading {
    normals: Normals,
    from: Format,
    frame: Frame,
    /// The materials.
    assets: SceneAssets,
}

impl LevelShading {
    /// A level as a scene.
    fn scene(&self, mesh: Mesh) -> Scene {
        Scene { assets: Box::new(self.assets.clone()), ..Scene::from_mesh(NAME, mesh, self.frame) }
    }
}

impl LevelMesh {
    fn from_mesh(
        mesh: &Mesh,
        bound: Bound,
        looks: &LevelShading,
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let request = MeshRequest::new(Budget::default(), Format::Glb, mesh.bounds());
        let Bounded { shape: mesh, bound } = request.snap(mesh, bound, job)?;
        let mut scene = looks.scene(mesh);
        looks.normals.apply(&mut scene, [looks.from, Format::Glb], notes)?;
        let scene = to_file_rows(scene, Format::Glb)?;
        let (triangles, vertices) = counts(&scene);
        Ok(Self { scene, bound, triangles, vertices })
    }

    fn error(&self) -> f64 {
        self.bound.at_most().unwrap_or(f64::INFINITY)
    }
}

/// Triangles, and rows of positions.
fn counts(scene: &Scene) -> (u64, u64) {
    scene.parts.iter().fold((0, 0), |(t, v), part| {
        (t + part.mesh.faces().len() as u64, v + part.mesh.positions().len() as u64)
    })
}

/// The most leaves of a tree of tiles. Chosen: each is a file, and all are in memory at once.
const MOST_TILES: usize = 20_000;

/// The fraction of the finest error that meshing a field may use. Chosen: half of it takes several times as
/// long to make and to prove.
const SHARE_OF_FIELDS: f64 = 0.8;

/// A descriptive name; a file name would make the bytes depend on a path.
const NAME: &str = "level";

/// How positions are identified when normals are computed: a simplified mesh has indices of its own.
fn normals_by(from: Format) -> Format {
    if from.topology() == Topology::Positions { Format::Obj } else { from }
}

/// The tolerance of the finest level.
fn finest(shape: &Shape, spec: &LodSpec, certificate: &mut Certificate) -> Result<Tolerance, MeshFailure> {
    if let Some(length) = spec.length {
        let asked = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
        let (budget, note) = asked.resolve(shape)?;
        certificate.notes.extend(note);
        return budget
            .length
            .ok_or_else(|| MeshFailure::refused(RefusalCode::Budget, "the budget has no length"));
    }
    let diagonal = shape.diagonal()?;
    let focal = spec.lens.focal_px().unwrap_or(f64::INFINITY);
    let distance = spec.nearest.unwrap_or(diagonal * focal / f64::from(spec.lens.screen.height_px));
    if spec.nearest.is_none() {
        certificate.notes.push(format!(
            "nothing says how near the eye comes: the finest level is for {distance:.6}, where the box fills the height of \
             the screen"
        ).into());
    }
    let view = View::MinDistance(MinDistanceView { distance, ..spec.lens });
    let length = view.length_of(spec.pixels, &shape.hull()?).and_then(|length| Tolerance::new(length).ok());
    length.ok_or_else(|| {
        MeshFailure::refused(
            RefusalCode::TooClose,
            "the shape has no size, or the eye is so close that no length is small enough",
        )
    })
}

/// Makes the triangles of a shape.
struct LevelMesher<'a> {
    shape: Shape,
    notes: Vec<Message>,
    place: Box3,
    /// Whether normals are recomputed, so that existing ones preserve no edge.
    has_new_normals: bool,
    job: &'a Job,
}

impl LevelMesher<'_> {
    /// The triangles of a triangle shape as one mesh, how far its transforms moved it, and how rows are tied.
    fn triangles(&mut self, notes: &mut Vec<Message>) -> Result<Option<(Mesh, f64, Topology)>, MeshFailure> {
        let Shape::Scene(scene) = &mut self.shape else { return Ok(None) };
        let placed = flatten::flatten(std::mem::take(scene))?;
        notes.extend(placed.note());
        let TransformedScene { mut scene, moved_at_most, .. } = placed;
        if self.has_new_normals {
            without_normals(&mut scene)?;
        }
        let is_blended = |attribute: &Attribute| matches!(attribute.semantic, Semantic::Blended(_));
        if scene.parts.iter().any(|part| part.mesh.attributes().iter().any(is_blended)) {
            notes.push("levels are of meshes at rest: skins and morph targets were left out".into());
            without(&mut scene, |semantic| matches!(semantic, Semantic::Blended(_)))?;
        }
        let shown = scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()).count();
        if shown == 0 {
            return Err(MeshFailure::refused(RefusalCode::Empty, "there is no triangle to make levels of"));
        }
        if scene.parts.len() == 1 && flatten::n_places(&scene) == 1 {
            let part = scene.parts.into_iter().next();
            return Ok(part.map(|part| {
                let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
                (part.mesh, moved_at_most, topology)
            }));
        }
        notes.push(format!("{shown} parts were put together").into());
        let meshes: Vec<Mesh> =
            scene.world_meshes()?.into_iter().map(|(_, mesh)| mesh.into_owned()).collect();
        let MergedMesh { mesh, is_partial } = merge(&meshes.iter().collect::<Vec<_>>())?;
        if is_partial {
            notes.push("what only some of the parts carry at their vertices was left out".into());
        }
        Ok(Some((mesh, moved_at_most, Topology::Indices)))
    }

    /// Triangles within a tolerance of a smooth shape, at full precision.
    fn make(&mut self, length: Tolerance) -> Result<Bounded<Mesh>, JobError> {
        let budget = Budget::length(length);
        // A format that keeps every digit.
        let request = MeshRequest::new(budget, Format::Ply, self.place);
        let job = self.job;
        let made = match &self.shape {
            Shape::Patches { patches, .. } => {
                return convert::patches_to_mesh(patches, &budget, job).or_else(Failure::best_effort);
            }
            Shape::Cage(polygons) => cage::limit_surface(polygons, &request, job),
            Shape::Volume(sampled) => {
                isosurface::mesh_volume(sampled, &request.widened(), &mut self.notes, job)
            }
            Shape::Field(field) => field::mesh_field(field, &request.widened(), &mut self.notes, job),
            _ => Err(MeshFailure::refused(RefusalCode::Unsupported, "this shape has no levels")),
        };
        let (scene, bound) = made.map_err(|failure| match failure {
            MeshFailure::Cancelled => JobError::Cancelled,
            MeshFailure::Refused(refusal) => JobError::Refused(refusal),
            other => JobError::Refused(Refusal::new(RefusalCode::Unsupported, other.message())),
        })?;
        let mesh = flatten::one_mesh(&scene).map(|mesh| mesh.into_owned());
        let mesh = mesh
            .map_err(|error| JobError::Refused(Refusal::new(RefusalCode::Unsupported, error.to_string())))?;
        Ok(Bounded { shape: mesh, bound })
    }
}

impl LodLayout {
    /// The finest level, as it will be written where it is one mesh.
    fn finest(&self) -> Option<&LevelMesh> {
        match self {
            Self::Levels(levels) => levels.first(),
            Self::Cut(cut) => Some(&cut.finest),
        }
    }

    /// The levels to choose from.
    fn counts(&self) -> Vec<LevelFacts> {
        let of = |level: &LevelMesh| LevelFacts {
            triangles: level.triangles,
            vertices: level.vertices,
            at_least: level.bound.at_least(),
            at_most: level.error(),
            evidence: level.bound.evidence().as_str(),
            distance: None,
            tiles: 1,
        };
        match self {
            Self::Levels(levels) => levels.iter().map(of).collect(),
            Self::Cut(cut) => cut.counts(),
        }
    }
}

impl LodOutcome {
    /// A level as it will be written, the finest first, with its bound; `None` where the finest level is cut
    /// in space, and beyond the last one.
    #[must_use]
    pub fn level(&self, k: usize) -> Option<(&Scene, &Bound)> {
        let LodLayout::Levels(levels) = &self.made else { return None };
        levels.get(k).map(|level| (&level.scene, &level.bound))
    }

    fn facts(&self, mut levels: Vec<LevelFacts>) -> LevelsFacts {
        let lens = &self.spec.lens;
        for (k, level) in levels.iter_mut().enumerate() {
            level.distance = self.switches.distance(k).filter(|distance| distance.is_finite());
        }
        let covers = |distance: f64| lens.focal_px().map_or(0.0, |focal| self.diagonal * focal / distance);
        let mut distances: Vec<f64> = self.spec.distances.clone();
        distances.extend(levels.iter().filter_map(|level| level.distance));
        distances.extend(
            lens.focal_px().into_iter().flat_map(|focal| COVERED.map(|px| self.diagonal * focal / px)),
        );
        distances.retain(|distance| *distance > 0.0 && distance.is_finite());
        distances.sort_by(f64::total_cmp);
        distances.dedup();
        let shown = distances
            .into_iter()
            .map(|distance| {
                let shown = self.switches.at(distance, None);
                LevelChoiceFacts {
                    distance,
                    covers_px: covers(distance),
                    level: shown.level,
                    triangles: levels[shown.level].triangles,
                    pixels: shown.pixels,
                }
            })
            .collect();
        let nearest =
            self.switches.distance(0).filter(|d| *d > 0.0 && d.is_finite()).unwrap_or(lens.distance);
        let view = ViewFacts::new(&View::MinDistance(MinDistanceView { distance: nearest, ..*lens }));
        LevelsFacts { pixels: self.spec.pixels.get(), view, hysteresis: HYSTERESIS, levels, shown }
    }

    /// Writes all levels as one glTF with `MSFT_lod`, binary or as JSON with all in it.
    ///
    /// # Errors
    /// As for [`glb::write_levels`]; [`WriteError::Unsupported`] for other formats than glTF, and where the
    /// finest level is cut in space.
    pub fn write(&self, format: Format, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificates = self.level_certificates();
        let levels = self.gltf_levels(&certificates)?;
        match format {
            Format::Glb => glb::write_levels(&levels, out),
            Format::Gltf => glb::write_levels_embedded(&levels, out),
            other => Err(WriteError::Unsupported(format!("{other} holds no levels of detail"))),
        }
    }

    /// Writes all levels as a glTF called `stem` with its buffer and pictures beside it.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'static>, WriteError> {
        let certificates = self.level_certificates();
        let levels = self.gltf_levels(&certificates)?;
        glb::write_levels_files(&levels, stem).map(FileSet::into_owned)
    }

    /// The extras of each level, where each is one mesh.
    fn level_certificates(&self) -> Vec<Value> {
        let LodLayout::Levels(made) = &self.made else { return Vec::new() };
        made.iter().map(|level| file_extras(&self.certificate, level)).collect()
    }

    fn gltf_levels<'a>(&'a self, certificates: &'a [Value]) -> Result<Vec<glb::GlbLevel<'a>>, WriteError> {
        let LodLayout::Levels(made) = &self.made else {
            return Err(WriteError::Unsupported(
                "what is cut in space is a tileset, not one file".to_owned(),
            ));
        };
        let levels = made.iter().zip(certificates).zip(self.coverages(made.len()));
        let level = |((level, certificate), coverage): ((&'a LevelMesh, &'a Value), f64)| glb::GlbLevel {
            scene: &level.scene,
            certificate: Some(certificate),
            coverage,
        };
        Ok(levels.map(level).collect())
    }

    /// The fraction of the screen that the bounding sphere covers where each level gives way to the next:
    /// viewers use its centre, which may be half a diagonal behind the side of the box.
    fn coverages(&self, n_levels: usize) -> Vec<f64> {
        let lens = &self.spec.lens;
        let pixels = f64::from(lens.screen.width_px) * f64::from(lens.screen.height_px);
        let mut before = f64::INFINITY;
        (0..n_levels)
            .map(|k| {
                let next = self.switches.distance(k + 1).filter(|d| d.is_finite());
                let Some((distance, focal)) = next.zip(lens.focal_px()) else { return 0.0 };
                let across = self.diagonal * focal / (distance + 0.5 * self.diagonal);
                let share = 0.25 * std::f64::consts::PI * across * across / pixels;
                // Fractions decrease from level to level, also where the shape is larger than the screen.
                let most = if before <= 1.0 { 0.99 * before } else { 1.0 };
                before = lesser(share, most);
                before
            })
            .collect()
    }
}

/// The extras of one mesh in its file.
fn file_extras(certificate: &Certificate, made: &LevelMesh) -> Value {
    json!({
        "version": certificate.version,
        "input": certificate.input,
        "bound": BoundFacts::new(&made.bound),
        "output": { "triangles": made.triangles, "vertices": made.vertices },
    })
}
