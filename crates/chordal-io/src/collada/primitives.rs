//! `ColladaPrimitive`: lists of faces by the indices of their corners.
use super::geometry::{ColladaGeometry, CornerStream, FaceScope, NO_ROW, PolygonCorners, PolygonCutter};
use crate::grow::{push, push_many};
use crate::text::{LineTokens, grouped, integer, show};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::explicit::Semantic;
use std::borrow::Cow;

/// How a list of indices makes faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PrimitiveKind {
    Triangles,
    /// The list of counts gives the number of corners of each face.
    Polylist,
    /// One index list per polygon.
    Polygons,
    Strips,
    Fans,
}

impl PrimitiveKind {
    /// The kind of an element.
    pub(super) fn from_element(name: &str) -> Option<Self> {
        Some(match name {
            "triangles" => Self::Triangles,
            "polylist" => Self::Polylist,
            "polygons" => Self::Polygons,
            "tristrips" => Self::Strips,
            "trifans" => Self::Fans,
            _ => return None,
        })
    }
}

/// The input that an index of a corner refers to.
#[derive(Clone, Debug)]
pub(super) struct PrimitiveInput {
    pub semantic: String,
    pub source: String,
    pub offset: usize,
}

/// A primitive while it is read.
#[derive(Clone, Debug)]
pub(super) struct ColladaPrimitive<'a> {
    pub kind: PrimitiveKind,
    pub symbol: String,
    pub inputs: Vec<PrimitiveInput>,
    pub counts: Cow<'a, str>,
    /// The lists of indices, each with its byte in the document.
    pub lists: Vec<(Cow<'a, str>, usize)>,
}

/// The most indices per corner. Chosen: a corner has a few.
pub(super) const MOST_INPUTS: usize = 64;

/// The id of a source or an element in this file: a URL without its '#'.
pub(super) fn local(url: &str) -> Option<&str> {
    url.strip_prefix('#')
}

/// The context in which primitives are read.
pub(super) struct PrimitiveScope<'s> {
    pub limits: &'s Limits,
    pub warnings: &'s mut Warnings,
    /// The location of a byte of the document.
    pub place: &'s dyn Fn(usize) -> FileLocation,
}

impl ColladaPrimitive<'_> {
    /// Appends the faces to the geometry.
    ///
    /// # Errors
    /// If an index is invalid, out of range or missing, or there is no list of vertices.
    pub(super) fn read(
        &self,
        geometry: &mut ColladaGeometry,
        scope: &mut PrimitiveScope<'_>,
    ) -> Result<(), ReadError> {
        let at = self.lists.first().map_or(0, |(_, at)| *at);
        let Some(vertex) = self.inputs.iter().find(|input| input.semantic == "VERTEX") else {
            return Err(refuse(scope, at, "no-vertices-input", "the faces have no input VERTEX".to_owned()));
        };
        if local(&vertex.source) != Some(&geometry.vertices_id) || geometry.vertices_id.is_empty() {
            let message = format!("the vertices {} are not there", show(vertex.source.as_bytes()));
            return Err(refuse(scope, at, "missing-source", message));
        }
        let first = geometry.faces.len();
        // Faces are numbered through all primitives; a symbol holds from its first face to the next
        // symbol.
        if geometry.symbols.last().is_none_or(|(_, symbol)| *symbol != self.symbol) {
            push(&mut geometry.symbols, (first, self.symbol.clone()))?;
        }
        // Pairs of a stream and the offset of its index: the corner's own inputs, and those of its vertex.
        let mut plan: Vec<(usize, usize)> = Vec::new();
        for (semantic, source) in geometry.vertices.clone() {
            if let Some(stream) = stream(geometry, semantic, &source, first)? {
                plan.push((stream, vertex.offset));
            }
        }
        let (mut n_texcoords, mut n_colors) = (0, 0);
        for input in &self.inputs {
            let semantic = match &*input.semantic {
                "NORMAL" => Semantic::Normal,
                "TEXCOORD" => {
                    n_texcoords += 1;
                    Semantic::TexCoord(n_texcoords - 1)
                }
                "COLOR" => {
                    n_colors += 1;
                    Semantic::Color(n_colors - 1)
                }
                "VERTEX" => continue,
                other => {
                    let message = format!("values of corners were skipped, {} first", show(other.as_bytes()));
                    scope.warnings.count("inputs-skipped", || ((scope.place)(at), message));
                    continue;
                }
            };
            let source = local(&input.source).filter(|id| geometry.sources.contains_key(*id));
            let Some(source) = source.map(str::to_owned) else {
                let message = format!("the source {} is not there", show(input.source.as_bytes()));
                return Err(refuse(scope, at, "missing-source", message));
            };
            if let Some(stream) = stream(geometry, semantic, &source, first)? {
                plan.push((stream, input.offset));
            }
        }
        // Several inputs may share an offset, so the largest counts and not their number.
        let stride = self.inputs.iter().map(|input| input.offset + 1).max().unwrap_or(1);
        let mut reader = IndexReader { plan, stride, vertex: vertex.offset, row: vec![0; stride] };
        self.faces(geometry, &mut reader, scope)
    }

    fn faces(
        &self,
        geometry: &mut ColladaGeometry,
        reader: &mut IndexReader,
        scope: &mut PrimitiveScope<'_>,
    ) -> Result<(), ReadError> {
        let mut cutter = PolygonCutter::default();
        let mut corners =
            PolygonCorners { vertices: Vec::new(), rows: vec![Vec::new(); geometry.streams.len()] };
        let mut counts = LineTokens::new(self.counts.as_bytes());
        for (text, at) in &self.lists {
            let mut list = IndexList { text, at: *at, tokens: LineTokens::new(text.as_bytes()) };
            let bad = |scope: &PrimitiveScope<'_>, what: &str| {
                Err(refuse(scope, *at, "truncated", format!("the list of indices {what}")))
            };
            corners.clear();
            match self.kind {
                PrimitiveKind::Triangles => {
                    while reader.corner(geometry, &mut list, &mut corners, scope)? {
                        if corners.vertices.len() == 3 {
                            emit(geometry, &corners, &mut cutter, *at, scope)?;
                            corners.clear();
                        }
                    }
                    if !corners.vertices.is_empty() {
                        return bad(scope, "ends inside a triangle");
                    }
                }
                PrimitiveKind::Polylist => {
                    for token in counts.by_ref() {
                        let n = integer(token).ok().and_then(|n| u64::try_from(n).ok());
                        let Some(n) = n else {
                            let message = format!("{} is no number of corners", show(token));
                            return Err(refuse(scope, *at, "not-a-number", message));
                        };
                        corners.clear();
                        for _ in 0..n {
                            if !reader.corner(geometry, &mut list, &mut corners, scope)? {
                                return bad(scope, "ends before the polygons that are counted");
                            }
                        }
                        emit(geometry, &corners, &mut cutter, *at, scope)?;
                    }
                    if list.tokens.next().is_some() {
                        let message = "indices after the last polygon were not used";
                        scope
                            .warnings
                            .count("indices-left-over", || ((scope.place)(*at), message.to_owned()));
                    }
                }
                PrimitiveKind::Polygons => {
                    // Each list is one polygon here, and one strip or fan below.
                    while reader.corner(geometry, &mut list, &mut corners, scope)? {}
                    emit(geometry, &corners, &mut cutter, *at, scope)?;
                }
                PrimitiveKind::Strips | PrimitiveKind::Fans => {
                    let mut strip =
                        PolygonCorners { vertices: Vec::new(), rows: vec![Vec::new(); corners.rows.len()] };
                    while reader.corner(geometry, &mut list, &mut strip, scope)? {}
                    for k in 2..strip.vertices.len() {
                        let triple = match (self.kind, k % 2) {
                            (PrimitiveKind::Fans, _) => [0, k - 1, k],
                            (_, 0) => [k - 2, k - 1, k],
                            // Every second triangle of a strip has the opposite orientation.
                            _ => [k - 1, k - 2, k],
                        };
                        let [a, b, c] = triple.map(|i| strip.vertices[i]);
                        if a == b || b == c || c == a {
                            let message = "triangles of strips that only lead to the next place were dropped";
                            scope
                                .warnings
                                .count("strip-stitches", || ((scope.place)(*at), message.to_owned()));
                            continue;
                        }
                        corners.clear();
                        corners.vertices.extend([a, b, c]);
                        for (rows, strip) in corners.rows.iter_mut().zip(&strip.rows) {
                            rows.extend(triple.iter().filter_map(|i| strip.get(*i)));
                        }
                        emit(geometry, &corners, &mut cutter, *at, scope)?;
                    }
                }
            }
        }
        Ok(())
    }
}

fn emit(
    geometry: &mut ColladaGeometry,
    corners: &PolygonCorners,
    cutter: &mut PolygonCutter,
    at: usize,
    scope: &mut PrimitiveScope<'_>,
) -> Result<(), ReadError> {
    let place = scope.place;
    let mut of_face =
        FaceScope { limits: scope.limits, warnings: &mut *scope.warnings, place: &|| place(at) };
    geometry.push(corners, cutter, &mut of_face)
}

fn refuse(scope: &PrimitiveScope<'_>, at: usize, code: &'static str, message: String) -> ReadError {
    ReadError::new(code, (scope.place)(at), message)
}

/// The stream of a semantic; its corners from triangle `first` on take their values from a source. `None` if
/// the source has too few numbers per row.
fn stream(
    geometry: &mut ColladaGeometry,
    semantic: Semantic,
    source: &str,
    first: usize,
) -> Result<Option<usize>, ReadError> {
    let source_width = geometry.sources.get(source).map_or(0, |source| source.width);
    let width = match &semantic {
        Semantic::Normal if source_width >= 3 => 3,
        Semantic::TexCoord(_) if source_width >= 2 => 2,
        Semantic::Color(_) if source_width >= 3 => source_width.min(4),
        _ => return Ok(None),
    };
    let existing =
        geometry.streams.iter().position(|stream| stream.semantic == semantic && stream.width == width);
    let index = match existing {
        Some(index) => index,
        None => {
            push(
                &mut geometry.streams,
                CornerStream { semantic, width, runs: Vec::new(), rows: Vec::new() },
            )?;
            geometry.streams.len() - 1
        }
    };
    let stream = &mut geometry.streams[index];
    // Earlier primitives had no such values.
    let missing = (3 * first).saturating_sub(stream.rows.len());
    push_many(&mut stream.rows, NO_ROW, missing)?;
    push(&mut stream.runs, (3 * first, source.to_owned()))?;
    Ok(Some(index))
}

/// A list of indices.
struct IndexList<'t> {
    text: &'t str,
    at: usize,
    tokens: LineTokens<'t>,
}

/// Reads the indices of corners.
struct IndexReader {
    /// The streams, with the offset of their index.
    plan: Vec<(usize, usize)>,
    stride: usize,
    vertex: usize,
    row: Vec<u32>,
}

impl IndexReader {
    /// Reads the next corner; false at the end of the list.
    fn corner(
        &mut self,
        geometry: &ColladaGeometry,
        list: &mut IndexList<'_>,
        corners: &mut PolygonCorners,
        scope: &PrimitiveScope<'_>,
    ) -> Result<bool, ReadError> {
        for k in 0..self.stride {
            let Some(token) = list.tokens.next() else {
                if k == 0 {
                    return Ok(false);
                }
                return Err(refuse(
                    scope,
                    list.at,
                    "truncated",
                    "the list of indices ends inside a corner".to_owned(),
                ));
            };
            let index = integer(token).ok().and_then(|index| u32::try_from(index).ok());
            // The largest number means that a corner has no value.
            match index.filter(|index| *index != NO_ROW) {
                Some(index) => self.row[k] = index,
                None => {
                    let message = format!("{} is no index", show(token));
                    return Err(refuse(scope, list.at + offset(list.text, token), "not-a-number", message));
                }
            }
        }
        let vertex = self.row[self.vertex];
        let n = geometry.positions.len() as u64;
        if u64::from(vertex) >= n {
            let message =
                format!("index {vertex} is out of range: there are {} vertices, from 0", grouped(n));
            return Err(refuse(scope, list.at, "index-out-of-range", message));
        }
        push(&mut corners.vertices, vertex)?;
        for (stream, offset) in &self.plan {
            let row = self.row[*offset];
            let source = geometry.streams[*stream].runs.last().and_then(|(_, id)| geometry.sources.get(id));
            let n = source.map_or(0, |source| source.count);
            if u64::from(row) >= n {
                let message =
                    format!("index {row} is out of range: the source has {} rows, from 0", grouped(n));
                return Err(refuse(scope, list.at, "index-out-of-range", message));
            }
            push(&mut corners.rows[*stream], row)?;
        }
        Ok(true)
    }
}

fn offset(text: &str, token: &[u8]) -> usize {
    (token.as_ptr() as usize).saturating_sub(text.as_ptr() as usize).min(text.len())
}
