//! From what a proof left open to the places that a bound lists.
use super::contacts::find_contacts;
use crate::budget::{Job, OpenPlace, OpenPlaces};
use crate::check::SandwichVerdict;
use crate::explicit::Mesh;
use crate::implicit::Csg;
use crate::math::{Box3, cross, difference, length};

/// The connected parts of the faces that a verdict left open, and the boxes in which a part of the surface may be missed,
/// and how primitives touch there.
pub(in crate::convert) fn open_places(
    mesh: &Mesh,
    verdict: &SandwichVerdict,
    csg: &Csg,
    job: &Job,
) -> OpenPlaces {
    let mut faces: Vec<u32> = verdict.open.iter().flatten().copied().collect();
    faces.sort_unstable();
    faces.dedup();
    let mut places = places_of_faces(mesh, &faces);
    places.extend(touching(verdict.unresolved.clone()).iter().map(|bounds| place(bounds, 0.0)));
    let at_points =
        verdict.wrong.iter().map(|probe| OpenPlace { at: probe.at, size: 0.0, area: 0.0, contact: None });
    places.extend(at_points);
    let whole = (0..mesh.faces().len() as u32).map(|face| area(mesh, face)).sum();
    let mut open = OpenPlaces::new(places, whole);
    find_contacts(&mut open.largest, csg, job);
    open
}

/// The most boxes that are put together by their sides; of more, all are one place. Chosen: some milliseconds.
const MOST_BOXES: usize = 4096;

/// Boxes around those that touch each other.
fn touching(mut boxes: Vec<Box3>) -> Vec<Box3> {
    if boxes.len() > MOST_BOXES {
        return vec![boxes.into_iter().fold(Box3::EMPTY, |all, one| all.union(one))];
    }
    let mut done: Vec<Box3> = Vec::new();
    while let Some(mut whole) = boxes.pop() {
        loop {
            let n = boxes.len();
            boxes.retain(|other| {
                let touches = (0..3).all(|k| other.min[k] <= whole.max[k] && whole.min[k] <= other.max[k]);
                if touches {
                    whole = whole.union(*other);
                }
                !touches
            });
            if boxes.len() == n {
                break;
            }
        }
        done.push(whole);
    }
    done
}

/// One place for each set of faces that hang together by vertices.
fn places_of_faces(mesh: &Mesh, faces: &[u32]) -> Vec<OpenPlace> {
    let mut parts = VertexSets { parent: (0..mesh.positions().len() as u32).collect() };
    for face in faces {
        let [a, b, c] = mesh.faces()[*face as usize];
        parts.join(a, b);
        parts.join(a, c);
    }
    let mut of_part: Vec<(u32, u32)> =
        faces.iter().map(|face| (parts.root(mesh.faces()[*face as usize][0]), *face)).collect();
    of_part.sort_unstable();
    let whole = |part: &[(u32, u32)]| {
        let all = part.iter().flat_map(|(_, face)| mesh.corners(*face as usize));
        let bounds = Box3::from_points(&all.collect::<Vec<_>>());
        place(&bounds, part.iter().map(|(_, face)| area(mesh, *face)).sum())
    };
    of_part.chunk_by(|a, b| a.0 == b.0).map(whole).collect()
}

fn place(bounds: &Box3, area: f64) -> OpenPlace {
    OpenPlace { at: bounds.centre(), size: bounds.diagonal(), area, contact: None }
}

fn area(mesh: &Mesh, face: u32) -> f64 {
    let [a, b, c] = mesh.corners(face as usize);
    0.5 * length(cross(difference(b, a), difference(c, a)))
}

/// Sets of vertices that are joined one by one.
struct VertexSets {
    parent: Vec<u32>,
}

impl VertexSets {
    fn root(&mut self, of: u32) -> u32 {
        let mut v = of;
        while self.parent[v as usize] != v {
            let above = self.parent[v as usize];
            self.parent[v as usize] = self.parent[above as usize];
            v = self.parent[v as usize];
        }
        v
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
