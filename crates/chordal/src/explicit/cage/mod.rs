//! `Cage`: a polygon mesh with what subdivision asks of it.
mod creases;
pub(crate) mod edges;
mod face_sizes;
mod grids;
pub(crate) mod limit;
mod quads;
mod refinement;
mod refinement_step;
mod rows;
mod stencils;
mod texcoords;
mod triangles;
mod values;
mod vertex_rule;

use edges::CageEdges;
use face_sizes::FaceSizes;
pub use refinement::Refinement;
use std::fmt;
pub use texcoords::{Chart, CornerTexcoords, LinearTexcoords};
pub use values::Real;

/// By which rules a cage is refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Any polygons; every round makes quads. The limit is a bicubic B-spline where four quads meet at each
    /// vertex.
    #[default]
    CatmullClark,
    /// Triangles; every round cuts each into four. The limit is a quartic box spline where six meet.
    Loop,
    /// Any polygons, cut into quads and left as they are.
    Bilinear,
}

/// What becomes of the border of an open cage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// Faces with a vertex on the border carry no surface; they shape that of the others.
    None,
    /// The border is a smooth curve, its corners rounded.
    #[default]
    EdgeOnly,
    /// The border is a smooth curve through those of its vertices that one face alone uses.
    EdgeAndCorner,
}

/// How the sharpness of an edge that is no longer than some rounds falls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CreasingMethod {
    /// By 1 a round, on each edge by itself.
    #[default]
    Uniform,
    /// By 1 a round, with a quarter of the others' around the same vertex: it changes smoothly along a
    /// crease.
    Chaikin,
}

/// A sharpness from which on it never falls. The number is OpenSubdiv's.
pub const INFINITELY_SHARP: f64 = 10.0;

/// A polygon mesh that stands for the smooth surface to which its refinement converges.
///
/// Faces are lists of three vertices or more, counter-clockwise from their front. Edges and vertices may be
/// sharp: for as many rounds as their sharpness says, a fraction counting as part of a round, and for ever
/// from [`INFINITELY_SHARP`] on.
///
/// ```
/// use chordal::explicit::Cage;
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let once = cube.refined()?;
/// assert_eq!((once.positions().len(), once.n_faces()), (26, 24));
/// // A corner goes to 5/9 of itself: (n − 3)/n of it, 2/n of its edges' middles, 1/n of its faces' with n = 3.
/// assert!((once.positions()[0][0] + 5.0 / 9.0).abs() < 1e-15); // rounding
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
///
/// Sources: E. Catmull, J. Clark, *Recursively generated B-spline surfaces on arbitrary topological meshes*,
/// 1978; C. Loop, *Smooth subdivision surfaces based on triangles*, 1987; T. DeRose, M. Kass, T. Truong,
/// *Subdivision surfaces in character animation*, 1998, for sharpness; the rules where those leave a choice
/// are OpenSubdiv's (its `sdc` and `far`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cage {
    positions: Vec<[f64; 3]>,
    /// How many corners each face has.
    sizes: FaceSizes,
    corners: Vec<u32>,
    scheme: Scheme,
    boundary: Boundary,
    creasing: CreasingMethod,
    /// Edges with their sharpness, above 0: the lower vertex first, in ascending order.
    creases: Vec<([u32; 2], f64)>,
    /// Vertices with theirs, in ascending order.
    sharp_vertices: Vec<(u32, f64)>,
    /// Faces without surface, in ascending order.
    holes: Vec<u32>,
    /// Whether it came from a round, in which what is a corner by nature was listed as one.
    is_refined: bool,
    texcoords: Option<CornerTexcoords>,
}

impl Cage {
    /// A Catmull–Clark cage without creases.
    ///
    /// # Errors
    /// [`InvalidCage`] when a coordinate is not finite, an index out of range, a face has fewer than three
    /// vertices or one twice, or there are too many to count in 31 bits.
    pub fn new<F: AsRef<[u32]>>(
        positions: Vec<[f64; 3]>,
        faces: impl IntoIterator<Item = F>,
    ) -> Result<Self, InvalidCage> {
        let (mut ends, mut corners) = (Vec::new(), Vec::new());
        for face in faces {
            corners.extend_from_slice(face.as_ref());
            ends.push(corners.len() as u32);
            if corners.len() > MOST {
                return Err(InvalidCage::TooMany { what: "corners", most: MOST });
            }
        }
        if positions.len() > MOST {
            return Err(InvalidCage::TooMany { what: "vertices", most: MOST });
        }
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(InvalidCage::NotFinite { row });
        }
        let cage = Self { positions, sizes: FaceSizes::from_ends(ends), corners, ..Self::default() };
        let mut last = vec![u32::MAX; cage.positions.len()];
        for (face, of) in cage.faces().enumerate() {
            if of.len() < 3 {
                return Err(InvalidCage::ShortFace { face });
            }
            for &index in of {
                let limit = cage.positions.len() as u32;
                let seen = last.get_mut(index as usize).ok_or(InvalidCage::IndexOutOfRange {
                    face,
                    index,
                    limit,
                })?;
                if *seen == face as u32 {
                    return Err(InvalidCage::VertexTwice { face, index });
                }
                *seen = face as u32;
            }
        }
        Ok(cage)
    }

    /// The same cage by another scheme.
    ///
    /// # Errors
    /// [`InvalidCage::NotTriangles`] for [`Scheme::Loop`] where a face is none.
    pub fn with_scheme(mut self, scheme: Scheme) -> Result<Self, InvalidCage> {
        if scheme == Scheme::Loop
            && let Some(face) = self.faces().position(|of| of.len() != 3)
        {
            return Err(InvalidCage::NotTriangles { face });
        }
        self.scheme = scheme;
        Ok(self)
    }

    /// The same cage with another rule for its border.
    #[must_use]
    pub fn with_boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = boundary;
        self
    }

    /// The same cage with another rule for sharpness.
    #[must_use]
    pub fn with_creasing(mut self, creasing: CreasingMethod) -> Self {
        self.creasing = creasing;
        self
    }

    /// The same cage with these edges as sharp as said, and no others. Of an edge that comes twice the last
    /// counts.
    ///
    /// # Errors
    /// [`InvalidCage::NoSuchEdge`] where no face has it, and [`InvalidCage::Sharpness`] where it is negative
    /// or NaN.
    pub fn with_creases(mut self, creases: &[([u32; 2], f64)]) -> Result<Self, InvalidCage> {
        let edges = CageEdges::new(&self);
        let mut sharpness = vec![0.0; edges.ends.len()];
        for &([a, b], sharp) in creases {
            let edge = edges.between(a, b).ok_or(InvalidCage::NoSuchEdge { ends: [a, b] })?;
            sharpness[edge as usize] = checked(sharp)?;
        }
        self.creases = edges.sharp_edges(&sharpness);
        Ok(self)
    }

    /// The same cage with these vertices as sharp as said, and no others. Of one that comes twice the last
    /// counts.
    ///
    /// # Errors
    /// [`InvalidCage::NoSuchVertex`], and [`InvalidCage::Sharpness`] where it is negative or NaN.
    pub fn with_sharp_vertices(mut self, vertices: &[(u32, f64)]) -> Result<Self, InvalidCage> {
        let mut all = std::collections::BTreeMap::new();
        for &(index, sharp) in vertices {
            if index as usize >= self.positions.len() {
                return Err(InvalidCage::NoSuchVertex { index });
            }
            all.insert(index, checked(sharp)?);
        }
        self.sharp_vertices = all.into_iter().filter(|(_, sharp)| *sharp > 0.0).collect();
        Ok(self)
    }

    /// The same cage whose faces of these numbers carry no surface, and shape that of the others.
    ///
    /// # Errors
    /// [`InvalidCage::NoSuchFace`].
    pub fn with_holes(mut self, holes: &[u32]) -> Result<Self, InvalidCage> {
        if let Some(&face) = holes.iter().find(|face| **face as usize >= self.n_faces()) {
            return Err(InvalidCage::NoSuchFace { face });
        }
        self.holes = holes.to_vec();
        self.holes.sort_unstable();
        self.holes.dedup();
        Ok(self)
    }

    /// The same cage as one that came from a round: what is a corner by nature is one where it is listed, and
    /// only there.
    #[must_use]
    pub fn with_corners_listed(mut self) -> Self {
        self.is_refined = true;
        self
    }

    /// Whether what is a corner by nature is one only where it is listed, as in a cage that came from a
    /// round.
    #[must_use]
    pub fn lists_corners(&self) -> bool {
        self.is_refined
    }

    /// n × 3.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// How many faces there are, with holes.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        self.sizes.len()
    }

    /// The vertices of one face.
    ///
    /// # Panics
    /// When there is no such face.
    #[must_use]
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.sizes.range(face)]
    }

    /// Where the corners of a face begin.
    pub(crate) fn begin(&self, face: usize) -> usize {
        self.sizes.range(face).start
    }

    /// All faces, with holes, in order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.n_faces()).map(|face| self.face(face))
    }

    /// Edges with their sharpness: the lower vertex first, in ascending order. The border is not listed: it
    /// always is sharp.
    #[must_use]
    pub fn creases(&self) -> &[([u32; 2], f64)] {
        &self.creases
    }

    /// Vertices with their sharpness, in ascending order.
    #[must_use]
    pub fn sharp_vertices(&self) -> &[(u32, f64)] {
        &self.sharp_vertices
    }

    /// Faces without surface, in ascending order.
    #[must_use]
    pub fn holes(&self) -> &[u32] {
        &self.holes
    }

    /// The rules.
    #[must_use]
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// What becomes of its border.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// How sharpness falls.
    #[must_use]
    pub fn creasing(&self) -> CreasingMethod {
        self.creasing
    }
}

/// Vertices, and corners of faces, that there may be: half-edges are counted in 31 bits.
const MOST: usize = (1 << 31) - 4;

fn checked(sharp: f64) -> Result<f64, InvalidCage> {
    if sharp >= 0.0 { Ok(sharp) } else { Err(InvalidCage::Sharpness { sharp }) }
}

/// Why polygons are no cage.
#[derive(Clone, Debug, PartialEq)]
pub enum InvalidCage {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The vertex.
        row: usize,
    },
    /// A face has an index that no vertex has.
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index.
        index: u32,
        /// How many vertices there are.
        limit: u32,
    },
    /// A face has fewer than three vertices.
    ShortFace {
        /// The face.
        face: usize,
    },
    /// A face has a vertex twice.
    VertexTwice {
        /// The face.
        face: usize,
        /// The vertex.
        index: u32,
    },
    /// Loop subdivision of a face that is no triangle.
    NotTriangles {
        /// The face.
        face: usize,
    },
    /// A crease where there is no edge.
    NoSuchEdge {
        /// Its vertices.
        ends: [u32; 2],
    },
    /// A sharp vertex that there is not.
    NoSuchVertex {
        /// Its number.
        index: u32,
    },
    /// A hole that there is not.
    NoSuchFace {
        /// Its number.
        face: u32,
    },
    /// A sharpness that is negative or NaN.
    Sharpness {
        /// It.
        sharp: f64,
    },
    /// Not as many values as vertices.
    WrongCount {
        /// How many there are to be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// Not as many rows of texture coordinates as corners.
    WrongCorners {
        /// How many corners there are.
        expected: usize,
        /// How many rows.
        found: usize,
    },
    /// A corner names texture coordinates that there are not.
    NoSuchTexcoord {
        /// The row.
        row: u32,
    },
    /// Texture coordinates that are NaN or infinite.
    TexcoordNotFinite {
        /// The row.
        row: usize,
    },
    /// More than can be counted.
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there may be.
        most: usize,
    },
}

impl fmt::Display for InvalidCage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { row } => write!(f, "vertex {row} has a coordinate that is not finite"),
            Self::IndexOutOfRange { face, index, limit } => {
                write!(f, "face {face} uses vertex {index}, but there are only {limit}")
            }
            Self::ShortFace { face } => write!(f, "face {face} has fewer than three vertices"),
            Self::VertexTwice { face, index } => write!(f, "face {face} uses vertex {index} twice"),
            Self::NotTriangles { face } => {
                write!(f, "face {face} is no triangle, and Loop subdivision takes nothing else")
            }
            Self::NoSuchEdge { ends: [a, b] } => {
                write!(f, "there is no edge between vertices {a} and {b} to be sharp")
            }
            Self::NoSuchVertex { index } => write!(f, "there is no vertex {index} to be sharp"),
            Self::NoSuchFace { face } => write!(f, "there is no face {face} to be a hole"),
            Self::Sharpness { sharp } => write!(f, "a sharpness is 0 or more, not {sharp}"),
            Self::WrongCount { expected, found } => {
                write!(f, "there are {found} values for {expected} vertices")
            }
            Self::WrongCorners { expected, found } => {
                write!(f, "there are rows of texture coordinates for {found} corners, but {expected} corners")
            }
            Self::NoSuchTexcoord { row } => write!(f, "there are no texture coordinates in row {row}"),
            Self::TexcoordNotFinite { row } => {
                write!(f, "texture coordinates in row {row} are not finite")
            }
            Self::TooMany { what, most } => write!(f, "there are more than {most} {what}"),
        }
    }
}

impl std::error::Error for InvalidCage {}
