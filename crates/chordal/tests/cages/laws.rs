//! Laws of refinement.
use super::corpus::cages;
use chordal::explicit::subdivision::{CreasingMethod, Scheme};
use chordal::explicit::{Cage, InvalidCage};

/// Coordinates of integers, so that what is exact stays so.
fn torus() -> Cage {
    let (n, m) = (6_u32, 5_u32);
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let point = |k: u32| {
        let (u, v) =
            (f64::from(k / m) * std::f64::consts::TAU / 6.0, f64::from(k % m) * std::f64::consts::TAU / 5.0);
        [(3.0 + v.cos()) * u.cos(), (3.0 + v.cos()) * u.sin(), v.sin()]
    };
    let quad = |k: u32| {
        let (i, j) = (k / m, k % m);
        [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    Cage::new((0..n * m).map(point).collect(), (0..n * m).map(quad)).unwrap()
}

#[test]
fn a_regular_round_is_that_of_the_tensor_b_spline() {
    let cage = torus();
    let once = cage.refined().unwrap();
    let at = |i: u32, j: u32| cage.positions()[((i + 6) % 6 * 5 + (j + 5) % 5) as usize];
    for i in 0..6 {
        for j in 0..5 {
            // A vertex of the uniform cubic B-spline: 1/8, 6/8, 1/8 both ways.
            let weights = [0.125, 0.75, 0.125];
            for k in 0..3 {
                let sum: f64 = (0..9).map(|n| (n / 3, n % 3)).fold(0.0, |sum, (a, b)| {
                    sum + weights[a] * weights[b] * at(i + 5 + a as u32, j + 4 + b as u32)[k]
                });
                // A dozen roundings of numbers up to 4.
                assert!((once.positions()[(i * 5 + j) as usize][k] - sum).abs() < 1e-14);
            }
        }
    }
}

/// A flat grid of unit squares with these vertices lifted to 1: its creases after a round, and how high the
/// point above a place is then.
fn round_of_lifted(
    n: [u32; 2],
    lifted: &[u32],
    creases: &[([u32; 2], f64)],
    place: [f64; 2],
) -> (Vec<f64>, f64) {
    let point = |k: u32| {
        let height = if lifted.contains(&k) { 1.0 } else { 0.0 };
        [f64::from(k % n[0]), f64::from(k / n[0]), height]
    };
    let corners = (0..n[0] * (n[1] - 1)).filter(|k| (k + 1) % n[0] != 0);
    let quads = corners.map(|k| [k, k + 1, k + n[0] + 1, k + n[0]]);
    let cage = Cage::new((0..n[0] * n[1]).map(point).collect(), quads).unwrap();
    let once = cage.with_creasing(CreasingMethod::Chaikin).with_creases(creases).unwrap().refined().unwrap();
    let height = once.positions().iter().find(|p| p[..2] == place).unwrap()[2];
    let mut left: Vec<f64> = once.creases().iter().map(|(_, sharp)| *sharp).collect();
    left.sort_by(f64::total_cmp);
    (left, height)
}

/// In the middle of 2 by 2 squares a crease of 1 goes on as one of 1/4. Both end in a round: 3/4 + 1/16 and
/// 3/16 + 1/4 are below 1. So the vertex is at 5/8, their mean, of the crease's 3/4, and at 3/8 of the smooth
/// rule's 1/4 · 1/4 + 1/2 · 1/2 + 1/4 · 1. OpenSubdiv's reference meshes count only what is below 1,
/// hence 1/4 and 3/4; its library Far, version 3.5, has this height.
#[test]
fn by_chaikin_creases_of_a_whole_round_end_as_well() {
    let (left, height) = round_of_lifted([3, 3], &[4], &[([3, 4], 1.0), ([4, 5], 0.25)], [1.0, 1.0]);
    assert_eq!((left, height), (vec![], 0.625 * 0.75 + 0.375 * 0.5625));
}

/// Halves of an edge end by themselves. The point between them is in the middle of an edge of 1 or more, and
/// else as far towards it from the smooth place as the edge is sharp: never beyond it, where OpenSubdiv 3.5
/// puts it for edges above 1.
#[test]
fn by_chaikin_no_point_of_an_edge_is_beyond_its_middle() {
    // 4 by 2 squares: the middle of the edge from 6 to 7 is at 1, its smooth place (1 + 1 + 1/2 + 1/2) / 4.
    let round = |creases: &[([u32; 2], f64)]| round_of_lifted([5, 3], &[6, 7], creases, [1.5, 1.0]);
    // At 6: 3/4 · 19/16 + 1/4 · 3/16 < 1. At 7: 3/4 · 19/16 + 1/4 · 7/2 - 1, and 3/4 · 7/2 + 1/4 · 19/16 - 1.
    let creases = [([5, 6], 0.1875), ([6, 7], 1.1875), ([7, 8], 3.5)];
    assert_eq!(round(&creases), (vec![0.765625, 1.921875, 2.5], 1.0));
    // At 6 it is alone, and ends. At 7: 3/4 · 7/8 + 1/4 · 7/2 - 1, and 3/4 · 7/2 + 1/4 · 7/8 - 1.
    let creases = [([6, 7], 0.875), ([7, 8], 3.5)];
    assert_eq!(round(&creases), (vec![0.53125, 1.84375, 2.5], 0.875 + 0.125 * 0.75));
    // Both halves remain: 3/4 · 7/8 + 1/4 · 3 - 1 at either end.
    let creases = [([5, 6], 3.0), ([6, 7], 0.875), ([7, 8], 3.0)];
    assert_eq!(round(&creases).1, 1.0);
}

#[test]
fn what_is_moved_and_sheared_is_refined_alike() {
    let map = |p: [f64; 3]| [2.0 * p[0] - p[1] + 3.0, 0.5 * p[1] + p[2], p[0] - 4.0 * p[2] - 1.0];
    for (name, cage) in cages() {
        let mapped = Cage::new(cage.positions().iter().map(|p| map(*p)).collect(), cage.faces()).unwrap();
        let mapped = mapped.with_scheme(cage.scheme()).unwrap().with_boundary(cage.boundary());
        let mapped = mapped.with_creasing(cage.creasing()).with_creases(cage.creases()).unwrap();
        let mapped = mapped.with_sharp_vertices(cage.sharp_vertices()).unwrap();
        let (mut ours, mut theirs) = (cage, mapped);
        for _ in 0..2 {
            (ours, theirs) = (ours.refined().unwrap(), theirs.refined().unwrap());
            assert!(ours.faces().eq(theirs.faces()), "{name}");
            let size = theirs.positions().as_flattened().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            for (p, q) in ours.positions().iter().zip(theirs.positions()) {
                let p = map(*p);
                // Weights add up to 1 within some roundings, times what the map makes of it.
                assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-13 * size), "{name}: {p:?} {q:?}");
            }
        }
    }
}

#[test]
fn what_is_no_cage_is_refused_by_name() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let new = |faces: &[&[u32]]| Cage::new(points.clone(), faces);
    assert_eq!(new(&[&[0, 1]]).unwrap_err(), InvalidCage::ShortFace { face: 0 });
    assert_eq!(new(&[&[0, 1, 2], &[0, 1, 0]]).unwrap_err(), InvalidCage::VertexTwice { face: 1, index: 0 });
    let out = InvalidCage::IndexOutOfRange { face: 0, index: 4, limit: 4 };
    assert_eq!(new(&[&[0, 1, 4]]).unwrap_err(), out);
    let square = new(&[&[0, 1, 3, 2]]).unwrap();
    assert_eq!(square.clone().with_scheme(Scheme::Loop).unwrap_err(), InvalidCage::NotTriangles { face: 0 });
    let diagonal = square.clone().with_creases(&[([0, 3], 1.0)]);
    assert_eq!(diagonal.unwrap_err(), InvalidCage::NoSuchEdge { ends: [0, 3] });
    assert!(square.with_sharp_vertices(&[(0, f64::NAN)]).is_err());
}

#[test]
fn every_cage_of_the_corpus_is_refined() {
    for (name, mut cage) in cages() {
        for round in 0..3 {
            let corners: usize = cage.faces().map(<[u32]>::len).sum();
            let next = cage.refined().unwrap_or_else(|error| panic!("{name} {round}: {error}"));
            let expected = if cage.scheme() == Scheme::Loop { 4 * cage.n_faces() } else { corners };
            assert_eq!(next.n_faces(), expected, "{name}");
            // No affine combination with weights from 0 to 1 leaves the hull.
            let (was, is) = (
                chordal::math::Box3::from_points(cage.positions()),
                chordal::math::Box3::from_points(next.positions()),
            );
            // Of some hundred sums around a pole.
            let room = 1e-12 * was.diagonal();
            assert!(
                (0..3).all(|k| is.min[k] >= was.min[k] - room && is.max[k] <= was.max[k] + room),
                "{name}"
            );
            cage = next;
        }
    }
}
