//! What a glTF says of how it looks stays after every verb: flat shading, points and lines; and what is said where
//! its file was smaller.
use chordal::budget::attributes::AttributeLimits;
use chordal::explicit::Semantic;
use chordal::{Job, Mesh};
use chordal_io::glb::{self, GltfPacking};
use chordal_io::{Content, Format, Frame, Limits, Marks, Scene, read};
use chordal_verbs::{
    BudgetSpec, FormatHint, Input, LodParts, LodSpec, MendSpec, Normals, OutputForm, TileErrors, convert,
    load, lod, mend, mesh,
};
use serde_json::{Value, json};

/// A bent sheet of so many cells a side, without normals.
fn sheet(cells: u32) -> Mesh {
    let side = cells + 1;
    let point = |i: u32| {
        let [x, y] = [f64::from(i % side), f64::from(i / side)].map(|x| x / f64::from(cells));
        [x, y, f64::from((0.25 * x * x) as f32)].map(|x| f64::from(x as f32))
    };
    let quad = |i: u32| {
        let a = i % cells + i / cells * side;
        [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]
    };
    Mesh::new((0..side * side).map(point).collect(), (0..cells * cells).flat_map(quad).collect())
        .expect("valid")
}

fn glb_of(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    bytes
}

fn flat_sheet() -> Vec<u8> {
    glb_of(&Scene::from_mesh("sheet", sheet(12), Frame::default()))
}

/// The sheet with lines in a material of their own, and points with colours of three bytes: of these, rows are
/// padded in the file.
fn marked_sheet() -> Vec<u8> {
    let bytes = flat_sheet();
    let n_json = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let mut json: Value = serde_json::from_slice(&bytes[20..20 + n_json]).expect("JSON");
    let mut bin = bytes[28 + n_json..].to_vec();
    let mut view = |data: &[u8], stride: Option<u32>| {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": data.len() });
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        bin.extend_from_slice(data);
        let views = json["bufferViews"].as_array_mut().expect("views");
        views.push(view);
        views.len() - 1
    };
    let floats = |values: &[f32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let ends = view(&floats(&[0.0, 0.0, 0.1, 1.0, 0.5, 0.3, 0.25, 1.0, 0.7]), None);
    let pairs = view(&[0, 1, 1, 2], None);
    let colours = view(&[255, 0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0], Some(4));
    let n_bin = bin.len();
    json["buffers"][0]["byteLength"] = json!(n_bin);
    let accessors = json["accessors"].as_array_mut().expect("accessors");
    let first = accessors.len();
    accessors.extend([
        json!({ "bufferView": ends, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0.1_f32],
            "max": [1, 1, 0.7_f32] }),
        json!({ "bufferView": pairs, "componentType": 5121, "count": 4, "type": "SCALAR" }),
        json!({ "bufferView": colours, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC3" }),
    ]);
    let n_materials = json["materials"].as_array().map_or(0, Vec::len);
    json["materials"].as_array_mut().expect("materials").push(json!({ "name": "wire" }));
    json["meshes"][0]["primitives"].as_array_mut().expect("primitives").extend([
        json!({ "attributes": { "POSITION": first }, "indices": first + 1, "mode": 1, "material": n_materials,
            "extras": { "kind": "seam" } }),
        json!({ "attributes": { "POSITION": first, "COLOR_0": first + 2 }, "mode": 0 }),
    ]);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    bin.resize(n_bin.next_multiple_of(4), 0);
    let mut file = Vec::from(*b"glTF");
    for word in [2, 28 + text.len() + bin.len(), text.len(), 0x4E4F_534A] {
        file.extend((word as u32).to_le_bytes());
    }
    file.extend(&text);
    file.extend((bin.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&bin);
    file
}

fn input(bytes: &[u8]) -> Input {
    load(bytes, FormatHint::default(), &Limits::default()).expect("read")
}

fn scene_of(bytes: &[u8]) -> Scene {
    let Content::Scene(scene) = read(bytes, Format::Glb, &Limits::default()).expect("read").content else {
        panic!("no scene")
    };
    scene
}

fn within(normals: Normals) -> BudgetSpec {
    BudgetSpec { length: Some("1%".parse().expect("a length")), normals, ..BudgetSpec::default() }
}

fn levels(tile_triangles: Option<u64>, normals: Normals) -> LodSpec {
    let chordal::View::MinDistance(lens) = "1920x1080 fov=60 dist=1".parse().expect("a view") else {
        unreachable!()
    };
    LodSpec {
        pixels: "1px".parse().expect("pixels"),
        lens,
        nearest: None,
        length: Some("0.1%".parse().expect("a length")),
        distances: Vec::new(),
        normals,
        attributes: AttributeLimits::default(),
        errors: TileErrors::Plain,
        tile_triangles,
        parts: LodParts::Separate,
        place: None,
        packing: GltfPacking::default(),
    }
}

fn written_levels(bytes: &[u8], normals: Normals) -> Vec<u8> {
    let mut out = Vec::new();
    lod(input(bytes), &levels(None, normals), &Job::default())
        .expect("levels")
        .write(Format::Glb, &mut out)
        .expect("written");
    out
}

fn has_normals(scene: &Scene) -> bool {
    scene.parts[0].mesh.attribute(&Semantic::Normal).is_some()
}

#[test]
fn a_gltf_without_normals_stays_flat_unless_normals_are_requested() {
    let (file, job) = (flat_sheet(), Job::default());
    let crease = Normals::Crease { angle_deg: 30.0 };
    for (normals, expected) in [(Normals::Auto, false), (crease, true)] {
        for to in [Format::Glb, Format::Gltf, Format::Obj] {
            let made = mesh(input(&file), &within(normals), to, &job).expect("simplified");
            assert_eq!(has_normals(made.scene().expect("triangles")), expected, "{normals} to {to}");
        }
        assert_eq!(has_normals(&scene_of(&written_levels(&file, normals))), expected, "{normals} of levels");
    }
    // An OBJ does not say how it is shaded.
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let made = mesh(input(obj), &within(Normals::Auto), Format::Glb, &job).expect("simplified");
    assert!(has_normals(made.scene().expect("triangles")));
}

/// What every verb writes of a file, by the name of the verb.
fn after_all_verbs(file: &[u8]) -> Vec<(&'static str, Vec<u8>)> {
    let job = Job::default();
    let mut all = vec![("lod", written_levels(file, Normals::Auto))];
    let mut add = |name: &'static str, write: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = Vec::new();
        write(&mut bytes);
        all.push((name, bytes));
    };
    let cures = MendSpec { drop_unused: true, ..MendSpec::default() };
    add("convert", &|out| convert(input(file), Format::Glb).expect("converted").write(out).expect("written"));
    add("mend", &|out| {
        mend(input(file), &cures, Format::Glb, &job).expect("mended").write(out).expect("written")
    });
    let budget = within(Normals::Auto);
    add("mesh", &|out| {
        mesh(input(file), &budget, Format::Glb, &job).expect("made").write(out).expect("written")
    });
    all
}

#[test]
fn points_and_lines_stay_number_for_number_after_every_verb() {
    let file = marked_sheet();
    let before = scene_of(&file);
    assert_eq!(before.parts[0].marks.len(), 2);
    for (verb, bytes) in after_all_verbs(&file) {
        let after = scene_of(&bytes);
        assert_eq!(after.assets.materials, before.assets.materials, "{verb}");
        if verb != "mesh" {
            assert_eq!(*after.parts[0].marks, *before.parts[0].marks, "{verb}");
            continue;
        }
        // Triangles at new places may be stored about another point, and what is beside them with them.
        let node = after.nodes.iter().find(|node| node.part == Some(0)).expect("shown");
        for (given, kept) in before.parts[0].marks.iter().zip(after.parts[0].marks.iter()) {
            assert_eq!((&given.primitive, given.material), (&kept.primitive, kept.material), "{verb}");
            assert_eq!(given.accessors[1..], kept.accessors[1..], "{verb}");
            for (i, (x, stored)) in positions(given).iter().zip(positions(kept)).enumerate() {
                assert_eq!(node.matrix[12 + i % 3] + f64::from(stored), f64::from(*x), "{verb}");
            }
        }
    }
    let simplified = mesh(input(&file), &within(Normals::Auto), Format::Glb, &Job::default()).expect("made");
    let faces = |scene: &Scene| scene.parts[0].mesh.faces().len();
    assert!(faces(simplified.scene().expect("triangles")) < faces(&before));
}

/// The positions of marks, in single precision.
fn positions(marks: &Marks) -> Vec<f32> {
    let at = marks.primitive["attributes"]["POSITION"].as_u64().expect("positions") as usize;
    let numbers = marks.accessors[at].bytes.chunks_exact(4);
    numbers.map(|bytes| f32::from_le_bytes(bytes.try_into().expect("four bytes"))).collect()
}

#[test]
fn points_and_lines_stand_where_they_stood_where_triangles_are_on_a_lattice() {
    let file = marked_sheet();
    let packing = GltfPacking { is_compressed: true, is_quantized: true };
    let form = OutputForm { format: Format::Glb, packing };
    let mut bytes = Vec::new();
    convert(input(&file), form).expect("converted").write(&mut bytes).expect("written");
    let after = scene_of(&bytes);
    let node = after.nodes.iter().find(|node| node.part == Some(0)).expect("shown");
    assert_ne!(node.matrix[0], 1.0, "the node scales the lattice");
    for (before, marks) in scene_of(&file).parts[0].marks.iter().zip(after.parts[0].marks.iter()) {
        for (i, (x, stored)) in positions(before).iter().zip(positions(marks)).enumerate() {
            let placed = node.matrix[12 + i % 3] + node.matrix[0] * f64::from(stored);
            // One rounding to single precision of a number within the box of the part.
            assert!((placed - f64::from(*x)).abs() <= f64::from(f32::EPSILON), "{placed} for {x}");
        }
    }
}

#[test]
fn what_leaves_points_and_lines_out_says_so() {
    let file = marked_sheet();
    let converted = convert(input(&file), Format::Obj).expect("converted");
    let notes: Vec<String> = converted.certificate.notes.iter().map(ToString::to_string).collect();
    let note = notes.iter().find(|note| note.contains("points and lines")).expect("a note");
    assert!(note.contains("'wire'") && note.contains("2x"), "{note}");
    let tiles = lod(input(&file), &levels(Some(1000), Normals::Auto), &Job::default()).expect("tiles");
    let notes: Vec<String> = tiles.certificate.notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.contains("points and lines (2x)")), "{notes:?}");
}

#[test]
fn a_file_of_lines_alone_is_converted() {
    let mut scene = scene_of(&marked_sheet());
    scene.parts[0].mesh = Mesh::default();
    let bytes = glb_of(&scene);
    let mut again = Vec::new();
    convert(input(&bytes), Format::Glb).expect("converted").write(&mut again).expect("written");
    assert_eq!(*scene_of(&again).parts[0].marks, *scene.parts[0].marks);
}

#[test]
fn what_was_smaller_in_its_file_is_said_with_the_setting() {
    let both = GltfPacking { is_compressed: true, is_quantized: true };
    let job = Job::default();
    for (packing, words) in [
        (GltfPacking { is_quantized: false, ..both }, &["compress"][..]),
        (GltfPacking { is_compressed: false, ..both }, &["quantize"]),
        (both, &["compress", "quantize"]),
        (GltfPacking::default(), &[]),
    ] {
        let scene = Scene { packing, ..Scene::from_mesh("sheet", sheet(12), Frame::default()) };
        let file = glb_of(&scene);
        let said = |notes: &[chordal::budget::advice::Message]| {
            let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
            let note = notes.into_iter().find(|note| note.contains("and the output is not"));
            note.unwrap_or_default()
        };
        let cures = MendSpec { drop_unused: true, ..MendSpec::default() };
        let notes = [
            said(&convert(input(&file), Format::Glb).expect("converted").certificate.notes),
            said(&mend(input(&file), &cures, Format::Glb, &job).expect("mended").certificate.notes),
            said(
                &mesh(input(&file), &within(Normals::Auto), Format::Glb, &job)
                    .expect("made")
                    .certificate
                    .notes,
            ),
            said(&lod(input(&file), &levels(None, Normals::Auto), &job).expect("levels").certificate.notes),
        ];
        for note in notes {
            for word in ["compress", "quantize"] {
                let is_advised = note.contains(&format!("'{word}")) || note.contains(&format!("{word} "));
                assert_eq!(is_advised, words.contains(&word), "{note}");
            }
        }
        let form = OutputForm { format: Format::Glb, packing };
        assert_eq!(said(&convert(input(&file), form).expect("converted").certificate.notes), "");
    }
}
