//! How far an edge seems to be from the surface, and where to split it.
use super::super::ask::Ask;
use super::super::planes::{between, crease};
use crate::implicit::LeafError;
use crate::math::{difference, dot, length};

type Point = [f64; 3];

/// An edge between two triangles.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub ends: [Point; 2],
    /// The corners across it.
    pub across: [Point; 2],
}

/// What is known of an edge.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    /// How far some point of it, or of the surface beyond it, seems to be from the other.
    pub error: f64,
    /// Where to split it.
    pub place: Point,
}

/// This far into a triangle a field shows its side of a crease.
const ASIDE: f64 = 0.1;
/// A crease this close to an end of an edge, as a share, is the end's.
const END: f64 = 0.05;
/// A place is at most this share of its edge's length away from it.
const REACH: f64 = 0.5;
/// A place is on a crease when its distance from the surface is this share of its distance from the edge: half of what
/// a smooth surface would have is 1/4.
const ON: f64 = 0.125;
/// Steps towards a crease, and towards a smooth surface.
const STEPS: usize = 2;

/// Looks at edges in turn, with few calls of the field.
pub(super) fn look(ask: &Ask, edges: &[Edge], aim: f64) -> Result<Vec<Cut>, LeafError> {
    let points: Vec<Point> = edges.iter().flat_map(samples).collect();
    let planes = ask.planes(&points)?;
    let mut cuts = Vec::with_capacity(edges.len());
    // Creases that may be.
    let mut tries = Vec::new();
    for (k, edge) in edges.iter().enumerate() {
        let middle = points[3 * k];
        let [at, left, right] = [0, 1, 2].map(|n| planes[3 * k + n]);
        // Where there is no gradient nothing is known but the edge's length.
        let error = at.map_or(edge.length(), |plane| plane.over(middle).abs());
        let place = at.map_or(middle, |plane| plane.foot(middle));
        cuts.push(Cut { error, place });
        if let (Some(left), Some(right)) = (left, right)
            && let Some(place) = crease(middle, &left, &right)
            && edge.has(place)
        {
            tries.push(Attempt { edge: k, place, open: true });
        }
    }
    settle_creases(ask, edges, &mut tries)?;
    for attempt in tries.iter().filter(|attempt| attempt.open) {
        let error = edges[attempt.edge].off(attempt.place);
        let cut = &mut cuts[attempt.edge];
        if error > cut.error {
            cut.error = error;
            cut.place = attempt.place;
        }
    }
    let creased: Vec<usize> =
        tries.iter().filter(|attempt| attempt.open).map(|attempt| attempt.edge).collect();
    let smooth: Vec<usize> =
        (0..edges.len()).filter(|k| cuts[*k].error > aim && creased.binary_search(k).is_err()).collect();
    let starts: Vec<Point> = smooth.iter().map(|k| points[3 * *k]).collect();
    let firsts: Vec<Point> = smooth.iter().map(|k| cuts[*k].place).collect();
    for ((k, place), start) in smooth.iter().zip(onto(ask, firsts)?).zip(starts) {
        let near = length(difference(place, start)) <= REACH * edges[*k].length();
        cuts[*k].place = if near { place } else { start };
    }
    Ok(cuts)
}

/// Steps along the gradient onto a smooth surface.
fn onto(ask: &Ask, mut places: Vec<Point>) -> Result<Vec<Point>, LeafError> {
    for _ in 0..STEPS {
        let planes = ask.planes(&places)?;
        for (place, plane) in places.iter_mut().zip(planes) {
            if let Some(plane) = plane {
                *place = plane.foot(*place);
            }
        }
    }
    Ok(places)
}

/// The middle, and a little into both triangles.
fn samples(edge: &Edge) -> [Point; 3] {
    let middle = between(edge.ends[0], edge.ends[1], 0.5);
    let [left, right] = edge.across.map(|c| between(middle, c, ASIDE));
    [middle, left, right]
}

/// A place that may be on a crease.
struct Attempt {
    edge: usize,
    place: Point,
    open: bool,
}

/// Moves the places onto their creases, and closes those that are on none.
fn settle_creases(ask: &Ask, edges: &[Edge], tries: &mut [Attempt]) -> Result<(), LeafError> {
    for _ in 0..STEPS {
        let points: Vec<Point> = tries
            .iter()
            .flat_map(|one| edges[one.edge].across.map(|side| between(one.place, side, ASIDE)))
            .collect();
        let planes = ask.planes(&points)?;
        for (one, pair) in tries.iter_mut().zip(planes.chunks_exact(2)).filter(|(one, _)| one.open) {
            let next = match (&pair[0], &pair[1]) {
                (Some(a), Some(b)) => crease(one.place, a, b),
                _ => None,
            };
            match next {
                Some(place) if edges[one.edge].has(place) => one.place = place,
                _ => one.open = false,
            }
        }
    }
    let places: Vec<Point> = tries.iter().map(|one| one.place).collect();
    for (one, plane) in tries.iter_mut().zip(ask.planes(&places)?) {
        let off = edges[one.edge].off(one.place);
        one.open &= plane.is_some_and(|plane| plane.over(one.place).abs() <= ON * off);
    }
    Ok(())
}

impl Edge {
    /// Whether a place is beside the edge, rather than beyond an end or far away.
    fn has(&self, place: Point) -> bool {
        let along = difference(self.ends[1], self.ends[0]);
        let t = dot(difference(place, self.ends[0]), along) / dot(along, along);
        t > END && t < 1.0 - END && self.off(place) <= REACH * length(along)
    }

    fn length(&self) -> f64 {
        length(difference(self.ends[1], self.ends[0]))
    }

    /// The distance of a place from the edge's line.
    fn off(&self, place: Point) -> f64 {
        let along = difference(self.ends[1], self.ends[0]);
        let from = difference(place, self.ends[0]);
        let t = dot(from, along) / dot(along, along);
        length(difference(from, along.map(|x| t * x)))
    }
}
