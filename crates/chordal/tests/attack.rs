//! Inputs that broke the bound, the topology or the patience of the patch mesher, and must not again.
use chordal::{Bounded, Budget, Failure, Job, Mesh, Patch, Tolerance, convert};
use chordal_testkit::sampler::Triangles;
use std::collections::BTreeMap;

type Point = [f64; 3];
type Failed = Failure<Mesh>;

fn patch(at: impl Fn(usize, usize) -> Point) -> Patch {
    Patch { control: std::array::from_fn(|i| std::array::from_fn(|j| at(i, j))) }
}

/// The even unit square with heights by row and column.
fn lifted(z: impl Fn(usize, usize) -> f64) -> Patch {
    patch(|i, j| [j as f64 / 3.0, i as f64 / 3.0, z(i, j)])
}

fn within(patches: &[Patch], length: f64) -> Result<Bounded<Mesh>, Failed> {
    let budget = Budget::length(Tolerance::new(length).expect("a positive length"));
    convert::patches_to_mesh(patches, &budget, &Job::default().with_threads(1))
}

fn with_triangles(patches: &[Patch], most: u64) -> Result<Bounded<Mesh>, Failed> {
    let budget = Budget { triangles: Some(most), ..Budget::default() };
    convert::patches_to_mesh(patches, &budget, &Job::default().with_threads(1))
}

fn mix(a: Point, b: Point, t: f64) -> Point {
    std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k])
}

fn on_curve(p: [Point; 4], t: f64) -> Point {
    let first = [mix(p[0], p[1], t), mix(p[1], p[2], t), mix(p[2], p[3], t)];
    mix(mix(first[0], first[1], t), mix(first[1], first[2], t), t)
}

fn on_patch(patch: &Patch, u: f64, v: f64) -> Point {
    on_curve(patch.control.map(|row| on_curve(row, u)), v)
}

/// The largest distance of an even grid of points on the patches from the mesh, both enlarged by `scale`.
fn farthest(patches: &[Patch], mesh: &Mesh, scale: f64) -> f64 {
    let large = |p: Point| p.map(|x| x * scale);
    let corners: Vec<Point> = mesh.positions().iter().map(|p| large(*p)).collect();
    let triangles = Triangles::new(&corners, mesh.faces());
    let mut most = 0.0_f64;
    for patch in patches {
        let patch = Patch { control: patch.control.map(|row| row.map(large)) };
        for i in 0..=16 {
            for j in 0..=16 {
                let p = on_patch(&patch, f64::from(j) / 16.0, f64::from(i) / 16.0);
                most = most.max(triangles.distance(p));
            }
        }
    }
    most
}

/// That no sample of the surface is farther from the mesh than the bound says.
fn assert_covered(patches: &[Patch], made: &Bounded<Mesh>, what: &str) {
    let at_most = made.bound.at_most().expect("proved");
    let found = farthest(patches, &made.shape, 1.0);
    assert!(found <= at_most, "{what}: {found:e} away, at most {at_most:e} promised");
}

/// Edges between positions by their number of faces.
fn edges(mesh: &Mesh) -> BTreeMap<[u32; 2], usize> {
    let mut count = BTreeMap::new();
    for face in mesh.faces() {
        let [a, b, c] = face.map(|row| mesh.position_of(row));
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *count.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
        }
    }
    count
}

fn assert_closed_manifold(mesh: &Mesh, what: &str) {
    assert!(!mesh.faces().is_empty(), "{what}: no faces");
    let odd = edges(mesh).into_iter().filter(|(edge, faces)| edge[0] == edge[1] || *faces != 2).count();
    assert_eq!(odd, 0, "{what}: edges without exactly two faces");
}

const COARSE_TO_FINE: [f64; 6] = [30.0, 3.0, 1.0, 0.3, 0.1, 0.02];

#[test]
fn patches_whose_squares_underflow_are_bounded_or_refused() {
    for power in [-340, -480, -500, -510, -520, -530, -540, -560, -600, -800, -1000, -1070] {
        let scale = 2_f64.powi(power.max(-1000)) * 2_f64.powi((power + 1000).min(0));
        let arch =
            |i: usize, j: usize| [j as f64, i as f64, if i * j == 1 { 3.0 } else { 0.0 }].map(|x| x * scale);
        let tiny = patch(arch);
        for relative in [1e-2, 1.0, 1e40] {
            let Ok(budget) = Tolerance::new(relative * scale) else { continue };
            match within(&[tiny], budget.get()) {
                Ok(made) => {
                    let back = 2_f64.powi(-power / 2);
                    let found = farthest(
                        &[Patch { control: tiny.control.map(|r| r.map(|p| p.map(|x| x * back))) }],
                        &enlarged(&made.shape, back),
                        back,
                    );
                    let at_most = made.bound.at_most().expect("proved") * back * back;
                    assert!(found <= at_most, "2^{power}, {relative}: {found:e} > {at_most:e}");
                }
                Err(failure) => assert_eq!(failure.code(), "below-precision", "2^{power}, {relative}"),
            }
        }
    }
}

fn enlarged(mesh: &Mesh, scale: f64) -> Mesh {
    let positions = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
    Mesh::new(positions, mesh.faces().to_vec()).expect("the same mesh, larger")
}

#[test]
fn patches_without_area_are_in_the_mesh() {
    let arch = lifted(|i, j| if i * j == 1 { 1.0 } else { 0.0 });
    let point = patch(|_, _| [10.0, 0.0, 0.0]);
    let segment = patch(|_, j| [10.0 + j as f64 / 3.0, 1.0, 0.0]);
    let curve = patch(|_, j| [10.0, j as f64, (j * j) as f64]);
    for flat in [point, segment, curve] {
        for length in [100.0, 1.0, 0.01] {
            for patches in [&[flat][..], &[arch, flat][..]] {
                let made = within(patches, length).expect("accepted");
                assert_covered(patches, &made, &format!("{} patches to {length}", patches.len()));
            }
        }
    }
}

#[test]
fn closed_patches_are_closed_at_every_budget() {
    // All sides in one point; and a sphere-like one with two poles and a seam.
    let bubble =
        patch(|i, j| if i % 3 == 0 || j % 3 == 0 { [0.0; 3] } else { [i as f64 - 1.5, j as f64 - 1.5, 1.0] });
    let ball = patch(|i, j| {
        let (radius, round) = ([0.0, 1.0, 1.0, 0.0][i], [[0.0, 0.0], [2.0, 1.0], [2.0, -1.0], [0.0, 0.0]][j]);
        [radius * round[0], radius * round[1], i as f64]
    });
    for (name, patch) in [("bubble", bubble), ("ball", ball)] {
        for length in COARSE_TO_FINE {
            let made = within(&[patch], length).expect("accepted");
            assert_covered(&[patch], &made, &format!("{name} to {length}"));
            assert_closed_manifold(&made.shape, &format!("{name} to {length}"));
        }
    }
}

#[test]
fn sides_folded_around_a_corner_are_covered_and_manifold() {
    // Both sides at a corner are the same curve; `twice`: at the opposite corner as well, which closes the
    // surface.
    for twice in [false, true] {
        for bulge in [0.3, -0.7] {
            let mut folded =
                lifted(|i, j| if i % 3 != 0 && j % 3 != 0 { bulge } else { 0.1 * (i + j) as f64 });
            for k in 0..4 {
                folded.control[k][0] = folded.control[0][k];
                if twice {
                    folded.control[3][k] = [1.0 - k as f64 / 9.0, 1.0, 0.3 * k as f64];
                }
            }
            if twice {
                folded.control[3][0] = folded.control[0][3];
                for k in 0..4 {
                    folded.control[k][3] = folded.control[3][k];
                }
            }
            for turns in 0..4 {
                let mut turned = folded;
                for _ in 0..turns {
                    turned = patch(|i, j| turned.control[j][3 - i]);
                }
                for length in COARSE_TO_FINE {
                    let what = format!("folded (twice: {twice}), turned {turns} times, to {length}");
                    let made = within(&[turned], length).expect("accepted");
                    assert_covered(&[turned], &made, &what);
                    if twice {
                        assert_closed_manifold(&made.shape, &what);
                    }
                    assert!(edges(&made.shape).values().all(|faces| *faces <= 2), "{what}");
                }
            }
        }
    }
}

#[test]
fn pillows_of_two_patches_are_closed_manifolds() {
    // Both have the same four sides, so that every corner is met by two patches only.
    for (twist, thick) in [(0.0, 0.5), (1.0, 0.3), (-1.0, 0.3), (3.0, 2.0)] {
        let half = |up: f64| {
            lifted(move |i, j| {
                let inside = i % 3 != 0 && j % 3 != 0;
                twist * (i * j) as f64 / 9.0 + if inside { up * (1.0 + twist * (i + 1) as f64) } else { 0.0 }
            })
        };
        let (front, mut back) = (half(thick), half(-thick));
        back.control.iter_mut().for_each(|row| row.reverse());
        for length in COARSE_TO_FINE {
            let what = format!("pillow with twist {twist} to {length}");
            let made = within(&[front, back], length).expect("accepted");
            assert_covered(&[front, back], &made, &what);
            assert_closed_manifold(&made.shape, &what);
        }
    }
}

#[test]
fn long_rows_are_halved_lengthwise() {
    // A parabola over u that grows by a hair along v: 7,400 cells in a row, more than a tile has.
    let gutter = lifted(|i, j| 1e-3 * [0.0, 0.0, 1.0 / 3.0, 1.0][j] * (1.0 + 5e-5 * i as f64 / 3.0));
    let made = within(&[gutter], 5e-12).expect("accepted");
    assert!(made.shape.faces().len() < 20_000, "{} triangles", made.shape.faces().len());
}

#[test]
fn budgets_of_triangles_end_for_huge_patches() {
    for scale in [1e100, 1e120, 1e149] {
        let arch = patch(|i, j| [j as f64, i as f64, if i * j == 1 { 3.0 } else { 0.0 }].map(|x| x * scale));
        let made = with_triangles(&[arch], 200).expect("accepted");
        let count = made.shape.faces().len();
        assert!((100..=200).contains(&count), "{count} triangles");
        assert!(made.bound.at_most().is_some_and(|most| most < 0.1 * scale), "{:?}", made.bound);
    }
}
