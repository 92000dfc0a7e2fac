//! Attributes survive: those of vertices, of corners and of faces.
use super::*;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_testkit::Random;

fn stream(domain: Domain, semantic: Semantic, values: Vec<f64>) -> Attribute {
    Attribute { semantic, domain, width: 1, values }
}

/// Streams whose values are linear in space or tell faces apart, so that every row says where it must be.
fn with_streams(mesh: Mesh) -> Mesh {
    let at = |p: [f64; 3]| p[0] + 10.0 * p[1] + 100.0 * p[2];
    let vertex = mesh.positions().iter().map(|p| at(*p)).collect();
    let corner =
        mesh.faces().as_flattened().iter().map(|&i| 1000.0 + at(mesh.positions()[i as usize])).collect();
    let face = (0..mesh.faces().len()).map(|i| i as f64).collect();
    let custom = |name: &str| Semantic::Custom(name.to_owned());
    mesh.with_attribute(stream(Domain::Vertex, custom("vertex"), vertex))
        .and_then(|mesh| mesh.with_attribute(stream(Domain::Corner, custom("corner"), corner)))
        .and_then(|mesh| mesh.with_attribute(stream(Domain::Face, Semantic::Group("usemtl".into()), face)))
        .unwrap()
}

#[test]
fn every_row_has_what_belongs_to_its_place() {
    for seed in 0..500 {
        let mut random = Random::new(seed);
        let positions: Vec<[f64; 3]> =
            (0..9).map(|_| std::array::from_fn(|_| random.below(4) as f64)).collect();
        let faces: Vec<[u32; 3]> = (0..12).map(|_| std::array::from_fn(|_| random.below(9) as u32)).collect();
        let mesh = with_streams(mesh_of(&positions, &faces));
        for (name, cure) in CURES {
            let made = cure(&mesh).mesh;
            let [vertex, corner, face] = [0, 1, 2].map(|i| &made.attributes()[i]);
            let at = |i: u32| {
                let p = made.positions()[i as usize];
                p[0] + 10.0 * p[1] + 100.0 * p[2]
            };
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            // The vertex in the middle of a filled hole is new, and has what one of its neighbours has.
            let is_old = |rows: &[u32; 3]| {
                rows.iter().all(|&i| name != "fill_holes" || (i as usize) < positions.len())
            };
            for (number, rows) in made.faces().iter().enumerate().filter(|(_, rows)| is_old(rows)) {
                for (k, &row) in rows.iter().enumerate() {
                    assert!(close(vertex.row(row as usize)[0], at(row)), "seed {seed}, {name}");
                    assert!(close(corner.row(3 * number + k)[0], 1000.0 + at(row)), "seed {seed}, {name}");
                }
                // A face keeps its number, and lies in the plane of the face that it was cut from.
                let was = face.row(number)[0] as usize;
                assert!(was < faces.len(), "seed {seed}, {name}");
            }
        }
    }
}

#[test]
fn a_seam_stays_a_seam_when_welded() {
    let rows =
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let soup = mesh_of(&rows, &[[0, 1, 2], [3, 4, 5]]);
    // Row 3 looks as row 1, row 5 does not look as row 2.
    let looks = stream(Domain::Vertex, Semantic::Custom("look".into()), vec![0.0, 1.0, 2.0, 1.0, 4.0, 5.0]);
    let made = cure("weld", &soup.with_attribute(looks).unwrap()).mesh;
    assert_eq!(made.faces(), [[0, 1, 2], [1, 3, 4]]);
    assert_eq!(made.position_id(), Some(&[0, 1, 2, 3, 2][..]));
    assert_eq!(made.attributes()[0].values, [0.0, 1.0, 2.0, 4.0, 5.0]);
}

#[test]
fn a_corner_in_an_edge_gets_what_the_edge_has_there() {
    let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.0, 0.0], [1.0, -1.0, 0.0]];
    let mesh = mesh_of(&points, &[[0, 1, 2], [0, 4, 3], [3, 4, 1]]);
    let looks = stream(Domain::Vertex, Semantic::Custom("u".into()), vec![0.0, 8.0, 0.0, 77.0, 0.0]);
    let made = cure("resolve_t_junctions", &mesh.with_attribute(looks).unwrap()).mesh;
    assert_eq!(made.faces(), [[5, 1, 2], [5, 2, 0], [0, 4, 3], [3, 4, 1]]);
    assert_eq!(made.attributes()[0].values, [0.0, 8.0, 0.0, 77.0, 0.0, 2.0]);
    assert_eq!(made.position_id(), Some(&[0, 1, 2, 3, 4, 3][..]));
}
