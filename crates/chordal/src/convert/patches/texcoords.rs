//! Texture coordinates of a finished mesh: each vertex gets the coordinates of its sheet at its parameters, with
//! one row for each side of a seam.
use super::patch_tile::{self, PatchTile, PatchTileMesh};
use super::seams::TileSeams;
use super::subpatch::{PatchSurface, Subpatch, SubpatchShape};
use super::tile_border;
use crate::budget::{Job, par_map};
use crate::explicit::{Attribute, Chart, Domain, LimitSheet, LimitSurface, Mesh, PatchSide, Semantic};
use crate::math::greater;
use std::collections::BTreeMap;

/// Texture coordinates at one vertex that differ by no more than this fraction of the largest are merged.
/// Chosen: far above the rounding of two sheets that meet (1e-14) and below the resolution of single precision
/// (6e-8).
const SAME: f64 = 1e-10;

/// The sheets of a surface in the texture plane.
pub(crate) struct SheetTexcoords<'a> {
    chart: &'a Chart,
    limit: LimitSurface<'a>,
}

impl<'a> SheetTexcoords<'a> {
    /// The sheets of a chart, which correspond to those of its cage.
    pub(crate) fn from_chart(chart: &'a Chart) -> Option<Self> {
        Some(Self { chart, limit: chart.cage().limit().ok()? })
    }

    /// One sheet; `None` if coordinates overflow or the face has none.
    pub(crate) fn sheet(&self, sheet: usize) -> Option<LimitSheet> {
        self.chart.has_face(self.limit.face_of(sheet).0).then(|| self.limit.sheet(sheet).ok()).flatten()
    }
}

/// The texture coordinates at a parameter of a sheet.
pub(crate) fn at(sheet: Option<&LimitSheet>, [u, v]: [f64; 2]) -> [f64; 2] {
    sheet.and_then(|sheet| sheet.point(u, v).ok()).map_or([0.0; 2], |[x, y, _]| [x, y])
}

/// The mesh of all tiles, in their order, with the texture coordinates of its sheets.
pub(crate) fn with_texcoords(
    mesh: Mesh,
    sheets: &dyn PatchSurface<'_>,
    subpatches: &[Subpatch<'_>],
    seams: &TileSeams,
    tiles: &[(PatchTile, PatchTileMesh)],
    job: &Job,
) -> Mesh {
    if !sheets.has_texcoords() {
        return mesh;
    }
    // Tiles of a sheet follow each other.
    let mut first = 0;
    let runs = tiles.chunk_by(|a, b| a.0.sheet == b.0.sheet).map(|run| {
        first += run.len();
        (first - run.len(), run)
    });
    let runs: Vec<(usize, &[(PatchTile, PatchTileMesh)])> = runs.collect();
    let corners = par_map(job, &runs, |_, (first, run)| {
        let mut out = Vec::new();
        let sheet = run.first().and_then(|(tile, _)| sheets.texcoords(tile.sheet as usize));
        for (k, (tile, done)) in run.iter().enumerate() {
            let point = |[u, v]: [f64; 2]| {
                let within = |x: f64, [from, to]: [f64; 2]| from + (to - from) * x;
                at(sheet.as_ref(), [within(u, tile.u), within(v, tile.v)])
            };
            // In the order of the tile's vertices: its border, then the inner ones.
            let mut local = Vec::new();
            for side in PatchSide::ALL {
                tile_border::walk_side(first + k, tile, side, seams, |u, v, _| local.push(point([u, v])));
            }
            match subpatches[tile.subpatch as usize].shape {
                SubpatchShape::Bezier(_) => {
                    let counts = PatchSide::ALL.map(|side| seams.count(first + k, side));
                    local.extend(patch_tile::inner_places(tile, counts).map(point));
                }
                SubpatchShape::Extraordinary(_) => local.extend(done.inner.iter().map(|_| point([0.5, 0.5]))),
            }
            out.extend(done.triangles.as_flattened().iter().map(|vertex| local[*vertex as usize]));
        }
        out
    });
    split_by_texcoords(mesh, &corners.concat())
}

/// The mesh with one row for each distinct pair of texture coordinates of the corners at a vertex; `corners` has
/// three pairs per triangle. The first pair keeps the vertex, each other one gets a vertex of its own, tied by
/// `position_id`.
pub(crate) fn split_by_texcoords(mesh: Mesh, corners: &[[f64; 2]]) -> Mesh {
    let largest = corners.as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
    let is_same = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() <= SAME * largest);
    let n = mesh.positions().len();
    let mut rows: Vec<Option<[f64; 2]>> = vec![None; n];
    // Additional vertices, for each vertex with more than one pair.
    let mut more: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut faces = mesh.faces().to_vec();
    let mut source: Vec<u32> = (0..n as u32).collect();
    for (vertex, &value) in faces.as_flattened_mut().iter_mut().zip(corners) {
        let own = *rows[*vertex as usize].get_or_insert(value);
        if is_same(own, value) {
            continue;
        }
        let others = more.entry(*vertex).or_default();
        let same = others.iter().find(|other| rows[**other as usize].is_some_and(|row| is_same(row, value)));
        if let Some(other) = same {
            *vertex = *other;
            continue;
        }
        let other = source.len() as u32;
        others.push(other);
        source.push(*vertex);
        rows.push(Some(value));
        *vertex = other;
    }
    let values: Vec<f64> = rows.into_iter().flat_map(Option::unwrap_or_default).collect();
    let texcoords = Attribute { semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values };
    if source.len() == n {
        return mesh.with_attribute(texcoords).expect("there is a row for each vertex");
    }
    let positions = source.iter().map(|vertex| mesh.positions()[*vertex as usize]).collect();
    let ids = source.iter().map(|vertex| mesh.position_of(*vertex)).collect();
    let split = Mesh::new(positions, faces).and_then(|split| split.with_position_id(ids));
    let with_all = mesh.attributes().iter().fold(split, |split, attribute| {
        let values = source.iter().flat_map(|vertex| attribute.row(*vertex as usize)).copied().collect();
        split?.with_attribute(Attribute { values, ..attribute.clone() })
    });
    let done = with_all.and_then(|split| split.with_attribute(texcoords));
    done.expect("rows are those of a mesh, and there is one for each vertex")
}
