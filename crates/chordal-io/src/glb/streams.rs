//! `AccessorStream`: the rows of one accessor, and their conversion to bytes.
use super::deformation::SkinSet;
use super::meshopt;
use super::stored_positions::StoredPositions;
use super::vertex_storage::{NormalizedNumber, VertexStorage, stored_row};
use crate::WriteError;
use chordal::Mesh;
use chordal::convert::gpu::IndexBuffer;
use chordal::explicit::{Attribute, Semantic};
use chordal::math::{greater, lesser, unit};
use std::borrow::Cow;
use std::io::Write;

/// The number of bytes that are collected before they go to the sink.
const BATCH: usize = 1 << 16;

/// The rows of one accessor.
pub(super) enum AccessorSource<'a> {
    /// Indices of two bytes.
    Short(&'a [[u32; 3]]),
    /// Indices of four bytes.
    Long(&'a [[u32; 3]]),
    /// Positions in their stored form.
    Positions(&'a Mesh, StoredPositions),
    /// Rows as normalized integers; v of texture coordinates may be flipped.
    Normalized(&'a Attribute, NormalizedNumber, bool),
    /// Unit vectors, from the first three numbers of a row; a row without direction becomes the given axis.
    Unit(&'a Attribute, usize),
    /// Numbers in single precision, unchanged.
    Plain(&'a Attribute),
    /// Texture coordinates with their origin at the lower left corner: v is flipped.
    TurnedTexcoords(&'a Attribute),
    /// Raw bytes.
    Bytes(Cow<'a, [u8]>),
    /// Indices of joints, four per vertex.
    Joints(Vec<u16>),
    /// The same with one byte each.
    ByteJoints(Vec<u8>),
    /// Joint weights, four per vertex.
    Weights(Vec<f32>),
    /// The same as integer shares of 65,535.
    ShortWeights(Vec<u16>),
}

/// One accessor with its own buffer view.
pub(super) struct AccessorStream<'a> {
    /// The name of the attribute, or `None` for indices.
    pub name: Option<String>,
    /// Its rows.
    pub rows: AccessorSource<'a>,
}

/// The rows of an accessor, compressed.
pub(super) struct CompressedStream {
    pub stream: Vec<u8>,
    /// The bytes per unpacked row.
    pub stride: usize,
    /// The number of rows.
    pub count: usize,
    /// Whether the rows are vertex indices of triangles.
    pub is_index: bool,
    pub target: u32,
}

impl<'a> AccessorStream<'a> {
    /// The indices of faces over `n_vertices` vertices: two bytes if the largest is below 65535, which would
    /// mean "restart".
    pub fn indices(faces: &'a [[u32; 3]], n_vertices: usize) -> Self {
        let short = IndexBuffer::fit_16_bits(n_vertices);
        Self {
            name: None,
            rows: if short { AccessorSource::Short(faces) } else { AccessorSource::Long(faces) },
        }
    }

    /// Bytes that are not vertex data.
    pub fn bytes(bytes: &'a [u8]) -> Self {
        Self { name: None, rows: AccessorSource::Bytes(Cow::Borrowed(bytes)) }
    }

    /// A compressed stream.
    pub fn compressed_bytes(stream: Vec<u8>) -> Self {
        Self { name: None, rows: AccessorSource::Bytes(Cow::Owned(stream)) }
    }

    /// The compressed rows, unless compression makes them longer.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn compressed(&self) -> Result<Option<CompressedStream>, WriteError> {
        let (Some(target), count) = (self.target(), self.count()) else { return Ok(None) };
        let n_bytes = self.n_bytes();
        if n_bytes == 0 {
            return Ok(None);
        }
        let (is_index, stream) = match self.rows {
            AccessorSource::Short(faces) | AccessorSource::Long(faces) => {
                (true, meshopt::encode_triangles(faces))
            }
            _ => {
                let mut bytes = Vec::new();
                self.write(&mut bytes)?;
                // Rows have a multiple of four bytes.
                (false, meshopt::encode_rows(&bytes, bytes.len() / count))
            }
        };
        let stride = n_bytes as usize / count;
        let is_shorter = (stream.len() as u64) < n_bytes;
        Ok(is_shorter.then_some(CompressedStream { stream, stride, count, is_index, target }))
    }

    /// The positions of a mesh.
    pub fn positions(mesh: &'a Mesh, stored: StoredPositions) -> Self {
        Self { name: Some("POSITION".to_owned()), rows: AccessorSource::Positions(mesh, stored) }
    }

    /// The joints of a set, and their weights.
    pub fn skin_set(set: usize, skin: SkinSet, fewer: Option<Vec<u16>>) -> [Self; 2] {
        let bytes = fewer.is_some().then(|| skin.joints.iter().map(|j| u8::try_from(*j).ok()).collect());
        let joints = match bytes.flatten() {
            Some(bytes) => AccessorSource::ByteJoints(bytes),
            None => AccessorSource::Joints(skin.joints),
        };
        let weights = fewer.map_or(AccessorSource::Weights(skin.weights), AccessorSource::ShortWeights);
        [
            Self { name: Some(format!("JOINTS_{set}")), rows: joints },
            Self { name: Some(format!("WEIGHTS_{set}")), rows: weights },
        ]
    }

    /// The same stream in a quantized storage.
    pub fn with_fewer_bits(mut self, storage: &VertexStorage) -> Self {
        let (attribute, turns_v) = match self.rows {
            AccessorSource::Unit(attribute, _) | AccessorSource::Plain(attribute) => (attribute, false),
            AccessorSource::TurnedTexcoords(attribute) => (attribute, true),
            _ => return self,
        };
        if let Some(number) = storage.number_of(attribute) {
            self.rows = AccessorSource::Normalized(attribute, number, turns_v);
        }
        self
    }

    /// Whether its integers are normalized.
    pub fn is_normalized(&self) -> bool {
        matches!(self.rows, AccessorSource::Normalized(..) | AccessorSource::ShortWeights(_))
    }

    /// Whether its format is allowed only by `KHR_mesh_quantization`.
    pub fn needs_quantization(&self) -> bool {
        match self.rows {
            AccessorSource::Positions(_, StoredPositions::Lattice(..)) => true,
            AccessorSource::Normalized(_, number, _) => {
                matches!(number, NormalizedNumber::I8 | NormalizedNumber::I16)
            }
            _ => false,
        }
    }

    /// The displacements of an attribute by a morph target.
    pub fn morph(name: &str, attribute: &'a Attribute) -> Result<Self, WriteError> {
        check_values(name, attribute)?;
        Ok(Self { name: Some(name.to_owned()), rows: AccessorSource::Plain(attribute) })
    }

    /// The same stream with v flipped, if it holds texture coordinates.
    pub fn with_turned_v(mut self) -> Self {
        if let AccessorSource::Plain(attribute) = self.rows
            && matches!(attribute.semantic, Semantic::TexCoord(_))
        {
            self.rows = AccessorSource::TurnedTexcoords(attribute);
        }
        self
    }

    /// An attribute under its glTF name; the caller numbers texture and colour sets.
    pub fn attribute(attribute: &'a Attribute, set: usize) -> Result<Self, WriteError> {
        let (name, widths, rows): (_, &[usize], _) = match &attribute.semantic {
            Semantic::Normal => ("NORMAL".to_owned(), &[3], AccessorSource::Unit(attribute, 2)),
            Semantic::Tangent => ("TANGENT".to_owned(), &[4], AccessorSource::Unit(attribute, 0)),
            Semantic::TexCoord(_) => (format!("TEXCOORD_{set}"), &[2], AccessorSource::Plain(attribute)),
            Semantic::Color(_) => (format!("COLOR_{set}"), &[3, 4], AccessorSource::Plain(attribute)),
            Semantic::Group(name) | Semantic::Custom(name) | Semantic::Blended(name) => {
                // Custom names start with an underscore.
                let mark = if name.starts_with('_') { "" } else { "_" };
                (format!("{mark}{name}"), &[1, 2, 3, 4, 9, 16], AccessorSource::Plain(attribute))
            }
        };
        if !widths.contains(&attribute.width) {
            return Err(WriteError::Unsupported(format!(
                "glTF has no attribute {name} of {} numbers a vertex",
                attribute.width
            )));
        }
        if let AccessorSource::Plain(attribute) = rows {
            check_values(&name, attribute)?;
        }
        Ok(Self { name: Some(name), rows })
    }

    /// `ELEMENT_ARRAY_BUFFER` or `ARRAY_BUFFER`, for rows of vertices.
    pub fn target(&self) -> Option<u32> {
        match self.rows {
            AccessorSource::Bytes(_) => None,
            AccessorSource::Short(_) | AccessorSource::Long(_) => Some(34963),
            _ => Some(34962),
        }
    }

    /// `UNSIGNED_SHORT`, `UNSIGNED_INT`, `FLOAT`, or a smaller integer.
    pub fn component_type(&self) -> u32 {
        match self.rows {
            AccessorSource::Short(_) | AccessorSource::Joints(_) | AccessorSource::ShortWeights(_) => 5123,
            AccessorSource::Positions(_, StoredPositions::Lattice(..)) => 5123,
            AccessorSource::ByteJoints(_) => 5121,
            AccessorSource::Normalized(_, number, _) => number.component_type(),
            AccessorSource::Long(_) => 5125,
            _ => 5126,
        }
    }

    fn width(&self) -> usize {
        match &self.rows {
            AccessorSource::Short(_) | AccessorSource::Long(_) | AccessorSource::Bytes(_) => 1,
            AccessorSource::Positions(..) => 3,
            AccessorSource::Joints(_) | AccessorSource::Weights(_) => 4,
            AccessorSource::ByteJoints(_) | AccessorSource::ShortWeights(_) => 4,
            AccessorSource::Unit(attribute, _)
            | AccessorSource::Normalized(attribute, ..)
            | AccessorSource::Plain(attribute)
            | AccessorSource::TurnedTexcoords(attribute) => attribute.width,
        }
    }

    /// The accessor type.
    pub fn kind(&self) -> &'static str {
        match self.width() {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            9 => "MAT3",
            _ => "MAT4",
        }
    }

    /// The number of elements.
    pub fn count(&self) -> usize {
        match &self.rows {
            AccessorSource::Short(faces) | AccessorSource::Long(faces) => 3 * faces.len(),
            AccessorSource::Bytes(bytes) => bytes.len(),
            AccessorSource::Positions(mesh, _) => mesh.positions().len(),
            AccessorSource::Joints(joints) => joints.len() / 4,
            AccessorSource::Weights(weights) => weights.len() / 4,
            AccessorSource::ByteJoints(joints) => joints.len() / 4,
            AccessorSource::ShortWeights(weights) => weights.len() / 4,
            AccessorSource::Unit(attribute, _)
            | AccessorSource::Normalized(attribute, ..)
            | AccessorSource::Plain(attribute)
            | AccessorSource::TurnedTexcoords(attribute) => attribute.values.len() / attribute.width,
        }
    }

    /// The bytes of a row without padding.
    fn row_size(&self) -> usize {
        let size = match self.rows {
            AccessorSource::Bytes(_) | AccessorSource::ByteJoints(_) => 1,
            AccessorSource::Short(_) | AccessorSource::Joints(_) | AccessorSource::ShortWeights(_) => 2,
            AccessorSource::Positions(_, StoredPositions::Lattice(..)) => 2,
            AccessorSource::Normalized(_, number, _) => number.size(),
            _ => 4,
        };
        self.width() * size
    }

    /// The stride between rows of a vertex, if it is larger than a row: strides are multiples of four.
    pub fn padded_stride(&self) -> Option<usize> {
        let is_vertex = !matches!(
            self.rows,
            AccessorSource::Bytes(_) | AccessorSource::Short(_) | AccessorSource::Long(_)
        );
        (is_vertex && !self.row_size().is_multiple_of(4)).then(|| self.row_size().next_multiple_of(4))
    }

    /// The number of bytes without padding at the end.
    pub fn n_bytes(&self) -> u64 {
        (self.count() * self.padded_stride().unwrap_or_else(|| self.row_size())) as u64
    }

    /// The number of bytes with padding to the next multiple of four.
    pub fn n_padded(&self) -> u64 {
        self.n_bytes().div_ceil(4) * 4
    }

    /// A hash of the bytes, to compare rows quickly.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn fingerprint(&self) -> Result<u64, WriteError> {
        let mut sum = FingerprintSink { sum: FNV_BASIS };
        self.write(&mut sum)?;
        Ok(sum.sum)
    }

    /// Writes the bytes, padded with zeros to a multiple of four.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let mut sink = ByteSink { out, bytes: Vec::with_capacity(BATCH + 16) };
        match &self.rows {
            AccessorSource::Short(faces) => {
                faces.as_flattened().iter().try_for_each(|i| sink.put((*i as u16).to_le_bytes()))?;
            }
            AccessorSource::Long(faces) => {
                faces.as_flattened().iter().try_for_each(|i| sink.put(i.to_le_bytes()))?;
            }
            AccessorSource::Bytes(bytes) => sink.out.write_all(bytes)?,
            AccessorSource::Joints(joints) => {
                joints.iter().try_for_each(|joint| sink.put(joint.to_le_bytes()))?;
            }
            AccessorSource::Weights(weights) => {
                weights.iter().try_for_each(|weight| sink.put(weight.to_le_bytes()))?;
            }
            AccessorSource::ByteJoints(joints) => joints.iter().try_for_each(|joint| sink.put([*joint]))?,
            AccessorSource::ShortWeights(weights) => {
                weights.iter().try_for_each(|weight| sink.put(weight.to_le_bytes()))?;
            }
            // A fourth number of 0 makes rows of eight bytes: in glTF they begin at multiples of
            // four.
            AccessorSource::Positions(mesh, StoredPositions::Lattice(lattice, corner)) => {
                for position in mesh.positions() {
                    let [x, y, z] = lattice.stored(*position, *corner);
                    [x, y, z, 0].into_iter().try_for_each(|x| sink.put(x.to_le_bytes()))?;
                }
            }
            AccessorSource::Positions(mesh, stored) => {
                for position in mesh.positions() {
                    let row = stored.stored(*position);
                    row.into_iter().try_for_each(|x| sink.put((x as f32).to_le_bytes()))?;
                }
            }
            AccessorSource::Normalized(attribute, number, turns_v) => {
                let pad = self.padded_stride().map_or(0, |stride| stride - self.row_size());
                for row in attribute.values.chunks_exact(attribute.width) {
                    let turned = [row[0], if *turns_v { 1.0 - row[1] } else { row[0] }];
                    let row = if *turns_v { &turned[..] } else { row };
                    for stored in stored_row(attribute, row, *number) {
                        let [low, high] = number.bytes(stored);
                        if number.size() == 1 { sink.put([low])? } else { sink.put([low, high])? }
                    }
                    (0..pad).try_for_each(|_| sink.put([0]))?;
                }
            }
            AccessorSource::Unit(attribute, axis) => {
                for row in attribute.values.chunks_exact(attribute.width) {
                    unit_or_axis(row, *axis)
                        .into_iter()
                        .try_for_each(|x| sink.put((x as f32).to_le_bytes()))?;
                    row.get(3).map_or(Ok(()), |w| {
                        sink.put((if *w < 0.0 { -1.0_f32 } else { 1.0 }).to_le_bytes())
                    })?;
                }
            }
            AccessorSource::Plain(attribute) => {
                attribute.values.iter().try_for_each(|x| sink.put((*x as f32).to_le_bytes()))?;
            }
            AccessorSource::TurnedTexcoords(attribute) => {
                for row in attribute.values.chunks_exact(2) {
                    sink.put((row[0] as f32).to_le_bytes())?;
                    sink.put(((1.0 - row[1]) as f32).to_le_bytes())?;
                }
            }
        }
        (self.n_bytes()..self.n_padded()).try_for_each(|_| sink.put([0]))?;
        sink.out.write_all(&sink.bytes)?;
        Ok(())
    }
}

/// The lowest and highest stored coordinates. Zero has no sign here.
pub(super) fn stored_bounds(mesh: &Mesh, stored: &StoredPositions) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for position in mesh.positions() {
        let stored = stored.stored(*position);
        for k in 0..3 {
            let x = stored[k] + 0.0;
            bounds[0][k] = lesser(x, bounds[0][k]);
            bounds[1][k] = greater(x, bounds[1][k]);
        }
    }
    bounds
}

/// The first three numbers as a unit vector, or an axis if they have no direction: the format requires a unit
/// vector.
fn unit_or_axis(row: &[f64], axis: usize) -> [f64; 3] {
    let along_axis = || std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
    let v = [row[0], row[1], row[2]];
    // A vector that had length 1 before it was rounded to single precision is kept to the last bit.
    let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (squared - 1.0).abs() < 4.0 * f64::from(f32::EPSILON) {
        return v;
    }
    unit(v).unwrap_or_else(along_axis)
}

/// Checks that single precision can hold the values, and that they suit the semantic.
fn check_values(name: &str, attribute: &Attribute) -> Result<(), WriteError> {
    let fits = |x: f64| match attribute.semantic {
        Semantic::Color(_) => (0.0..=1.0).contains(&x),
        Semantic::Group(_) => f64::from(x as f32) == x,
        _ => (x as f32).is_finite(),
    };
    let Some(at) = attribute.values.iter().position(|x| !fits(*x)) else { return Ok(()) };
    let (row, value) = (at / attribute.width, attribute.values[at]);
    Err(WriteError::Unsupported(format!("glTF cannot hold {value} at vertex {row} of attribute {name}")))
}

/// The basis and the prime of the 64-bit FNV hash (G. Fowler, L. C. Noll, P. Vo, 1991).
const FNV_BASIS: u64 = 0xCBF2_9CE4_8422_2325;
const FNV_PRIME: u64 = 0x0000_0100_0000_01B3;

/// Hashes bytes four at a time, in their padded form.
struct FingerprintSink {
    sum: u64,
}

impl Write for FingerprintSink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        for word in bytes.chunks(4) {
            let word = word.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
            self.sum = (self.sum ^ word).wrapping_mul(FNV_PRIME);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

struct ByteSink<'a> {
    out: &'a mut dyn Write,
    bytes: Vec<u8>,
}

impl ByteSink<'_> {
    fn put<const N: usize>(&mut self, bytes: [u8; N]) -> Result<(), WriteError> {
        self.bytes.extend_from_slice(&bytes);
        if self.bytes.len() >= BATCH {
            self.out.write_all(&self.bytes)?;
            self.bytes.clear();
        }
        Ok(())
    }
}
