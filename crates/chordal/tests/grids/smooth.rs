//! Smoothed masks: the surface is that of the means, and its bound is against the mask as it was.
use super::shapes::{interpolant, one_sided, surface_points};
use super::solid::flaw;
use chordal::budget::{Evidence, RefusalCode};
use chordal::convert::lattices::mask_to_smooth_mesh;
use chordal::convert::{Border, Polygonize, grid_to_mesh};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::{Failure, Job};
use chordal_testkit::{Random, is_long};

type Inside = fn([f64; 3]) -> bool;

fn mask(n: [usize; 3], affine: Affine3, inside: Inside) -> Grid {
    let at = |i: usize| [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])].map(|x| x as f64);
    let values = (0..n.iter().product()).map(|i| 7 * u8::from(inside(at(i)))).collect();
    Grid::new(n, Samples::U8(values), affine).unwrap()
}

fn ball(p: [f64; 3]) -> bool {
    p.map(|x| (x - 8.0) * (x - 8.0)).iter().sum::<f64>() < 34.0
}

/// A ball with a bar and a sheet that are one sample thin.
fn with_thin_parts(p: [f64; 3]) -> bool {
    ball(p) || p[1] == 8.0 && p[2] == 8.0 || p[0] == 15.0
}

/// The mean of the sides around a sample, with the weights of a Gaussian in three dimensions.
fn mean(grid: &Grid, sigma: f64, at: [usize; 3]) -> f64 {
    let reach = (4.0 * sigma).ceil() as i64;
    let (mut sum, mut whole) = (0.0, 0.0);
    for d in (-reach..=reach)
        .flat_map(|x| (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |z| [x, y, z])))
    {
        let weight = (-0.5 * d.map(|d| (d * d) as f64).iter().sum::<f64>() / (sigma * sigma)).exp();
        let there =
            std::array::from_fn(|k| (at[k] as i64 + d[k]).clamp(0, grid.size()[k] as i64 - 1) as usize);
        sum += weight * f64::from(u8::from(grid.sample(there) > 3.5));
        whole += weight;
    }
    sum / whole
}

#[test]
fn the_bound_is_against_the_unsmoothed_mask() {
    let sheared =
        Affine3::new([[1.0, 0.25, 0.0, -3.0], [0.0, 0.75, 0.125, 5.0], [0.125, 0.0, -1.5, 7.0]]).unwrap();
    let rule = Polygonize::above(3.5);
    let mut random = Random::new(5);
    let cases: [(Inside, Affine3, f64); 4] = [
        (ball, Affine3::IDENTITY, 0.7),
        (ball, sheared, 1.5),
        (with_thin_parts, Affine3::IDENTITY, 1.0),
        (with_thin_parts, sheared, 0.4),
    ];
    for (number, (inside, affine, sigma)) in cases.into_iter().enumerate() {
        let grid = mask([17, 18, 16], affine, inside);
        let made = mask_to_smooth_mesh(&grid, &rule, [sigma; 3], &Job::default().with_threads(2)).unwrap();
        if number % 2 == 0 || is_long() {
            let job = Job::default().with_threads(1);
            let again = mask_to_smooth_mesh(&grid, &rule, [sigma; 3], &job).unwrap();
            assert!(made == again, "other bytes on one thread");
        }
        let mesh = &made.shape.mesh;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), |_, _| false), None);
        assert_eq!(*made.bound.evidence(), Evidence::Proved);
        let most = made.bound.at_most().expect("proved");
        // Points of the mask's own surface: of its interpolant, with what is inside below 0.
        let values = (0..grid.samples().len()).map(|i| 3.5 - grid.samples().get(i)).collect();
        let own = Grid::new(grid.size(), Samples::F64(values), affine).unwrap();
        let points = surface_points(&own, &mut random, 300);
        assert!(interpolant(&own, [8.0; 3]) < 0.0);
        let seen = one_sided(&points, mesh);
        assert!(seen <= most, "case {number}: {seen} from {most}");
        // What is gone is as far as it was; the bar's ends and the sheet lie seven samples off.
        let is_gone = number == 2;
        assert!(is_gone == (most > 3.0) && seen > 0.3 * most, "case {number}: {seen} from {most}");
        let (mut n_inside, mut changed) = (0, 0);
        for i in 0..grid.samples().len() {
            let at = [i % 17, i / 17 % 18, i / (17 * 18)];
            let is_inside = grid.samples().get(i) > 3.5;
            n_inside += u64::from(is_inside);
            let mean = mean(&grid, sigma, at);
            assert!((mean - 0.5).abs() > 1e-5, "a tie tests nothing");
            changed += u64::from(is_inside != (mean > 0.5));
        }
        assert_eq!((made.shape.inside, made.shape.changed), (n_inside, changed), "case {number}");
    }
}

#[test]
fn nothing_is_lost_without_a_width_or_on_a_plane() {
    let half: Inside = |p| p[0] < 5.0;
    let grid = mask([10, 9, 8], Affine3::IDENTITY, half);
    let rule = Polygonize { border: [[Border::Open; 2]; 3], ..Polygonize::above(3.5) };
    let before = grid_to_mesh(&grid, &rule, None, &Job::default()).unwrap();
    for sigma in [[0.0; 3], [1.25; 3], [0.0, 3.0, 0.5]] {
        let made = mask_to_smooth_mesh(&grid, &rule, sigma, &Job::default()).unwrap();
        assert_eq!(made.shape.changed, 0);
        assert_eq!(made.shape.mesh.faces(), before.shape.faces());
        let most = before.bound.at_most().expect("proved");
        assert!(made.bound.at_most().expect("proved") <= most + 1e-5, "{:?}", made.bound);
    }
}

#[test]
fn what_cannot_be_smoothed_is_refused() {
    let sheet: Inside = |p| p[2] == 4.0;
    let grid = mask([9; 3], Affine3::IDENTITY, sheet);
    let rule = Polygonize::above(3.5);
    let refused = |sigma: [f64; 3], job: &Job| match mask_to_smooth_mesh(&grid, &rule, sigma, job) {
        Err(Failure::Refused(why)) => (why.code, why.message.to_string()),
        other => panic!("{other:?}"),
    };
    let (code, message) = refused([2.0; 3], &Job::default());
    assert!(code == RefusalCode::Empty && message.contains("81 samples"), "{message}");
    for sigma in [[-1.0, 0.0, 0.0], [f64::NAN; 3], [0.0, 33.0, 0.0], [f64::INFINITY; 3]] {
        assert_eq!(refused(sigma, &Job::default()).0, RefusalCode::Budget);
    }
    let mut few = Job::default();
    few.memory_limit = 1000;
    assert_eq!(refused([1.0; 3], &few).0, RefusalCode::TooMuchMemory);
}
