//! The arrays of triangles and polylines for Python.
use crate::array::{Array, ArrayData};
use chordal::explicit::Polyline;
use chordal_io::{PathSet, Polylines, WriteError};
use chordal_verbs::{MeshOutcome, Scene};
use std::borrow::Cow;
use std::sync::Arc;

/// The rows of everything that a scene shows, part by part, in the scene's coordinates and the order of its
/// tree, as in a file of one mesh.
pub(crate) struct ShownRows {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl ShownRows {
    /// `None` if the scene shows its only part untransformed.
    pub(crate) fn from_scene(scene: &Scene) -> Result<Option<Self>, WriteError> {
        let meshes = scene.world_meshes()?;
        if let ([(_, Cow::Borrowed(_))], [_]) = (&meshes[..], &scene.parts[..]) {
            return Ok(None);
        }
        let mut rows = Self { vertices: Vec::new(), faces: Vec::new() };
        for (_, mesh) in &meshes {
            // An overflow here is harmless: `array` refuses faces if there are more than 2³¹ vertices.
            let first = rows.vertices.len() as u32;
            rows.vertices.extend_from_slice(mesh.positions());
            let faces = mesh.faces().iter().map(|face| face.map(|index| first.saturating_add(index)));
            rows.faces.extend(faces);
        }
        Ok(Some(rows))
    }

    /// An array by its name. Indices are signed in Python, which halves their range.
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

/// The rows of a mesh.
pub(crate) enum TriangleRows {
    /// The rows of its only part.
    Only(Arc<MeshOutcome>),
    Joined(Arc<ShownRows>),
}

impl TriangleRows {
    pub(crate) fn from_outcome(outcome: &Arc<MeshOutcome>) -> Result<Self, WriteError> {
        let shown = outcome.scene().map(ShownRows::from_scene).transpose()?.flatten();
        Ok(shown.map_or_else(|| Self::Only(Arc::clone(outcome)), |rows| Self::Joined(Arc::new(rows))))
    }

    /// An array by its name.
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

/// The rows of all polylines in order.
pub(crate) struct PolylineRows {
    /// All coordinates.
    points: Vec<f64>,
    /// The number of coordinates of a point.
    width: usize,
    /// The parameter of each point on its curve.
    places: Vec<f64>,
    /// The index of the first point of each polyline, then the number of all points.
    starts: Vec<i64>,
    /// For each polyline whether it is closed.
    closed: Vec<i64>,
    /// The index of the element of each polyline in the file.
    sources: Vec<i64>,
}

impl PolylineRows {
    pub(crate) fn from_polylines(lines: &Polylines) -> Self {
        match lines {
            Polylines::Plane(paths) => Self::from_paths(paths),
            Polylines::Space(paths) => Self::from_paths(paths),
        }
    }

    fn from_paths<const D: usize>(paths: &PathSet<Polyline<D>>) -> Self {
        let n_points = paths.lines.iter().map(|line| line.points.len()).sum();
        let n_lines = paths.lines.len();
        let mut rows = Self {
            points: Vec::with_capacity(n_points * D),
            width: D,
            places: Vec::with_capacity(n_points),
            starts: Vec::with_capacity(n_lines + 1),
            closed: Vec::with_capacity(n_lines),
            sources: Vec::with_capacity(n_lines),
        };
        for (index, line) in paths.lines.iter().enumerate() {
            rows.starts.push((rows.points.len() / D) as i64);
            rows.closed.push(i64::from(line.closed));
            rows.sources.push(paths.element_of(index).map_or(index as i64, |element| element.source as i64));
            rows.points.extend_from_slice(line.points.as_flattened());
            rows.places.extend_from_slice(&line.places);
        }
        rows.starts.push((rows.points.len() / D) as i64);
        rows
    }

    /// An array by its name.
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
