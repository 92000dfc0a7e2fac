//! Maps that are right, and maps that lie: the bound holds with both.
use super::super::violations::{ViolationReport, tolerance_violations};
use super::cells::surface_mapping;
use super::images::{VertexImage, vertex_images};
use super::paths::edge_paths;
use super::surface::FanSurface;
use super::{MappedPair, NearFaces};
use crate::budget::{ErrorLimit, Job};
use crate::check::{Deviation, Goal, OneSidedDistance, deviation};
use crate::explicit::{Mesh, Topology, distance_sq_to_triangle};
use chordal_testkit::{Random, is_long, some};

/// A bumpy torus of `n` × `n` quads: closed, without symmetry.
fn torus(n: u32, bump: f64) -> Mesh {
    let angle = |i: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let at = |i: u32, j: u32| {
        let (u, v) = (angle(i), angle(j));
        let r = 0.4 + bump * libm::sin(3.0 * u + 2.0 * v) * libm::cos(5.0 * u);
        let out = 1.0 + r * libm::cos(v);
        [out * libm::cos(u), out * libm::sin(u), r * libm::sin(v)]
    };
    let positions = (0..n).flat_map(|i| (0..n).map(move |j| at(i, j))).collect();
    let row = |i: u32, j: u32| (i % n) * n + j % n;
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let faces = (0..n).flat_map(|i| (0..n).flat_map(move |j| quad(i, j))).collect();
    Mesh::new(positions, faces).unwrap()
}

/// For each vertex of a torus of `n` the face of one of `n / k` at the same place.
fn near(n: u32, k: u32) -> Vec<u32> {
    (0..n).flat_map(|i| (0..n).map(move |j| 2 * ((i / k) * (n / k) + j / k))).collect()
}

fn mapped(a: &Mesh, b: &Mesh, by_row: &[u32]) -> Deviation {
    let (job, near) = (Job::default(), NearFaces { by_row, topology: Topology::Indices });
    MappedPair::new(a, b, (near, 0.0), &job)
        .unwrap()
        .deviation(f64::INFINITY, &Goal::default(), &job)
        .unwrap()
}

/// Holds a bound against that of the search, which shares nothing with it but the last step.
fn assert_holds(a: &Mesh, b: &Mesh, by_row: &[u32]) -> Deviation {
    let found = mapped(a, b, by_row);
    let searched = deviation(a, b, &Goal::default(), &Job::default()).unwrap();
    let ends = |found: &Deviation| [found.bound.at_least(), found.bound.at_most().unwrap()];
    let ([least, most], [true_least, true_most]) = (ends(&found), ends(&searched));
    assert!(most >= true_least && least <= true_most, "{least}..{most} and {true_least}..{true_most}");
    assert!(most <= 1.21 * true_most, "{most} is far above {true_most}");
    found
}

#[test]
fn most_faces_of_a_coarser_torus_need_no_search() {
    for (n, k) in [(24, 2), (48, 4), (60, 3), (64, 16)] {
        let (a, b) = (torus(n, 0.05), torus(n / k, 0.05));
        assert_holds(&a, &b, &near(n, k));
        let job = Job::default();
        let near = near(n, k);
        let pair =
            MappedPair::new(&a, &b, (NearFaces { by_row: &near, topology: Topology::Indices }, 0.0), &job)
                .unwrap();
        let unknown = |up: &[f64]| up.iter().filter(|up| **up == f64::INFINITY).count();
        let (forward, backward) = (unknown(&pair.mapping.forward), unknown(&pair.mapping.backward));
        assert!(20 * forward <= a.faces().len(), "{forward} of {} faces", a.faces().len());
        assert!(5 * backward <= b.faces().len(), "{backward} of {} faces", b.faces().len());
    }
}

/// A ring of `n` sides between two radii, as a plate with a hole; without a hole, caps are fans.
fn washer(n: u32, hole: Option<f64>) -> Mesh {
    let at = |r: f64, i: u32, z: f64| {
        let angle = (f64::from(i) + 0.3) / f64::from(n) * std::f64::consts::TAU;
        [r * libm::cos(angle), r * libm::sin(angle), z]
    };
    let circle = |r: f64, z: f64| (0..n).map(move |i| at(r, i, z));
    let mut positions: Vec<_> = circle(1.0, 0.0).chain(circle(1.0, 0.3)).collect();
    let strip = |from: u32, to: u32| {
        (0..n).flat_map(move |i| {
            let [a, b, c, d] = [from + i, from + (i + 1) % n, to + (i + 1) % n, to + i];
            [[a, b, c], [a, c, d]]
        })
    };
    let mut faces: Vec<[u32; 3]> = strip(0, n).collect();
    match hole {
        Some(r) => {
            positions.extend(circle(r, 0.0).chain(circle(r, 0.3)));
            faces.extend(strip(2 * n, 0).chain(strip(n, 3 * n)).chain(strip(3 * n, 2 * n)));
        }
        None => {
            positions.extend([[0.0, 0.0, 0.0], [0.0, 0.0, 0.3]]);
            faces.extend((0..n).flat_map(|i| {
                let j = (i + 1) % n;
                [[2 * n, j, i], [2 * n + 1, n + i, n + j]]
            }));
        }
    }
    Mesh::new(positions, faces).unwrap()
}

/// For each vertex of one mesh the nearest face of another.
fn nearest_faces(a: &Mesh, b: &Mesh) -> Vec<u32> {
    let off = |p: [f64; 3], face: usize| distance_sq_to_triangle(p, b.corners(face));
    let nearest = |p: &[f64; 3]| (0..b.faces().len()).min_by(|f, g| off(*p, *f).total_cmp(&off(*p, *g)));
    a.positions().iter().map(|p| nearest(p).unwrap() as u32).collect()
}

#[test]
fn flat_faces_with_holes_and_fans_need_no_search() {
    for (n, m, hole) in [(96, 24, Some(0.5)), (60, 18, Some(0.9)), (300, 90, None), (500, 11, None)] {
        let (a, b) = (washer(n, hole), washer(m, hole));
        let by_row = nearest_faces(&a, &b);
        assert_holds(&a, &b, &by_row);
        let (job, near) = (Job::default(), NearFaces { by_row: &by_row, topology: Topology::Indices });
        let pair = MappedPair::new(&a, &b, (near, 0.0), &job).unwrap();
        let all_known = |up: &[f64]| up.iter().all(|up| *up < f64::INFINITY);
        assert!(all_known(&pair.mapping.forward), "{n} sides onto {m}");
        assert!(all_known(&pair.mapping.backward), "{n} sides onto {m}, back");
    }
}

#[test]
fn a_surface_is_a_rounding_away_from_itself() {
    let a = torus(16, 0.05);
    let found = mapped(&a, &a, &near(16, 1));
    assert!(found.bound.at_most().unwrap() <= 14.0 * f64::EPSILON * a.bounds().diagonal());
}

#[test]
fn faces_that_are_not_near_cost_time_alone() {
    let (a, b) = (torus(24, 0.05), torus(12, 0.05));
    let mut random = Random::new(7);
    let n_faces = b.faces().len();
    for _ in 0..20 {
        let by_row: Vec<u32> = (0..a.positions().len()).map(|_| random.below(n_faces + 9) as u32).collect();
        assert_holds(&a, &b, &by_row);
    }
    assert_holds(&a, &b, &[u32::MAX; 24 * 24]);
}

#[test]
fn a_part_of_the_source_that_nothing_stands_for_is_found() {
    let a = torus(24, 0.05);
    for hole in 0..6 {
        // A vertex and the faces around it are missing.
        let b = torus(12, 0.05);
        let faces = b.faces().iter().filter(|rows| !rows.contains(&(23 * hole))).copied().collect();
        let b = Mesh::new(b.positions().to_vec(), faces).unwrap();
        assert_holds(&a, &b, &near(24, 2));
    }
}

#[test]
fn a_part_of_the_result_that_stands_for_nothing_is_found() {
    let (a, b) = (torus(24, 0.05), torus(12, 0.05));
    let mut positions = b.positions().to_vec();
    let first = positions.len() as u32;
    positions.extend([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]);
    let mut faces = b.faces().to_vec();
    faces.extend([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f| f.map(|v: u32| first + v)));
    let b = Mesh::new(positions, faces).unwrap();
    let found = assert_holds(&a, &b, &near(24, 2));
    // It is in the hole of the torus.
    assert!(found.bound.at_least() > 0.4, "{:?}", found.bound);
}

#[test]
fn a_spike_of_either_surface_is_found() {
    for spiked in [0, 1] {
        let mut meshes = [torus(24, 0.05), torus(12, 0.05)];
        let mut positions = meshes[spiked].positions().to_vec();
        positions[50] = positions[50].map(|x| 2.0 * x);
        meshes[spiked] = Mesh::new(positions, meshes[spiked].faces().to_vec()).unwrap();
        let found = assert_holds(&meshes[0], &meshes[1], &near(24, 2));
        assert!(found.bound.at_least() > 0.3, "{:?}", found.bound);
    }
}

#[test]
fn a_label_that_is_changed_after_the_walks_leaves_no_cells() {
    let (a, b) = (torus(24, 0.05), torus(12, 0.05));
    let job = Job::default();
    let (source, result) = (FanSurface::new(&a, None), FanSurface::new(&b, None));
    let near = near(24, 2);
    let images = vertex_images(&source, &result, (a.faces().as_flattened(), &near), &job);
    let paths = edge_paths(&source, &result, &images, (0.1, &job));
    let unknown = |images: &[VertexImage]| {
        let made = surface_mapping(&source, &result, images, (&paths, &job));
        [made.forward, made.backward].map(|up| up.iter().filter(|up| **up == f64::INFINITY).count())
    };
    let before = unknown(&images);
    for v in [0, 100, 571] {
        let mut changed = images.clone();
        let face = (changed[v].face + 1) % result.n_faces() as u32;
        changed[v] = VertexImage::on_face(source.at(v as u32), face, &result);
        let after = unknown(&changed);
        assert!(after[0] >= before[0] + 6 && after[1] > before[1], "{before:?} to {after:?}");
    }
}

#[test]
fn surfaces_that_are_wound_against_each_other_or_torn_are_bounded() {
    let mut random = Random::new(3);
    for _ in 0..10 {
        let (a, b) = (torus(24, 0.05), torus(12, 0.05));
        let flipped = |mesh: &Mesh, share: usize, random: &mut Random| {
            let faces = mesh.faces().iter().map(|&[a, b, c]| match random.below(share) {
                0 => [a, c, b],
                _ => [a, b, c],
            });
            Mesh::new(mesh.positions().to_vec(), faces.collect()).unwrap()
        };
        let (a, b) = (flipped(&a, 9, &mut random), flipped(&b, 9, &mut random));
        assert_holds(&a, &b, &near(24, 2));
        let torn = |mesh: &Mesh, random: &mut Random| {
            let faces = mesh.faces().iter().filter(|_| random.below(12) > 0).copied().collect();
            Mesh::new(mesh.positions().to_vec(), faces).unwrap()
        };
        assert_holds(&torn(&a, &mut random), &b, &near(24, 2));
    }
}

#[test]
fn violations_are_those_beyond_the_length() {
    let (a, b) = (torus(24, 0.05), torus(12, 0.05));
    let (job, near) = (Job::default(), near(24, 2));
    let pair = MappedPair::new(&a, &b, (NearFaces { by_row: &near, topology: Topology::Indices }, 0.0), &job)
        .unwrap();
    let found = pair.deviation(f64::INFINITY, &Goal::default(), &job).unwrap();
    let (least, most) = (found.bound.at_least(), found.bound.at_most().unwrap());
    let none = pair.violations(1.001 * most, &job).unwrap();
    assert!(none.is_empty() && none.at_most >= least && none.at_most <= 1.001 * most);
    assert!(!pair.violations(0.99 * least, &job).unwrap().is_empty());
}

#[test]
fn both_ends_have_the_rounding_of_the_frame_where_one_direction_alone_is_searched() {
    let mut random = Random::new(11);
    let triangle = |tip: f64| {
        let positions = vec![[1000.0, 0.9, 0.0], [1001.0, 1.1, 0.0], [1000.5, tip, 0.0]];
        Mesh::new(positions, vec![[0, 1, 2]]).unwrap()
    };
    for _ in 0..200 {
        // Far from zero along x, so that the frame rounds y; the tips are that far apart, exactly.
        let (tip, off) = (0.001 + 0.05 * random.unit(), 1e-4 * random.unit());
        let (a, b) = (triangle(tip - off), triangle(tip));
        let apart = tip - a.positions()[2][1];
        let found = mapped(&a, &b, &[0; 3]);
        let (least, most) = (found.bound.at_least(), found.bound.at_most().unwrap());
        assert!(least <= apart && apart <= most, "{least:e} to {most:e}, but {apart:e}");
        let OneSidedDistance { at_least, at_most, .. } = found.forward;
        assert!(at_least <= apart && apart <= at_most, "{at_least:e} to {at_most:e}, but {apart:e}");
    }
}

#[test]
fn a_surface_is_within_less_of_itself_than_the_frame_rounds() {
    for scale in [1.0, 1e-300] {
        let torus = torus(16, 0.05);
        let positions = torus
            .positions()
            .iter()
            .map(|p| [p[0] + 1e6, p[1] - 2e3, p[2] + 0.7].map(|x| scale * x))
            .collect();
        let a = Mesh::new(positions, torus.faces().to_vec()).unwrap();
        let (job, near) = (Job::default(), near(16, 1));
        let pair =
            MappedPair::new(&a, &a, (NearFaces { by_row: &near, topology: Topology::Indices }, 0.0), &job)
                .unwrap();
        // The surface moves by less than a unit of the last place of the largest coordinate.
        let moved = 2.0 * f64::EPSILON * 1e6 * scale;
        let found = pair.deviation(f64::INFINITY, &Goal::default(), &job).unwrap();
        assert!(found.bound.at_most().unwrap() <= moved, "{:?}", found.bound);
        let none = pair.violations(1e-20 * scale, &job).unwrap();
        assert!(none.is_empty() && none.at_most <= 1e-20 * scale, "{:e}", none.at_most);
    }
}

#[test]
fn who_is_too_far_is_the_same_by_a_map_and_by_a_search() {
    let job = Job::default();
    let (mut n_found, mut random) = (0, Random::new(3));
    let (large, small) =
        ([(24, 2, 0.05), (48, 4, 0.03), (60, 5, 0.08)], [(24, 2, 0.05), (24, 4, 0.03), (30, 5, 0.08)]);
    for (n, k, bump) in if is_long() { large } else { small } {
        let (a, b) = (torus(n, bump), torus(n / k, bump));
        let whole = deviation(&a, &b, &Goal::default(), &job).unwrap().bound.at_most().unwrap();
        let lies = (0..n * n).map(|_| random.below(b.faces().len()) as u32).collect();
        for by_row in [near(n, k), lies] {
            let near = NearFaces { by_row: &by_row, topology: Topology::Indices };
            let pair = MappedPair::new(&a, &b, (near, 0.0), &job).unwrap();
            for share in some([0.02, 0.3, 0.7, 0.9, 0.97, 1.01], 2) {
                let length = share * whole;
                let faces = |found: &ViolationReport| {
                    found.violations.each_ref().map(|far| far.iter().map(|far| far.face).collect::<Vec<_>>())
                };
                let limit = ErrorLimit::uniform(length);
                let searched = faces(&tolerance_violations(&a, &b, &limit, &job).unwrap());
                assert_eq!(
                    faces(&pair.violations(length, &job).unwrap()),
                    searched,
                    "{n} onto {} at {share}",
                    n / k
                );
                n_found += searched.concat().len();
            }
        }
    }
    assert!(n_found > 1000, "{n_found}");
}

#[test]
fn a_result_with_a_part_far_from_everything_is_too_far_there() {
    let (a, b) = (torus(24, 0.05), torus(12, 0.05));
    let mut positions = b.positions().to_vec();
    let n = positions.len() as u32;
    positions.extend([[50.0, 0.0, 0.0], [51.0, 0.0, 0.0], [50.0, 1.0, 0.0]]);
    let faces = b.faces().iter().copied().chain([[n, n + 1, n + 2]]).collect();
    let b = Mesh::new(positions, faces).unwrap();
    let (job, by_row) = (Job::default(), near(24, 2));
    let pair =
        MappedPair::new(&a, &b, (NearFaces { by_row: &by_row, topology: Topology::Indices }, 0.0), &job)
            .unwrap();
    let found = pair.violations(0.3, &job).unwrap();
    let faces = found.violations[1].iter().map(|far| far.face).collect::<Vec<_>>();
    assert_eq!(faces, [b.faces().len() as u32 - 1]);
    assert!(found.violations[0].is_empty() && found.violations[1][0].distance > 48.0);
}
