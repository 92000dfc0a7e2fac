//! Meshes by chance: whatever the topology, the bound holds and nothing breaks.
use super::{bounds, length, made, n_faces, shapes};
use chordal::check::validity;
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::{Budget, Mesh};
use chordal_testkit::Random;
use chordal_testkit::{cases, is_long};

/// Faces between rows by chance: edges with many faces, vertices with many fans, faces twice and without
/// area.
fn soup(random: &mut Random) -> Mesh {
    let n = 4 + random.below(40);
    let m = 1 + random.below(120);
    // On a coarse lattice, so that rows meet.
    let coarse = random.below(2) == 0;
    let at = |random: &mut Random| -> [f64; 3] {
        random.point::<3>().map(|x| if coarse { (2.0 * x).round() } else { x })
    };
    let positions = (0..n).map(|_| at(random)).collect();
    let faces = (0..m).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
    Mesh::new(positions, faces).expect("valid")
}

/// A surface with holes torn in it, faces turned, rows torn apart and others put together.
fn torn(random: &mut Random) -> Mesh {
    let whole = match random.below(5) {
        0 => shapes::torus([16, 10], 0.1),
        1 => shapes::sphere(3),
        2 => shapes::mobius([30, 5]),
        3 => shapes::heights([14, 14], 0.02),
        _ => shapes::tray(6, 0.01),
    };
    let mut positions = whole.positions().to_vec();
    let mut faces = whole.faces().to_vec();
    for _ in 0..random.below(30) {
        faces.swap_remove(random.below(faces.len()));
    }
    for _ in 0..random.below(6) {
        let face = random.below(faces.len());
        faces[face].swap(0, 1);
    }
    for _ in 0..random.below(6) {
        let (a, b) = (random.below(positions.len()) as u32, random.below(positions.len()) as u32);
        faces.iter_mut().flatten().filter(|i| **i == a).for_each(|i| *i = b);
    }
    for _ in 0..random.below(6) {
        let row = positions.len() as u32;
        let (face, k) = (random.below(faces.len()), random.below(3));
        positions.push(positions[faces[face][k] as usize]);
        faces[face][k] = row;
    }
    Mesh::new(positions, faces).expect("valid")
}

/// Values of every kind, in every domain, with jumps by chance.
fn dressed(mesh: Mesh, random: &mut Random) -> Mesh {
    let mut mesh = mesh;
    let kinds = [
        (Semantic::TexCoord(0), 2),
        (Semantic::Normal, 3),
        (Semantic::Tangent, 4),
        (Semantic::Color(0), 4),
        (Semantic::Group("m".into()), 1),
        (Semantic::Custom("x".into()), 5),
    ];
    for (semantic, width) in kinds {
        let (domain, rows) = match random.below(4) {
            0 => (Domain::Vertex, mesh.positions().len()),
            1 => (Domain::Corner, 3 * mesh.faces().len()),
            2 => (Domain::Face, mesh.faces().len()),
            _ => continue,
        };
        let jumps = random.below(4);
        let one =
            |random: &mut Random| if random.below(20) < jumps { random.between(-1.0, 1.0) } else { 0.5 };
        let values = (0..rows * width).map(|_| one(random)).collect();
        mesh = mesh.with_attribute(Attribute { semantic, domain, width, values }).expect("it fits");
    }
    mesh
}

fn held(seed: u64, mesh: &Mesh, random: &mut Random) {
    let n = mesh.faces().len();
    let size = mesh.bounds().diagonal();
    if size == 0.0 {
        return;
    }
    let budget = match random.below(3) {
        0 => Budget::triangles(random.below(n + 1) as u64),
        _ => length(size * random.power(-5.0, -0.5)),
    };
    let made = made(mesh, &budget);
    let name = format!("seed {seed}, {budget:?}");
    bounds::holds(&name, mesh, &budget, &made, random);
    if let Some(asked) = budget.length {
        assert!(made.bound.at_most().expect("proved") <= asked.get(), "{name}");
    }
    let out = &made.shape.mesh;
    assert_eq!(out.attributes().len(), mesh.attributes().len(), "{name}: an attribute is gone");
    for (a, b) in mesh.attributes().iter().zip(out.attributes()) {
        assert_eq!((&a.semantic, a.domain, a.width), (&b.semantic, b.domain, b.width), "{name}");
    }
    let (before, after) = (validity(mesh, Topology::Positions), validity(out, Topology::Positions));
    assert!(
        n_faces(&made) <= n && (after.non_manifold_edges.count <= before.non_manifold_edges.count),
        "{name}"
    );
    // Pieces that went, and faces without a surface that were left out, take away what they had.
    if made.shape.stats.dropped_components + before.collapsed_faces.count == 0 {
        assert_eq!(before.non_manifold_edges.count, after.non_manifold_edges.count, "{name}");
        assert_eq!(before.inconsistent_edges.count, after.inconsistent_edges.count, "{name}");
        assert_eq!(before.components, after.components, "{name}");
        assert_eq!(before.euler, after.euler, "{name}");
    }
}

#[test]
fn faces_by_chance_are_within_their_bound() {
    for seed in 0..if is_long() { 150 } else { 5 } {
        let mut random = Random::new(seed);
        let mesh = soup(&mut random);
        let mesh = if random.below(2) == 0 { dressed(mesh, &mut random) } else { mesh };
        held(seed, &mesh, &mut random);
    }
}

#[test]
fn torn_surfaces_are_within_their_bound() {
    for seed in 0..cases(15) as u64 {
        let mut random = Random::new(seed + 1_000_000);
        let mesh = torn(&mut random);
        let mesh = if random.below(2) == 0 { dressed(mesh, &mut random) } else { mesh };
        held(seed, &mesh, &mut random);
    }
}
