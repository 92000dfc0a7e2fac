//! Limit surfaces beside their own points, at irregular vertices, creases, corners and borders.
use super::corpus::cages;
use super::judge;
use chordal::explicit::Cage;
use chordal::explicit::query::SurfaceTree;
use chordal::explicit::subdivision::{LimitSurface, Scheme};
use chordal::{Job, Tolerance};
use chordal_testkit::Random;
use chordal_testkit::is_long;
use chordal_testkit::sampler::Point;

fn samples(limit: &LimitSurface<'_>, n: usize) -> Vec<Point> {
    let sheets = (0..limit.n_sheets()).map(|sheet| limit.sheet(sheet).unwrap());
    sheets
        .flat_map(|sheet| {
            let places = (0..=n).flat_map(move |i| (0..=n).map(move |j| (i, j)));
            places.map(move |(i, j)| sheet.at(j as f64 / n as f64, i as f64 / n as f64).unwrap().point)
        })
        .collect()
}

fn extent(samples: &[Point]) -> f64 {
    samples.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn no_cage_of_the_corpus_breaks_an_enclosure() {
    let mut numbers = Random::new(21);
    let mut wide = 0;
    for (name, cage) in cages().into_iter().filter(|(_, cage)| cage.scheme() != Scheme::Loop) {
        let limit = cage.limit().unwrap();
        let samples = samples(&limit, if limit.n_sheets() > 100 { 4 } else { 12 });
        let tree = SurfaceTree::from_limit(&limit, &Job::default()).unwrap();
        let size = extent(&samples);
        // Vertices of hundreds of quads take long when they are first met.
        let (count, tolerance) =
            if name.contains("pole") { (10, 1e-2) } else { (if is_long() { 500 } else { 18 }, 1e-9) };
        for query in 0..count {
            let p = match query % 3 {
                // On the surface; every sheet begins at a vertex.
                0 => samples[(query * 169) % samples.len()],
                1 => {
                    let on = samples[(query * 101) % samples.len()];
                    let off = numbers.point_within::<3>(0.05 * size);
                    [0, 1, 2].map(|k| on[k] + off[k])
                }
                _ => numbers.point_within::<3>(1.5 * size),
            };
            let found = tree.closest_point(p, Some(Tolerance::new(tolerance * size).unwrap())).unwrap();
            let sheet = limit.sheet(found.sheet as usize).unwrap();
            let place = sheet.at(found.u, found.v).unwrap().point;
            judge(&found, p, place, &samples, 1e-12 * size);
            wide += usize::from(found.at_most - found.at_least > tolerance * size);
        }
    }
    assert!(wide <= 5, "{wide} enclosures are wide");
}

/// The corner of a cube goes to a half of itself.
#[test]
fn the_vertices_of_a_cube() {
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
    let sides: [&[u32]; 6] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    let cube = Cage::new((0..8).map(corner).collect(), sides).unwrap();
    let tree = SurfaceTree::from_limit(&cube.limit().unwrap(), &Job::default()).unwrap();
    for share in [0.5, 0.5001, 0.6, 1.0, 5.0] {
        let found = tree.closest_point([share; 3], None).unwrap();
        let truth = (share - 0.5) * 3.0_f64.sqrt();
        assert!(found.at_least <= truth + 1e-14 && truth <= found.at_most + 1e-14, "{found:?}: {truth}");
        assert!(found.at_most - found.at_least < 1e-11, "{found:?}");
        assert!(found.point.iter().all(|x| (x - 0.5).abs() < 1e-5), "{found:?}");
    }
    // From the middle all six sides are equally near, at the middle of each.
    let found = tree.closest_point([0.0; 3], None).unwrap();
    let side = cube.limit().unwrap().sheet(0).unwrap().at(0.5, 0.5).unwrap().point;
    let truth = side.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(found.at_least <= truth + 1e-12 && truth <= found.at_most + 1e-12, "{found:?}: {truth}");
}

#[test]
fn what_was_asked_before_changes_no_answer() {
    for (name, cage) in
        cages().into_iter().filter(|(name, _)| name.contains("cube_creases") || name.contains("dart"))
    {
        if cage.scheme() == Scheme::Loop {
            continue;
        }
        let limit = cage.limit().unwrap();
        let mut numbers = Random::new(22);
        let points: Vec<Point> = (0..60).map(|_| numbers.point_within::<3>(1.5)).collect();
        let tree = || SurfaceTree::from_limit(&limit, &Job::default()).unwrap();
        let all = tree().closest_points(&points, None, &Job::default());
        for (p, known) in points.iter().zip(&all).rev() {
            assert_eq!(tree().closest_point(*p, None), *known, "{name}");
        }
    }
}
