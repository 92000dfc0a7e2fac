//! Flat shading: normals of faces cost nothing, and come out as normals of faces.
use super::{length, made, n_faces, shapes};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_testkit::sampler::{Point, cross, dot, norm, sub};

fn normal(t: [Point; 3]) -> Point {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    n.map(|x| x / norm(n))
}

/// A mesh with the normal of each face, as f32 holds it.
fn shaded(mesh: &Mesh, domain: Domain) -> Mesh {
    let normals: Vec<Point> =
        (0..mesh.faces().len()).map(|f| normal(mesh.corners(f)).map(|x| f64::from(x as f32))).collect();
    let of = |normals: Vec<Point>| Attribute {
        semantic: Semantic::Normal,
        domain,
        width: 3,
        values: normals.as_flattened().to_vec(),
    };
    match domain {
        Domain::Face => mesh.clone().with_attribute(of(normals)),
        Domain::Corner => mesh.clone().with_attribute(of(normals.iter().flat_map(|n| [*n; 3]).collect())),
        Domain::Vertex => {
            let positions = mesh.faces().as_flattened().iter().map(|row| mesh.positions()[*row as usize]);
            let faces = (0..mesh.faces().len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]);
            let apart = Mesh::new(positions.collect(), faces.collect()).expect("valid");
            apart.with_attribute(of(normals.iter().flat_map(|n| [*n; 3]).collect()))
        }
    }
    .expect("it fits")
}

fn normals_at(mesh: &Mesh, face: usize) -> [Point; 3] {
    let a = mesh.attribute(&Semantic::Normal).expect("normals");
    let at = |k: usize| match a.domain {
        Domain::Face => face,
        Domain::Corner => 3 * face + k,
        Domain::Vertex => mesh.faces()[face][k] as usize,
    };
    [0, 1, 2].map(|k| [0, 1, 2].map(|i| a.row(at(k))[i]))
}

#[test]
fn flat_shading_costs_no_triangle_and_stays() {
    // The second has edges of 30° and more all over, the third is flat itself.
    for mesh in [shapes::lobes(4), shapes::sphere(1), shapes::gear(2, 7), shapes::tray(12, 0.02)] {
        let asked = length(0.05);
        let plain = made(&mesh, &asked);
        for domain in [Domain::Vertex, Domain::Corner, Domain::Face] {
            let made = made(&shaded(&mesh, domain), &asked);
            assert_eq!(n_faces(&made), n_faces(&plain), "{domain:?}");
            let out = &made.shape.mesh;
            for face in 0..out.faces().len() {
                let own = normal(out.corners(face));
                let [a, b, c] = normals_at(out, face);
                // Sides that are flat share theirs.
                assert!(norm(sub(a, own)) < 2e-3 && a == b && a == c, "{domain:?}: {a:?} is not {own:?}");
            }
        }
    }
}

#[test]
fn rows_of_one_normal_are_shared() {
    let sides = [0.0, 1.0, 2.0, 3.0];
    let cube = shaded(&shapes::blocks([&sides, &sides, &sides], |_| true), Domain::Vertex);
    let out = made(&cube, &length(1e-3)).shape.mesh;
    assert_eq!((out.faces().len(), out.positions().len(), out.n_positions()), (12, 24, 8));
}

#[test]
fn creases_of_smooth_normals_stay_where_they_are() {
    // A cylinder in 64 sides and 8 layers, smooth along its side, with a hard edge to its caps.
    let n = 64;
    let (mut positions, mut normals, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    let ring = |z: f64, i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
        [cos, sin, z]
    };
    for j in 0..=8 {
        for i in 0..n {
            let p = ring(f64::from(j) / 4.0, i);
            positions.push(p);
            normals.push([p[0], p[1], 0.0]);
        }
    }
    for j in 0..8 {
        for i in 0..n {
            let [a, b] = [j * n + i, j * n + (i + 1) % n];
            faces.extend([[a, b, b + n], [a, b + n, a + n]]);
        }
    }
    for (z, up) in [(0.0, -1.0), (2.0, 1.0)] {
        let first = positions.len() as u32;
        positions.push([0.0, 0.0, z]);
        positions.extend((0..n).map(|i| ring(z, i)));
        normals.resize(positions.len(), [0.0, 0.0, up]);
        faces.extend((0..n).map(|i| {
            let [a, b] = [first + 1 + i, first + 1 + (i + 1) % n];
            if up > 0.0 { [first, a, b] } else { [first, b, a] }
        }));
    }
    let mesh = Mesh::new(positions, faces).expect("valid");
    let mesh = mesh.with_attribute(Attribute::vertex_normals(&normals)).expect("it fits");
    let out = made(&mesh, &length(0.02)).shape.mesh;
    assert!(out.faces().len() < 200, "{} triangles", out.faces().len());
    for face in 0..out.faces().len() {
        let t = out.corners(face);
        let cap = (t[0][2] == t[1][2] && t[0][2] == t[2][2]).then_some(t[0][2] - 1.0);
        for (p, n) in t.iter().zip(normals_at(&out, face)) {
            assert!((norm(n) - 1.0).abs() < 1e-9);
            match cap {
                Some(up) => assert_eq!(n, [0.0, 0.0, up]),
                // Along the side outwards, up to a chord of what was allowed.
                None => {
                    let out = p[0].hypot(p[1]);
                    assert!(n[2].abs() < 1e-9 && dot(n, [p[0] / out, p[1] / out, 0.0]) > 0.97, "{p:?} {n:?}");
                }
            }
            assert!((p[2] == 0.0 || p[2] == 2.0) || cap.is_none());
        }
    }
}
