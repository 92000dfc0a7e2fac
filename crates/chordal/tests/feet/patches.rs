//! Random patches, and those with nothing to hold on to, beside samples by the plain sum of Bernstein's
//! polynomials.
use super::judge;
use chordal::explicit::query::{SurfaceClosestPoint, SurfaceTree};
use chordal::{Job, Patch, Tolerance};
use chordal_testkit::Random;
use chordal_testkit::sampler::{Point, distance};

pub fn at(patch: &Patch, u: f64, v: f64) -> Point {
    let weights = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let (along, up) = (weights(u), weights(v));
    let term = |i: usize, j: usize, k: usize| up[i] * along[j] * patch.control[i][j][k];
    [0, 1, 2].map(|k| (0..16).map(|n| term(n / 4, n % 4, k)).sum())
}

pub fn samples(patch: &Patch, n: usize) -> Vec<Point> {
    let places = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
    places.map(|(i, j)| at(patch, j as f64 / n as f64, i as f64 / n as f64)).collect()
}

fn random(numbers: &mut Random, rough: f64) -> Patch {
    let mut patch = Patch::flat([-1.5, -1.5, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
    patch
        .control
        .as_flattened_mut()
        .as_flattened_mut()
        .iter_mut()
        .for_each(|x| *x += rough * numbers.signed());
    patch
}

fn foot(tree: &SurfaceTree, p: Point) -> SurfaceClosestPoint {
    tree.closest_point(p, None).unwrap()
}

#[test]
fn no_enclosure_of_ten_thousand_is_broken() {
    let mut numbers = Random::new(1);
    let (mut wide, mut on_border) = (0, 0);
    for round in 0..250 {
        let patches: Vec<Patch> =
            (0..1 + round % 3).map(|_| random(&mut numbers, [0.2, 1.0, 3.0][round % 3])).collect();
        let tree = SurfaceTree::from_patches(&patches, &Job::default()).unwrap();
        let samples: Vec<Point> = patches.iter().flat_map(|patch| samples(patch, 24)).collect();
        for query in 0..40 {
            // Near, farther, far, and on the surface.
            let p = match query % 8 {
                0 => at(&patches[0], 0.5 + 0.5 * numbers.signed(), 0.5 + 0.5 * numbers.signed()),
                1 => samples[(query * 37) % samples.len()],
                2 => numbers.point_within::<3>(1e3),
                3 => numbers.point_within::<3>(1e9),
                _ => numbers.point_within::<3>(4.0),
            };
            let found = foot(&tree, p);
            let place = at(&patches[found.sheet as usize], found.u, found.v);
            let reach = 8.0 + p.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            judge(&found, p, place, &samples, 1e-14 * reach);
            wide += usize::from(found.at_most - found.at_least > 1e-12 * reach);
            on_border += usize::from([0.0, 1.0].contains(&found.u) || [0.0, 1.0].contains(&found.v));
        }
    }
    assert_eq!(wide, 0, "enclosures that are wide");
    assert!((1000..9000).contains(&on_border), "{on_border} feet on borders");
}

#[test]
fn a_tolerance_is_met_and_holds() {
    let mut numbers = Random::new(2);
    for _ in 0..100 {
        let patch = random(&mut numbers, 1.0);
        let tree = SurfaceTree::from_patches(&[patch], &Job::default()).unwrap();
        let samples = samples(&patch, 24);
        for tolerance in [1e-1, 1e-3, 1e-6] {
            let p = numbers.point_within::<3>(3.0);
            let found = tree.closest_point(p, Some(Tolerance::new(tolerance).unwrap())).unwrap();
            judge(&found, p, at(&patch, found.u, found.v), &samples, 1e-13);
            assert!(found.at_most - found.at_least <= tolerance, "{found:?}");
            let exact = foot(&tree, p);
            assert!(found.at_least <= exact.at_most && exact.at_least <= found.at_most);
        }
    }
}

/// A pole, a line, a point, a fold, and a sliver.
fn degenerate() -> Vec<Patch> {
    let mut pole = Patch::flat([0.0; 3], [1.0, 0.0, 0.2], [0.0, 1.0, 0.0]);
    pole.control[0] = [[0.3, 0.0, 0.0]; 4];
    pole.control[2][1][2] = 0.5;
    let line = Patch::flat([0.0; 3], [1.0, 2.0, 3.0], [0.0; 3]);
    let point = Patch { control: [[[0.25, -0.5, 1.0 / 3.0]; 4]; 4] };
    let mut fold = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for row in &mut fold.control {
        (row[1], row[2]) = (row[2], row[1]);
    }
    let sliver = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0]);
    let mut two_poles = pole;
    two_poles.control[3] = [[0.6, 1.0, 0.4]; 4];
    vec![pole, line, point, fold, sliver, two_poles]
}

#[test]
fn degenerate_patches_have_feet() {
    let mut numbers = Random::new(3);
    for (which, patch) in degenerate().into_iter().enumerate() {
        let tree = SurfaceTree::from_patches(&[patch], &Job::default()).unwrap();
        let samples = samples(&patch, 40);
        for query in 0..200 {
            let p = match query % 4 {
                0 => samples[(query * 31) % samples.len()],
                1 => patch.control[0][0],
                _ => numbers.point_within::<3>(2.0),
            };
            let found = foot(&tree, p);
            judge(&found, p, at(&patch, found.u, found.v), &samples, 1e-14);
            assert!(found.at_most - found.at_least < 1e-12, "{which}: {found:?} of {p:?}");
        }
    }
}

#[test]
fn a_power_of_two_changes_no_digit() {
    let mut numbers = Random::new(4);
    for _ in 0..50 {
        let patch = random(&mut numbers, 1.0);
        let p = numbers.point_within::<3>(3.0);
        let plain = foot(&SurfaceTree::from_patches(&[patch], &Job::default()).unwrap(), p);
        for exponent in [-300, -900, 300, 900] {
            let scale = f64::powi(2.0, exponent);
            let scaled = Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| x * scale))) };
            let tree = SurfaceTree::from_patches(&[scaled], &Job::default()).unwrap();
            let found = foot(&tree, p.map(|x| x * scale));
            assert_eq!((found.sheet, found.u, found.v), (plain.sheet, plain.u, plain.v));
            assert_eq!([found.at_least, found.at_most], [plain.at_least * scale, plain.at_most * scale]);
            assert_eq!(found.point, plain.point.map(|x| x * scale));
        }
    }
}

#[test]
fn queries_that_dwarf_the_surface_or_are_none() {
    let patch = random(&mut Random::new(5), 1.0);
    let tree = SurfaceTree::from_patches(&[patch], &Job::default()).unwrap();
    for far in [1e12, 1e18, 1e20, 1e100, 1e200, 1e300] {
        for p in [[far, 0.0, 0.0], [-far, far, 0.5 * far]] {
            let found = foot(&tree, p);
            let square = if far < 1e150 {
                distance(p, [0.0; 3])
            } else {
                far * distance(p.map(|x| x / far), [0.0; 3])
            };
            assert!(
                found.at_least <= square * (1.0 + 1e-15) + 4.0
                    && square <= found.at_most * (1.0 + 1e-15) + 4.0
            );
            assert!(found.at_most - found.at_least <= 1e-13 * found.at_most, "{found:?}");
            assert!(distance(found.point, at(&patch, found.u, found.v)) < 1e-14);
        }
    }
    let most = foot(&tree, [f64::MAX, -f64::MAX, f64::MAX]);
    assert!(most.at_least <= f64::MAX && most.at_most == f64::INFINITY, "{most:?}");
    for p in [[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]] {
        assert_eq!(tree.closest_point(p, None), None);
    }
    let none = SurfaceTree::from_patches(&[], &Job::default()).unwrap();
    assert_eq!(none.closest_point([0.0; 3], None), None);
    let mut broken = patch;
    broken.control[1][2][0] = f64::NAN;
    assert!(SurfaceTree::from_patches(&[broken], &Job::default()).is_err());
    let origin =
        SurfaceTree::from_patches(&[Patch { control: [[[0.0; 3]; 4]; 4] }], &Job::default()).unwrap();
    let found = foot(&origin, [3.0, 4.0, 0.0]);
    assert!(found.at_least <= 5.0 && found.at_most >= 5.0 && found.at_most - found.at_least < 1e-14);
}

#[test]
fn many_queries_are_answered_like_each_on_any_number_of_threads() {
    let mut numbers = Random::new(6);
    let patches: Vec<Patch> = (0..5).map(|_| random(&mut numbers, 1.0)).collect();
    let tree = SurfaceTree::from_patches(&patches, &Job::default()).unwrap();
    let points: Vec<Point> = (0..1000).map(|_| numbers.point_within::<3>(3.0)).collect();
    let each: Vec<_> = points.iter().map(|p| tree.closest_point(*p, None)).collect();
    for threads in [1, 2, 5] {
        assert_eq!(tree.closest_points(&points, None, &Job::default().with_threads(threads)), each);
    }
}
