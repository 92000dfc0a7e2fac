//! The arrow from a volume of labels to a mesh for each label: `labels_to_meshes`, and `labels_to_blocks` for a part of one.
use super::cubes::bound::{IsosurfaceDistance, diagonal};
use super::cubes::caps::{CapVertex, triangles};
use super::cubes::case_table::{EDGES, TABLE};
use super::cubes::marching_cubes::refusal;
use super::cubes::mask_cells::{MaskCellBounds, MaskCells};
use super::cubes::rule::{Border, LatticeTransform, Polygonize};
use super::grid_blocks::{FaceKey, GridBlock};
use super::grid_to_mesh::{VertexKey, bound, check, vertex_errors};
use crate::budget::{Bound, Bounded, Evidence, Failure, Job, JobError, Progress, RefusalCode};
use crate::explicit::Mesh;
use crate::implicit::{Affine3, Grid, with_samples};
use crate::math::lesser;
use std::collections::BTreeMap;

/// How labels become meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LabelOptions {
    /// The label without a mesh.
    pub background: Option<u32>,
    /// Whether the shape is open or capped at the border of the lattice.
    pub border: [[Border; 2]; 3],
    /// As [`Polygonize::offset`].
    pub offset: [i64; 3],
}

impl Default for LabelOptions {
    /// No mesh for label 0, capped at the border.
    fn default() -> Self {
        Self { background: Some(0), border: [[Border::Capped; 2]; 3], offset: [0; 3] }
    }
}

/// Builds a mesh for each label of a volume, in the order of labels.
///
/// A label's mesh is that of [`grid_to_mesh`](super::grid_to_mesh) for a mask of 1 at its samples and 0
/// elsewhere, at level 0.5: each is closed and manifold, up to an open border. Every vertex is the midpoint
/// of a lattice edge between two labels, with the same bits in the meshes of both. Where three or more labels
/// meet in a cell, or two cross a face of a cell diagonally, their meshes leave a gap between them.
///
/// **Bound.** As for `grid_to_mesh`: to the boundary of the region where the interpolant of that mask is above 0.5, in
/// both directions; *proved*, once for each kind of cell of a label (`convert/cubes/mask_cells.rs`). Measured on cubes: a
/// tenth of a cell for one sample alone, and four fifths if corners of a label lie diagonally across cells.
///
/// **Cost.** One pass plane by plane on one thread: a few numbers for each sample of two planes, beside the
/// meshes. The kinds of cells are at most 1,785, less than a millisecond each, on all threads.
///
/// # Errors
/// [`Failure::Refused`]: only samples of the background, or an axis of one sample ([`RefusalCode::Empty`]); a
/// sample that is no whole number from 0 to 2³² − 1 ([`RefusalCode::Unsupported`], with its index); a
/// transform as for `grid_to_mesh`; more triangles or bytes than the job allows. [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::lattices::{LabelOptions, labels_to_meshes};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::Job;
/// let grid = Grid::new([2, 2, 2], Samples::U16(vec![7, 9, 7, 9, 7, 9, 7, 9]), Affine3::IDENTITY)?;
/// let meshes = labels_to_meshes(&grid, &LabelOptions::default(), &Job::default()).expect("labels");
/// assert_eq!(meshes.iter().map(|(label, _)| *label).collect::<Vec<_>>(), [7, 9]);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
pub fn labels_to_meshes(
    grid: &Grid,
    rule: &LabelOptions,
    job: &Job,
) -> Result<Vec<(u32, Bounded<Mesh>)>, Failure<Mesh>> {
    let labelled_meshes = labelled(grid, rule, false, job)?;
    if labelled_meshes.is_empty() {
        let only = rule.background.unwrap_or(0);
        return Err(Failure::refused(
            RefusalCode::Empty,
            format!("every sample has the label {only}, which is the background"),
        ));
    }
    let mesh = |(label, (LabelMesh { positions, faces, .. }, bound))| {
        (label, Bounded { shape: Mesh::by_construction(positions, faces), bound })
    };
    Ok(labelled_meshes.into_iter().map(mesh).collect())
}

/// Builds the triangles of each label in a block of a volume, in the order of labels: those of [`labels_to_meshes`] for the
/// whole volume, in the cells of this grid, with the keys that join them to those of other blocks
/// ([`join_blocks`](super::lattices::join_blocks)).
///
/// The grid shares its outer samples with the blocks beside it, `rule.offset` is the index of its first sample in the
/// whole volume, and `rule.border` is [`Border::Open`] at sides shared with another block. A label without triangles in
/// this block has no entry.
///
/// **Bound.** As for [`labels_to_meshes`]; the largest of all blocks of a label holds for the label.
///
/// # Errors
/// As for [`labels_to_meshes`]; but a block of the background alone is no error and gives an empty list.
///
/// ```
/// use chordal::convert::lattices::{LabelOptions, labels_to_blocks};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::Job;
/// let grid = Grid::new([2, 2, 2], Samples::U16(vec![7, 9, 7, 9, 7, 9, 7, 9]), Affine3::IDENTITY)?;
/// let blocks = labels_to_blocks(&grid, &LabelOptions::default(), &Job::default()).expect("labels");
/// assert_eq!(blocks.iter().map(|(label, _)| *label).collect::<Vec<_>>(), [7, 9]);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
pub fn labels_to_blocks(
    grid: &Grid,
    rule: &LabelOptions,
    job: &Job,
) -> Result<Vec<(u32, GridBlock)>, JobError> {
    let labelled_meshes = labelled(grid, rule, true, job)?;
    let block = |(label, (mesh, bound))| {
        let LabelMesh { positions, faces, vertex_keys, face_keys, .. } = mesh;
        let bound = Some(bound).filter(|_| !faces.is_empty());
        (label, GridBlock { positions, faces, normals: Vec::new(), vertex_keys, face_keys, bound })
    };
    Ok(labelled_meshes
        .into_iter()
        .map(block)
        .filter(|(_, block): &(u32, GridBlock)| !block.faces.is_empty())
        .collect())
}

/// The mesh of each label, and its bound.
#[allow(clippy::useless_conversion, reason = "one body for every type of samples")]
fn labelled(
    grid: &Grid,
    rule: &LabelOptions,
    has_keys: bool,
    job: &Job,
) -> Result<BTreeMap<u32, (LabelMesh, Bound)>, JobError> {
    let mask_rule = Polygonize { border: rule.border, offset: rule.offset, ..Polygonize::above(0.5) };
    check(grid.size(), grid.affine(), &mask_rule)?;
    let mut sheets = LabelMesher::new(grid, rule, has_keys);
    with_samples!(grid.samples(), values => sheets.build(|at| label(f64::from(values[at])), job))?;
    let meshes = std::mem::take(&mut sheets.meshes);
    let mut cells = MaskCells::default();
    meshes.values().for_each(|mesh| cells.add_all(&mesh.cells));
    // The proof of a cell does not depend on the cell's position.
    let rows = grid.affine().rows().map(|[a, b, c, _]| [a, b, c, 0.0]);
    let linear = Affine3::new(rows).unwrap_or(*grid.affine());
    let errors = vertex_errors(&linear, &Polygonize { offset: [0; 3], ..mask_rule }, [2; 3]);
    let bounds = job.run(|| MaskCellBounds::new(&cells, &linear, (diagonal(&linear), errors), job));
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let with_bound = |mesh: LabelMesh| {
        let most = bounds.largest(&mesh.cells);
        let farthest = IsosurfaceDistance { most, at: [0; 3], least: 0.0, witness: None };
        let mut bound = bound(farthest, Evidence::Proved, grid.affine(), &mask_rule, grid.size());
        bound.at = None;
        (mesh, bound)
    };
    Ok(meshes.into_iter().map(|(label, mesh)| (label, with_bound(mesh))).collect())
}

fn label(sample: f64) -> Option<u32> {
    (sample >= 0.0 && sample <= f64::from(u32::MAX) && sample.floor() == sample).then_some(sample as u32)
}

/// The mesh of a label, and the kinds of its cells.
#[derive(Default)]
struct LabelMesh {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The keys of vertices and faces; empty unless requested.
    vertex_keys: Vec<VertexKey>,
    face_keys: Vec<FaceKey>,
    cells: MaskCells,
}

/// One plane of samples, and the vertices that begin in it: for each lattice edge its rows in the meshes of
/// its two labels, and for each sample on a capped border its row in the mesh of its own label.
#[derive(Default)]
struct LabelPlane {
    labels: Vec<u32>,
    edges: [Vec<[u32; 2]>; 3],
    samples: Vec<u32>,
}

struct LabelMesher<'a> {
    grid: &'a Grid,
    rule: &'a LabelOptions,
    transform: LatticeTransform,
    upright: bool,
    has_keys: bool,
    meshes: BTreeMap<u32, LabelMesh>,
    vertices: u64,
    triangles: u64,
}

/// The bytes of a vertex and of a triangle, without and with their keys.
const BYTES: [u64; 2] = [24, 12];
const KEYED_BYTES: [u64; 2] = [24 + size_of::<VertexKey>() as u64, 12 + size_of::<FaceKey>() as u64];
/// The kind of a vertex at a sample.
const SAMPLE: u8 = 3;
/// The row of a missing vertex.
const NONE: u32 = u32::MAX;

impl<'a> LabelMesher<'a> {
    fn new(grid: &'a Grid, rule: &'a LabelOptions, has_keys: bool) -> Self {
        let transform = LatticeTransform::new(grid.affine(), rule.offset);
        let upright = grid.affine().orientation() > 0;
        Self { grid, rule, transform, upright, has_keys, meshes: BTreeMap::new(), vertices: 0, triangles: 0 }
    }

    fn build(&mut self, label_of: impl Fn(usize) -> Option<u32>, job: &Job) -> Result<(), JobError> {
        let [nx, ny, nz] = self.grid.size();
        let grid = self.grid;
        let read = |k: usize| -> Result<LabelPlane, JobError> {
            let labels =
                (k * nx * ny..(k + 1) * nx * ny).map(|at| label_of(at).ok_or_else(|| no_label(grid, at)));
            Ok(LabelPlane { labels: labels.collect::<Result<_, _>>()?, ..LabelPlane::default() })
        };
        let capped = [0, 1].map(|end| self.rule.border[2][end] == Border::Capped);
        let mut low = read(0)?;
        self.add_plane_vertices(&mut low, 0);
        if capped[0] {
            self.cap_end(&low, 0);
        }
        for k in 0..nz - 1 {
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            job.report(Progress { stage: "labels", done: k as u64, total: nz as u64 - 1 });
            let mut high = read(k + 1)?;
            self.add_plane_vertices(&mut high, k + 1);
            self.add_vertices_between(&mut low, &high, k);
            self.cells(&low, &high, k);
            self.cap_sides(&low, &high, k);
            self.check(job)?;
            low = high;
        }
        if capped[1] {
            self.cap_end(&low, 1);
        }
        self.check(job)
    }

    fn check(&self, job: &Job) -> Result<(), JobError> {
        if self.triangles > job.triangle_limit {
            let message =
                format!("the labels have more than {} triangles, which is the limit", job.triangle_limit);
            return Err(refusal(RefusalCode::TooManyTriangles, message));
        }
        // Growing arrays reserve up to twice their contents.
        let [vertex, triangle] = if self.has_keys { KEYED_BYTES } else { BYTES };
        if 2 * (vertex * self.vertices + triangle * self.triangles) > job.memory_limit {
            let message = format!(
                "the meshes of the labels need more than {} bytes, which is the limit",
                job.memory_limit
            );
            return Err(refusal(RefusalCode::TooMuchMemory, message));
        }
        Ok(())
    }

    /// Adds a vertex to the mesh of a label: at a sample, or on the edge along an axis from it.
    fn vertex(&mut self, label: u32, at: [f64; 3], (kind, sample): (u8, [usize; 3])) -> u32 {
        if self.rule.background == Some(label) {
            return NONE;
        }
        let (has_keys, lattice) = (self.has_keys, self.volume_index(sample));
        let LabelMesh { positions, vertex_keys, .. } = self.meshes.entry(label).or_default();
        self.vertices += 1;
        positions.push(at);
        if has_keys {
            vertex_keys.push(VertexKey { lattice, level: 0, kind, sheet: 0 });
        }
        positions.len() as u32 - 1
    }

    /// The index of a sample in the whole volume.
    fn volume_index(&self, sample: [usize; 3]) -> [i64; 3] {
        [0, 1, 2].map(|axis| self.rule.offset[axis] + sample[axis] as i64)
    }

    fn face(&mut self, label: u32, [a, b, c]: [u32; 3], key: FaceKey) {
        let has_keys = self.has_keys;
        let LabelMesh { faces, face_keys, .. } = self.meshes.entry(label).or_default();
        self.triangles += 1;
        faces.push(if self.upright { [a, b, c] } else { [a, c, b] });
        if has_keys {
            face_keys.push(key);
        }
    }

    /// Adds the two vertices at the midpoint of an edge along `axis` from the sample (i, j, k).
    fn middle(&mut self, [low, high]: [u32; 2], axis: usize, [i, j, k]: [usize; 3]) -> [u32; 2] {
        if low == high {
            return [NONE; 2];
        }
        // In the indices of the whole volume, so that blocks agree in every bit.
        let mut at = [self.transform.global(0, i), self.transform.global(1, j), self.transform.global(2, k)];
        at[axis] += 0.5;
        let at = self.transform.at(at);
        let edge = (axis as u8, [i, j, k]);
        [self.vertex(low, at, edge), self.vertex(high, at, edge)]
    }

    /// Adds the vertices in a plane.
    fn add_plane_vertices(&mut self, plane: &mut LabelPlane, k: usize) {
        let [nx, ny, nz] = self.grid.size();
        let capped = |axis: usize, end: usize| self.rule.border[axis][end] == Border::Capped;
        let border = [0, 1, 2].map(|axis| [capped(axis, 0), capped(axis, 1)]);
        plane.edges = [vec![[NONE; 2]; nx * ny], vec![[NONE; 2]; nx * ny], vec![[NONE; 2]; nx * ny]];
        plane.samples = vec![NONE; nx * ny];
        for j in 0..ny {
            for i in 0..nx {
                let at = i + nx * j;
                let label = plane.labels[at];
                if i + 1 < nx {
                    plane.edges[0][at] = self.middle([label, plane.labels[at + 1]], 0, [i, j, k]);
                }
                if j + 1 < ny {
                    plane.edges[1][at] = self.middle([label, plane.labels[at + nx]], 1, [i, j, k]);
                }
                let ends = |axis: usize, index: usize, n: usize| {
                    (index == 0 && border[axis][0]) || (index + 1 == n && border[axis][1])
                };
                if ends(0, i, nx) || ends(1, j, ny) || ends(2, k, nz) {
                    let index = [
                        self.transform.global(0, i),
                        self.transform.global(1, j),
                        self.transform.global(2, k),
                    ];
                    plane.samples[at] = self.vertex(label, self.transform.at(index), (SAMPLE, [i, j, k]));
                }
            }
        }
    }

    /// Adds the vertices between two planes.
    fn add_vertices_between(&mut self, low: &mut LabelPlane, high: &LabelPlane, k: usize) {
        let nx = self.grid.size()[0];
        for at in 0..low.labels.len() {
            low.edges[2][at] = self.middle([low.labels[at], high.labels[at]], 2, [at % nx, at / nx, k]);
        }
    }

    fn cells(&mut self, low: &LabelPlane, high: &LabelPlane, k: usize) {
        let size @ [nx, ny, _] = self.grid.size();
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let at = i + nx * j;
                let corner_labels = |plane: &LabelPlane| {
                    [plane.labels[at], plane.labels[at + 1], plane.labels[at + nx], plane.labels[at + nx + 1]]
                };
                let (a, b) = (corner_labels(low), corner_labels(high));
                if a == [a[0]; 4] && b == a {
                    continue;
                }
                let labels: [u32; 8] = std::array::from_fn(|c| if c < 4 { a[c] } else { b[c - 4] });
                let row = |edge: u8| {
                    let [c, _] = EDGES[usize::from(edge)].map(usize::from);
                    let plane = if c < 4 { low } else { high };
                    plane.edges[usize::from(edge) / 4][at + (c & 1) + nx * (c >> 1 & 1)]
                };
                for (first, label) in labels.into_iter().enumerate() {
                    if labels[..first].contains(&label) || self.rule.background == Some(label) {
                        continue;
                    }
                    let signs = (0..8).fold(0, |signs, c| signs | u8::from(labels[c] == label) << c);
                    let cell = [i, j, k];
                    let ends = [0, 1, 2].map(|axis| [cell[axis] == 0, cell[axis] + 2 == size[axis]]);
                    self.meshes.entry(label).or_default().cells.add(signs, ends, self.rule.border);
                    let case = &TABLE.upright[usize::from(signs)];
                    let [x, y, z] = self.volume_index(cell);
                    for (number, triangle) in (0..).zip(&case.corners[..usize::from(case.triangles)]) {
                        let face = triangle.map(|edge| {
                            // Each edge has a vertex for either label: that of its low end comes first.
                            let end = usize::from(labels[usize::from(EDGES[usize::from(edge)][0])] != label);
                            row(edge)[end]
                        });
                        self.face(label, face, FaceKey { is_cap: false, place: [z, y, x], number });
                    }
                }
            }
        }
    }

    /// Adds the caps of the side walls between two planes.
    fn cap_sides(&mut self, low: &LabelPlane, high: &LabelPlane, k: usize) {
        let [nx, ny, _] = self.grid.size();
        let border = self.rule.border;
        for (axis, n) in [(0, nx), (1, ny)] {
            for end in (0..2).filter(|end| border[axis][*end] == Border::Capped) {
                let fixed = if end == 0 { 0 } else { n - 1 };
                let (step, start, count) = if axis == 0 { (nx, fixed, ny) } else { (1, nx * fixed, nx) };
                for p in 0..count - 1 {
                    let (a, b) = (start + p * step, start + (p + 1) * step);
                    // Along the other axis, then up: counter-clockwise as seen from outside at the low x and the
                    // high y border.
                    let mut corners = [(0, a), (0, b), (1, b), (1, a)];
                    let mut sides =
                        [low.edges[1 - axis][a], low.edges[2][b], high.edges[1 - axis][a], low.edges[2][a]];
                    if (axis == 0) == (end == 0) {
                        corners = [corners[3], corners[2], corners[1], corners[0]];
                        sides = [sides[2], sides[1], sides[0], sides[3]];
                    }
                    let along = if axis == 0 { [p, k] } else { [k, p] };
                    self.cap_square([low, high], corners, sides, self.cap_place(axis, end, along));
                }
            }
        }
    }

    /// Adds the cap of the first or the last plane.
    fn cap_end(&mut self, plane: &LabelPlane, end: usize) {
        let [nx, ny, _] = self.grid.size();
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let at = i + nx * j;
                let mut corners = [at, at + 1, at + nx + 1, at + nx].map(|at| (0, at));
                let mut sides =
                    [plane.edges[0][at], plane.edges[1][at + 1], plane.edges[0][at + nx], plane.edges[1][at]];
                // The first plane is seen from the other side.
                if end == 0 {
                    corners = [corners[3], corners[2], corners[1], corners[0]];
                    sides = [sides[2], sides[1], sides[0], sides[3]];
                }
                self.cap_square([plane; 2], corners, sides, self.cap_place(2, end, [i, j]));
            }
        }
    }

    /// The place of a cap's triangles: the border, and the indices along the two axes after its own.
    fn cap_place(&self, axis: usize, end: usize, [p, q]: [usize; 2]) -> [i64; 3] {
        let along = |axis: usize, index: usize| self.rule.offset[axis % 3] + index as i64;
        [2 * axis as i64 + end as i64, along(axis + 2, q), along(axis + 1, p)]
    }

    /// Adds the caps of all labels in one square. Each corner is a plane and a row, counter-clockwise from
    /// outside; `sides` has the vertices of the side after each corner.
    fn cap_square(
        &mut self,
        planes: [&LabelPlane; 2],
        corners: [(usize, usize); 4],
        sides: [[u32; 2]; 4],
        place: [i64; 3],
    ) {
        let label_at = |(plane, at): (usize, usize)| planes[plane].labels[at];
        let labels = corners.map(label_at);
        for (first, label) in labels.into_iter().enumerate() {
            if labels[..first].contains(&label) || self.rule.background == Some(label) {
                continue;
            }
            let row = |vertex: CapVertex| match vertex {
                CapVertex::Corner(i) => planes[corners[i].0].samples[corners[i].1],
                CapVertex::Side(i) => {
                    let (corner, next) = (corners[i], corners[(i + 1) % 4]);
                    // As in `middle`, the vertex of the lower end comes first.
                    let lower = lesser(corner, next);
                    sides[i][usize::from(label_at(lower) != label)]
                }
            };
            let mut number = 0;
            triangles(labels.map(|other| other == label), row, |face| {
                self.face(label, face, FaceKey { is_cap: true, place, number });
                number += 1;
            });
        }
    }
}

fn no_label(grid: &Grid, at: usize) -> JobError {
    let [nx, ny, _] = grid.size();
    let (i, j, k) = (at % nx, at / nx % ny, at / (nx * ny));
    let sample = grid.samples().get(at);
    let message =
        format!("sample ({i}, {j}, {k}) is {sample}, and a label is a whole number from 0 to 4294967295");
    refusal(RefusalCode::Unsupported, message)
}
