//! `Draft`: the rows and faces of a mesh to be, each with the place in the old one that its attributes come from.
use super::mended::refused;
use crate::Mesh;
use crate::budget::{Code, Stopped};
use crate::explicit::{Attribute, Domain, Semantic};

/// The attributes of one old row, or of a place between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    from: u32,
    to: u32,
    /// 0 at `from`, 1 at `to`.
    t: f64,
}

impl Blend {
    pub fn of(row: u32) -> Self {
        Self { from: row, to: row, t: 0.0 }
    }

    /// The place `t` of the way from one to the other.
    pub fn between([from, to]: [u32; 2], t: f64) -> Self {
        Self { from, to, t }
    }
}

/// A row to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub at: [f64; 3],
    /// Rows of one label are one position.
    pub label: u32,
    pub source: Blend,
}

/// A face to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub rows: [u32; 3],
    /// The old face that it has the attributes of.
    pub source: u32,
    /// The same for its corners, in the numbering of half-edges.
    pub corners: [Blend; 3],
}

impl Face {
    /// An old face as it is.
    pub fn kept(mesh: &Mesh, face: u32) -> Self {
        let corners = [0, 1, 2].map(|k| Blend::of(3 * face + k));
        Self { rows: mesh.faces()[face as usize], source: face, corners }
    }

    /// The other way round; the first corner stays the first.
    pub fn turned(self) -> Self {
        let ([a, b, c], [p, q, r]) = (self.rows, self.corners);
        Self { rows: [a, c, b], corners: [p, r, q], ..self }
    }
}

/// A mesh to be.
pub(super) struct Draft<'a> {
    mesh: &'a Mesh,
    pub rows: Vec<Row>,
    pub faces: Vec<Face>,
}

impl<'a> Draft<'a> {
    /// All rows of `mesh`, tied as they are, and no face.
    pub fn without_faces(mesh: &'a Mesh) -> Self {
        let row =
            |(i, at): (u32, &[f64; 3])| Row { at: *at, label: mesh.position_of(i), source: Blend::of(i) };
        let rows = (0..).zip(mesh.positions()).map(row).collect();
        Self { mesh, rows, faces: Vec::with_capacity(mesh.faces().len()) }
    }

    /// All old faces as they are.
    pub fn keep_all(&mut self) {
        let mesh = self.mesh;
        self.faces.extend((0..mesh.faces().len() as u32).map(|face| Face::kept(mesh, face)));
    }

    /// One more row, of the label `label`.
    pub fn add_row(&mut self, row: Row) -> u32 {
        // More rows than u32 can number are refused at the end, by their count.
        let number = u32::try_from(self.rows.len()).unwrap_or(u32::MAX);
        self.rows.push(row);
        number
    }

    /// The mesh. Rows of one label get the coordinates of the first of them, which differ at most in the sign of zero.
    pub fn finish(self) -> Result<Mesh, Stopped> {
        let Self { mesh, rows, faces } = self;
        let most = rows.iter().map(|row| row.label as usize + 1).max().unwrap_or(0);
        let mut first = vec![u32::MAX; most];
        let mut ids = Vec::with_capacity(rows.len());
        for (number, row) in (0..).zip(&rows) {
            let known = &mut first[row.label as usize];
            *known = if *known == u32::MAX { number } else { *known };
            ids.push(*known);
        }
        let positions = ids.iter().map(|&id| rows[id as usize].at).collect();
        let is_tied = mesh.position_id().is_some() || (0..).zip(&ids).any(|(row, &id)| row != id);
        let mut made = Mesh::new(positions, faces.iter().map(|face| face.rows).collect());
        if is_tied {
            made = made.and_then(|made| made.with_position_id(ids));
        }
        for attribute in mesh.attributes() {
            let values = match attribute.domain {
                Domain::Vertex => blended(attribute, rows.iter().map(|row| row.source)),
                Domain::Corner => blended(attribute, faces.iter().flat_map(|face| face.corners)),
                Domain::Face => blended(attribute, faces.iter().map(|face| Blend::of(face.source))),
            };
            made = made.and_then(|made| made.with_attribute(Attribute { values, ..attribute.clone() }));
        }
        // Rows and faces come from a valid mesh: only their number can be too large.
        made.map_err(|error| refused(Code::TooManyTriangles, error.to_string()))
    }
}

fn blended(attribute: &Attribute, sources: impl Iterator<Item = Blend>) -> Vec<f64> {
    let mut values = Vec::with_capacity(attribute.values.len());
    for Blend { from, to, t } in sources {
        let (a, b) = (attribute.row(from as usize), attribute.row(to as usize));
        let is_number = matches!(attribute.semantic, Semantic::Group(_));
        if t == 0.0 || a == b || (is_number && t < 0.5) {
            values.extend_from_slice(a);
        } else if is_number {
            values.extend_from_slice(b);
        } else {
            let start = values.len();
            values.extend(a.iter().zip(b).map(|(a, b)| (1.0 - t) * a + t * b));
            if matches!(attribute.semantic, Semantic::Normal | Semantic::Tangent) {
                make_unit(&mut values[start..]);
            }
        }
    }
    values
}

/// Takes the first three numbers to length 1; leaves them where they have no direction.
fn make_unit(row: &mut [f64]) {
    let length = row.iter().take(3).map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        row.iter_mut().take(3).for_each(|x| *x /= length);
    }
}
