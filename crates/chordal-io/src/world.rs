//! `Scene::world_meshes`: the meshes where their nodes put them.
use crate::scene::IDENTITY;
use crate::{Limits, Part, Scene};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::fmt;

/// Why meshes cannot be put in their places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unplaced {
    /// A node, part or child is not there, or a node has two parents or itself above it.
    NoForest {
        /// The node.
        node: usize,
    },
    /// The instances have more vertices or triangles than the limit.
    TooMany {
        /// The limit.
        limit: u64,
    },
    /// A coordinate overflows.
    NotFinite {
        /// The node.
        node: usize,
    },
}

impl fmt::Display for Unplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoForest { node } => write!(f, "node {node} is not there, or is reached twice"),
            Self::TooMany { limit } => {
                write!(f, "the instances pass the limit of {limit} vertices or triangles")
            }
            Self::NotFinite { node } => write!(f, "the transform of node {node} overflows"),
        }
    }
}

impl std::error::Error for Unplaced {}

impl Scene {
    /// One part for each node that shows one, in the space of the roots, in the order of a walk down from them.
    ///
    /// Matrices are multiplied from the root and applied in f64. What is exact stays exact: permutations of axes, changes
    /// of sign, and translations whose sum is a number. Normals go with the inverse transpose, tangents with the
    /// matrix. A mirror turns triangles around, so that fronts stay fronts. Zero has no sign afterwards.
    ///
    /// Takes time and memory for each instance, up to [`Limits::rows`] vertices and triangles.
    ///
    /// # Errors
    /// [`Unplaced`] when the nodes are no forest, the instances pass the limit, or a coordinate overflows.
    pub fn world_meshes(&self, limits: &Limits) -> Result<Vec<Part>, Unplaced> {
        let mut out = Vec::new();
        let mut seen = vec![false; self.nodes.len()];
        let mut left = limits.rows;
        let mut open: Vec<(usize, [f64; 16])> =
            self.roots.iter().rev().map(|root| (*root, IDENTITY)).collect();
        while let Some((i, above)) = open.pop() {
            let Some(node) = self.nodes.get(i).filter(|_| !std::mem::replace(&mut seen[i], true)) else {
                return Err(Unplaced::NoForest { node: i });
            };
            let matrix = product(&above, &node.matrix);
            open.extend(node.children.iter().rev().map(|child| (*child, matrix)));
            let Some(part) = node.part else { continue };
            let Some(part) = self.parts.get(part) else { return Err(Unplaced::NoForest { node: i }) };
            let n = part.mesh.positions().len().max(part.mesh.faces().len()) as u64;
            left = left.checked_sub(n).ok_or(Unplaced::TooMany { limit: limits.rows })?;
            let mesh = placed(&part.mesh, &matrix).ok_or(Unplaced::NotFinite { node: i })?;
            out.push(Part { name: part.name.clone(), mesh, indexed: part.indexed });
        }
        Ok(out)
    }
}

/// `a · b` of column-major matrices. Products with zero are left out, so that nothing exact is rounded.
fn product(a: &[f64; 16], b: &[f64; 16]) -> [f64; 16] {
    std::array::from_fn(|at| {
        let (column, row) = (at / 4, at % 4);
        sum((0..4).map(|k| (a[4 * k + row], b[4 * column + k])))
    })
}

/// The sum of the products of pairs, in order, without those that are zero.
fn sum(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let terms = pairs.filter(|(a, b)| *a != 0.0 && *b != 0.0).map(|(a, b)| a * b);
    // The first term is taken as it is, and a sum of no terms is +0.
    terms.reduce(|a, b| a + b).unwrap_or(0.0) + 0.0
}

/// A mesh under a matrix; `None` when a coordinate overflows.
fn placed(mesh: &Mesh, matrix: &[f64; 16]) -> Option<Mesh> {
    if *matrix == IDENTITY {
        return Some(mesh.clone());
    }
    let linear: [[f64; 3]; 3] = [0, 4, 8].map(|c| [matrix[c], matrix[c + 1], matrix[c + 2]]);
    let translation = [matrix[12], matrix[13], matrix[14]];
    let put = |p: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|row| {
            let columns = (0..3).map(|c| (linear[c][row], p[c]));
            sum(columns.chain([(translation[row], 1.0)]))
        })
    };
    let cofactors = cofactors(&linear);
    let determinant = sum((0..3).map(|k| (linear[0][k], cofactors[0][k])));
    let is_mirror = determinant < 0.0;
    let positions = mesh.positions().iter().map(put).collect();
    let faces = mesh.faces().iter().map(|&[a, b, c]| if is_mirror { [a, c, b] } else { [a, b, c] }).collect();
    let mut out = Mesh::new(positions, faces).ok()?;
    if let Some(ids) = mesh.position_id() {
        out = out.with_position_id(ids.to_vec()).ok()?;
    }
    for attribute in mesh.attributes() {
        let mut values = attribute.values.clone();
        match attribute.semantic {
            Semantic::Normal => {
                // The cofactors are the inverse transpose times the determinant.
                let signed = if is_mirror { cofactors.map(|c| c.map(|x| -x)) } else { cofactors };
                values.chunks_exact_mut(attribute.width).for_each(|row| turn(row, &signed));
            }
            Semantic::Tangent => values.chunks_exact_mut(attribute.width).for_each(|row| {
                turn(row, &linear);
                if is_mirror && let Some(sign) = row.get_mut(3) {
                    *sign = -*sign;
                }
            }),
            _ => {}
        }
        if is_mirror && attribute.domain == Domain::Corner {
            for face in values.chunks_exact_mut(3 * attribute.width) {
                let (_, last) = face.split_at_mut(attribute.width);
                let (second, third) = last.split_at_mut(attribute.width);
                second.swap_with_slice(third);
            }
        }
        let (semantic, domain, width) = (attribute.semantic.clone(), attribute.domain, attribute.width);
        out = out.with_attribute(Attribute { semantic, domain, width, values }).ok()?;
    }
    Some(out)
}

/// The columns of the matrix of cofactors.
fn cofactors(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|c| {
        let (a, b) = (m[(c + 1) % 3], m[(c + 2) % 3]);
        std::array::from_fn(|row| {
            let (i, j) = ((row + 1) % 3, (row + 2) % 3);
            sum([(a[i], b[j]), (-a[j], b[i])].into_iter())
        })
    })
}

/// Turns the direction in the first three numbers; its length becomes one, unless it has none.
fn turn(row: &mut [f64], linear: &[[f64; 3]; 3]) {
    let Some(&[x, y, z]) = row.get(..3).and_then(|v| <&[f64; 3]>::try_from(v).ok()) else { return };
    let turned: [f64; 3] =
        std::array::from_fn(|k| sum([(linear[0][k], x), (linear[1][k], y), (linear[2][k], z)].into_iter()));
    let is_signed_permutation = linear.iter().flatten().all(|m| [-1.0, 0.0, 1.0].contains(m));
    let longest = turned.iter().fold(0.0_f64, |m, t| if t.abs() > m { t.abs() } else { m });
    let scaled = turned.map(|t| t / longest);
    let length = sum(scaled.map(|s| (s, s)).into_iter()).sqrt();
    let unit = if is_signed_permutation || !longest.is_finite() || longest == 0.0 {
        turned
    } else {
        scaled.map(|s| s / length)
    };
    row[..3].copy_from_slice(&unit);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, Node};
    use chordal::explicit::{face_normal, vertex_normals};

    fn tetrahedron() -> Mesh {
        let positions = vec![[0.1, 0.2, 0.3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        let mesh = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
        let normals = vertex_normals(&mesh);
        mesh.with_attribute(Attribute::vertex_normals(&normals)).unwrap()
    }

    fn under(matrix: [f64; 16]) -> Mesh {
        let mut scene = Scene::of("t", tetrahedron(), true, Frame::default());
        scene.nodes[0].matrix = matrix;
        scene.world_meshes(&Limits::default()).unwrap().remove(0).mesh
    }

    #[test]
    fn turning_axes_is_exact() {
        let z_up = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let turned = under(z_up);
        for (a, b) in tetrahedron().positions().iter().zip(turned.positions()) {
            assert_eq!([a[0], a[2], -a[1]].map(|x| (x + 0.0).to_bits()), b.map(f64::to_bits));
        }
        let normal = |mesh: &Mesh| mesh.attribute(&Semantic::Normal).unwrap().row(3).to_vec();
        let before = normal(&tetrahedron());
        assert_eq!(normal(&turned), vec![before[0], before[2], -before[1]]);
    }

    #[test]
    fn fronts_stay_fronts_under_a_mirror_and_normals_stay_normals_under_shear() {
        let mirror = [-2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 5.0, 6.0, 7.0, 1.0];
        let shear = [1.0, 0.5, 0.0, 0.0, 0.3, 1.0, 0.2, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        for matrix in [mirror, shear] {
            let mesh = under(matrix);
            let corners: [[f64; 3]; 3] = [1, 2, 3].map(|i| mesh.positions()[i]);
            let centre: [f64; 3] =
                std::array::from_fn(|k| mesh.positions().iter().map(|p| p[k]).sum::<f64>() / 4.0);
            for f in 0..4 {
                let normal = face_normal(mesh.corners(f)).unwrap();
                let out: f64 = (0..3).map(|k| normal[k] * (mesh.corners(f)[0][k] - centre[k])).sum();
                assert!(out > 0.0, "face {f} of {corners:?} faces inwards");
            }
            let rows = mesh.attribute(&Semantic::Normal).unwrap();
            for i in 0..4 {
                let (row, p) = (rows.row(i), mesh.positions()[i]);
                let out: f64 = (0..3).map(|k| row[k] * (p[k] - centre[k])).sum();
                assert!(
                    out > 0.0 && (row.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 4.0 * f64::EPSILON
                );
            }
        }
    }

    #[test]
    fn normals_are_transformed_as_planes_are() {
        // A plane x + y = 1 under a scale of x by 2 is x/2 + y = 1.
        let mesh =
            Mesh::new(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]]).unwrap();
        let half = 0.5_f64.sqrt();
        let mesh = mesh.with_attribute(Attribute::vertex_normals(&[[half, half, 0.0]; 3])).unwrap();
        let mut scene = Scene::of("plane", mesh, true, Frame::default());
        scene.nodes[0].matrix[0] = 2.0;
        let placed = scene.world_meshes(&Limits::default()).unwrap().remove(0).mesh;
        let normal = placed.attribute(&Semantic::Normal).unwrap().row(0).to_vec();
        let expected = face_normal(placed.corners(0)).unwrap();
        for k in 0..3 {
            assert!((normal[k] - expected[k]).abs() < 2.0 * f64::EPSILON);
        }
    }

    #[test]
    fn instances_are_limited_and_loops_are_refused() {
        let mut scene = Scene::of("t", tetrahedron(), true, Frame::default());
        let child = scene.nodes[0].clone();
        scene.nodes[0].children = (1..=9).collect();
        scene.nodes.extend(std::iter::repeat_n(child, 9));
        assert_eq!(scene.world_meshes(&Limits::default()).unwrap().len(), 10);
        let limits = Limits { rows: 39, ..Limits::default() };
        assert_eq!(scene.world_meshes(&limits), Err(Unplaced::TooMany { limit: 39 }));
        scene.nodes[3].children = vec![0];
        assert_eq!(scene.world_meshes(&Limits::default()), Err(Unplaced::NoForest { node: 0 }));
        scene.nodes[3].children = vec![99];
        assert_eq!(scene.world_meshes(&Limits::default()), Err(Unplaced::NoForest { node: 99 }));
        scene.nodes[0].matrix[12] = f64::MAX;
        scene.nodes[3] =
            Node { matrix: scene.nodes[0].matrix, children: Vec::new(), ..scene.nodes[3].clone() };
        assert_eq!(scene.world_meshes(&Limits::default()), Err(Unplaced::NotFinite { node: 3 }));
    }
}
