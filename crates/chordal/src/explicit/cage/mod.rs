//! `Cage`: a control mesh of polygons with tags for subdivision.
mod creases;
pub(crate) mod edges;
mod face_sizes;
mod grids;
pub(crate) mod limit;
mod quads;
mod refinement;
mod refinement_step;
mod rows;
mod sharpness;
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

/// The rules by which a cage is refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Any polygons; every round makes quads. The limit is a bicubic B-spline in regions where four quads
    /// meet at each vertex.
    #[default]
    CatmullClark,
    /// Triangles; every round splits each into four. The limit is a quartic box spline in regions where six
    /// meet.
    Loop,
    /// Any polygons, split into quads without smoothing.
    Bilinear,
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Self; 3] = [Self::CatmullClark, Self::Loop, Self::Bilinear];

    /// Its name in options and reports.
    ///
    /// ```
    /// use chordal::explicit::subdivision::Scheme;
    /// assert_eq!(Scheme::CatmullClark.name(), "catmull-clark");
    /// ```
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::CatmullClark => "catmull-clark",
            Self::Loop => "loop",
            Self::Bilinear => "bilinear",
        }
    }

    /// Whether it takes and makes triangles instead of polygons and quads.
    #[must_use]
    pub const fn is_for_triangles(self) -> bool {
        match self {
            Self::CatmullClark | Self::Bilinear => false,
            Self::Loop => true,
        }
    }
}

/// The treatment of the border of an open cage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// Faces with a vertex on the border have no surface, but shape that of the others.
    None,
    /// The border is a smooth curve with rounded corners.
    #[default]
    EdgeOnly,
    /// The border is a smooth curve that interpolates its vertices that have only one face.
    EdgeAndCorner,
}

/// How a semi-sharp edge loses its sharpness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CreasingMethod {
    /// By 1 per round, on each edge independently.
    #[default]
    Uniform,
    /// By 1 per round, with a quarter of the mean of the other edges around the same vertex: sharpness
    /// changes smoothly along a crease.
    Chaikin,
}

/// Sharpness from this value on never decreases. The number is OpenSubdiv's.
pub const INFINITELY_SHARP: f64 = 10.0;

/// A polygon mesh that controls the smooth surface to which its refinement converges.
///
/// Faces are lists of three or more vertices, counter-clockwise seen from their front. Edges and vertices may
/// be sharp: for as many rounds as their sharpness, where a fraction counts as part of a round, and forever
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
    /// The number of corners of each face.
    sizes: FaceSizes,
    corners: Vec<u32>,
    scheme: Scheme,
    boundary: Boundary,
    creasing: CreasingMethod,
    /// Edges with their sharpness, above 0: the lower vertex first, in ascending order.
    creases: Vec<([u32; 2], f64)>,
    /// Vertices with their sharpness, in ascending order.
    sharp_vertices: Vec<(u32, f64)>,
    /// Faces without surface, in ascending order.
    holes: Vec<u32>,
    /// Whether it is the result of a round, which has listed all corners that are sharp by topology.
    is_refined: bool,
    texcoords: Option<CornerTexcoords>,
}

impl Cage {
    /// A Catmull–Clark cage without creases.
    ///
    /// # Errors
    /// [`InvalidCage`] when a coordinate is not finite, an index is out of range, a face has fewer than three
    /// vertices or repeats one, or there are too many to count in 31 bits.
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
        // By vertex the last face that has used it, so that a repeated one is found in one pass.
        let mut last = vec![u32::MAX; cage.positions.len()];
        for (face, vertices) in cage.faces().enumerate() {
            if vertices.len() < 3 {
                return Err(InvalidCage::ShortFace { face });
            }
            for &index in vertices {
                let limit = cage.positions.len() as u32;
                let last_face = last.get_mut(index as usize).ok_or(InvalidCage::IndexOutOfRange {
                    face,
                    index,
                    limit,
                })?;
                if *last_face == face as u32 {
                    return Err(InvalidCage::VertexTwice { face, index });
                }
                *last_face = face as u32;
            }
        }
        Ok(cage)
    }

    /// The same cage with another scheme.
    ///
    /// # Errors
    /// [`InvalidCage::NotTriangles`] for [`Scheme::Loop`] if a face is not a triangle.
    pub fn with_scheme(mut self, scheme: Scheme) -> Result<Self, InvalidCage> {
        if scheme == Scheme::Loop
            && let Some(face) = self.faces().position(|vertices| vertices.len() != 3)
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

    /// The same cage with these creases only. If an edge occurs twice, the last one counts.
    ///
    /// # Errors
    /// [`InvalidCage::NoSuchEdge`] for an edge of no face, and [`InvalidCage::Sharpness`] if it is negative
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

    /// The same cage with these sharp vertices only. If a vertex occurs twice, the last one counts.
    ///
    /// # Errors
    /// [`InvalidCage::NoSuchVertex`], and [`InvalidCage::Sharpness`] if it is negative or NaN.
    pub fn with_sharp_vertices(mut self, vertices: &[(u32, f64)]) -> Result<Self, InvalidCage> {
        let mut sharpness = std::collections::BTreeMap::new();
        for &(index, sharp) in vertices {
            if index as usize >= self.positions.len() {
                return Err(InvalidCage::NoSuchVertex { index });
            }
            sharpness.insert(index, checked(sharp)?);
        }
        self.sharp_vertices = sharpness.into_iter().filter(|(_, sharp)| *sharp > 0.0).collect();
        Ok(self)
    }

    /// The same cage with these faces as its holes: they have no surface, but shape that of the others.
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

    /// The same cage, treated as the result of a round: vertices that are corners by topology are corners
    /// only if they are listed.
    #[must_use]
    pub fn with_corners_listed(mut self) -> Self {
        self.is_refined = true;
        self
    }

    /// Whether vertices that are corners by topology are corners only if they are listed, as in the result of
    /// a round.
    #[must_use]
    pub fn lists_corners(&self) -> bool {
        self.is_refined
    }

    /// The coordinates, n × 3.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The number of faces, including holes.
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

    /// The index of the first corner of a face.
    pub(crate) fn begin(&self, face: usize) -> usize {
        self.sizes.range(face).start
    }

    /// All faces, including holes, in order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.n_faces()).map(|face| self.face(face))
    }

    /// Edges with their sharpness: the lower vertex first, in ascending order. The border is not listed: it
    /// is always sharp.
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

    /// The refinement rules.
    #[must_use]
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The treatment of the border.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// The rule by which sharpness decreases.
    #[must_use]
    pub fn creasing(&self) -> CreasingMethod {
        self.creasing
    }
}

/// The most vertices, and corners of faces. Derived: half-edges are counted in 31 bits.
const MOST: usize = (1 << 31) - 4;

fn checked(sharp: f64) -> Result<f64, InvalidCage> {
    if sharp >= 0.0 { Ok(sharp) } else { Err(InvalidCage::Sharpness { sharp }) }
}

/// The reason why polygons do not form a cage.
#[derive(Clone, Debug, PartialEq)]
pub enum InvalidCage {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The vertex.
        row: usize,
    },
    /// A face refers to a vertex that does not exist.
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index.
        index: u32,
        /// The number of vertices.
        limit: u32,
    },
    /// A face has fewer than three vertices.
    ShortFace {
        /// The face.
        face: usize,
    },
    /// A face repeats a vertex.
    VertexTwice {
        /// The face.
        face: usize,
        /// The vertex.
        index: u32,
    },
    /// Loop subdivision of a face that is not a triangle.
    NotTriangles {
        /// The face.
        face: usize,
    },
    /// A crease that is not an edge.
    NoSuchEdge {
        /// Its vertices.
        ends: [u32; 2],
    },
    /// A sharp vertex that does not exist.
    NoSuchVertex {
        /// Its index.
        index: u32,
    },
    /// A hole that does not exist.
    NoSuchFace {
        /// Its index.
        face: u32,
    },
    /// A sharpness that is negative or NaN.
    Sharpness {
        /// The value.
        sharp: f64,
    },
    /// The numbers of values and vertices differ.
    WrongCount {
        /// The expected number.
        expected: usize,
        /// The actual number.
        found: usize,
    },
    /// The numbers of rows of texture coordinates and of corners differ.
    WrongCorners {
        /// The number of corners.
        expected: usize,
        /// The number of rows.
        found: usize,
    },
    /// A corner refers to texture coordinates that do not exist.
    NoSuchTexcoord {
        /// The row.
        row: u32,
    },
    /// Texture coordinates that are NaN or infinite.
    TexcoordNotFinite {
        /// The row.
        row: usize,
    },
    /// More elements than can be counted.
    TooMany {
        /// The kind of elements.
        what: &'static str,
        /// The largest allowed number.
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
