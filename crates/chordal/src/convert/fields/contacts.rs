//! Contacts: places where two primitives of a solid touch without crossing, or where solids meet in an edge only. The
//! displaced copies of a mesh cannot prove the surface there.
use super::field_sampler::FieldSampler;
use crate::budget::{Job, OpenPlace, SurfaceContact};
use crate::implicit::{Csg, Dual, Expr, Tape};
use crate::math::{cross, difference, distance, dot, greater, length};

/// The most primitives near a place that are examined in pairs, the nearest to its middle first. Chosen: enough for all
/// that stand along a wall.
const NEAREST: usize = 32;
/// Pairs are tried from points at which the cosine between their normals is at least this, up to its sign. Chosen: steps
/// from there lead to a contact if there is one, and faces that meet at a right angle are left out.
const TURNED: f64 = 0.3;
/// The most points from which one pair is tried. Chosen: the first may lead to an end of the contact that other parts
/// cover.
const TRIES_OF_PAIR: usize = 3;
/// The most points from which all pairs of a place are tried. Chosen: some milliseconds.
const MOST_TRIES: usize = 64;
/// Primitives touch at a point if both are nearer to it than this fraction of the place's size. Chosen: far above
/// rounding, and small beside the place.
const NEAR: f64 = 1e-3;
/// Their normals are parallel there if the cosine between them is at least this, up to its sign. Chosen: 3 degrees.
const PARALLEL: f64 = 0.9986;

/// The most points from which common edges are searched: a box has twelve edges, and all its corners and the middles of its
/// sides lie on some. Chosen: some ten milliseconds.
const MOST_EDGES: usize = 1024;
/// Steps towards an edge. Chosen: each step of Newton's method doubles the digits.
const STEPS_TO_EDGE: usize = 6;
/// Steps towards a contact. Measured: 2 to 7 lead there from anywhere on a wall beside a cylinder.
const STEPS: usize = 24;
/// Steps end nearer to the contact than this fraction of the place's size. Chosen: far below [`NEAR`].
const ENOUGH: f64 = 1e-9;
/// The step of difference quotients, relative to the place's size. Chosen: larger suffers from bending, smaller from
/// rounding.
const DIFFERENCE: f64 = 1e-5;
/// The damping of the first step, relative to squares of slopes. Chosen: as is usual for Levenberg–Marquardt.
const DAMPING: f64 = 1e-3;
/// The damping grows tenfold if a step leads farther away, up to this. Chosen: with more, steps hardly move.
const MOST_DAMPING: f64 = 1e4;
/// The damping falls to a tenth if a step leads nearer, down to this. Chosen: some damping is needed so that steps do not
/// run along a contact, where slopes are zero.
const LEAST_DAMPING: f64 = 1e-10;

/// Finds where primitives of a solid touch.
pub(super) struct ContactSearch<'a> {
    csg: &'a Csg,
    whole: Tape,
    job: &'a Job,
}

/// The step of Newton's method from a point to a primitive: its length along the normal there; infinite if the function
/// has no slope.
#[derive(Clone, Copy)]
struct PrimitiveFoot {
    distance: f64,
    normal: [f64; 3],
}

/// A primitive near a place, and its steps from the place's points.
type NearPrimitive = (usize, Vec<PrimitiveFoot>);

/// Two primitives, a point from which to search their contact, and the sum of its distances from both.
struct ContactStart {
    distance: f64,
    pair: [usize; 2],
    at: [f64; 3],
}

impl<'a> ContactSearch<'a> {
    /// For the solid of a sign, with its primitives.
    pub fn new(csg: &'a Csg, sign: &Expr, job: &'a Job) -> Self {
        Self { csg, whole: Tape::new(sign), job }
    }

    /// A contact of two primitives in a place, searched from points of the place. Contacts with the same side above and below
    /// are preferred to flush ones.
    pub fn contact(&self, place: &OpenPlace, points: &[[f64; 3]]) -> Option<SurfaceContact> {
        let feet = self.feet_near(place, points);
        let mut flush = None;
        let mut tried: Vec<[usize; 2]> = Vec::new();
        for ContactStart { pair, at, .. } in self.starts(place, points, &feet, |cosine| cosine >= TURNED) {
            if tried.iter().filter(|other| **other == pair).count() >= TRIES_OF_PAIR {
                continue;
            }
            if tried.len() >= MOST_TRIES {
                break;
            }
            tried.push(pair);
            match self.contact_of(place, pair, at) {
                Some(contact) if !contact.is_flush => return Some(contact),
                contact => flush = flush.or(contact),
            }
        }
        let edges =
            self.starts(place, points, &feet, |cosine| cosine < PARALLEL).into_iter().take(MOST_EDGES);
        let mut edges = edges.filter_map(|start| self.edge_contact(place, start.pair, start.at));
        edges.next().or(flush)
    }

    /// The primitives near a place, the nearest first.
    fn feet_near(&self, place: &OpenPlace, points: &[[f64; 3]]) -> Vec<NearPrimitive> {
        let reach =
            |primitive: usize| Some((self.feet(primitive, &[place.at])?[0].distance.abs(), primitive));
        let mut nearest: Vec<(f64, usize)> = (0..self.csg.primitives().len())
            .filter_map(reach)
            .filter(|(distance, _)| *distance <= place.size)
            .collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.truncate(NEAREST);
        let feet = |(_, primitive): (f64, usize)| Some((primitive, self.feet(primitive, points)?));
        nearest.into_iter().filter_map(feet).collect()
    }

    /// Starting points for all pairs of primitives near a place, the nearest first, at which the absolute cosine between the
    /// normals satisfies `is_turned`.
    fn starts(
        &self,
        place: &OpenPlace,
        points: &[[f64; 3]],
        feet: &[NearPrimitive],
        is_turned: impl Fn(f64) -> bool,
    ) -> Vec<ContactStart> {
        let mut starts = Vec::new();
        for (k, (p, of_p)) in feet.iter().enumerate() {
            for (q, of_q) in &feet[k + 1..] {
                if self.csg.primitives()[*p].is_parallel_to(&self.csg.primitives()[*q]) {
                    continue;
                }
                for ((a, b), at) in of_p.iter().zip(of_q).zip(points) {
                    let distance = a.distance.abs() + b.distance.abs();
                    if distance <= place.size && is_turned(dot(a.normal, b.normal).abs()) {
                        starts.push(ContactStart { distance, pair: [*p, *q], at: *at });
                    }
                }
            }
        }
        // The sort is stable: equal distances stay in the order of pairs and points.
        starts.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        starts
    }

    /// A point on both of two primitives that cross, by steps of Newton's method from a start.
    fn crossing_point(&self, [p, q]: [usize; 2], start: [f64; 3]) -> Option<[f64; 3]> {
        (0..STEPS_TO_EDGE).try_fold(start, |at, _| {
            let [a, b] = [self.feet(p, &[at])?[0], self.feet(q, &[at])?[0]];
            let cosine = dot(a.normal, b.normal);
            let square = 1.0 - cosine * cosine;
            // The step in the plane of both normals whose components along them are minus the two distances.
            let [u, v] = [a.distance - cosine * b.distance, b.distance - cosine * a.distance];
            (square > 1.0 - PARALLEL * PARALLEL)
                .then(|| std::array::from_fn(|k| at[k] - (u * a.normal[k] + v * b.normal[k]) / square))
        })
    }

    /// The contact at an edge of two primitives around which two opposite wedges are inside and the others are not, as if two
    /// boxes have only an edge in common.
    fn edge_contact(&self, place: &OpenPlace, pair: [usize; 2], start: [f64; 3]) -> Option<SurfaceContact> {
        let at = self.crossing_point(pair, start)?;
        let [a, b] = self.feet_on(place, pair, at)?;
        let most = NEAR * place.size;
        let in_wedge = |of_p: f64, of_q: f64| -> [f64; 3] {
            let direction: [f64; 3] = std::array::from_fn(|k| of_p * a.normal[k] + of_q * b.normal[k]);
            // Twice as far from the edge as it may be off, so that the points are in the four wedges.
            let scale = 2.0 * most / length(direction);
            std::array::from_fn(|k| at[k] + scale * direction[k])
        };
        let around = [in_wedge(1.0, 1.0), in_wedge(1.0, -1.0), in_wedge(-1.0, -1.0), in_wedge(-1.0, 1.0)];
        let inside: Vec<bool> =
            duals(&self.whole, &around, self.job)?.iter().map(|dual| dual.value < 0.0).collect();
        let is_across = inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1];
        is_across.then_some(SurfaceContact { at, is_flush: false, lines: None })
    }

    /// The steps from a point to two primitives, if it is on both and in the place.
    fn feet_on(&self, place: &OpenPlace, [p, q]: [usize; 2], at: [f64; 3]) -> Option<[PrimitiveFoot; 2]> {
        let [a, b] = [self.feet(p, &[at])?[0], self.feet(q, &[at])?[0]];
        let is_on = greater(a.distance.abs(), b.distance.abs()) <= NEAR * place.size;
        (is_on && distance(at, place.at) <= place.size).then_some([a, b])
    }

    /// The contact of two primitives at the point to which steps from a start lead, if the surface of the solid passes there.
    fn contact_of(&self, place: &OpenPlace, pair: [usize; 2], start: [f64; 3]) -> Option<SurfaceContact> {
        let at = self.touching_point(pair, start, place.size)?;
        let [a, b] = self.feet_on(place, pair, at)?;
        if dot(a.normal, b.normal).abs() < PARALLEL {
            return None;
        }
        let most = NEAR * place.size;
        // Two points on either side, beyond both surfaces.
        let beside = |offset: f64| std::array::from_fn(|k| at[k] + offset * a.normal[k]);
        let points = [at, beside(2.0 * most), beside(-2.0 * most)];
        let [here, above, below] = duals(&self.whole, &points, self.job)?.try_into().ok()?;
        let is_bare = here.value.abs() <= most * length(here.gradient);
        is_bare.then_some(SurfaceContact {
            at,
            is_flush: (above.value < 0.0) != (below.value < 0.0),
            lines: None,
        })
    }

    /// The point at which two primitives touch, by damped steps from a start (Levenberg and Marquardt). They minimize the
    /// distances from both primitives and the sine between their normals. Without the sine, steps from one surface to the other
    /// would approach a contact so slowly that thousands of them would be needed.
    fn touching_point(&self, pair: [usize; 2], start: [f64; 3], size: f64) -> Option<[f64; 3]> {
        let step = DIFFERENCE * size;
        let mut at = start;
        let mut miss = self.misses(pair, &[at], size)?[0];
        let mut damping = DAMPING;
        for _ in 0..STEPS {
            let shifted = [0, 1, 2].map(|k| [0, 1, 2].map(|j| if j == k { at[j] + step } else { at[j] }));
            let moved = self.misses(pair, &shifted, size)?;
            let slopes: [[f64; 5]; 3] =
                std::array::from_fn(|k| std::array::from_fn(|i| (moved[k][i] - miss[i]) / step));
            let down = slopes.map(|slope| dot(slope, miss));
            let mut nearer = None;
            // More damping gives a shorter step that goes more nearly straight downhill.
            while nearer.is_none() && damping <= MOST_DAMPING {
                let damped =
                    |i: usize, j: usize| dot(slopes[i], slopes[j]) + if i == j { damping } else { 0.0 };
                let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| damped(i, j)));
                let next = difference(at, solved(rows, down));
                let next_miss = self.misses(pair, &[next], size).map(|misses| misses[0]);
                nearer = next_miss
                    .filter(|next_miss| length(*next_miss) < length(miss))
                    .map(|next_miss| (next, next_miss));
                damping =
                    if nearer.is_some() { greater(0.1 * damping, LEAST_DAMPING) } else { 10.0 * damping };
            }
            let Some((next, next_miss)) = nearer else { break };
            (at, miss) = (next, next_miss);
            if length(miss) <= ENOUGH * size {
                break;
            }
        }
        Some(at)
    }

    /// By point: its distances from two primitives, and the cross product of their normals, times a size.
    fn misses(&self, [p, q]: [usize; 2], points: &[[f64; 3]], size: f64) -> Option<Vec<[f64; 5]>> {
        let (of_p, of_q) = (self.feet(p, points)?, self.feet(q, points)?);
        let miss = |(a, b): (&PrimitiveFoot, &PrimitiveFoot)| {
            let [x, y, z] = cross(a.normal, b.normal);
            [a.distance, b.distance, size * x, size * y, size * z]
        };
        Some(of_p.iter().zip(&of_q).map(miss).collect())
    }

    /// By point: the step to a primitive; `None` if a leaf fails.
    fn feet(&self, primitive: usize, points: &[[f64; 3]]) -> Option<Vec<PrimitiveFoot>> {
        let tape = self.csg.primitives()[primitive].tape();
        let foot = |Dual { value, gradient }: Dual<f64>| {
            let steep = length(gradient);
            let distance = value / steep;
            if steep > 0.0 && distance.is_finite() {
                PrimitiveFoot { distance, normal: gradient.map(|x| x / steep) }
            } else {
                PrimitiveFoot { distance: f64::INFINITY, normal: [0.0; 3] }
            }
        };
        Some(duals(tape, points, self.job)?.into_iter().map(foot).collect())
    }
}

fn duals(tape: &Tape, points: &[[f64; 3]], job: &Job) -> Option<Vec<Dual<f64>>> {
    FieldSampler { tape, job }.duals(points).ok()
}

/// The solution of three linear equations whose matrix is symmetric, by Cramer's rule; not finite if it is singular.
fn solved(rows: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = rows;
    let [u, v, w] = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, u);
    [u, v, w].map(|row| dot(row, right) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::Field;
    use crate::implicit::shapes::{cuboid, cylinder, sphere};

    /// The contact found in a place around a point, from that point.
    fn contact_near(field: &Field, at: [f64; 3], size: f64) -> Option<SurfaceContact> {
        let csg = Csg::from_expr(field.sign());
        let place = OpenPlace { at, size, area: 1.0, contact: None };
        ContactSearch::new(&csg, field.sign(), &Job::default()).contact(&place, &[at])
    }

    fn assert_is_at(contact: Option<SurfaceContact>, [x, y]: [f64; 2], is_flush: bool) {
        let contact = contact.expect("a contact");
        let distance = length([contact.at[0] - x, contact.at[1] - y]);
        assert!(distance < 1e-6 && contact.is_flush == is_flush, "{contact:?}");
    }

    #[test]
    fn a_post_in_a_tray_is_found_from_far_along_the_wall_that_it_touches() {
        let pocket = cuboid([36.0, 20.0, 15.0]).unwrap().moved([0.0, 0.0, 2.0]).unwrap();
        let tray = cuboid([40.0, 24.0, 15.0]).unwrap().difference(&pocket);
        let whole = tray.union(&cylinder(3.0, 13.0).unwrap().moved([14.0, 7.0, 0.0]).unwrap());
        // The wall is a face of the pocket, whose normal is that of the post.
        let found = contact_near(&whole, [7.9512, 9.9226, 1.0], 23.936);
        assert_is_at(found, [14.0, 10.0], false);
        assert!((found.unwrap().at[2] - 1.0).abs() < 1e-6, "it stays where it was along the contact");
    }

    #[test]
    fn contacts_have_both_sides_alike_and_faces_that_lie_in_one_another_have_not() {
        let block = cuboid([10.0; 3]).unwrap();
        let post = cylinder(3.0, 20.0).unwrap().moved([8.0, 0.0, 0.0]).unwrap();
        assert_is_at(contact_near(&block.union(&post), [5.2, 1.0, 1.0], 6.0), [5.0, 0.0], false);
        let hole = cylinder(2.0, 20.0).unwrap().moved([3.0, 0.0, 0.0]).unwrap();
        assert_is_at(contact_near(&block.difference(&hole), [4.9, 0.5, 1.0], 3.0), [5.0, 0.0], false);
        let bead = sphere(2.0).unwrap().moved([3.0, 0.0, 0.0]).unwrap();
        assert_is_at(contact_near(&block.union(&bead), [4.9, 0.5, 0.2], 3.0), [5.0, 0.0], true);
    }

    #[test]
    fn solids_that_have_an_edge_alone_in_common_touch_there() {
        let block = cuboid([10.0; 3]).unwrap();
        let beside = |x: f64, y: f64| block.union(&block.moved([x, y, 0.0]).unwrap());
        assert_is_at(contact_near(&beside(10.0, 10.0), [4.0, 5.0, 1.0], 12.0), [5.0, 5.0], false);
        assert_is_at(contact_near(&beside(-10.0, 10.0), [0.0, 0.0, 0.0], 17.0), [-5.0, 5.0], false);
        // From the corners and the middles of the sides, as of a place that both boxes are: eleven other edges are as near.
        let whole = beside(10.0, 10.0);
        let csg = Csg::from_expr(whole.sign());
        let place = OpenPlace { at: [5.0, 5.0, 0.0], size: 30.0, area: 1.0, contact: None };
        let sides = [-5.0, 0.0, 5.0];
        let points: Vec<[f64; 3]> =
            sides.iter().flat_map(|x| sides.iter().flat_map(move |y| sides.map(|z| [*x, *y, z]))).collect();
        let found = ContactSearch::new(&csg, whole.sign(), &Job::default()).contact(&place, &points);
        assert_is_at(found, [5.0, 5.0], false);
        // Overlapping, apart, and face to face.
        for (x, y) in [(9.0, 9.0), (11.0, 11.0), (10.0, 3.0)] {
            assert_eq!(contact_near(&beside(x, y), [4.0, 5.0, 1.0], 12.0), None, "{x} {y}");
        }
        let post = cylinder(3.0, 20.0).unwrap();
        assert_eq!(contact_near(&block.union(&post), [3.0, 0.0, 5.0], 6.0), None);
    }

    #[test]
    fn what_crosses_or_is_hidden_in_a_solid_is_no_contact() {
        let block = cuboid([10.0; 3]).unwrap();
        let post = cylinder(3.0, 20.0).unwrap().moved([7.0, 0.0, 0.0]).unwrap();
        assert_eq!(contact_near(&block.union(&post), [5.0, 2.0, 1.0], 6.0), None);
        let beads = [1.0, -1.0].map(|x| sphere(1.0).unwrap().moved([x, 0.0, 0.0]).unwrap());
        assert!(contact_near(&beads[0].union(&beads[1]), [0.1, 0.2, 0.0], 2.0).is_some());
        assert_eq!(contact_near(&block.union(&beads[0]).union(&beads[1]), [0.1, 0.2, 0.0], 2.0), None);
    }
}
