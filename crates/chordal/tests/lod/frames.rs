//! Frames and threads: the same mesh larger, elsewhere, twice, on more threads.
use super::{bounds, length, made, made_on, n_faces, shapes};
use chordal::check::validity;
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::{Budget, Job, Mesh};
use chordal_testkit::Random;

fn mapped(mesh: &Mesh, map: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    mesh.with_positions(mesh.positions().iter().map(|p| map(*p)).collect()).expect("finite")
}

fn some() -> [(&'static str, Mesh); 4] {
    [
        ("bumps", shapes::torus([80, 40], 0.1)),
        ("gear", shapes::gear(2, 7)),
        ("heights", shapes::heights([40, 40], 0.002)),
        ("mobius", shapes::mobius([60, 8])),
    ]
}

#[test]
fn a_mesh_scaled_by_a_power_of_two_gives_the_same_triangles() {
    for (name, mesh) in some() {
        for scale in chordal_testkit::some([1024.0, 2_f64.powi(300), 2_f64.powi(-300), 1.0 / 1024.0], 2) {
            let scaled = mapped(&mesh, |p| p.map(|x| x * scale));
            for (plain, large) in
                [(Budget::triangles(300), Budget::triangles(300)), (length(0.01), length(0.01 * scale))]
            {
                let (a, b) = (made(&mesh, &plain), made(&scaled, &large));
                assert!(n_faces(&a) < mesh.faces().len() / 2);
                assert_eq!(a.shape.mesh.faces(), b.shape.mesh.faces(), "{name} × {scale}");
                assert_eq!(
                    *b.shape.mesh.positions(),
                    *mapped(&a.shape.mesh, |p| p.map(|x| x * scale)).positions()
                );
            }
        }
    }
}

#[test]
fn a_mesh_far_from_zero_gives_as_many_triangles() {
    for (name, mesh) in some() {
        let moved = mapped(&mesh, |p| [p[0] + 1e6, p[1] - 1e6, p[2] + 1e6]);
        let (a, b) = (made(&mesh, &length(0.01)), made(&moved, &length(0.01)));
        let (n, m) = (n_faces(&a) as f64, n_faces(&b) as f64);
        assert!((n - m).abs() <= 0.01 * n, "{name}: {n} became {m}");
        assert!(b.bound.at_most().expect("proved") <= 0.01);
        // Held in coordinates around zero, so that the sampler's rounding does not count: 1e6 is taken off
        // without any.
        let back = |mesh: &Mesh| mapped(mesh, |p| [p[0] - 1e6, p[1] + 1e6, p[2] - 1e6]);
        let mut near = b.clone();
        near.shape.mesh = back(&b.shape.mesh);
        near.shape.worst = None;
        let seen = super::sampler::apart(&back(&moved), &near.shape.mesh, &mut Random::new(1));
        assert!(seen <= b.bound.at_most().expect("proved") * (1.0 + 1e-9), "{name}: {seen}");
    }
}

/// Itself again, 64 away: without rounding, since coordinates are those of f32.
fn twice(mesh: &Mesh) -> Mesh {
    let n = mesh.positions().len() as u32;
    let moved = mesh.positions().iter().map(|p| [p[0] + 64.0, p[1], p[2]]);
    let again = mesh.faces().iter().map(|face| face.map(|i| i + n));
    let positions = mesh.positions().iter().copied().chain(moved).collect();
    Mesh::new(positions, mesh.faces().iter().copied().chain(again).collect()).expect("valid")
}

#[test]
fn two_of_a_kind_far_apart_are_simplified_alike() {
    for (name, one) in [
        ("plate", shapes::plate(16)),
        ("torus", shapes::torus([60, 30], 0.0)),
        ("tray", shapes::tray(12, 0.01)),
    ] {
        let two = twice(&one);
        for budget in [length(0.01), Budget::triangles(two.faces().len() as u64 / 4)] {
            let out = made(&two, &budget).shape.mesh;
            let left = out.faces().iter().filter(|f| out.positions()[f[0] as usize][0] < 32.0).count();
            let right = out.faces().len() - left;
            // Quadrics about one origin are rounded there, which decides between edges of flat sides that
            // cost the same.
            let off = left.abs_diff(right) as f64;
            assert!(off <= 0.08 * left as f64 + 2.0, "{name}: {left} and {right}");
        }
    }
}

#[test]
fn a_thin_tray_keeps_its_walls() {
    let mesh = shapes::tray(20, 0.002);
    // Five times as much as the walls are thick, and less.
    for asked in [0.01, 0.001, 0.0001] {
        let made = made(&mesh, &length(asked));
        bounds::holds("tray", &mesh, &length(asked), &made, &mut Random::new(1));
        let found = validity(&made.shape.mesh, Topology::Positions);
        assert!(found.closed && found.manifold() && found.genus == Some(0), "{asked}: {found:?}");
        assert!(n_faces(&made) < 200, "{asked}: {} triangles", n_faces(&made));
        if asked < 0.002 {
            let off = (found.measure.signed_volume - 0.1 + 0.996 * 0.996 * 0.098).abs();
            assert!(off < asked * 2.8, "{asked}: volume is off by {off}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for (name, mesh) in some() {
        for budget in [Budget::triangles(200), length(0.003)] {
            let on = |threads| made_on(&mesh, &budget, &Job::default().with_threads(threads));
            let one = on(1);
            for threads in [2, 3] {
                let more = on(threads);
                assert!(one.shape == more.shape && one.bound == more.bound, "{name} on {threads}");
            }
        }
    }
}

/// Meshes that are simplified in regions: more than 65,536 triangles, some with borders, one with values that follow places.
fn large() -> [(&'static str, Mesh); 3] {
    let heights = shapes::heights([200, 180], 0.0005);
    let values = heights.positions().iter().flat_map(|p| [p[0], p[1]]).collect();
    let texcoord = Attribute { semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values };
    let textured = heights.with_attribute(texcoord).expect("two numbers a vertex");
    [("bumps", shapes::torus([300, 150], 0.1)), ("heights", textured), ("gear", shapes::gear(14, 60))]
}

#[test]
fn regions_are_the_same_on_any_number_of_threads_and_leave_no_trace() {
    // By default the one with borders and values: each takes four seconds.
    for (name, mesh) in
        large().into_iter().filter(|(name, _)| chordal_testkit::is_long() || *name == "heights")
    {
        assert!(mesh.faces().len() > 70_000, "{name}: {} triangles", mesh.faces().len());
        let size = mesh.bounds().diagonal();
        for share in chordal_testkit::some([5e-4, 5e-5], 1) {
            let budget = length(share * size);
            let on = |threads| made_on(&mesh, &budget, &Job::default().with_threads(threads));
            let (one, more) = (on(1), on(3));
            assert!(one.shape == more.shape && one.bound == more.bound, "{name}");
            assert!(one.bound.at_most().is_some_and(|most| most <= share * size), "{name}: {:?}", one.bound);
            let [before, after] = [&mesh, &one.shape.mesh].map(|mesh| validity(mesh, Topology::Indices));
            assert_eq!(
                (after.closed, after.manifold(), after.genus),
                (before.closed, before.manifold(), before.genus)
            );
            if let Some(texcoord) = one.shape.mesh.attribute(&Semantic::TexCoord(0)) {
                for (row, p) in one.shape.mesh.positions().iter().enumerate() {
                    let off = (0..2).map(|k| (texcoord.row(row)[k] - p[k]).abs()).fold(0.0, f64::max);
                    assert!(off < 0.05 * size, "{off} at {p:?}");
                }
            }
        }
    }
}
