//! What is written compressed reads back as the same triangles.
use super::super::build::scene_of;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, vertex_normals};
use chordal_io::glb::{GltfPacking, write, write_embedded, write_files};
use chordal_io::{Frame, Limits, MATERIAL, Scene, glb, read_with};
use chordal_testkit::Random;
use serde_json::Value;

/// A bumpy sheet with normals, texture coordinates and two materials, its vertices and faces shuffled.
fn sheet(n: usize, random: &mut Random) -> Mesh {
    let mut places: Vec<[usize; 2]> = (0..n * n).map(|i| [i % n, i / n]).collect();
    for i in (1..places.len()).rev() {
        places.swap(i, random.below(i + 1));
    }
    let mut number = vec![0_u32; n * n];
    places.iter().zip(0..).for_each(|([x, y], i)| number[y * n + x] = i);
    let mut faces = Vec::new();
    for y in 0..n - 1 {
        for x in 0..n - 1 {
            let at = |x: usize, y: usize| number[y * n + x];
            faces.push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
            faces.push([at(x + 1, y + 1), at(x, y + 1), at(x, y)]);
        }
    }
    for i in (1..faces.len()).rev() {
        faces.swap(i, random.below(i + 1));
        faces[i].rotate_left(random.below(3));
    }
    let height = |x: usize, y: usize| (x as f64 * 0.3).sin() * (y as f64 * 0.2).cos();
    let positions = places.iter().map(|[x, y]| [*x as f64, *y as f64, f64::from(height(*x, *y) as f32)]);
    let mesh = Mesh::new(positions.collect(), faces).expect("a sheet");
    let normals = vertex_normals(&mesh).into_iter().flatten().map(|x| f64::from(x as f32)).collect();
    let texcoords = places.iter().flatten().map(|i| f64::from(*i as f32 / n as f32)).collect();
    let attribute = |semantic, domain, width, values| Attribute { semantic, domain, width, values };
    let groups = (0..mesh.faces().len()).map(|i| (1 + i % 2) as f64).collect();
    mesh.with_attribute(attribute(Semantic::Normal, Domain::Vertex, 3, normals))
        .and_then(|mesh| mesh.with_attribute(attribute(Semantic::TexCoord(0), Domain::Vertex, 2, texcoords)))
        .and_then(|mesh| {
            let semantic = Semantic::Group(MATERIAL.to_owned());
            mesh.with_attribute(attribute(semantic, Domain::Face, 1, groups))
        })
        .expect("attributes")
}

fn scene(mesh: Mesh, is_compressed: bool) -> Scene {
    let mut scene = Scene::from_mesh("sheet", mesh, Frame::default());
    scene.groups.insert(MATERIAL.to_owned(), ["", "red", "blue"].map(str::to_owned).to_vec());
    scene.packing = GltfPacking { is_compressed, ..GltfPacking::default() };
    scene
}

/// The triangles with all that their corners carry, whatever the order of triangles and of their corners.
fn content(mesh: &Mesh) -> Vec<Vec<u64>> {
    let bits = |values: &[f64]| values.iter().map(|x| (x + 0.0).to_bits()).collect::<Vec<_>>();
    let corner = |v: u32| {
        let mut all = bits(&mesh.positions()[v as usize]);
        for semantic in [Semantic::Normal, Semantic::TexCoord(0)] {
            all.extend(
                mesh.attribute(&semantic).map(|found| bits(found.row(v as usize))).unwrap_or_default(),
            );
        }
        all
    };
    let groups = mesh.attributes().iter().find(|attribute| attribute.domain == Domain::Face);
    let mut faces: Vec<Vec<u64>> = Vec::new();
    for (i, face) in mesh.faces().iter().enumerate() {
        let mut corners = face.map(corner);
        let first = (0..3).min_by_key(|k| corners[*k].clone()).expect("three");
        corners.rotate_left(first);
        let group = groups.map_or(0.0, |groups| groups.values[i]);
        faces.push([corners.concat(), vec![group.to_bits()]].concat());
    }
    faces.sort();
    faces
}

fn json_of(file: &[u8]) -> Value {
    let n = u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize;
    serde_json::from_slice(&file[20..20 + n]).expect("JSON")
}

#[test]
fn compressed_triangles_come_back_to_the_last_bit() {
    let mut random = Random::new(8);
    for n in [2, 3, 5, 17, 40, 90] {
        let mesh = sheet(n, &mut random);
        let (plain, packed) = (scene(mesh.clone(), false), scene(mesh, true));
        let mut files = [Vec::new(), Vec::new()];
        write(&plain, None, &mut files[0]).expect("written");
        write(&packed, None, &mut files[1]).expect("written");
        let [plain, back] = files.each_ref().map(|file| {
            let (scene, warnings) = scene_of(glb::read(file, &Limits::default()).expect("read"));
            assert!(warnings.is_empty(), "{warnings:?}");
            content(&scene.parts[0].mesh)
        });
        assert_eq!(plain, back, "{n}");
        if n >= 17 {
            let share = files[1].len() as f64 / files[0].len() as f64;
            assert!(share < if n == 17 { 0.8 } else { 0.65 }, "{n}: {share} of the bytes");
            let json = json_of(&files[1]);
            assert_eq!(json["extensionsRequired"][0], "EXT_meshopt_compression");
            assert_eq!(json["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"], true);
        }
        if n == 2 {
            // What would be longer compressed is not.
            assert!(json_of(&files[1])["extensionsRequired"].is_null());
        }
    }
}

#[test]
fn what_is_beside_or_in_the_text_is_compressed_too() {
    let packed = scene(sheet(20, &mut Random::new(4)), true);
    let expected = {
        let mut file = Vec::new();
        write(&packed, None, &mut file).expect("written");
        content(&scene_of(glb::read(&file, &Limits::default()).expect("read")).0.parts[0].mesh)
    };
    let mut text = Vec::new();
    write_embedded(&packed, None, &mut text).expect("written");
    let (embedded, _) = scene_of(glb::read(&text, &Limits::default()).expect("read"));
    assert_eq!(content(&embedded.parts[0].mesh), expected);
    let files = write_files(&packed, None, "sheet").expect("written");
    let bytes = files.beside[0].bytes.to_vec();
    let mut open = |name: &str| {
        assert_eq!(name, "sheet.bin");
        Ok(bytes.clone())
    };
    let limits = Limits::default();
    let loaded = read_with(&files.document, chordal_io::Format::Gltf, &mut open, &limits).expect("read");
    assert_eq!(content(&scene_of(loaded).0.parts[0].mesh), expected);
}
