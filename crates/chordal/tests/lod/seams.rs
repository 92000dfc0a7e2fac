//! Seams: values belong to their chart, and lines between charts stay where they are.
use super::sampler::triangles;
use super::{length, made, n_faces, shapes};
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::{Budget, Mesh};
use chordal_testkit::Random;
use chordal_testkit::sampler::{closest_weights, norm, on, sub};
use std::f64::consts::TAU;

/// Values at the corners of a mesh.
fn at_corners(mesh: &Mesh, semantic: Semantic, of: impl Fn(usize, usize) -> Vec<f64>) -> Attribute {
    let values: Vec<Vec<f64>> =
        (0..mesh.faces().len()).flat_map(|f| [0, 1, 2].map(|k| (f, k))).map(|(f, k)| of(f, k)).collect();
    Attribute { semantic, domain: Domain::Corner, width: values[0].len(), values: values.concat() }
}

/// The same with values of corners as values of vertices: rows part where values do.
fn at_vertices(mesh: &Mesh) -> Mesh {
    let a = &mesh.attributes()[0];
    let mut rows = std::collections::BTreeMap::new();
    let (mut positions, mut values, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (f, face) in mesh.faces().iter().enumerate() {
        faces.push([0, 1, 2].map(|k| {
            let value = a.row(3 * f + k);
            let key = (face[k], value.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
            *rows.entry(key).or_insert_with(|| {
                positions.push(mesh.positions()[face[k] as usize]);
                values.extend_from_slice(value);
                positions.len() as u32 - 1
            })
        }));
    }
    let attribute = Attribute { domain: Domain::Vertex, values, ..a.clone() };
    Mesh::new(positions, faces).expect("valid").with_attribute(attribute).expect("it fits")
}

fn values(mesh: &Mesh, face: usize, w: [f64; 3]) -> Vec<f64> {
    let a = &mesh.attributes()[0];
    let at = |k: usize| match a.domain {
        Domain::Face => a.row(face),
        Domain::Corner => a.row(3 * face + k),
        Domain::Vertex => a.row(mesh.faces()[face][k] as usize),
    };
    (0..a.width).map(|i| (0..3).map(|k| w[k] * at(k)[i]).sum()).collect()
}

/// How far the values at points of one surface are from those of the other close by, at most.
fn smeared(from: &Mesh, to: &Mesh, reach: f64) -> f64 {
    let (tree, mut random, mut most) = (triangles(to), Random::new(7), 0.0_f64);
    for face in 0..from.faces().len() {
        for _ in 0..(20_000 / from.faces().len()).max(3) {
            let w = random.weights();
            let p = on(from.corners(face), w);
            let own = values(from, face, w);
            let off = |other: usize| {
                let there = values(to, other, closest_weights(p, to.corners(other)));
                own.iter().zip(&there).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            // At a seam either side may be the right one.
            let near = tree.within(p, reach);
            assert!(!near.is_empty(), "nothing within {reach} of {p:?}");
            most = most.max(near.into_iter().map(off).fold(f64::INFINITY, f64::min));
        }
    }
    most
}

fn both_ways(a: &Mesh, b: &Mesh, reach: f64) -> f64 {
    smeared(a, b, reach).max(smeared(b, a, reach))
}

/// A torus with texture coordinates around both ways, and a seam along each.
fn torus() -> Mesh {
    let [n, m] = [80_u32, 40];
    let mesh = shapes::torus([n, m], 0.0);
    let faces = mesh.faces().to_vec();
    let uv = |f: usize, k: usize| {
        let (row, cell) = (faces[f][k], f as u32 / 2);
        // A corner at the far side of the last cells is at 1 and not at 0.
        let wrap = |at: u32, cell: u32, n: u32| if at < cell { n } else { at };
        let (i, j) = (wrap(row / m, cell / m, n), wrap(row % m, cell % m, m));
        vec![f64::from(i) / f64::from(n), f64::from(j) / f64::from(m)]
    };
    let uv = at_corners(&mesh, Semantic::TexCoord(0), uv);
    mesh.with_attribute(uv).expect("it fits")
}

#[test]
fn a_seam_around_a_torus_does_not_smear() {
    for mesh in [torus(), at_vertices(&torus())] {
        // A long triangle is straight where coordinates are round: they slide by two cells and more, and not
        // by a chart.
        for (asked, most) in [(0.003, 0.05), (0.01, 0.1)] {
            let made = made(&mesh, &length(asked));
            let out = &made.shape.mesh;
            let plain = n_faces(&super::made(&shapes::torus([80, 40], 0.0), &length(asked)));
            assert!(10 * n_faces(&made) < 13 * plain, "{} triangles, {plain} without", n_faces(&made));
            let off = both_ways(&mesh, out, 2.0 * asked);
            assert!(off < most, "{off} within {asked}");
            // No triangle spans the texture: that is what a smear looks like.
            for face in 0..out.faces().len() {
                let [a, b, c] =
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|w| values(out, face, w));
                for i in 0..2 {
                    let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
                    assert!(low >= 0.0 && high <= 1.0 && high - low < 0.4, "from {low} to {high}");
                }
            }
        }
    }
}

/// A box whose six sides are unwrapped to cells of a 3 × 2 atlas, with a margin.
fn atlas() -> Mesh {
    let cuts: Vec<f64> = (0..=12).map(|i| f64::from(i) / 12.0).collect();
    let mesh = shapes::blocks([&cuts, &cuts, &cuts], |_| true);
    let corners: Vec<_> = (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect();
    let uv = |f: usize, k: usize| {
        let t = corners[f];
        let axis = (0..3).find(|k| t[0][*k] == t[1][*k] && t[0][*k] == t[2][*k]).expect("on a side");
        let p = t[k];
        let (u, v) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
        vec![(axis as f64 + 0.1 + 0.8 * u) / 3.0, (t[0][axis] + 0.1 + 0.8 * v) / 2.0]
    };
    let uv = at_corners(&mesh, Semantic::TexCoord(0), uv);
    mesh.with_attribute(uv).expect("it fits")
}

#[test]
fn charts_of_an_atlas_stay_apart_and_exact() {
    for mesh in [atlas(), at_vertices(&atlas())] {
        for budget in [length(1e-3), Budget::triangles(12)] {
            let made = made(&mesh, &budget);
            let out = &made.shape.mesh;
            // Twelve would do; what is left lies on the seams.
            assert!(n_faces(&made) <= 16, "{} triangles", n_faces(&made));
            // Straight lines on flat sides: nothing slides.
            assert!(both_ways(&mesh, out, 1e-6) < 1e-9);
        }
    }
}

/// A flat square of 20 × 20 cells with one material below a wavy line and another above.
fn two_materials() -> Mesh {
    let flat = shapes::heights([20, 20], 0.0);
    let mesh =
        flat.with_positions(flat.positions().iter().map(|p| [p[0], p[1], 0.0]).collect()).expect("finite");
    let of = |f: usize| {
        let cell = f as u32 / 2;
        let (i, j) = (cell / 20, cell % 20);
        f64::from(u8::from(f64::from(j) < 10.0 + 4.0 * (TAU * f64::from(i) / 20.0).sin()))
    };
    let values = (0..mesh.faces().len()).map(of).collect();
    let group =
        Attribute { semantic: Semantic::Group("material".into()), domain: Domain::Face, width: 1, values };
    mesh.with_attribute(group).expect("it fits")
}

#[test]
fn the_border_of_two_materials_stays() {
    let mesh = two_materials();
    let made = made(&mesh, &length(1e-6));
    assert!(n_faces(&made) < 100, "{} triangles", n_faces(&made));
    assert!(both_ways(&mesh, &made.shape.mesh, 3e-6) < 1e-12);
    let area = |mesh: &Mesh| -> f64 {
        let of = |f: usize| {
            let t = mesh.corners(f);
            0.5 * mesh.attributes()[0].row(f)[0]
                * norm(chordal_testkit::sampler::cross(sub(t[1], t[0]), sub(t[2], t[0])))
        };
        (0..mesh.faces().len()).map(of).sum()
    };
    assert!((area(&mesh) - area(&made.shape.mesh)).abs() < 1e-5);
}

#[test]
fn colours_that_jump_stay_apart_and_smooth_ones_follow() {
    // Left half blue to green upwards, right half red.
    let flat = shapes::heights([20, 20], 0.0);
    let mesh =
        flat.with_positions(flat.positions().iter().map(|p| [p[0], p[1], 0.0]).collect()).expect("finite");
    let corners: Vec<_> = (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect();
    let colour = |f: usize, k: usize| {
        let y = corners[f][k][1];
        if f < corners.len() / 2 { vec![0.0, y, 1.0 - y] } else { vec![1.0, 0.0, 0.0] }
    };
    let colours = at_corners(&mesh, Semantic::Color(0), colour);
    let mesh = mesh.with_attribute(colours).expect("it fits");
    let made = made(&mesh, &length(1e-4));
    assert!(n_faces(&made) < 20, "{} triangles", n_faces(&made));
    assert!(both_ways(&mesh, &made.shape.mesh, 3e-4) < 1e-3);
}
