//! Levels as 3D Tiles: a chain, or a tree of regions.
use super::TileErrors;
use super::gltf_levels::file_extras;
use super::level_mesh::LevelMesh;
use super::outcome::{LodLayout, LodOutcome};
use super::scene_levels::SceneLevels;
use super::tile_hierarchy::TileHierarchy;
use crate::MeshFailure;
use crate::output::file_rows::unsupported;
use crate::scene::placements;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, RefusalCode};
use chordal::explicit::InvalidMesh;
use chordal::lod::selection::SwitchDistances;
use chordal::math::{Box3, add_up, greater, mul_up};
use chordal_io::tiles::{self, Tile, Tileset};
use chordal_io::{Axis, FileSet, Frame, ImageContent, Scene, SideFile, WriteError, glb};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeSet;

impl LodOutcome {
    /// The files of a tileset of 3D Tiles 1.1: `tileset.json` is the document, and beside it are the tiles, and once each
    /// picture that tiles show. If the finest level has up to `spec.tile_triangles`, there is one tile a level, each the
    /// child of the next coarser one. Above that, the finest level is cut in space ([`chordal::lod::tiling::tree`]), and
    /// tiles meet without cracks whichever are shown. A tile holds the materials of its own faces.
    ///
    /// # Errors
    /// As for [`glb::write`] and [`tiles::write`].
    pub fn tileset(&self) -> Result<FileSet<'_>, MeshFailure> {
        let mut files = TileFiles::default();
        let root = match &self.layout {
            LodLayout::Levels(levels) => self.as_chain(levels, &mut files)?,
            LodLayout::Cut(cut) => self.as_tree(cut, &mut files)?,
        };
        let tileset = self.tileset_from_root(root);
        let document = tiles::write(&tileset).map_err(|error| WriteError::Unsupported(error.to_string()))?;
        let TileFiles { files: mut beside, shown } = files;
        let pictures = self.layout.finest_scene().assets.picture_files(PICTURES);
        beside.extend(pictures.into_iter().filter(|file| shown.contains(&file.name)));
        Ok(FileSet { document, beside })
    }

    /// One tile a level.
    fn as_chain(&self, levels: &SceneLevels, files: &mut TileFiles<'_>) -> Result<Tile, MeshFailure> {
        let mut bounds = Box3::EMPTY;
        let mut tree: Option<Tile> = None;
        for k in 0..levels.levels.len() {
            let Some(level) = levels.level_mesh(k) else { continue };
            let name = format!("level_{k}.glb");
            // A tile's box has to contain those of its children, and a coarser level may lie inside of a finer one.
            bounds = bounds.union(self.write_tile(&level, &name, files)?);
            tree = Some(self.tile(&level, &bounds, &name, tree.take().into_iter().collect()));
        }
        tree.ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "there is no level"))
    }

    /// One tile a region.
    fn as_tree(&self, cut: &TileHierarchy, files: &mut TileFiles<'_>) -> Result<Tile, MeshFailure> {
        // Children come after their parents, so that in reverse order the children of every tile are finished.
        let mut done: Vec<Option<(Tile, Box3)>> = cut.tiles.iter().map(|_| None).collect();
        for (k, tile) in cut.tiles.iter().enumerate().rev() {
            let name = format!("tile_{k}.glb");
            let mut bounds = self.write_tile(tile, &name, files)?;
            let mut children = Vec::new();
            for (child, inner) in cut.children[k].iter().filter_map(|child| done[*child].take()) {
                bounds = bounds.union(inner);
                children.push(child);
            }
            done[k] = Some((self.tile(tile, &bounds, &name, children), bounds));
        }
        let mut root = root_of(cut.roots.iter().filter_map(|root| done[*root].take()).collect());
        root.transform = placement_matrix(cut.origin, &cut.finest.scene.frame);
        Ok(root)
    }

    /// Writes one mesh as a file. Returns its box, in the space of tiles.
    fn write_tile(
        &self,
        level: &LevelMesh,
        name: &str,
        files: &mut TileFiles<'_>,
    ) -> Result<Box3, MeshFailure> {
        let mut bytes = Vec::new();
        let scene = tile_scene(&level.scene).map_err(unsupported)?;
        glb::write(&scene, Some(&file_extras(&self.certificate, level)), &mut bytes)?;
        files.shown.extend(scene.assets.images.iter().filter_map(|image| match &image.content {
            ImageContent::Uri(uri) => Some(uri.clone()),
            ImageContent::Bytes(_) => None,
        }));
        files.files.push(SideFile { name: name.to_owned(), bytes: Cow::Owned(bytes) });
        Ok(tiles::content_bounds(&level.scene)?)
    }

    /// A tile for a file, with finer tiles as its children.
    fn tile(&self, level: &LevelMesh, bounds: &Box3, name: &str, children: Vec<Tile>) -> Tile {
        let metres = self.metres();
        let mut tile = Tile::leaf(tiles::aligned_box(bounds), name);
        tile.extras = Some(tile_extras(&level.bound, level.triangles, metres));
        if !children.is_empty() {
            tile.geometric_error = self.geometric_error(&level.bound, metres, largest_error(&children));
            tile.children = children;
        }
        tile
    }

    fn metres(&self) -> f64 {
        self.layout.finest_scene().frame.metres_per_unit.unwrap_or(1.0)
    }

    fn tileset_from_root(&self, mut root: Tile) -> Tileset {
        if let Some(place) = self.spec.place {
            // The origin of the coordinates is moved first, within the scene, and then the scene to its place on the
            // Earth.
            let root_matrix = root.transform.as_deref();
            root.transform = Some(Box::new(
                root_matrix.map_or(place.matrix(), |root_matrix| moved(&place.matrix(), root_matrix)),
            ));
        }
        let scaled = self.spec.errors == TileErrors::Scaled;
        let pixels = self.spec.pixels.get();
        let description = if scaled {
            "scaled so that the viewers' formula keeps the pixels everywhere on the screen"
        } else {
            "the proved error"
        };
        Tileset {
            // The error of showing not even the root.
            geometric_error: add_up(mul_up(self.diagonal, self.metres()), root.geometric_error),
            root,
            extras: Some(json!({ "chordal": {
                "certificate": self.certificate,
                "geometricError": description,
                "viewer": {
                    "3d-tiles-renderer": { "errorTarget": pixels },
                    "CesiumJS": { "maximumScreenSpaceError": pixels, "dynamicScreenSpaceError": false },
                },
            }})),
        }
    }

    /// The geometric error of a tile: viewers switch to it at the distance at which this is the requested pixels in the
    /// middle of the screen. It exceeds that of the children, as the specification requires.
    fn geometric_error(&self, bound: &Bound, metres: f64, finer: f64) -> f64 {
        let lens = &self.spec.lens;
        let at_most = bound.at_most().unwrap_or(f64::INFINITY);
        let error = placements::scaled_up(at_most, metres);
        let far =
            SwitchDistances::new(&[at_most], *lens, self.spec.pixels).distance(0).filter(|d| d.is_finite());
        let geometric_error = match (self.spec.errors, far.zip(lens.focal_px())) {
            (TileErrors::Scaled, Some((distance, focal))) => {
                // Four roundings here and two in the viewer may lower the value.
                let scaled = self.spec.pixels.get() * distance * metres / focal * (1.0 + 8.0 * f64::EPSILON); // rounded up
                greater(scaled, error)
            }
            _ => error,
        };
        // One step is enough: the writer refuses a tile whose error is not below that of its parent.
        let least = finer.next_up();
        greater(geometric_error, least)
    }
}

/// The single root tile: an empty tile above the roots if there are several.
pub(super) fn root_of(mut roots: Vec<(Tile, Box3)>) -> Tile {
    if roots.len() == 1 {
        return roots.remove(0).0;
    }
    let bounds = roots.iter().fold(Box3::EMPTY, |hull, (_, bounds)| hull.union(*bounds));
    let children: Vec<Tile> = roots.into_iter().map(|(tile, _)| tile).collect();
    let mut parent = Tile::leaf(tiles::aligned_box(&bounds), "");
    parent.contents.clear();
    // It shows nothing, which is off by up to the size of everything below it.
    parent.geometric_error = add_up(largest_error(&children), bounds.diagonal());
    parent.children = children;
    parent
}

/// The files of tiles, as far as they are written.
#[derive(Default)]
struct TileFiles<'a> {
    files: Vec<SideFile<'a>>,
    /// The pictures that the tiles name.
    shown: BTreeSet<String>,
}

/// The prefix of the names of pictures: empty, since they are in a folder of their own.
const PICTURES: &str = "";

/// A level in the form in which it is written: with the materials of its own faces, and pictures in files.
fn tile_scene(scene: &Scene) -> Result<Cow<'_, Scene>, InvalidMesh> {
    if scene.assets.images.is_empty() {
        return scene.with_used_materials();
    }
    let mut beside = scene.clone();
    *beside.assets = scene.assets.with_pictures_beside(PICTURES);
    let used = match beside.with_used_materials()? {
        Cow::Owned(used) => Some(used),
        Cow::Borrowed(_) => None,
    };
    Ok(Cow::Owned(used.unwrap_or(beside)))
}

/// A note on materials that no face has: tiles do not hold them.
pub(super) fn unused_note(scene: &Scene) -> Result<Option<Message>, MeshFailure> {
    let n_materials = scene.assets.materials.len();
    let used = scene.with_used_materials().map_err(unsupported)?.assets.materials.len();
    let note = || {
        format!(
            "tiles hold the materials that faces have: {} of {n_materials} are left out",
            n_materials - used
        )
    };
    Ok((used < n_materials).then(|| note().into()))
}

/// The largest geometric error of several tiles.
pub(super) fn largest_error(tiles: &[Tile]) -> f64 {
    tiles.iter().fold(0.0, |most, tile| greater(most, tile.geometric_error))
}

/// The extras of a tile.
pub(super) fn tile_extras(bound: &Bound, triangles: u64, metres: f64) -> Value {
    json!({ "chordal": {
        "at_most": placements::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), metres), "triangles": triangles,
        "evidence": bound.evidence().as_str(), "reference": bound.reference.as_str(),
    }})
}

/// The product of a matrix with a translation by the last column of another matrix, which is applied first.
fn moved(matrix: &[f64; 16], first: &[f64; 16]) -> [f64; 16] {
    let mut out = *matrix;
    for k in 0..3 {
        out[12 + k] = (0..3).fold(matrix[12 + k], |sum, j| sum + matrix[4 * j + k] * first[12 + j]);
    }
    out
}

/// The matrix that moves coordinates back from their origin, in the space of tiles: z-up and in metres.
pub(super) fn placement_matrix(origin: [f64; 3], frame: &Frame) -> Option<Box<[f64; 16]>> {
    if origin == [0.0; 3] {
        return None;
    }
    let metres = frame.metres_per_unit.unwrap_or(1.0);
    let [x, y, z] = origin.map(|x| x * metres);
    // To glTF, all that is not z-up is y-up, and viewers turn it.
    let [x, y, z] = if frame.up == Some(Axis::Z) { [x, y, z] } else { [x, -z, y] };
    Some(Box::new([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]))
}
