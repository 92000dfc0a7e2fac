//! `Wedges`: the attribute values at the corners of triangles, shared where no feature line separates them.
use super::flat_normals::is_flat;
use super::surface::{Compaction, HalfEdgeSurface, NONE, SurfaceRegion};
use crate::budget::AttributeLimits;
use crate::explicit::{Attribute, DisjointSets, Domain, Mesh, Semantic, next_in_face, previous_in_face};
use crate::math::elementary::cos;
use crate::math::{dot, greater, lesser};
use std::ops::Range;

/// One row of values for all corners around a vertex between two feature lines.
///
/// Feature lines are edges at which values jump: texture seams, normal creases, material borders. Where
/// nothing jumps, the corners around a vertex share their row.
#[derive(Clone)]
pub(super) struct Wedges {
    /// By half-edge: the row of the corner at its start.
    pub corner_row: Vec<u32>,
    values: Vec<f64>,
    width: usize,
    spans: Vec<WedgeColumns>,
}

/// The columns of one attribute.
#[derive(Clone, Copy, Debug)]
struct WedgeColumns {
    from: usize,
    width: usize,
    blending: WedgeBlending,
    limited: Option<LimitedAttribute>,
}

/// The way values are blended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WedgeBlending {
    /// By weights.
    Weighted,
    /// By weights; a seam wherever values differ.
    Linear,
    /// By weights; the first three numbers are then normalized to a unit direction.
    Direction,
    /// The value of the largest weight, for numbers that identify something.
    Heaviest,
}

/// Normals farther apart than 30° make a crease, as for meshes without normals.
const CREASE_COSINE: f64 = 0.866_025_403_784_438_6;
/// Colours no farther apart than this are equal: two steps of eight bits.
const COLOR_STEP: f64 = 2.0 / 255.0;

fn blending(semantic: &Semantic) -> WedgeBlending {
    match semantic {
        Semantic::Normal | Semantic::Tangent => WedgeBlending::Direction,
        Semantic::TexCoord(_) | Semantic::Color(_) => WedgeBlending::Weighted,
        Semantic::Blended(_) => WedgeBlending::Linear,
        Semantic::Group(_) | Semantic::Custom(_) => WedgeBlending::Heaviest,
    }
}

/// Whether corners carry an attribute: attributes of vertices and corners. Normals of flat shading are
/// recomputed instead.
pub(super) fn is_carried(mesh: &Mesh, attribute: &Attribute) -> bool {
    attribute.domain != Domain::Face && !is_flat(mesh, attribute)
}

impl Wedges {
    /// The values of a mesh, and for each half-edge whether its edge is a feature line; `None` if there
    /// are no values and only attributes of faces make lines. Rows marked by `stays` keep their values,
    /// since a neighbouring region shares them.
    pub fn from_mesh(
        mesh: &Mesh,
        surface: &HalfEdgeSurface,
        stays: impl Fn(u32) -> bool,
        limits: &AttributeLimits,
    ) -> (Option<Self>, Vec<bool>) {
        let mut is_line = lines_of_faces(mesh, surface);
        let carried: Vec<&Attribute> = mesh.attributes().iter().filter(|a| is_carried(mesh, a)).collect();
        if carried.is_empty() {
            return (None, is_line);
        }
        let mut wedges = Self::from_corners(mesh, &carried);
        let crease = limits.normal_deg().map_or(CREASE_COSINE, |most| {
            let half = cos((0.5 * most).to_radians());
            greater(half, CREASE_COSINE)
        });
        let mut joined = DisjointSets::new(wedges.values.len() / wedges.width);
        for h in 0..surface.start.len() as u32 {
            let t = surface.twin[h as usize];
            if t == NONE || t < h {
                continue;
            }
            // The corners on both sides of the edge: a and b at its start, c and d at its end.
            let [a, b, c, d] =
                [h, next_in_face(t), next_in_face(h), t].map(|corner| wedges.corner_row[corner as usize]);
            if wedges.jumps([a, b], crease) || wedges.jumps([c, d], crease) {
                is_line[h as usize] = true;
                is_line[t as usize] = true;
            }
        }
        let rows = mesh.faces().as_flattened();
        for h in 0..surface.start.len() as u32 {
            let t = surface.twin[h as usize];
            // Joins the two corners at the start of `h`; its twin joins those at the other end.
            if t != NONE && !is_line[h as usize] && !stays(rows[h as usize]) {
                joined.union(wedges.corner_row[h as usize], wedges.corner_row[next_in_face(t) as usize]);
            }
        }
        wedges.join(joined);
        (Some(wedges), is_line)
    }

    /// Drops the corners of removed faces.
    pub fn compact(&mut self, compaction: &Compaction) {
        self.corner_row = compaction.half_edges(&self.corner_row).collect();
    }

    /// The rows of a region's corners, and their numbers in the whole surface.
    pub fn region(&self, region: &SurfaceRegion) -> (Self, Vec<u32>) {
        let corners = || region.half_edges().map(|h| self.corner_row[h as usize]);
        let mut rows: Vec<u32> = corners().collect();
        rows.sort_unstable();
        rows.dedup();
        let local = |row: u32| rows.partition_point(|r| *r < row) as u32;
        let wedges = Self {
            corner_row: corners().map(local).collect(),
            values: rows.iter().flat_map(|row| self.row(*row).iter().copied()).collect(),
            width: self.width,
            spans: self.spans.clone(),
        };
        (wedges, rows)
    }

    /// Takes over the result of collapses in a [`Self::region`].
    pub fn put_back(&mut self, collapsed: &Self, rows: &[u32], region: &SurfaceRegion) {
        for (h, row) in region.half_edges().zip(&collapsed.corner_row) {
            self.corner_row[h as usize] = rows[*row as usize];
        }
        for (local, row) in (0..).zip(rows) {
            self.values[*row as usize * self.width..][..self.width].copy_from_slice(collapsed.row(local));
        }
    }

    /// A row for every vertex, or for every corner if some attribute belongs to corners.
    fn from_corners(mesh: &Mesh, carried: &[&Attribute]) -> Self {
        let mut spans = Vec::new();
        let mut width = 0;
        for a in carried {
            let limited = match a.semantic {
                Semantic::TexCoord(_) if a.width == 2 => Some(LimitedAttribute::Texcoord),
                Semantic::Normal if a.width == 3 => Some(LimitedAttribute::Normal),
                _ => None,
            };
            spans.push(WedgeColumns {
                from: width,
                width: a.width,
                blending: blending(&a.semantic),
                limited,
            });
            width += a.width;
        }
        let rows = mesh.faces().as_flattened();
        let by_vertex = carried.iter().all(|a| a.domain == Domain::Vertex);
        let n_rows = if by_vertex { mesh.positions().len() } else { rows.len() };
        let mut values = Vec::with_capacity(n_rows * width);
        if by_vertex {
            (0..n_rows).for_each(|row| carried.iter().for_each(|a| values.extend_from_slice(a.row(row))));
        } else {
            for (corner, row) in rows.iter().enumerate() {
                for a in carried {
                    values.extend_from_slice(a.row(if a.domain == Domain::Vertex {
                        *row as usize
                    } else {
                        corner
                    }));
                }
            }
        }
        let corner_row = if by_vertex { rows.to_vec() } else { (0..rows.len() as u32).collect() };
        Self { corner_row, values, width, spans }
    }

    pub fn row(&self, wedge: u32) -> &[f64] {
        &self.values[wedge as usize * self.width..][..self.width]
    }

    /// Whether two rows differ so much that the edge between them is a feature line. Directions jump if their
    /// cosine is below `crease`.
    fn jumps(&self, [a, b]: [u32; 2], crease: f64) -> bool {
        if a == b {
            return false;
        }
        let (a, b) = (self.row(a), self.row(b));
        self.spans.iter().any(|span| {
            let columns = span.from..span.from + span.width;
            let (a, b) = (&a[columns.clone()], &b[columns]);
            match span.blending {
                WedgeBlending::Heaviest | WedgeBlending::Linear => a != b,
                WedgeBlending::Direction if span.width >= 3 => {
                    let [p, q] = [a, b].map(|v| [v[0], v[1], v[2]]);
                    let turned = dot(p, q) < crease * (dot(p, p) * dot(q, q)).sqrt();
                    turned || (span.width == 4 && a[3] != b[3])
                }
                // Texture coordinates have two components, colours three or four.
                _ if span.width == 2 => a != b,
                _ => (0..span.width).any(|k| (a[k] - b[k]).abs() > COLOR_STEP),
            }
        })
    }

    /// Merges rows that no line separates into the first of them, whose directions become the sum.
    fn join(&mut self, mut sets: DisjointSets) {
        for wedge in 0..(self.values.len() / self.width) as u32 {
            let root = sets.find(wedge);
            if root == wedge {
                continue;
            }
            for span in self.spans.clone() {
                if span.blending == WedgeBlending::Direction {
                    // The fourth number of a tangent is a sign, which has no sum.
                    for k in 0..lesser(span.width, 3) {
                        let more = self.values[wedge as usize * self.width + span.from + k];
                        self.values[root as usize * self.width + span.from + k] += more;
                    }
                }
            }
        }
        for wedge in &mut self.corner_row {
            *wedge = sets.find(*wedge);
        }
        // After all sums, since a root may get more parts.
        for wedge in 0..(self.values.len() / self.width) as u32 {
            if sets.find(wedge) == wedge {
                self.normalize_directions(wedge);
            }
        }
    }

    /// Normalizes directions to length 1; a zero direction stays as it is.
    fn normalize_directions(&mut self, wedge: u32) {
        let row = &mut self.values[wedge as usize * self.width..][..self.width];
        normalize_directions(&self.spans, row);
    }

    /// The row with its directions normalized to length 1.
    pub fn normalized(&self, mut row: Vec<f64>) -> Vec<f64> {
        normalize_directions(&self.spans, &mut row);
        row
    }

    /// The blend of rows by weights.
    pub fn blend(&self, parts: &[(u32, f64)]) -> Vec<f64> {
        let mut blended = vec![0.0; self.width];
        let heaviest = parts.iter().fold(None, |best: Option<&(u32, f64)>, part| {
            if best.is_some_and(|best| best.1 >= part.1) { best } else { Some(part) }
        });
        for span in &self.spans {
            for (k, value) in blended.iter_mut().enumerate().skip(span.from).take(span.width) {
                *value = match (span.blending, heaviest) {
                    (WedgeBlending::Heaviest, Some((wedge, _))) => self.row(*wedge)[k],
                    // The sign of a tangent is not blended either.
                    (WedgeBlending::Direction, Some((wedge, _))) if k == span.from + 3 => self.row(*wedge)[k],
                    _ => {
                        let values = || parts.iter().map(|(wedge, _)| self.row(*wedge)[k]);
                        let sum =
                            parts.iter().fold(0.0, |sum, (wedge, weight)| sum + weight * self.row(*wedge)[k]);
                        // With weights ≥ 0 the blend lies between the values, except for rounding.
                        if !parts.is_empty() && parts.iter().all(|(_, weight)| *weight >= 0.0) {
                            let least = values().fold(f64::INFINITY, |least, x| lesser(x, least));
                            let most = values().fold(f64::NEG_INFINITY, |most, x| greater(x, most));
                            greater(lesser(sum, most), least)
                        } else {
                            sum
                        }
                    }
                };
            }
        }
        blended
    }

    /// Sets a row.
    pub fn set_row(&mut self, wedge: u32, values: &[f64]) {
        self.values[wedge as usize * self.width..][..self.width].copy_from_slice(values);
        self.normalize_directions(wedge);
    }

    /// Gives the corners at one end of a collapsed edge the rows of the other end: corners left of the edge
    /// get the row of the corner `left`, corners right of it the row of `right`. Feature lines separate left
    /// from right.
    pub fn transfer(&mut self, surface: &HalfEdgeSurface, is_line: &[bool], end: &WedgeTransfer) {
        transferred_corners(surface, is_line, end, |corner, row| self.corner_row[corner as usize] = row);
    }

    /// The columns of the attributes that can have limits.
    pub fn limited_columns(&self) -> impl Iterator<Item = (Range<usize>, LimitedAttribute)> + '_ {
        self.spans.iter().filter_map(|span| Some((span.from..span.from + span.width, span.limited?)))
    }
}

fn normalize_directions(spans: &[WedgeColumns], row: &mut [f64]) {
    for span in spans.iter().filter(|span| span.blending == WedgeBlending::Direction && span.width >= 3) {
        let v = &mut row[span.from..span.from + 3];
        let size = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        if size > 0.0 && size.is_finite() {
            v.iter_mut().for_each(|x| *x /= size);
        }
    }
}

/// Calls `visit` with each corner that [`Wedges::transfer`] changes, and its new row.
pub(super) fn transferred_corners(
    surface: &HalfEdgeSurface,
    is_line: &[bool],
    end: &WedgeTransfer,
    mut visit: impl FnMut(u32, u32),
) {
    let WedgeTransfer { h, at_start, left, right } = *end;
    let across = surface.twin[h as usize];
    // Left of the edge, away from it, until the next line; then right of it.
    let first_left = if at_start { h } else { next_in_face(h) };
    sweep_fan(surface, is_line, (first_left, at_start), |corner| visit(corner, left));
    if across != NONE {
        let first_right = if at_start { next_in_face(across) } else { across };
        sweep_fan(surface, is_line, (first_right, !at_start), |corner| visit(corner, right));
    }
}

/// Visits the corners around a vertex from the first on, counter-clockwise or clockwise, until the next line.
fn sweep_fan(
    surface: &HalfEdgeSurface,
    is_line: &[bool],
    (first, ccw): (u32, bool),
    mut visit: impl FnMut(u32),
) {
    let mut g = first;
    loop {
        visit(g);
        // Around the vertex: counter-clockwise across the incoming edge, clockwise across the outgoing one.
        let edge = if ccw { previous_in_face(g) } else { g };
        let t = surface.twin[edge as usize];
        if t == NONE || is_line[edge as usize] {
            break;
        }
        g = if ccw { t } else { next_in_face(t) };
        if g == first {
            break;
        }
    }
}

/// An attribute whose difference a budget can limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LimitedAttribute {
    /// Texture coordinates of two components.
    Texcoord,
    Normal,
}

/// What a collapse does to the values of the corners around it.
pub(super) struct WedgeChange {
    /// Rows with their new values, before directions are normalized.
    pub rows: Vec<(u32, Vec<f64>)>,
    pub transfer: WedgeTransfer,
}

/// See [`Wedges::transfer`].
#[derive(Clone, Copy, Debug)]
pub(super) struct WedgeTransfer {
    pub h: u32,
    /// Whether the corners at the start of the half-edge change, or those at its end.
    pub at_start: bool,
    pub left: u32,
    pub right: u32,
}

/// Feature lines between faces with different face attributes. Face normals are ignored, since they
/// follow from the faces.
fn lines_of_faces(mesh: &Mesh, surface: &HalfEdgeSurface) -> Vec<bool> {
    let mut is_line = vec![false; surface.start.len()];
    let of_faces =
        |a: &&Attribute| a.domain == Domain::Face && blending(&a.semantic) != WedgeBlending::Direction;
    for attribute in mesh.attributes().iter().filter(of_faces) {
        for (h, (is_line, t)) in is_line.iter_mut().zip(&surface.twin).enumerate() {
            *is_line |= *t != NONE && attribute.row(h / 3) != attribute.row(*t as usize / 3);
        }
    }
    is_line
}
