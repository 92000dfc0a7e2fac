//! Real files: each ends in a shape, a shape with warnings, or one error that names its place.
use crate::common;
use chordal_testkit::corpus;

use chordal::Mesh;
use chordal_io::{Content, Format, Limits, read};
use common::count;

/// Positions and triangles by a count that shares nothing with the readers; `None` where it is too simple for
/// a file.
fn naive_counts(bytes: &[u8], format: Format) -> Option<(usize, usize)> {
    let text = String::from_utf8_lossy(bytes);
    let first = |line: &str| line.split_whitespace().next().unwrap_or("").to_owned();
    match format {
        Format::Obj => {
            if text.contains("\\\n") || text.contains("\\\r") {
                return None;
            }
            let n_positions = text.lines().filter(|l| first(l) == "v").count();
            let corners = text.lines().filter(|l| first(l) == "f").map(|l| l.split_whitespace().count() - 1);
            Some((n_positions, corners.map(|n| n.saturating_sub(2)).sum()))
        }
        Format::Ply => {
            let rows = |name: &str| {
                let line =
                    text.split(['\n', '\r']).find(|l| l.trim().starts_with("element") && l.contains(name))?;
                line.split_whitespace().nth(2)?.parse::<usize>().ok()
            };
            Some((rows("vertex").unwrap_or(0), rows("face").unwrap_or(0)))
        }
        Format::Stl => {
            let n = text.lines().filter(|l| first(l).eq_ignore_ascii_case("endfacet")).count();
            let binary = bytes.get(80..84).map_or(0, |b| u32::from_le_bytes(b.try_into().unwrap()) as usize);
            let n = if bytes.len() == 84 + 50 * binary { binary } else { n };
            Some((3 * n, n))
        }
        Format::Off => {
            let words = |line: &str| line.split('#').next().unwrap_or("").trim().replace("OFF", " ");
            let rows: Vec<String> = text.lines().map(words).filter(|line| !line.trim().is_empty()).collect();
            let number = |i: usize, k: usize| rows[i].split_whitespace().nth(k)?.parse::<usize>().ok();
            let (n_positions, n_faces) = (number(0, 0)?, number(0, 1)?);
            let corners = (0..n_faces).map(|i| number(1 + n_positions + i, 0));
            Some((n_positions, corners.map(|n| n.unwrap_or(0).saturating_sub(2)).sum()))
        }
        _ => None,
    }
}

fn compare(name: &str, mesh: &Mesh, (n_positions, n_triangles): (usize, usize), format: Format) {
    let positions = if format == Format::Obj { mesh.n_positions() } else { mesh.positions().len() };
    assert_eq!(positions, n_positions, "{name}");
    if format == Format::Ply {
        // The header counts polygons, of which each is one triangle or more.
        assert!(mesh.faces().len() >= n_triangles, "{name}");
    } else {
        assert_eq!(mesh.faces().len(), n_triangles, "{name}");
    }
}

#[test]
fn known_models_have_the_counts_that_they_are_known_for() {
    let Some(data) = corpus::find("") else { return };
    for (path, vertices, positions, triangles) in [
        ("mesh/bunny/testdata/bun_zipper.ply", 35_947, 35_947, 69_451),
        ("mesh/common/data/spot.obj", 3_225, 2_930, 5_856),
        ("mesh/common/data/cow.obj", 2_903, 2_903, 5_804),
        ("mesh/common/data/homer.obj", 6_002, 6_002, 12_000),
        ("mesh/common/data/fandisk.obj", 6_475, 6_475, 12_946),
        ("mesh/common/data/suzanne.obj", 507, 507, 968),
        ("mesh/trimesh/models/featuretype.STL", 10_428, 2_010, 3_476),
        ("corner/assimp/test/models/STL/Spider_binary.stl", 4_104, 722, 1_368),
        ("mesh/libigl/lion.off", 8_356, 8_356, 16_674),
        ("corner/trimesh/models/whitespace.off", 8, 8, 12),
    ] {
        let bytes = std::fs::read(data.join(path)).expect("readable");
        let format = Format::from_extension(path.rsplit('.').next().unwrap()).expect("known");
        let (mesh, _) = common::load(&bytes, format);
        assert_eq!(
            (mesh.positions().len(), mesh.n_positions(), mesh.faces().len()),
            (vertices, positions, triangles),
            "{path}"
        );
    }
}

#[test]
fn text_and_binary_of_one_model_are_one_mesh() {
    let Some(data) = corpus::find("") else { return };
    let load = |path: &str| {
        let bytes = std::fs::read(data.join(path)).expect("readable");
        common::load(&bytes, Format::from_extension(path.rsplit('.').next().unwrap()).expect("known")).0
    };
    let single = |mesh: &Mesh| mesh.positions().iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
    for (a, b) in [
        ("corner/assimp/test/models/STL/Spider_ascii.stl", "corner/assimp/test/models/STL/Spider_binary.stl"),
        (
            "topology/geometry-central/test/assets/stl_box_ascii.stl",
            "topology/geometry-central/test/assets/stl_box_binary.stl",
        ),
        ("corner/draco/testdata/test_pos_color_ascii.ply", "corner/draco/testdata/test_pos_color.ply"),
        (
            "corner/assimp/test/models/PLY/cube_binary.ply",
            "corner/assimp/test/models/PLY/cube_binary_header_with_RN_newline.ply",
        ),
    ] {
        let (a, b) = (load(a), load(b));
        assert_eq!(a.faces(), b.faces());
        // The text has six or seven decimals of the same numbers.
        for (p, q) in single(&a).iter().flatten().zip(single(&b).iter().flatten()) {
            assert!((p - q).abs() <= 1e-6 * p.abs().max(1.0), "{p} {q}");
        }
    }
}

#[test]
fn every_real_file_ends_well() {
    let Some(data) = corpus::find("") else { return };
    let mut counts = [0_usize; 3];
    for folder in ["mesh", "corner", "topology", "batch", "patches"] {
        for path in corpus::files(&data.join(folder)) {
            let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
            let bytes = std::fs::read(&path).expect("readable");
            let known = Format::from_extension(extension).or_else(|| Format::sniff(&bytes));
            let Some(format) = known.filter(|f| !matches!(f, Format::Glb | Format::Gltf)) else { continue };
            let name = path.strip_prefix(&data).expect("below").display();
            match read(&bytes, format, &Limits::default()) {
                Ok(loaded) => {
                    // A binary STL with bytes after its end is known by its extension alone.
                    let is_odd = count(&loaded.warnings, "trailing-bytes") > 0;
                    assert!(is_odd || Format::sniff(&bytes) == Some(format), "{name} by its content");
                    let shape = match &loaded.content {
                        Content::Scene(scene) => {
                            let mesh = &scene.parts[0].mesh;
                            let is_plain = |code| count(&loaded.warnings, code) == 0;
                            if let Some(naive) = naive_counts(&bytes, format)
                                .filter(|_| is_plain("short-faces") && is_plain("faces-over-lines"))
                            {
                                compare(&name.to_string(), mesh, naive, format);
                            }
                            format!(
                                "{:>7} v {:>7} p {:>7} f",
                                mesh.positions().len(),
                                mesh.n_positions(),
                                mesh.faces().len()
                            )
                        }
                        Content::Polygons(polygons) => format!("{:>7} polygons", polygons.cage.n_faces()),
                        Content::Patches(patches, _) => format!("{:>7} patches", patches.len()),
                        Content::Surfaces(surfaces, _) => format!("{:>7} surfaces", surfaces.len()),
                        Content::Drawing(drawing) => format!("{:>7} curves", drawing.lines.len()),
                        Content::Curves(curves) => format!("{:>7} curves", curves.lines.len()),
                        Content::Field { field, .. } => format!("{:>7} steps", field.tape().len()),
                        Content::Volume(volume) => format!("{:>7} samples", volume.grid.samples().len()),
                    };
                    let warned: Vec<String> =
                        loaded.warnings.iter().map(|w| format!("{} {}", w.code, w.count)).collect();
                    counts[usize::from(!warned.is_empty())] += 1;
                    println!("{name}: {shape}  {}", warned.join(", "));
                }
                Err(error) => {
                    counts[2] += 1;
                    println!("{name}: E {}: {error}", error.code);
                    assert!(!error.message.is_empty() && !error.code.is_empty());
                }
            }
        }
    }
    println!("{} clean, {} with warnings, {} refused", counts[0], counts[1], counts[2]);
    assert!(counts.iter().sum::<usize>() > 200, "{counts:?}: too few files to judge");
}
