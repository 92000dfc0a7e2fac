//! Bounds: no point of either surface is farther than promised, and the worst pair is as far as it is said to
//! be.
use super::sampler::{apart, triangles};
use super::{data, length, made, n_faces, shapes};
use chordal::budget::Evidence;
use chordal::lod::SimplifiedMesh;
use chordal::{Bounded, Budget, Mesh};
use chordal_testkit::sampler::{norm, sub};
use chordal_testkit::{Random, is_long, some};

/// What the arithmetic of the sampler may be off by, as a share of the coordinates: a thousand roundings,
/// since needles have no good normal.
const SLACK: f64 = 1e-12;

/// Of a length, the fraction by which both ends of a bound may differ beside a tenth.
const CLOSE: f64 = 0.01;

/// The same of the diagonal, where there is no length.
const TINY: f64 = 1e-9;

/// Holds what came out for a budget against the mesh.
pub fn holds(name: &str, mesh: &Mesh, budget: &Budget, made: &Bounded<SimplifiedMesh>, random: &mut Random) {
    let out = &made.shape.mesh;
    let reach = mesh.positions().as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let slack = SLACK * reach;
    assert_eq!(*made.bound.evidence(), Evidence::Proved);
    let (least, most) = (made.bound.at_least(), made.bound.at_most().expect("proved"));
    let seen = apart(mesh, out, random);
    assert!(seen <= most + slack, "{name}: a point is {seen:e} away, proved was {most:e}");
    let diagonal = mesh.bounds().diagonal();
    let width = budget.length.map_or(TINY * diagonal, |length| CLOSE * length.get().min(diagonal));
    let width = width + 1024.0 * f64::EPSILON * diagonal;
    assert!(most <= (1.1 + CLOSE) * least + width, "{name}: [{least:e}, {most:e}] is wide");
    if let Some(worst) = &made.shape.worst {
        let trees = [triangles(mesh), triangles(out)];
        let off = trees.map(|tree| tree.distance(worst.from));
        let (own, far) = (off[0].min(off[1]), off[0].max(off[1]));
        assert!(own <= slack, "{name}: the worst point is {own:e} off both surfaces");
        assert!(far >= least - slack, "{name}: the worst point is {far:e} away, said was {least:e}");
        let pair = norm(sub(worst.from, worst.to));
        assert!((pair - far).abs() <= slack, "{name}: the worst pair is {pair:e} apart, not {far:e}");
    } else {
        assert!(least == 0.0 && seen <= slack + width, "{name}: no worst pair, but {seen:e}");
    }
}

fn solids() -> Vec<(&'static str, Mesh)> {
    vec![
        ("torus", shapes::torus([60, 30], 0.0)),
        ("bumps", shapes::torus([80, 40], 0.1)),
        ("sphere", shapes::sphere(4)),
        ("lobes", shapes::lobes(4)),
        ("gear", shapes::gear(2, 7)),
        ("shaft", shapes::shaft(60)),
        ("plate", shapes::plate(16)),
        ("heights", shapes::heights([40, 40], 0.002)),
        ("tray", shapes::tray(20, 0.002)),
        ("mobius", shapes::mobius([60, 8])),
    ]
}

fn drawn() -> Vec<(&'static str, Mesh)> {
    let names = [
        "common/data/spot.obj",
        "common/data/cow.obj",
        "common/data/suzanne.obj",
        "common/data/beetle.obj",
        "common/data/teapot.obj",
        "odedstein/objects/wingnut/wingnut.obj",
        "trimesh/models/quadknot.obj",
        "libigl/truck.obj",
    ];
    some(names, 3).into_iter().filter_map(|name| data::obj(name).map(|mesh| (name, mesh))).collect()
}

/// One of three in the order of the meshes, or all of them in the long sweep.
fn by_turns(all: [f64; 3], number: usize) -> Vec<f64> {
    if is_long() { all.to_vec() } else { vec![all[number % 3]] }
}

fn counts_hold(meshes: Vec<(&str, Mesh)>) {
    let mut random = Random::new(1);
    for (number, (name, mesh)) in some(meshes, 5).into_iter().enumerate() {
        for share in by_turns([0.5, 0.1, 0.01], number) {
            let most = (share * mesh.faces().len() as f64).ceil() as u64;
            let budget = Budget::triangles(most);
            let made = made(&mesh, &budget);
            eprintln!("{name} to {most}: {} triangles", n_faces(&made));
            holds(&format!("{name} to {most}"), &mesh, &budget, &made, &mut random);
        }
    }
}

fn lengths_hold(meshes: Vec<(&str, Mesh)>) {
    let mut random = Random::new(2);
    for (number, (name, mesh)) in some(meshes, 5).into_iter().enumerate() {
        for share in by_turns([1e-2, 1e-3, 1e-4], number) {
            let asked = share * mesh.bounds().diagonal();
            let made = made(&mesh, &length(asked));
            eprintln!("{name} within {share:e}: {} of {}", n_faces(&made), mesh.faces().len());
            let most = made.bound.at_most().expect("proved");
            assert!(most <= asked, "{name} within {share:e}: {most:e} of {asked:e}");
            holds(&format!("{name} within {share:e}"), &mesh, &length(asked), &made, &mut random);
        }
    }
}

#[test]
fn bounds_of_counts_hold_on_solids() {
    counts_hold(solids());
}

#[test]
fn bounds_of_counts_hold_on_meshes_that_people_drew() {
    counts_hold(drawn());
}

#[test]
fn bounds_of_lengths_hold_on_solids() {
    lengths_hold(solids());
}

#[test]
fn bounds_of_lengths_hold_on_meshes_that_people_drew() {
    lengths_hold(drawn());
}

/// Where attempt after attempt was too far in the same places, the mesh used to come back as it was.
#[test]
fn a_length_that_needs_many_close_looks_is_reached() {
    let Some(mesh) = data::obj("common/data/fandisk.obj") else { return };
    let asked = 1e-4 * mesh.bounds().diagonal();
    let made = made(&mesh, &length(asked));
    assert!(n_faces(&made) < 2400, "{} triangles", n_faces(&made));
    assert!(made.bound.at_most().expect("proved") <= asked);
    holds("fandisk", &mesh, &length(asked), &made, &mut Random::new(3));
}

#[test]
fn the_sampler_sees_what_is_off() {
    let mesh = shapes::sphere(3);
    let moved: Vec<_> =
        mesh.positions().iter().map(|p| if p[2] > 0.9 { p.map(|x| 1.01 * x) } else { *p }).collect();
    let moved = Mesh::new(moved, mesh.faces().to_vec()).expect("valid");
    let seen = apart(&mesh, &moved, &mut Random::new(1));
    assert!((0.009..0.0101).contains(&seen), "{seen}");
}
