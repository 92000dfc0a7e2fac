//! Triangles of several shapes of a script, each compared with its own shape.
use super::bound_judge::{BoundJudge, JudgedBound, JudgedMesh, conclude, unable};
use crate::mesh::field;
use crate::{ImplicitShape, MeshFailure};
use chordal::Mesh;
use chordal::budget::Bound;
use chordal::check::findings::MeshConnectivity;
use chordal::check::{self, Goal};
use chordal::convert::has_meshes;
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::math::{Box3, greater};
use std::collections::BTreeMap;

/// The most vertices of a component by which its shape is found. Chosen: a few, spread over all of it.
const MOST_VERTICES: usize = 64;

impl BoundJudge<'_> {
    /// The largest distance between a shape and its triangles. Any assignment of triangles to shapes gives a proof: if each
    /// shape is near its own triangles, all shapes are near all triangles.
    pub(super) fn against_bodies(
        &self,
        mesh: &JudgedMesh,
        implicit: &ImplicitShape,
        claimed: &Bound,
        goal: &Goal,
    ) -> Result<JudgedBound, MeshFailure> {
        let solids = implicit.bodies.iter().map(|body| field::finite(&implicit.of_body(body)));
        let solids: Vec<Field> = match solids.collect() {
            Ok(solids) => solids,
            Err(MeshFailure::Cancelled) => return Err(MeshFailure::Cancelled),
            Err(failure) => return unable(&failure.to_string()),
        };
        if solids.iter().any(has_meshes) {
            return unable("there is no judge of a field with meshes in it");
        }
        let Some(parts) = parts_by_solid(&mesh.mesh, &solids) else {
            return unable("a function of a shape failed");
        };
        let boxes: Vec<Box3> = parts.iter().map(Mesh::bounds).collect();
        let mut total: Option<Bound> = None;
        for (part, solid) in parts.iter().zip(&solids) {
            if part.faces().is_empty() {
                return unable("the triangles are fewer than the shapes of the script");
            }
            let deviation = check::field_deviation(part, solid, goal, self.job);
            let deviation = deviation.map(|deviation| (deviation.bound, deviation.backward));
            let own = match conclude(deviation, mesh.moved, claimed)? {
                JudgedBound::Between(own) => own,
                unable => return Ok(unable),
            };
            total = Some(match total {
                None => own,
                Some(before) => field::wider(before, own),
            });
        }
        let Some(total) = total else { return unable("there is no shape") };
        // A point that is far from its own triangles may be near those of another shape, up to this distance from their box.
        let far = 2.0 * total.at_most().unwrap_or(f64::INFINITY);
        let is_apart = |(k, bounds): (usize, &Box3)| boxes[..k].iter().all(|other| gap(bounds, other) > far);
        if boxes.iter().enumerate().all(is_apart) {
            return Ok(JudgedBound::Between(total));
        }
        let mut one_end =
            Bound::with_evidence(0.0, total.at_most(), total.evidence().clone(), total.reference);
        one_end.metric = total.metric;
        Ok(JudgedBound::Between(one_end))
    }
}

/// The largest distance between two boxes along an axis.
fn gap(a: &Box3, b: &Box3) -> f64 {
    let along = |k: usize| greater(b.min[k] - a.max[k], a.min[k] - b.max[k]);
    (0..3).fold(0.0, |most, k| greater(along(k), most))
}

/// For each solid, the components of a mesh whose vertices are nearest to its surface. `None` if a user's function fails.
fn parts_by_solid(mesh: &Mesh, solids: &[Field]) -> Option<Vec<Mesh>> {
    let component_of = MeshConnectivity::new(mesh, Topology::Positions).component_of_faces();
    let mut vertices: BTreeMap<u32, Vec<[f64; 3]>> = BTreeMap::new();
    for (face, component) in component_of.iter().enumerate() {
        vertices.entry(*component).or_default().push(mesh.corners(face)[0]);
    }
    let tapes: Vec<_> = solids.iter().map(Field::tape).collect();
    let mut solid_of = BTreeMap::new();
    for (component, points) in vertices {
        let samples: Vec<[f64; 3]> =
            points.iter().step_by(points.len().div_ceil(MOST_VERTICES)).copied().collect();
        let mut values = vec![0.0; samples.len()];
        let mut nearest = (f64::INFINITY, 0);
        for (number, tape) in tapes.iter().enumerate() {
            tape.at(&samples, &mut values).ok()?;
            let far = values.iter().fold(0.0, |most, value: &f64| greater(value.abs(), most));
            if far < nearest.0 {
                nearest = (far, number);
            }
        }
        solid_of.insert(component, nearest.1);
    }
    let mesh_of = |number: usize| {
        let (mut positions, mut faces, mut row_of) = (Vec::new(), Vec::new(), BTreeMap::new());
        for (face, component) in component_of.iter().enumerate() {
            if solid_of.get(component) == Some(&number) {
                faces.push(mesh.faces()[face].map(|row| {
                    *row_of.entry(row).or_insert_with(|| {
                        positions.push(mesh.positions()[row as usize]);
                        positions.len() as u32 - 1
                    })
                }));
            }
        }
        Mesh::new(positions, faces).ok()
    };
    (0..solids.len()).map(mesh_of).collect()
}
