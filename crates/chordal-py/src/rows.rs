//! The numbers of triangles and polylines, in the rows that Python sees.
use crate::array::{Array, ArrayData};
use chordal::explicit::Polyline;
use chordal_io::{PathSet, Polylines, WriteError};
use chordal_verbs::{MeshOutcome, Scene};
use std::borrow::Cow;
use std::sync::Arc;

/// The rows of all that a scene shows, one part after the other, in its own space and the order of its tree: as the file of
/// such a mesh has it.
pub(crate) struct ShownRows {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl ShownRows {
    /// Nothing where the scene shows its only part as it is.
    pub(crate) fn from_scene(scene: &Scene) -> Result<Option<Self>, WriteError> {
        let meshes = scene.world_meshes()?;
        if let ([(_, Cow::Borrowed(_))], [_]) = (&meshes[..], &scene.parts[..]) {
            return Ok(None);
        }
        let mut rows = Self { vertices: Vec::new(), faces: Vec::new() };
        for (_, mesh) in &meshes {
            // Where that is too many for an index, there is no array of faces, for those have one bit less.
            let first = rows.vertices.len() as u32;
            rows.vertices.extend_from_slice(mesh.positions());
            let faces = mesh.faces().iter().map(|face| face.map(|index| first.saturating_add(index)));
            rows.faces.extend(faces);
        }
        Ok(Some(rows))
    }

    /// The numbers of that name. Indices have a sign in Python, which costs the largest half of them.
    pub(crate) fn array(rows: &Arc<Self>, name: &str) -> Option<Array> {
        match name {
            "vertices" => Some(Array::new(rows, |rows| ArrayData::from_f64(rows.vertices.as_flattened(), 3))),
            "faces" => {
                i32::try_from(rows.vertices.len()).ok()?;
                Some(Array::new(rows, |rows| ArrayData::from_u32_below_sign(rows.faces.as_flattened(), 3)))
            }
            _ => None,
        }
    }
}

/// The rows of a mesh that was made.
pub(crate) enum TriangleRows {
    /// Those of its only part.
    Only(Arc<MeshOutcome>),
    Joined(Arc<ShownRows>),
}

impl TriangleRows {
    pub(crate) fn from_outcome(outcome: &Arc<MeshOutcome>) -> Result<Self, WriteError> {
        let shown = outcome.scene().map(ShownRows::from_scene).transpose()?.flatten();
        Ok(shown.map_or_else(|| Self::Only(Arc::clone(outcome)), |rows| Self::Joined(Arc::new(rows))))
    }

    /// The numbers of that name.
    pub(crate) fn array(&self, name: &str) -> Option<Array> {
        let outcome = match self {
            Self::Joined(rows) => return ShownRows::array(rows, name),
            Self::Only(outcome) => outcome,
        };
        match name {
            "vertices" => Some(Array::new(outcome, |outcome| {
                ArrayData::from_f64(single_part(outcome.scene()).0.as_flattened(), 3)
            })),
            "faces" => {
                i32::try_from(single_part(outcome.scene()).0.len()).ok()?;
                Some(Array::new(outcome, |outcome| {
                    ArrayData::from_u32_below_sign(single_part(outcome.scene()).1.as_flattened(), 3)
                }))
            }
            _ => None,
        }
    }
}

fn single_part(scene: Option<&Scene>) -> (&[[f64; 3]], &[[u32; 3]]) {
    let part = scene.and_then(|scene| scene.parts.first());
    part.map_or((&[], &[]), |part| (part.mesh.positions(), part.mesh.faces()))
}

/// The rows of polylines, one after the other.
pub(crate) struct PolylineRows {
    /// All coordinates.
    points: Vec<f64>,
    /// Coordinates of a point.
    width: usize,
    /// For each point its parameter on its curve.
    places: Vec<f64>,
    /// For each polyline the index of its first point, and the number of all points at the end.
    starts: Vec<i64>,
    /// For each polyline whether its last point is joined to its first.
    closed: Vec<i64>,
    /// For each polyline the number of its element in the file.
    sources: Vec<i64>,
}

impl PolylineRows {
    pub(crate) fn from_polylines(lines: &Polylines) -> Self {
        match lines {
            Polylines::Plane(drawn) => Self::from_paths(drawn),
            Polylines::Space(drawn) => Self::from_paths(drawn),
        }
    }

    fn from_paths<const D: usize>(drawn: &PathSet<Polyline<D>>) -> Self {
        let n_points = drawn.lines.iter().map(|line| line.points.len()).sum();
        let n_lines = drawn.lines.len();
        let mut rows = Self {
            points: Vec::with_capacity(n_points * D),
            width: D,
            places: Vec::with_capacity(n_points),
            starts: Vec::with_capacity(n_lines + 1),
            closed: Vec::with_capacity(n_lines),
            sources: Vec::with_capacity(n_lines),
        };
        for (index, line) in drawn.lines.iter().enumerate() {
            rows.starts.push((rows.points.len() / D) as i64);
            rows.closed.push(i64::from(line.closed));
            rows.sources.push(drawn.element_of(index).map_or(index as i64, |element| element.source as i64));
            rows.points.extend_from_slice(line.points.as_flattened());
            rows.places.extend_from_slice(&line.places);
        }
        rows.starts.push((rows.points.len() / D) as i64);
        rows
    }

    /// The numbers of that name.
    pub(crate) fn array(rows: &Arc<Self>, name: &str) -> Option<Array> {
        Some(match name {
            "points" => Array::new(rows, |rows| ArrayData::from_f64(&rows.points, rows.width)),
            "places" => Array::new(rows, |rows| ArrayData::from_f64(&rows.places, 1)),
            "starts" => Array::new(rows, |rows| ArrayData::from_i64(&rows.starts)),
            "closed" => Array::new(rows, |rows| ArrayData::from_i64(&rows.closed)),
            "sources" => Array::new(rows, |rows| ArrayData::from_i64(&rows.sources)),
            _ => return None,
        })
    }
}
