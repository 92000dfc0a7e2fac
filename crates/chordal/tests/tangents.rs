//! Tangents: along u, at right angles to the normal, mirrored where the texture is, and the same from any
//! order.
use chordal::Mesh;
use chordal::explicit::{
    Attribute, Domain, NormalWeight, Semantic, Shading, Topology, with_normals, with_tangents,
};

/// A grid over the unit square, bent upwards, with texture coordinates of its vertices.
fn sheet(n: u32, texture: impl Fn(f64, f64) -> [f64; 2]) -> Mesh {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let grid = || (0..=n).flat_map(move |j| (0..=n).map(move |i| (at(i), at(j))));
    let positions = grid().map(|(x, y)| [x, y, 0.3 * x * x]).collect();
    let row = |i: u32, j: u32| j * (n + 1) + i;
    let faces = (0..n)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let values = grid().flat_map(|(x, y)| texture(x, y)).collect();
    let texture = Attribute { semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values };
    let mesh = Mesh::new(positions, faces).unwrap().with_attribute(texture).unwrap();
    with_normals(&mesh, Topology::Indices, Shading::Smooth(NormalWeight::Angle)).unwrap()
}

fn tangents(mesh: &Mesh) -> Vec<[f64; 4]> {
    let made = with_tangents(mesh, 0).unwrap().unwrap();
    let rows = made.attribute(&Semantic::Tangent).unwrap();
    assert_eq!((rows.domain, rows.width), (Domain::Corner, 4));
    rows.values.chunks(4).map(|row| [row[0], row[1], row[2], row[3]]).collect()
}

#[test]
fn tangents_run_along_u_at_right_angles_to_the_normal() {
    let mesh = sheet(8, |x, y| [x, y]);
    let normals = mesh.attribute(&Semantic::Normal).unwrap();
    for (corner, [x, y, z, sign]) in tangents(&mesh).into_iter().enumerate() {
        let row = mesh.faces()[corner / 3][corner % 3];
        let normal = normals.row(row as usize);
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6);
        assert!((x * normal[0] + y * normal[1] + z * normal[2]).abs() < 1e-6);
        // The sheet is bent along x only, so that u runs up the slope 0.6 x.
        let slope = 0.6 * mesh.positions()[row as usize][0];
        assert!(
            y.abs() < 1e-6 && (z / x - slope).abs() < 0.05 && x > 0.0 && sign == 1.0,
            "{x} {y} {z} {sign}"
        );
    }
}

#[test]
fn where_mirrored_halves_meet_corners_of_one_vertex_differ() {
    let mesh = sheet(4, |x, y| [(x - 0.5).abs(), y]);
    let found = tangents(&mesh);
    let mut signs = std::collections::BTreeMap::new();
    for (corner, tangent) in found.iter().enumerate() {
        let row = mesh.faces()[corner / 3][corner % 3];
        signs.entry(row).or_insert_with(Vec::new).push(tangent[3]);
    }
    for (row, signs) in signs {
        let x = mesh.positions()[row as usize][0];
        assert_eq!(signs.contains(&1.0), x >= 0.5, "at x = {x}");
        assert_eq!(signs.contains(&-1.0), x <= 0.5, "at x = {x}");
    }
}

#[test]
fn the_order_of_faces_and_corners_does_not_matter() {
    let mesh = sheet(6, |x, y| [x + 0.2 * y * y, y - 0.3 * x * x]);
    let straight = tangents(&mesh);
    let n = mesh.faces().len();
    let turned = mesh.faces().iter().rev().map(|&[a, b, c]| [b, c, a]).collect();
    let mut other = Mesh::new(mesh.positions().to_vec(), turned).unwrap();
    for attribute in mesh.attributes() {
        other = other.with_attribute(attribute.clone()).unwrap();
    }
    for (corner, tangent) in tangents(&other).into_iter().enumerate() {
        let was = straight[3 * (n - 1 - corner / 3) + (corner + 1) % 3];
        assert!((0..4).all(|k| (tangent[k] - was[k]).abs() < 1e-6), "{tangent:?} {was:?}");
    }
}

#[test]
fn h55_no_tangent_is_nan() {
    let textures: [&dyn Fn(f64, f64) -> [f64; 2]; 5] = [
        &|_, _| [0.0, 0.0],
        &|x, _| [x, x],
        &|x, y| [x * 1e300, y * -1e300],
        &|x, _| [f64::NAN, x],
        &|x, y| [x * 1e-300, y * 1e-300],
    ];
    for (number, texture) in textures.into_iter().enumerate() {
        for tangent in tangents(&sheet(3, texture)) {
            let square: f64 = tangent[..3].iter().map(|x| x * x).sum();
            assert!((square - 1.0).abs() < 1e-5 && tangent[3].abs() == 1.0, "texture {number}: {tangent:?}");
        }
    }
    let point = Mesh::new(vec![[1e300; 3]; 3], vec![[0, 1, 2], [0, 0, 0]]).unwrap();
    let texture = Attribute {
        semantic: Semantic::TexCoord(0),
        domain: Domain::Corner,
        width: 2,
        values: (0..12).map(f64::from).collect(),
    };
    let point =
        with_normals(&point.with_attribute(texture).unwrap(), Topology::Indices, Shading::Flat).unwrap();
    assert_eq!(tangents(&point), [[1.0, 0.0, 0.0, 1.0]; 6]);
    assert!(with_tangents(&point, 1).is_none());
    assert!(with_tangents(&Mesh::default(), 0).is_none());
}
