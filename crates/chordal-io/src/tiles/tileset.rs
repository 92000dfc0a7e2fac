//! `Tileset` and `Tile`: what a tileset says.
use serde_json::Value;

/// A tree of tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct Tileset {
    /// The error in metres where nothing of the tileset is shown.
    pub geometric_error: f64,
    /// The tile that covers all.
    pub root: Tile,
    /// Whatever else is said; for ours the certificate of the whole.
    pub extras: Option<Value>,
}

/// A part of space, and what is shown there.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Where its content and that of all its children is.
    pub volume: BoundingVolume,
    /// The error in metres where this tile is shown and its children are not; 0 where there are none.
    pub geometric_error: f64,
    /// What becomes of its content once its children are shown.
    pub refine: Refine,
    /// Column-major 4 × 4 matrix from its space to its parent's, where it has one of its own.
    pub transform: Option<Box<[f64; 16]>>,
    /// The files that show it, by their paths below the tileset's folder. Ours have one; an empty tile has
    /// none.
    pub contents: Vec<String>,
    /// Finer tiles for the same space.
    pub children: Vec<Tile>,
    /// Tiles below it that follow a rule, and that files of bits list.
    pub implicit: Option<ImplicitTiling>,
    /// Whatever else is said; for ours the certificate of this tile's content.
    pub extras: Option<Value>,
}

/// A volume around a tile, in metres. Tiles are z-up: a viewer turns y-up content by (x, y, z) → (x, −z, y).
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
    /// They stand in its place.
    #[default]
    Replace,
    /// They come on top of it.
    Add,
}

/// Tiles below one tile that are halves of it in each direction, as far as they are there.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplicitTiling {
    /// Into how many a tile falls.
    pub subdivision: Subdivision,
    /// Levels of tiles that one file lists.
    pub subtree_levels: u32,
    /// Files that list them.
    pub n_subtrees: u64,
    /// For each level, the tile itself first, how many tiles are there. The error of a level is half that of
    /// the one before.
    pub n_tiles: Vec<u64>,
    /// For each level how many files show its tiles.
    pub n_contents: Vec<u64>,
}

/// Into how many tiles one falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subdivision {
    /// Four, by x and y.
    Quadtree,
    /// Eight.
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
    /// All tiles with their depths, parents before their children; those that follow a rule are not among
    /// them.
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
        let mut found = Vec::new();
        while let Some((depth, tile)) = open.pop() {
            found.push((depth, tile));
            open.extend(tile.children.iter().rev().map(|child| (depth + 1, child)));
        }
        found
    }
}

impl Subdivision {
    /// Tiles that one falls into.
    pub(super) fn n_children(self) -> u64 {
        match self {
            Self::Quadtree => 4,
            Self::Octree => 8,
        }
    }
}
