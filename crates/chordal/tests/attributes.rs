//! What is measured of attributes, held against values that are known in closed form, seams that moved, and
//! planted errors.
use crate::solids::shapes;

use chordal::budget::JobError;
use chordal::check::findings::{AttributeDeviation, attribute_deviation};
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::lod::simplify;
use chordal::{Budget, Job, Mesh, Tolerance};

type Point = [f64; 3];

fn at_corners(mesh: Mesh, semantic: Semantic, of: impl Fn(usize, usize) -> Vec<f64>) -> Mesh {
    let rows: Vec<Vec<f64>> =
        (0..mesh.faces().len()).flat_map(|f| [0, 1, 2].map(|k| (f, k))).map(|(f, k)| of(f, k)).collect();
    let attribute =
        Attribute { semantic, domain: Domain::Corner, width: rows[0].len(), values: rows.concat() };
    mesh.with_attribute(attribute).expect("it fits")
}

fn at_vertices(mesh: Mesh, semantic: Semantic, of: impl Fn(Point) -> Vec<f64>) -> Mesh {
    let rows: Vec<Vec<f64>> = mesh.positions().iter().map(|p| of(*p)).collect();
    let attribute =
        Attribute { semantic, domain: Domain::Vertex, width: rows[0].len(), values: rows.concat() };
    mesh.with_attribute(attribute).expect("it fits")
}

fn flat(n: [u32; 2]) -> Mesh {
    let mesh = shapes::heights(n, 0.0);
    let low = mesh.positions().iter().map(|p| [p[0], p[1], 0.0]).collect();
    mesh.with_positions(low).expect("finite")
}

const TEXTURE: Semantic = Semantic::TexCoord(0);

/// Texture coordinates around a torus both ways, with a seam along each, and then moved.
fn torus([n, m]: [u32; 2], moved: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let mesh = shapes::torus([n, m], 0.0);
    let faces = mesh.faces().to_vec();
    at_corners(mesh, TEXTURE, |f, k| {
        let (row, cell) = (faces[f][k], f as u32 / 2);
        // A corner at the far side of the last cells is at 1 and not at 0.
        let wrap = |at: u32, cell: u32, n: u32| if at < cell { n } else { at };
        let (i, j) = (wrap(row / m, cell / m, n), wrap(row % m, cell % m, m));
        moved([f64::from(i) / f64::from(n), f64::from(j) / f64::from(m)]).to_vec()
    })
}

fn measured(a: &Mesh, b: &Mesh, moved: Option<f64>) -> Vec<AttributeDeviation> {
    let moved = moved.map(|moved| Tolerance::new(moved).expect("a length"));
    attribute_deviation(a, b, moved, &Job::default()).expect("measured")
}

/// Of the one attribute: the largest and the root of the mean square.
fn of_one(a: &Mesh, b: &Mesh, moved: Option<f64>) -> (f64, f64) {
    let all = measured(a, b, moved);
    assert_eq!(all.len(), 1);
    assert!(all[0].rms <= all[0].largest && all[0].samples > 0);
    assert_eq!(all[0].at.is_none(), all[0].largest == 0.0);
    (all[0].largest, all[0].rms)
}

#[test]
fn nothing_is_off_between_a_mesh_and_itself_also_at_its_seams() {
    let mesh = torus([24, 12], |uv| uv);
    let (largest, rms) = of_one(&mesh, &mesh, None);
    assert!(largest < 1e-12 && rms < 1e-12, "{largest} {rms}");
    // What slides by a hundredth all over is off by that all over.
    let (largest, rms) = of_one(&mesh, &torus([24, 12], |[u, v]| [u + 0.006, v - 0.008]), None);
    assert!((largest - 0.01).abs() < 1e-12 && (rms - 0.01).abs() < 1e-12, "{largest} {rms}");
    // Swapped, as when a reader takes one for the other: far off nearly everywhere.
    let (largest, rms) = of_one(&mesh, &torus([24, 12], |[u, v]| [v, u]), None);
    assert!(largest > 1.0 && rms > 0.3, "{largest} {rms}");
}

#[test]
fn a_linear_difference_has_the_mean_square_of_its_integral() {
    // 0.1 · (x, y) over the unit square: the mean square is 0.01 · 2/3, the largest 0.1 · √2 at a corner.
    // Whatever the triangles of either are.
    let a = at_vertices(flat([40, 40]), TEXTURE, |p| vec![p[0], p[1]]);
    let b = at_vertices(flat([37, 31]), TEXTURE, |p| vec![1.1 * p[0], 1.1 * p[1]]);
    let (largest, rms) = of_one(&a, &b, None);
    let expected = (0.01_f64 * 2.0 / 3.0).sqrt();
    assert!((rms - expected).abs() < 1e-3 * expected, "{rms} for {expected}");
    assert!(largest < 0.1 * 2.0_f64.sqrt() && largest > 0.99 * 0.1 * 2.0_f64.sqrt(), "{largest}");
    // The other way around it is the same, up to the order of a sum.
    let (again, again_rms) = of_one(&b, &a, None);
    assert!(largest == again && (rms - again_rms).abs() < 1e-12);
}

#[test]
fn a_seam_does_not_smear_and_a_smear_is_found() {
    let mesh = torus([80, 40], |uv| uv);
    let length = Tolerance::new(0.01).expect("a length");
    let made = simplify(&mesh, &Budget::length(length), Topology::Indices, &Job::default()).expect("made");
    let bound = made.bound.at_most().expect("proved");
    let out = made.shape.mesh;
    // Long triangles are straight where coordinates are round, so that they slide; but not by a chart, which
    // is 1.
    let (largest, rms) = of_one(&mesh, &out, Some(bound));
    println!("slides by {largest}, {rms} on the mean");
    assert!(largest > 1e-3 && largest < 0.1 && rms < 0.02, "{largest} {rms}");
    // Values of both sides put together at the positions of the seam: triangles across it show the whole
    // texture backwards.
    let smeared = {
        let bare = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).expect("valid");
        let mut values = vec![0.0; 2 * bare.positions().len()];
        let uv = mesh.attribute(&TEXTURE).expect("there");
        for (corner, row) in mesh.faces().as_flattened().iter().enumerate().rev() {
            values[2 * *row as usize..][..2].copy_from_slice(uv.row(corner));
        }
        let uv = Attribute { semantic: TEXTURE, domain: Domain::Vertex, width: 2, values };
        bare.with_attribute(uv).expect("it fits")
    };
    let (largest, _) = of_one(&mesh, &smeared, Some(bound));
    assert!(largest > 0.5, "{largest}");
}

/// A flat square whose texture jumps by 1 at the middle line of its vertices, which stand at `x`.
fn halves(x: f64, n: u32) -> Mesh {
    let mesh = flat([2, n]);
    let moved = mesh.positions().iter().map(|p| [if p[0] == 0.5 { x } else { p[0] }, p[1], p[2]]).collect();
    let mesh = mesh.with_positions(moved).expect("finite");
    let corners: Vec<_> = (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect();
    let right = mesh.faces().len() / 2;
    at_corners(mesh, TEXTURE, move |f, k| {
        let [x, y, _] = corners[f][k];
        vec![x + f64::from(u8::from(f >= right)), y]
    })
}

#[test]
fn a_seam_may_have_moved_as_far_as_is_said() {
    let still = halves(0.5, 30);
    // Other triangles, the same line.
    let (largest, _) = of_one(&still, &halves(0.5, 7), None);
    assert!(largest < 1e-12, "{largest}");
    // A line of 400 short triangles, so that samples stand between the old place and the new one.
    let fine = |x: f64| {
        let [a, b] = [0.48, 0.52].map(f64::from);
        let xs = [0.0, a, x, b, 1.0];
        let positions =
            xs.iter().flat_map(|x| (0..=100).map(move |j| [*x, f64::from(j) / 100.0, 0.0])).collect();
        let quad = |i: u32, j: u32| [i * 101 + j, (i + 1) * 101 + j, (i + 1) * 101 + j + 1, i * 101 + j + 1];
        let cells = (0..4).flat_map(|i| (0..100).map(move |j| quad(i, j)));
        let faces = cells.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mesh = Mesh::new(positions, faces).expect("valid");
        let corners: Vec<_> = (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect();
        at_corners(mesh, TEXTURE, move |f, k| {
            let [x, y, _] = corners[f][k];
            vec![x + f64::from(u8::from(f >= 400)), y]
        })
    };
    let (old, new) = (fine(0.5), fine(0.505));
    let (largest, rms) = of_one(&old, &new, None);
    assert!(largest > 0.99, "{largest}");
    // Half of a percent of the square is off by about 1.
    assert!(rms > 0.03 && rms < 0.12, "{rms}");
    let (largest, _) = of_one(&old, &new, Some(0.001));
    assert!(largest > 0.99, "{largest}");
    let (largest, rms) = of_one(&old, &new, Some(0.006));
    assert!(largest < 0.006 && rms < 0.001, "{largest} {rms}");
}

/// A square from above and from below, so far apart, the lower one with other values.
fn sheet(low: f64, thick: f64) -> Mesh {
    let top = flat([6, 6]);
    let n = top.positions().len() as u32;
    let at = |z: f64| top.positions().iter().map(move |p| [p[0], p[1], z]);
    let backs = top.faces().iter().map(|[a, b, c]| [c + n, b + n, a + n]);
    let faces = top.faces().iter().copied().chain(backs).collect();
    let mesh = Mesh::new(at(low + thick).chain(at(low)).collect(), faces).expect("valid");
    let corners: Vec<_> = (0..mesh.faces().len()).map(|f| mesh.corners(f)).collect();
    let half = mesh.faces().len() / 2;
    at_corners(mesh, TEXTURE, move |f, k| vec![corners[f][k][0] + if f < half { 0.0 } else { 2.0 }, 0.0])
}

#[test]
fn the_back_of_a_sheet_is_not_taken_for_its_front() {
    // Both sides at one place.
    assert!(of_one(&sheet(0.0, 0.0), &sheet(0.0, 0.0), None).0 < 1e-12);
    // Moved by more than it is thick: its front is beside the other's back.
    let (here, moved) = (sheet(0.0, 0.01), sheet(0.012, 0.01));
    assert!(of_one(&here, &moved, None).0 > 1.0);
    assert!(of_one(&here, &moved, Some(0.013)).0 < 1e-12);
}

#[test]
fn one_value_that_is_off_is_found() {
    let mesh = at_vertices(flat([30, 30]), Semantic::Color(0), |p| vec![p[0], p[1], 0.5]);
    let mut values = mesh.attributes()[0].values.clone();
    let row = 31 * 12 + 17;
    values[3 * row + 2] += 0.1;
    let off = Attribute { values, ..mesh.attributes()[0].clone() };
    let bare = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).expect("valid");
    let found = measured(&mesh, &bare.with_attribute(off).expect("it fits"), None).remove(0);
    // The sample next to a corner has 0.8 of it.
    assert!(found.largest > 0.079 && found.largest < 0.1, "{}", found.largest);
    let (at, there) = (found.at.expect("somewhere"), mesh.positions()[row]);
    assert!((0..3).all(|k| (at[k] - there[k]).abs() < 1.0 / 30.0), "{at:?} near {there:?}");
    // Six faces of 1800 carry it.
    assert!(found.rms > 1e-3 && found.rms < 5e-3, "{}", found.rms);
}

#[test]
fn directions_are_compared_by_their_angle() {
    let tilted = |deg: f64, size: f64| {
        let (sin, cos) = deg.to_radians().sin_cos();
        at_vertices(flat([5, 6]), Semantic::Normal, move |_| vec![size * sin, 0.0, size * cos])
    };
    for (deg, size) in [(10.0, 1.0), (1e-6, 1.0), (89.0, 3.0), (180.0, 1.0)] {
        let found = measured(&tilted(0.0, 1.0), &tilted(deg, size), None).remove(0);
        assert!(found.is_angle());
        assert!((found.largest - deg).abs() < 1e-9 && (found.rms - deg).abs() < 1e-9, "{found:?}");
    }
    // No direction at all is as far off as can be.
    assert_eq!(of_one(&tilted(0.0, 1.0), &tilted(0.0, 0.0), None).0, 180.0);
    let tangent =
        |sign: f64| at_vertices(flat([2, 2]), Semantic::Tangent, move |_| vec![1.0, 0.0, 0.0, sign]);
    assert_eq!(of_one(&tangent(1.0), &tangent(1.0), None).0, 0.0);
    assert_eq!(of_one(&tangent(1.0), &tangent(-1.0), None).0, 180.0);
}

#[test]
fn what_has_no_counterpart_or_only_names_is_left_out() {
    let plain = flat([3, 3]);
    let uv = at_vertices(plain.clone(), TEXTURE, |p| vec![p[0], p[1]]);
    assert!(measured(&plain, &uv, None).is_empty() && measured(&uv, &plain, None).is_empty());
    let second = at_vertices(plain.clone(), Semantic::TexCoord(1), |p| vec![p[0], p[1]]);
    assert!(measured(&uv, &second, None).is_empty());
    let [three, four] = [3, 4].map(|n| at_vertices(plain.clone(), Semantic::Color(0), move |_| vec![0.5; n]));
    assert!(measured(&three, &four, None).is_empty());
    let group = at_vertices(plain.clone(), Semantic::Group("material".into()), |_| vec![1.0]);
    assert!(measured(&group, &group, None).is_empty());
    let none = Mesh::default().with_attribute(Attribute { values: Vec::new(), ..uv.attributes()[0].clone() });
    assert!(measured(&uv, &none.expect("nothing fits"), None).is_empty());
    // Several at once, each by itself, and one of vertices against one of corners.
    let both = at_vertices(uv.clone(), Semantic::Custom("heat".into()), |p| vec![7.0 * p[0]]);
    let faces: Vec<_> = (0..plain.faces().len()).map(|f| plain.corners(f)).collect();
    let other = at_corners(uv, Semantic::Custom("heat".into()), |f, k| vec![7.0 * faces[f][k][0] + 0.25]);
    let found = measured(&both, &other, None);
    assert_eq!(
        found.iter().map(|of| &of.semantic).collect::<Vec<_>>(),
        [&TEXTURE, &Semantic::Custom("heat".into())]
    );
    assert!(found[0].largest < 1e-12 && (found[1].largest - 0.25).abs() < 1e-12);
    // What is no number is infinitely far off, and does not hide.
    let bad = at_vertices(plain.clone(), TEXTURE, |p| vec![if p[0] == 0.0 { f64::NAN } else { p[0] }, p[1]]);
    let good = at_vertices(plain, TEXTURE, |p| vec![p[0], p[1]]);
    assert_eq!(of_one(&good, &bad, None), (f64::INFINITY, f64::INFINITY));
}

#[test]
fn threads_and_powers_of_two_change_nothing_and_a_cancel_stops() {
    let mesh = torus([60, 30], |uv| uv);
    let length = Tolerance::new(0.02).expect("a length");
    let made = simplify(&mesh, &Budget::length(length), Topology::Indices, &Job::default()).expect("made");
    let out = made.shape.mesh;
    let on = |n| {
        attribute_deviation(&mesh, &out, Some(length), &Job::default().with_threads(n)).expect("measured")
    };
    assert_eq!(on(1), on(3));
    for k in [-300, 300] {
        let scaled = |mesh: &Mesh| {
            let larger = mesh.positions().iter().map(|p| p.map(|x| x * 2.0_f64.powi(k))).collect();
            mesh.with_positions(larger).expect("finite")
        };
        let found = measured(&scaled(&mesh), &scaled(&out), Some(0.02 * 2.0_f64.powi(k)));
        assert_eq!((found[0].largest, found[0].rms), (on(1)[0].largest, on(1)[0].rms));
    }
    let job = Job::default();
    job.cancel();
    assert_eq!(attribute_deviation(&mesh, &out, None, &job), Err(JobError::Cancelled));
}
