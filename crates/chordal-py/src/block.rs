//! Blocks of a volume, meshed one by one in any process and then joined.
use crate::source::Source;
use crate::{failure, work};
use chordal::budget::{Bound, Evidence, JobError, Reference};
use chordal::convert::lattices::{
    FaceKey, GridBlock, LabelOptions, VertexKey, block_normals, grid_to_block, join_blocks, labels_to_blocks,
};
use chordal::convert::{Border, Inside, Polygonize};
use chordal::implicit::{Affine3, Grid};
use chordal::{Mesh, Tolerance};
use chordal_io::{Format, Frame, Scene, for_vertex_caches};
use chordal_verbs::report::BoundFacts;
use chordal_verbs::{Input, Shape, made_of};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::borrow::Cow;
use std::sync::Arc;

/// The place of a block in its volume, and the surface to extract.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BlockArguments {
    iso: f64,
    /// "high" or "low".
    inside: String,
    /// For each axis whether its low and its high side are capped.
    capped: [[bool; 2]; 3],
    /// The index of the first sample in the volume.
    offset: [i64; 3],
    /// The rows of the matrix from indices of the volume to space.
    affine: [[f64; 4]; 3],
    /// The largest bound allowed, as a length.
    wanted: Option<f64>,
}

impl BlockArguments {
    fn border(&self) -> [[Border; 2]; 3] {
        self.capped.map(|ends| ends.map(|capped| if capped { Border::Capped } else { Border::Open }))
    }
}

/// The triangles of a block.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Block(Arc<GridBlock>);

/// Meshes a block of a volume.
#[pyfunction]
pub(crate) fn block(py: Python<'_>, samples: &Source, arguments: BlockArguments) -> PyResult<Block> {
    Ok(Block(Arc::new(mesh_block(py, samples, &arguments)?)))
}

/// The triangles of each label in a block.
#[pyfunction]
pub(crate) fn label_blocks(
    py: Python<'_>,
    samples: &Source,
    arguments: BlockArguments,
) -> PyResult<Vec<(u32, Block)>> {
    let blocks = mesh_labels(py, samples, &arguments)?;
    Ok(blocks.into_iter().map(|(label, block)| (label, Block(Arc::new(block)))).collect())
}

pub(crate) fn mesh_labels(
    py: Python<'_>,
    samples: &Source,
    arguments: &BlockArguments,
) -> PyResult<Vec<(u32, GridBlock)>> {
    let grid = lattice(py, samples, arguments)?;
    let rule =
        LabelOptions { border: arguments.border(), offset: arguments.offset, ..LabelOptions::default() };
    let blocks = work::run(py, None, move |job| labels_to_blocks(&grid, &rule, job))?;
    blocks.map_err(|error| failure::mesh(py, error.into()))
}

/// The samples of a block, placed in the volume.
fn lattice(py: Python<'_>, samples: &Source, arguments: &BlockArguments) -> PyResult<Grid> {
    let Shape::Volume(sampled) = samples.shape() else {
        return Err(failure::internal(py, "this is no volume"));
    };
    let affine = Affine3::new(arguments.affine).map_err(|error| failure::argument("affine", error))?;
    Ok(sampled.volume.grid.clone().with_affine(affine))
}

/// The surface to extract.
fn rule(arguments: &BlockArguments) -> PyResult<Polygonize> {
    let inside = match arguments.inside.as_str() {
        "high" => Inside::High,
        "low" => Inside::Low,
        other => return Err(failure::argument("inside", format!("'high' or 'low', not '{other}'"))),
    };
    let (border, offset) = (arguments.border(), arguments.offset);
    Ok(Polygonize { inside, border, offset, ..Polygonize::above(arguments.iso) })
}

/// The normals of vertices with their keys, ordered by key.
pub(crate) fn normals_of(
    py: Python<'_>,
    samples: &Source,
    arguments: &BlockArguments,
) -> PyResult<Vec<(VertexKey, [f64; 3])>> {
    let (grid, rule) = (lattice(py, samples, arguments)?, rule(arguments)?);
    let normals = work::run(py, None, move |job| block_normals(&grid, &rule, job))?;
    normals.map_err(|error| failure::mesh(py, error.into()))
}

pub(crate) fn mesh_block(
    py: Python<'_>,
    samples: &Source,
    arguments: &BlockArguments,
) -> PyResult<GridBlock> {
    let (grid, rule) = (lattice(py, samples, arguments)?, rule(arguments)?);
    let wanted = arguments.wanted.and_then(|length| Tolerance::new(length).ok());
    let block = work::run(py, None, move |job| grid_to_block(&grid, &rule, wanted, job))?;
    block.map_err(|error| failure::mesh(py, error.into()))
}

/// Joins blocks; returns the mesh and its bound as JSON.
#[pyfunction]
pub(crate) fn joined(
    py: Python<'_>,
    blocks: Vec<Py<Block>>,
    metres_per_unit: Option<f64>,
) -> PyResult<(Source, String)> {
    let blocks: Vec<Arc<GridBlock>> = blocks.iter().map(|block| Arc::clone(&block.get().0)).collect();
    let scene = work::run(py, None, move |job| {
        let joined = join_blocks(blocks, job)?;
        Ok::<_, JobError>(scene_of(joined.shape, &joined.bound, metres_per_unit))
    })?;
    let (input, bound) = scene.map_err(|error| failure::mesh(py, error.into()))?;
    Ok((Source::from_input(input, Vec::new()), bound))
}

/// Triangles as an input, ordered as the command writes them, and their bound as JSON.
pub(crate) fn scene_of(mesh: Mesh, mesh_bound: &Bound, metres_per_unit: Option<f64>) -> (Input, String) {
    let bound = serde_json::to_string(&BoundFacts::new(mesh_bound)).unwrap_or_default();
    let frame = Frame { metres_per_unit, ..Frame::default() };
    let ordered = match for_vertex_caches(&mesh) {
        Ok(Cow::Owned(ordered)) => Some(ordered),
        Ok(Cow::Borrowed(_)) | Err(_) => None,
    };
    let shape = Shape::Scene(Scene::from_mesh("surface", ordered.unwrap_or(mesh), frame));
    let mut input = Input::made(shape, Format::Ply);
    input.composed = made_of(&input, "volume", mesh_bound).ok().map(Arc::new);
    (input, bound)
}

/// The numbers of a vertex key: x, y, z, kind. Defined by [`Block::state`].
const VERTEX_ROW: usize = 4;
/// The numbers of a triangle key: whether it is a cap, three of its cell, its number. Defined as above.
const FACE_ROW: usize = 5;

/// The bytes of an array.
type BlockArrayBytes<'py> = pyo3::Bound<'py, PyBytes>;

/// The lower and upper bound and the worst place. Without an upper bound, infinity.
pub(crate) type BoundState = (f64, f64, Option<[f64; 3]>);

pub(crate) fn state_of_bound(bound: &Bound) -> BoundState {
    (bound.at_least(), bound.at_most().unwrap_or(f64::INFINITY), bound.at)
}

/// The bound of a state: the distance to the isosurface of the interpolant.
pub(crate) fn bound_of_state((least, most, at): BoundState) -> Bound {
    let most = Some(most).filter(|most| most.is_finite());
    let evidence = if most.is_some() { Evidence::Proved } else { Evidence::Estimated };
    let mut bound = Bound::with_evidence(least, most, evidence, Reference::Trilinear);
    bound.at = at;
    bound
}

#[pymethods]
impl Block {
    /// The number of triangles.
    #[getter]
    fn n_faces(&self) -> usize {
        self.0.faces.len()
    }

    /// The block as bytes, from which [`Self::of_state`] restores it.
    fn state<'py>(&self, py: Python<'py>) -> (Vec<BlockArrayBytes<'py>>, Option<BoundState>) {
        let block = &self.0;
        let bytes = |numbers: Vec<u8>| PyBytes::new(py, &numbers);
        let vertex = |key: &VertexKey| [key.lattice[0], key.lattice[1], key.lattice[2], i64::from(key.kind)];
        let face = |key: &FaceKey| {
            let [a, b, c] = key.place;
            [i64::from(key.is_cap), a, b, c, i64::from(key.number)]
        };
        let integers = |numbers: Vec<i64>| bytes(numbers.iter().flat_map(|n| n.to_le_bytes()).collect());
        let blocks = vec![
            bytes(block.positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()),
            bytes(block.faces.as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect()),
            integers(block.vertex_keys.iter().flat_map(vertex).collect()),
            integers(block.face_keys.iter().flat_map(face).collect()),
        ];
        (blocks, block.bound.as_ref().map(state_of_bound))
    }

    /// The block of a state.
    #[staticmethod]
    fn of_state(blocks: [PyBackedBytes; 4], bound: Option<BoundState>) -> PyResult<Self> {
        let wrong = |what: &str| failure::argument("state", what);
        let [positions, faces, vertex_keys, face_keys] = &blocks;
        let (numbers, rest_of_number) = positions.as_chunks::<8>();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let (indices, rest_of_index) = faces.as_chunks::<4>();
        let indices: Vec<u32> = indices.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        let integers = |bytes: &[u8]| -> Vec<i64> {
            bytes.as_chunks::<8>().0.iter().map(|bytes| i64::from_le_bytes(*bytes)).collect()
        };
        let small = |n: i64| u8::try_from(n).map_err(|_| wrong("a key is invalid"));
        let (vertex_rows, face_rows) = (integers(vertex_keys), integers(face_keys));
        let vertex_keys: Vec<VertexKey> = vertex_rows
            .as_chunks::<VERTEX_ROW>()
            .0
            .iter()
            .map(|[x, y, z, kind]| {
                // The only level and sheet that keys of blocks have.
                Ok(VertexKey { lattice: [*x, *y, *z], level: 0, kind: small(*kind)?, sheet: 0 })
            })
            .collect::<PyResult<_>>()?;
        let face_keys: Vec<FaceKey> = face_rows
            .as_chunks::<FACE_ROW>()
            .0
            .iter()
            .map(|[cap, a, b, c, number]| {
                Ok(FaceKey { is_cap: *cap != 0, place: [*a, *b, *c], number: small(*number)? })
            })
            .collect::<PyResult<_>>()?;
        let (points, rest_of_point) = numbers.as_chunks::<3>();
        let (corners, rest_of_face) = indices.as_chunks::<3>();
        // The bytes may be from anywhere, and whoever uses a block relies on its indices and numbers
        // unchecked.
        let fits = rest_of_number.is_empty()
            && rest_of_index.is_empty()
            && rest_of_point.is_empty()
            && rest_of_face.is_empty()
            && vertex_keys.len() == points.len()
            && face_keys.len() == corners.len()
            && numbers.iter().all(|x| x.is_finite())
            && indices.iter().all(|i| (*i as usize) < points.len());
        if !fits {
            return Err(wrong("the arrays do not fit each other"));
        }
        Ok(Self(Arc::new(GridBlock {
            positions: points.to_vec(),
            faces: corners.to_vec(),
            normals: Vec::new(),
            vertex_keys,
            face_keys,
            bound: bound.map(bound_of_state),
        })))
    }
}
