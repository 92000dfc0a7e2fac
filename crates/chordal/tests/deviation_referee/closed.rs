//! Distances that are known in closed form.
use super::measured;
use chordal::Mesh;
use chordal::check::{Deviation, Goal};

fn plate(n: u32, z: f64) -> Mesh {
    let positions = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), z]));
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let faces = quads.flat_map(|k| [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]]).collect();
    Mesh::new(positions.collect(), faces).unwrap()
}

/// The ends enclose `truth` and are as close as asked for.
fn is(found: &Deviation, truth: f64) {
    let (least, most) = (found.bound.at_least(), found.bound.at_most().unwrap());
    assert!(
        least <= truth * (1.0 + 1e-15) && truth <= most * (1.0 + 1e-15),
        "[{least:e}, {most:e}] {truth:e}"
    );
    assert!(most <= 1.1 * least + 16.0 * f64::EPSILON && found.reached, "[{least:e}, {most:e}]");
}

#[test]
fn a_translated_plane_is_as_far_as_it_was_moved() {
    for (n, m) in [(1, 1), (1, 30), (7, 12), (30, 1)] {
        for height in [1e-9, 0.3, 25.0] {
            is(&measured(&plate(n, 0.0), &plate(m, height), &Goal::default()), height);
        }
    }
    // Moved along itself it sticks out by that at one side.
    let moved = super::families::moved(&plate(8, 0.0), |[x, y, z]| [x + 0.125, y, z]);
    is(&measured(&plate(8, 0.0), &moved, &Goal::default()), 0.125);
}

/// An octahedron divided n times and drawn to the sphere.
fn sphere(n: u32, radius: f64) -> Mesh {
    let mut triangles: Vec<[[f64; 3]; 3]> = Vec::new();
    for signs in 0..8 {
        let s = |k: u32| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
        let [x, y, z] = [[s(0), 0.0, 0.0], [0.0, s(1), 0.0], [0.0, 0.0, s(2)]];
        triangles.push(if s(0) * s(1) * s(2) > 0.0 { [x, y, z] } else { [x, z, y] });
    }
    for _ in 0..n {
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let middle = |p: [f64; 3], q: [f64; 3]| {
                    let m: [f64; 3] = std::array::from_fn(|k| 0.5 * (p[k] + q[k]));
                    let length = m.iter().map(|x| x * x).sum::<f64>().sqrt();
                    m.map(|x| x / length)
                };
                let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    let positions: Vec<_> = triangles.concat().iter().map(|p| p.map(|x| x * radius)).collect();
    let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, faces).unwrap()
}

#[test]
fn two_spheres_about_one_centre_are_as_far_as_their_radii() {
    // A corner of the outer one is nearest to the same corner of the inner one, since that lies deepest
    // inside the half-space through it, across the ray to it; every other point is nearer, by convexity.
    for outer in [1.5, 1.015_625] {
        is(&measured(&sphere(3, outer), &sphere(3, 1.0), &Goal::default()), outer - 1.0);
    }
    // Against a sphere in other triangles the corners of the finer one decide: between R − r and R − r·cos.
    let found = measured(&sphere(4, 1.5), &sphere(2, 1.0), &Goal::default());
    assert!(found.bound.at_least() > 0.5 && found.bound.at_most().unwrap() < 0.65);
}

#[test]
fn a_missing_tooth_is_as_far_as_it_was_high() {
    let plain = plate(10, 0.0);
    // One corner inside is drawn up to a tooth.
    for height in [0.01, 0.25] {
        let mut positions = plain.positions().to_vec();
        positions[5 * 11 + 5][2] = height;
        let tooth = Mesh::new(positions, plain.faces().to_vec()).unwrap();
        let found = measured(&tooth, &plain, &Goal::default());
        is(&found, height);
        let worst = found.worst();
        assert_eq!((worst.from, worst.to), ([0.5, 0.5, height], [0.5, 0.5, 0.0]));
    }
}

#[test]
fn a_plate_without_its_margin_is_as_far_as_the_corner_of_the_margin() {
    let inner = super::families::moved(&plate(9, 0.0), |[x, y, z]| [0.001 + 0.998 * x, 0.001 + 0.998 * y, z]);
    let corner = (2.0_f64 * 0.001 * 0.001).sqrt();
    let found = measured(&plate(1, 0.0), &inner, &Goal { relative: 0.01, ..Goal::default() });
    let (least, most) = (found.bound.at_least(), found.bound.at_most().unwrap());
    assert!(
        least <= corner * (1.0 + 1e-12) && corner <= most * (1.0 + 1e-12) && most <= 1.01 * least + 1e-15
    );
}
