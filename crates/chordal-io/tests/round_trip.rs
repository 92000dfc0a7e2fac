//! What is written reads back: the same positions to the last bit, the same faces, normals at the format's
//! precision.
use crate::common;
use chordal_testkit::Random;

use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, face_normal};
use chordal_io::{
    Content, Format, Frame, Limits, Node, Part, ReadOutcome, Scene, WriteError, losses, obj, off, ply, read,
    stl,
};
use common::{count, load_scene};
use serde_json::{Value, json};

fn write(scene: &Scene, format: Format, certificate: Option<&Value>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let result = match format {
        Format::Obj => obj::write(scene, certificate, &mut bytes),
        Format::Ply => ply::write(scene, certificate, &mut bytes),
        Format::Off => off::write(scene, certificate, &mut bytes),
        Format::Stl => stl::write(scene, certificate, &mut bytes),
        other => panic!("no writer of {other} here"),
    };
    result.expect("written");
    bytes
}

fn scene_of(mesh: Mesh) -> Scene {
    Scene::from_mesh("", mesh, Frame::default())
}

/// Writes, checks that the content is recognised, and reads.
fn there_and_back(mesh: &Mesh, format: Format) -> Mesh {
    let bytes = write(&scene_of(mesh.clone()), format, None);
    assert_eq!(Format::sniff(&bytes), Some(format));
    load_scene(&bytes, format).0.parts[0].mesh.clone()
}

fn bits(points: &[[f64; 3]]) -> Vec<[u64; 3]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

fn vertex(semantic: Semantic, width: usize, values: Vec<f64>) -> Attribute {
    Attribute { semantic, domain: Domain::Vertex, width, values }
}

/// A number from all of the range of f64 now and then, and a plain one most of the time.
fn number(random: &mut Random) -> f64 {
    match random.below(8) {
        0 => [0.0, -0.0, 1e300, -1e300, 4e-324, 0.1, 1e16, 1e-7, 123456789012345680.0][random.below(9)],
        1 => {
            let any = f64::from_bits(random.bits());
            if any.abs() < 1e307 { any } else { 1.0 }
        }
        _ => random.unit() * 20.0 - 10.0,
    }
}

/// A random soup of triangles over random vertices.
fn soup(random: &mut Random, n: usize) -> Mesh {
    let positions: Vec<[f64; 3]> = (0..n).map(|_| std::array::from_fn(|_| number(random))).collect();
    let faces = (0..2 * n).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
    Mesh::new(positions, faces).expect("valid")
}

fn unit_normals(random: &mut Random, n: usize) -> Vec<[f64; 3]> {
    (0..n)
        .map(|_| {
            let v: [f64; 3] = std::array::from_fn(|_| random.unit() - 0.5);
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            v.map(|x| x / length)
        })
        .collect()
}

/// A cube with 24 vertices: hard edges, tied by position.
fn cube() -> Mesh {
    let (mut positions, mut normals, mut texcoords, mut id, mut faces) =
        (vec![], vec![], vec![], vec![], vec![]);
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let first = positions.len() as u32;
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
                id.push((4.0 * p[0] + 2.0 * p[1] + p[2]) as u32 + 7);
                positions.push(p.map(|x| x - 1.0 / 3.0));
                let mut n = [0.0; 3];
                n[axis] = 2.0 * side - 1.0;
                normals.push(n);
                texcoords.extend([u / 3.0, v]);
            }
            let quad: [[u32; 3]; 2] =
                if side > 0.0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
            faces.extend(quad.map(|f| f.map(|i| first + i)));
        }
    }
    Mesh::new(positions, faces)
        .and_then(|m| m.with_position_id(id))
        .and_then(|m| m.with_attribute(Attribute::vertex_normals(&normals)))
        .and_then(|m| m.with_attribute(vertex(Semantic::TexCoord(0), 2, texcoords)))
        .expect("valid")
}

#[test]
fn random_meshes_come_back_from_obj_and_ply_to_the_last_bit() {
    let seed = 0xC0FFEE;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    for round in 0..200 {
        let n = 3 + random.below(40);
        let mut mesh = soup(&mut random, n);
        let normals = unit_normals(&mut random, n);
        if round % 2 == 0 {
            mesh = mesh.with_attribute(Attribute::vertex_normals(&normals)).unwrap();
        }
        if round % 3 == 0 {
            let texcoords = (0..2 * n).map(|_| number(&mut random)).collect();
            mesh = mesh.with_attribute(vertex(Semantic::TexCoord(0), 2, texcoords)).unwrap();
        }
        for format in [Format::Obj, Format::Ply] {
            let back = there_and_back(&mesh, format);
            // A vertex that no face uses has no `vt` and no `vn` in OBJ.
            let used =
                |i: usize| format == Format::Ply || mesh.faces().iter().flatten().any(|f| *f as usize == i);
            assert_eq!(bits(back.positions()), bits(mesh.positions()), "round {round} {format}");
            assert_eq!(back.faces(), mesh.faces());
            assert_eq!(back.position_id(), None);
            assert_eq!(back.attributes().len(), mesh.attributes().len());
            for attribute in mesh.attributes() {
                let read = back.attribute(&attribute.semantic).expect("kept");
                for i in (0..n).filter(|i| used(*i)) {
                    if attribute.semantic == Semantic::Normal {
                        let single = |row: &[f64]| row.iter().map(|x| *x as f32).collect::<Vec<_>>();
                        assert_eq!(single(read.row(i)), single(attribute.row(i)), "round {round} {format}");
                    } else {
                        let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                        assert_eq!(bits(read.row(i)), bits(attribute.row(i)), "round {round} {format}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_creased_cube_stays_closed_and_creased() {
    let mesh = cube();
    for format in [Format::Obj, Format::Ply] {
        let back = there_and_back(&mesh, format);
        assert_eq!((back.positions().len(), back.n_positions()), (24, 8), "{format}");
        for (f, (face, read)) in mesh.faces().iter().zip(back.faces()).enumerate() {
            for k in 0..3 {
                let (i, j) = (face[k] as usize, read[k] as usize);
                assert_eq!(back.positions()[j], mesh.positions()[i], "{format} face {f}");
                for attribute in mesh.attributes() {
                    assert_eq!(back.attribute(&attribute.semantic).unwrap().row(j), attribute.row(i));
                }
                // Corners that shared a position still do, and no others.
                for (other, other_read) in mesh.faces().iter().zip(back.faces()) {
                    let tied = mesh.position_of(face[k]) == mesh.position_of(other[0]);
                    assert_eq!(tied, back.position_of(read[k]) == back.position_of(other_read[0]));
                }
            }
        }
        assert_eq!(there_and_back(&back, format), back, "the second time nothing changes");
    }
    let text = String::from_utf8(write(&scene_of(mesh), Format::Obj, None)).unwrap();
    assert_eq!(text.lines().filter(|l| l.starts_with("v ")).count(), 8, "each position once");
}

#[test]
fn stl_comes_back_as_rounded_triangles_tied_by_position() {
    let seed = 11;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let positions = (0..50).map(|_| std::array::from_fn(|_| random.unit() - 0.5)).collect();
    let faces = (0..99).map(|_| std::array::from_fn(|_| random.below(50) as u32)).collect();
    for mesh in [cube(), Mesh::new(positions, faces).unwrap()] {
        let back = there_and_back(&mesh, Format::Stl);
        assert_eq!(back.faces().len(), mesh.faces().len());
        for f in 0..mesh.faces().len() {
            assert_eq!(back.corners(f), mesh.corners(f).map(|p| p.map(|x| f64::from(x as f32))));
        }
        let mut used: Vec<_> = mesh.faces().iter().flatten().map(|i| mesh.position_of(*i)).collect();
        used.sort_unstable();
        used.dedup();
        assert_eq!(back.n_positions(), used.len());
    }
    let bytes = write(&scene_of(cube()), Format::Stl, None);
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(
        [number(84), number(88), number(92)],
        face_normal(cube().corners(0)).unwrap().map(|x| x as f32)
    );
}

#[test]
fn the_certificate_travels_to_the_last_bit() {
    let certificate = json!({
        "bound": { "at_most": 0.000_977_138_471_238_471_2, "at_least": 7.1e-4, "at": [1.0, -0.1, 1e-300] },
        "notes": ["a line\nbreak, a \"quote\" and an é", ""],
    });
    for format in [Format::Obj, Format::Ply, Format::Off] {
        let bytes = write(&scene_of(cube()), format, Some(&certificate));
        let (scene, warnings) = load_scene(&bytes, format);
        assert_eq!(scene.certificate.as_ref(), Some(&certificate), "{format}");
        assert_eq!(warnings.iter().filter(|w| w.code != "duplicate-vertices").count(), 0, "{warnings:?}");
        assert_eq!(scene.parts[0].mesh.faces().len(), 12);
    }
    let (scene, _) = load_scene(&write(&scene_of(cube()), Format::Stl, Some(&certificate)), Format::Stl);
    assert_eq!(scene.certificate, None);
    let long = Value::String("x".repeat(1 << 20));
    assert!(matches!(
        obj::write(&scene_of(cube()), Some(&long), &mut Vec::new()),
        Err(WriteError::Unsupported(_))
    ));
    assert!(matches!(
        ply::write(&scene_of(cube()), Some(&long), &mut Vec::new()),
        Err(WriteError::Unsupported(_))
    ));
}

#[test]
fn a_long_certificate_stands_in_short_lines() {
    let certificate = json!({ "name": "  \\ \u{e9}  ".repeat(9_000), "bound": 1.5 });
    for format in [Format::Ply, Format::Obj, Format::Off] {
        let bytes = write(&scene_of(cube()), format, Some(&certificate));
        let lines = bytes.split(|byte| *byte == b'\n').filter(|line| {
            let words = [&b"comment chordal "[..], b"# chordal: "];
            words.iter().any(|start| line.starts_with(start))
        });
        let lengths: Vec<usize> = lines.map(<[u8]>::len).collect();
        assert!(lengths.len() > 500 && lengths.iter().all(|n| *n <= 200), "{format}: {lengths:?}");
        let (scene, warnings) = load_scene(&bytes, format);
        assert_eq!(scene.certificate.as_ref(), Some(&certificate), "{format}");
        assert_eq!(count(&warnings, "certificate-unreadable"), 0);
    }
}

#[test]
fn one_line_of_earlier_versions_is_a_certificate_too() {
    let obj = "# chordal: {\"bound\": 2}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let off = "OFF\n# chordal: {\"bound\": 2}\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let ply = "ply\nformat ascii 1.0\ncomment chordal {\"bound\": 2}\nend_header\n";
    for (text, format) in [(obj, Format::Obj), (off, Format::Off), (ply, Format::Ply)] {
        let (scene, warnings) = load_scene(text.as_bytes(), format);
        assert_eq!(scene.certificate, Some(json!({ "bound": 2 })), "{format}: {warnings:?}");
    }
}

#[test]
fn lines_of_a_certificate_that_are_lost_or_moved_are_no_certificate() {
    let certificate = json!({ "name": "n".repeat(700) });
    for format in [Format::Ply, Format::Obj, Format::Off] {
        let bytes = write(&scene_of(cube()), format, Some(&certificate));
        let of_file: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        let first = of_file
            .iter()
            .position(|line| line.windows(10).any(|w| w == b"chordal 1/" || w == b"ordal: 1/5"))
            .unwrap();
        for damage in 0..3 {
            let mut lines = of_file.clone();
            match damage {
                0 => drop(lines.remove(first + 2)),
                1 => lines.insert(first + 2, of_file[first + 2]),
                _ => lines.swap(first + 1, first + 2),
            }
            let (scene, warnings) = load_scene(&lines.concat(), format);
            assert_eq!(
                (scene.certificate, count(&warnings, "certificate-unreadable")),
                (None, 1),
                "{format}"
            );
            assert_eq!(scene.parts[0].mesh.faces().len(), 12, "the mesh is read all the same");
        }
    }
}

#[test]
fn a_broken_certificate_is_counted_and_skipped() {
    let obj = b"# chordal: {\"bound\": \nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (scene, warnings) = load_scene(obj, Format::Obj);
    assert_eq!((scene.certificate, count(&warnings, "certificate-unreadable")), (None, 1));
    let deep = format!("ply\nformat ascii 1.0\ncomment chordal {}\nend_header\n", "[".repeat(60_000));
    let (scene, warnings) = load_scene(deep.as_bytes(), Format::Ply);
    assert_eq!((scene.certificate, count(&warnings, "certificate-unreadable")), (None, 1));
}

#[test]
fn colours_come_back_exactly_where_the_format_holds_them() {
    let bytes: Vec<f64> = (0..24 * 4).map(|i| f64::from((i * 37) % 256) / 255.0).collect();
    let mesh = |values: Vec<f64>| {
        let plain = Mesh::new(cube().positions().to_vec(), cube().faces().to_vec()).unwrap();
        plain.with_attribute(vertex(Semantic::Color(0), 4, values)).unwrap()
    };
    for format in [Format::Obj, Format::Ply, Format::Off] {
        let back = there_and_back(&mesh(bytes.clone()), format);
        assert_eq!(back.attribute(&Semantic::Color(0)).unwrap().values, bytes, "{format}");
    }
    let floats: Vec<f64> = bytes.iter().map(|x| f64::from((x * 0.7) as f32)).collect();
    let back = there_and_back(&mesh(floats.clone()), Format::Ply);
    assert_eq!(back.attribute(&Semantic::Color(0)).unwrap().values, floats);
}

#[test]
fn groups_of_obj_come_back_with_their_names() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl red paint\ng left\ns 3\nf 1 3 4\nusemtl blue\ns off\nf 1 2 4\ng\nf 2 3 4\n";
    let (scene, _) = load_scene(text.as_bytes(), Format::Obj);
    let (back, warnings) = load_scene(&write(&scene, Format::Obj, None), Format::Obj);
    assert_eq!(back, scene);
    assert_eq!(warnings, []);
    assert_eq!(losses(&scene, Format::Obj).unwrap(), []);
    let lost: Vec<_> = losses(&scene, Format::Ply).unwrap().into_iter().map(|w| w.message).collect();
    assert_eq!(
        lost,
        [
            "PLY holds no groups 'material' of faces",
            "PLY holds no groups 'g' of faces",
            "PLY holds no groups 's' of faces"
        ]
    );
}

fn node(matrix: [f64; 16], children: Vec<usize>, part: Option<usize>) -> Node {
    Node { matrix: matrix.into(), children, part, ..Node::default() }
}

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

#[test]
fn nodes_are_applied_and_a_mirror_keeps_the_front() {
    let part = Part { name: "cube".into(), mesh: cube(), indexed: true, ..Part::default() };
    let (mut scaled, mut mirror, mut moved) = (IDENTITY, IDENTITY, IDENTITY);
    (scaled[0], scaled[5], scaled[10]) = (4.0, 0.5, 2.0);
    mirror[0] = -1.0;
    (moved[12], moved[13], moved[14]) = (10.0, 20.0, 30.0);
    let scene = Scene {
        parts: vec![part],
        nodes: vec![
            node(moved, vec![1, 2], None),
            node(scaled, vec![], Some(0)),
            node(mirror, vec![], Some(0)),
        ],
        roots: vec![0],
        ..Scene::default()
    };
    for format in [Format::Obj, Format::Ply, Format::Stl, Format::Off] {
        let (back, _) = load_scene(&write(&scene, format, None), format);
        let mesh = &back.parts[0].mesh;
        assert_eq!(mesh.faces().len(), 24, "{format}");
        let normals = mesh.attribute(&Semantic::Normal);
        for f in 0..24 {
            let truth = face_normal(mesh.corners(f)).unwrap();
            let centre =
                mesh.corners(f).iter().fold([0.0; 3], |c, p| std::array::from_fn(|k| c[k] + p[k] / 3.0));
            // Outwards from the middle of its own cube: the cube spans -1/3 to 2/3, so its middle is 1/6.
            let middle = if f < 12 {
                [10.0 + 4.0 / 6.0, 20.0 + 0.5 / 6.0, 30.0 + 2.0 / 6.0]
            } else {
                [10.0 - 1.0 / 6.0, 20.0 + 1.0 / 6.0, 30.0 + 1.0 / 6.0]
            };
            let out: f64 = (0..3).map(|k| truth[k] * (centre[k] - middle[k])).sum();
            assert!(out > 0.2, "{format} face {f} looks inwards");
            if let Some(normals) = normals {
                let row = normals.row(mesh.faces()[f][0] as usize);
                let agree: f64 = (0..3).map(|k| truth[k] * row[k]).sum();
                // Single precision of the normals, and of positions near 30 over an edge of 1 / 2.
                assert!(agree > 1.0 - 1e-6, "{format} face {f}: {agree}");
            }
        }
    }
}

#[test]
fn scenes_that_no_format_can_hold_are_refused_by_name() {
    let with = |nodes: Vec<Node>, roots: Vec<usize>| Scene {
        parts: vec![Part { name: "p".into(), mesh: cube(), indexed: true, ..Part::default() }],
        nodes,
        roots,
        ..Scene::default()
    };
    let mut perspective = IDENTITY;
    perspective[3] = 0.1;
    let mut huge = IDENTITY;
    huge[0] = f64::MAX;
    let mut wide = IDENTITY;
    wide[0] = 1e300;
    let cases = [
        (with(vec![node(IDENTITY, vec![0], Some(0))], vec![0]), "node 0 is reached twice"),
        (with(vec![node(IDENTITY, vec![], Some(0))], vec![0, 0]), "node 0 is reached twice"),
        (with(vec![node(IDENTITY, vec![5], None)], vec![0]), "node 5 is not there"),
        (with(vec![node(IDENTITY, vec![], Some(3))], vec![0]), "shows a part that is not there"),
        (with(vec![node(perspective, vec![], Some(0))], vec![0]), "not affine"),
        (with(vec![node(huge, vec![1], None), node(wide, vec![], Some(0))], vec![0]), "not finite"),
    ];
    for (scene, words) in cases {
        for format in [Format::Obj, Format::Ply, Format::Stl, Format::Off] {
            let mut sink = Vec::new();
            let error = match format {
                Format::Obj => obj::write(&scene, None, &mut sink),
                Format::Ply => ply::write(&scene, None, &mut sink),
                Format::Off => off::write(&scene, None, &mut sink),
                _ => stl::write(&scene, None, &mut sink),
            };
            let message = error.unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
    let big = Mesh::new(vec![[1e39, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let message = stl::write(&scene_of(big), None, &mut Vec::new()).unwrap_err().to_string();
    assert!(message.contains("coordinate 1e39 is over the limit of STL"), "{message}");
}

/// Fails after so many bytes, as a full disk does.
struct Full(usize);

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.len() > self.0 {
            return Err(std::io::Error::other("no space left"));
        }
        self.0 -= bytes.len();
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_sink_that_fails_is_an_error_wherever_it_fails() {
    for format in [Format::Obj, Format::Ply, Format::Stl, Format::Off] {
        let size = write(&scene_of(cube()), format, None).len();
        for room in [0, 1, size - 1] {
            let mut full = Full(room);
            let result = match format {
                Format::Obj => obj::write(&scene_of(cube()), None, &mut full),
                Format::Ply => ply::write(&scene_of(cube()), None, &mut full),
                Format::Off => off::write(&scene_of(cube()), None, &mut full),
                _ => stl::write(&scene_of(cube()), None, &mut full),
            };
            assert!(matches!(result, Err(WriteError::Io(_))), "{format} {room}");
        }
    }
}

#[test]
fn what_a_format_leaves_out_is_told() {
    let mut scene = scene_of(cube());
    scene.certificate = Some(json!({}));
    assert_eq!(losses(&scene, Format::Obj).unwrap(), []);
    assert_eq!(losses(&scene, Format::Ply).unwrap(), []);
    let lost: Vec<_> = losses(&scene, Format::Stl).unwrap().into_iter().map(|w| w.message).collect();
    let all = [
        "STL holds no certificate",
        "STL holds no normals of vertices",
        "STL holds no texture coordinates of set 0 of vertices",
    ];
    assert_eq!(lost, all);
    let custom = vertex(Semantic::Custom("heat".into()), 1, vec![0.0; 24]);
    let scene = scene_of(cube().with_attribute(custom).unwrap());
    assert_eq!(losses(&scene, Format::Obj).unwrap()[0].message, "OBJ holds no values 'heat' of vertices");
}

#[test]
fn normals_of_corners_survive_obj() {
    let plain =
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2], [2, 1, 0]]).unwrap();
    let values = [[0.0, 0.0, 1.0]; 3].into_iter().chain([[0.0, 0.0, -1.0]; 3]).flatten().collect();
    let corner = Attribute { semantic: Semantic::Normal, domain: Domain::Corner, width: 3, values };
    let back = there_and_back(&plain.with_attribute(corner).unwrap(), Format::Obj);
    assert_eq!((back.positions().len(), back.n_positions()), (6, 3));
    let normals = back.attribute(&Semantic::Normal).unwrap();
    assert_eq!(normals.row(back.faces()[1][0] as usize), [0.0, 0.0, -1.0]);
}

#[test]
fn the_reader_of_each_format_gives_identity_nodes() {
    let bytes = write(&scene_of(cube()), Format::Obj, None);
    let ReadOutcome { content: Content::Scene(scene), .. } =
        read(&bytes, Format::Obj, &Limits::default()).unwrap()
    else {
        panic!("a scene")
    };
    assert_eq!((scene.nodes.len(), *scene.nodes[0].matrix, scene.roots), (1, IDENTITY, vec![0]));
}
