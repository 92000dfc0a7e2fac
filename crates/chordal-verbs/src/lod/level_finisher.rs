//! `LevelFinisher`: levels as they will be written, with their normals and rounded.
use super::LodSpec;
use crate::file_rows::to_file_rows;
use crate::rounded_mesh::snap_with_bound;
use crate::{MeshFailure, Normals};
use chordal::budget::Bound;
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::explicit::Topology;
use chordal::{Bounded, Job, Mesh};
use chordal_io::{Format, Frame, Part, Scene, SceneAssets};

/// What every level gets: normals, the frame, materials.
pub(super) struct LevelFinisher {
    normals: Normals,
    /// How far attributes may go off.
    pub attributes: AttributeLimits,
    from: Format,
    frame: Frame,
    /// The materials.
    assets: SceneAssets,
}

impl LevelFinisher {
    pub fn new(spec: &LodSpec, from: Format, frame: Frame, assets: SceneAssets) -> Self {
        let LodSpec { normals, attributes, .. } = *spec;
        Self { normals, attributes, from: normals_by(from), frame, assets }
    }

    /// A mesh as a scene of its own.
    pub fn scene(&self, mesh: Mesh) -> Scene {
        Scene { assets: Box::new(self.assets.clone()), ..Scene::from_mesh(NAME, mesh, self.frame) }
    }

    /// Sets the normals of a scene, and adds a note.
    pub fn apply_normals(&self, scene: &mut Scene, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
        self.normals.apply(scene, [self.from, Format::Glb], notes)
    }

    /// A level of a part as glTF holds it: with its normals, rounded, in the rows of the file.
    pub fn finish(
        &self,
        part: Part,
        bound: Bound,
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Bounded<Part>, MeshFailure> {
        let Bounded { shape: mesh, bound } = snap_with_bound(&part.mesh, bound, Format::Glb, None, job)?;
        let mut scene = Scene { parts: vec![Part { mesh, ..part }], frame: self.frame, ..Scene::default() };
        self.apply_normals(&mut scene, notes)?;
        let shape = to_file_rows(scene, Format::Glb)?.parts.remove(0);
        Ok(Bounded { shape, bound })
    }
}

/// A descriptive name; a file name would make the bytes depend on a path.
pub(super) const NAME: &str = "shape";

/// How positions are identified when normals are computed: a simplified mesh has indices of its own.
fn normals_by(from: Format) -> Format {
    if from.topology() == Topology::Positions { Format::Obj } else { from }
}
