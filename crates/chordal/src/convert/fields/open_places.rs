//! Groups the faces and boxes that a proof left open into the places that a bound lists.
use super::contacts::ContactSearch;
use crate::budget::{Job, OpenPlace, OpenPlaces};
use crate::check::SandwichVerdict;
use crate::explicit::Mesh;
use crate::implicit::{Csg, Expr};
use crate::math::{Box3, cross, difference, length};

/// A place with some of its points, from which contacts are searched.
type PlaceWithPoints = (OpenPlace, Vec<[f64; 3]>);

/// The places that a verdict left open: connected sets of open faces, and boxes in which a part of the surface may be
/// missed; with contacts of the sign's primitives there.
pub(in crate::convert) fn open_places(
    mesh: &Mesh,
    verdict: &SandwichVerdict,
    sign: &Expr,
    job: &Job,
) -> OpenPlaces {
    let mut faces: Vec<u32> = verdict.open.iter().flatten().copied().collect();
    faces.sort_unstable();
    faces.dedup();
    let mut places = places_of_faces(mesh, &faces);
    places.extend(
        touching(verdict.unresolved.clone()).iter().map(|bounds| (place(bounds, 0.0), points_of(bounds))),
    );
    let at_points =
        verdict.wrong.iter().map(|probe| OpenPlace { at: probe.at, size: 0.0, area: 0.0, contact: None });
    places.extend(at_points.map(|place| (place, Vec::new())));
    let total_area = (0..mesh.faces().len() as u32).map(|face| area(mesh, face)).sum();
    let csg = Csg::from_expr(sign);
    let search = ContactSearch::new(&csg, sign, job);
    // Contacts are searched only for the places that are listed.
    let mut by_size: Vec<usize> = (0..places.len()).collect();
    by_size.sort_by(|a, b| places[*b].0.size.total_cmp(&places[*a].0.size));
    for number in by_size.into_iter().take(OpenPlaces::MOST) {
        let (place, points) = &mut places[number];
        place.contact = search.contact(place, points);
    }
    OpenPlaces::new(places.into_iter().map(|(place, _)| place).collect(), total_area)
}

/// The most boxes that are grouped; if there are more, all are one place. Chosen: some milliseconds.
const MOST_BOXES: usize = 4096;

/// The bounding boxes of groups of touching boxes.
fn touching(mut boxes: Vec<Box3>) -> Vec<Box3> {
    if boxes.len() > MOST_BOXES {
        return vec![boxes.into_iter().fold(Box3::EMPTY, |hull, bounds| hull.union(bounds))];
    }
    let mut done: Vec<Box3> = Vec::new();
    while let Some(mut hull) = boxes.pop() {
        // Boxes that were apart may touch the hull once it has grown.
        loop {
            let n = boxes.len();
            boxes.retain(|other| {
                let touches = (0..3).all(|k| other.min[k] <= hull.max[k] && hull.min[k] <= other.max[k]);
                if touches {
                    hull = hull.union(*other);
                }
                !touches
            });
            if boxes.len() == n {
                break;
            }
        }
        done.push(hull);
    }
    done
}

/// The middle and the corners of a box.
fn points_of(bounds: &Box3) -> Vec<[f64; 3]> {
    let corner =
        |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { bounds.max[axis] } else { bounds.min[axis] });
    std::iter::once(bounds.centre()).chain((0..8).map(corner)).collect()
}

/// The most points taken from the faces of a place. Chosen: enough for all points of few large faces.
const MOST_POINTS: usize = 64;

/// One place for each set of faces that are connected by vertices.
fn places_of_faces(mesh: &Mesh, faces: &[u32]) -> Vec<PlaceWithPoints> {
    let mut parts = VertexSets { parent: (0..mesh.positions().len() as u32).collect() };
    for face in faces {
        let [a, b, c] = mesh.faces()[*face as usize];
        parts.join(a, b);
        parts.join(a, c);
    }
    let mut of_part: Vec<(u32, u32)> =
        faces.iter().map(|face| (parts.root(mesh.faces()[*face as usize][0]), *face)).collect();
    of_part.sort_unstable();
    let place_of = |part: &[(u32, u32)]| {
        let corners = part.iter().flat_map(|(_, face)| mesh.corners(*face as usize));
        let bounds = Box3::from_points(&corners.collect::<Vec<_>>());
        let place = place(&bounds, part.iter().map(|(_, face)| area(mesh, *face)).sum());
        let points = part.iter().flat_map(|(_, face)| points_of_face(mesh.corners(*face as usize)));
        let every = (POINTS_OF_FACE * part.len()).div_ceil(MOST_POINTS);
        (place, points.step_by(every).collect())
    };
    of_part.chunk_by(|a, b| a.0 == b.0).map(place_of).collect()
}

const POINTS_OF_FACE: usize = 7;

/// The corners of a triangle, the middles of its sides, and its centroid.
fn points_of_face([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; POINTS_OF_FACE] {
    let middle = |points: &[[f64; 3]]| {
        [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64)
    };
    [a, b, c, middle(&[a, b]), middle(&[b, c]), middle(&[c, a]), middle(&[a, b, c])]
}

fn place(bounds: &Box3, area: f64) -> OpenPlace {
    OpenPlace { at: bounds.centre(), size: bounds.diagonal(), area, contact: None }
}

fn area(mesh: &Mesh, face: u32) -> f64 {
    let [a, b, c] = mesh.corners(face as usize);
    0.5 * length(cross(difference(b, a), difference(c, a)))
}

/// Disjoint sets of vertices.
struct VertexSets {
    parent: Vec<u32>,
}

impl VertexSets {
    fn root(&mut self, vertex: u32) -> u32 {
        let mut v = vertex;
        while self.parent[v as usize] != v {
            let parent = self.parent[v as usize];
            self.parent[v as usize] = self.parent[parent as usize];
            v = self.parent[v as usize];
        }
        v
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
