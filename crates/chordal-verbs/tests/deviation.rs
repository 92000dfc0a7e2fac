//! Deviations of real files: the ends are as close as was asked for, each file is 0 away from itself.
use crate::common;
use chordal::Job;
use chordal::explicit::Topology;
use chordal::{Mesh, check};
use chordal_testkit::Random;
use chordal_testkit::sampler::{Triangles, on};
use chordal_verbs::{FormatHint, Input, Shape, load};

fn read(path: &std::path::Path) -> Option<Input> {
    let bytes = std::fs::read(path).ok()?;
    let name = path.file_name()?.to_str()?;
    load(&bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Default::default()).ok()
}

fn mesh_of(input: Input) -> Option<Mesh> {
    let Shape::Scene(scene) = input.shape else { return None };
    let part = scene.parts.into_iter().max_by_key(|part| part.mesh.faces().len())?;
    (!part.mesh.faces().is_empty()).then_some(part.mesh)
}

/// Every vertex halfway to the middle of its neighbours: a surface near the first, with the same triangles.
fn relaxed(mesh: &Mesh) -> Mesh {
    let ids = Topology::Positions.ids(mesh).expect("ids");
    let n = mesh.positions().len();
    let (mut sums, mut counts) = (vec![[0.0; 3]; n], vec![0.0; n]);
    for face in mesh.faces() {
        for k in 0..3 {
            let (from, to) = (ids[face[k] as usize] as usize, face[(k + 1) % 3] as usize);
            (0..3).for_each(|axis| sums[from][axis] += mesh.positions()[to][axis]);
            counts[from] += 1.0;
        }
    }
    let at = |row: usize| -> [f64; 3] {
        let id = ids[row] as usize;
        let p = mesh.positions()[row];
        if counts[id] == 0.0 {
            p
        } else {
            std::array::from_fn(|k| 0.5 * p[k] + 0.5 * sums[id][k] / counts[id])
        }
    };
    Mesh::new((0..n).map(at).collect(), mesh.faces().to_vec()).expect("finite")
}

#[test]
fn the_ends_are_close_on_every_file_of_the_corpus() {
    let files = common::files(400_000);
    let mut n_pairs = 0;
    for path in &files {
        let Some(mesh) = read(path).and_then(mesh_of) else { continue };
        let size = mesh.bounds().diagonal();
        let goal = check::Goal::default();
        let job = Job::default();
        let itself = check::deviation(&mesh, &mesh, &goal, &job).unwrap();
        assert_eq!(itself.bound.at_most(), Some(0.0), "{}", path.display());
        let found = check::deviation(&mesh, &relaxed(&mesh), &goal, &job).unwrap();
        let (least, most) = (found.bound.at_least(), found.bound.at_most().unwrap());
        assert!(
            found.reached && most <= 1.1 * least + 16.0 * f64::EPSILON * size,
            "{}: {found:?}",
            path.display()
        );
        let seen = sampled([&mesh, &relaxed(&mesh)], &mut Random::new(n_pairs));
        // The sampler's own rounding, on coordinates that may be far from zero.
        let slack = 1e-12 * (size + mesh.bounds().max.iter().fold(0.0_f64, |most, x| most.max(x.abs())));
        assert!(seen <= most + slack, "{}: a point is {seen:e} away, proved was {most:e}", path.display());
        n_pairs += 1;
    }
    assert!(files.is_empty() || n_pairs > 30, "only {n_pairs} files were read");
}

/// The largest distance of some points of either mesh to the other, by the sampler.
fn sampled(meshes: [&Mesh; 2], random: &mut Random) -> f64 {
    let soups = meshes.map(|mesh| Triangles::new(mesh.positions(), mesh.faces()));
    let mut most = 0.0_f64;
    for (from, to) in [(&soups[0], &soups[1]), (&soups[1], &soups[0])] {
        for _ in 0..24 {
            let triangle = from.corners[random.below(from.corners.len())];
            most = most.max(to.distance(on(triangle, random.weights())));
        }
    }
    most
}
