//! `LevelSource`: the triangles of any surface in levels at full precision.
use super::level_finisher::{NAME, attributes_before_rounding};
use super::scene_levels::LevelChains;
use super::{LodParts, LodSpec};
use crate::mesh::isosurface::simplified::job_to_simplify;
use crate::mesh::request::MeshRequest;
use crate::mesh::tessellate::tessellate;
use crate::output::format_rounding::{self, RoundingTarget};
use crate::output::notes::{deformation_notes, reduction_notes};
use crate::scene::drop_attributes::{drop_attributes, drop_normals};
use crate::scene::flatten::{self, TransformedScene};
use crate::scene::merge::{MergedMesh, merge};
use crate::scene::placements;
use crate::{MeshFailure, Normals, OutputForm, Shape};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Budget, JobError, Reference, RefusalCode, Tolerance};
use chordal::explicit::{Semantic, Topology};
use chordal::lod::{self, LodLevel, LodSource, LodSteps, ReductionStats};
use chordal::math::{Box3, add_up};
use chordal::{Bounded, Job, Mesh};
use chordal_io::glb::PositionLattice;
use chordal_io::{Format, Part, Scene, SceneAssets, glb};
use std::collections::BTreeSet;

/// Builds levels of any surface.
pub(super) struct LevelSource<'a> {
    pub spec: &'a LodSpec,
    /// The tolerance of the finest level, rounding to the format included.
    pub finest: Tolerance,
    pub job: &'a Job,
}

/// Levels at full precision.
pub(super) enum SourceLevels {
    /// Levels of each part.
    Chains(Box<LevelChains>),
    /// A finest level that has to be cut in space.
    TooLarge { finest: Box<Bounded<Mesh>>, cut: CutRule, assets: Box<SceneAssets> },
}

impl SourceLevels {
    /// The assets of the scene.
    pub fn assets(&self) -> SceneAssets {
        match self {
            Self::Chains(chains) => (*chains.scene.assets).clone(),
            Self::TooLarge { assets, .. } => (**assets).clone(),
        }
    }
}

/// The rule by which a finest level is cut in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutRule {
    /// The most triangles of a tile.
    pub most: usize,
    /// The lattice of the positions of all tiles, if they have one.
    pub lattice: Option<PositionLattice>,
}

/// The number of triangles at which a level is the last. Chosen: enough for a picture of a few pixels.
const LAST_LEVEL: usize = 64;

/// The least number of triangles at which a level of a part is the last. Defined: a tetrahedron.
const LAST_LEVEL_OF_PART: usize = 4;

/// The fraction of the finest error that meshing a field may use. Chosen: with half of it, meshing and proving take several
/// times as long.
const SHARE_OF_FIELDS: f64 = 0.8;

impl LevelSource<'_> {
    /// Builds levels, and notes the data that they leave out.
    pub fn levels(&self, shape: Shape, notes: &mut Vec<Message>) -> Result<SourceLevels, MeshFailure> {
        let bounds = shape.bounds()?;
        match shape {
            Shape::Scene(scene) => self.of_scene(scene, bounds, notes),
            shape => self.of_smooth_shape(&shape, bounds, notes),
        }
    }

    fn max_tile_triangles(&self) -> usize {
        self.spec.tile_triangles.map_or(usize::MAX, |most| usize::try_from(most).unwrap_or(usize::MAX).max(1))
    }

    fn of_scene(
        &self,
        mut scene: Scene,
        bounds: Box3,
        notes: &mut Vec<Message>,
    ) -> Result<SourceLevels, MeshFailure> {
        if !matches!(self.spec.normals, Normals::Auto | Normals::Keep) {
            // Without the old normals, no edge is kept for them.
            drop_normals(&mut scene, notes)?;
        }
        notes.extend(deformation_notes(&scene));
        let stretch = placements::part_scales(&scene);
        let is_empty = |(part, stretch): (&Part, &f64)| part.mesh.faces().is_empty() || *stretch == 0.0;
        if scene.parts.iter().zip(&stretch).all(is_empty) {
            return Err(MeshFailure::refused(
                RefusalCode::Empty,
                "there are no triangles to build levels from",
            ));
        }
        if self.spec.parts == LodParts::Separate && !self.is_too_large(&scene, &stretch, bounds)? {
            let (mut stretch, mut moved) = (stretch, 0.0);
            if self.spec.tile_triangles.is_some() {
                (scene, moved) = without_motion(scene, notes)?;
                stretch = placements::part_scales(&scene);
            }
            return self.of_parts(PlacedScene { scene, stretch, moved }, bounds, notes);
        }
        let (scene, moved) = without_motion(scene, notes)?;
        self.of_merged_parts(scene, moved, bounds, notes)
    }

    /// Whether the finest level has to be cut in space.
    fn is_too_large(&self, scene: &Scene, stretch: &[f64], bounds: Box3) -> Result<bool, MeshFailure> {
        let most = self.max_tile_triangles();
        let n_faces = |part: &Part| part.mesh.faces().len();
        // Levels never have more triangles than the input, so that nothing has to be simplified to know.
        if scene.parts.iter().map(n_faces).sum::<usize>() <= most {
            return Ok(false);
        }
        let lengths = self.part_lengths(scene, stretch, bounds)?;
        // Otherwise only the finest levels themselves tell, and these are built for the answer alone: of the chain
        // the first level is asked for, after which a limit of 0 triangles ends it.
        let mut remaining = most;
        for (part, length) in scene.parts.iter().zip(lengths) {
            let attributes = attributes_before_rounding(self.spec);
            let finest =
                LodSteps { max_untiled_triangles: 0, attributes, ..LodSteps::from_finest(self.finest) };
            let n = match length {
                Some(length) => {
                    let chain = part_chain(part, &LodSteps { finest: length, ..finest }, self.job)?;
                    chain.first().map_or(0, |level| level.mesh.faces().len())
                }
                None => n_faces(part),
            };
            let Some(fewer) = remaining.checked_sub(n) else { return Ok(true) };
            remaining = fewer;
        }
        Ok(false)
    }

    /// By part: the tolerance of its finest level in its own coordinates, less the rounding; `None` for a part that stays
    /// as it is.
    fn part_lengths(
        &self,
        scene: &Scene,
        stretch: &[f64],
        bounds: Box3,
    ) -> Result<Vec<Option<Tolerance>>, MeshFailure> {
        let lost = format_rounding::worst_rounding(scene, stretch, &self.targets(scene, stretch));
        let request = MeshRequest::new(Budget::length(self.finest), Format::Glb, bounds);
        let remaining = request.reserve_rounding(lost)?.length.unwrap_or(self.finest);
        let length = |((part, stretch), takes_levels): ((&Part, &f64), bool)| {
            let changes = takes_levels && !part.mesh.faces().is_empty();
            if changes { placements::length_in_part(remaining.get(), *stretch) } else { None }
        };
        Ok(scene.parts.iter().zip(stretch).zip(glb::takes_levels(scene)).map(length).collect())
    }

    /// The rounding of each part.
    fn targets(&self, scene: &Scene, stretch: &[f64]) -> Vec<RoundingTarget> {
        let length = format_rounding::length_for_lattice(self.finest.get(), &self.spec.attributes);
        format_rounding::targets(scene, stretch, self.form(), |_| length)
    }

    fn form(&self) -> OutputForm {
        OutputForm { format: Format::Glb, packing: self.spec.packing }
    }

    /// Levels of each part, placed by the nodes of the scene.
    fn of_parts(
        &self,
        PlacedScene { scene, stretch, moved }: PlacedScene,
        bounds: Box3,
        notes: &mut Vec<Message>,
    ) -> Result<SourceLevels, MeshFailure> {
        let n_fixed = glb::takes_levels(&scene).iter().filter(|takes| !**takes).count();
        if n_fixed > 0 {
            let note =
                "parts that morph targets move, or a skin at a node with more than the part, have one level";
            notes.push(format!("{note} ({n_fixed}x)").into());
        }
        let lengths = self.part_lengths(&scene, &stretch, bounds)?;
        // The parts share the number at which a level is the last: the scene is to end at about that many triangles.
        let n_parts = lengths.iter().flatten().count().max(1);
        let stop_at_triangles = (LAST_LEVEL / n_parts).max(LAST_LEVEL_OF_PART);
        let mut stats = ReductionStats::default();
        let mut chains = Vec::with_capacity(scene.parts.len());
        for (part, length) in scene.parts.iter().zip(lengths) {
            let chain = match length {
                Some(length) => {
                    let attributes = attributes_before_rounding(self.spec);
                    let steps = LodSteps { stop_at_triangles, attributes, ..LodSteps::from_finest(length) };
                    part_chain(part, &steps, self.job)?
                }
                None => vec![LodLevel {
                    mesh: part.mesh.clone(),
                    bound: Bound::proved(0.0, 0.0, Reference::InputTriangles),
                    stats: ReductionStats::default(),
                    attributes: Vec::new(),
                }],
            };
            if let Some(coarsest) = chain.last() {
                stats += coarsest.stats;
            }
            chains.push(chain);
        }
        notes.extend(reduction_notes(&stats));
        let finest = self.finest.get();
        let lattices = self.targets(&scene, &stretch).iter().map(|target| target.lattice).collect();
        let chains = LevelChains { scene, stretch, chains, lattices, moved_at_most: moved, finest };
        Ok(SourceLevels::Chains(Box::new(chains)))
    }

    /// Levels of all parts as one mesh.
    fn of_merged_parts(
        &self,
        scene: Scene,
        moved: f64,
        bounds: Box3,
        notes: &mut Vec<Message>,
    ) -> Result<SourceLevels, MeshFailure> {
        let flattened = flatten::flatten(scene)?;
        notes.extend(flattened.note());
        let TransformedScene { scene, moved_at_most, .. } = flattened;
        let moved_at_most = if moved == 0.0 { moved_at_most } else { add_up(moved, moved_at_most) };
        let Scene { frame, assets, .. } = &scene;
        let template = Scene { assets: assets.clone(), ..Scene::from_mesh(NAME, Mesh::default(), *frame) };
        let (mesh, topology) = merged_mesh(scene, notes)?;
        let request = MeshRequest::new(Budget::length(self.finest), self.form(), bounds);
        let inner = request.reserve_rounding(request.rounding())?;
        let inner = request.with_budget(inner).reserve_rounding(moved_at_most)?;
        let steps = self.steps(&inner);
        let chain = lod::chain(LodSource::Triangles(&mesh, topology), &steps, self.job)?;
        // Rounding to a lattice changes attributes, and there is no measurement of them against merged parts.
        let lattice = request.lattice.filter(|_| !self.spec.attributes.is_set());
        self.as_source(template, chain, (moved_at_most, lattice), notes)
    }

    fn of_smooth_shape(
        &self,
        shape: &Shape,
        bounds: Box3,
        notes: &mut Vec<Message>,
    ) -> Result<SourceLevels, MeshFailure> {
        let template = Scene::from_mesh(NAME, Mesh::default(), *shape.frame());
        let request = MeshRequest::new(Budget::length(self.finest), self.form(), bounds);
        let inner = request.reserve_rounding(request.rounding())?;
        let mut steps = self.steps(&inner);
        if matches!(shape, Shape::Field(_) | Shape::Volume(_)) {
            steps.tessellation_share = SHARE_OF_FIELDS;
        }
        // Meshes with as many triangles as can be simplified; if the volume's own lattice gives more, with its own
        // triangles.
        let simplification_job = job_to_simplify(self.job);
        let mut build = |length: Tolerance| {
            if !matches!(shape, Shape::Volume(_)) {
                return tessellate(shape, length, bounds, notes, self.job);
            }
            let before = notes.len();
            match tessellate(shape, length, bounds, notes, &simplification_job) {
                Err(JobError::Refused(refusal)) if refusal.code == RefusalCode::TooManyTriangles => {
                    // The second attempt makes the same notes again.
                    notes.truncate(before);
                    tessellate(shape, length, bounds, notes, self.job)
                }
                result => result,
            }
        };
        let chain = lod::chain(LodSource::Smooth(&mut build), &steps, self.job)?;
        self.as_source(template, chain, (0.0, request.lattice), notes)
    }

    fn steps(&self, budget: &Budget) -> LodSteps {
        let finest = budget.length.unwrap_or(self.finest);
        let max_untiled_triangles = self.max_tile_triangles();
        let attributes = attributes_before_rounding(self.spec);
        LodSteps {
            max_untiled_triangles,
            stop_at_triangles: LAST_LEVEL,
            attributes,
            ..LodSteps::from_finest(finest)
        }
    }

    /// The levels of a single mesh.
    fn as_source(
        &self,
        template: Scene,
        mut chain: Vec<LodLevel>,
        (moved_at_most, lattice): (f64, Option<PositionLattice>),
        notes: &mut Vec<Message>,
    ) -> Result<SourceLevels, MeshFailure> {
        if let Some(coarsest) = chain.last() {
            notes.extend(reduction_notes(&coarsest.stats));
        }
        let most = self.max_tile_triangles();
        if chain.first().is_none_or(|finest| finest.mesh.faces().len() <= most) {
            let finest = self.finest.get();
            let (stretch, chains, lattices) = (vec![1.0], vec![chain], vec![lattice]);
            let chains = LevelChains { scene: template, stretch, chains, lattices, moved_at_most, finest };
            return Ok(SourceLevels::Chains(Box::new(chains)));
        }
        let LodLevel { mesh, bound, .. } = chain.remove(0);
        let moved = Bound::proved(0.0, moved_at_most, Reference::InputTriangles);
        let bound = if moved_at_most > 0.0 { bound.then(&moved) } else { bound };
        let finest = Box::new(Bounded { shape: mesh, bound });
        Ok(SourceLevels::TooLarge { finest, cut: CutRule { most, lattice }, assets: template.assets })
    }
}

/// A scene for which levels are built.
struct PlacedScene {
    scene: Scene,
    /// By part: the largest factor by which its nodes lengthen.
    stretch: Vec<f64>,
    /// The largest distance by which applied transforms have moved a vertex through rounding.
    moved: f64,
}

/// Removes the motion of a scene, and its assets except materials: tiles and merged meshes hold none of them. Parts that a
/// skin or morph targets pose stay in that pose. Also returns the largest distance by which rounding the pose moved a
/// vertex.
fn without_motion(scene: Scene, notes: &mut Vec<Message>) -> Result<(Scene, f64), MeshFailure> {
    let TransformedScene { mut scene, moved_at_most, .. } =
        if flatten::is_posed(&scene) { flatten::flatten(scene)? } else { TransformedScene::unchanged(scene) };
    leave_out_motion(&mut scene, notes)?;
    Ok((scene, moved_at_most))
}

fn leave_out_motion(scene: &mut Scene, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
    let mut dropped: Vec<String> = scene.assets.beside_materials().into_iter().map(str::to_owned).collect();
    dropped.extend(properties_of_nodes(scene));
    let n_marks: usize = scene.parts.iter().map(|part| part.marks.len()).sum();
    dropped.extend((n_marks > 0).then(|| format!("points and lines ({n_marks}x)")));
    scene.parts.iter_mut().for_each(|part| part.marks = Vec::new().into());
    if !dropped.is_empty() {
        let note = format!("these levels show triangles alone: left out are {}", dropped.join(", "));
        notes.push(note.into());
    }
    *scene.assets = scene.assets.materials_only();
    scene.nodes.iter_mut().for_each(|node| {
        if !node.properties.is_empty() {
            node.properties.retain(|key, _| ["translation", "rotation", "scale"].contains(&key.as_str()));
        }
    });
    if scene.parts.iter().any(Part::is_deformed) {
        notes.push("levels are of meshes at rest: skins and morph targets were left out".into());
        drop_attributes(scene, |semantic| matches!(semantic, Semantic::Blended(_)))?;
    }
    Ok(())
}

/// The properties of nodes beside their transforms and assets, by name.
fn properties_of_nodes(scene: &Scene) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (key, value) in scene.nodes.iter().flat_map(|node| &*node.properties) {
        match key.as_str() {
            "translation" | "rotation" | "scale" | "camera" | "skin" | "weights" => {}
            "extensions" => {
                names.extend(value.as_object().into_iter().flat_map(|extensions| extensions.keys().cloned()))
            }
            other => drop(names.insert(format!("{other} of nodes"))),
        }
    }
    names
}

/// The levels of one part.
fn part_chain(part: &Part, steps: &LodSteps, job: &Job) -> Result<Vec<LodLevel>, MeshFailure> {
    let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
    Ok(lod::chain(LodSource::Triangles(&part.mesh, topology), steps, job)?)
}

/// All parts of a scene in world coordinates as one mesh, with the way in which its rows are tied.
fn merged_mesh(mut scene: Scene, notes: &mut Vec<Message>) -> Result<(Mesh, Topology), MeshFailure> {
    if scene.parts.len() == 1 {
        let part = scene.parts.remove(0);
        let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
        return Ok((part.mesh, topology));
    }
    let shown = scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()).count();
    notes.push(format!("{shown} parts were put together").into());
    let meshes: Vec<&Mesh> = scene.parts.iter().map(|part| &part.mesh).collect();
    let MergedMesh { mesh, is_partial } = merge(&meshes)?;
    if is_partial {
        notes.push("vertex attributes that only some of the parts have were left out".into());
    }
    Ok((mesh, Topology::Indices))
}
