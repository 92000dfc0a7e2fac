//! `MendBuilder`: the rows and faces of a new mesh, each with the element of the old mesh from which its
//! attributes come.
use super::mended_mesh::refusal;
use crate::Mesh;
use crate::budget::{Job, JobError, RefusalCode};
use crate::explicit::{Attribute, Domain, Semantic};

/// Checks whether a repair may start: the job is not cancelled, and its memory limit is sufficient.
pub(super) fn check_limits(mesh: &Mesh, job: &Job) -> Result<(), JobError> {
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    // Counted: a face and its sources 64 bytes, in and out 24, twins and sets 48; a row and its source 48, in
    // and out 56.
    let attributes: usize = mesh.attributes().iter().map(|attribute| attribute.values.len()).sum();
    let bytes = 136 * mesh.faces().len() + 104 * mesh.positions().len() + 16 * attributes;
    if bytes as u64 > job.memory_limit {
        let limit = job.memory_limit;
        return Err(refusal(
            RefusalCode::TooMuchMemory,
            format!("mending needs about {bytes} bytes; the limit is {limit}"),
        ));
    }
    Ok(())
}

/// The source of attributes: one old row, or a point between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AttributeSource {
    from: u32,
    to: u32,
    /// 0 at `from`, 1 at `to`.
    t: f64,
}

impl AttributeSource {
    pub fn from_row(row: u32) -> Self {
        Self { from: row, to: row, t: 0.0 }
    }

    /// The point at the parameter `t` between two rows.
    pub fn between([from, to]: [u32; 2], t: f64) -> Self {
        Self { from, to, t }
    }
}

/// A new row.
#[derive(Clone, Copy, Debug)]
pub(super) struct MendRow {
    pub at: [f64; 3],
    /// Rows with the same label are one position.
    pub label: u32,
    pub source: AttributeSource,
}

/// A new face.
#[derive(Clone, Copy, Debug)]
pub(super) struct MendFace {
    pub rows: [u32; 3],
    /// The old face that provides its attributes.
    pub source: u32,
    /// The sources of its corners' attributes, as half-edge numbers.
    pub corners: [AttributeSource; 3],
}

impl MendFace {
    /// An unchanged old face.
    pub fn from_mesh(mesh: &Mesh, face: u32) -> Self {
        let corners = [0, 1, 2].map(|k| AttributeSource::from_row(3 * face + k));
        Self { rows: mesh.faces()[face as usize], source: face, corners }
    }

    /// The face with reversed winding; the first corner stays the first.
    pub fn flipped(self) -> Self {
        let ([a, b, c], [p, q, r]) = (self.rows, self.corners);
        Self { rows: [a, c, b], corners: [p, r, q], ..self }
    }
}

/// A new mesh under construction.
pub(super) struct MendBuilder<'a> {
    mesh: &'a Mesh,
    pub rows: Vec<MendRow>,
    pub faces: Vec<MendFace>,
}

impl<'a> MendBuilder<'a> {
    /// All rows of `mesh`, tied as in `mesh`, and no face.
    pub fn without_faces(mesh: &'a Mesh) -> Self {
        let row = |(i, at): (u32, &[f64; 3])| MendRow {
            at: *at,
            label: mesh.position_of(i),
            source: AttributeSource::from_row(i),
        };
        let rows = (0..).zip(mesh.positions()).map(row).collect();
        Self { mesh, rows, faces: Vec::with_capacity(mesh.faces().len()) }
    }

    /// Adds all old faces unchanged.
    pub fn add_all_faces(&mut self) {
        let mesh = self.mesh;
        self.faces.extend((0..mesh.faces().len() as u32).map(|face| MendFace::from_mesh(mesh, face)));
    }

    /// Adds a row and returns its index.
    pub fn add_row(&mut self, row: MendRow) -> u32 {
        // More rows than u32 can number are refused at the end, by their count.
        let number = u32::try_from(self.rows.len()).unwrap_or(u32::MAX);
        self.rows.push(row);
        number
    }

    /// The mesh. Rows with the same label get the coordinates of the first of them; these differ at most in
    /// the sign of zero.
    pub fn finish(self) -> Result<Mesh, JobError> {
        let Self { mesh, rows, faces } = self;
        let most = rows.iter().map(|row| row.label as usize + 1).max().unwrap_or(0);
        let mut first = vec![u32::MAX; most];
        let mut ids = Vec::with_capacity(rows.len());
        for (number, row) in (0..).zip(&rows) {
            let first_row = &mut first[row.label as usize];
            *first_row = if *first_row == u32::MAX { number } else { *first_row };
            ids.push(*first_row);
        }
        let positions = ids.iter().map(|&id| rows[id as usize].at).collect();
        let is_tied = mesh.position_id().is_some() || (0..).zip(&ids).any(|(row, &id)| row != id);
        let mut result = Mesh::new(positions, faces.iter().map(|face| face.rows).collect());
        if is_tied {
            result = result.and_then(|mesh| mesh.with_position_id(ids));
        }
        for attribute in mesh.attributes() {
            let values = match attribute.domain {
                Domain::Vertex => interpolate(attribute, rows.iter().map(|row| row.source)),
                Domain::Corner => interpolate(attribute, faces.iter().flat_map(|face| face.corners)),
                Domain::Face => {
                    interpolate(attribute, faces.iter().map(|face| AttributeSource::from_row(face.source)))
                }
            };
            result = result.and_then(|mesh| mesh.with_attribute(Attribute { values, ..attribute.clone() }));
        }
        // Rows and faces come from a valid mesh, so only their number can be too large.
        result.map_err(|error| refusal(RefusalCode::TooManyTriangles, error.to_string()))
    }
}

fn interpolate(attribute: &Attribute, sources: impl Iterator<Item = AttributeSource>) -> Vec<f64> {
    let mut values = Vec::with_capacity(attribute.values.len());
    for AttributeSource { from, to, t } in sources {
        let (a, b) = (attribute.row(from as usize), attribute.row(to as usize));
        // A group is a name, and names have no mean: that of the nearer end counts.
        let is_group = matches!(attribute.semantic, Semantic::Group(_));
        // (1 − t)·a + t·a is not always a, so equal rows are copied.
        if t == 0.0 || a == b || (is_group && t < 0.5) {
            values.extend_from_slice(a);
        } else if is_group {
            values.extend_from_slice(b);
        } else {
            let start = values.len();
            values.extend(a.iter().zip(b).map(|(a, b)| (1.0 - t) * a + t * b));
            if matches!(attribute.semantic, Semantic::Normal | Semantic::Tangent) {
                normalize(&mut values[start..]);
            }
        }
    }
    values
}

/// Scales the first three numbers to length 1; leaves them unchanged if they have no direction.
fn normalize(row: &mut [f64]) {
    let length = row.iter().take(3).map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        row.iter_mut().take(3).for_each(|x| *x /= length);
    }
}
