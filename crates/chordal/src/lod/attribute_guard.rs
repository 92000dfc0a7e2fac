//! `AttributeGuard`: keeps texture coordinates and normals within their limits during simplification.
use super::local_tolerance::LocalTolerance;
use super::samples::SamplesByFace;
use super::surface::{HalfEdgeSurface, NONE};
use super::wedges::{LimitedAttribute, WedgeChange, Wedges, transferred_corners};
use crate::budget::AttributeLimits;
use crate::explicit::{closest_on_triangle, distance_sq_to_triangle, next_in_face, previous_in_face};
use crate::math::elementary::cos;
use crate::math::{dot, lesser};
use std::ops::Range;
use std::sync::Arc;

/// The limits, and the values at the vertices of the original.
///
/// It compares the values of every vertex of the original with those at the nearest point of the faces after
/// a collapse. It guides and proves nothing: `check::attribute_deviation` measures the result.
#[derive(Clone)]
pub(super) struct AttributeGuard {
    original: Arc<OriginalRows>,
    limits: Arc<[ColumnLimit]>,
    /// By vertex of the original: how often its limits were lowered.
    cuts: Vec<u8>,
}

/// The fractions of the limits that collapses may use: the first one at first, and the next one where an
/// attempt exceeded them; after the last, nothing changes there. Chosen: the remainder is for points between
/// vertices.
const SHARES: [f64; 3] = [0.9, 0.6, 0.3];

/// By vertex of the original: its rows, one for each side of the lines that meet at the vertex.
struct OriginalRows {
    /// The rows of vertex `v` are `first[v]..first[v + 1]`.
    first: Vec<u32>,
    values: Vec<f64>,
    width: usize,
}

/// The limit of one attribute, by the usable fraction.
struct ColumnLimit {
    columns: Range<usize>,
    most: [ValueLimit; SHARES.len()],
}

#[derive(Clone, Copy, Debug)]
enum ValueLimit {
    /// The square of the largest distance.
    DistanceSq(f64),
    /// The cosine of the largest angle.
    Cosine(f64),
}

/// A face after a collapse: its corners, and the values at them.
pub(super) struct FaceAfter<'a> {
    corners: [[f64; 3]; 3],
    rows: [&'a [f64]; 3],
}

impl AttributeGuard {
    /// The guard of a surface that has not changed yet.
    pub fn new(
        surface: &HalfEdgeSurface,
        wedges: &Wedges,
        n_vertices: usize,
        limits: &AttributeLimits,
    ) -> Self {
        let width = wedges.limited_columns().map(|(columns, _)| columns.end).max().unwrap_or(0);
        let mut original = OriginalRows { first: vec![0], values: Vec::new(), width };
        let mut rows = Vec::new();
        for v in 0..n_vertices as u32 {
            rows.clear();
            if surface.outgoing[v as usize] != NONE {
                rows.extend(surface.one_ring(v).map(|corner| wedges.corner_row[corner as usize]));
            }
            rows.sort_unstable();
            rows.dedup();
            rows.iter().for_each(|row| original.values.extend_from_slice(&wedges.row(*row)[..width]));
            let n = original.first[v as usize] + rows.len() as u32;
            original.first.push(n);
        }
        let limit = |(columns, attribute): (Range<usize>, LimitedAttribute)| {
            let most = match attribute {
                LimitedAttribute::Texcoord => {
                    let most = limits.texcoord()?;
                    SHARES.map(|share| ValueLimit::DistanceSq((share * most) * (share * most)))
                }
                LimitedAttribute::Normal => {
                    let most = limits.normal_deg()?;
                    SHARES.map(|share| ValueLimit::Cosine(cos((share * most).to_radians())))
                }
            };
            Some(ColumnLimit { columns, most })
        };
        let limits = wedges.limited_columns().filter_map(limit).collect();
        Self { original: Arc::new(original), limits, cuts: vec![0; n_vertices] }
    }

    /// Takes back all reductions of limits.
    pub fn reset(&mut self) {
        self.cuts.fill(0);
    }

    /// Lowers the limits of an earlier attempt once more for some samples. Samples that are not vertices have
    /// no limits.
    pub fn tighten(&mut self, before: &Self, mut samples: Vec<u32>) {
        samples.sort_unstable();
        samples.dedup();
        self.cuts.clone_from(&before.cuts);
        for sample in samples {
            if let Some(cuts) = self.cuts.get_mut(sample as usize) {
                *cuts = lesser(*cuts + 1, SHARES.len() as u8);
            }
        }
    }

    /// Whether the values of all vertices that a pending collapse reassigns are near those of the new faces.
    ///
    /// The nearest point decides; if it differs too much, as beside a seam that moved, any other
    /// face that is within the tolerance may decide.
    pub fn allows(
        &self,
        samples: &SamplesByFace,
        faces: &[(u32, FaceAfter<'_>)],
        tolerance: &LocalTolerance,
    ) -> bool {
        samples.reassignments().iter().filter(|(sample, _)| (*sample as usize) < self.cuts.len()).all(
            |&(sample, nearest)| {
                let cuts = usize::from(self.cuts[sample as usize]);
                if cuts >= SHARES.len() {
                    return false;
                }
                let p = samples.at(sample);
                let mut rows = self.original.rows(sample);
                rows.all(|row| {
                    let is_near = |(_, face): &&(u32, FaceAfter<'_>)| {
                        tolerance.holds_sample(sample, distance_sq_to_triangle(p, face.corners))
                    };
                    let holder = faces.iter().filter(|(face, _)| *face == nearest);
                    let others = faces.iter().filter(|(face, _)| *face != nearest).filter(is_near);
                    holder.chain(others).any(|(_, face)| self.is_close(row, (p, cuts), face))
                })
            },
        )
    }

    /// Whether a row is near the values at the point of a face that is nearest to `p`, after `cuts`
    /// reductions of the limits.
    fn is_close(&self, row: &[f64], (p, cuts): ([f64; 3], usize), face: &FaceAfter<'_>) -> bool {
        let weights = closest_on_triangle(p, face.corners);
        let value = |k: usize| (0..3).map(|i| weights[i] * face.rows[i][k]).sum::<f64>();
        self.limits.iter().all(|limit| {
            let from = limit.columns.start;
            match limit.most[cuts] {
                ValueLimit::DistanceSq(most) => {
                    let offset = [from, from + 1].map(|k| value(k) - row[k]);
                    offset[0] * offset[0] + offset[1] * offset[1] <= most
                }
                ValueLimit::Cosine(least) => {
                    let [p, q]: [[f64; 3]; 2] =
                        [std::array::from_fn(|k| value(from + k)), std::array::from_fn(|k| row[from + k])];
                    let sizes = (dot(p, p) * dot(q, q)).sqrt();
                    // A vertex without a normal has no angle to any other.
                    dot(q, q) == 0.0 || dot(p, q) >= lesser(least, 1.0 - SMALLEST_TURN) * sizes
                }
            }
        })
    }
}

/// One minus the largest cosine of an angle that counts as larger than 0, so that rounding is no turn.
/// Chosen: some thousand times the rounding of dot products and roots, and the cosine of an angle of a
/// ten-thousandth of a degree.
const SMALLEST_TURN: f64 = 1e-12;

impl OriginalRows {
    fn rows(&self, v: u32) -> impl Iterator<Item = &[f64]> {
        let [from, to] = [self.first[v as usize], self.first[v as usize + 1]].map(|i| i as usize);
        (from..to).map(|row| &self.values[row * self.width..][..self.width])
    }
}

/// The values at corners after a collapse.
pub(super) struct WedgesAfter<'a> {
    wedges: &'a Wedges,
    /// Corners whose row changes, each with its new row.
    corners: Vec<(u32, u32)>,
    /// Rows whose values change, each with its new values.
    rows: Vec<(u32, Vec<f64>)>,
}

impl<'a> WedgesAfter<'a> {
    pub fn new(
        wedges: &'a Wedges,
        change: &WedgeChange,
        surface: &HalfEdgeSurface,
        is_line: &[bool],
    ) -> Self {
        let mut corners = Vec::new();
        transferred_corners(surface, is_line, &change.transfer, |corner, row| corners.push((corner, row)));
        let normalized = |(row, values): &(u32, Vec<f64>)| (*row, wedges.normalized(values.clone()));
        Self { wedges, corners, rows: change.rows.iter().map(normalized).collect() }
    }

    /// A face after the collapse of the edge between `ends`, with the values at its corners, first those at
    /// the new point.
    pub fn face(
        &self,
        (face, corners): (u32, [[f64; 3]; 3]),
        ends: [u32; 2],
        surface: &HalfEdgeSurface,
    ) -> (u32, FaceAfter<'_>) {
        let changed_corner = (3 * face..3 * face + 3).find(|h| ends.contains(&surface.start[*h as usize]));
        let at = changed_corner.unwrap_or(3 * face);
        let rows = [at, next_in_face(at), previous_in_face(at)].map(|corner| self.row_at(corner));
        (face, FaceAfter { corners, rows })
    }

    fn row_at(&self, corner: u32) -> &[f64] {
        let moved = self.corners.iter().find(|(moved, _)| *moved == corner);
        let row = moved.map_or(self.wedges.corner_row[corner as usize], |(_, row)| *row);
        let new = self.rows.iter().find(|(changed, _)| *changed == row);
        new.map_or_else(|| self.wedges.row(row), |(_, values)| values)
    }
}
