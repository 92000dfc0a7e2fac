//! Tilesets of others, from the folder with test data.
use chordal_io::tiles::{self, Refine, Subdivision, Tileset};
use chordal_io::{Limits, ReadError, Warning};
use chordal_testkit::corpus;
use std::path::Path;

fn read(folder: &Path) -> Result<(Tileset, Vec<Warning>), ReadError> {
    let bytes = std::fs::read(folder.join("tileset.json")).expect("readable");
    let mut open = |path: &str| std::fs::read(folder.join(path)).map_err(|error| error.to_string());
    tiles::read(&bytes, &mut open, &Limits::default())
}

#[test]
fn a_tileset_of_discrete_levels_reads() {
    let Some(folder) = corpus::find("tiles") else { return };
    let folder = folder.join("1.0/TilesetWithDiscreteLOD");
    let (tileset, warnings) = read(&folder).expect("read");
    assert_eq!(warnings, []);
    let tiles = tileset.tiles();
    let errors: Vec<f64> = tiles.iter().map(|(_, tile)| tile.geometric_error).collect();
    assert_eq!(errors, [1.0, 0.1, 0.0]);
    assert!(tiles.iter().all(|(_, tile)| tile.refine == Refine::Replace));
    assert_eq!(tileset.root.contents, ["dragon_low.b3dm"]);
    assert!(tileset.root.transform.is_some());
    // Its contents are tiles of 1.0, with a GLB in each.
    let bytes = std::fs::read(folder.join("dragon_low.b3dm")).expect("readable");
    let shown = tiles::content(&bytes, &Limits::default()).expect("read");
    let chordal_io::Content::Scene(scene) = shown.content else { panic!("no scene") };
    assert!(scene.parts.iter().any(|part| !part.mesh.faces().is_empty()));
}

#[test]
fn a_sparse_implicit_quadtree_reads() {
    let Some(folder) = corpus::find("tiles") else { return };
    let folder = folder.join("1.1/SparseImplicitQuadtree");
    let (tileset, warnings) = read(&folder).expect("read");
    assert_eq!(warnings, []);
    let implicit = tileset.root.implicit.as_ref().expect("implicit");
    assert_eq!((implicit.subdivision, implicit.subtree_levels), (Subdivision::Quadtree, 3));
    // Nine files with subtrees and 32 with contents are in the folder.
    assert_eq!(implicit.n_subtrees, 9);
    let n_files = std::fs::read_dir(folder.join("content")).expect("a folder").count() as u64;
    assert_eq!((implicit.n_contents.iter().sum::<u64>(), n_files), (32, 32));
    assert_eq!(implicit.n_tiles.len(), 6);
    assert_eq!(implicit.n_tiles[5], 32);
    assert!(implicit.n_tiles[..3].iter().sum::<u64>() == 7);
    for entry in std::fs::read_dir(folder.join("content")).expect("a folder") {
        let bytes = std::fs::read(entry.expect("an entry").path()).expect("readable");
        tiles::content(&bytes, &Limits::default()).expect("a GLB");
    }
}

#[test]
fn h75_a_subtree_that_is_missing_is_named() {
    let Some(folder) = corpus::find("tiles") else { return };
    let folder = folder.join("1.1/SparseImplicitQuadtree");
    let bytes = std::fs::read(folder.join("tileset.json")).expect("readable");
    let mut open = |path: &str| {
        if path == "subtrees/3.5.0.subtree" {
            return Err("gone".to_owned());
        }
        std::fs::read(folder.join(path)).map_err(|error| error.to_string())
    };
    let error = tiles::read(&bytes, &mut open, &Limits::default()).expect_err("refused");
    assert_eq!(error.code, "file-missing");
    assert!(error.to_string().contains("/root/implicitTiling/subtrees/uri"), "{error}");
    assert!(error.message.contains("subtrees/3.5.0.subtree"), "{error}");
}
