//! `VertexImage`: for each vertex of the source, a point on a face of the other surface.
use super::surface::{FanSurface, MOST_AROUND, NONE};
use crate::budget::{Job, par_map};
use crate::explicit::closest_on_triangle;
use crate::math::{difference, dot, greater, lesser};
use std::collections::BinaryHeap;

/// A point of a face of the result that is near a point of the source.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexImage {
    /// The face, or [`NONE`] if unknown.
    pub face: u32,
    pub carrier: Carrier,
    /// The point, rounded.
    pub at: [f64; 3],
    /// The squared distance, rounded.
    pub distance_sq: f64,
}

/// The part of its face on which an image lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Carrier {
    Inside,
    /// On an edge, given by its half-edge.
    Edge(u32),
    /// At a corner, given by the half-edge that starts there.
    Corner(u32),
}

impl VertexImage {
    pub const UNKNOWN: Self =
        Self { face: NONE, carrier: Carrier::Inside, at: [0.0; 3], distance_sq: f64::INFINITY };

    /// The nearest point of a face.
    #[inline]
    pub fn on_face(p: [f64; 3], face: u32, surface: &FanSurface) -> Self {
        let corners = surface.corners(face);
        let w = closest_on_triangle(p, corners);
        let at: [f64; 3] =
            std::array::from_fn(|k| w[0] * corners[0][k] + w[1] * corners[1][k] + w[2] * corners[2][k]);
        let offset = difference(p, at);
        let h = 3 * face;
        let carrier = match w.map(|w| w > 0.0) {
            [true, true, true] | [false, false, false] => Carrier::Inside,
            [true, true, false] => Carrier::Edge(h),
            [false, true, true] => Carrier::Edge(h + 1),
            [true, false, true] => Carrier::Edge(h + 2),
            [true, false, false] => Carrier::Corner(h),
            [false, true, false] => Carrier::Corner(h + 1),
            [false, false, true] => Carrier::Corner(h + 2),
        };
        Self { face, carrier, at, distance_sq: dot(offset, offset) }
    }

    /// Moves to nearer faces across the edge or around the corner on which the image lies, as long as there
    /// are any.
    pub fn descend(mut self, p: [f64; 3], surface: &FanSurface) -> Self {
        // Around the same corner once more would find the same faces.
        let mut last = NONE;
        for _ in 0..MOST_STEPS {
            let previous = self;
            match self.carrier {
                Carrier::Inside => break,
                Carrier::Edge(h) => {
                    let across = surface.twin(h);
                    if across != NONE {
                        self.take_nearer(p, across / 3, surface);
                    }
                }
                Carrier::Corner(h) => {
                    let v = surface.start(h);
                    if v == last {
                        break;
                    }
                    last = v;
                    for g in surface.ring(v).take(MOST_AROUND) {
                        if g / 3 != previous.face {
                            self.take_nearer(p, g / 3, surface);
                        }
                    }
                }
            }
            if self.face == previous.face {
                break;
            }
        }
        self
    }

    #[inline]
    fn take_nearer(&mut self, p: [f64; 3], face: u32, surface: &FanSurface) {
        let candidate = Self::on_face(p, face, surface);
        if candidate.distance_sq < self.distance_sq {
            *self = candidate;
        }
    }
}

/// The most faces that one descent visits; on average it visits fewer than two.
const MOST_STEPS: u32 = 64;
/// The images are final once this many of the farthest vertices in a row found nothing nearer. Chosen: an
/// image that stays too far costs tightness or a search, never the proof.
const STAYING: u32 = 64;
/// Vertices in one task.
const CHUNK: usize = 1 << 12;

/// The image of every vertex of `source`, found from a face near it: `near` has a face for each row of the
/// mesh, and `rows` are the corners of the mesh's faces.
pub(super) fn vertex_images(
    source: &FanSurface,
    result: &FanSurface,
    (rows, near): (&[u32], &[u32]),
    job: &Job,
) -> Vec<VertexImage> {
    let vertices: Vec<u32> = (0..source.n_vertices() as u32).collect();
    let chunks: Vec<&[u32]> = vertices.chunks(CHUNK).collect();
    let image = |v: &u32| {
        let face = near[rows[source.outgoing(*v) as usize] as usize];
        if face as usize >= result.n_faces() {
            return VertexImage::UNKNOWN;
        }
        VertexImage::on_face(source.at(*v), face, result).descend(source.at(*v), result)
    };
    let parts = par_map(job, &chunks, |_, part| part.iter().map(image).collect::<Vec<_>>());
    let mut images = parts.concat();
    pass_on(source, result, &mut images);
    images
}

/// Offers each vertex the faces of its neighbours, the farthest first: a descent may end on a sheet that is
/// not the nearest.
fn pass_on(source: &FanSurface, result: &FanSurface, images: &mut [VertexImage]) {
    // Squares are not negative, so their bits sort like the numbers.
    let key = |v: u32, image: &VertexImage| (image.distance_sq.to_bits(), v);
    let known = images.iter().enumerate().filter(|(_, image)| image.face != NONE);
    let mut heap: BinaryHeap<(u64, u32)> = known.map(|(v, image)| key(v as u32, image)).collect();
    let mut staying = 0;
    while staying < STAYING {
        let Some((bits, v)) = heap.pop() else { break };
        // An entry from before the vertex got a nearer image.
        if bits != images[v as usize].distance_sq.to_bits() {
            continue;
        }
        let p = source.at(v);
        let before = images[v as usize];
        for h in source.ring(v) {
            let neighbour = images[source.end(h) as usize];
            if neighbour.face == NONE || neighbour.face == images[v as usize].face {
                continue;
            }
            let other = VertexImage::on_face(p, neighbour.face, result).descend(p, result);
            if other.distance_sq < images[v as usize].distance_sq {
                images[v as usize] = other;
            }
        }
        let now = images[v as usize];
        if now.distance_sq >= before.distance_sq {
            staying += 1;
            continue;
        }
        staying = 0;
        heap.push(key(v, &now));
        // Neighbours that are at least as far may find the same face nearer.
        for h in source.ring(v) {
            let u = source.end(h);
            let image = &mut images[u as usize];
            if image.face == NONE || image.distance_sq <= now.distance_sq {
                continue;
            }
            let p = source.at(u);
            let other = VertexImage::on_face(p, now.face, result).descend(p, result);
            if other.distance_sq < image.distance_sq {
                *image = other;
                heap.push(key(u, &other));
            }
        }
    }
}

/// The largest squared distance of an image.
pub(super) fn largest_distance_sq(images: &[VertexImage]) -> f64 {
    let known = images.iter().filter(|image| image.face != NONE);
    known.fold(0.0, |most, image| greater(most, lesser(image.distance_sq, f64::MAX)))
}
