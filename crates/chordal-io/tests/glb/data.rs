//! Files of others, from the folder with test data.
use super::build::strict;
use chordal_io::{Content, Limits, ReadError, glb};
use chordal_testkit::corpus;

/// What gltf-validator 2.0.0-dev.3.10 refuses, and its first code; and what needs an extension.
const REFUSED: &[(&str, &str)] = &[
    ("corner/assimp/test/models/glTF2/BoxBadNormals-glTF-Binary/BoxBadNormals.glb", "ACCESSOR_MIN_MISMATCH"),
    (
        "corner/assimp/test/models/glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb",
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    ),
    ("corner/trimesh/models/cube.glb", "GLB_CHUNK_LENGTH_UNALIGNED"),
    ("gltf/khronos/testdata/CesiumMan/glTF_Binary/CesiumMan.glb", "ACCESSOR_WEIGHTS_NON_NORMALIZED"),
];

#[test]
fn all_files_read_as_the_validator_says() {
    let Some(folder) = corpus::find("") else { return };
    let mut all = corpus::files(&folder);
    all.retain(|path| path.extension().is_some_and(|e| e == "glb"));
    assert!(all.len() >= 40, "only {} files", all.len());
    let refused_by_all = |code: &str| ["unsupported-extension", "ACCESSOR_INVALID_FLOAT"].contains(&code);
    for path in all {
        let name = path.strip_prefix(&folder).expect("below").to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).expect("readable");
        let expected = REFUSED.iter().find(|(file, _)| *file == name).map(|(_, code)| *code);
        let code = |error: ReadError| error.code;
        assert_eq!(glb::read(&bytes, &strict()).map_err(code).err(), expected, "{name}");
        match glb::read(&bytes, &Limits::default()) {
            Ok(loaded) => {
                let is_warned = |code: &str| loaded.warnings.iter().any(|warning| warning.code == code);
                assert!(expected.is_none_or(is_warned), "{name} was accepted");
                let Content::Scene(scene) = loaded.content else { panic!("no scene") };
                let placed = scene.world_meshes().expect("placed");
                let is_empty = placed.iter().all(|(_, mesh)| mesh.faces().is_empty());
                // Two files have nodes and nothing to draw: `empty_nodes.glb` and `nodes.glb`.
                let file = path.file_name().expect("a file").to_string_lossy();
                assert_eq!(is_empty, ["empty_nodes.glb", "nodes.glb"].contains(&&*file), "{name}");
                let mut out = Vec::new();
                glb::write(&scene, None, &mut out).unwrap_or_else(|error| panic!("{name}: {error}"));
                let again = glb::read(&out, &strict()).unwrap_or_else(|error| panic!("{name}: {error}"));
                let Content::Scene(again) = again.content else { panic!("no scene") };
                assert_eq!(again.world_meshes().expect("placed").len(), placed.len(), "{name}");
            }
            Err(error) => assert!(refused_by_all(error.code), "{name}: {error}"),
        }
    }
}
