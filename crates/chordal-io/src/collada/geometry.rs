//! `ColladaGeometry`: the sources of a mesh, and the faces of its primitives.
use crate::assemble::{RawMesh, mesh, too_many_rows};
use crate::grow::{push, with_room};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, MATERIAL, Part, ReadError};
use chordal::explicit::triangulate::Triangulator;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// Rows of numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct ColladaSource {
    pub values: Vec<f64>,
    pub count: u64,
    pub offset: usize,
    pub stride: usize,
    /// The number of named values in a row.
    pub width: usize,
}

impl ColladaSource {
    /// A row, if it is complete.
    pub(super) fn row(&self, row: u32) -> Option<&[f64]> {
        if u64::from(row) >= self.count {
            return None;
        }
        let start = (row as usize).checked_mul(self.stride)?.checked_add(self.offset)?;
        self.values.get(start..start.checked_add(self.width)?)
    }
}

/// Why positions cannot be read.
pub(super) struct BadPositions {
    pub code: &'static str,
    pub message: String,
}

impl ColladaSource {
    /// Whether all rows are complete.
    pub(super) fn is_whole(&self) -> bool {
        let last = |count: u64| u32::try_from(count - 1).is_ok_and(|row| self.row(row).is_some());
        self.count == 0 || self.width <= self.stride && last(self.count)
    }

    /// The rows as positions, all finite unless the limits allow others.
    pub(super) fn positions(&self, limits: &Limits) -> Result<Vec<[f64; 3]>, BadPositions> {
        // The rows were checked to exist; without a stride they may all be the same.
        let n = self.count as usize;
        if self.width < 3 {
            let message = format!("positions have {} coordinates, not 3", self.width);
            return Err(BadPositions { code: "wrong-width", message });
        }
        let allocated = with_room(n);
        let mut positions = allocated
            .map_err(|error| BadPositions { code: error.code, message: error.message.to_string() })?;
        for row in 0..n {
            let source_row = self.row(row as u32).unwrap_or(&[0.0; 3]);
            let position: [f64; 3] = std::array::from_fn(|k| source_row[k]);
            if !limits.drop_nonfinite && position.iter().any(|x| !x.is_finite()) {
                let message = format!("position {row} is not finite: {position:?}");
                return Err(BadPositions { code: "not-finite", message });
            }
            positions.push(position);
        }
        Ok(positions)
    }
}

/// A stream of values for each corner.
#[derive(Clone, Debug)]
pub(super) struct CornerStream {
    pub semantic: Semantic,
    pub width: usize,
    /// The source of each run of corners, with the first corner.
    pub runs: Vec<(usize, String)>,
    pub rows: Vec<u32>,
}

/// The row of a corner without a value.
pub(super) const NO_ROW: u32 = u32::MAX;
/// A polygon with more corners than this, and far fewer vertices than corners, is cut as a fan. Chosen: the
/// general triangulation would visit its vertices again and again.
const LONG: usize = 1 << 16;

/// A mesh while it is read.
#[derive(Debug, Default)]
pub(super) struct ColladaGeometry {
    pub id: String,
    pub name: String,
    pub sources: BTreeMap<String, ColladaSource>,
    /// The source of positions, and the other inputs of the vertices.
    pub vertices: Vec<(Semantic, String)>,
    pub vertices_id: String,
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub streams: Vec<CornerStream>,
    /// The material symbol of each run of triangles, with the first triangle.
    pub symbols: Vec<(usize, String)>,
}

/// The corners of one polygon: its vertices, and the rows of each stream.
#[derive(Debug, Default)]
pub(super) struct PolygonCorners {
    pub vertices: Vec<u32>,
    /// For each stream of the geometry the rows, or empty.
    pub rows: Vec<Vec<u32>>,
}

impl PolygonCorners {
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.rows.iter_mut().for_each(Vec::clear);
    }
}

/// The context in which a polygon is read.
pub(super) struct FaceScope<'s> {
    pub limits: &'s Limits,
    pub warnings: &'s mut Warnings,
    pub place: &'s dyn Fn() -> FileLocation,
}

/// Triangulates polygons.
#[derive(Default)]
pub(super) struct PolygonCutter {
    triangulator: Triangulator,
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl ColladaGeometry {
    /// Appends a polygon, cut into triangles.
    ///
    /// # Errors
    /// `too-many-rows`.
    pub(super) fn push(
        &mut self,
        corners: &PolygonCorners,
        cutter: &mut PolygonCutter,
        scope: &mut FaceScope<'_>,
    ) -> Result<(), ReadError> {
        let n = corners.vertices.len();
        let FaceScope { limits, warnings, place } = scope;
        if n < 3 {
            warnings.count("short-faces", || (place(), crate::faces::SHORT_FACES.to_owned()));
            return Ok(());
        }
        let rows = (self.faces.len() + n - 2) as u64;
        // Half-edges are counted in 31 bits.
        let most = limits.rows.min(u64::from(u32::MAX / 6));
        if rows > most {
            return Err(too_many_rows(place(), "triangles of a mesh", rows, most));
        }
        cutter.triangles.clear();
        if n == 3 {
            cutter.triangles.push([0, 1, 2]);
        } else {
            let message = "faces of more than 3 corners were cut into triangles";
            warnings.count("polygons-cut", || (place(), message.to_owned()));
            let is_long = n > LONG && n > self.positions.len() + self.positions.len() / 2;
            let folded = if is_long {
                cutter.triangles.extend((2..n as u32).map(|k| [0, k - 1, k]));
                1
            } else {
                let point =
                    |i: &u32| self.positions[*i as usize].map(|x| if x.is_finite() { x } else { 0.0 });
                cutter.points.clear();
                cutter.points.extend(corners.vertices.iter().map(point));
                cutter.triangulator.polygon(&cutter.points, &mut cutter.triangles)
            };
            if folded > 0 {
                let message = format!("a polygon of {n} corners crosses or overlaps itself");
                warnings.count("polygon-overlaps", || (place(), message));
            }
        }
        for triangle in &cutter.triangles {
            push(&mut self.faces, triangle.map(|k| corners.vertices[k as usize]))?;
            for (stream, rows) in self.streams.iter_mut().zip(&corners.rows) {
                for k in triangle {
                    push(&mut stream.rows, rows.get(*k as usize).copied().unwrap_or(NO_ROW))?;
                }
            }
        }
        Ok(())
    }

    /// Drops the sources that no corner stream uses.
    pub(super) fn drop_unused_sources(&mut self) {
        let Self { sources, streams, .. } = self;
        sources.retain(|id, _| streams.iter().any(|stream| stream.runs.iter().any(|(_, of)| of == id)));
    }

    /// The part for this mesh; `number` maps material symbols to numbers.
    pub(super) fn part(
        mut self,
        number: &dyn Fn(&str) -> u32,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Part, ReadError> {
        let n = self.faces.len();
        let mut attributes = Vec::new();
        for stream in std::mem::take(&mut self.streams) {
            attributes.extend(self.attribute(stream)?);
        }
        let ends = self.symbols.iter().skip(1).map(|(first, _)| *first).chain([n]);
        let mut values: Vec<f64> = with_room(n)?;
        for ((_, symbol), end) in self.symbols.iter().zip(ends) {
            values.resize(end, f64::from(number(symbol)));
        }
        if values.iter().any(|number| *number > 0.0) {
            let semantic = Semantic::Group(MATERIAL.to_owned());
            attributes.push(Attribute { semantic, domain: Domain::Face, width: 1, values });
        }
        let raw = RawMesh { positions: self.positions, position_id: None, faces: self.faces, attributes };
        let name = if self.name.is_empty() { self.id } else { self.name };
        Ok(Part { name, mesh: mesh(raw, limits, warnings)?, indexed: true, ..Part::default() })
    }

    /// The values of corners, if any has one.
    fn attribute(&self, stream: CornerStream) -> Result<Option<Attribute>, ReadError> {
        let CornerStream { semantic, width, runs, mut rows } = stream;
        let n = 3 * self.faces.len();
        // Corners of primitives after the last one with values.
        let missing = n.saturating_sub(rows.len());
        crate::grow::push_many(&mut rows, NO_ROW, missing)?;
        if rows.iter().all(|row| *row == NO_ROW) {
            return Ok(None);
        }
        let blank = if matches!(semantic, Semantic::Color(_)) { 1.0 } else { 0.0 };
        let mut values = with_room(n.saturating_mul(width))?;
        let ends = runs.iter().skip(1).map(|(first, _)| *first).chain([n]);
        values.resize(runs.first().map_or(n, |(first, _)| *first) * width, blank);
        for ((first, id), end) in runs.iter().zip(ends) {
            let source = self.sources.get(id);
            for row in &rows[*first..end] {
                let source_row = source.and_then(|source| source.row(*row)).unwrap_or(&[]);
                values.extend((0..width).map(|k| source_row.get(k).copied().unwrap_or(blank)));
            }
        }
        Ok(Some(Attribute { semantic, domain: Domain::Corner, width, values }))
    }
}
