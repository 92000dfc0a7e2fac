//! `Refinement`: topology once, for positions that move and for whatever else stands at vertices.
use super::corpus::cages;
use chordal::budget::Job;
use chordal::explicit::subdivision::{Refinement, Scheme};
use chordal::explicit::{Cage, InvalidCage};

fn rounds_of(cage: &Cage) -> u32 {
    if cage.n_faces() > 500 { 3 } else { 5 }
}

/// The same cage with its vertices elsewhere.
fn moved(cage: &Cage) -> Cage {
    let shaken = |k: usize, x: f64| x + 0.01 * ((k * k + 3 * k) as f64 % 17.0);
    let positions = cage.positions().iter().enumerate();
    let positions = positions.map(|(k, p)| [shaken(k, p[1]), shaken(k + 1, p[2]), shaken(k + 2, p[0])]);
    let same = Cage::new(positions.collect(), cage.faces()).unwrap();
    let same = same.with_scheme(cage.scheme()).unwrap().with_boundary(cage.boundary());
    let same = same.with_creasing(cage.creasing()).with_creases(cage.creases()).unwrap();
    same.with_sharp_vertices(cage.sharp_vertices()).unwrap().with_holes(cage.holes()).unwrap()
}

fn bits(points: &[[f64; 3]]) -> Vec<u64> {
    points.as_flattened().iter().map(|x| x.to_bits()).collect()
}

#[test]
fn a_moved_cage_is_evaluated_as_it_is_refined_bit_for_bit() {
    for (name, cage) in cages() {
        let other = moved(&cage);
        for rounds in 0..=rounds_of(&cage) {
            let refinement = cage.refinement(rounds).unwrap();
            let expected = other.refined_times(rounds).unwrap();
            let sizes = (refinement.n_controls(), refinement.n_points(), refinement.n_faces());
            let counts = (cage.positions().len(), expected.positions().len(), expected.n_faces());
            assert_eq!(sizes, counts, "{name} {rounds}");
            for threads in [1, 2] {
                let job = Job::default().with_threads(threads);
                let points = refinement.evaluate(other.positions(), &job).unwrap();
                assert!(bits(&points) == bits(expected.positions()), "{name} {rounds} on {threads}");
                assert!(expected.faces().flatten().eq(&refinement.corners(&job)), "{name} {rounds}");
                assert!(refinement.refined(other.positions(), &job).unwrap() == expected, "{name} {rounds}");
            }
        }
    }
}

/// More than a task of each kind, so that threads do share the work: a torus with a seam of sharp edges and a
/// sharp vertex.
#[test]
fn a_large_cage_is_the_same_on_any_number_of_threads() {
    let (n, m) = (96_u32, 64_u32);
    let point = |k: u32| {
        let turn = std::f64::consts::TAU;
        let (u, v) = (f64::from(k / m) * turn / f64::from(n), f64::from(k % m) * turn / f64::from(m));
        [(3.0 + v.cos()) * u.cos(), (3.0 + v.cos()) * u.sin(), v.sin()]
    };
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let quad = |k: u32| {
        let (i, j) = (k / m, k % m);
        [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    let cage = Cage::new((0..n * m).map(point).collect(), (0..n * m).map(quad)).unwrap();
    let seam: Vec<([u32; 2], f64)> = (0..n).map(|i| ([at(i, 7), at(i + 1, 7)], 2.3)).collect();
    let cage = cage.with_creases(&seam).unwrap().with_sharp_vertices(&[(5, 1.5)]).unwrap();
    let refinement = cage.refinement(4).unwrap();
    let on = |threads| refinement.refined(cage.positions(), &Job::default().with_threads(threads)).unwrap();
    let one = on(1);
    assert_eq!(one.n_faces(), 6144 * 256);
    for threads in [2, 3] {
        assert!(on(threads) == one, "{threads} threads");
    }
}

#[test]
fn single_precision_and_other_values_follow_the_same_rules() {
    let job = Job::default();
    for (name, cage) in cages() {
        let refinement = cage.refinement(rounds_of(&cage)).unwrap();
        let expected = refinement.evaluate(cage.positions(), &job).unwrap();
        let size = expected.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let single: Vec<[f32; 3]> = cage.positions().iter().map(|p| p.map(|x| x as f32)).collect();
        for (p, q) in refinement.evaluate(&single, &job).unwrap().iter().zip(&expected) {
            // Twenty roundings of f32, each of half 1.2e-7, by shares that add up to 1; more around poles of
            // hundreds of faces.
            assert!(
                (0..3).all(|k| (f64::from(p[k]) - q[k]).abs() <= 2e-6 * size),
                "{name}: {p:?} {q:?} {size}"
            );
        }
        // Five numbers: the positions among others, and one that is the same everywhere, as shares add up to
        // 1.
        let five: Vec<[f64; 5]> = cage.positions().iter().map(|p| [p[2], 1.0, p[0], p[1], 0.0]).collect();
        for (p, q) in refinement.evaluate(&five, &job).unwrap().iter().zip(&expected) {
            assert_eq!([p[2], p[3], p[0]].map(f64::to_bits), q.map(f64::to_bits), "{name}");
            // Some hundred sums around a pole.
            assert!((p[1] - 1.0).abs() < 1e-13 && p[4] == 0.0, "{name}: {p:?}");
        }
    }
}

fn square() -> Cage {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    Cage::new(points, [[0_u32, 1, 2, 3]]).unwrap()
}

fn evaluated(refinement: &Refinement, values: &[[f64; 1]]) -> Result<Vec<[f64; 1]>, InvalidCage> {
    refinement.evaluate(values, &Job::default())
}

#[test]
fn what_cannot_be_evaluated_is_refused_by_name() {
    for rounds in 0..4 {
        let refinement = square().refinement(rounds).unwrap();
        let short = evaluated(&refinement, &[[0.0]; 3]);
        assert_eq!(short.unwrap_err(), InvalidCage::WrongCount { expected: 4, found: 3 });
        let nan = evaluated(&refinement, &[[0.0], [1.0], [f64::NAN], [0.0]]);
        assert_eq!(nan.unwrap_err(), InvalidCage::NotFinite { row: 2 });
        let mut out = vec![[0.0]; refinement.n_points() + 1];
        let long = refinement.evaluate_into(&[[0.0]; 4], &mut out, &Job::default());
        let expected = refinement.n_points();
        assert_eq!(long.unwrap_err(), InvalidCage::WrongCount { expected, found: expected + 1 });
    }
    // The sum of two overflows before it is halved.
    let refinement = square().refinement(3).unwrap();
    assert!(matches!(evaluated(&refinement, &[[f64::MAX]; 4]), Err(InvalidCage::NotFinite { .. })));
    let large = evaluated(&refinement, &[[f64::MAX / 64.0]; 4]).unwrap();
    assert!(large.iter().all(|x| (x[0] / f64::MAX - 1.0 / 64.0).abs() < 1e-15)); // rounding
    for scheme in [Scheme::CatmullClark, Scheme::Bilinear] {
        let cage = square().with_scheme(scheme).unwrap();
        assert!(matches!(cage.refinement(20), Err(InvalidCage::TooMany { .. })), "{scheme:?}");
    }
}

#[test]
fn points_and_faces_of_nothing_are_nothing() {
    let empty = Cage::new(Vec::new(), std::iter::empty::<[u32; 4]>()).unwrap();
    for rounds in [0, 1, 2, 5, 100, u32::MAX] {
        let refined = empty.refined_times(rounds).unwrap();
        assert_eq!((refined.positions().len(), refined.n_faces()), (0, 0));
    }
    // Vertices that no face uses stay where they are.
    let bare = Cage::new(vec![[1.0, 2.0, 3.0]; 2], std::iter::empty::<[u32; 4]>()).unwrap();
    assert_eq!(bare.refined_times(4).unwrap().positions(), bare.positions());
}
