//! Contacts: places where two primitives of a solid touch without crossing, or where solids meet in an edge alone, which no
//! displaced copy of a mesh goes around.
use super::field_sampler::FieldSampler;
use crate::budget::{Job, OpenPlace, SurfaceContact};
use crate::implicit::{Csg, Dual, Expr, Tape};
use crate::math::{cross, difference, dot, greater, length};

/// The primitives of a place that are looked at in pairs: those nearest to its middle. Chosen: a place as long as a wall has
/// all that stand along it.
const NEAREST: usize = 32;
/// Pairs are tried from points where the cosine between their normals is as far from 0 as this. Chosen: steps from there lead
/// to a contact if there is one, and faces that meet at a right angle are left out.
const TURNED: f64 = 0.3;
/// The most points from which one pair is tried. Chosen: the first may lie at the end of a contact, where others hide it,
const TRIES_OF_PAIR: usize = 3;
/// and the most of all pairs of a place. Chosen: some milliseconds.
const MOST_TRIES: usize = 64;
/// Primitives touch where both are nearer than this fraction of the place's size to one point,
const NEAR: f64 = 1e-3;
/// and the cosine between their normals there is as far from 0 as this: 3 degrees.
const PARALLEL: f64 = 0.9986;

/// The most starts from which edges are looked for: a box has twelve, and all its corners and the middles of its sides lie on
/// some. Chosen: some ten milliseconds.
const MOST_EDGES: usize = 1024;
/// Steps towards an edge: those of Newton's method double the digits.
const STEPS_TO_EDGE: usize = 6;
/// Steps towards a contact. Measured: 2 to 7 lead there from anywhere on a wall beside a cylinder.
const STEPS: usize = 24;
/// They end nearer than this fraction of the place's size. Chosen: far below [`NEAR`].
const ENOUGH: f64 = 1e-9;
/// The differences that stand for slopes, in the place's size. Chosen: in the middle between rounding and bending.
const DIFFERENCE: f64 = 1e-5;
/// Steps are damped by this at first, as if slopes were of that size; chosen as is usual,
const DAMPING: f64 = 1e-3;
/// by ten times as much where they lead farther away, and no more than this, where they hardly move;
const MOST_DAMPING: f64 = 1e4;
/// by a tenth where they lead nearer, and no less than this, so that along a contact, where no slope says anything, they stay.
/// Chosen.
const LEAST_DAMPING: f64 = 1e-10;

/// Finds where primitives of a solid touch.
pub(super) struct ContactSearch<'a> {
    csg: &'a Csg,
    whole: Tape,
    job: &'a Job,
}

/// Where a step of Newton's method leads from a point: how far along the normal there. Without end where the function has no
/// slope.
#[derive(Clone, Copy)]
struct PrimitiveFoot {
    distance: f64,
    normal: [f64; 3],
}

/// A primitive near a place, and where steps lead from points of it.
type NearPrimitive = (usize, Vec<PrimitiveFoot>);

/// Two primitives, a point from which to look for their contact, and how far it is from both.
struct ContactStart {
    off: f64,
    pair: [usize; 2],
    at: [f64; 3],
}

impl<'a> ContactSearch<'a> {
    /// Of the solid of a sign, with its primitives.
    pub fn new(csg: &'a Csg, sign: &Expr, job: &'a Job) -> Self {
        Self { csg, whole: Tape::new(sign), job }
    }

    /// Where two primitives touch in a place, looked for from points of it: one from opposite sides if there is any.
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
                found => flush = flush.or(found),
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

    /// All pairs of primitives near a place with points from which to look for their contact, the nearest first: those whose
    /// normals have such a cosine there, without its sign.
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
                    let off = a.distance.abs() + b.distance.abs();
                    if off <= place.size && is_turned(dot(a.normal, b.normal).abs()) {
                        starts.push(ContactStart { off, pair: [*p, *q], at: *at });
                    }
                }
            }
        }
        starts.sort_by(|a, b| a.off.total_cmp(&b.off));
        starts
    }

    /// A point on two primitives that cross, as far as steps lead from a start.
    fn crossing_point(&self, [p, q]: [usize; 2], start: [f64; 3]) -> Option<[f64; 3]> {
        (0..STEPS_TO_EDGE).try_fold(start, |at, _| {
            let [a, b] = [self.feet(p, &[at])?[0], self.feet(q, &[at])?[0]];
            let cosine = dot(a.normal, b.normal);
            let square = 1.0 - cosine * cosine;
            let [u, v] = [a.distance - cosine * b.distance, b.distance - cosine * a.distance];
            (square > 1.0 - PARALLEL * PARALLEL)
                .then(|| std::array::from_fn(|k| at[k] - (u * a.normal[k] + v * b.normal[k]) / square))
        })
    }

    /// Where two primitives cross and only opposite ones of the four sides about their edge are inside, as where two boxes have
    /// an edge in common and nothing else.
    fn edge_contact(&self, place: &OpenPlace, pair: [usize; 2], start: [f64; 3]) -> Option<SurfaceContact> {
        let at = self.crossing_point(pair, start)?;
        let [a, b] = self.feet_on(place, pair, at)?;
        let most = NEAR * place.size;
        let aside = |of_p: f64, of_q: f64| -> [f64; 3] {
            let way: [f64; 3] = std::array::from_fn(|k| of_p * a.normal[k] + of_q * b.normal[k]);
            let by = 2.0 * most / length(way);
            std::array::from_fn(|k| at[k] + by * way[k])
        };
        let around = [aside(1.0, 1.0), aside(1.0, -1.0), aside(-1.0, -1.0), aside(-1.0, 1.0)];
        let inside: Vec<bool> =
            duals(&self.whole, &around, self.job)?.iter().map(|here| here.value < 0.0).collect();
        let is_across = inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1];
        is_across.then_some(SurfaceContact { at, is_flush: false, lines: None })
    }

    /// Where steps lead from a point to two primitives, if it is on both and in the place.
    fn feet_on(&self, place: &OpenPlace, [p, q]: [usize; 2], at: [f64; 3]) -> Option<[PrimitiveFoot; 2]> {
        let [a, b] = [self.feet(p, &[at])?[0], self.feet(q, &[at])?[0]];
        let is_on = greater(a.distance.abs(), b.distance.abs()) <= NEAR * place.size;
        (is_on && length(difference(at, place.at)) <= place.size).then_some([a, b])
    }

    /// Whether two primitives touch where steps from a point lead, and the surface of the whole is there.
    fn contact_of(&self, place: &OpenPlace, pair: [usize; 2], start: [f64; 3]) -> Option<SurfaceContact> {
        let at = self.touching_point(pair, start, place.size)?;
        let [a, b] = self.feet_on(place, pair, at)?;
        if dot(a.normal, b.normal).abs() < PARALLEL {
            return None;
        }
        let most = NEAR * place.size;
        // Beyond both surfaces, on both sides.
        let beside = |by: f64| std::array::from_fn(|k| at[k] + by * a.normal[k]);
        let points = [at, beside(2.0 * most), beside(-2.0 * most)];
        let [here, above, below] = duals(&self.whole, &points, self.job)?.try_into().ok()?;
        let is_bare = here.value.abs() <= most * length(here.gradient);
        is_bare.then_some(SurfaceContact {
            at,
            is_flush: (above.value < 0.0) != (below.value < 0.0),
            lines: None,
        })
    }

    /// The point nearest to both of two primitives where their normals are parallel, as far as damped steps lead from a start
    /// (Levenberg and Marquardt). They take the distances from both and the sine between their normals, which crossing surfaces
    /// have too: steps from one surface to the other would come as near a contact only after thousands of them.
    fn touching_point(&self, pair: [usize; 2], start: [f64; 3], size: f64) -> Option<[f64; 3]> {
        let step = DIFFERENCE * size;
        let mut at = start;
        let mut miss = self.misses(pair, &[at], size)?[0];
        let mut damping = DAMPING;
        for _ in 0..STEPS {
            let aside = [0, 1, 2].map(|k| [0, 1, 2].map(|j| if j == k { at[j] + step } else { at[j] }));
            let moved = self.misses(pair, &aside, size)?;
            let slopes: [[f64; 5]; 3] =
                std::array::from_fn(|k| std::array::from_fn(|i| (moved[k][i] - miss[i]) / step));
            let down = slopes.map(|slope| dot(slope, miss));
            let mut nearer = None;
            while nearer.is_none() && damping <= MOST_DAMPING {
                let damped =
                    |i: usize, j: usize| dot(slopes[i], slopes[j]) + if i == j { damping } else { 0.0 };
                let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| damped(i, j)));
                let to = difference(at, solved(rows, down));
                let there = self.misses(pair, &[to], size).map(|misses| misses[0]);
                nearer = there.filter(|there| length(*there) < length(miss)).map(|there| (to, there));
                damping =
                    if nearer.is_some() { greater(0.1 * damping, LEAST_DAMPING) } else { 10.0 * damping };
            }
            let Some((to, there)) = nearer else { break };
            (at, miss) = (to, there);
            if length(miss) <= ENOUGH * size {
                break;
            }
        }
        Some(at)
    }

    /// By point: how far it is from two primitives, and the sine between their normals, times a size, as a vector.
    fn misses(&self, [p, q]: [usize; 2], points: &[[f64; 3]], size: f64) -> Option<Vec<[f64; 5]>> {
        let (of_p, of_q) = (self.feet(p, points)?, self.feet(q, points)?);
        let miss = |(a, b): (&PrimitiveFoot, &PrimitiveFoot)| {
            let [x, y, z] = cross(a.normal, b.normal);
            [a.distance, b.distance, size * x, size * y, size * z]
        };
        Some(of_p.iter().zip(&of_q).map(miss).collect())
    }

    /// By point; none where a leaf fails.
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

/// The solution of three linear equations whose matrix is symmetric, by Cramer's rule; not finite where there is none.
fn solved(rows: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = rows;
    let [u, v, w] = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, u);
    [u, v, w].map(|of| dot(of, right) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::Field;
    use crate::implicit::shapes::{cuboid, cylinder, sphere};

    /// What is found in a place around a point, from that point.
    fn contact_near(field: &Field, at: [f64; 3], size: f64) -> Option<SurfaceContact> {
        let csg = Csg::from_expr(field.sign());
        let place = OpenPlace { at, size, area: 1.0, contact: None };
        ContactSearch::new(&csg, field.sign(), &Job::default()).contact(&place, &[at])
    }

    fn assert_is_at(contact: Option<SurfaceContact>, [x, y]: [f64; 2], is_flush: bool) {
        let contact = contact.expect("a contact");
        let off = length([contact.at[0] - x, contact.at[1] - y]);
        assert!(off < 1e-6 && contact.is_flush == is_flush, "{contact:?}");
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
