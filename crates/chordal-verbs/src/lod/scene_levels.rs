//! `SceneLevels`: each part of a scene in levels of detail, and the levels of the scene that they form.
use super::level_finisher::{LatticeFit, LevelFinisher};
use super::level_mesh::LevelMesh;
use crate::MeshFailure;
use crate::output::pass_through::rounded_deformation;
use crate::report::AttributeFacts;
use crate::scene::flatten;
use crate::scene::placements;
use crate::scene::shown_parts::ShownParts;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Reference, RefusalCode};
use chordal::check::findings::AttributeDeviation;
use chordal::explicit::Semantic;
use chordal::lod::{LodLevel, ReductionStats};
use chordal::math::{div_up, greater};
use chordal::{Bounded, Job, Mesh};
use chordal_io::glb::{PositionLattice, VertexStorage};
use chordal_io::{Format, Part, Scene};
use std::borrow::Cow;

/// The parts of a scene in levels, in the form in which these will be written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneLevels {
    /// The scene with the finest level of each part.
    pub finest: Scene,
    /// By part: its coarser levels, the finest first.
    pub coarser: Vec<Vec<Part>>,
    /// By part: the bounds of all its levels in its own coordinates, the finest first.
    pub bounds: Vec<Vec<Bound>>,
    /// By part and level: the deviations of attributes with limits.
    attributes: Vec<Vec<Vec<AttributeDeviation>>>,
    /// The levels of the scene, the finest first.
    pub levels: Vec<SceneLevel>,
}

/// A level of the scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneLevel {
    /// By part: its level.
    choice: Vec<usize>,
    /// The bound in the coordinates of the scene.
    pub bound: Bound,
    pub triangles: u64,
    pub vertices: u64,
    /// The deviations of attributes with limits.
    pub attributes: Vec<AttributeFacts>,
}

/// A scene, with levels of its parts at full precision.
pub(super) struct LevelChains {
    /// The nodes, and the other data of the scene. The meshes of its parts are ignored.
    pub scene: Scene,
    /// By part: the largest factor by which its nodes lengthen.
    pub stretch: Vec<f64>,
    /// By part: its levels, the finest first, at least one.
    pub chains: Vec<Vec<LodLevel>>,
    /// By part: the lattice of its positions, one for all of its levels.
    pub lattices: Vec<Option<PositionLattice>>,
    /// The largest distance by which applied transforms have moved a vertex through rounding.
    pub moved_at_most: f64,
    /// The tolerance of the finest level of the scene.
    pub finest: f64,
}

/// A level of the scene with more than this fraction of the triangles of the level before is left out. Chosen: it would save
/// too little.
const WORTH_IT: f64 = 0.8;

/// The most levels of the scene. Defined: 2⁴⁸ between the errors of the finest and the coarsest.
const MOST_LEVELS: usize = 48;

impl SceneLevels {
    /// Rounds the levels of all parts to the precision of glTF, with their normals, and chooses the levels of the scene:
    /// errors double from one to the next, and each part is in its coarsest level within them.
    pub fn new(
        source: LevelChains,
        finisher: &LevelFinisher,
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let LevelChains { scene: mut finest, stretch, chains, lattices, moved_at_most, finest: tolerance } =
            source;
        let moved = Bound::proved(0.0, moved_at_most, Reference::InputTriangles);
        let (mut coarser, mut bounds, mut attributes) = (Vec::new(), Vec::new(), Vec::new());
        let posed = flatten::is_posed(&finest).then(|| finest.clone());
        // From a copy: poses are compared with those of the scene as it was, while its parts are replaced.
        let shown = posed.as_ref().map(ShownParts::new);
        for (number, ((part, mut chain), lattice)) in
            finest.parts.iter_mut().zip(chains).zip(lattices).enumerate()
        {
            let shown = shown.as_ref().filter(|shown| shown.is_posed(number));
            let original = shown.map(|_| part.mesh.clone());
            let pose = shown.zip(original.as_ref()).map(|(shown, before)| PosedLevels {
                shown,
                part: number,
                before,
                stretch: stretch[number],
            });
            if let Some(pose) = &pose {
                // If no simplified level keeps the length in the pose, the mesh itself is the finest level.
                chain.insert(0, unchanged_level(pose.before));
            }
            let (lattice, measured) = match finisher.fit(&part.mesh, &chain, lattice, job)? {
                LatticeFit::Free => (lattice, Vec::new()),
                LatticeFit::Within(measured) => (lattice, measured),
                // The levels of a part have one lattice or none: if one of them exceeds a limit, all stay in single
                // precision.
                LatticeFit::Exceeds => (None, Vec::new()),
            };
            let mut measured = measured.into_iter();
            let storage = finisher.storage(lattice);
            let mut levels: Vec<Bounded<Part>> = Vec::new();
            let mut deviations = Vec::new();
            for level in chain {
                let level_attributes = measured.next().unwrap_or_else(|| {
                    let mut deviations = level.attributes;
                    deviations.iter_mut().for_each(|deviation| add_rounding(deviation, storage.as_ref()));
                    deviations
                });
                let bound = if moved_at_most > 0.0 { level.bound.then(&moved) } else { level.bound };
                let level_part = Part {
                    name: part.name.clone(),
                    mesh: level.mesh,
                    indexed: part.indexed,
                    properties: part.properties.clone(),
                    storage: storage.map(Box::new),
                    marks: part.marks.clone(),
                };
                let mut level = finisher.finish(level_part, bound, notes, job)?;
                if let Some(pose) = &pose {
                    level.bound = pose.bound(&mut level.shape, &level.bound, job)?;
                }
                // Rounding may make two levels equal.
                let is_coarser = |finer: &Bounded<Part>| level.bound.at_most() > finer.bound.at_most();
                if levels.last().is_none_or(is_coarser) {
                    levels.push(level);
                    deviations.push(level_attributes);
                }
            }
            let is_fine = |level: &Bounded<Part>| error_in(&level.bound, stretch[number]) <= tolerance;
            // The mesh itself was inserted for want of a better one; a simplified level within the length replaces
            // it.
            if pose.is_some() && levels.get(1).is_some_and(is_fine) {
                levels.remove(0);
                deviations.remove(0);
            }
            let mut meshes = Vec::with_capacity(levels.len());
            let mut level_bounds = Vec::with_capacity(levels.len());
            for Bounded { shape, bound } in levels {
                meshes.push(shape);
                level_bounds.push(bound);
            }
            if meshes.is_empty() {
                return Err(MeshFailure::refused(RefusalCode::Empty, "there is no triangle to show"));
            }
            *part = meshes.remove(0);
            coarser.push(meshes);
            bounds.push(level_bounds);
            attributes.push(deviations);
        }
        let mut scene_levels = Self { finest, coarser, bounds, attributes, levels: Vec::new() };
        scene_levels.choose_levels(&stretch, tolerance)?;
        Ok(scene_levels)
    }

    fn choose_levels(&mut self, stretch: &[f64], finest: f64) -> Result<(), MeshFailure> {
        let mut tolerance = finest;
        for _ in 0..MOST_LEVELS {
            let choice: Vec<usize> = (0..self.bounds.len())
                .map(|part| {
                    // The coarsest level within the tolerance; if none is, the finest, whose error then is that of
                    // the scene.
                    let fits = |bound: &Bound| error_in(bound, stretch[part]) <= tolerance;
                    self.bounds[part].iter().rposition(fits).unwrap_or(0)
                })
                .collect();
            let is_last = choice.iter().zip(&self.bounds).all(|(level, bounds)| level + 1 == bounds.len());
            let level = self.scene_level(choice, stretch)?;
            // Of two levels with one error only one could ever be shown, since they would switch at one distance.
            let is_new = |finer: &SceneLevel| {
                let fewer = level.triangles as f64 <= WORTH_IT * finer.triangles as f64;
                fewer && level.bound.at_most() > finer.bound.at_most()
            };
            if self.levels.last().is_none_or(is_new) {
                self.levels.push(level);
            }
            if is_last {
                break;
            }
            tolerance *= 2.0;
        }
        Ok(())
    }

    fn scene_level(&self, choice: Vec<usize>, stretch: &[f64]) -> Result<SceneLevel, MeshFailure> {
        let is_alone = choice.len() == 1
            && placements::n_places(&self.finest) == 1
            && placements::is_untransformed(&self.finest);
        let mut most = 0.0;
        let (mut triangles, mut vertices) = (0, 0);
        let mut attributes = Vec::new();
        for (part, level) in choice.iter().enumerate() {
            most = greater(error_in(&self.bounds[part][*level], stretch[part]), most);
            let mesh = &self.part(part, *level).mesh;
            self.attributes[part][*level]
                .iter()
                .for_each(|deviation| AttributeFacts::add(&mut attributes, deviation));
            triangles += mesh.faces().len() as u64;
            vertices += mesh.positions().len() as u64;
        }
        if !most.is_finite() {
            let message = "the transforms of the scene take its coordinates out of range";
            return Err(MeshFailure::refused(RefusalCode::NotFinite, message));
        }
        // Another part may make up for the error of one, so that there is a lower bound only for a single part.
        let bound = match &choice[..] {
            [level] if is_alone => self.bounds[0][*level].clone(),
            _ => Bound::proved(0.0, most, Reference::InputTriangles),
        };
        Ok(SceneLevel { choice, bound, triangles, vertices, attributes })
    }

    fn part(&self, part: usize, level: usize) -> &Part {
        match level.checked_sub(1) {
            None => &self.finest.parts[part],
            Some(k) => &self.coarser[part][k],
        }
    }

    /// A level of the scene in the form in which it will be written.
    pub fn level_mesh(&self, k: usize) -> Option<LevelMesh> {
        let SceneLevel { bound, triangles, vertices, .. } = self.levels.get(k)?.clone();
        Some(LevelMesh { scene: self.scene(k)?.into_owned(), bound, triangles, vertices })
    }

    /// A level of the scene, as a scene.
    pub fn scene(&self, k: usize) -> Option<Cow<'_, Scene>> {
        let choice = &self.levels.get(k)?.choice;
        if choice.iter().all(|level| *level == 0) {
            return Some(Cow::Borrowed(&self.finest));
        }
        let parts = choice.iter().enumerate().map(|(part, level)| self.part(part, *level).clone());
        let Scene { nodes, roots, frame, certificate, groups, assets, packing, stored, .. } = &self.finest;
        Some(Cow::Owned(Scene {
            parts: parts.collect(),
            nodes: nodes.clone(),
            roots: roots.clone(),
            frame: *frame,
            certificate: certificate.clone(),
            groups: groups.clone(),
            assets: assets.clone(),
            packing: *packing,
            stored: *stored,
            ..Scene::default()
        }))
    }
}

/// The levels of a part that a skin poses.
struct PosedLevels<'a> {
    shown: &'a ShownParts<'a>,
    part: usize,
    before: &'a Mesh,
    stretch: f64,
}

impl PosedLevels<'_> {
    /// The bound of a level in its pose, converted to the part's own coordinates, so that the largest stretch turns it back.
    /// Rounds the joints as glTF stores them.
    fn bound(&self, level: &mut Part, own_bound: &Bound, job: &Job) -> Result<Bound, MeshFailure> {
        let mesh = std::mem::take(&mut level.mesh);
        level.mesh = rounded_deformation(mesh, level.storage.as_deref(), Format::Glb)?;
        let most = own_bound.at_most().unwrap_or(f64::INFINITY);
        let moved = self.shown.moved(self.part, [self.before, &level.mesh], most, (None, job))?;
        let in_part = if self.stretch > 0.0 { div_up(moved, self.stretch) } else { moved };
        Ok(if in_part.is_finite() {
            Bound::proved(0.0, in_part, Reference::InputTriangles)
        } else {
            Bound::with_evidence(0.0, None, own_bound.evidence().clone(), Reference::InputTriangles)
        })
    }
}

fn unchanged_level(mesh: &Mesh) -> LodLevel {
    LodLevel {
        mesh: mesh.clone(),
        bound: Bound::proved(0.0, 0.0, Reference::InputTriangles),
        stats: ReductionStats::default(),
        attributes: Vec::new(),
    }
}

/// Adds to a measured deviation the largest error of rounding to a storage.
fn add_rounding(deviation: &mut AttributeDeviation, storage: Option<&VertexStorage>) {
    let Some(storage) = storage else { return };
    let lost = match deviation.semantic {
        Semantic::Normal | Semantic::Tangent => storage.directions.worst_deg(),
        Semantic::TexCoord(_) if storage.has_short_texcoords => VertexStorage::WORST_TEXCOORD,
        _ => 0.0,
    };
    deviation.largest += lost;
    deviation.rms += lost;
}

/// The upper end of a part's bound if its transforms lengthen it by `stretch`.
fn error_in(bound: &Bound, stretch: f64) -> f64 {
    placements::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), stretch)
}
