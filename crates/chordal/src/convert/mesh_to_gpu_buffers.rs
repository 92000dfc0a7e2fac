//! The arrow from a mesh to GPU buffers: single precision about an origin, small indices, cache-friendly
//! orders.
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode};
use crate::explicit::{Mesh, acmr, cache_order, fetch_order};
use crate::math::{Box3, DoubleDouble, add_up, mul_up, sqrt_up};

/// Vertex indices, of the smallest type that fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum IndexBuffer {
    /// If [`IndexBuffer::fit_16_bits`].
    U16(Vec<[u16; 3]>),
    /// For any number of vertices.
    U32(Vec<[u32; 3]>),
}

impl IndexBuffer {
    /// Whether the indices of `n_vertices` fit 16 bits: up to 65,535 vertices, whose last index is 65,534.
    /// Graphics processors take the last 16-bit number as "restart".
    #[must_use]
    pub fn fit_16_bits(n_vertices: usize) -> bool {
        n_vertices <= usize::from(u16::MAX)
    }

    fn new(faces: Vec<[u32; 3]>, n_vertices: usize) -> Self {
        if Self::fit_16_bits(n_vertices) {
            Self::U16(faces.into_iter().map(|face| face.map(|v| v as u16)).collect())
        } else {
            Self::U32(faces)
        }
    }

    /// The number of triangles.
    #[must_use]
    pub fn n_triangles(&self) -> usize {
        match self {
            Self::U16(faces) => faces.len(),
            Self::U32(faces) => faces.len(),
        }
    }

    /// One triangle.
    ///
    /// # Panics
    /// If `index` is out of range.
    #[must_use]
    pub fn triangle(&self, index: usize) -> [u32; 3] {
        match self {
            Self::U16(faces) => faces[index].map(u32::from),
            Self::U32(faces) => faces[index],
        }
    }
}

/// The buffers that a graphics processor draws.
#[derive(Clone, Debug, PartialEq)]
pub struct GpuBuffers {
    /// The origin of the positions: add it in the transform of the part.
    pub origin: [f64; 3],
    /// n × 3, relative to the origin, in the mesh's unit: 12 bytes a vertex, in the order in which triangles
    /// first use them.
    pub positions: Vec<[f32; 3]>,
    /// m × 3: 6 bytes a triangle, or 12.
    pub indices: IndexBuffer,
    /// For each vertex its row in the mesh, for attributes.
    pub source_vertex: Vec<u32>,
    /// For each triangle its row in the mesh.
    pub source_face: Vec<u32>,
}

impl GpuBuffers {
    /// The bytes of positions and indices: 12·V + 6·T, or 12·V + 12·T.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let index = match self.indices {
            IndexBuffer::U16(_) => 6,
            IndexBuffer::U32(_) => 12,
        };
        12 * self.positions.len() as u64 + index * self.indices.n_triangles() as u64
    }

    /// The bytes of the same triangles without indices: 36·T.
    #[must_use]
    pub fn unindexed_bytes(&self) -> u64 {
        36 * self.indices.n_triangles() as u64
    }

    /// The average number of vertices transformed for each triangle, with a first-in, first-out cache of the given
    /// size: [`acmr`].
    #[must_use]
    pub fn acmr(&self, cache: u32) -> f64 {
        let faces: Vec<_> = (0..self.indices.n_triangles()).map(|i| self.indices.triangle(i)).collect();
        acmr(&faces, cache)
    }
}

/// Turns a mesh into buffers for a graphics processor. Positions are in single precision about the middle of
/// the mesh's box, indices have 16 bits while they fit, triangles are in the order of [`cache_order`],
/// vertices in that of [`fetch_order`].
///
/// **Bound.** Two-sided Hausdorff distance between the mesh and `origin + positions`, taken exactly,
/// *proved*: a point moves no farther than the corners of its triangle, whose displacements are computed
/// exactly and rounded up. Unused vertices are left out. Attributes stay with the mesh;
/// `source_vertex` gives their rows. There is no budget: the bound is always about 2⁻²⁵ of the size of the
/// part.
///
/// **Cost.** O(n), about 0.3 µs a triangle.
///
/// # Errors
/// [`Failure::Refused`] for a mesh without triangles, and for one so large that its corners leave the range
/// of f32 about the middle; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Job, Mesh, convert};
/// let far = vec![[1e6, 0.0, 0.1], [1e6 + 1.0, 0.0, 0.1], [1e6, 1.0, 0.1]];
/// let mesh = Mesh::new(far, vec![[0, 1, 2]]).unwrap();
/// let bounded = convert::gpu::mesh_to_gpu_buffers(&mesh, &Job::default()).unwrap();
/// assert_eq!((bounded.shape.origin, bounded.shape.bytes()), ([1e6 + 0.5, 0.5, 0.1], 3 * 12 + 6));
/// assert_eq!(bounded.bound.at_most(), Some(0.0));
/// ```
pub fn mesh_to_gpu_buffers(mesh: &Mesh, job: &Job) -> Result<Bounded<GpuBuffers>, Failure<GpuBuffers>> {
    if mesh.faces().is_empty() {
        return Err(Failure::refused(RefusalCode::Empty, "the mesh has no triangles"));
    }
    // 1. Triangles, then vertices.
    let source_face = cache_order(mesh.faces());
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let drawn: Vec<[u32; 3]> = source_face.iter().map(|face| mesh.faces()[*face as usize]).collect();
    let source_vertex = fetch_order(&drawn);
    let mut renamed = vec![0_u32; mesh.positions().len()];
    source_vertex.iter().zip(0..).for_each(|(old, new)| renamed[*old as usize] = new);
    let faces: Vec<[u32; 3]> = drawn.into_iter().map(|face| face.map(|v| renamed[v as usize])).collect();
    // 2. Positions about the middle, and the largest displacement.
    let corner = |old: &u32| mesh.positions()[*old as usize];
    let bounds = source_vertex.iter().map(corner).fold(Box3::EMPTY, Box3::with);
    let origin = bounds.centre();
    let mut positions = Vec::with_capacity(source_vertex.len());
    let (mut most, mut at) = (0.0, None);
    for p in source_vertex.iter().map(corner) {
        let offset: [f32; 3] = std::array::from_fn(|k| (p[k] - origin[k]) as f32);
        if !offset.iter().all(|x| x.is_finite()) {
            return Err(Failure::refused(
                RefusalCode::NotFinite,
                format!("the corner {p:?} is beyond the range of single precision about {origin:?}"),
            ));
        }
        let moved = displacement(p, origin, offset);
        if moved > most {
            (most, at) = (moved, Some(p));
        }
        positions.push(offset);
    }
    let mut bound = Bound::proved(0.0, most, Reference::InputTriangles);
    bound.at = at;
    let indices = IndexBuffer::new(faces, positions.len());
    Ok(Bounded { shape: GpuBuffers { origin, positions, indices, source_vertex, source_face }, bound })
}

/// The distance of `origin + offset` from `p`, rounded up; exactly 0 if they are equal.
fn displacement(p: [f64; 3], origin: [f64; 3], offset: [f32; 3]) -> f64 {
    // Adding zero rounds nothing.
    let sum = |a: f64, b: f64| if a == 0.0 || b == 0.0 { a + b } else { add_up(a, b) };
    let mut square = 0.0;
    for k in 0..3 {
        // The difference is exact as a sum of two numbers; its remainder is rounded once more.
        let d = DoubleDouble::two_sum(p[k], -origin[k]);
        let remainder = DoubleDouble::two_sum(d.hi, -f64::from(offset[k]));
        let distance = sum(sum(remainder.hi.abs(), remainder.lo.abs()), d.lo.abs());
        if distance > 0.0 {
            square = sum(square, mul_up(distance, distance));
        }
    }
    if square > 0.0 { sqrt_up(square) } else { 0.0 }
}
