//! Turns faces so that neighbours agree on which side is out, and closed pieces have their outside out.
use super::draft::{Draft, Face};
use super::mended::{Mended, begin};
use super::nesting::depths;
use crate::Mesh;
use crate::budget::{Job, Stopped};
use crate::check::{Finding, Witness};
use crate::explicit::{Topology, Twin, Twins};
use crate::math::{difference, dot};

/// Turns faces, piece by piece: a *piece* hangs together by edges with exactly two faces.
///
/// - In each piece neighbours are made to agree. The side that most of its faces show already stays in front, with equal
///   numbers that of its first face.
/// - A closed piece is then turned outwards, or inwards where it is a cavity: where it lies inside an odd number of other
///   closed pieces. Whether it does is decided exactly, at sixteen of its vertices. A piece whose volume rounding cannot
///   tell from 0 stays as it is.
/// - A piece that cannot be made to agree, as a Möbius strip, is left as it was and reported.
///
/// The surface stays: bound 0. The changes are `turned_faces`, and `left_unorientable` with the first face of such a
/// piece. Attributes stay with their corners; normals are not turned, since they say what the file wants to be seen.
///
/// Linear for one piece; O(n log n) for several closed ones.
///
/// # Errors
/// [`Stopped`] by a cancel or the memory limit.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend};
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let inside_out = Mesh::new(corners, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 3, 2]])?;
/// let mended = mend::orient(&inside_out, Topology::Indices, &Job::default())?;
/// assert_eq!(mended.count("turned_faces"), 3);
/// assert!(check::measure(&mended.mesh).signed_volume > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn orient(mesh: &Mesh, topology: Topology, job: &Job) -> Result<Mended, Stopped> {
    begin(mesh, job)?;
    let ids = topology.ids(mesh);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    let mut sides = Sides { turned: vec![false; mesh.faces().len()], pieces: Vec::new() };
    sides.agree(&twins);
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    sides.face_outwards(mesh);
    let mut unorientable = Finding::default();
    for piece in sides.pieces.iter().filter(|piece| !piece.is_orientable) {
        unorientable.add(|| Witness::face(mesh, piece.faces[0]));
    }
    let mut turned = Finding::default();
    for (face, _) in (0..).zip(&sides.turned).filter(|(_, turned)| **turned) {
        turned.add(|| Witness::face(mesh, face));
    }
    let changes = [("left_unorientable", unorientable), ("turned_faces", turned)];
    if changes[1].1.is_none() {
        return Ok(Mended::exact(mesh.clone(), changes));
    }
    let mut draft = Draft::without_faces(mesh);
    for (face, &turned) in (0..).zip(&sides.turned) {
        let kept = Face::kept(mesh, face);
        draft.faces.push(if turned { kept.turned() } else { kept });
    }
    Ok(Mended::exact(draft.finish()?, changes))
}

/// Faces that hang together by edges with two faces.
pub(super) struct Piece {
    /// Ascending.
    pub faces: Vec<u32>,
    is_closed: bool,
    is_orientable: bool,
}

/// Which faces are to be turned.
struct Sides {
    turned: Vec<bool>,
    pieces: Vec<Piece>,
}

impl Sides {
    /// Finds the pieces, and makes the faces of each agree.
    fn agree(&mut self, twins: &Twins) {
        let mut seen = vec![false; self.turned.len()];
        for start in 0..self.turned.len() as u32 {
            if seen[start as usize] || twins.get(3 * start) == Twin::Collapsed {
                continue;
            }
            let piece = self.walk(start, twins, &mut seen);
            let n_turned = piece.faces.iter().filter(|&&face| self.turned[face as usize]).count();
            let all_back = !piece.is_orientable;
            let other_side = 2 * n_turned > piece.faces.len();
            for &face in piece.faces.iter().filter(|_| all_back || other_side) {
                let turned = &mut self.turned[face as usize];
                *turned = !all_back && !*turned;
            }
            self.pieces.push(piece);
        }
    }

    /// The piece of a face, with the faces turned that do not agree with it.
    fn walk(&mut self, start: u32, twins: &Twins, seen: &mut [bool]) -> Piece {
        let mut piece = Piece { faces: vec![start], is_closed: true, is_orientable: true };
        seen[start as usize] = true;
        let mut next = 0;
        while let Some(&face) = piece.faces.get(next) {
            next += 1;
            let turned = self.turned[face as usize];
            for h in 3 * face..3 * face + 3 {
                let (neighbour, wanted) = match twins.get(h) {
                    Twin::Pair(t) => (t / 3, turned),
                    Twin::Flipped(t) => (t / 3, !turned),
                    Twin::Boundary | Twin::Crowded | Twin::Collapsed => {
                        piece.is_closed = false;
                        continue;
                    }
                };
                if !std::mem::replace(&mut seen[neighbour as usize], true) {
                    self.turned[neighbour as usize] = wanted;
                    piece.faces.push(neighbour);
                } else if self.turned[neighbour as usize] != wanted {
                    piece.is_orientable = false;
                }
            }
        }
        piece.faces.sort_unstable();
        piece
    }

    /// Turns the closed pieces whose volume has the wrong sign.
    fn face_outwards(&mut self, mesh: &Mesh) {
        let solid = |piece: &&Piece| piece.is_closed && piece.is_orientable;
        let solids: Vec<&Piece> = self.pieces.iter().filter(solid).collect();
        for (piece, depth) in solids.iter().zip(depths(mesh, &solids)) {
            let is_cavity = depth % 2 == 1;
            if volume_is_negative(mesh, piece, &self.turned).is_some_and(|negative| negative != is_cavity) {
                for &face in &piece.faces {
                    self.turned[face as usize] = !self.turned[face as usize];
                }
            }
        }
    }
}

/// Whether a closed piece encloses a negative volume; `None` where rounding could decide that.
fn volume_is_negative(mesh: &Mesh, piece: &Piece, turned: &[bool]) -> Option<bool> {
    let corners = || piece.faces.iter().map(|&face| (face, mesh.corners(face as usize)));
    let (_, [origin, ..]) = corners().next()?;
    // Halved before the difference, which may exceed the range of f64; in units of the piece's own size.
    let from_origin = |p: [f64; 3]| difference(p.map(|x| 0.5 * x), origin.map(|x| 0.5 * x));
    let reach = corners()
        .flat_map(|(_, c)| c)
        .flat_map(from_origin)
        .fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
    let (mut volume, mut size) = (0.0, 0.0);
    for (face, corners) in corners() {
        let [a, b, c] = corners.map(|p| from_origin(p).map(|x| x / reach));
        let cross = |a: [f64; 3], b: [f64; 3], k: usize| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            (a[i] * b[j] - a[j] * b[i], a[i].abs() * b[j].abs() + a[j].abs() * b[i].abs())
        };
        let terms = [0, 1, 2].map(|k| cross(b, c, k));
        let determinant = dot(a, terms.map(|term| term.0));
        volume += if turned[face as usize] { -determinant } else { determinant };
        size += dot(a.map(f64::abs), terms.map(|term| term.1));
    }
    // Each term has fewer than 16 roundings of half a step, and the sum one for each term; doubled for those of `size`.
    let rounding = (16.0 + piece.faces.len() as f64) * f64::EPSILON * size;
    (volume.abs() > rounding).then_some(volume < 0.0)
}
