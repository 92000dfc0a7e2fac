//! Cages for Python: polygons with the tags of subdivision surfaces, and their refinement.
use crate::array::{Array, ArrayData};
use crate::source::Source;
use crate::{failure, work};
use chordal::explicit::subdivision::{Boundary, CreasingMethod, Scheme};
use chordal::explicit::{Cage as Polygon, InvalidCage};
use chordal_io::{Format, Frame, Polygons, obj};
use chordal_verbs::{Input, Shape, refined_cage, sha256};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use std::sync::Arc;

/// The tags of a cage, as Python passes them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tags {
    creases: Vec<(u32, u32, f64)>,
    corners: Vec<(u32, f64)>,
    holes: Vec<u32>,
    scheme: String,
    boundary: String,
    creasing: String,
}

const BOUNDARIES: [(Boundary, &str); 3] = [
    (Boundary::None, "none"),
    (Boundary::EdgeOnly, "edge-only"),
    (Boundary::EdgeAndCorner, "edge-and-corner"),
];
const CREASINGS: [(CreasingMethod, &str); 2] =
    [(CreasingMethod::Uniform, "uniform"), (CreasingMethod::Chaikin, "chaikin")];

/// The value of a name.
fn from_name<T: Copy>(argument: &str, name: &str, table: &[(T, &str)]) -> PyResult<T> {
    let value = table.iter().find(|(_, known)| *known == name).map(|(value, _)| *value);
    value.ok_or_else(|| {
        let names: Vec<String> = table.iter().map(|(_, known)| format!("'{known}'")).collect();
        failure::argument(argument, format!("one of {}, not '{name}'", names.join(", ")))
    })
}

/// The name of a value.
fn name_of<T: PartialEq>(value: &T, table: &[(T, &'static str)]) -> &'static str {
    table.iter().find(|(known, _)| known == value).map_or("", |(_, name)| name)
}

/// A cage with the lists that numpy reads.
struct CageArrays {
    cage: Polygon,
    /// The index of the first corner of each face, then the number of all corners.
    offsets: Vec<i64>,
    indices: Vec<u32>,
}

/// A polygon cage.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Cage(Arc<CageArrays>);

impl Cage {
    /// Wraps a cage.
    pub(crate) fn from_cage(cage: Polygon) -> Self {
        let (mut offsets, mut indices) = (vec![0], Vec::new());
        for face in cage.faces() {
            indices.extend_from_slice(face);
            offsets.push(indices.len() as i64);
        }
        Self(Arc::new(CageArrays { cage, offsets, indices }))
    }
}

#[pymethods]
impl Cage {
    /// `numbers` are three coordinates a vertex in double precision, `indices` the vertices of all faces in
    /// 32 bits, and `ends` the end of each face in `indices` in 64 bits; all in native byte order.
    #[new]
    fn new(
        py: Python<'_>,
        numbers: PyBackedBytes,
        indices: PyBackedBytes,
        ends: PyBackedBytes,
        tags: Tags,
    ) -> PyResult<Self> {
        let schemes = Scheme::ALL.map(|scheme| (scheme, scheme.name()));
        let scheme = from_name("scheme", &tags.scheme, &schemes)?;
        let boundary = from_name("boundary", &tags.boundary, &BOUNDARIES)?;
        let creasing = from_name("creasing", &tags.creasing, &CREASINGS)?;
        let cage = work::run(py, None, move |_| {
            let creases: Vec<_> = tags.creases.iter().map(|(a, b, sharp)| ([*a, *b], *sharp)).collect();
            polygons(&numbers, &indices, &ends)?
                .with_scheme(scheme)
                .map(|cage| cage.with_boundary(boundary).with_creasing(creasing))
                .and_then(|cage| cage.with_creases(&creases))
                .and_then(|cage| cage.with_sharp_vertices(&tags.corners))
                .and_then(|cage| cage.with_holes(&tags.holes))
                .map(Self::from_cage)
        })?;
        cage.map_err(|error| failure::argument(argument_of(&error), error))
    }

    /// The cage after some rounds of subdivision.
    fn refined(&self, py: Python<'_>, levels: u32) -> PyResult<Self> {
        let arrays = Arc::clone(&self.0);
        let cage =
            work::run(py, None, move |job| refined_cage(&arrays.cage, levels, job).map(Self::from_cage))?;
        cage.map_err(|error| failure::mesh(py, error))
    }

    /// An array by its name: "positions", "indices" or "offsets".
    fn array(&self, py: Python<'_>, name: &str) -> PyResult<Array> {
        Ok(match name {
            "positions" => {
                Array::new(&self.0, |arrays| ArrayData::from_f64(arrays.cage.positions().as_flattened(), 3))
            }
            // A cage has fewer vertices than 2³¹.
            "indices" => Array::new(&self.0, |arrays| ArrayData::from_u32_below_sign(&arrays.indices, 1)),
            "offsets" => Array::new(&self.0, |arrays| ArrayData::from_i64(&arrays.offsets)),
            _ => return Err(failure::internal(py, &format!("there are no {name}"))),
        })
    }

    /// Sharp edges with their sharpness.
    #[getter]
    fn creases(&self) -> Vec<(u32, u32, f64)> {
        self.0.cage.creases().iter().map(|([a, b], sharp)| (*a, *b, *sharp)).collect()
    }

    /// Sharp vertices with their sharpness.
    #[getter]
    fn corners(&self) -> Vec<(u32, f64)> {
        self.0.cage.sharp_vertices().to_vec()
    }

    /// Faces without surface.
    #[getter]
    fn holes(&self) -> Vec<u32> {
        self.0.cage.holes().to_vec()
    }

    /// The names of the scheme, of the boundary rule and of the creasing method.
    #[getter]
    fn rules(&self) -> (&'static str, &'static str, &'static str) {
        let cage = &self.0.cage;
        (cage.scheme().name(), name_of(&cage.boundary(), &BOUNDARIES), name_of(&cage.creasing(), &CREASINGS))
    }

    /// The cage as if it were read from a file.
    fn source(&self, py: Python<'_>, unit: Option<&str>) -> PyResult<Source> {
        let metres_per_unit =
            crate::spec::parse_argument::<chordal::budget::Unit>("unit", unit)?.map(|unit| unit.metres());
        let arrays = Arc::clone(&self.0);
        let input = work::run(py, None, move |_| {
            let polygons = Polygons::from_cage(
                arrays.cage.clone(),
                Frame { up: None, metres_per_unit, ..Frame::default() },
            );
            let mut bytes = Vec::new();
            obj::write_polygons(&polygons, None, &mut bytes)?;
            let (n_bytes, digest) = (bytes.len() as u64, sha256(&bytes).into());
            Ok(Input { n_bytes, digest, ..Input::made(Shape::Cage(polygons), Format::Obj) })
        })?;
        input.map(|input| Source::from_input(input, Vec::new())).map_err(|error| failure::write(py, &error))
    }
}

/// The polygons of some bytes. Left-over bytes are ignored: Python passes whole numbers.
fn polygons(numbers: &[u8], indices: &[u8], ends: &[u8]) -> Result<Polygon, InvalidCage> {
    let numbers =
        numbers.as_chunks::<{ size_of::<f64>() }>().0.iter().map(|bytes| f64::from_ne_bytes(*bytes));
    let numbers: Vec<f64> = numbers.collect();
    let indices =
        indices.as_chunks::<{ size_of::<u32>() }>().0.iter().map(|bytes| u32::from_ne_bytes(*bytes));
    let indices: Vec<u32> = indices.collect();
    let mut rest = &indices[..];
    let mut start = 0;
    let faces = ends.as_chunks::<{ size_of::<i64>() }>().0.iter().map(|bytes| {
        let end = i64::from_ne_bytes(*bytes);
        let n = usize::try_from(end.saturating_sub(start)).unwrap_or(0);
        start = end;
        let (face, others) = rest.split_at(if n < rest.len() { n } else { rest.len() });
        rest = others;
        face
    });
    Polygon::new(numbers.as_chunks::<3>().0.to_vec(), faces)
}

/// The argument that an error is about.
fn argument_of(error: &InvalidCage) -> &'static str {
    match error {
        InvalidCage::NotFinite { .. } | InvalidCage::WrongCount { .. } => "positions",
        InvalidCage::NoSuchEdge { .. } => "creases",
        InvalidCage::NoSuchVertex { .. } => "corners",
        InvalidCage::NoSuchFace { .. } => "holes",
        InvalidCage::Sharpness { .. } => "creases or corners",
        InvalidCage::NotTriangles { .. }
        | InvalidCage::IndexOutOfRange { .. }
        | InvalidCage::ShortFace { .. }
        | InvalidCage::VertexTwice { .. }
        | InvalidCage::TooMany { .. } => "faces",
        InvalidCage::WrongCorners { .. }
        | InvalidCage::NoSuchTexcoord { .. }
        | InvalidCage::TexcoordNotFinite { .. } => "texcoords",
    }
}
