//! `LevelFinisher`: levels in the form in which they will be written, with their normals and rounded.
use super::LodSpec;
use crate::output::file_rows::{to_file_rows, unsupported};
use crate::output::format_rounding::snap_with_bound;
use crate::output::format_rounding::{RoundingTarget, limits_left, storage_within};
use crate::simplify::exceeds;
use crate::{MeshFailure, Normals};
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Bound, JobError, Reference, Tolerance};
use chordal::check::findings::{AttributeDeviation, attribute_deviation};
use chordal::explicit::Topology;
use chordal::lod::LodLevel;
use chordal::{Bounded, Job, Mesh};
use chordal_io::glb::{PositionLattice, VertexStorage};
use chordal_io::{Format, Frame, Part, Scene, SceneAssets};

/// The settings that all levels share: normals, the frame, materials.
pub(super) struct LevelFinisher {
    normals: Normals,
    /// The limits on attributes before they are rounded.
    pub attributes: AttributeLimits,
    /// The limits after rounding, as requested.
    requested: AttributeLimits,
    is_quantized: bool,
    from: Format,
    frame: Frame,
    /// The materials.
    assets: SceneAssets,
}

impl LevelFinisher {
    pub fn new(spec: &LodSpec, from: Format, frame: Frame, assets: SceneAssets) -> Self {
        let LodSpec { attributes: requested, packing, .. } = *spec;
        let normals = spec.normals.of_file(from);
        let attributes = attributes_before_rounding(spec);
        let is_quantized = packing.is_quantized;
        Self { normals, attributes, requested, is_quantized, from: normals_by(from), frame, assets }
    }

    /// The storage of a part with positions on that lattice, if numbers are rounded to fewer bits at all.
    pub fn storage(&self, lattice: Option<PositionLattice>) -> Option<VertexStorage> {
        self.is_quantized.then(|| storage_within(lattice, &self.requested))
    }

    /// The deviations of the attributes of levels on a lattice from those of a mesh. Without limits, or without a lattice,
    /// nothing is measured; [`LatticeFit::Exceeds`] if a level exceeds a limit, or it cannot be measured whether it does.
    pub fn fit(
        &self,
        before: &Mesh,
        chain: &[LodLevel],
        lattice: Option<PositionLattice>,
        job: &Job,
    ) -> Result<LatticeFit, MeshFailure> {
        let Some(storage) = self.storage(lattice).filter(|_| lattice.is_some() && self.requested.is_set())
        else {
            return Ok(LatticeFit::Free);
        };
        if before.faces().is_empty() {
            return Ok(LatticeFit::Exceeds);
        }
        let mut measured = Vec::with_capacity(chain.len());
        for level in chain {
            let snapped = RoundingTarget::new(Format::Glb, lattice).snap(&level.mesh)?;
            let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles);
            let after = storage.round_attributes(&snapped.mesh).map_err(unsupported)?;
            let moved = level.bound.clone().then(&step).at_most().and_then(|most| Tolerance::new(most).ok());
            let deviations = match attribute_deviation(before, &after, moved, job) {
                Ok(deviations) => deviations,
                Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
                Err(JobError::Refused(_)) => return Ok(LatticeFit::Exceeds),
            };
            if deviations.iter().any(|deviation| exceeds(&self.requested, deviation)) {
                return Ok(LatticeFit::Exceeds);
            }
            measured.push(deviations);
        }
        Ok(LatticeFit::Within(measured))
    }

    /// A mesh as a scene of its own, with its attributes rounded.
    pub fn scene(&self, mesh: Mesh, storage: Option<VertexStorage>) -> Result<Scene, MeshFailure> {
        let mut scene =
            Scene { assets: Box::new(self.assets.clone()), ..Scene::from_mesh(NAME, mesh, self.frame) };
        for part in &mut scene.parts {
            part.storage = storage.map(Box::new);
            round_attributes(part)?;
        }
        Ok(scene)
    }

    /// Sets the normals of a scene, and adds a note.
    pub fn apply_normals(&self, scene: &mut Scene, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
        self.normals.apply(scene, [self.from, Format::Glb], notes)
    }

    /// A level of a part as glTF stores it: with its normals, rounded, in the rows of the file.
    pub fn finish(
        &self,
        part: Part,
        bound: Bound,
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Bounded<Part>, MeshFailure> {
        let lattice = part.storage.as_ref().and_then(|storage| storage.lattice);
        let target = RoundingTarget::new(Format::Glb, lattice);
        // Positions first: normals are those of the triangles that the file holds, and are rounded after they are
        // computed.
        let Bounded { shape: mesh, bound } = snap_with_bound(&part.mesh, bound, target, None, job)?;
        let mut scene = Scene { parts: vec![Part { mesh, ..part }], frame: self.frame, ..Scene::default() };
        self.apply_normals(&mut scene, notes)?;
        for part in &mut scene.parts {
            round_attributes(part)?;
        }
        let shape = to_file_rows(scene, Format::Glb)?.parts.remove(0);
        Ok(Bounded { shape, bound })
    }
}

/// Whether attributes of levels keep their limits when positions are rounded to a lattice.
pub(super) enum LatticeFit {
    /// There are no limits, or no lattice.
    Free,
    /// They keep the limits: by level, the deviations of the attributes.
    Within(Vec<Vec<AttributeDeviation>>),
    /// They exceed the limits: positions stay in single precision.
    Exceeds,
}

/// The limits on attributes that are left for simplification if values are rounded afterwards.
pub(super) fn attributes_before_rounding(spec: &LodSpec) -> AttributeLimits {
    let limits = spec.attributes;
    if !spec.packing.is_quantized {
        return limits;
    }
    limits_left(limits, &storage_within(None, &limits))
}

/// Rounds the attributes of a part to the precision of its storage.
pub(super) fn round_attributes(part: &mut Part) -> Result<(), MeshFailure> {
    if let Some(storage) = &part.storage {
        part.mesh = storage.round_attributes(&part.mesh).map_err(unsupported)?;
    }
    Ok(())
}

/// A descriptive name; a file name would make the bytes depend on a path.
pub(super) const NAME: &str = "shape";

/// The format that says how positions are identified when normals are computed: a simplified mesh has indices of its own.
fn normals_by(from: Format) -> Format {
    if from.topology() == Topology::Positions { Format::Obj } else { from }
}
