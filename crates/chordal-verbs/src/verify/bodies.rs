//! Triangles of several shapes of a script, each shape against its own.
use super::bound_judge::{BoundJudge, JudgedBound, JudgedMesh, conclude, unable};
use crate::{ImplicitShape, MeshFailure, field};
use chordal::Mesh;
use chordal::budget::Bound;
use chordal::check::findings::MeshConnectivity;
use chordal::check::{self, Goal};
use chordal::convert::has_meshes;
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::math::{Box3, greater};
use std::collections::BTreeMap;

/// The vertices of a component by which its shape is found. Chosen: a few all over it.
const MOST_VERTICES: usize = 64;

impl BoundJudge<'_> {
    /// The largest distance between a shape and its triangles. Any way to give triangles to shapes is a proof, if each shape
    /// is near its own: then all are near all.
    pub(super) fn against_bodies(
        &self,
        mesh: &JudgedMesh,
        implicit: &ImplicitShape,
        said: &Bound,
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
        let mut whole: Option<Bound> = None;
        for (part, solid) in parts.iter().zip(&solids) {
            if part.faces().is_empty() {
                return unable("the triangles are fewer than the shapes of the script");
            }
            let found = check::field_deviation(part, solid, goal, self.job);
            let own = match conclude(found.map(|found| (found.bound, found.backward)), mesh.moved, said)? {
                JudgedBound::Between(own) => own,
                unable => return Ok(unable),
            };
            whole = Some(match whole {
                None => own,
                Some(before) => field::wider(before, own),
            });
        }
        let Some(whole) = whole else { return unable("there is no shape") };
        // A point that is far from its own triangles may be near others', which reach as far out of their boxes.
        let far = 2.0 * whole.at_most().unwrap_or(f64::INFINITY);
        let is_apart = |(k, own): (usize, &Box3)| boxes[..k].iter().all(|other| gap(own, other) > far);
        if boxes.iter().enumerate().all(is_apart) {
            return Ok(JudgedBound::Between(whole));
        }
        let mut one_end =
            Bound::with_evidence(0.0, whole.at_most(), whole.evidence().clone(), whole.reference);
        one_end.metric = whole.metric;
        Ok(JudgedBound::Between(one_end))
    }
}

/// The largest distance between two boxes along an axis.
fn gap(a: &Box3, b: &Box3) -> f64 {
    let along = |k: usize| greater(b.min[k] - a.max[k], a.min[k] - b.max[k]);
    (0..3).fold(0.0, |most, k| greater(along(k), most))
}

/// For each solid the components of a mesh whose vertices are nearest to its surface. None where a function of one fails.
fn parts_by_solid(mesh: &Mesh, solids: &[Field]) -> Option<Vec<Mesh>> {
    let component_of = MeshConnectivity::new(mesh, Topology::Positions).component_of_faces();
    let mut vertices: BTreeMap<u32, Vec<[f64; 3]>> = BTreeMap::new();
    for (face, component) in component_of.iter().enumerate() {
        vertices.entry(*component).or_default().push(mesh.corners(face)[0]);
    }
    let tapes: Vec<_> = solids.iter().map(Field::tape).collect();
    let mut solid_of = BTreeMap::new();
    for (component, all) in vertices {
        let some: Vec<[f64; 3]> = all.iter().step_by(all.len().div_ceil(MOST_VERTICES)).copied().collect();
        let mut values = vec![0.0; some.len()];
        let mut nearest = (f64::INFINITY, 0);
        for (number, tape) in tapes.iter().enumerate() {
            tape.at(&some, &mut values).ok()?;
            let far = values.iter().fold(0.0, |most, value: &f64| greater(value.abs(), most));
            if far < nearest.0 {
                nearest = (far, number);
            }
        }
        solid_of.insert(component, nearest.1);
    }
    let own = |number: usize| {
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
    (0..solids.len()).map(own).collect()
}
