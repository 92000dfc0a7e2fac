//! `Mesh`: triangles over an indexed list of positions, with attribute streams.
use crate::math::Box3;
use std::fmt;

/// The meaning of an attribute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Semantic {
    /// Unit normals, 3 wide.
    Normal,
    /// Tangents with the sign of the bitangent, 4 wide.
    Tangent,
    /// Texture coordinates of a set, 2 wide.
    TexCoord(u32),
    /// Colours of a set, 3 or 4 wide, 0 to 1.
    Color(u32),
    /// The index of a material or smoothing group, 1 wide.
    Group(String),
    /// Any other attribute, under its name in the file.
    Custom(String),
    /// Numbers under a name that may be blended, such as a morph target's displacement of a vertex, or the
    /// weights of a skin's joints.
    Blended(String),
}

/// The elements that the rows of an attribute belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// One row per vertex.
    Vertex,
    /// Three rows per face, in the order of its corners.
    Corner,
    /// One row per face.
    Face,
}

/// A stream of values with `width` numbers per row.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Its meaning.
    pub semantic: Semantic,
    /// The elements its rows belong to.
    pub domain: Domain,
    /// Numbers per row, 1 to 16.
    pub width: usize,
    /// All rows, one after the other.
    pub values: Vec<f64>,
}

impl Attribute {
    /// Vertex normals from `n × 3` values.
    #[must_use]
    pub fn vertex_normals(normals: &[[f64; 3]]) -> Self {
        Self {
            semantic: Semantic::Normal,
            domain: Domain::Vertex,
            width: 3,
            values: normals.as_flattened().to_vec(),
        }
    }

    /// The row of one vertex, corner or face.
    #[must_use]
    pub fn row(&self, index: usize) -> &[f64] {
        &self.values[index * self.width..][..self.width]
    }
}

/// The most half-edges that a mesh may have: the upper half of `u32` is used for flags and states.
const MAX_HALF_EDGES: usize = (1 << 31) - 4;

/// Triangles: `faces` is m × 3, indices into `positions`, n × 3, all finite. The front is counter-clockwise.
///
/// Vertices that differ only in their attributes (the two sides of a hard edge) are separate rows.
/// [`Mesh::position_id`] links them, so that a cube with 24 vertices is still closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    position_id: Option<Vec<u32>>,
    attributes: Vec<Attribute>,
}

impl Mesh {
    /// A mesh without attributes.
    ///
    /// # Errors
    /// [`InvalidMesh`] when a coordinate is not finite, an index is out of range, or there are more than 2³²
    /// − 2 positions or 715,827,881 faces: half-edges are counted in 31 bits.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Result<Self, InvalidMesh> {
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(InvalidMesh::NotFinite { row, value: positions[row] });
        }
        if positions.len() >= u32::MAX as usize {
            return Err(InvalidMesh::TooManyPositions(positions.len()));
        }
        if faces.len() > MAX_HALF_EDGES / 3 {
            return Err(InvalidMesh::TooManyFaces(faces.len()));
        }
        let limit = positions.len() as u32;
        if let Some(face) = faces.iter().position(|f| f.iter().any(|i| *i >= limit)) {
            let index = faces[face].into_iter().find(|i| *i >= limit).unwrap_or(limit);
            return Err(InvalidMesh::IndexOutOfRange { face, index, limit });
        }
        Ok(Self { positions, faces, position_id: None, attributes: Vec::new() })
    }

    /// A mesh whose caller guarantees finite positions, valid indices and counts within the limits. A second
    /// check would take a third of the time that meshing a volume takes.
    pub(crate) fn by_construction(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Self {
        debug_assert!(Self::new(positions.clone(), faces.clone()).is_ok(), "the maker's proof is broken");
        Self { positions, faces, position_id: None, attributes: Vec::new() }
    }

    /// The same mesh with vertices linked by position: row i belongs to position `id[i]`. Rows with the same
    /// id have bit-identical positions.
    ///
    /// # Errors
    /// [`InvalidMesh`] when the length differs from the number of positions, an id is not below that number,
    /// or two rows of one id differ.
    pub fn with_position_id(mut self, id: Vec<u32>) -> Result<Self, InvalidMesh> {
        if id.len() != self.positions.len() {
            return Err(InvalidMesh::Length {
                what: "position_id",
                rows: id.len(),
                expected: self.positions.len(),
            });
        }
        let bits = |row: usize| {
            let [x, y, z] = self.positions[row];
            [x.to_bits(), y.to_bits(), z.to_bits()]
        };
        // Shortcut: if every id is the index of a row with the same position, as ids usually are, rows of one
        // id are equal.
        let is_row = |(row, i): (usize, &u32)| (*i as usize) < id.len() && bits(*i as usize) == bits(row);
        if !id.iter().enumerate().all(is_row) {
            let mut first_rows: Vec<Option<u32>> = vec![None; id.len()];
            for (row, &i) in id.iter().enumerate() {
                let first = first_rows.get_mut(i as usize).ok_or(InvalidMesh::PositionId { row })?;
                if bits(*first.get_or_insert(row as u32) as usize) != bits(row) {
                    return Err(InvalidMesh::PositionId { row });
                }
            }
        }
        self.position_id = Some(id);
        Ok(self)
    }

    /// The same mesh with another attribute.
    ///
    /// # Errors
    /// [`InvalidMesh::Length`] when the number of values does not fit the domain.
    pub fn with_attribute(mut self, attribute: Attribute) -> Result<Self, InvalidMesh> {
        let rows = match attribute.domain {
            Domain::Vertex => self.positions.len(),
            Domain::Corner => 3 * self.faces.len(),
            Domain::Face => self.faces.len(),
        };
        if attribute.values.len() != rows * attribute.width {
            return Err(InvalidMesh::Length {
                what: "attribute",
                rows: attribute.values.len(),
                expected: rows * attribute.width,
            });
        }
        self.attributes.push(attribute);
        Ok(self)
    }

    /// The same triangles with only these attributes.
    ///
    /// # Errors
    /// As for [`Mesh::with_attribute`].
    pub fn with_only(&self, attributes: impl IntoIterator<Item = Attribute>) -> Result<Self, InvalidMesh> {
        let bare = Self {
            positions: self.positions.clone(),
            faces: self.faces.clone(),
            position_id: self.position_id.clone(),
            attributes: Vec::new(),
        };
        attributes.into_iter().try_fold(bare, Self::with_attribute)
    }

    /// The coordinates and the indices; attributes and position ids are dropped.
    #[cfg(feature = "booleans")]
    pub(crate) fn into_parts(self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        (self.positions, self.faces)
    }

    /// The coordinates, n × 3.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The indices into the positions, m × 3.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// For each vertex the id of its position; `None` if each vertex is its own position.
    #[must_use]
    pub fn position_id(&self) -> Option<&[u32]> {
        self.position_id.as_deref()
    }

    /// The position of vertex `index`.
    #[inline]
    #[must_use]
    pub fn position_of(&self, index: u32) -> u32 {
        self.position_id.as_ref().map_or(index, |id| id[index as usize])
    }

    /// The number of distinct positions.
    #[must_use]
    pub fn n_positions(&self) -> usize {
        let Some(id) = &self.position_id else { return self.positions.len() };
        let mut used = vec![false; id.len()];
        id.iter().for_each(|i| used[*i as usize] = true);
        used.iter().filter(|u| **u).count()
    }

    /// All attribute streams.
    #[must_use]
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// The first attribute with this meaning.
    #[must_use]
    pub fn attribute(&self, semantic: &Semantic) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.semantic == *semantic)
    }

    /// The three corners of a face.
    #[inline]
    #[must_use]
    pub fn corners(&self, face: usize) -> [[f64; 3]; 3] {
        let [a, b, c] = self.faces[face];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The rows used by some faces, in ascending order.
    pub(crate) fn rows_of(&self, faces: &[u32]) -> Vec<u32> {
        let mut rows: Vec<u32> = faces.iter().flat_map(|face| self.faces[*face as usize]).collect();
        rows.sort_unstable();
        rows.dedup();
        rows
    }

    /// Some faces and the rows that they use, both ascending; attributes and position ids are dropped.
    pub(crate) fn some_faces(&self, faces: &[u32], rows: &[u32]) -> Self {
        let new_index = |row: u32| rows.partition_point(|other| *other < row) as u32;
        let positions = rows.iter().map(|row| self.positions[*row as usize]).collect();
        let faces = faces.iter().map(|face| self.faces[*face as usize].map(new_index)).collect();
        Self::by_construction(positions, faces)
    }

    /// The bounding box of the positions.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        Box3::from_points(&self.positions)
    }

    /// The same topology and attributes with other positions, for example after rounding to the written
    /// precision.
    ///
    /// # Errors
    /// [`InvalidMesh`] when their number differs, one is not finite, or vertices with the same position id
    /// separate.
    pub fn with_positions(&self, positions: Vec<[f64; 3]>) -> Result<Self, InvalidMesh> {
        if positions.len() != self.positions.len() {
            return Err(InvalidMesh::Length {
                what: "positions",
                rows: positions.len(),
                expected: self.positions.len(),
            });
        }
        let mut mesh = Self::new(positions, self.faces.clone())?;
        if let Some(id) = &self.position_id {
            mesh = mesh.with_position_id(id.clone())?;
        }
        mesh.attributes.clone_from(&self.attributes);
        Ok(mesh)
    }
}

/// The reason why arrays do not form a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum InvalidMesh {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Its row in `positions`.
        row: usize,
        /// The value in that row.
        value: [f64; 3],
    },
    /// A face refers to a position that does not exist.
    IndexOutOfRange {
        /// The row of `faces`.
        face: usize,
        /// The index.
        index: u32,
        /// The number of positions.
        limit: u32,
    },
    /// More positions than u32 indices can address.
    TooManyPositions(usize),
    /// More faces than 31-bit half-edge indices can address.
    TooManyFaces(usize),
    /// An array has the wrong length.
    Length {
        /// The name of the array.
        what: &'static str,
        /// Its length.
        rows: usize,
        /// The expected length.
        expected: usize,
    },
    /// A row of `position_id` is out of range or links two different positions.
    PositionId {
        /// The row.
        row: usize,
    },
}

impl fmt::Display for InvalidMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { row, value } => write!(f, "position {row} is not finite: {value:?}"),
            Self::IndexOutOfRange { face, index, limit } => {
                write!(f, "face {face} names position {index}, but there are only {limit}")
            }
            Self::TooManyPositions(n) => write!(f, "{n} positions are more than 32-bit indices can name"),
            Self::TooManyFaces(n) => write!(f, "{n} faces have more edges than 31 bits can number"),
            Self::Length { what, rows, expected } => {
                write!(f, "{what} has {rows} values where {expected} are needed")
            }
            Self::PositionId { row } => {
                write!(f, "position_id row {row} is out of range or ties different positions")
            }
        }
    }
}

impl std::error::Error for InvalidMesh {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_link_rows_of_one_position_whatever_their_numbers() {
        let [p, q] = [[1.0, 2.0, 3.0], [0.0; 3]];
        let with = |rows: &[[f64; 3]], id: &[u32]| {
            Mesh::new(rows.to_vec(), Vec::new()).and_then(|mesh| mesh.with_position_id(id.to_vec()))
        };
        // The ids may be those of rows at their position, or any other numbers.
        for id in [[0, 0, 2], [1, 1, 2], [2, 2, 0], [0, 1, 2], [2, 1, 0]] {
            assert_eq!(with(&[p, p, q], &id).unwrap().position_id(), Some(&id[..]));
        }
        for (id, row) in [([0, 0, 0], 2), ([0, 2, 2], 2), ([1, 1, 3], 2), ([5, 0, 0], 0)] {
            assert_eq!(with(&[p, p, q], &id), Err(InvalidMesh::PositionId { row }), "{id:?}");
        }
        // The zeros differ in a bit.
        assert_eq!(with(&[q, [-0.0; 3]], &[0, 0]), Err(InvalidMesh::PositionId { row: 1 }));
    }
}
