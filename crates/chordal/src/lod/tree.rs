//! `tree`: a large mesh as a hierarchy of tiles that replace each other, region by region, without cracks.
use super::chain::needs_a_proof;
use super::reduction::ReductionStats;
use super::region_tree::RegionTree;
use super::simplified_mesh::SimplifiedMesh;
use super::simplify::{SimplifyInput, simplify_within};
use crate::budget::{
    AttributeLimits, Bound, Bounded, ErrorLimit, Job, JobError, Message, Refusal, RefusalCode, Tolerance,
    par_map,
};
use crate::explicit::{Mesh, Topology};
use std::collections::BTreeMap;

/// Triangles for one region of a surface, shown instead of those of its children.
#[derive(Clone, Debug, PartialEq)]
pub struct LodTile {
    /// The triangles, with all attributes.
    pub mesh: Mesh,
    /// The distance of the triangles from the true shape.
    pub bound: Bound,
    /// Parts that could not be collapsed, and parts that were dropped.
    pub stats: ReductionStats,
    /// The number of its ancestors.
    pub depth: u32,
    /// The tiles that show the same region finer, as indices into [`LodTileTree::tiles`]; they come after
    /// this tile. Empty for a leaf.
    pub children: Vec<usize>,
}

impl LodTile {
    /// The proved error.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.bound.at_most().unwrap_or(f64::INFINITY)
    }
}

/// Tiles over the regions of a surface. See [`tree`].
#[derive(Clone, Debug, PartialEq)]
pub struct LodTileTree {
    /// All tiles, by depth.
    pub tiles: Vec<LodTile>,
    /// The tiles that together are the coarsest version: the first one alone, unless the surface cannot be
    /// reduced to one tile.
    pub roots: Vec<usize>,
}

/// How to split a mesh into tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TilingOptions {
    /// The additional error of the tiles directly above the finest.
    pub step: Tolerance,
    /// The ratio of the additional errors of successive steps, > 1.
    pub factor: f64,
    /// The largest number of triangles of a tile, ≥ 1.
    pub max_triangles: usize,
    /// A single tile for the whole mesh with at most this many triangles becomes the root.
    pub stop_at_triangles: usize,
    /// The limits of the attributes' deviation from those of `finest`, for every tile.
    pub attributes: AttributeLimits,
}

impl TilingOptions {
    /// Tiles of up to 65,536 triangles, errors that start at `step` and double, until 64 triangles or fewer.
    #[must_use]
    pub fn from_step(step: Tolerance) -> Self {
        let attributes = AttributeLimits::default();
        Self { step, factor: 2.0, max_triangles: 1 << 16, stop_at_triangles: 64, attributes }
    }
}

/// A coarser tile is dropped if it has more than this fraction of the triangles that it replaces. Chosen: a
/// larger value keeps tiles that save little.
const WORTH_IT: f64 = 0.8;
/// The largest number of steps: 2⁴⁸ between the finest and the coarsest error.
const MOST_STEPS: u32 = 48;

/// A mesh as a tree of tiles, each of which covers the same part of the surface as its children together,
/// with fewer triangles.
///
/// The leaves are the triangles of `finest`, divided into regions by position; no triangle is cut. A tile
/// above is built from the triangles of `finest` in its region by [`simplify`](super::simplify()), within a
/// length that grows by `tiling.factor` from step to step. Two regions are merged as soon as their triangles
/// fit into one tile; a region without a partner is simplified further by itself. A tile that is proved to be
/// the same surface as its leaves replaces them.
///
/// *Which tiles may be shown together.* Any tiles that cover each region exactly once: a root, or instead
/// its children, and so on, whatever the neighbours do. Where a region meets another one, positions, edges
/// and values (except the normals of flat shading, which are those of the remaining faces) stay as they are
/// in `finest`, and no tile gets a new edge between two such positions. Hence there are no cracks,
/// and such a mixture of a closed manifold is a closed manifold.
///
/// *What the bound covers.* The two-sided Hausdorff distance of all points, proved if that of `finest` is:
/// the deviation of a tile from the triangles of `finest` in the same region is added to that. The regions
/// partition `finest`. Hence every point of `finest` is near the tile that is shown for its region, and every
/// point that is shown is near `finest`: any mixture is within the largest bound of its tiles. Errors
/// decrease strictly from a tile to its children.
///
/// *Cost.* One [`simplify`](super::simplify()) of the whole per step, parallel over regions: 14 steps from
/// 10⁶ triangles to 64 at the root.
///
/// # Errors
/// [`RefusalCode::Budget`] for a factor that is not larger than 1 and for tiles of no triangle;
/// [`RefusalCode::Empty`] without a triangle; [`RefusalCode::Unsupported`] if `finest` has no upper bound;
/// the refusals of [`check::deviation`](crate::check::deviation).
///
/// ```
/// use chordal::{Bound, Bounded, Job, Mesh, Tolerance};
/// use chordal::budget::Reference;
/// use chordal::explicit::Topology;
/// use chordal::lod::tiling::{TilingOptions, tree};
/// // A roof over a square of 32 × 32 cells.
/// let at = |i: u32, j: u32| [f64::from(i), f64::from(j), 16.0 - (f64::from(i) - 16.0).powi(2) / 16.0];
/// let positions = (0..33).flat_map(|i| (0..33).map(move |j| at(i, j))).collect();
/// let cell = |i: u32, j: u32| { let a = 33 * i + j; [[a, a + 33, a + 34], [a, a + 34, a + 1]] };
/// let roof = Mesh::new(positions, (0..32).flat_map(|i| (0..32).flat_map(move |j| cell(i, j))).collect())?;
/// let roof = Bounded { shape: roof, bound: Bound::exact(Reference::InputTriangles) };
/// let tiling = TilingOptions { max_triangles: 600, ..TilingOptions::from_step(Tolerance::new(0.1)?) };
/// let tile_tree = tree(&roof, Topology::Indices, &tiling, &Job::default())?;
/// let leaves = tile_tree.tiles.iter().filter(|tile| tile.children.is_empty());
/// assert_eq!(leaves.map(|tile| tile.mesh.faces().len()).sum::<usize>(), 2048);
/// assert!(tile_tree.roots == [0] && tile_tree.tiles[0].mesh.faces().len() <= 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn tree(
    finest: &Bounded<Mesh>,
    topology: Topology,
    tiling: &TilingOptions,
    job: &Job,
) -> Result<LodTileTree, JobError> {
    if tiling.factor.is_nan() || tiling.factor <= 1.0 {
        return refuse(
            RefusalCode::Budget,
            format!("the factor between errors is larger than 1, not {}", tiling.factor),
        );
    }
    if tiling.max_triangles == 0 {
        return refuse(RefusalCode::Budget, "a tile holds at least one triangle");
    }
    if finest.shape.faces().is_empty() {
        return refuse(RefusalCode::Empty, "there is no triangle to put into tiles");
    }
    if finest.bound.at_most().is_none() {
        return refuse(RefusalCode::Unsupported, needs_a_proof("tiles", &finest.bound));
    }
    job.run(|| {
        let regions = RegionTree::new(&finest.shape, topology, tiling.max_triangles);
        let mut builder =
            TileTreeBuilder::new(TileTreeInput { regions, bound: &finest.bound, topology, tiling, job })?;
        builder.run()?;
        Ok(builder.finish())
    })
}

/// The data that do not change while a tree is built.
struct TileTreeInput<'a> {
    regions: RegionTree<'a>,
    bound: &'a Bound,
    topology: Topology,
    tiling: &'a TilingOptions,
    job: &'a Job,
}

/// A simplified region, with its distance from the triangles of the finest mesh.
type SimplifiedRegion = Option<Bounded<SimplifiedMesh>>;

impl TileTreeInput<'_> {
    /// Simplifies regions within a length.
    fn simplify_regions(
        &self,
        regions: &[usize],
        length: Tolerance,
    ) -> Result<Vec<SimplifiedRegion>, JobError> {
        par_map(self.job, regions, |_, region| self.simplify_region(*region, length)).into_iter().collect()
    }

    fn simplify_region(&self, region: usize, length: Tolerance) -> Result<SimplifiedRegion, JobError> {
        // A region whose triangles have no area at all cannot be simplified.
        if !self.regions.has_surface(region) {
            return Ok(None);
        }
        let (mesh, fixed_rows) = self.regions.mesh(region);
        let input = SimplifyInput {
            mesh: &mesh,
            topology: self.topology,
            fixed_rows: &fixed_rows,
            limit: ErrorLimit::uniform(length.get()),
            attributes: self.tiling.attributes,
            job: self.job,
        };
        simplify_within(&input).map(Some)
    }
}

/// Builds a tree from its leaves upwards.
struct TileTreeBuilder<'a> {
    input: TileTreeInput<'a>,
    /// All tiles, including those that were replaced again; children before parents.
    tiles: Vec<LodTile>,
    /// The coarsest tiles so far, by the largest region that they cover.
    coarsest: BTreeMap<usize, Vec<usize>>,
}

impl<'a> TileTreeBuilder<'a> {
    fn new(input: TileTreeInput<'a>) -> Result<Self, JobError> {
        let regions = input.regions.regions.iter().enumerate();
        let leaves: Vec<usize> =
            regions.filter(|(_, region)| region.halves.is_none()).map(|(at, _)| at).collect();
        let meshes = par_map(input.job, &leaves, |_, region| input.regions.mesh(*region).0);
        let leaf = |mesh| {
            let bound = input.bound.clone();
            LodTile { mesh, bound, stats: ReductionStats::default(), depth: 0, children: Vec::new() }
        };
        let tiles = meshes.into_iter().map(leaf).collect();
        let coarsest = leaves.into_iter().enumerate().map(|(tile, region)| (region, vec![tile])).collect();
        if input.job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        Ok(Self { input, tiles, coarsest })
    }

    fn run(&mut self) -> Result<(), JobError> {
        let TilingOptions { step, factor, stop_at_triangles: enough, .. } = *self.input.tiling;
        let mut length = step;
        let extent = self.input.regions.extent();
        for _ in 0..MOST_STEPS {
            if self.coarsest.len() == 1 && self.count(0) <= enough {
                break;
            }
            self.step(length)?;
            // No error exceeds the extent.
            match Tolerance::new(length.get() * factor) {
                Ok(longer) if length.get() < extent => length = longer,
                _ => break,
            }
        }
        Ok(())
    }

    /// The number of triangles that show a region of [`Self::coarsest`].
    fn count(&self, region: usize) -> usize {
        let tiles = self.coarsest.get(&region).into_iter().flatten();
        tiles.map(|tile| self.tiles[*tile].mesh.faces().len()).sum()
    }

    /// Adds a tile above the current ones wherever a length gives sufficiently few triangles.
    fn step(&mut self, length: Tolerance) -> Result<(), JobError> {
        let most = self.input.tiling.max_triangles;
        // Merge two halves that probably fit into one tile, since each step leaves about half of the
        // triangles.
        let halves = |region: &usize| self.input.regions.regions[*region].halves;
        let fit = |[a, b]: [usize; 2]| {
            let are_coarsest = self.coarsest.contains_key(&a) && self.coarsest.contains_key(&b);
            are_coarsest && self.count(a).saturating_add(self.count(b)) <= most.saturating_mul(2)
        };
        let parents = self.coarsest.keys().map(|region| self.input.regions.regions[*region].parent);
        let mut parents: Vec<usize> =
            parents.filter(|parent| halves(parent).is_some_and(|first| fit([first, first + 1]))).collect();
        parents.sort_unstable();
        parents.dedup();
        let mut tried: Vec<usize> = self.coarsest.keys().copied().collect();
        // Merged regions are tried first: a half that is merged now needs no tile of its own.
        for (parent, simplified) in parents.iter().zip(self.input.simplify_regions(&parents, length)?) {
            let Some(first) = self.input.regions.regions[*parent].halves else { continue };
            let n = simplified.as_ref().map_or(usize::MAX, |simplified| simplified.shape.mesh.faces().len());
            if n > most {
                continue;
            }
            let is_fewer = n <= self.count(first) + self.count(first + 1);
            let below =
                [first, first + 1].into_iter().filter_map(|half| self.coarsest.remove(&half)).flatten();
            let below = below.collect();
            self.coarsest.insert(*parent, below);
            tried.retain(|region| *region != first && *region != first + 1);
            // Otherwise the region stays merged, and longer lengths will simplify it.
            if is_fewer && let Some(simplified) = simplified {
                self.add_tile(*parent, simplified);
            }
        }
        for (region, simplified) in tried.iter().zip(self.input.simplify_regions(&tried, length)?) {
            let Some(simplified) = simplified else { continue };
            if simplified.shape.mesh.faces().len() as f64 <= WORTH_IT * self.count(*region) as f64 {
                self.add_tile(*region, simplified);
            }
        }
        Ok(())
    }

    /// Adds a tile above those that show a region. Its error must be larger than theirs, so tiles whose error
    /// is not smaller are removed.
    fn add_tile(&mut self, region: usize, simplified: Bounded<SimplifiedMesh>) {
        let bound = self.input.bound.then(&simplified.bound);
        let Some(error) = bound.at_most() else { return };
        let is_same = simplified.bound.at_most() == Some(0.0);
        let mut below = if is_same { Vec::new() } else { self.coarsest.remove(&region).unwrap_or_default() };
        // A leaf has the error of the finest mesh; the new tile's error is larger, or it would itself be a
        // leaf.
        while let Some(at) = below.iter().position(|tile| self.tiles[*tile].error() >= error) {
            let finer = self.tiles[below[at]].children.clone();
            below.splice(at..=at, finer);
        }
        self.coarsest.insert(region, vec![self.tiles.len()]);
        let SimplifiedMesh { mesh, stats, .. } = simplified.shape;
        self.tiles.push(LodTile { mesh, bound, stats, depth: 0, children: below });
    }

    /// The remaining tiles, by depth.
    fn finish(self) -> LodTileTree {
        let mut order: Vec<usize> = self.coarsest.into_values().flatten().collect();
        let roots = (0..order.len()).collect();
        let mut from: Vec<Option<LodTile>> = self.tiles.into_iter().map(Some).collect();
        let mut tiles: Vec<LodTile> = Vec::new();
        let mut depths = vec![0; order.len()];
        while let Some(at) = order.get(tiles.len()) {
            // Every tile has one parent.
            let Some(mut tile) = from[*at].take() else { break };
            tile.depth = depths[tiles.len()];
            let first = order.len();
            order.append(&mut tile.children);
            tile.children = (first..order.len()).collect();
            depths.resize(order.len(), tile.depth + 1);
            tiles.push(tile);
        }
        LodTileTree { tiles, roots }
    }
}

fn refuse<T>(code: RefusalCode, message: impl Into<Message>) -> Result<T, JobError> {
    Err(JobError::Refused(Refusal::new(code, message)))
}
