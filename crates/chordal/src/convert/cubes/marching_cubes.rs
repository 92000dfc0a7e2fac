//! Marching cubes in the manner of Flying Edges: classify, count, prefix-sum, then write everything in place.
//!
//! A row of samples owns the vertices on the lattice edges that begin at its samples. Its counts give every
//! vertex a number before any is computed. So slabs of the lattice are written on any thread without locks,
//! into parts of one array, with the same result on any number of threads.
//!
//! Source: W. Schroeder, R. Maynard, B. Geveci, *Flying Edges: a high-performance scalable isocontouring
//! algorithm*, 2015.
use super::caps;
use super::case_table::{CubeCase, TABLE};
use super::rule::{LatticeTransform, Polygonize};
use super::sign_bits::{KINDS, SignBits, planes};
use super::source::SampleSource;
use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map, par_map_owned};
use crate::implicit::Affine3;
use crate::math::simd::{self, Kernel};

/// A number type for positions.
pub trait Coordinate: Copy + Default + Send + Sync + 'static {
    /// The nearest number of this type.
    fn from_f64(x: f64) -> Self;
}

impl Coordinate for f64 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
}

impl Coordinate for f32 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as Self
    }
}

/// The triangles, and the plan that numbers their vertices.
pub(crate) struct Isosurface<P> {
    pub positions: Vec<[P; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub plan: MarchingPlan,
}

/// The position of every vertex and triangle in the output.
pub(crate) struct MarchingPlan {
    pub(super) bits: SignBits,
    slabs: Vec<LatticeSlab>,
    /// The first vertex of each kind in each row. Kinds: on a lattice edge along x, y or z, or on a cap
    /// (`sign_bits.rs`).
    starts: Vec<[u32; KINDS]>,
    /// The number of vertices.
    pub vertices: usize,
    /// The number of triangles, and how many of them are caps.
    pub triangles: usize,
    cap_triangles: usize,
}

/// The vertices and triangles that a few planes of samples, and the cells above them, add to the mesh.
struct LatticeSlab {
    /// Its first plane, and the plane after its last.
    planes: [usize; 2],
    /// Vertices of each kind in each row.
    rows: Vec<[u32; KINDS]>,
    /// The signs of the cells that the surface passes, row by row.
    cases: Vec<u8>,
    /// The number of entries in `cases` of each row of cells.
    cells: Vec<u32>,
    triangles: u64,
}

impl MarchingPlan {
    /// Classifies and counts.
    pub fn new<S: SampleSource>(source: &S, rule: &Polygonize, job: &Job) -> Result<Self, JobError> {
        let size = source.size();
        if SignBits::bytes(size) > job.memory_limit {
            return Err(refusal(
                RefusalCode::TooMuchMemory,
                format!(
                    "a bit for each of {} x {} x {} samples is more than the job's memory limit",
                    size[0], size[1], size[2]
                ),
            ));
        }
        let bits = SignBits::new(source, rule, job);
        let step = planes(size[2]);
        let ranges: Vec<[usize; 2]> =
            (0..size[2]).step_by(step).map(|k| [k, (k + step).min(size[2])]).collect();
        let slabs = par_map(job, &ranges, |_, planes| {
            if job.is_cancelled() {
                return LatticeSlab {
                    planes: *planes,
                    rows: vec![],
                    cases: vec![],
                    cells: vec![],
                    triangles: 0,
                };
            }
            simd::dispatch(simd::isa(), CountKernel { bits: &bits, planes: *planes })
        });
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let cap_triangles = caps::count(&bits);
        let vertices: u64 = slabs.iter().flat_map(|slab| &slab.rows).flatten().map(|n| u64::from(*n)).sum();
        let triangles = cap_triangles + slabs.iter().map(|slab| slab.triangles).sum::<u64>();
        let mut next = 0_u32;
        let mut starts = Vec::with_capacity(size[1] * size[2]);
        // More vertices would overflow the numbers; they are refused below.
        if vertices < u64::from(u32::MAX) {
            for counts in slabs.iter().flat_map(|slab| &slab.rows) {
                starts.push(counts.map(|n| {
                    let start = next;
                    next += n;
                    start
                }));
            }
        }
        let plan = Self {
            bits,
            slabs,
            starts,
            vertices: vertices as usize,
            triangles: triangles as usize,
            cap_triangles: cap_triangles as usize,
        };
        plan.check(job)?;
        Ok(plan)
    }

    /// Refuses a mesh beyond the limits of the job or of the index type.
    fn check(&self, job: &Job) -> Result<(), JobError> {
        let (vertices, triangles) = (self.vertices as u64, self.triangles as u64);
        if triangles > job.triangle_limit {
            let message =
                format!("the surface has {triangles} triangles; the limit is {}", job.triangle_limit);
            return Err(refusal(RefusalCode::TooManyTriangles, message));
        }
        // The limits of `Mesh`, whose half-edges are counted in 31 bits.
        if vertices >= u64::from(u32::MAX) || triangles > u64::from(u32::MAX) / 6 {
            let message =
                format!("{vertices} vertices and {triangles} triangles are more than one mesh can number");
            return Err(refusal(RefusalCode::TooManyTriangles, message));
        }
        let bytes = SignBits::bytes(self.bits.size) + 24 * vertices + 12 * triangles;
        if bytes > job.memory_limit {
            let message = format!("the mesh needs {bytes} bytes; the limit is {}", job.memory_limit);
            return Err(refusal(RefusalCode::TooMuchMemory, message));
        }
        Ok(())
    }

    /// Whether a sample is inside.
    pub(crate) fn is_inside(&self, index: [usize; 3]) -> bool {
        self.bits.is_inside(index)
    }

    /// The number of a vertex of a kind.
    pub(super) fn vertex(&self, kind: usize, index: [usize; 3]) -> u32 {
        self.starts[index[1] + self.bits.size[1] * index[2]][kind] + self.bits.rank(kind, index)
    }

    /// Makes an entry for each vertex, in their order.
    pub(crate) fn for_each_vertex<T: Clone + Default + Send + Sync>(
        &self,
        job: &Job,
        make: impl Fn(usize, [usize; 3]) -> T + Sync,
    ) -> Vec<T> {
        let mut all = vec![T::default(); self.vertices];
        par_map_owned(job, self.parts(&mut all), |(slab, part)| {
            let mut out = part.iter_mut();
            for_each_in_slab(&self.bits, slab.planes, |kind, index| {
                if let Some(out) = out.next() {
                    *out = make(kind, index);
                }
            });
        });
        all
    }

    /// Visits the triangles of the caps, which come after those of all cells: see [`caps::for_each_triangle`].
    pub(crate) fn for_each_cap_triangle(&self, each: impl FnMut(usize, usize, [usize; 2], u8)) {
        caps::for_each_triangle(&self.bits, each);
    }

    /// Splits an array with one entry a vertex into a part for each slab.
    fn parts<'a, T>(&'a self, all: &'a mut [T]) -> Vec<(&'a LatticeSlab, &'a mut [T])> {
        let mut rest = all;
        let mut parts = Vec::with_capacity(self.slabs.len());
        for slab in &self.slabs {
            let count: u64 = slab.rows.iter().flatten().map(|n| u64::from(*n)).sum();
            let (part, behind) = rest.split_at_mut(count as usize);
            parts.push((slab, part));
            rest = behind;
        }
        parts
    }

    /// Calls `work` for each slab on the job's threads, with the slab's number and a function that visits the
    /// cells of the slab that the surface passes, by their index and the signs of their corners.
    pub(crate) fn for_each_slab<R: Send>(
        &self,
        job: &Job,
        work: impl Fn(usize, &mut dyn FnMut(&mut dyn FnMut([usize; 3], u8))) -> R + Sync,
    ) -> Vec<R> {
        par_map(job, &self.slabs, |number, slab| {
            let mut walk = |each: &mut dyn FnMut([usize; 3], u8)| {
                for k in slab.planes[0]..slab.planes[1].min(self.bits.size[2] - 1) {
                    for j in 0..self.bits.size[1] - 1 {
                        self.bits.cases([j, k], |i, signs| each([i, j, k], signs));
                    }
                }
            };
            work(number, &mut walk)
        })
    }
}

/// Classifies, counts and writes.
pub(crate) fn march<P: Coordinate, S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    job: &Job,
) -> Result<Isosurface<P>, JobError> {
    let plan = MarchingPlan::new(source, rule, job)?;
    let transform = LatticeTransform::new(affine, rule.offset);
    let mut positions = vec![[P::default(); 3]; plan.vertices];
    let mut faces = vec![[0; 3]; plan.triangles];
    let cells = if affine.orientation() > 0 { &TABLE.upright } else { &TABLE.mirrored };
    // Slabs are written in parallel, each into its own part of the arrays.
    let mut rest = &mut faces[..];
    let mut work = Vec::with_capacity(plan.slabs.len());
    for (slab, positions) in plan.parts(&mut positions) {
        let (faces, behind) = rest.split_at_mut(slab.triangles as usize);
        work.push((slab, positions, faces));
        rest = behind;
    }
    debug_assert_eq!(rest.len(), plan.cap_triangles, "what is left is for caps");
    par_map_owned(job, work, |(slab, positions, faces)| {
        if !job.is_cancelled() {
            let written = SlabOutput { positions, faces };
            simd::dispatch(
                simd::isa(),
                WriteKernel { source, plan: &plan, slab, transform, rule, cells, written },
            );
        }
    });
    write_caps(&plan, affine, rest);
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    Ok(Isosurface { positions, faces, plan })
}

pub(crate) fn refusal(code: RefusalCode, message: String) -> JobError {
    JobError::Refused(Refusal::new(code, message))
}

struct CountKernel<'a> {
    bits: &'a SignBits,
    planes: [usize; 2],
}

impl Kernel for CountKernel<'_> {
    type Output = LatticeSlab;

    #[inline(always)]
    fn run(self) -> LatticeSlab {
        let Self { bits, planes } = self;
        let [_, ny, nz] = bits.size;
        let mut slab =
            LatticeSlab { planes, rows: Vec::new(), cases: Vec::new(), cells: Vec::new(), triangles: 0 };
        slab.rows.reserve(ny * (planes[1] - planes[0]));
        for k in planes[0]..planes[1] {
            for j in 0..ny {
                let mut counts = [0; KINDS];
                for (kind, count) in counts.iter_mut().enumerate() {
                    *count =
                        (0..bits.width()).map(|word| bits.vertices(kind, [j, k], word).count_ones()).sum();
                }
                slab.rows.push(counts);
                if j + 1 < ny && k + 1 < nz {
                    let before = slab.cases.len();
                    bits.cases([j, k], |_, signs| {
                        slab.triangles += u64::from(TABLE.upright[usize::from(signs)].triangles);
                        slab.cases.push(signs);
                    });
                    slab.cells.push((slab.cases.len() - before) as u32);
                }
            }
        }
        slab
    }
}

/// The part of the arrays that a slab fills.
struct SlabOutput<'a, P> {
    positions: &'a mut [[P; 3]],
    faces: &'a mut [[u32; 3]],
}

struct WriteKernel<'a, P, S> {
    source: &'a S,
    plan: &'a MarchingPlan,
    slab: &'a LatticeSlab,
    transform: LatticeTransform,
    rule: &'a Polygonize,
    cells: &'a [CubeCase; 256],
    written: SlabOutput<'a, P>,
}

impl<P: Coordinate, S: SampleSource> Kernel for WriteKernel<'_, P, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { source, plan, slab, transform, rule, cells, written } = self;
        write_faces(plan, slab, cells, written.faces);
        let mut out = written.positions.iter_mut();
        for_each_in_slab(&plan.bits, slab.planes, |kind, index| {
            let at = vertex_at(source, rule, &transform, kind, index);
            if let Some(out) = out.next() {
                *out = at.map(P::from_f64);
            }
        });
    }
}

/// The position of a vertex.
#[inline(always)]
pub(super) fn vertex_at<S: SampleSource + ?Sized>(
    source: &S,
    rule: &Polygonize,
    transform: &LatticeTransform,
    kind: usize,
    [i, j, k]: [usize; 3],
) -> [f64; 3] {
    let mut at = [transform.global(0, i), transform.global(1, j), transform.global(2, k)];
    if kind < 3 {
        let ahead = [i + usize::from(kind == 0), j + usize::from(kind == 1), k + usize::from(kind == 2)];
        at[kind] += rule.crossing(source.at([i, j, k]), source.at(ahead));
    }
    transform.at(at)
}

/// Visits the vertices of some planes of samples, in their order.
#[inline(always)]
fn for_each_in_slab(bits: &SignBits, planes: [usize; 2], mut each: impl FnMut(usize, [usize; 3])) {
    for k in planes[0]..planes[1] {
        for j in 0..bits.size[1] {
            for kind in 0..KINDS {
                for word in 0..bits.width() {
                    let mut left = bits.vertices(kind, [j, k], word);
                    while left != 0 {
                        each(kind, [64 * word + left.trailing_zeros() as usize, j, k]);
                        left &= left - 1;
                    }
                }
            }
        }
    }
}

/// Writes the triangles of a slab. Along a row of cells, the vertices on each cell edge come in order, so one
/// counter for each of the 12 edges numbers them. Cells that the surface does not pass are not in `cases`, and
/// have no vertices to count.
#[inline(always)]
fn write_faces(plan: &MarchingPlan, slab: &LatticeSlab, cells: &[CubeCase; 256], faces: &mut [[u32; 3]]) {
    let [_, ny, _] = plan.bits.size;
    let mut faces = faces.iter_mut();
    let mut cases = slab.cases.iter();
    for (row, count) in slab.cells.iter().enumerate() {
        if *count == 0 {
            continue;
        }
        let (j, k) = (row % (ny - 1), slab.planes[0] + row / (ny - 1));
        let starts = |j: usize, k: usize| plan.starts[j + ny * k];
        let [a, b, c, d] = [starts(j, k), starts(j + 1, k), starts(j, k + 1), starts(j + 1, k + 1)];
        // The edges at x and at x + 1 are in the same row of samples: `ahead` keeps their numbers apart.
        let mut next = [a[0], b[0], c[0], d[0], a[1], a[1], c[1], c[1], a[2], a[2], b[2], b[2]];
        for signs in cases.by_ref().take(*count as usize) {
            let case = &cells[usize::from(*signs)];
            let mut number = [0; 16];
            for edge in 0..12 {
                number[edge] = next[edge] + case.ahead[edge];
                next[edge] += case.grows[edge];
            }
            for (triangle, out) in case.corners[..usize::from(case.triangles)].iter().zip(faces.by_ref()) {
                // The mask changes no number; the compiler needs no bounds check with it.
                *out = triangle.map(|edge| number[usize::from(edge & 15)]);
            }
        }
    }
}

/// Writes the triangles of the caps.
fn write_caps(plan: &MarchingPlan, affine: &Affine3, faces: &mut [[u32; 3]]) {
    let upright = affine.orientation() > 0;
    let mut out = faces.iter_mut();
    caps::for_each_square(&plan.bits, |square| {
        let inside = square.map(|at| plan.bits.is_inside(at));
        let number = |spot: caps::CapVertex| match spot {
            caps::CapVertex::Corner(i) => plan.vertex(3, square[i]),
            caps::CapVertex::Side(i) => crossing(plan, square[i], square[(i + 1) % 4]),
        };
        caps::triangles(inside, number, |[a, b, c]| {
            if let Some(out) = out.next() {
                *out = if upright { [a, b, c] } else { [a, c, b] };
            }
        });
    });
}

/// The vertex between two neighbouring samples of different sides.
fn crossing(plan: &MarchingPlan, a: [usize; 3], b: [usize; 3]) -> u32 {
    let axis = (0..3).find(|&k| a[k] != b[k]).unwrap_or(0);
    plan.vertex(axis, if a[axis] < b[axis] { a } else { b })
}
