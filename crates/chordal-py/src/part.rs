//! Parts of a surface that never is in one memory: simplified, joined, and written as tiles.
use crate::block::{
    BlockArguments, BoundState, bound_of_state, mesh_block, mesh_labels, normals_of, scene_of, state_of_bound,
};
use crate::source::Source;
use crate::{failure, work};
use chordal::Tolerance;
use chordal::budget::JobError;
use chordal::convert::lattices::VertexKey;
use chordal::explicit::{Attribute, Mesh, Semantic};
use chordal::implicit::Affine3;
use chordal::lod::tiling::{FragmentBox, LatticeBox, LatticeFragment, SurfacePart};
use chordal::math::Box3;
use chordal_io::Frame;
use chordal_verbs::{TileEntry, part_tile, part_tileset, rounded_part};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// The place of a part in its lattice.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BoxArguments {
    /// The indices of the first and the last sample.
    low: [i64; 3],
    high: [i64; 3],
    /// For each axis whether other parts adjoin its low and its high side.
    goes_on: [[bool; 2]; 3],
}

impl BoxArguments {
    fn place(&self) -> LatticeBox {
        LatticeBox { low: self.low, high: self.high, goes_on: self.goes_on }
    }
}

/// The box of a fragment.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct FragmentArguments {
    /// The index of the first sample, and the number of cells along each axis.
    low: [i64; 3],
    sides: [i64; 3],
    affine: [[f64; 4]; 3],
    is_halved: bool,
}

/// A fragment: three integers of 32 bits a vertex and three indices a triangle, in native byte order; the
/// octants of its box that have triangles, and the largest distance by which a vertex was moved.
type FragmentState<'py> = (pyo3::Bound<'py, PyBytes>, pyo3::Bound<'py, PyBytes>, u8, f64);

/// A part of a surface.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct BlockPart(Arc<SurfacePart>);

/// An entry of a tileset: the name of the tile, the box of its content (low, then high), its bound, its
/// number of triangles, and its children by their indices in the list.
type EntryState = (String, [f64; 6], BoundState, u64, Vec<usize>);

/// The triangles of a block; `None` if it has none. With `around`, the samples of the block and around it and
/// their place, vertices get normals.
#[pyfunction]
pub(crate) fn part(
    py: Python<'_>,
    samples: &Source,
    arguments: BlockArguments,
    place: BoxArguments,
    around: Option<(Py<Source>, BlockArguments)>,
) -> PyResult<Option<BlockPart>> {
    let mut block = mesh_block(py, samples, &arguments)?;
    if let Some((samples, arguments)) = around.filter(|_| !block.faces.is_empty()) {
        let normals = normals_of(py, samples.get(), &arguments)?;
        let normal = |key: &VertexKey| {
            let row = normals.binary_search_by_key(key, |(known, _)| *known);
            row.map(|row| normals[row].1)
                .map_err(|_| failure::argument("around", "these are not the samples around the block"))
        };
        block.normals = block.vertex_keys.iter().map(normal).collect::<PyResult<_>>()?;
    }
    Ok(SurfacePart::from_block(block, &place.place()).map(|part| BlockPart(Arc::new(part))))
}

/// The triangles of each label in a block.
#[pyfunction]
pub(crate) fn label_parts(
    py: Python<'_>,
    samples: &Source,
    arguments: BlockArguments,
    place: BoxArguments,
) -> PyResult<Vec<(u32, BlockPart)>> {
    let place = place.place();
    let part = |(label, block)| Some((label, BlockPart(Arc::new(SurfacePart::from_block(block, &place)?))));
    Ok(mesh_labels(py, samples, &arguments)?.into_iter().filter_map(part).collect())
}

/// Joins parts that fill a box.
#[pyfunction]
pub(crate) fn join_parts(
    py: Python<'_>,
    parts: Vec<Py<BlockPart>>,
    place: BoxArguments,
) -> PyResult<BlockPart> {
    let parts: Vec<Arc<SurfacePart>> = parts.iter().map(|part| Arc::clone(&part.get().0)).collect();
    let joined = work::run(py, None, move |_| SurfacePart::join(&parts, &place.place()))?;
    joined.map(|part| BlockPart(Arc::new(part))).map_err(|error| failure::mesh(py, error.into()))
}

/// The document of a tileset.
#[pyfunction]
pub(crate) fn tileset<'py>(
    py: Python<'py>,
    entries: Vec<EntryState>,
    origin: [f64; 3],
    metres_per_unit: Option<f64>,
) -> PyResult<pyo3::Bound<'py, PyBytes>> {
    let entry = |(name, [a, b, c, d, e, f], bound, triangles, children): EntryState| TileEntry {
        name,
        bounds: Box3 { min: [a, b, c], max: [d, e, f] },
        bound: bound_of_state(bound),
        triangles,
        children,
    };
    let entries: Vec<TileEntry> = entries.into_iter().map(entry).collect();
    let document = part_tileset(&entries, origin, &Frame { metres_per_unit, ..Frame::default() });
    document.map(|document| PyBytes::new(py, &document)).map_err(|error| failure::mesh(py, error))
}

#[pymethods]
impl BlockPart {
    /// The number of triangles.
    #[getter]
    fn n_faces(&self) -> usize {
        self.0.mesh.faces().len()
    }

    /// The number of vertices shared with other parts.
    #[getter]
    fn n_shared(&self) -> usize {
        self.0.shared.len()
    }

    /// The upper bound of the error.
    #[getter]
    fn at_most(&self) -> f64 {
        self.0.bound.at_most().unwrap_or(f64::INFINITY)
    }

    /// Fewer triangles, within a length of the part's.
    fn simplified(&self, py: Python<'_>, length: f64) -> PyResult<Self> {
        let length = Tolerance::new(length).map_err(|error| failure::argument("length", error))?;
        let part = Arc::clone(&self.0);
        let simplified = work::run(py, None, move |job| part.simplified(length, job))?;
        simplified.map(|(part, _)| Self(Arc::new(part))).map_err(|error| failure::mesh(py, error.into()))
    }

    /// The same in single precision about an origin.
    fn rounded(&self, py: Python<'_>, origin: [f64; 3]) -> PyResult<Self> {
        let rounded = rounded_part(&self.0, origin).map_err(|error| failure::mesh(py, error))?;
        Ok(Self(Arc::new(rounded)))
    }

    /// The file of the tile, and its entry in a tileset.
    fn tile<'py>(
        &self,
        py: Python<'py>,
        name: String,
        metres_per_unit: Option<f64>,
    ) -> PyResult<(pyo3::Bound<'py, PyBytes>, EntryState)> {
        let frame = Frame { metres_per_unit, ..Frame::default() };
        let tile = part_tile(SurfacePart::clone(&self.0), frame, name, Vec::new())
            .map_err(|error| failure::mesh(py, error))?;
        let TileEntry { name, bounds: Box3 { min, max }, bound, triangles, children } = tile.entry;
        let corners = [min[0], min[1], min[2], max[0], max[1], max[2]];
        Ok((PyBytes::new(py, &tile.glb), (name, corners, state_of_bound(&bound), triangles, children)))
    }

    /// A fragment of Neuroglancer's legacy mesh format: the number of vertices, their coordinates times a
    /// scale in single precision, and three indices for each triangle; all little-endian.
    fn fragment<'py>(&self, py: Python<'py>, scale: f64) -> pyo3::Bound<'py, PyBytes> {
        let mesh = &self.0.mesh;
        let mut bytes = (mesh.positions().len() as u32).to_le_bytes().to_vec();
        let coordinates = mesh.positions().as_flattened().iter();
        coordinates.for_each(|x| bytes.extend(((x * scale) as f32).to_le_bytes()));
        mesh.faces().as_flattened().iter().for_each(|row| bytes.extend(row.to_le_bytes()));
        PyBytes::new(py, &bytes)
    }

    /// A fragment of Neuroglancer's multi-resolution mesh format, before its compression by Draco.
    fn lattice_fragment<'py>(
        &self,
        py: Python<'py>,
        place: BoxArguments,
        within: FragmentArguments,
    ) -> PyResult<FragmentState<'py>> {
        let FragmentArguments { low, sides, affine, is_halved } = within;
        let affine = Affine3::new(affine).map_err(|error| failure::argument("affine", error))?;
        let within = FragmentBox { low, sides, affine, is_halved };
        let part = Arc::clone(&self.0);
        let fragment = work::run(py, None, move |_| LatticeFragment::new(&part, &place.place(), &within))?;
        let fragment = fragment.map_err(|error| failure::mesh(py, error.into()))?;
        let numbers = fragment.positions.as_flattened().iter().flat_map(|x| i32::from(*x).to_ne_bytes());
        let indices = fragment.faces.as_flattened().iter().flat_map(|row| row.to_ne_bytes());
        let (numbers, indices): (Vec<u8>, Vec<u8>) = (numbers.collect(), indices.collect());
        Ok((PyBytes::new(py, &numbers), PyBytes::new(py, &indices), fragment.octants, fragment.moved_at_most))
    }

    /// The triangles as a scene, and their bound as JSON.
    fn source(&self, py: Python<'_>, metres_per_unit: Option<f64>) -> PyResult<(Source, String)> {
        let part = Arc::clone(&self.0);
        let scene = work::run(py, None, move |_| {
            Ok::<_, JobError>(scene_of(part.mesh.clone(), &part.bound, metres_per_unit))
        })?;
        let (input, bound) = scene.map_err(|error| failure::mesh(py, error.into()))?;
        Ok((Source::from_input(input, Vec::new()), bound))
    }

    /// The part as bytes, from which [`Self::of_state`] restores it.
    fn state<'py>(&self, py: Python<'py>) -> (pyo3::Bound<'py, PyBytes>, BoundState) {
        (PyBytes::new(py, &bytes_of(&self.0)), state_of_bound(&self.0.bound))
    }

    /// The part of a state.
    #[staticmethod]
    fn of_state(bytes: PyBackedBytes, bound: BoundState) -> PyResult<Self> {
        let wrong = || failure::argument("state", "the bytes are not those of a part");
        let mut part = part_of_bytes(&bytes).ok_or_else(wrong)?;
        part.bound = bound_of_state(bound);
        Ok(Self(Arc::new(part)))
    }
}

/// The bytes of a number of 64 bits.
const NUMBER: usize = 8;
/// The numbers of a shared vertex: its index, x, y, z, kind. Defined by [`bytes_of`].
const SHARED_ROW: usize = 5;

/// The numbers of positions, faces, shared vertices and normals, then all of these; little-endian.
///
/// ```text
/// 4 counts | positions | normals | shared rows | faces
///    u64        3 × f64   3 × f64    5 × i64     3 × u32
/// ```
fn bytes_of(part: &SurfacePart) -> Vec<u8> {
    let mesh = &part.mesh;
    let is_normal = |attribute: &&Attribute| attribute.semantic == Semantic::Normal;
    let normals = mesh.attributes().iter().find(is_normal).map_or(&[][..], |normals| &normals.values);
    let counts = [mesh.positions().len(), mesh.faces().len(), part.shared.len(), normals.len() / 3];
    let mut bytes = Vec::new();
    counts.iter().for_each(|n| bytes.extend((*n as u64).to_le_bytes()));
    let numbers = mesh.positions().as_flattened().iter().chain(normals);
    numbers.for_each(|x| bytes.extend(x.to_le_bytes()));
    for (row, key) in &part.shared {
        let [x, y, z] = key.lattice;
        [i64::from(*row), x, y, z, i64::from(key.kind)].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    }
    // Last, since their numbers have four bytes and all others eight.
    mesh.faces().as_flattened().iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    bytes
}

fn part_of_bytes(bytes: &[u8]) -> Option<SurfacePart> {
    let (numbers, _) = bytes.as_chunks::<NUMBER>();
    let (counts, numbers) = numbers.split_at_checked(4)?;
    let count = |k: usize| usize::try_from(u64::from_le_bytes(counts[k])).ok();
    let [positions, faces, shared, normals] = [count(0)?, count(1)?, count(2)?, count(3)?];
    let length = |rows: usize, width: usize| rows.checked_mul(width);
    let (coordinates, numbers) = numbers.split_at_checked(length(positions, 3)?)?;
    let (directions, numbers) = numbers.split_at_checked(length(normals, 3)?)?;
    let (keys, _) = numbers.split_at_checked(length(shared, SHARED_ROW)?)?;
    // This cannot overflow: the bytes held all of these numbers.
    let before = NUMBER * (4 + 3 * (positions + normals) + SHARED_ROW * shared);
    let (indices, rest) = bytes.get(before..)?.as_chunks::<4>();
    if !rest.is_empty() || indices.len() != length(faces, 3)? {
        return None;
    }
    let points = |numbers: &[[u8; NUMBER]]| -> Vec<[f64; 3]> {
        numbers.as_chunks::<3>().0.iter().map(|point| point.map(f64::from_le_bytes)).collect()
    };
    let corners = indices.as_chunks::<3>().0.iter().map(|face| face.map(u32::from_le_bytes)).collect();
    let mut mesh = Mesh::new(points(coordinates), corners).ok()?;
    if normals > 0 {
        mesh = mesh.with_attribute(Attribute::vertex_normals(&points(directions))).ok()?;
    }
    let key = |row: &[[u8; NUMBER]; SHARED_ROW]| {
        let [row, x, y, z, kind] = row.map(i64::from_le_bytes);
        // Keys of blocks have no other level and no sheet, so that neither is in the bytes.
        let key = VertexKey { lattice: [x, y, z], level: 0, kind: u8::try_from(kind).ok()?, sheet: 0 };
        u32::try_from(row).ok().filter(|row| (*row as usize) < positions).map(|row| (row, key))
    };
    let shared: Vec<(u32, VertexKey)> =
        keys.as_chunks::<SHARED_ROW>().0.iter().map(key).collect::<Option<_>>()?;
    // Parts are joined in one pass over these rows, which would miss those that are out of order.
    if !shared.is_sorted_by_key(|(row, _)| *row) {
        return None;
    }
    Some(SurfacePart { mesh, shared, bound: chordal::Bound::exact(chordal::budget::Reference::Trilinear) })
}
