//! Parts of a surface that is never in one place: simplified, joined, and written as tiles.
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

/// Where a part is in its lattice.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BoxArguments {
    /// The index of the first sample, and of the last one.
    low: [i64; 3],
    high: [i64; 3],
    /// For each axis whether another part is beyond its low and its high side.
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
    /// The index of its first sample, and its cells along each axis.
    low: [i64; 3],
    sides: [i64; 3],
    affine: [[f64; 4]; 3],
    is_halved: bool,
}

/// Of a fragment: three whole numbers of 32 bits a vertex, three indices a triangle, in the order of the machine; which
/// eighths of its box have triangles, and how far the part was moved at most.
type FragmentState<'py> = (pyo3::Bound<'py, PyBytes>, pyo3::Bound<'py, PyBytes>, u8, f64);

/// A part of a surface.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct BlockPart(Arc<SurfacePart>);

/// What a tileset says of a tile: its name, the box of its content (low, then high), its bound, its triangles, and its
/// children by their numbers in the list.
type EntryState = (String, [f64; 6], BoundState, u64, Vec<usize>);

/// The triangles of a block; `None` where it has none. With the samples around it, and where these begin, vertices have normals.
#[pyfunction]
pub(crate) fn part(
    py: Python<'_>,
    samples: &Source,
    arguments: BlockArguments,
    place: BoxArguments,
    around: Option<(Py<Source>, BlockArguments)>,
) -> PyResult<Option<BlockPart>> {
    let mut made = mesh_block(py, samples, &arguments)?;
    if let Some((samples, arguments)) = around.filter(|_| !made.faces.is_empty()) {
        let known = normals_of(py, samples.get(), &arguments)?;
        let normal = |key: &VertexKey| {
            let at = known.binary_search_by_key(key, |(known, _)| *known);
            at.map(|at| known[at].1).map_err(|_| failure::argument("around", "these are other samples"))
        };
        made.normals = made.vertex_keys.iter().map(normal).collect::<PyResult<_>>()?;
    }
    Ok(SurfacePart::from_block(made, &place.place()).map(|part| BlockPart(Arc::new(part))))
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

/// Parts that fill a box as one.
#[pyfunction]
pub(crate) fn join_parts(
    py: Python<'_>,
    parts: Vec<Py<BlockPart>>,
    place: BoxArguments,
) -> PyResult<BlockPart> {
    let parts: Vec<Arc<SurfacePart>> = parts.iter().map(|part| Arc::clone(&part.get().0)).collect();
    let made = work::run(py, None, move |_| SurfacePart::join(&parts, &place.place()))?;
    made.map(|part| BlockPart(Arc::new(part))).map_err(|error| failure::mesh(py, error.into()))
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

    /// The number of vertices at which other parts go on.
    #[getter]
    fn n_shared(&self) -> usize {
        self.0.shared.len()
    }

    /// The upper end of its bound.
    #[getter]
    fn at_most(&self) -> f64 {
        self.0.bound.at_most().unwrap_or(f64::INFINITY)
    }

    /// Fewer triangles within a length of these.
    fn simplified(&self, py: Python<'_>, length: f64) -> PyResult<Self> {
        let length = Tolerance::new(length).map_err(|error| failure::argument("length", error))?;
        let part = Arc::clone(&self.0);
        let made = work::run(py, None, move |job| part.simplified(length, job))?;
        made.map(|(part, _)| Self(Arc::new(part))).map_err(|error| failure::mesh(py, error.into()))
    }

    /// The same in single precision about an origin.
    fn rounded(&self, py: Python<'_>, origin: [f64; 3]) -> PyResult<Self> {
        let made = rounded_part(&self.0, origin).map_err(|error| failure::mesh(py, error))?;
        Ok(Self(Arc::new(made)))
    }

    /// Its file, and what a tileset says of it.
    fn tile<'py>(
        &self,
        py: Python<'py>,
        name: String,
        metres_per_unit: Option<f64>,
    ) -> PyResult<(pyo3::Bound<'py, PyBytes>, EntryState)> {
        let frame = Frame { metres_per_unit, ..Frame::default() };
        let made = part_tile(SurfacePart::clone(&self.0), frame, name, Vec::new())
            .map_err(|error| failure::mesh(py, error))?;
        let TileEntry { name, bounds: Box3 { min, max }, bound, triangles, children } = made.entry;
        let ends = [min[0], min[1], min[2], max[0], max[1], max[2]];
        Ok((PyBytes::new(py, &made.glb), (name, ends, state_of_bound(&bound), triangles, children)))
    }

    /// A fragment of Neuroglancer's meshes: the number of vertices, their coordinates times a scale in single precision, and
    /// three indices for each triangle; all little-endian.
    fn fragment<'py>(&self, py: Python<'py>, scale: f64) -> pyo3::Bound<'py, PyBytes> {
        let mesh = &self.0.mesh;
        let mut bytes = (mesh.positions().len() as u32).to_le_bytes().to_vec();
        let coordinates = mesh.positions().as_flattened().iter();
        coordinates.for_each(|x| bytes.extend(((x * scale) as f32).to_le_bytes()));
        mesh.faces().as_flattened().iter().for_each(|row| bytes.extend(row.to_le_bytes()));
        PyBytes::new(py, &bytes)
    }

    /// A fragment of Neuroglancer's meshes of several levels, before Draco.
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
        let made = work::run(py, None, move |_| LatticeFragment::new(&part, &place.place(), &within))?;
        let made = made.map_err(|error| failure::mesh(py, error.into()))?;
        let numbers = made.positions.as_flattened().iter().flat_map(|x| i32::from(*x).to_ne_bytes());
        let indices = made.faces.as_flattened().iter().flat_map(|row| row.to_ne_bytes());
        let (numbers, indices): (Vec<u8>, Vec<u8>) = (numbers.collect(), indices.collect());
        Ok((PyBytes::new(py, &numbers), PyBytes::new(py, &indices), made.octants, made.moved_at_most))
    }

    /// Its triangles as a scene, and its bound as JSON.
    fn source(&self, py: Python<'_>, metres_per_unit: Option<f64>) -> PyResult<(Source, String)> {
        let part = Arc::clone(&self.0);
        let made = work::run(py, None, move |_| {
            Ok::<_, JobError>(scene_of(part.mesh.clone(), &part.bound, metres_per_unit))
        })?;
        let (input, bound) = made.map_err(|error| failure::mesh(py, error.into()))?;
        Ok((Source::from_input(input, Vec::new()), bound))
    }

    /// All of it as bytes: what [`Self::of_state`] makes the same part of.
    fn state<'py>(&self, py: Python<'py>) -> (pyo3::Bound<'py, PyBytes>, BoundState) {
        (PyBytes::new(py, &bytes_of(&self.0)), state_of_bound(&self.0.bound))
    }

    /// The part of such a state.
    #[staticmethod]
    fn of_state(bytes: PyBackedBytes, bound: BoundState) -> PyResult<Self> {
        let wrong = || failure::argument("state", "these are no bytes of a part");
        let mut part = part_of_bytes(&bytes).ok_or_else(wrong)?;
        part.bound = bound_of_state(bound);
        Ok(Self(Arc::new(part)))
    }
}

/// Bytes of one number.
const NUMBER: usize = 8;
/// Numbers of a row of what is shared: the row, x, y, z, kind.
const SHARED_ROW: usize = 5;

/// How many positions, faces, shared rows and normals there are, and each of these; all little-endian.
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
    mesh.faces().as_flattened().iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    bytes
}

fn part_of_bytes(bytes: &[u8]) -> Option<SurfacePart> {
    let (numbers, _) = bytes.as_chunks::<NUMBER>();
    let (counts, numbers) = numbers.split_at_checked(4)?;
    let count = |at: usize| usize::try_from(u64::from_le_bytes(counts[at])).ok();
    let [positions, faces, shared, normals] = [count(0)?, count(1)?, count(2)?, count(3)?];
    let take = |of: usize, width: usize| of.checked_mul(width);
    let (coordinates, numbers) = numbers.split_at_checked(take(positions, 3)?)?;
    let (directions, numbers) = numbers.split_at_checked(take(normals, 3)?)?;
    let (keys, _) = numbers.split_at_checked(take(shared, SHARED_ROW)?)?;
    let before = NUMBER * (4 + 3 * (positions + normals) + SHARED_ROW * shared);
    let (indices, odd) = bytes.get(before..)?.as_chunks::<4>();
    if !odd.is_empty() || indices.len() != take(faces, 3)? {
        return None;
    }
    let points = |of: &[[u8; NUMBER]]| -> Vec<[f64; 3]> {
        of.as_chunks::<3>().0.iter().map(|point| point.map(f64::from_le_bytes)).collect()
    };
    let corners = indices.as_chunks::<3>().0.iter().map(|face| face.map(u32::from_le_bytes)).collect();
    let mut mesh = Mesh::new(points(coordinates), corners).ok()?;
    if normals > 0 {
        mesh = mesh.with_attribute(Attribute::vertex_normals(&points(directions))).ok()?;
    }
    let key = |row: &[[u8; NUMBER]; SHARED_ROW]| {
        let [row, x, y, z, kind] = row.map(i64::from_le_bytes);
        let key = VertexKey { lattice: [x, y, z], level: 0, kind: u8::try_from(kind).ok()?, sheet: 0 };
        u32::try_from(row).ok().filter(|row| (*row as usize) < positions).map(|row| (row, key))
    };
    let shared: Vec<(u32, VertexKey)> =
        keys.as_chunks::<SHARED_ROW>().0.iter().map(key).collect::<Option<_>>()?;
    if !shared.is_sorted_by_key(|(row, _)| *row) {
        return None;
    }
    Some(SurfacePart { mesh, shared, bound: chordal::Bound::exact(chordal::budget::Reference::Trilinear) })
}
