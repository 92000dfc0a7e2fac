//! `placed`: the parts of a scene as they stand in space, for formats without nodes.
use crate::scene::IDENTITY;
use crate::{Part, Scene, WriteError};
use chordal::explicit::{Attribute, Domain, Semantic};

/// A part where a node puts it.
#[derive(Clone, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) part: &'a Part,
    /// The node's name, or else the part's.
    pub(crate) name: &'a str,
    transform: Option<Transform>,
}

/// An affine map that is not the identity.
#[derive(Clone, Debug)]
struct Transform {
    columns: [[f64; 3]; 3],
    origin: [f64; 3],
    /// The cofactors of the columns, with the sign of the determinant: where normals go.
    normals: [[f64; 3]; 3],
    is_mirror: bool,
}

/// Every part that a node shows, in the order of the tree.
///
/// # Errors
/// [`WriteError::Unsupported`] for nodes that are no tree, and matrices that are not affine.
pub(crate) fn placed(scene: &Scene) -> Result<Vec<Placed<'_>>, WriteError> {
    let mut seen = vec![false; scene.nodes.len()];
    let mut open: Vec<(usize, [f64; 16])> = scene.roots.iter().rev().map(|root| (*root, IDENTITY)).collect();
    let mut found = Vec::new();
    while let Some((index, parent)) = open.pop() {
        let unsupported = |what: &str| WriteError::Unsupported(format!("node {index} {what}"));
        let node = scene.nodes.get(index).ok_or_else(|| unsupported("is not there"))?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(unsupported("is reached twice: nodes must be a tree"));
        }
        let matrix = product(&parent, &node.matrix);
        if [matrix[3], matrix[7], matrix[11], matrix[15]] != [0.0, 0.0, 0.0, 1.0] {
            return Err(unsupported("has a matrix that is not affine"));
        }
        if let Some(part) = node.part {
            let part = scene.parts.get(part).ok_or_else(|| unsupported("shows a part that is not there"))?;
            let name = if node.name.is_empty() { &part.name } else { &node.name };
            found.push(Placed { part, name, transform: Transform::of(&matrix) });
        }
        open.extend(node.children.iter().rev().map(|child| (*child, matrix)));
    }
    Ok(found)
}

/// `a · b`, column-major; exactly the other one where one is the identity, also for −0.
fn product(a: &[f64; 16], b: &[f64; 16]) -> [f64; 16] {
    if *a == IDENTITY {
        return *b;
    }
    if *b == IDENTITY {
        return *a;
    }
    std::array::from_fn(|i| {
        let (column, row) = (i / 4, i % 4);
        let term = |k: usize| a[4 * k + row] * b[4 * column + k];
        (term(0) + term(1)) + (term(2) + term(3))
    })
}

impl Transform {
    fn of(matrix: &[f64; 16]) -> Option<Self> {
        if *matrix == IDENTITY {
            return None;
        }
        let column = |k: usize| [matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]];
        let columns = [column(0), column(1), column(2)];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let cofactors =
            [cross(columns[1], columns[2]), cross(columns[2], columns[0]), cross(columns[0], columns[1])];
        let determinant: f64 = (0..3).map(|k| columns[0][k] * cofactors[0][k]).sum();
        let is_mirror = determinant < 0.0;
        let sign = if is_mirror { -1.0 } else { 1.0 };
        let normals = cofactors.map(|column| column.map(|x| sign * x));
        Some(Self { columns, origin: column(3), normals, is_mirror })
    }
}

fn combine(columns: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (columns[0][k] * v[0] + columns[1][k] * v[1]) + columns[2][k] * v[2])
}

impl Placed<'_> {
    /// The position of a vertex in space.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] when it overflows.
    pub(crate) fn position(&self, vertex: usize) -> Result<[f64; 3], WriteError> {
        let position = self.part.mesh.positions()[vertex];
        let Some(transform) = &self.transform else { return Ok(position) };
        let moved = combine(&transform.columns, position);
        let moved: [f64; 3] = std::array::from_fn(|k| moved[k] + transform.origin[k]);
        if moved.iter().all(|x| x.is_finite()) {
            return Ok(moved);
        }
        Err(WriteError::Unsupported(format!(
            "vertex {vertex} of part '{}' is not finite in space",
            self.part.name
        )))
    }

    /// The normal of a row in space: of unit length, or zero where there is none.
    pub(crate) fn normal(&self, row: &[f64]) -> [f64; 3] {
        let normal = [row[0], row[1], row[2]];
        let Some(transform) = &self.transform else { return normal };
        let moved = combine(&transform.normals, normal);
        let largest = moved.iter().fold(0.0_f64, |m, x| if x.abs() > m { x.abs() } else { m });
        if !(largest > 0.0 && largest.is_finite()) {
            return [0.0; 3];
        }
        let scaled = moved.map(|x| x / largest);
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        scaled.map(|x| x / length)
    }

    /// The corners of a face, numbered 0 to 2, in the order in which its front is counter-clockwise.
    pub(crate) fn order(&self) -> [usize; 3] {
        if self.transform.as_ref().is_some_and(|t| t.is_mirror) { [0, 2, 1] } else { [0, 1, 2] }
    }

    /// The attribute of a meaning, if its rows are at least that wide and belong to vertices.
    pub(crate) fn vertex_attribute(&self, semantic: &Semantic, width: usize) -> Option<&Attribute> {
        let attribute = self.part.mesh.attribute(semantic)?;
        (attribute.domain == Domain::Vertex && attribute.width >= width).then_some(attribute)
    }

    /// For each vertex the first vertex at the same position.
    pub(crate) fn first_rows(&self) -> Vec<u32> {
        let mesh = &self.part.mesh;
        let n = mesh.positions().len() as u32;
        let Some(id) = mesh.position_id() else { return (0..n).collect() };
        let mut first = vec![u32::MAX; id.len()];
        (0..n)
            .zip(id)
            .map(|(row, id)| {
                let known = &mut first[*id as usize];
                *known = if *known == u32::MAX { row } else { *known };
                *known
            })
            .collect()
    }
}
