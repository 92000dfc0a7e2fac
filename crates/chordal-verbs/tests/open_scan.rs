//! Row 59 of the hostile inputs: an open scan has no sign of its own, and is never given a wrong one quietly.
use chordal::explicit::query::{Bvh, Containment, Enclosure, PointLocation};
use chordal::math::Box3;
use chordal::{Job, Mesh};
use chordal_testkit::corpus;
use chordal_verbs::{FormatHint, Shape, load};

/// The unit sphere in `2n` times `n` quads, without the faces that reach above `cut`.
fn bowl(n: u32, cut: f64) -> Mesh {
    let at = |i: u32, j: u32| {
        let (around, down) = (f64::from(i % (2 * n)), f64::from(j));
        let (turn, fall) =
            (std::f64::consts::PI * around / f64::from(n), std::f64::consts::PI * down / f64::from(n));
        [fall.sin() * turn.cos(), fall.sin() * turn.sin(), fall.cos()]
    };
    let number = |i: u32, j: u32| (i % (2 * n)) * (n + 1) + j;
    let positions: Vec<[f64; 3]> = (0..2 * n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
    let quads = (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    let below = |face: &[u32; 3]| face.iter().all(|&row| positions[row as usize][2] <= cut);
    let faces = faces.filter(below).collect();
    Mesh::new(positions, faces).unwrap()
}

/// The policy: a side is only said where the winding number, with its error, is on that side of its
/// threshold.
fn is_said_as_it_is(Containment { side, winding }: Containment) -> bool {
    let (least, most) = (winding.value - winding.off_at_most, winding.value + winding.off_at_most);
    match side {
        PointLocation::Inside => least > 0.75,
        PointLocation::Outside => most < 0.25,
        PointLocation::Ambiguous => least <= 0.75 && most >= 0.25,
        PointLocation::On => winding.value.is_nan(),
    }
}

#[test]
fn h59_an_open_sphere_says_inside_outside_or_ambiguous_and_never_the_wrong_one() {
    let mesh = bowl(24, 0.5);
    let bvh = Bvh::build(&mesh, &Job::default()).unwrap();
    let enclosure = Enclosure::new(&mesh, &bvh);
    assert!(!enclosure.is_closed());
    // The cap that is missing, seen from the axis at height z, has the solid angle 2π(1 − cos), so that it
    // hides as much less: near the bottom all is clear, in the plane of the rim it is a half.
    for z in [-0.9, -0.5, 0.0, 0.3, 0.5, 0.8, 1.2, 3.0] {
        let found = enclosure.inside([0.01, 0.02, z]);
        let up = 0.5 - z;
        let rim = 0.75_f64.sqrt();
        let hidden = (1.0 + up / (up * up + rim * rim).sqrt()) / 2.0;
        // The polygon is not the sphere, and the point not on the axis.
        assert!(
            (found.winding.value - hidden).abs() < 0.08 + found.winding.off_at_most,
            "{z}: {found:?}, {hidden}"
        );
        assert!(is_said_as_it_is(found), "{z}: {found:?}");
    }
    let side = |z: f64| enclosure.inside([0.01, 0.02, z]).side;
    assert_eq!(
        [-0.5, 0.5, 3.0].map(side),
        [PointLocation::Inside, PointLocation::Ambiguous, PointLocation::Outside]
    );
    // Against the whole sphere: nobody is told the other side.
    let (mut n_sure, mut n_ambiguous) = (0, 0);
    for k in 0..4096_u32 {
        let p: [f64; 3] = [(k % 16), (k / 16 % 16), (k / 256)].map(|i| (f64::from(i) - 7.4) / 5.0);
        let r = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
        let found = enclosure.inside(p);
        assert!(is_said_as_it_is(found), "{p:?}: {found:?}");
        match found.side {
            PointLocation::Ambiguous => n_ambiguous += 1,
            // Between the polygon and the sphere, and above the rim, where the wall is missing, there is no
            // truth.
            _ if (0.97..1.01).contains(&r) || p[2] > 0.3 => {}
            PointLocation::Inside => assert!(r < 1.0, "{p:?}: {found:?}"),
            _ => assert!(r > 0.97, "{p:?}: {found:?}"),
        }
        n_sure += u32::from(found.side != PointLocation::Ambiguous);
    }
    assert!(n_ambiguous > 20 && n_sure > 3000, "{n_ambiguous} ambiguous, {n_sure} sure");
}

#[test]
fn h59_an_open_scan_says_inside_outside_or_ambiguous_with_its_winding_number() {
    let Some(path) = corpus::find("mesh/bunny/testdata/bun_zipper.ply") else { return };
    let bytes = std::fs::read(path).unwrap();
    let input = load(
        &bytes,
        FormatHint { name: Some("bun_zipper.ply"), ..FormatHint::default() },
        &Default::default(),
    );
    let Shape::Scene(scene) = input.unwrap().shape else { panic!("triangles") };
    let mesh = &scene.parts[0].mesh;
    let bvh = Bvh::build(mesh, &Job::default()).unwrap();
    let enclosure = Enclosure::new(mesh, &bvh);
    assert!(!enclosure.is_closed(), "223 boundary edges");
    let Box3 { min, max } = mesh.bounds();
    let at = |t: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| min[k] + t[k] * (max[k] - min[k])) };
    let mut met = [0; 3];
    for k in 0..1000_u32 {
        let p = at([k % 10, k / 10 % 10, k / 100].map(|i| (f64::from(i) + 0.5) / 10.0));
        let found = enclosure.inside(p);
        assert!(is_said_as_it_is(found), "{p:?}: {found:?}");
        match found.side {
            PointLocation::Inside => met[0] += 1,
            PointLocation::Outside => met[1] += 1,
            _ => met[2] += 1,
        }
        // The plain sum over all faces says the same number.
        if k % 50 == 0 {
            let plain = bvh.winding_number_plain(p).unwrap();
            let off = (plain.value - found.winding.value).abs();
            assert!(off <= plain.off_at_most + found.winding.off_at_most, "{p:?}: {found:?}, {plain:?}");
        }
    }
    assert!(met[0] > 100 && met[1] > 300 && met[2] < 50, "{met:?}");
    let found = chordal::check::validity(mesh, chordal::explicit::Topology::Indices);
    assert_eq!(found.boundary_edges.count, 223);
}
