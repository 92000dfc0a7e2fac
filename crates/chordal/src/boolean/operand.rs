//! `Operand`: one mesh of a boolean, ready for the engines and for the check of the result.
use super::failure::BooleanError;
use crate::budget::{Job, JobError};
use crate::check::findings::MeshConnectivity;
use crate::check::{Facing, has_zero_area, self_intersections};
use crate::explicit::{Bvh, Mesh, Topology, WindingMoments, position_id_by_bits};

/// One operand.
pub(super) struct Operand<'a> {
    pub mesh: &'a Mesh,
    /// The distinct positions that faces use.
    pub points: Vec<[f64; 3]>,
    /// Faces with three distinct positions, as rows of `points`.
    pub faces: Vec<[u32; 3]>,
    /// For each of `faces` the face of the mesh.
    pub face_of: Vec<u32>,
    /// Whether every edge has two triangles, which run it both ways, none crosses another, and shells are
    /// wound as their nesting demands: then winding numbers are 0 and 1 alone.
    pub is_simple: bool,
    /// For distances and winding numbers; `None` without faces.
    tree: Option<(Bvh, WindingMoments)>,
}

impl<'a> Operand<'a> {
    pub fn new(number: usize, mesh: &'a Mesh, job: &Job) -> Result<Self, BooleanError> {
        // 1. Rows by position.
        let ids = job.run(|| position_id_by_bits(mesh.positions()));
        let mut row_of = vec![u32::MAX; ids.len()];
        let (mut points, mut faces, mut face_of) = (Vec::new(), Vec::new(), Vec::new());
        for (face, corners) in (0..).zip(mesh.faces()) {
            let [a, b, c] = corners.map(|row| ids[row as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            faces.push([a, b, c].map(|id| {
                let row = &mut row_of[id as usize];
                if *row == u32::MAX {
                    *row = points.len() as u32;
                    // Adding zero makes −0.0 one with 0.0.
                    points.push(mesh.positions()[id as usize].map(|x| x + 0.0));
                }
                *row
            }));
            face_of.push(face);
        }
        if faces.is_empty() {
            return Ok(Self { mesh, points, faces, face_of, is_simple: true, tree: None });
        }
        // 2. Closed, so that there is an inside.
        let bvh = Bvh::build(mesh, job)?;
        let moments = WindingMoments::new(mesh, &bvh);
        if !moments.enclosure(&bvh).is_closed() {
            let found = MeshConnectivity::new(mesh, Topology::Positions).validity();
            let boundary_edges = found.boundary_edges.count;
            return Err(BooleanError::NotClosed { operand: number, boundary_edges });
        }
        let is_simple = is_simple(mesh, job)?;
        Ok(Self { mesh, points, faces, face_of, is_simple, tree: Some((bvh, moments)) })
    }

    /// Whether `p` is inside, exactly; `None` on the surface.
    pub fn contains(&self, p: [f64; 3]) -> Option<bool> {
        let Some((bvh, moments)) = &self.tree else { return Some(false) };
        let winding = moments.enclosure(bvh).inside(p).winding.value;
        (!winding.is_nan()).then_some(winding > 0.0)
    }

    /// A lower bound of the distance of `p` from the triangles.
    pub fn distance_down(&self, p: [f64; 3]) -> f64 {
        let tree = self.tree.as_ref();
        tree.map_or(f64::INFINITY, |(bvh, _)| bvh.closest_distance_down(p).unwrap_or(0.0))
    }
}

/// See [`Operand::is_simple`].
fn is_simple(mesh: &Mesh, job: &Job) -> Result<bool, JobError> {
    let surface = MeshConnectivity::new(mesh, Topology::Positions);
    let components = surface.components();
    let is_sound = |component: &crate::check::Component| {
        component.closed && component.manifold() && component.oriented && component.facing == Facing::Outward
    };
    if !components.iter().all(is_sound) {
        return Ok(false);
    }
    let n_flat = (0..mesh.faces().len()).filter(|face| has_zero_area(mesh.corners(*face))).count();
    Ok(n_flat == 0 && self_intersections(mesh, job)?.count == 0)
}
