//! Blocks of a volume that are meshed one by one, and joined to the mesh of the whole volume: `grid_to_block`,
//! `join_blocks`.
use super::cubes::bound::IsosurfaceProof;
use super::cubes::case_table::TABLE;
use super::cubes::marching_cubes::{Isosurface, MarchingPlan, march, refusal};
use super::cubes::normals::gradient_normals;
use super::cubes::rule::{Normals, Polygonize};
use super::cubes::source::DenseSamples;
use super::grid_to_mesh::{VertexKey, bound, check, vertex_errors};
use crate::budget::{Bound, Bounded, Evidence, Job, JobError, Reference, RefusalCode, Tolerance};
use crate::explicit::Mesh;
use crate::implicit::{Grid, with_samples};
use std::borrow::Borrow;

/// The place of a triangle in the order of the whole volume's mesh: cells row by row, then the caps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FaceKey {
    /// Whether it closes the shape at the border of the lattice.
    pub is_cap: bool,
    /// For a cell z, y and x of its lowest sample; for a cap the border (2 a + 1 for the high end of axis a), and the
    /// indices along the second and the first axis after it.
    pub place: [i64; 3],
    /// Its number among the triangles of this place.
    pub number: u8,
}

/// The triangles of a block of a volume, with the keys that join them to those of other blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct GridBlock {
    /// n × 3 coordinates.
    pub positions: Vec<[f64; 3]>,
    /// m × 3 indices into the positions.
    pub faces: Vec<[u32; 3]>,
    /// A normal for each position, if the caller has added them; otherwise empty.
    pub normals: Vec<[f64; 3]>,
    /// The key of each position.
    pub vertex_keys: Vec<VertexKey>,
    /// The key of each triangle.
    pub face_keys: Vec<FaceKey>,
    /// The distance between the triangles and the surface of the interpolant in this block; `None` for a block without
    /// surface.
    pub bound: Option<Bound>,
}

/// Meshes a block of a volume: the part in the cells of this grid of the mesh that
/// [`grid_to_mesh`](super::grid_to_mesh()) builds of the whole volume without a budget.
///
/// The grid shares its outer samples with the blocks beside it, `rule.offset` is the index of its first sample in the
/// whole, and `rule.border` is [`Border::Open`](super::Border::Open) at sides shared with another block. A block without
/// surface has no triangles. Normals need samples beyond the block's sides, so a rule with [`Normals::Gradient`] is
/// refused; [`block_normals`] computes them.
///
/// **Bound.** That of the cells of the block, proved; the largest of all blocks holds for the whole volume. With a length
/// `wanted`, every cell whose bound would exceed it is examined; without one, only a share of the cells is, so that for
/// noise the bound may be as large as the diagonal of a cell.
///
/// # Errors
/// As for [`grid_to_triangles`](super::lattices::grid_to_triangles).
pub fn grid_to_block(
    grid: &Grid,
    rule: &Polygonize,
    wanted: Option<Tolerance>,
    job: &Job,
) -> Result<GridBlock, JobError> {
    let (size, affine) = (grid.size(), grid.affine());
    check(size, affine, rule)?;
    if rule.normals != Normals::None {
        let message = "normals need samples beyond the sides of a block: compute them apart from the \
             triangles";
        return Err(refusal(RefusalCode::Unsupported, message.into()));
    }
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = DenseSamples { values, size, rule: *rule };
            let Isosurface { positions, faces, plan } = march::<f64, _>(&source, affine, rule, job)?;
            let vertex_keys = vertex_keys(&plan, rule, job);
            let face_keys = face_keys(&plan, rule, job);
            debug_assert_eq!(face_keys.len(), faces.len(), "every triangle has a key");
            let errors = vertex_errors(affine, rule, size);
            let bound = (!faces.is_empty()).then(|| {
                let proof = IsosurfaceProof::new(&source, affine, rule, errors);
                let farthest = proof.of_block(wanted.map_or(0.0, Tolerance::get)).max_distance(&plan, job);
                bound(farthest, Evidence::Proved, affine, rule, size)
            });
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            Ok(GridBlock { positions, faces, normals: Vec::new(), vertex_keys, face_keys, bound })
        })
    })
}

/// The normals along the gradient with the keys of their vertices, in the order of keys.
///
/// For the normals of a block, pass a grid with one more sample beyond each side that the block shares: central
/// differences need the samples beside a vertex. The block's normals are then among the result, bit for bit those of the
/// whole volume.
///
/// # Errors
/// As for [`grid_to_block`].
pub fn block_normals(
    grid: &Grid,
    rule: &Polygonize,
    job: &Job,
) -> Result<Vec<(VertexKey, [f64; 3])>, JobError> {
    let (size, affine) = (grid.size(), grid.affine());
    check(size, affine, rule)?;
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = DenseSamples { values, size, rule: *rule };
            let plan = MarchingPlan::new(&source, rule, job)?;
            let normals = gradient_normals(&source, affine, rule, &plan, job);
            let mut keyed_normals: Vec<_> = vertex_keys(&plan, rule, job).into_iter().zip(normals).collect();
            keyed_normals.sort_unstable_by_key(|(key, _)| *key);
            if job.is_cancelled() { Err(JobError::Cancelled) } else { Ok(keyed_normals) }
        })
    })
}

fn vertex_keys(plan: &MarchingPlan, rule: &Polygonize, job: &Job) -> Vec<VertexKey> {
    plan.for_each_vertex(job, |kind, at| VertexKey {
        lattice: [0, 1, 2].map(|k| rule.offset[k] + at[k] as i64),
        level: 0,
        kind: kind as u8,
        sheet: 0,
    })
}

fn face_keys(plan: &MarchingPlan, rule: &Polygonize, job: &Job) -> Vec<FaceKey> {
    let slab_keys = plan.for_each_slab(job, |_, walk| {
        let mut keys = Vec::new();
        walk(&mut |[i, j, k], signs| {
            let place = [k, j, i];
            let place = [0, 1, 2].map(|axis| rule.offset[2 - axis] + place[axis] as i64);
            let cell = |number| FaceKey { is_cap: false, place, number };
            keys.extend((0..TABLE.upright[usize::from(signs)].triangles).map(cell));
        });
        keys
    });
    let mut keys = slab_keys.concat();
    plan.for_each_cap_triangle(|axis, end, [p, q], number| {
        let along = |axis: usize, index: usize| rule.offset[axis % 3] + index as i64;
        let place = [2 * axis as i64 + end as i64, along(axis + 2, q), along(axis + 1, p)];
        keys.push(FaceKey { is_cap: true, place, number });
    });
    keys
}

/// The sort key of a vertex in the order of the whole volume's mesh.
fn order(key: &VertexKey) -> (i64, i64, u8, i64) {
    let [x, y, z] = key.lattice;
    (z, y, key.kind, x)
}

/// Joins blocks to the mesh of the whole volume: the positions and triangles of [`grid_to_mesh`](super::grid_to_mesh()),
/// bit for bit and in its order, whatever the order of the blocks.
///
/// The bound is the largest of all blocks, proved.
///
/// Cost: O(n log k) in the vertices and triangles of k blocks, since each block's are sorted already.
///
/// # Errors
/// [`JobError::Refused`]: no block has triangles ([`RefusalCode::Empty`]); vertices with one key have different positions,
/// or a triangle occurs twice, so that these are not blocks of one volume ([`RefusalCode::Unsupported`]); more triangles
/// than a mesh or the job may have ([`RefusalCode::TooManyTriangles`]).
///
/// ```
/// use chordal::Job;
/// use chordal::convert::lattices::{grid_to_block, join_blocks};
/// use chordal::convert::{Border, Polygonize};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// // One voxel of a mask: an octahedron, in two halves.
/// let mask: Vec<u8> = (0..27).map(|n| u8::from(n == 13)).collect();
/// let mut blocks = Vec::new();
/// for low in [0, 1] {
///     let half = Samples::U8(mask[9 * low..9 * low + 18].to_vec());
///     let mut rule = Polygonize { offset: [0, 0, low as i64], ..Polygonize::above(0.5) };
///     rule.border[2][1 - low] = Border::Open;
///     let grid = Grid::new([3, 3, 2], half, Affine3::IDENTITY)?;
///     blocks.push(grid_to_block(&grid, &rule, None, &Job::default()).expect("a block"));
/// }
/// let joined = join_blocks(blocks, &Job::default()).expect("blocks of one volume");
/// assert_eq!((joined.shape.positions().len(), joined.shape.faces().len()), (6, 8));
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
pub fn join_blocks(
    blocks: impl IntoIterator<Item: Borrow<GridBlock>>,
    job: &Job,
) -> Result<Bounded<Mesh>, JobError> {
    let held: Vec<_> = blocks.into_iter().collect();
    let blocks: Vec<&GridBlock> =
        held.iter().map(Borrow::borrow).filter(|block| !block.faces.is_empty()).collect();
    let triangles = blocks.iter().map(|block| block.faces.len() as u64).sum::<u64>();
    if triangles == 0 {
        return Err(refusal(RefusalCode::Empty, "no block has a surface".into()));
    }
    if triangles > job.triangle_limit {
        let limit = job.triangle_limit;
        let message = format!("the blocks have {triangles} triangles; the limit is {limit}");
        return Err(refusal(RefusalCode::TooManyTriangles, message));
    }
    // Every vertex of every block, in the order of the whole volume's mesh.
    let mut entries: Vec<(usize, u32)> = Vec::new();
    for (k, block) in blocks.iter().enumerate() {
        entries.extend((0..block.positions.len() as u32).map(|row| (k, row)));
    }
    let key_of = |(k, row): &(usize, u32)| &blocks[*k].vertex_keys[*row as usize];
    // Each block's entries are sorted already, and the stable sort merges such runs.
    entries.sort_by_key(|entry| order(key_of(entry)));
    let mut numbers: Vec<Vec<u32>> = blocks.iter().map(|block| vec![0; block.positions.len()]).collect();
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut last: Option<(usize, u32)> = None;
    for entry in entries {
        let (k, row) = entry;
        let here = blocks[k].positions[row as usize];
        if last.is_none_or(|before| key_of(&before) != key_of(&entry)) {
            positions.push(here);
            last = Some(entry);
        } else if positions.last().is_some_and(|known| known.map(f64::to_bits) != here.map(f64::to_bits)) {
            let lattice = key_of(&entry).lattice;
            let message =
                format!("vertices of one key lie apart: these are no blocks of one volume ({lattice:?})");
            return Err(refusal(RefusalCode::Unsupported, message));
        }
        // If there are more vertices than an index can number, `Mesh::new` refuses them below.
        numbers[k][row as usize] = u32::try_from(positions.len() - 1).unwrap_or(u32::MAX);
    }
    let mut faces: Vec<(FaceKey, [u32; 3])> = Vec::with_capacity(triangles as usize);
    for (block, numbers) in blocks.iter().zip(&numbers) {
        let face = |face: &[u32; 3]| face.map(|row| numbers[row as usize]);
        faces.extend(block.face_keys.iter().copied().zip(block.faces.iter().map(face)));
    }
    faces.sort_by_key(|(key, _)| *key);
    if let Some(pair) = faces.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let message =
            format!("a triangle comes twice: blocks overlap by more than a sample ({:?})", pair[0].0.place);
        return Err(refusal(RefusalCode::Unsupported, message));
    }
    let bound = Bound::of_parts(blocks.iter().filter_map(|block| block.bound.as_ref()))
        .unwrap_or_else(|| Bound::exact(Reference::Trilinear));
    let faces = faces.into_iter().map(|(_, face)| face).collect();
    let mesh = Mesh::new(positions, faces)
        .map_err(|error| refusal(RefusalCode::TooManyTriangles, error.to_string()))?;
    Ok(Bounded { shape: mesh, bound })
}
