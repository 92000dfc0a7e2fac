//! `TileHierarchy`: a finest level that is cut in space, and coarser tiles above it.
use super::level_finisher::{LevelFinisher, round_attributes};
use super::level_mesh::{LevelMesh, counts};
use super::source::CutRule;
use crate::MeshFailure;
use crate::output::file_rows::{to_file_rows, unsupported};
use crate::output::format_rounding::RoundingTarget;
use crate::output::notes::reduction_notes;
use crate::report::LevelFacts;
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Reference, RefusalCode, Tolerance};
use chordal::explicit::Topology;
use chordal::lod::tiling::TilingOptions;
use chordal::lod::{self, ReductionStats};
use chordal::math::{add_up, greater, mul_up};
use chordal::{Bounded, Job, Mesh, mend};
use chordal_io::{Format, snap};

/// The most leaves of a tree of tiles. Chosen: each is a file, and all are in memory at once.
const MOST_TILES: usize = 20_000;

/// A finest level that is cut in space, with all coarser levels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TileHierarchy {
    /// The finest level in one piece, for views from near.
    pub finest: LevelMesh,
    /// Tiles in the form in which they will be written, parents before children.
    pub tiles: Vec<LevelMesh>,
    /// By tile: the tiles that show the same region at a finer level.
    pub children: Vec<Vec<usize>>,
    pub roots: Vec<usize>,
    /// The origin of all coordinates.
    pub origin: [f64; 3],
}

impl TileHierarchy {
    /// Cuts a mesh into tiles of at most `most` triangles. Coordinates are in single precision relative to one common
    /// origin, or on one lattice about it, so that coordinates that two tiles share are identical.
    pub fn build(
        finest: Bounded<Mesh>,
        finisher: &LevelFinisher,
        CutRule { most, lattice }: CutRule,
        notes: &mut Vec<Message>,
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let Bounded { shape: mesh, bound } = finest;
        let n = mesh.faces().len();
        if n / most > MOST_TILES {
            let message = format!("{n} triangles in tiles of {most} are more than {MOST_TILES} files: let ");
            let message = Message::from(message).setting(Setting::TileTriangles).words(" be larger");
            return Err(MeshFailure::Usage(message));
        }
        // One origin for all tiles, chosen by the whole mesh: with one each, a shared vertex would be rounded
        // differently.
        let origin = snap(&mesh, Format::Glb)?.origin;
        let (local, rounding) = about(&mesh, origin)?;
        // Not glTF's own rounding, which would choose an origin for each tile: that of STL has none.
        let target = RoundingTarget::new(Format::Stl, lattice);
        let storage = finisher.storage(lattice);
        let (rounded, moved) = round_tile(&local, &target, job)?;
        let bound = bound.then(&Bound::proved(0.0, up(moved, rounding), Reference::InputTriangles));
        let mut scene = finisher.scene(rounded, storage)?;
        finisher.apply_normals(&mut scene, notes)?;
        scene.parts.iter_mut().try_for_each(round_attributes)?;
        let scene = to_file_rows(scene, Format::Glb)?;
        let Some(part) = scene.parts.first() else {
            return Err(MeshFailure::refused(RefusalCode::Empty, "there is no triangle to cut"));
        };
        // If the finest level has no error, the errors of coarser levels start at its resolution.
        let resolution = f64::from(f32::EPSILON) * part.mesh.bounds().diagonal(); // about that of single precision
        let step = bound.at_most().and_then(|most| Tolerance::new(most).ok());
        let step = step.or_else(|| Tolerance::new(resolution).ok());
        let step = step.ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "the shape has no size"))?;
        let cuts = TilingOptions {
            max_triangles: most,
            attributes: finisher.attributes,
            ..TilingOptions::from_step(step)
        };
        // The tree starts from the rounded mesh, whose bound has the rounding in it, so that leaves add none.
        let root = Bounded { shape: part.mesh.clone(), bound: bound.clone() };
        let tree = lod::tiling::tree(&root, Topology::Positions, &cuts, job)?;
        let mut stats = ReductionStats::default();
        tree.roots.iter().for_each(|root| stats += tree.tiles[*root].stats);
        notes.extend(reduction_notes(&stats));
        let (mut tiles, mut children) = (Vec::new(), Vec::new());
        for tile in tree.tiles {
            let (rounded, moved) = round_tile(&tile.mesh, &target, job)?;
            let step = Bound::proved(0.0, moved, Reference::InputTriangles);
            // Collapses make new positions in coarser tiles, which are rounded for the first time here.
            let bound = if moved > 0.0 { tile.bound.then(&step) } else { tile.bound };
            let scene = to_file_rows(finisher.scene(rounded, storage)?, Format::Glb)?;
            let (triangles, vertices) = counts(&scene);
            tiles.push(LevelMesh { scene, bound, triangles, vertices });
            children.push(tile.children);
        }
        let (triangles, vertices) = counts(&scene);
        let finest = LevelMesh { scene, bound, triangles, vertices };
        Ok(Self { finest, tiles, children, roots: tree.roots, origin })
    }

    /// The tiles that are shown for an allowed error: the coarsest tiles within it, and leaves.
    fn visible_tiles(&self, error: f64) -> Vec<usize> {
        let mut open = self.roots.clone();
        let mut shown = Vec::new();
        while let Some(tile) = open.pop() {
            if self.children[tile].is_empty() || self.tiles[tile].error() <= error {
                shown.push(tile);
            } else {
                open.extend(&self.children[tile]);
            }
        }
        shown
    }

    /// The tiles that are shown if all of the shape is equally far away, for each error of a tile.
    pub fn counts(&self) -> Vec<LevelFacts> {
        let mut errors: Vec<f64> = self.tiles.iter().map(LevelMesh::error).collect();
        errors.sort_by(f64::total_cmp);
        errors.dedup();
        let mut levels: Vec<LevelFacts> = Vec::new();
        for error in errors {
            let shown = self.visible_tiles(error);
            let sum = |count: fn(&LevelMesh) -> u64| shown.iter().map(|tile| count(&self.tiles[*tile])).sum();
            let at_most = shown.iter().fold(0.0, |most, tile| greater(most, self.tiles[*tile].error()));
            // The error of one tile may make up for the error of another.
            let at_least = if let [tile] = shown[..] { self.tiles[tile].bound.at_least() } else { 0.0 };
            let tiles = shown.len() as u64;
            let level = LevelFacts {
                triangles: sum(|tile| tile.triangles),
                vertices: sum(|tile| tile.vertices),
                at_least,
                at_most,
                evidence: self.finest.bound.evidence().as_str(),
                distance: None,
                tiles,
                geometry: None,
                attributes: Vec::new(),
            };
            if levels.last().is_none_or(|finer| at_most > finer.at_most && level.triangles < finer.triangles)
            {
                levels.push(level);
            }
        }
        levels
    }
}

/// A mesh in coordinates relative to an origin, and the largest distance by which rounding them moves a vertex.
pub(super) fn about(mesh: &Mesh, origin: [f64; 3]) -> Result<(Mesh, f64), MeshFailure> {
    if origin == [0.0; 3] {
        return Ok((mesh.clone(), 0.0));
    }
    let local = mesh.positions().iter().map(|p| std::array::from_fn(|k| p[k] - origin[k])).collect();
    let local = mesh.with_positions(local).map_err(unsupported)?;
    // Half a unit in the last place of each of three differences, and of each coordinate of the origin in metres: less than
    // two units of the largest number.
    let largest = reach(local.positions().as_flattened());
    let rounding = mul_up(2.0 * f64::EPSILON, add_up(largest, reach(&origin)));
    Ok((local, rounding))
}

/// The triangles of a tile at the positions of its file, and the largest distance that these moved. Triangles that a lattice
/// left with two corners at one point are dropped: their neighbours share the edge.
fn round_tile(mesh: &Mesh, target: &RoundingTarget, job: &Job) -> Result<(Mesh, f64), MeshFailure> {
    let snapped = target.snap(mesh)?;
    if target.lattice.is_some() && snapped.moved_at_most > 0.0 {
        let cleaned = mend::drop_collapsed(&snapped.mesh, Topology::Positions, job)?;
        // If nothing would remain, there is no bound, and all triangles stay.
        if let Some(moved) = cleaned.bound.at_most() {
            return Ok((cleaned.mesh, up(snapped.moved_at_most, moved)));
        }
    }
    Ok((snapped.mesh, snapped.moved_at_most))
}

/// A sum, rounded up unless it is exact.
pub(super) fn up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a + b } else { add_up(a, b) }
}

fn reach(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most, x| greater(most, x.abs()))
}
