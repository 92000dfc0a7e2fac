//! `places_beyond`: where two surfaces are farther apart than a length, face by face.
use super::Pair;
use super::cover::{Cover, Scratch, Terms, cover};
use super::piece::{Piece, larger};
use super::side::Side;
use crate::budget::{Job, Stopped, par_map};
use crate::explicit::Mesh;
use crate::math::add_up;
use std::borrow::Cow;
use std::cell::RefCell;

/// A point of a face that is farther from the other surface than was asked, or may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// The face of its own mesh.
    pub face: u32,
    /// The point, rounded.
    pub at: [f64; 3],
    /// How far it is, rounded up.
    pub distance: f64,
}

/// Faces in one task.
const CHUNK: usize = 512;
/// Halvings of one face before it counts as too far where that is not known.
const MOST_CUTS: u32 = 64;
/// Faces of the other surface under one piece.
const MOST_FACES: usize = 1 << 14;

/// What a look at every face of two surfaces found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Places {
    /// Faces of the first surface, and of the second, with a point that is too far, in the order of the faces.
    pub beyond: [Vec<Beyond>; 2],
    /// Where there are none: no point of either surface is farther than this from the other, proved.
    pub at_most: f64,
}

impl Places {
    /// Whether no face is too far.
    pub fn is_empty(&self) -> bool {
        self.beyond.iter().all(Vec::is_empty)
    }
}

/// For each face of `a` that has a point farther than `length` from `b` the farthest such point that was seen, and
/// the same from `b` to `a`, each in the order of the faces. Where both lists are empty the two-sided distance is at most
/// `length`, proved as by [`super::deviation`]; a face that could not be decided is in its list.
///
/// Cost: less than [`super::deviation`], since nothing is sought that is nearer.
///
/// # Errors
/// As for [`super::deviation`].
pub(crate) fn places_beyond(a: &Mesh, b: &Mesh, length: f64, job: &Job) -> Result<Places, Stopped> {
    job.run(|| {
        let pair = Pair::of([a, b], job)?;
        let Pair { frame, sides: [a, b], moved, reach, .. } = &pair;
        let terms = Terms { enough: pair.limit(length).within(), most_faces: MOST_FACES, reach: *reach };
        let mut at_most = 0.0;
        let beyond = [(a, b, 0), (b, a, 1)].map(|(own, other, which)| {
            let vertices = pair.ask(which, job);
            let chunks: Vec<&[u32]> = vertices.faces.chunks(CHUNK).collect();
            let found = par_map(job, &chunks, |_, faces| {
                let mut scratch = Scratch::default();
                let mut most = 0.0;
                let mut one = |face: &u32| {
                    let corners = own.mesh().faces()[*face as usize].map(|row| vertices.corner(row));
                    let piece = Piece { corners, off: 0.0, known: f64::INFINITY };
                    match look(piece, other, (terms, Find::Farthest), &mut scratch) {
                        Look::Within(up) => {
                            most = larger(most, up);
                            None
                        }
                        Look::Beyond(at, up) => {
                            Some(Beyond { face: *face, at: frame.world(at), distance: frame.length_up(up) })
                        }
                    }
                };
                let found: Vec<Beyond> =
                    if job.is_cancelled() { Vec::new() } else { faces.iter().filter_map(&mut one).collect() };
                (found, most)
            });
            let most = found.iter().fold(0.0, |most, (_, up)| larger(most, *up));
            // Faces that both surfaces have were not asked, and nothing of them was rounded.
            let rounded = !vertices.faces.is_empty() && *moved > 0.0;
            at_most = larger(at_most, if rounded { add_up(most, *moved) } else { most });
            found.into_iter().flat_map(|(found, _)| found).collect()
        });
        let places = Places { beyond, at_most: frame.length_up(at_most) };
        if job.is_cancelled() { Err(Stopped::Cancelled) } else { Ok(places) }
    })
}

/// Faces of the other surface under one piece where a quick answer is worth more.
const FEW_FACES: usize = 512;

/// Which point beyond the length is wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Find {
    /// The first.
    Any,
    Farthest,
}

/// What is known of a piece.
enum Look {
    /// No point is farther than this, which is near enough.
    Within(f64),
    /// A point that is too far, or may be, and how far that may be.
    Beyond([f64; 3], f64),
}

/// Whether all of a piece is proved to be near enough.
fn look(piece: Piece, other: &Side, (terms, find): (Terms, Find), scratch: &mut Scratch) -> Look {
    let mut worst: Option<([f64; 3], f64)> = None;
    let see = |worst: &mut Option<([f64; 3], f64)>, at: [f64; 3], up: f64| {
        if up > terms.enough && worst.is_none_or(|worst| up > worst.1) {
            *worst = Some((at, up));
        }
    };
    piece.corners.iter().for_each(|corner| see(&mut worst, corner.at, corner.up));
    let mut open = vec![piece];
    let (mut cuts, mut most) = (0, 0.0);
    while let Some(mut piece) = open.pop() {
        if find == Find::Any && worst.is_some() {
            break;
        }
        piece.known = piece.bound_by_corners(other, terms.enough);
        if piece.known <= terms.enough {
            most = larger(most, piece.known);
            continue;
        }
        match cover(&piece, other, terms, scratch) {
            Cover::Within(up) if up <= terms.enough => {
                most = larger(most, up);
                continue;
            }
            // What a border of the other surface leaves open adds to it: halves are nearer.
            Cover::Within(_) => {}
            Cover::TooFar(at) => {
                let corner = other.ask(at);
                see(&mut worst, at, corner.up);
            }
            Cover::None => {}
        }
        let halves = if cuts < MOST_CUTS { piece.halves(|at| other.ask(at)) } else { None };
        match halves {
            Some(halves) => {
                cuts += 1;
                see(&mut worst, halves[0].corners[1].at, halves[0].corners[1].up);
                open.extend(halves);
            }
            // Too small, or too many: undecided, so it counts.
            None => {
                let far = piece
                    .corners
                    .iter()
                    .fold(piece.corners[0], |far, c| if c.up > far.up { *c } else { far });
                see(&mut worst, far.at, piece.known);
            }
        }
    }
    worst.map_or(Look::Within(most), |(at, up)| Look::Beyond(at, up))
}

/// A surface against which others are held, many times: one piece of them after the other.
pub(crate) struct Judge<'a> {
    side: Side<'a>,
    scratch: RefCell<Scratch>,
    reach: f64,
}

impl<'a> Judge<'a> {
    /// A judge by a surface.
    ///
    /// # Errors
    /// As for [`crate::explicit::Bvh::build`].
    pub fn new(mesh: Cow<'a, Mesh>, job: &Job) -> Result<Self, Stopped> {
        let reach = mesh.positions().as_flattened().iter().fold(0.0, |most, x| larger(most, x.abs()));
        Ok(Self { side: Side::new(mesh, job)?, scratch: RefCell::default(), reach })
    }

    /// A judge by a surface of a few faces, which nothing can stop.
    pub fn small(mesh: Mesh) -> Option<Self> {
        let job = Job::default().with_threads(1);
        Self::new(Cow::Owned(mesh), &job).ok()
    }

    /// The square of the distance of a point to the surface, up to rounding.
    pub fn distance_sq(&self, at: [f64; 3]) -> f64 {
        self.side.distance_sq(at)
    }

    /// Whether all points of a triangle are within `length` of the surface, proved; `false` where it is not known.
    pub fn has_near(&self, triangle: [[f64; 3]; 3], length: f64) -> bool {
        let corners = triangle.map(|at| self.side.ask(at));
        let reach = triangle.as_flattened().iter().fold(self.reach, |most, x| larger(most, x.abs()));
        let terms = Terms { enough: length, most_faces: FEW_FACES, reach };
        let piece = Piece { corners, off: 0.0, known: f64::INFINITY };
        matches!(look(piece, &self.side, (terms, Find::Any), &mut self.scratch.borrow_mut()), Look::Within(_))
    }
}
