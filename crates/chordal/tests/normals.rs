//! Normals: closed forms on the cube and the sphere, an oracle for random meshes, and everything that could
//! be NaN.
use chordal::Mesh;
use chordal::check::validity;
use chordal::explicit::{
    Attribute, Domain, NormalWeight, Semantic, Shading, Topology, face_normal, smooth_normals, with_normals,
};
use chordal_testkit::Random;
use chordal_testkit::sampler::{cross, dot, sub};
use std::collections::BTreeMap;

type V = [f64; 3];

fn unit(a: V) -> V {
    let length = dot(a, a).sqrt();
    if length > 0.0 { a.map(|x| x / length) } else { a }
}

/// The angle of two directions, right near 0 too.
fn angle(a: V, b: V) -> f64 {
    let c = cross(a, b);
    dot(c, c).sqrt().atan2(dot(a, b))
}

fn cube() -> Mesh {
    let corners: Vec<V> = (0..8).map(|i| [0, 1, 2].map(|k| f64::from(i >> k & 1))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(corners, faces).unwrap()
}

/// An icosahedron whose faces were cut into four so many times, on the unit sphere.
fn icosphere(levels: u32) -> Mesh {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(unit));
    }
    let near = |p: V, q: V| (dot(p, q) - 1.0 / 5.0_f64.sqrt()).abs() < 0.1;
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..12).flat_map(move |j| (0..12).map(move |k| (i, j, k)))) {
        let [p, q, r] = [i, j, k].map(|n: usize| positions[n]);
        let is_face = i < j && i < k && near(p, q) && near(q, r) && near(r, p);
        if is_face && dot(cross(sub(q, p), sub(r, p)), p) > 0.0 {
            faces.push([i as u32, j as u32, k as u32]);
        }
    }
    assert_eq!(faces.len(), 20);
    for _ in 0..levels {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut cut = Vec::new();
        for [a, b, c] in faces {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[p, q]| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    let [s, t] = [p, q].map(|i| positions[i as usize]);
                    positions.push(unit([s[0] + t[0], s[1] + t[1], s[2] + t[2]]));
                    positions.len() as u32 - 1
                })
            });
            cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = cut;
    }
    Mesh::new(positions, faces).unwrap()
}

fn normal_rows(mesh: &Mesh) -> Vec<V> {
    let own = mesh.attribute(&Semantic::Normal).unwrap();
    own.values.chunks(3).map(|row| [row[0], row[1], row[2]]).collect()
}

const CREASE: Shading = Shading::Crease { angle_rad: 0.5, weight: NormalWeight::Angle };

#[test]
fn a_cube_has_24_vertices_creased_and_8_smooth_and_is_closed_either_way() {
    let creased = with_normals(&cube(), Topology::Indices, CREASE).unwrap();
    let smooth = with_normals(&cube(), Topology::Indices, Shading::Smooth(NormalWeight::Angle)).unwrap();
    let flat = with_normals(&cube(), Topology::Indices, Shading::Flat).unwrap();
    assert_eq!([&creased, &smooth, &flat].map(|mesh| mesh.positions().len()), [24, 8, 8]);
    for mesh in [&creased, &smooth, &flat] {
        let found = validity(mesh, Topology::Indices);
        assert!(found.closed && found.manifold() && found.oriented);
        assert_eq!((found.positions, mesh.n_positions()), (8, 8));
    }
    // Every creased normal is that of its faces, every smooth one points along its corner's diagonal.
    let rows = normal_rows(&creased);
    for (number, face) in creased.faces().iter().enumerate() {
        let own = face_normal(creased.corners(number)).unwrap();
        assert!(face.iter().all(|&row| angle(rows[row as usize], own) < 1e-9));
    }
    for (p, normal) in smooth.positions().iter().zip(normal_rows(&smooth)) {
        assert!(angle(p.map(|x| x - 0.5), normal) < 1e-9);
    }
    assert_eq!(flat.attribute(&Semantic::Normal).unwrap().domain, Domain::Face);
}

#[test]
fn only_hard_edges_double_vertices() {
    // A tent: its ridge is bent by 90°, its sides lie flat.
    let positions = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 1.0],
        [2.0, 1.0, 0.0],
    ];
    let tent = Mesh::new(positions, vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]).unwrap();
    let creased = with_normals(&tent, Topology::Indices, CREASE).unwrap();
    assert_eq!(creased.positions().len(), 8);
    let wide = Shading::Crease { angle_rad: 1.6, weight: NormalWeight::Angle };
    assert_eq!(with_normals(&tent, Topology::Indices, wide).unwrap().positions().len(), 6);
    // Attributes go along with the copies.
    let looks = Attribute {
        semantic: Semantic::TexCoord(0),
        domain: Domain::Vertex,
        width: 2,
        values: (0..12).map(f64::from).collect(),
    };
    let made = with_normals(&tent.with_attribute(looks).unwrap(), Topology::Indices, CREASE).unwrap();
    let looks = made.attribute(&Semantic::TexCoord(0)).unwrap();
    for row in 0..8 {
        let first = made.position_of(row as u32) as f64;
        assert_eq!(looks.row(row), [2.0 * first, 2.0 * first + 1.0]);
    }
}

#[test]
fn smoothing_groups_decide_whatever_the_angle() {
    let groups = |values: [f64; 6]| {
        let values = values.iter().flat_map(|v| [*v, *v]).collect();
        let semantic = Semantic::Group("s".into());
        cube().with_attribute(Attribute { semantic, domain: Domain::Face, width: 1, values }).unwrap()
    };
    let rows = |mesh: &Mesh| {
        with_normals(mesh, Topology::Indices, Shading::Groups(NormalWeight::Angle)).unwrap().positions().len()
    };
    assert_eq!(rows(&groups([1.0; 6])), 8, "one group is smooth across 90°");
    assert_eq!(rows(&groups([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])), 24, "six groups have all edges hard");
    // Group 0 is none: its sides are hard, and so is each face by itself.
    let apart =
        with_normals(&groups([0.0; 6]), Topology::Indices, Shading::Groups(NormalWeight::Angle)).unwrap();
    assert_eq!(apart.positions().len(), 36);
    let none = with_normals(&cube(), Topology::Indices, Shading::Groups(NormalWeight::Angle)).unwrap();
    assert_eq!(none.attribute(&Semantic::Normal).unwrap().domain, Domain::Face);
}

#[test]
fn edges_that_are_not_manifold_are_hard() {
    let book = Mesh::new(
        vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.0, -0.1, 0.0]],
        vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    )
    .unwrap();
    let creased = with_normals(&book, Topology::Indices, CREASE).unwrap();
    assert_eq!(creased.positions().len(), 9);
    // Two faces that are wound against each other do not cancel each other's normals.
    let bent = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        vec![[0, 1, 2], [1, 2, 3]],
    )
    .unwrap();
    let made = with_normals(&bent, Topology::Indices, CREASE).unwrap();
    assert_eq!(made.positions().len(), if face_normal(bent.corners(1)).unwrap()[2] < 0.0 { 6 } else { 4 });
}

/// On an icosphere, the worst and the root mean square angle of normals to the true ones, in degrees, and how
/// flat normals do.
fn against_the_sphere(levels: u32) -> [f64; 4] {
    let sphere = icosphere(levels);
    let (mut worst, mut sum) = (0.0_f64, 0.0);
    for (p, normal) in sphere.positions().iter().zip(smooth_normals(&sphere, NormalWeight::Angle)) {
        let off = angle(*p, normal);
        (worst, sum) = (worst.max(off), sum + off * off);
    }
    let (mut flat_worst, mut flat_sum) = (0.0_f64, 0.0);
    for face in 0..sphere.faces().len() {
        let normal = face_normal(sphere.corners(face)).unwrap();
        for corner in sphere.corners(face) {
            let off = angle(corner, normal);
            (flat_worst, flat_sum) = (flat_worst.max(off), flat_sum + off * off);
        }
    }
    let mean = |sum: f64, n: usize| (sum / n as f64).sqrt();
    let [n, m] = [sphere.positions().len(), 3 * sphere.faces().len()];
    [flat_worst, mean(flat_sum, m), worst, mean(sum, n)].map(f64::to_degrees)
}

#[test]
fn on_a_sphere_smooth_normals_are_much_nearer_than_flat_ones() {
    let all: Vec<[f64; 4]> = (0..=5).map(against_the_sphere).collect();
    for (level, row) in all.iter().enumerate() {
        println!(
            "{level} | {:8} | {:.3} {:.3} | {:.4} {:.4}",
            20 << (2 * level),
            row[0],
            row[1],
            row[2],
            row[3]
        );
    }
    // At the corners of an icosahedron, and of one cut once, smooth normals are exact by symmetry.
    assert!(all[0][2] < 1e-6 && all[1][2] < 1e-6, "{all:?}");
    for pair in all[2..].windows(2) {
        let ratio: [f64; 4] = std::array::from_fn(|k| pair[0][k] / pair[1][k]);
        // The flat angle is the edge over the radius, and an edge is halved.
        assert!(ratio[1] > 1.97 && ratio[1] < 2.03, "flat: {ratio:?}");
        assert!(ratio[2] > 1.97 && ratio[3] > 2.2, "smooth: {ratio:?}");
    }
    assert!(all.iter().all(|row| row[2] < row[0] / 15.0 && row[3] < row[1] / 25.0), "{all:?}");
}

#[test]
fn smooth_normals_are_those_of_the_definition() {
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let positions: Vec<V> = (0..12).map(|_| [0; 3].map(|_| random.below(1000) as f64 / 7.0)).collect();
        let faces: Vec<[u32; 3]> = (0..20).map(|_| [0; 3].map(|_| random.below(12) as u32)).collect();
        let mesh = Mesh::new(positions, faces).unwrap();
        for weight in [NormalWeight::Angle, NormalWeight::Area, NormalWeight::Uniform] {
            let found = smooth_normals(&mesh, weight);
            let mut sums = [[0.0; 3]; 12];
            for (number, face) in mesh.faces().iter().enumerate() {
                let corners = mesh.corners(number);
                let whole = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
                for k in 0..3 {
                    let here = corners[k];
                    let weight = match weight {
                        NormalWeight::Angle => {
                            angle(sub(corners[(k + 1) % 3], here), sub(corners[(k + 2) % 3], here))
                        }
                        NormalWeight::Area => dot(whole, whole).sqrt(),
                        NormalWeight::Uniform => 1.0,
                    };
                    let sum = &mut sums[face[k] as usize];
                    let normal = unit(whole);
                    *sum = std::array::from_fn(|i| sum[i] + weight * normal[i]);
                }
            }
            for (sum, found) in sums.into_iter().zip(found) {
                // Sums that nearly cancel have no direction worth comparing.
                assert!(dot(sum, sum).sqrt() < 1e-6 || angle(sum, found) < 1e-8, "seed {seed}, {weight:?}");
                assert!(found == [0.0; 3] || (dot(found, found) - 1.0).abs() < 1e-14, "seed {seed}");
            }
        }
    }
}

#[test]
fn h54_normals_do_not_depend_on_the_size_of_a_mesh() {
    let mesh = icosphere(2);
    let expected = smooth_normals(&mesh, NormalWeight::Angle);
    for scale in [1e-300, 1e-160, 1e-60, 1e-30, 1e30, 1e100, 1e160, 1e300] {
        let scaled =
            mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect()).unwrap();
        for weight in [NormalWeight::Angle, NormalWeight::Area, NormalWeight::Uniform] {
            for (a, b) in smooth_normals(&scaled, weight).into_iter().zip(smooth_normals(&mesh, weight)) {
                assert!(angle(a, b) < 1e-9, "{scale:e} {weight:?}: {a:?} {b:?}");
            }
        }
    }
    for power in [-20, 20] {
        let scale = libm::ldexp(1.0, power);
        let scaled =
            mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect()).unwrap();
        assert_eq!(smooth_normals(&scaled, NormalWeight::Angle), expected, "a power of two changes no bit");
    }
}

#[test]
fn h55_no_normal_is_nan() {
    let sick: [(&[V], &[[u32; 3]]); 6] = [
        (&[[1.0; 3]; 3], &[[0, 1, 2]]),
        (&[[0.0; 3], [1.0; 3], [3.0; 3]], &[[0, 1, 2], [2, 1, 0]]),
        (&[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-12, 0.0]], &[[0, 1, 2]]),
        (&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2], [0, 2, 1]]),
        (&[[1e308, 0.0, 0.0], [-1e308, 0.0, 0.0], [0.0, 1e308, -1e308]], &[[0, 1, 2], [0, 0, 1]]),
        (&[[1e-320, 0.0, 0.0], [0.0, 1e-320, 0.0], [0.0, 0.0, 1e30]], &[[0, 1, 2]]),
    ];
    let weights = [NormalWeight::Angle, NormalWeight::Area, NormalWeight::Uniform];
    let crease = |weight| Shading::Crease { angle_rad: 0.5, weight };
    let kinds = weights.map(Shading::Smooth).into_iter().chain(weights.map(crease)).chain([Shading::Flat]);
    let kinds: Vec<Shading> = kinds.collect();
    for (positions, faces) in sick {
        let mesh = Mesh::new(positions.to_vec(), faces.to_vec()).unwrap();
        for kind in &kinds {
            for topology in [Topology::Indices, Topology::Positions] {
                let made = with_normals(&mesh, topology, *kind).unwrap();
                for row in normal_rows(&made) {
                    let square = dot(row, row);
                    assert!(square == 0.0 || (square - 1.0).abs() < 1e-12, "{positions:?} {kind:?}: {row:?}");
                }
            }
        }
    }
    // The needle has a direction, and it is found.
    let needle = Mesh::new(sick[2].0.to_vec(), sick[2].1.to_vec()).unwrap();
    assert_eq!(smooth_normals(&needle, NormalWeight::Angle), [[0.0, 0.0, 1.0]; 3]);
}

#[test]
fn a_soup_is_smooth_by_positions_and_flat_by_indices() {
    let cube = cube();
    let soup: Vec<V> = (0..12).flat_map(|f| cube.corners(f)).collect();
    let mesh = Mesh::new(soup, (0..12).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect()).unwrap();
    let smooth = Shading::Smooth(NormalWeight::Angle);
    let tied = with_normals(&mesh, Topology::Positions, smooth).unwrap();
    for (p, normal) in tied.positions().iter().zip(normal_rows(&tied)) {
        assert!(angle(p.map(|x| x - 0.5), normal) < 1e-9);
    }
    let loose = with_normals(&mesh, Topology::Indices, smooth).unwrap();
    assert!(normal_rows(&loose).iter().all(|n| n.iter().filter(|x| **x == 0.0).count() == 2));
    assert_eq!((tied.positions().len(), tied.position_id()), (36, None));
}
