//! `PartInstance`: the parts of a scene under the transforms of their nodes, for formats without nodes.
use crate::matrix::{IDENTITY, product};
use crate::{Part, Scene, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::math::unit;
use std::borrow::Cow;

/// A part as shown by a node.
#[derive(Clone, Debug)]
pub(crate) struct PartInstance<'a> {
    /// The part as in the file, or posed if a skin or morph targets move it at rest.
    pub(crate) part: Cow<'a, Part>,
    /// The name of the node, or of the part if the node has none.
    pub(crate) name: &'a str,
    transform: Option<InstanceTransform>,
}

/// An affine map other than the identity.
#[derive(Clone, Debug)]
struct InstanceTransform {
    columns: [[f64; 3]; 3],
    origin: [f64; 3],
    /// The cofactor matrix, with the sign of the determinant, which transforms normals.
    normals: [[f64; 3]; 3],
    is_mirror: bool,
}

impl Scene {
    /// Every part with the transforms of its node applied, in scene coordinates. Each has the name of the
    /// node, or of the part if the node has none. They come in the order of the tree: a part that two nodes
    /// show comes twice, one that no node shows is left out.
    ///
    /// Positions are rounded once for each transform. Normals and tangents are transformed and stay of unit
    /// length. Mirrored parts are wound the other way round, so that the front stays the front. Parts without
    /// a transform are borrowed and cost nothing. Parts moved by a skin or morph targets are in their [rest
    /// pose](crate::RestPose), without the attributes that pose them.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] if the nodes are not a tree, a matrix is not affine, or a position
    /// overflows.
    ///
    /// ```
    /// use chordal::Mesh;
    /// use chordal_io::{Frame, Scene};
    /// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let mut scene = Scene::from_mesh("triangle", mesh, Frame::default());
    /// scene.nodes[0].matrix[0] = -2.0;
    /// let (name, placed) = &scene.world_meshes()?[0];
    /// assert_eq!((*name, placed.positions()[1], placed.faces()[0]), ("triangle", [-2.0, 0.0, 0.0], [0, 2, 1]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn world_meshes(&self) -> Result<Vec<(&str, Cow<'_, Mesh>)>, WriteError> {
        part_instances(self)?.into_iter().map(|placed| Ok((placed.name, placed.mesh()?))).collect()
    }
}

/// The most triangles and vertices of parts, counted once for each instance: a small file can show one large
/// mesh a million times. Chosen: about 4 GB.
const MOST_PLACED_ROWS: usize = 100_000_000;

/// Every instance of a part, in the order of the tree.
///
/// # Errors
/// [`WriteError::Unsupported`] if the nodes are not a tree, or a matrix is not affine.
pub(crate) fn part_instances(scene: &Scene) -> Result<Vec<PartInstance<'_>>, WriteError> {
    let mut seen = vec![false; scene.nodes.len()];
    // Reversed, since the last item of the stack is taken first.
    let mut open: Vec<(usize, [f64; 16])> = scene.roots.iter().rev().map(|root| (*root, IDENTITY)).collect();
    let mut instances = Vec::new();
    let mut rows = 0_usize;
    let poses = scene.rest_poses();
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
            rows = rows.saturating_add(part.mesh.faces().len().saturating_add(part.mesh.positions().len()));
            if rows > MOST_PLACED_ROWS {
                return Err(unsupported(
                    "shows one part too many: written out they have more than 100,000,000 rows",
                ));
            }
            let name = if node.name.is_empty() { &part.name } else { &node.name };
            // A pose has the positions in the scene already, so no transform is left to apply.
            instances.push(match poses.pose(index)? {
                Some(pose) => {
                    let part = Cow::Owned(Part { mesh: pose.posed(&part.mesh)?, ..part.clone() });
                    PartInstance { part, name, transform: None }
                }
                None => {
                    let transform = InstanceTransform::from_matrix(&matrix);
                    PartInstance { part: Cow::Borrowed(part), name, transform }
                }
            });
        }
        open.extend(node.children.iter().rev().map(|child| (*child, matrix)));
    }
    Ok(instances)
}

impl InstanceTransform {
    fn from_matrix(matrix: &[f64; 16]) -> Option<Self> {
        if *matrix == IDENTITY {
            return None;
        }
        let column = |k: usize| [matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]];
        let columns = [column(0), column(1), column(2)];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        // Normals turn by the inverse transpose. The cofactors are a multiple of it, and exist for
        // singular matrices too; the sign of that multiple, negative for mirrors, is taken out
        // below.
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

impl<'a> PartInstance<'a> {
    /// The mesh in scene coordinates.
    fn mesh(&self) -> Result<Cow<'a, Mesh>, WriteError> {
        let mesh = &self.part.mesh;
        let Some(transform) = &self.transform else {
            return Ok(match &self.part {
                Cow::Borrowed(part) => Cow::Borrowed(&part.mesh),
                Cow::Owned(part) => Cow::Owned(part.mesh.clone()),
            });
        };
        let positions = (0..mesh.positions().len()).map(|i| self.position(i)).collect::<Result<_, _>>()?;
        let order = self.order();
        let faces = mesh.faces().iter().map(|face| order.map(|corner| face[corner])).collect();
        let mut moved = Mesh::new(positions, faces);
        if let Some(id) = mesh.position_id() {
            moved = moved.and_then(|moved| moved.with_position_id(id.to_vec()));
        }
        for attribute in mesh.attributes() {
            let values = self.transform_attribute(attribute, transform);
            moved = moved.and_then(|moved| moved.with_attribute(Attribute { values, ..attribute.clone() }));
        }
        // The rows are those of a valid mesh, and equal positions stay equal.
        moved.map(Cow::Owned).map_err(|error| WriteError::Unsupported(error.to_string()))
    }

    /// The values of an attribute in scene coordinates, in the order of the instance's corners.
    fn transform_attribute(&self, attribute: &Attribute, transform: &InstanceTransform) -> Vec<f64> {
        let rows = attribute.values.len() / attribute.width;
        let order = self.order();
        let source = |row: usize| match attribute.domain {
            Domain::Corner => 3 * (row / 3) + order[row % 3],
            Domain::Vertex | Domain::Face => row,
        };
        let turn = |row: usize| -> Vec<f64> {
            let row = attribute.row(source(row));
            match (&attribute.semantic, row) {
                (Semantic::Normal, [_, _, _, rest @ ..]) => [&self.normal(row)[..], rest].concat(),
                (Semantic::Tangent, [x, y, z, sign, rest @ ..]) => {
                    // The bitangent is sign · normal × tangent, and a mirror reverses the cross
                    // product.
                    let sign = if transform.is_mirror { -sign } else { *sign };
                    let tangent = unit(combine(&transform.columns, [*x, *y, *z])).unwrap_or_default();
                    [&tangent[..], &[sign], rest].concat()
                }
                _ => row.to_vec(),
            }
        };
        (0..rows).flat_map(turn).collect()
    }

    /// The position of a vertex in scene coordinates.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] if it overflows.
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

    /// The normal of a row in scene coordinates: of unit length, or zero if there is none.
    pub(crate) fn normal(&self, row: &[f64]) -> [f64; 3] {
        let normal = [row[0], row[1], row[2]];
        let Some(transform) = &self.transform else { return normal };
        // Zero if it has no direction.
        unit(combine(&transform.normals, normal)).unwrap_or_default()
    }

    /// The corners of a face, numbered 0 to 2, ordered so that its front is counter-clockwise.
    pub(crate) fn order(&self) -> [usize; 3] {
        if self.transform.as_ref().is_some_and(|t| t.is_mirror) { [0, 2, 1] } else { [0, 1, 2] }
    }

    /// The vertex attribute of a semantic, if its rows have at least that width.
    pub(crate) fn vertex_attribute(&self, semantic: &Semantic, width: usize) -> Option<&Attribute> {
        let attribute = self.part.mesh.attribute(semantic)?;
        (attribute.domain == Domain::Vertex && attribute.width >= width).then_some(attribute)
    }

    /// For each vertex the first vertex at the same position.
    pub(crate) fn first_rows(&self) -> Vec<u32> {
        first_rows(&self.part.mesh)
    }
}

/// For each vertex of a mesh the first vertex at the same position.
pub(crate) fn first_rows(mesh: &Mesh) -> Vec<u32> {
    let n = mesh.positions().len() as u32;
    let Some(id) = mesh.position_id() else { return (0..n).collect() };
    let mut first = vec![u32::MAX; id.len()];
    (0..n)
        .zip(id)
        .map(|(row, id)| {
            let first_row = &mut first[*id as usize];
            *first_row = if *first_row == u32::MAX { row } else { *first_row };
            *first_row
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, Node};

    #[test]
    fn refuses_to_write_out_a_small_mesh_shown_without_end() {
        let n = 20_000;
        let positions = (0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let mesh = Mesh::new(positions, vec![[0, 1, 2]; 10_000]).expect("valid");
        let mut scene = Scene::from_mesh("", mesh, Frame::default());
        let node = scene.nodes[0].clone();
        scene.nodes = vec![node; 4000];
        scene.roots = (0..4000).collect();
        assert!(matches!(scene.world_meshes(), Err(WriteError::Unsupported(_))));
    }

    /// A corner of a cube with a normal and a tangent on each vertex and a number on each corner. It is shown
    /// unchanged, and again by a child node, mirrored in x and stretched by two in y.
    fn scene() -> Scene {
        let stream = |semantic, domain, width, values: &[f64]| Attribute {
            semantic,
            domain,
            width,
            values: values.repeat(if domain == Domain::Vertex { 3 } else { 1 }),
        };
        let mesh = Mesh::new(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], vec![[0, 1, 2]])
            .and_then(|mesh| {
                mesh.with_attribute(stream(Semantic::Normal, Domain::Vertex, 3, &[0.6, 0.8, 0.0]))
            })
            .and_then(|mesh| {
                mesh.with_attribute(stream(Semantic::Tangent, Domain::Vertex, 4, &[-0.8, 0.6, 0.0, 1.0]))
            })
            .and_then(|mesh| {
                mesh.with_attribute(stream(
                    Semantic::Custom("n".into()),
                    Domain::Corner,
                    1,
                    &[10.0, 11.0, 12.0],
                ))
            })
            .unwrap();
        let mut scene = Scene::from_mesh("part", mesh, Frame::default());
        let mut matrix = IDENTITY;
        (matrix[0], matrix[5], matrix[14]) = (-1.0, 2.0, 5.0);
        scene.nodes.push(Node {
            name: "there".into(),
            matrix: matrix.into(),
            part: Some(0),
            ..Node::default()
        });
        scene.nodes[0].children.push(1);
        scene
    }

    #[test]
    fn a_part_comes_once_for_each_place_with_everything_turned_along() {
        let scene = scene();
        let meshes = scene.world_meshes().unwrap();
        let [(first, plain), (second, mirrored)] = &meshes[..] else { panic!("two places") };
        assert_eq!((*first, *second), ("part", "there"));
        assert!(matches!(plain, Cow::Borrowed(mesh) if *mesh == &scene.parts[0].mesh));
        assert_eq!(mirrored.positions(), [[-1.0, 0.0, 5.0], [0.0, 2.0, 5.0], [0.0, 0.0, 6.0]]);
        // One mirror flips the winding once: the front stays the front, and corner values stay with their
        // corners.
        assert_eq!(mirrored.faces(), [[0, 2, 1]]);
        let row = |semantic: &Semantic, i: usize| mirrored.attribute(semantic).unwrap().row(i).to_vec();
        assert_eq!([0, 1, 2].map(|i| row(&Semantic::Custom("n".into()), i)[0]), [10.0, 12.0, 11.0]);
        let (normal, tangent) = (row(&Semantic::Normal, 0), row(&Semantic::Tangent, 0));
        // Normals shrink along an axis that is stretched: (−0.6, 0.4) and (0.8, 1.2), at length 1.
        let close = |a: &[f64], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 4.0 * f64::EPSILON);
        assert!(close(&normal, [-0.6, 0.4, 0.0].map(|x| x / 0.52_f64.sqrt())), "{normal:?}");
        assert!(close(&tangent[..3], [0.8, 1.2, 0.0].map(|x| x / 2.08_f64.sqrt())), "{tangent:?}");
        assert_eq!(tangent[3], -1.0, "the bitangent is on the other side of a mirrored pair");
    }

    #[test]
    fn a_scene_that_is_no_tree_or_leaves_the_numbers_has_no_world() {
        let mut twice = scene();
        twice.roots.push(1);
        let mut huge = scene();
        huge.nodes[1].matrix[0] = 1e308;
        huge.nodes[0].matrix[0] = 1e308;
        let mut lost = scene();
        lost.nodes[1].part = Some(7);
        for scene in [twice, huge, lost] {
            assert!(matches!(scene.world_meshes(), Err(WriteError::Unsupported(_))));
        }
    }
}
