//! `Tileset` and `Tile`: the tree of a tileset.
use serde_json::Value;

/// A tree of tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct Tileset {
    /// The geometric error in metres if nothing of the tileset is shown.
    pub geometric_error: f64,
    /// The tile that covers everything.
    pub root: Tile,
    /// Other data; in Chordal's files the certificate of the whole.
    pub extras: Option<Value>,
}

/// A region of space, with the content that shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// A volume around its content and that of all its children.
    pub volume: BoundingVolume,
    /// The geometric error in metres if this tile is shown and its children are not; 0 if it has none.
    pub geometric_error: f64,
    /// Whether children replace its content or add to it.
    pub refine: Refine,
    /// Column-major 4 × 4 matrix from its space to its parent's, if it has one.
    pub transform: Option<Box<[f64; 16]>>,
    /// The files of its content, by their paths below the tileset's folder. Chordal writes one; an empty tile
    /// has none.
    pub contents: Vec<String>,
    /// Finer tiles for the same region.
    pub children: Vec<Tile>,
    /// The implicit tiling below it: tiles that follow a rule, listed in subtree files.
    pub implicit: Option<ImplicitTiling>,
    /// Other data; in Chordal's files the certificate of this tile's content.
    pub extras: Option<Value>,
}

/// A bounding volume, in metres. Tiles are z-up: a viewer rotates y-up content by (x, y, z) → (x, −z, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundingVolume {
    /// The centre, then three half axes.
    Box([f64; 12]),
    /// West, south, east and north in radians, the lowest and highest height in metres.
    Region([f64; 6]),
    /// The centre and the radius.
    Sphere([f64; 4]),
}

/// How children relate to their parent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refine {
    /// They replace it.
    #[default]
    Replace,
    /// They are shown in addition to it.
    Add,
}

/// Implicit tiling: available tiles below one tile, each half as large in each direction as its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplicitTiling {
    /// How a tile is subdivided.
    pub subdivision: Subdivision,
    /// Levels of tiles in one subtree file.
    pub subtree_levels: u32,
    /// The number of subtree files.
    pub n_subtrees: u64,
    /// The number of available tiles of each level, from the tile itself on. Each level halves the geometric
    /// error.
    pub n_tiles: Vec<u64>,
    /// The number of contents of each level.
    pub n_contents: Vec<u64>,
}

/// How a tile is subdivided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subdivision {
    /// Into four, by x and y.
    Quadtree,
    /// Into eight.
    Octree,
}

impl Tile {
    /// A tile with one file and without children, which replaces its parent.
    #[must_use]
    pub fn leaf(volume: [f64; 12], uri: &str) -> Self {
        Self {
            volume: BoundingVolume::Box(volume),
            geometric_error: 0.0,
            refine: Refine::Replace,
            transform: None,
            contents: vec![uri.to_owned()],
            children: Vec::new(),
            implicit: None,
            extras: None,
        }
    }
}

impl Tileset {
    /// All tiles with their depths, parents before their children, without the tiles of implicit tilings.
    ///
    /// ```
    /// use chordal_io::tiles::{Tile, Tileset};
    /// let cube = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// let root = Tile { geometric_error: 0.5, children: vec![Tile::leaf(cube, "1.glb")], ..Tile::leaf(cube, "0.glb") };
    /// let tileset = Tileset { geometric_error: 2.0, root, extras: None };
    /// let depths: Vec<usize> = tileset.tiles().iter().map(|(depth, _)| *depth).collect();
    /// assert_eq!(depths, [0, 1]);
    /// ```
    #[must_use]
    pub fn tiles(&self) -> Vec<(usize, &Tile)> {
        let mut open = vec![(0, &self.root)];
        let mut tiles = Vec::new();
        while let Some((depth, tile)) = open.pop() {
            tiles.push((depth, tile));
            open.extend(tile.children.iter().rev().map(|child| (depth + 1, child)));
        }
        tiles
    }
}

impl Subdivision {
    /// The number of children of a tile.
    pub(super) fn n_children(self) -> u64 {
        match self {
            Self::Quadtree => 4,
            Self::Octree => 8,
        }
    }
}
