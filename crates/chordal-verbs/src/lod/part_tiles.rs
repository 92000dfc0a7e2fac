//! Tiles of a surface that is built part by part: `part_tile` for each, `part_tileset` for the tree of all.
use super::level_mesh::counts;
use super::tile_hierarchy::{about, up};
use super::tileset::{largest_error, placement_matrix, root_of, tile_extras};
use crate::MeshFailure;
use crate::output::file_rows::order_new_triangles;
use crate::report::BoundFacts;
use crate::scene::placements::scaled_up;
use chordal::budget::{Bound, Reference, RefusalCode};
use chordal::lod::tiling::SurfacePart;
use chordal::math::{Box3, add_up, greater, mul_up};
use chordal_io::tiles::{self, Tile, Tileset};
use chordal_io::{Format, Frame, Scene, WriteError, glb, snap};
use serde_json::json;

/// A part of a surface at the positions of its tile, and that tile.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTile {
    /// The part, in coordinates relative to the common origin of all tiles.
    pub part: SurfacePart,
    /// The tile's file.
    pub glb: Vec<u8>,
    /// The entry of the tile in a tileset.
    pub entry: TileEntry,
}

/// The entry of a tile in a tileset.
#[derive(Clone, Debug, PartialEq)]
pub struct TileEntry {
    /// The name of its file.
    pub name: String,
    /// The box of its content in viewers, in the space of tiles.
    pub bounds: Box3,
    /// The error of its triangles.
    pub bound: Bound,
    /// The number of its triangles.
    pub triangles: u64,
    /// The tiles with finer versions of its region, as indices of entries before this one.
    pub children: Vec<usize>,
}

/// A part with positions in single precision relative to `origin`. The origin has to be the same for all parts, so that
/// shared vertices stay equal; it may be zero for a part with such positions. Rounding adds to the bound.
///
/// # Errors
/// [`MeshFailure::Refused`] for coordinates beyond single precision.
pub fn rounded_part(part: &SurfacePart, origin: [f64; 3]) -> Result<SurfacePart, MeshFailure> {
    let (local, rounding) = about(&part.mesh, origin)?;
    // STL stores single precision without an origin of its own.
    let rounded = snap(&local, Format::Stl)?;
    // Two roundings: that of the difference to the origin, and that to single precision.
    let moved = Bound::proved(0.0, up(rounded.moved_at_most, rounding), Reference::InputTriangles);
    let mut bound = if moved.at_most() == Some(0.0) { part.bound.clone() } else { part.bound.then(&moved) };
    // The worst place moves with the coordinates.
    bound.at = bound.at.map(|at| std::array::from_fn(|k| at[k] - origin[k]));
    Ok(SurfacePart { mesh: rounded.mesh, shared: part.shared.clone(), bound })
}

/// The file of a part with rounded positions, and its entry.
///
/// # Errors
/// As for [`glb::write`].
pub fn part_tile(
    part: SurfacePart,
    frame: Frame,
    name: String,
    children: Vec<usize>,
) -> Result<PartTile, MeshFailure> {
    let mut scene = Scene::from_mesh(super::level_finisher::NAME, part.mesh.clone(), frame);
    order_new_triangles(&mut scene)?;
    let (triangles, vertices) = counts(&scene);
    let extras = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "bound": BoundFacts::new(&part.bound),
        "output": { "triangles": triangles, "vertices": vertices },
    });
    let mut bytes = Vec::new();
    glb::write(&scene, Some(&extras), &mut bytes)?;
    let bounds = tiles::content_bounds(&scene)?;
    let entry = TileEntry { name, bounds, bound: part.bound.clone(), triangles, children };
    Ok(PartTile { part, glb: bytes, entry })
}

/// The document of a tileset of parts: entries that are not a child of another entry are at its root.
///
/// The geometric error of a tile is its proved error in metres, at least a step above that of its children.
///
/// # Errors
/// [`MeshFailure::Refused`] without an entry; as for [`tiles::write`].
pub fn part_tileset(entries: &[TileEntry], origin: [f64; 3], frame: &Frame) -> Result<Vec<u8>, MeshFailure> {
    let metres = frame.metres_per_unit.unwrap_or(1.0);
    let mut done: Vec<Option<(Tile, Box3)>> = Vec::with_capacity(entries.len());
    for entry in entries {
        let mut bounds = entry.bounds;
        let mut children = Vec::new();
        for (child, inner) in entry.children.iter().filter_map(|child| done.get_mut(*child)?.take()) {
            bounds = bounds.union(inner);
            children.push(child);
        }
        let mut tile = Tile::leaf(tiles::aligned_box(&bounds), &entry.name);
        tile.extras = Some(tile_extras(&entry.bound, entry.triangles, metres));
        if !children.is_empty() {
            let error = scaled_up(entry.bound.at_most().unwrap_or(f64::INFINITY), metres);
            tile.geometric_error = greater(error, largest_error(&children).next_up());
            tile.children = children;
        }
        done.push(Some((tile, bounds)));
    }
    let roots: Vec<(Tile, Box3)> = done.into_iter().flatten().collect();
    let all_bounds = roots.iter().fold(Box3::EMPTY, |hull, (_, bounds)| hull.union(*bounds));
    let Some(mut bound) =
        Bound::of_parts(entries.iter().filter(|entry| entry.children.is_empty()).map(|entry| &entry.bound))
    else {
        return Err(MeshFailure::refused(RefusalCode::Empty, "no part has a surface"));
    };
    bound.at = bound.at.map(|at| std::array::from_fn(|k| at[k] + origin[k]));
    let mut root = root_of(roots);
    root.transform = placement_matrix(origin, frame);
    let tileset = Tileset {
        // The product with 1 is one step above the diagonal, which is a rounded number.
        geometric_error: add_up(mul_up(all_bounds.diagonal(), 1.0), root.geometric_error),
        root,
        extras: Some(json!({ "chordal": {
            "version": env!("CARGO_PKG_VERSION"),
            "bound": BoundFacts::new(&bound),
            "geometricError": "the proved error",
        }})),
    };
    tiles::write(&tileset).map_err(|error| WriteError::Unsupported(error.to_string()).into())
}
