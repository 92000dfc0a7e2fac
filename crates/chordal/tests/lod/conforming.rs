//! Meshes that share faces: what they share stays the same on both sides, each stays closed and within its bound.
use super::length;
use super::sampler::apart;
use crate::grids::solid::{flaw, volume6};
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Evidence, RefusalCode};
use chordal::convert::Border;
use chordal::convert::lattices::{LabelOptions, labels_to_meshes};
use chordal::explicit::Attribute;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::lod::simplify_conforming;
use chordal::{Bounded, Budget, Failure, Job, Mesh};
use chordal_testkit::{Random, is_long};
use std::collections::{BTreeMap, BTreeSet};

type Corner = [u64; 3];

fn made_on(meshes: &[Mesh], budget: &Budget, n_threads: usize) -> Bounded<Vec<Bounded<Mesh>>> {
    match simplify_conforming(meshes, budget, &Job::default().with_threads(n_threads)) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other}"),
    }
}

/// Cells of the nearest of some points, with some noise, so that labels meet in faces, lines, points and dust.
fn labels(random: &mut Random, size: [usize; 3], n_labels: usize, noise: usize) -> Vec<u8> {
    let place = |random: &mut Random| size.map(|n| n as f64 * random.unit());
    let seeds: Vec<([f64; 3], u8)> =
        (0..2 * n_labels).map(|i| (place(random), (i % n_labels) as u8)).collect();
    let mut values = Vec::new();
    for at in 0..size.iter().product::<usize>() {
        let p = [at % size[0], at / size[0] % size[1], at / (size[0] * size[1])];
        let far = |q: &[f64; 3]| (0..3).map(|k| (p[k] as f64 - q[k]).powi(2)).sum::<f64>();
        let near = seeds.iter().min_by(|a, b| far(&a.0).total_cmp(&far(&b.0))).expect("a seed");
        values.push(if random.below(100) < noise { random.below(n_labels) as u8 } else { near.1 });
    }
    values
}

fn meshes_of(size: [usize; 3], labels: Vec<u8>, affine: Affine3, border: Border) -> Vec<Mesh> {
    let grid = Grid::new(size, Samples::U8(labels), affine).expect("a grid");
    let rule = LabelOptions { border: [[border; 2]; 3], ..LabelOptions::default() };
    match labels_to_meshes(&grid, &rule, &Job::default()) {
        Ok(made) => made.into_iter().map(|(_, made)| made.shape).collect(),
        Err(other) => panic!("{other}"),
    }
}

/// The faces of a mesh by their corners, from the least one on.
fn faces(mesh: &Mesh, is_turned: bool) -> BTreeSet<[Corner; 3]> {
    let of = |face: usize| {
        let [a, b, c] = mesh.corners(face).map(|p| p.map(f64::to_bits));
        let all = if is_turned { [a, c, b] } else { [a, b, c] };
        let least = (0..3).min_by_key(|k| all[*k]).expect("three");
        std::array::from_fn(|k| all[(least + k) % 3])
    };
    (0..mesh.faces().len()).map(of).collect()
}

/// By pair of meshes: the faces that both have.
fn shared(meshes: &[&Mesh]) -> BTreeMap<[usize; 2], Vec<[Corner; 3]>> {
    let mut all = BTreeMap::new();
    let turned: Vec<_> = meshes.iter().map(|mesh| faces(mesh, true)).collect();
    for (a, mesh) in meshes.iter().enumerate() {
        let own = faces(mesh, false);
        for (b, others) in turned.iter().enumerate().skip(a + 1) {
            let both: Vec<[Corner; 3]> = own.intersection(others).copied().collect();
            if !both.is_empty() {
                all.insert([a, b], both);
            }
        }
    }
    all
}

/// The edges that some faces have on one side alone.
fn border(faces: &[[Corner; 3]]) -> BTreeSet<[Corner; 2]> {
    let edges: BTreeSet<[Corner; 2]> =
        faces.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
    edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a])).copied().collect()
}

/// Holds results against the meshes that they were.
fn holds(
    name: &str,
    before: &[Mesh],
    made: &Bounded<Vec<Bounded<Mesh>>>,
    is_closed: bool,
    random: &mut Random,
) {
    assert_eq!(made.shape.len(), before.len(), "{name}");
    let mut worst = 0.0_f64;
    for (number, (old, new)) in before.iter().zip(&made.shape).enumerate() {
        let (mesh, most) = (&new.shape, new.bound.at_most().expect("proved"));
        assert_eq!(*new.bound.evidence(), Evidence::Proved);
        worst = worst.max(most);
        let open = |_, _| !is_closed;
        assert_eq!(flaw(mesh.positions().len(), mesh.faces(), open), None, "{name}: mesh {number}");
        if is_closed {
            let volume = volume6(mesh.positions(), mesh.faces());
            assert!(volume6(old.positions(), old.faces()) > 0.0 || volume <= 0.0, "{name}: mesh {number}");
        }
        let seen = apart(old, mesh, random);
        assert!(seen <= most + 1e-12 * 100.0, "{name}: mesh {number} is {seen:e} off, proved was {most:e}");
    }
    assert_eq!(made.bound.at_most(), Some(worst), "{name}");
    let (old, new) = (
        shared(&before.iter().collect::<Vec<_>>()),
        shared(&made.shape.iter().map(|m| &m.shape).collect::<Vec<_>>()),
    );
    // Where meshes are open, the ends of what they share are theirs, and get fewer vertices, too.
    for (pair, faces) in old.iter().filter(|_| is_closed) {
        let now = new.get(pair).unwrap_or_else(|| panic!("{name}: {pair:?} share nothing any more"));
        assert!(border(faces) == border(now), "{name}: what {pair:?} share has another border");
        assert!(now.len() <= faces.len(), "{name}: {pair:?}");
    }
}

#[test]
fn random_labels_keep_their_common_faces_and_stay_closed() {
    let seed = 0x5EED_1ABE;
    let mut random = Random::new(seed);
    let sheared =
        Affine3::new([[1.0, 0.25, 0.0, -3.0], [0.0, 0.75, 0.125, 5.0], [0.125, 0.0, -1.5, 7.0]]).unwrap();
    let mut fewer = 0.0;
    let n = if is_long() { 160 } else { 6 };
    for case in 0..n {
        let size = [0; 3].map(|_: i32| 3 + random.below(9));
        let (n_labels, noise) = (2 + random.below(5), [0, 0, 2, 20][random.below(4)]);
        let values = labels(&mut random, size, n_labels, noise);
        if values.iter().all(|label| *label == 0) {
            continue;
        }
        let affine = if random.below(3) == 0 { sheared } else { Affine3::IDENTITY };
        let border = if random.below(4) == 0 { Border::Open } else { Border::Capped };
        let meshes = meshes_of(size, values, affine, border);
        if meshes.iter().all(|mesh| mesh.faces().is_empty()) {
            continue;
        }
        let name = format!("case {case} of seed {seed:x}");
        let within = [0.05, 0.3, 0.6, 1.0, 3.0][random.below(5)];
        let made = made_on(&meshes, &length(within), 2);
        assert!(made.bound.at_most().expect("proved") <= within, "{name}");
        holds(&name, &meshes, &made, border == Border::Capped, &mut random);
        assert!(made == made_on(&meshes, &length(within), 1), "{name}: other bytes on one thread");
        let count =
            |all: &mut dyn Iterator<Item = &Mesh>| all.map(|mesh| mesh.faces().len()).sum::<usize>() as f64;
        let share = count(&mut made.shape.iter().map(|made| &made.shape)) / count(&mut meshes.iter());
        assert!(share <= 1.0);
        fewer += share / n as f64;
    }
    assert!(fewer < 0.75, "{fewer} of the triangles were left on average");
}

#[test]
fn a_count_is_for_all_meshes_together() {
    let mut random = Random::new(11);
    let size = if is_long() { [16, 15, 14] } else { [13, 12, 11] };
    let values = labels(&mut random, size, 4, 0);
    let meshes = meshes_of(size, values, Affine3::IDENTITY, Border::Capped);
    let n: usize = meshes.iter().map(|mesh| mesh.faces().len()).sum();
    let mut last = 0.0;
    for part in [1, 2] {
        let most = (n / part) as u64;
        let budget = Budget { triangles: Some(most), ..Budget::default() };
        let made = simplify_conforming(&meshes, &budget, &Job::default()).expect("reachable");
        let left: usize = made.shape.iter().map(|made| made.shape.faces().len()).sum();
        assert!(left as u64 <= most && left as f64 > 0.8 * most as f64, "{left} for {most}");
        holds(&format!("{most}"), &meshes, &made, true, &mut random);
        let most = made.bound.at_most().expect("proved");
        assert!(most >= last && (part == 1) == (most == 0.0), "{most} after {last}");
        last = most;
        let one = simplify_conforming(&meshes, &budget, &Job::default().with_threads(1)).expect("reachable");
        assert!(one == made, "other bytes on one thread");
    }
    // Fixed lines between labels and closed shapes have a least number.
    let budget = Budget { triangles: Some(3), ..Budget::default() };
    let Err(Failure::Unmet(best)) = simplify_conforming(&meshes, &budget, &Job::default()) else {
        panic!("three triangles are no labels")
    };
    holds("three", &meshes, &best, true, &mut random);
    let fewest: usize = best.shape.iter().map(|made| made.shape.faces().len()).sum();
    // A little more than that is reached.
    let most = fewest as u64 + fewest as u64 / 30;
    let budget = Budget { triangles: Some(most), ..Budget::default() };
    let made = simplify_conforming(&meshes, &budget, &Job::default()).expect("reachable");
    let left: usize = made.shape.iter().map(|made| made.shape.faces().len()).sum();
    assert!(left as u64 <= most, "{left} for {most}");
    // With a length, too, the count is a limit.
    let budget = Budget { triangles: Some(3), ..length(0.5) };
    let Err(Failure::Unmet(best)) = simplify_conforming(&meshes, &budget, &Job::default()) else {
        panic!("three triangles are no labels")
    };
    assert!(best.bound.at_most().expect("proved") <= 0.5);
}

/// A box with its faces outwards.
fn cuboid([x0, x1]: [f64; 2]) -> Mesh {
    let positions =
        (0..8).map(|c| [if c & 1 == 0 { x0 } else { x1 }, f64::from(c >> 1 & 1), f64::from(c >> 2)]);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new(positions.collect(), faces).expect("a box")
}

#[test]
fn odd_meshes_are_kept_or_refused() {
    let job = Job::default();
    let half = cuboid([0.0, 1.0]);
    let refused = |meshes: &[Mesh], budget: &Budget| match simplify_conforming(meshes, budget, &job) {
        Err(Failure::Refused(why)) => why.code,
        other => panic!("{other:?}"),
    };
    let one = std::slice::from_ref(&half);
    assert_eq!(refused(&[], &length(0.1)), RefusalCode::Empty);
    assert_eq!(refused(&[Mesh::default()], &length(0.1)), RefusalCode::Empty);
    assert_eq!(refused(one, &Budget::default()), RefusalCode::Budget);
    assert_eq!(refused(one, &Budget { angle_deg: Some(3.0), ..length(0.1) }), RefusalCode::Budget);
    let attributes = AttributeLimits::new(Some(0.5), None).expect("a limit");
    assert_eq!(refused(one, &Budget { attributes, ..length(0.1) }), RefusalCode::Budget);
    let normals = Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 8]);
    let with_normals = half.clone().with_attribute(normals).expect("normals");
    assert_eq!(refused(&[with_normals], &length(0.1)), RefusalCode::Unsupported);
    // The same box twice, one that it does not touch, none, and one beside it whose zeros have another sign.
    let turned = half.positions().iter().map(|p| p.map(|x| if x == 0.0 { -0.0 } else { x })).collect();
    let turned = half.with_positions(turned).expect("a box");
    let all = [half.clone(), half.clone(), cuboid([5.0, 6.0]), Mesh::default(), cuboid([-1.0, 0.0]), turned];
    let made = made_on(&all, &length(0.01), 2);
    for (before, made) in all.iter().zip(&made.shape) {
        assert_eq!((made.shape.faces().len(), made.bound.at_most()), (before.faces().len(), Some(0.0)));
    }
    // Flat faces and faces with one corner.
    let flat =
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![[0, 1, 2], [0, 0, 0]]).unwrap();
    let point = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    for budget in [length(0.01), length(1e300), Budget { triangles: Some(1), ..Budget::default() }] {
        let made = made_on(&[flat.clone(), point.clone(), half.clone()], &budget, 1);
        assert_eq!(made.shape.len(), 3);
    }
    // Boxes of lengths that no number has.
    let far =
        Mesh::new(vec![[-1e308, 0.0, 0.0], [1e308, 0.0, 0.0], [0.0, 1e308, 0.0]], vec![[0, 1, 2]]).unwrap();
    _ = simplify_conforming(&[far], &Budget { triangles: Some(0), ..Budget::default() }, &job);
}
