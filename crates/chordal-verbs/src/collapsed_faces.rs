//! Drops the triangles that have the same corner twice, for formats that forbid them.
use crate::MeshFailure;
use crate::max_bound::max_bound;
use crate::placements::part_scales;
use chordal::budget::{Bound, Reference};
use chordal::explicit::Topology;
use chordal::{Job, mend};
use chordal_io::Scene;

/// Drops such triangles from a scene whose rows are those of its file. Returns a bound for how far the surface moved: 0 if
/// other triangles have the edges that they covered.
pub(crate) fn drop_collapsed_faces(scene: &mut Scene) -> Result<Bound, MeshFailure> {
    let stretch = part_scales(scene);
    let mut bound = Bound::exact(Reference::InputTriangles);
    for (part, stretch) in scene.parts.iter_mut().zip(stretch) {
        let mended = mend::drop_collapsed(&part.mesh, Topology::Indices, &Job::default())?;
        if !mended.is_unchanged() {
            bound = max_bound(bound, &mended.bound, stretch)?;
            part.mesh = mended.mesh;
        }
    }
    Ok(bound)
}
