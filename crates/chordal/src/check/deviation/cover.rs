//! Covers: faces of the other surface that together lie under a whole piece, and the distance of the piece
//! from them.
//!
//! Every vertex has an image in a plane: its two coordinates along axes perpendicular to the piece's normal,
//! rounded, the same number wherever the vertex occurs. Faces and piece have as images the triangles between
//! the images of their corners, and all decisions below are exact for those. Let `S` be faces whose images
//! all have the same orientation or no area, such that a side of one of them whose image meets the inside of
//! the piece's has exactly one neighbour across, wound alike, and that neighbour is in `S` too. Along a path
//! inside the piece's image, the number of images of `S` above a point changes only where the image of a side
//! is crossed. Each such side belongs to two faces of `S` that run along it in opposite directions; so
//! whatever one of them adds there the other subtracts, and faces whose image has no area add and subtract
//! nothing in all. Hence the number is the same at almost every point of the piece's image, and where one
//! face of `S` overlaps its inside, it is 1 or more: together they cover all of it.
//!
//! A side without such a neighbour is accepted if it stays within some depth of the border of the piece's
//! image. Then the same holds for the piece shrunk by the greatest such depth, if one face covers the centre
//! of the inscribed circle. The smaller triangle is the piece scaled about that centre by 1 − depth/radius,
//! so that no point of the piece is farther from it than the share depth/radius of its distance to the
//! centre. This handles surfaces that end at the same line, if rounding puts one end inside the other.
//!
//! So every point of the piece is in the part over some face: the points whose image is in that face's image,
//! a convex polygon on the piece. Its distance to the face is at most that of its farthest corner. The
//! difference between image and truth does not matter to the proof, only to its sharpness. The polygon is
//! clipped in rounded numbers, outwards: see [`ConvexClipper`].
use super::clipper::ConvexClipper;
use super::distance_surface::DistanceSurface;
use super::projection::SubtriangleProjection;
use super::subtriangle::MeshSubtriangle;
use crate::explicit::{Twin, Twins};
use crate::math::{Orientation, greater, orient2d};

/// The result of the search for a cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cover {
    /// No point of the piece is farther than this from the faces under it.
    Within(f64),
    /// This point of the piece is too far from a face under it.
    TooFar([f64; 3]),
    /// The surface ends, folds or branches under the piece, or has too many faces there.
    None,
}

/// The faces visited for the current piece. The table is reused from piece to piece.
#[derive(Default)]
pub(super) struct CoverScratch {
    /// By face: the round in which it was last visited, so that a new round need not clear the table.
    last_visit: Vec<u32>,
    round: u32,
    faces: Vec<u32>,
}

impl CoverScratch {
    /// Starts a new round without visited faces. The table is allocated when it is first needed; the system
    /// commits its pages as they are touched.
    fn start(&mut self, other: &DistanceSurface) {
        if self.last_visit.is_empty() {
            self.last_visit = vec![0; other.mesh().faces().len()];
        }
        self.round += 1;
        self.faces.clear();
    }

    fn visit(&mut self, face: u32) {
        let last_visit = &mut self.last_visit[face as usize];
        if *last_visit != self.round {
            *last_visit = self.round;
            self.faces.push(face);
        }
    }
}

/// The limits of a search for a cover: the distance that suffices, and the most faces under one piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoverLimits {
    pub tolerance: f64,
    pub most_faces: usize,
    /// The largest coordinate of both surfaces.
    pub reach: f64,
}

/// Searches for a cover of `piece` by faces of `other` around the faces nearest to its corners.
pub(super) fn cover(
    piece: &MeshSubtriangle,
    other: &DistanceSurface,
    limits: CoverLimits,
    scratch: &mut CoverScratch,
) -> Cover {
    let Some(view) = SubtriangleProjection::along_normal(piece) else { return Cover::None };
    let mesh = other.mesh();
    let image_of = |face: u32| mesh.corners(face as usize).map(|p| view.project(p));
    // 1. A face of the other surface whose image overlaps the inside of the piece.
    let mut first = None;
    // It must overlap the inside: the number of layers is counted from there.
    for corner in &piece.corners {
        let image = image_of(corner.face);
        let orientation = orient2d(image[0], image[1], image[2]);
        if orientation != Orientation::Flat && view.overlaps(image) {
            first = Some((corner.face, orientation));
            break;
        }
    }
    let Some((first, front)) = first else { return Cover::None };
    // 2. All faces reached from it across edges inside the piece.
    scratch.start(other);
    scratch.visit(first);
    //    ╱╲────────╱╲
    //   ╱  ╲  f2  ╱  ╲       ▪ the piece. It crosses the sides f1|f2 and f2|f3, so the search goes from
    //  ╱ ▪▪▪▪▪▪▪▪▪▪▪▪ ╲      one face to the next; it crosses none of their outer sides, so it ends there.
    // ╱  f1  ╲  ╱  f3  ╲     The list of visited faces is also the queue.
    let clipper = ConvexClipper::new(&view, piece);
    let (mut n_faces, mut most, mut trim) = (0, 0.0, 0.0);
    while n_faces < scratch.faces.len() {
        let face = scratch.faces[n_faces];
        n_faces += 1;
        if n_faces > limits.most_faces {
            return Cover::None;
        }
        let image = image_of(face);
        let orientation = orient2d(image[0], image[1], image[2]);
        // The surface folds back under the piece: layers would cancel, and the count says nothing.
        if orientation == front.flipped() {
            return Cover::None;
        }
        for k in 0..3 {
            let side = [image[k], image[(k + 1) % 3]];
            if !view.crosses(side) {
                continue;
            }
            match across(other.twins(), 3 * face + k as u32) {
                Some(neighbour) => scratch.visit(neighbour),
                // No neighbour, several, or one that is wound the other way: the surface ends here.
                None => trim = greater(trim, view.depth(side)),
            }
        }
        // 3. The distance of that part of the piece that is over this face.
        if orientation != Orientation::Flat {
            let corners = mesh.corners(face as usize);
            // The clipper expects the counter-clockwise image.
            let image =
                if orientation == Orientation::Front { image } else { [image[0], image[2], image[1]] };
            let (far, at) = clipper.farthest(piece, image, &corners);
            let far = piece.with_slack(far);
            if far > limits.tolerance {
                return Cover::TooFar(at);
            }
            most = greater(most, far);
        }
    }
    if trim == 0.0 {
        return Cover::Within(most);
    }
    // 4. The surface ends a little inside the piece: if the centre is covered, so is the part deeper than
    //    that, and every other point is near that part.
    match view.trimmed(trim, piece, scratch.faces.iter().map(|face| image_of(*face))) {
        Some(to_deeper_part) => Cover::Within((most + to_deeper_part).next_up()),
        None => Cover::None,
    }
}

/// The face across a half-edge if there is exactly one and it is wound alike.
fn across(twins: &Twins, half_edge: u32) -> Option<u32> {
    match twins.get(half_edge) {
        Twin::Pair(twin) => Some(twin / 3),
        _ => None,
    }
}
