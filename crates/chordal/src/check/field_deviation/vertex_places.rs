//! Several places for a vertex without a common one: runs of consecutive faces around it, each of which has a
//! displacement.
//!
//! Runs overlap by some faces, which have a displacement at either place. The copy is cut there along an
//! edge: outward along a convex one, since beyond the planes of its two faces all is outside, inward along a
//! concave one. This is a guess like every displacement: the resulting faces are proved.
use crate::explicit::Mesh;
use crate::math::{cross, difference, dot, length};

/// A corner: a face of the mesh, and the number of one of its three corners.
pub(super) type FaceCorner = (u32, u8);

/// The faces around a vertex in order, and its places.
#[derive(Clone, Debug)]
pub(super) struct VertexPlaces {
    /// Each face shares an edge with the next one; the edge starts at the vertex in the next face.
    pub ring: Vec<FaceCorner>,
    /// In the order of the ring.
    pub places: Vec<VertexPlace>,
}

/// One place of a vertex.
#[derive(Clone, Debug)]
pub(super) struct VertexPlace {
    /// The corners at this place; at least one.
    pub corners: Vec<FaceCorner>,
    /// The corners whose constraints the place obeys, including those of faces beside the cuts.
    pub obeyed: Vec<FaceCorner>,
}

/// The most faces around a vertex. Chosen: the time of the search grows with about the cube of their number.
const MOST_FACES: usize = 48;

/// The faces around a vertex in order; `None` if they do not form a single ring.
pub(super) fn ring(mesh: &Mesh, ids: &[u32], corners: &[FaceCorner]) -> Option<Vec<FaceCorner>> {
    let id = |(face, corner): FaceCorner, by: u8| {
        ids[mesh.faces()[face as usize][usize::from((corner + by) % 3)] as usize]
    };
    if corners.len() > MOST_FACES || corners.len() < 3 {
        return None;
    }
    let mut order = vec![corners[0]];
    // From each face to the one that begins at the neighbour where it ends:
    //
    //          end of f = begin of g
    //                   |
    //              g    |    f
    //                   |
    //     end of g ──── v ──── begin of f
    //
    // Two faces that begin there are a branch. If two end at the same neighbour, the walk may
    // circle without the first face, so its length is limited.
    while order.len() <= corners.len() {
        let end = id(order[order.len() - 1], 2);
        let mut next = corners.iter().filter(|corner| id(**corner, 1) == end);
        let (Some(after), None) = (next.next(), next.next()) else { return None };
        if *after == order[0] {
            return (order.len() == corners.len()).then_some(order);
        }
        order.push(*after);
    }
    None
}

/// The fewest places for the faces of a ring, if there is a solution. `fits` says whether some corners have a
/// common displacement, and `rank` how suitable the edge between two faces is for a cut.
pub(super) fn places(
    ring: Vec<FaceCorner>,
    fits: impl Fn(&[FaceCorner]) -> bool,
    rank: impl Fn(FaceCorner, FaceCorner) -> f64,
) -> Option<VertexPlaces> {
    let n = ring.len();
    // The ring twice, so that every run is a slice.
    let round: Vec<FaceCorner> = ring.iter().chain(&ring).copied().collect();
    let corners_between =
        |first: usize, last: usize| -> Vec<FaceCorner> { (first..=last).map(|k| round[k % n]).collect() };
    let fits_run = |first: usize, last: usize| fits(&corners_between(first, last));
    let mut best: Option<Vec<[usize; 2]>> = None;
    for start in 0..n {
        // Only fewer runs are better; of equally few the first stays.
        let most = best.as_ref().map_or(n, |best| best.len() - 1);
        if let Some(runs) = runs_from(start, n, most, &fits_run) {
            best = Some(runs);
        }
    }
    let runs = best?;
    // A cut lies in the overlap of two consecutive runs; `cuts` holds the last face before it:
    //   run k      |--------|
    //   run k + 1       |--------|
    //   cut k            ^
    // The first run of the pair may give up faces as far as the second can be extended backwards (`first`).
    let mut cuts: Vec<usize> = Vec::with_capacity(runs.len());
    let mut firsts = Vec::with_capacity(runs.len());
    for (k, run) in runs.iter().enumerate() {
        let [mut first, last] = runs.get(k + 1).copied().unwrap_or([runs[0][0] + n, runs[0][1] + n]);
        let least = cuts.last().map_or(run[0], |cut| cut + 1).max(run[0]);
        while first > least + 1 && fits_run(first - 1, last) {
            first -= 1;
        }
        let most = cuts.first().map_or(run[1], |cut| run[1].min(cut + n - 1));
        let candidates = least.max(first - 1)..=most;
        let cut = candidates.reduce(|a, b| {
            let rank_at = |k: usize| rank(round[k % n], round[(k + 1) % n]);
            if rank_at(b) > rank_at(a) { b } else { a }
        })?;
        cuts.push(cut);
        firsts.push(first);
    }
    let places = (0..runs.len()).map(|k| {
        // The run that begins after this cut.
        let run = runs.get(k + 1).copied().unwrap_or([runs[0][0] + n, runs[0][1] + n]);
        let end = cuts.get(k + 1).copied().unwrap_or(cuts[0] + n);
        let (begin, first) = (cuts[k] + 1, firsts[k]);
        let reach = (begin - usize::from(begin > first), end + usize::from(end < run[1]));
        VertexPlace { corners: corners_between(begin, end), obeyed: corners_between(reach.0, reach.1) }
    });
    let places: Vec<VertexPlace> = places.collect();
    (places.len() > 1 && places.iter().all(|place| !place.corners.is_empty()))
        .then_some(VertexPlaces { ring, places })
}

/// Runs around a ring, each of which starts at the last face of the previous run and is as long as fits.
/// `None` if there are more than `most`, if two neighbours do not fit, or if one run holds all faces.
fn runs_from(
    start: usize,
    n: usize,
    most: usize,
    fits: &impl Fn(usize, usize) -> bool,
) -> Option<Vec<[usize; 2]>> {
    let mut runs = Vec::new();
    let mut first = start;
    while first < start + n {
        // As far as possible: a shorter run never makes the next one reach farther.
        let mut last = first;
        while last < start + n && fits(first, last + 1) {
            last += 1;
        }
        if last == first || runs.len() == most {
            return None;
        }
        runs.push([first, last]);
        first = last;
    }
    (runs.len() > 1).then_some(runs)
}

/// The convexity of the mesh at the edge between two faces around a vertex: the sine of the turn, negative if
/// it is concave.
pub(super) fn convexity(mesh: &Mesh, before: FaceCorner, after: FaceCorner) -> f64 {
    let corner = |(face, k): FaceCorner, by: u8| {
        mesh.positions()[mesh.faces()[face as usize][usize::from((k + by) % 3)] as usize]
    };
    let [at, a, b] = [0, 1, 2].map(|by| corner(before, by));
    let normal = cross(difference(a, at), difference(b, at));
    let away = difference(corner(after, 2), at);
    let sine = -dot(normal, away) / (length(normal) * length(away));
    if sine.is_nan() { 0.0 } else { sine }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces that fit where their numbers are less than `reach` apart around a ring of `n`.
    fn cut(n: u32, reach: u32) -> Option<VertexPlaces> {
        let ring: Vec<FaceCorner> = (0..n).map(|face| (face, 0)).collect();
        let fits = |corners: &[FaceCorner]| {
            let apart = |a: u32, b: u32| (a + n - b).min(b + n - a) % n;
            corners.iter().all(|(a, _)| corners.iter().all(|(b, _)| apart(*a, *b) < reach))
        };
        places(ring, fits, |before, _| f64::from(before.0 % 3))
    }

    #[test]
    fn every_face_has_one_place_and_every_place_fits() {
        for n in 3..12 {
            for reach in 2..n {
                let Some(VertexPlaces { ring, places }) = cut(n, reach) else { continue };
                let all: Vec<u32> =
                    places.iter().flat_map(|place| place.corners.iter().map(|(face, _)| *face)).collect();
                let mut sorted = all.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, (0..n).collect::<Vec<u32>>(), "{n} {reach}");
                // In the order of the ring.
                let first = ring.iter().position(|(face, _)| *face == all[0]).unwrap();
                assert!(all.iter().enumerate().all(|(k, face)| ring[(first + k) % ring.len()].0 == *face));
                assert!(
                    places.iter().all(|place| place.corners.iter().all(|one| place.obeyed.contains(one)))
                );
            }
        }
        // Two neighbours that do not fit have no place.
        assert!(cut(6, 1).is_none());
        // All fit at once: nothing is cut.
        assert!(cut(4, 4).is_none());
    }
}
