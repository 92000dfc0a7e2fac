//! The places at which the nodes of a scene show its parts: the stretch of their transforms, and the rounding these cause.
use chordal::budget::Tolerance;
use chordal::math::{
    Box3, Interval, add_up, div_down, greater, lesser, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
use chordal_io::{Part, RestPoses, Scene, WriteError};

/// A column-major 4 × 4 matrix.
pub(crate) type Matrix4 = [f64; 16];

pub(crate) const IDENTITY: Matrix4 =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A length times a stretch, rounded up; a length of 0 stays 0 and a stretch of 1 changes nothing.
pub(crate) fn scaled_up(length: f64, stretch: f64) -> f64 {
    if length == 0.0 || stretch == 0.0 {
        0.0
    } else if stretch == 1.0 {
        length
    } else {
        mul_up(length, stretch)
    }
}

/// A length of the scene in the coordinates of a part that is scaled by `stretch`; `None` if nothing is left of the length.
pub(crate) fn length_in_part(length: f64, stretch: f64) -> Option<Tolerance> {
    let in_part = (stretch > 0.0).then(|| div_down(length, stretch));
    in_part.filter(|in_part| *in_part > 0.0).and_then(|in_part| Tolerance::new(in_part).ok())
}

/// By part: the largest factor by which a placement lengthens a vector, by its transforms or by its pose; 0 for a part without
/// placements. For a posed part the weights of the joints are taken as constant.
pub(crate) fn part_scales(scene: &Scene) -> Vec<f64> {
    let mut stretch = vec![0.0; scene.parts.len()];
    for place in part_placements(scene) {
        let most: &mut f64 = &mut stretch[place.part];
        *most = greater(place.stretch, *most);
    }
    stretch
}

/// Whether every placement of a scene is without a transform.
pub(crate) fn is_untransformed(scene: &Scene) -> bool {
    part_placements(scene).iter().all(|place| place.is_identity)
}

/// One placement of a part.
pub(crate) struct PartPlacement {
    pub node: usize,
    pub part: usize,
    pub is_identity: bool,
    /// The number of transforms between the part and the scene.
    depth: u32,
    /// The product of the transforms, as it is rounded.
    matrix: Matrix4,
    /// The product of the transforms' absolute values: an upper bound of their exact product.
    magnitude: Matrix4,
    /// The largest factor by which the transforms together lengthen, rounded up.
    stretch: f64,
    /// The pose by a skin or morph targets: then the transforms do not count, and `stretch` is that of the pose.
    posed: Option<PosedPlace>,
}

/// The rounding and the box of a part in its rest pose.
#[derive(Clone, Copy)]
struct PosedPlace {
    rounding: f64,
    bounds: Box3,
}

impl PartPlacement {
    /// The placement above all nodes: the world itself.
    const OUTSIDE: Self = Self {
        node: 0,
        part: 0,
        is_identity: true,
        depth: 0,
        matrix: IDENTITY,
        magnitude: IDENTITY,
        stretch: 1.0,
        posed: None,
    };

    /// Composes this placement with a node's matrix.
    fn compose(&self, node: usize, matrix: &Matrix4, part: usize) -> Self {
        // A product with the identity is exact: it adds no depth, and so no rounding.
        if *matrix == IDENTITY {
            return Self { node, part, ..*self };
        }
        Self {
            node,
            part,
            is_identity: false,
            depth: self.depth + 1,
            matrix: product(&self.matrix, matrix),
            magnitude: product(&self.magnitude, &matrix.map(f64::abs)),
            stretch: scaled_up(largest_stretch(matrix), self.stretch),
            posed: None,
        }
    }

    /// The placement in the pose by a skin or morph targets, if there are any. A pose out of range has an infinite stretch.
    fn in_rest_pose(self, poses: &RestPoses<'_>) -> Self {
        match poses.pose(self.node) {
            Ok(None) => self,
            Ok(Some(pose)) => {
                // In the coordinates of the scene, and not below the node: glTF ignores the transforms of a node with
                // a skin.
                let bounds = Box3::from_points(&pose.positions);
                let posed = Some(PosedPlace { rounding: pose.rounding, bounds });
                Self { is_identity: false, stretch: pose.stretch, posed, ..self }
            }
            Err(_) => Self { is_identity: false, stretch: f64::INFINITY, ..self },
        }
    }

    /// The largest factor by which the placement lengthens, rounded up.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// The largest distance by which the rounding of its transforms can move a vertex of the part.
    pub fn rounding(&self, part: &Part) -> f64 {
        if let Some(posed) = &self.posed {
            return posed.rounding;
        }
        let bounds = part.mesh.bounds();
        if bounds.is_empty() { 0.0 } else { self.rounding_within(largest_reach(&bounds)) }
    }

    /// The largest distance by which the rounding of its transforms can move a point with coordinates of at most these
    /// absolute values.
    ///
    /// A product of a matrix with a vector or a matrix has four products and three sums an entry, so the error of d
    /// transforms is less than `7d` half steps, relative to the product of the absolute values. `8d` whole steps cover that
    /// and the rounding of the estimate, which has as many operations.
    fn rounding_within(&self, reach: [f64; 3]) -> f64 {
        let m = &self.magnitude;
        let steps = 8.0 * f64::from(self.depth) * f64::EPSILON;
        let squares = (0..3).fold(0.0, |sum, row| {
            let largest = m[row] * reach[0] + m[4 + row] * reach[1] + m[8 + row] * reach[2] + m[12 + row];
            let error = mul_up(largest, steps);
            add_up(sum, mul_up(error, error))
        });
        sqrt_up(squares)
    }
}

/// The distance of two points, rounded up.
pub(crate) fn distance_up(p: [f64; 3], q: [f64; 3]) -> f64 {
    let sides: [f64; 3] = std::array::from_fn(|k| {
        let (low, high) = (sub_down(p[k], q[k]), sub_up(p[k], q[k]));
        greater(low.abs(), high.abs())
    });
    let squares = sides.map(|side| mul_up(side, side));
    sqrt_up(add_up(add_up(squares[0], squares[1]), squares[2]))
}

/// The largest absolute values of coordinates in a box; 0 for an empty box.
pub(crate) fn largest_reach(bounds: &Box3) -> [f64; 3] {
    if bounds.is_empty() {
        return [0.0; 3];
    }
    std::array::from_fn(|k| {
        let (low, high) = (bounds.min[k].abs(), bounds.max[k].abs());
        greater(low, high)
    })
}

/// The largest distance by which the rounding of the nodes of a scene can move a vertex.
pub(crate) fn nodes_rounding(scene: &Scene) -> f64 {
    let moved = part_placements(scene).into_iter().filter(|place| !place.is_identity);
    moved.map(|place| place.rounding(&scene.parts[place.part])).fold(0.0, greater)
}

/// The largest distance by which the rounding of a map can move a point with coordinates of at most these absolute values.
pub(crate) fn map_rounding(map: &Matrix4, reach: [f64; 3]) -> f64 {
    let place = PartPlacement::OUTSIDE.compose(0, map, 0);
    if place.is_identity { 0.0 } else { place.rounding_within(reach) }
}

/// The map that applies `map` and then `after`, and the largest distance by which its rounding can move a point with coordinates
/// of at most these absolute values.
pub(crate) fn as_one_map(after: &Matrix4, map: &Matrix4, reach: [f64; 3]) -> (Matrix4, f64) {
    if *after == IDENTITY || *map == IDENTITY {
        return (if *after == IDENTITY { *map } else { *after }, 0.0);
    }
    let magnitude = product(&after.map(f64::abs), &map.map(f64::abs));
    let place = PartPlacement { depth: 1, magnitude, ..PartPlacement::OUTSIDE };
    (product(after, map), place.rounding_within(reach))
}

/// All placements in the order of the tree, as in [`Scene::world_meshes`], by walking the scene from its roots with an
/// explicit stack. Readers guarantee that the nodes are a forest.
pub(crate) fn part_placements(scene: &Scene) -> Vec<PartPlacement> {
    let mut placements = Vec::new();
    let mut open: Vec<(usize, std::rc::Rc<PartPlacement>)> = Vec::new();
    let outside = std::rc::Rc::new(PartPlacement::OUTSIDE);
    let poses = scene.rest_poses();
    open.extend(scene.roots.iter().rev().map(|root| (*root, outside.clone())));
    while let Some((index, parent)) = open.pop() {
        let node = &scene.nodes[index];
        let here = std::rc::Rc::new(parent.compose(index, &node.matrix, 0));
        if let Some(part) = node.part {
            placements.push(PartPlacement { part, ..*here }.in_rest_pose(&poses));
        }
        open.extend(node.children.iter().rev().map(|child| (*child, here.clone())));
    }
    placements
}

fn product(a: &Matrix4, b: &Matrix4) -> Matrix4 {
    std::array::from_fn(|i| (0..4).map(|k| a[4 * k + i % 4] * b[i / 4 * 4 + k]).sum())
}

/// An upper bound for the largest factor by which the linear part M lengthens; 1 for a rotation, up to rounding. No
/// eigenvalue of MᵀM exceeds the largest sum of absolute values in one of its rows, nor its trace.
pub(crate) fn largest_stretch(m: &Matrix4) -> f64 {
    // Exactly 1, so that moving a scene stretches no bound: the sums below are rounded up.
    if is_translation(m) {
        return 1.0;
    }
    let dot = |a: usize, b: usize| size_of(dot_of(m, a, b));
    let row = |a: usize| add_up(add_up(dot(a, 0), dot(a, 1)), dot(a, 2));
    let rows = [1, 2].into_iter().fold(row(0), |most, a| greater(row(a), most));
    let trace = add_up(add_up(dot(0, 0), dot(1, 1)), dot(2, 2));
    sqrt_up(lesser(rows, trace))
}

/// A lower bound for the smallest factor by which the linear part M lengthens; 1 for a rotation, up to rounding. No
/// eigenvalue of MᵀM is less than the smallest entry of its diagonal minus the absolute values of the others in its row
/// (Gershgorin).
pub(crate) fn smallest_stretch(m: &Matrix4) -> f64 {
    // Exactly 1, as for the largest factor: the sums below are rounded down.
    if is_translation(m) {
        return 1.0;
    }
    let row = |a: usize| {
        let others = [0, 1, 2].into_iter().filter(|b| *b != a);
        others.fold(dot_of(m, a, a).lo(), |least, b| sub_down(least, size_of(dot_of(m, a, b))))
    };
    let least = [1, 2].into_iter().fold(row(0), |least, a| lesser(row(a), least));
    sqrt_down(greater(least, 0.0))
}

/// The entry of MᵀM in a row and a column, enclosed.
fn dot_of(m: &Matrix4, a: usize, b: usize) -> Interval {
    let terms = [0, 1, 2].map(|k| Interval::point(m[4 * a + k]) * Interval::point(m[4 * b + k]));
    terms[0] + terms[1] + terms[2]
}

fn size_of(entry: Interval) -> f64 {
    greater(entry.lo().abs(), entry.hi().abs())
}

/// Whether the linear part is exactly the identity.
fn is_translation(m: &Matrix4) -> bool {
    m[..12] == IDENTITY[..12]
}

/// The placement of a node's part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NodePlacement {
    /// The largest factor by which its transforms lengthen, rounded up.
    pub stretch: f64,
    /// The longest diagonal of the part's own box, in world coordinates.
    pub size: f64,
}

/// By node: its placement; `None` for nodes without a part, and for nodes that no scene shows.
pub(crate) fn node_placements(scene: &Scene) -> Vec<Option<NodePlacement>> {
    let mut placements = vec![None; scene.nodes.len()];
    for PartPlacement { node, part, matrix, stretch, posed, .. } in part_placements(scene) {
        if let Some(PosedPlace { bounds, .. }) = posed {
            placements[node] = Some(NodePlacement { stretch, size: bounds.diagonal() });
            continue;
        }
        let bounds = scene.parts[part].mesh.bounds();
        let extent: [f64; 3] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
        let diagonal = |signs: [f64; 2]| {
            let [x, y, z] = [extent[0], signs[0] * extent[1], signs[1] * extent[2]];
            let along = [0, 1, 2].map(|row| matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z);
            along.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let diagonals = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(diagonal);
        let size = diagonals.into_iter().fold(0.0, |most, size| greater(size, most));
        placements[node] = Some(NodePlacement { stretch, size });
    }
    placements
}

/// The part of each placement, in the order of [`Scene::world_meshes`].
pub(crate) fn parts_in_order(scene: &Scene) -> Vec<usize> {
    let mut parts = Vec::new();
    let mut open: Vec<usize> = scene.roots.iter().rev().copied().collect();
    while let Some(node) = open.pop() {
        let node = &scene.nodes[node];
        parts.extend(node.part);
        open.extend(node.children.iter().rev());
    }
    parts
}

/// The number of triangles in a scene, counted once for each placement.
pub(crate) fn n_placed_faces(scene: &Scene) -> u64 {
    let parts = parts_in_order(scene).into_iter();
    parts.fold(0, |n, part| n.saturating_add(scene.parts[part].mesh.faces().len() as u64))
}

/// The number of placements in a scene.
pub(crate) fn n_places(scene: &Scene) -> usize {
    parts_in_order(scene).len()
}

/// By part: a box around each of its placements in world coordinates, rounding included, and whether it has a single
/// placement without a transform.
///
/// # Errors
/// As [`Scene::world_meshes`].
pub(crate) fn boxes_of_parts(scene: &Scene) -> Result<Vec<(Vec<Box3>, bool)>, WriteError> {
    let mut parts = vec![(Vec::new(), true); scene.parts.len()];
    for ((_, mesh), part) in scene.world_meshes()?.into_iter().zip(parts_in_order(scene)) {
        parts[part].0.push(mesh.bounds());
    }
    for place in part_placements(scene) {
        let (boxes, is_single_identity) = &mut parts[place.part];
        *is_single_identity &= place.is_identity && boxes.len() == 1;
        if !place.is_identity {
            // The boxes of all placements of the part grow, since their order is not that of the placements;
            // a box may be too large.
            let rounding = place.rounding(&scene.parts[place.part]);
            boxes.iter_mut().for_each(|bounds| *bounds = pad_box(bounds, rounding));
        }
    }
    Ok(parts)
}

/// A box grown by a length on every side, rounded outward.
pub(crate) fn pad_box(bounds: &Box3, length: f64) -> Box3 {
    if length == 0.0 {
        return *bounds;
    }
    Box3 { min: bounds.min.map(|x| sub_down(x, length)), max: bounds.max.map(|x| add_up(x, length)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn the_stretch_is_never_too_small_and_that_of_a_rotation_is_one() {
        let mut random = Random::new(9);
        for round in 0..2000 {
            let mut m = IDENTITY;
            for k in [0, 1, 2, 4, 5, 6, 8, 9, 10] {
                m[k] = random.signed() * f64::from(2_i32.pow(round % 5));
            }
            if round % 3 == 0 {
                // Of rank 1.
                (0..3).for_each(|k| (m[4 + k], m[8 + k]) = (-0.7 * m[k], 0.2 * m[k]));
            }
            let stretch = largest_stretch(&m);
            let frobenius = [0, 1, 2, 4, 5, 6, 8, 9, 10].map(|k| m[k] * m[k]).iter().sum::<f64>().sqrt();
            assert!(stretch <= frobenius * (1.0 + 1e-12), "{stretch} {frobenius}");
            for _ in 0..50 {
                let v = [random.signed(), random.signed(), random.signed()];
                let size = v.iter().map(|x| x * x).sum::<f64>().sqrt();
                let image = [0, 1, 2].map(|r| m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2]);
                let long = image.iter().map(|x| x * x).sum::<f64>().sqrt();
                assert!(long <= stretch * size * (1.0 + 1e-12), "{long} {stretch} {size}");
            }
            let (sin, cos) = random.signed().mul_add(3.0, 0.0).sin_cos();
            let mut turn = IDENTITY;
            (turn[0], turn[1], turn[4], turn[5]) = (cos, sin, -sin, cos);
            assert!((1.0 - 1e-15..1.0 + 1e-14).contains(&largest_stretch(&turn)));
        }
    }
}
