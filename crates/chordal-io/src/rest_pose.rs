//! `RestPose`: a part as its skin or morph targets pose it, with the joints and weights in the file.
use crate::glb::deformation::{targets_of, weights_of};
use crate::matrix::cross;
use crate::{Node, Part, Scene, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::math::{Interval, add_up, greater, lesser, mul_up, sqrt_up, sub_up, unit};
use serde_json::{Map, Value};

/// The columns of an affine map, in interval arithmetic.
type IntervalMap = [[Interval; 3]; 4];

/// A part as posed by a skin or morph targets before any animation: each vertex at Σ wᵢ · jointᵢ · inverse
/// bind matrixᵢ of its position, with weights that sum to 1, after its morph targets have moved it by their
/// default weights. The transform of a node with a skin is ignored, as glTF defines it.
#[derive(Clone, Debug, PartialEq)]
pub struct RestPose {
    /// By vertex: its position in scene coordinates.
    pub positions: Vec<[f64; 3]>,
    /// An upper bound of the distance from each position to the one of exact arithmetic.
    pub rounding: f64,
    /// An upper bound of the largest singular value of the linear part of all vertices' maps: a vertex whose
    /// weights stay the same moves at most so many times as far as it moves in its own coordinates.
    pub stretch: f64,
    /// By vertex: the columns of its map, rounded.
    maps: Vec<[[f64; 3]; 4]>,
}

/// The data that poses the parts of a scene at rest: the transforms of its nodes, and its skins.
pub struct RestPoses<'a> {
    scene: &'a Scene,
    /// By node: its map to the scene; `None` if the node lies on a cycle. Empty if nothing is posed.
    globals: Vec<Option<IntervalMap>>,
}

/// The maps and weights that pose a node.
struct PoseMaps {
    /// The maps of its joints, or the single map of the node.
    maps: Vec<IntervalMap>,
    is_skinned: bool,
    /// The weights of its morph targets; empty if these move nothing.
    weights: Vec<f64>,
}

/// Whether a node shows a part that has a skin, or morph targets that move it at rest.
fn may_be_posed(node: &Node, part: &Part) -> bool {
    skin_of(node).is_some() && !weights_of(&part.mesh).is_empty() || default_weights(node, part).is_some()
}

/// The index of the skin of a node.
fn skin_of(node: &Node) -> Option<usize> {
    node.properties.get("skin").and_then(Value::as_u64).and_then(|skin| usize::try_from(skin).ok())
}

/// The weights of morph targets at rest, if any is not zero: those of the node, or else of the mesh.
fn default_weights(node: &Node, part: &Part) -> Option<Vec<f64>> {
    let list = |properties: &Map<String, Value>| {
        let list = properties.get("weights").and_then(Value::as_array)?;
        Some(list.iter().map(|x| x.as_f64().unwrap_or(0.0)).collect::<Vec<_>>())
    };
    let weights = list(&node.properties).or_else(|| part.properties.as_deref().and_then(list))?;
    let has_targets = || part.is_deformed() && !targets_of(&part.mesh).is_empty();
    (weights.iter().any(|weight| *weight != 0.0) && has_targets()).then_some(weights)
}

impl Scene {
    /// The rest poses of the parts that the nodes show.
    #[must_use]
    pub fn rest_poses(&self) -> RestPoses<'_> {
        RestPoses::new(self)
    }
}

impl<'a> RestPoses<'a> {
    fn new(scene: &'a Scene) -> Self {
        let is_posed = |node: &Node| {
            node.part.and_then(|part| scene.parts.get(part)).is_some_and(|part| may_be_posed(node, part))
        };
        let globals = if scene.nodes.iter().any(is_posed) { globals(scene) } else { Vec::new() };
        Self { scene, globals }
    }

    /// Whether a skin or morph targets pose the part of a node, and the file has all data for it.
    #[must_use]
    pub fn is_posed(&self, node: usize) -> bool {
        self.maps_of(node).is_some()
    }

    /// Whether a node has a skin that cannot be applied: the skin, one of its nodes or a joint that the mesh
    /// uses is missing.
    #[must_use]
    pub fn lacks_skin(&self, node: usize) -> bool {
        let names = self.scene.nodes.get(node).is_some_and(|at| at.part.is_some() && skin_of(at).is_some());
        names && self.maps_of(node).is_none_or(|maps| !maps.is_skinned)
    }

    /// The maps and weights that pose a node; `None` if nothing does.
    fn maps_of(&self, node: usize) -> Option<PoseMaps> {
        self.globals.first()?;
        let at = self.scene.nodes.get(node)?;
        let part = self.scene.parts.get(at.part?)?;
        let joints = skin_of(at).filter(|_| !weights_of(&part.mesh).is_empty());
        let joints = joints.and_then(|skin| self.joint_maps(skin, &part.mesh));
        let weights = default_weights(at, part);
        if joints.is_none() && weights.is_none() {
            return None;
        }
        let is_skinned = joints.is_some();
        let maps = joints.or_else(|| Some(vec![self.globals[node]?]))?;
        Some(PoseMaps { maps, is_skinned, weights: weights.unwrap_or_default() })
    }

    /// By joint of a skin: the map of a vertex that follows only this joint; `None` if the skin, one of its
    /// nodes or a joint that the mesh uses is missing.
    fn joint_maps(&self, skin: usize, mesh: &Mesh) -> Option<Vec<IntervalMap>> {
        let skin = self.scene.assets.skins.get(skin)?;
        let joints = skin["joints"].as_array()?;
        let binds = match skin.get("inverseBindMatrices") {
            None => None,
            Some(at) => {
                let accessor = self.scene.assets.accessors.get(usize::try_from(at.as_u64()?).ok()?)?;
                let is_matrices = accessor.properties.get("type").is_none_or(|kind| kind == "MAT4");
                let rows = accessor.bytes.chunks_exact(MATRIX_BYTES);
                Some(rows.map(matrix_from_bytes).collect::<Vec<_>>()).filter(|_| is_matrices)
            }
        };
        let map = |(k, joint): (usize, &Value)| {
            let global = (*self.globals.get(usize::try_from(joint.as_u64()?).ok()?)?)?;
            match &binds {
                None => Some(global),
                Some(binds) => Some(product(&global, &as_map(binds.get(k)?))),
            }
        };
        let maps: Vec<IntervalMap> = joints.iter().enumerate().map(map).collect::<Option<_>>()?;
        let follows = weights_of(mesh).iter().any(|(first, _, attribute)| {
            let beyond = maps.len().saturating_sub(*first).min(attribute.width);
            attribute.values.chunks_exact(attribute.width).any(|row| row[beyond..].iter().any(|w| *w > 0.0))
        });
        (!follows && !maps.is_empty()).then_some(maps)
    }

    /// The pose of the part that a node shows; `None` if neither a skin nor morph targets move it, or if the
    /// file lacks data for it: then the transform of the node places it.
    ///
    /// Linear in the vertices times the joints of each.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] if a position is out of range.
    pub fn pose(&self, node: usize) -> Result<Option<RestPose>, WriteError> {
        let part = self.scene.nodes.get(node).and_then(|node| self.scene.parts.get(node.part?));
        part.map_or(Ok(None), |part| self.pose_of(node, &part.mesh))
    }

    /// The same for another mesh with the same joints and morph targets, instead of the part's mesh.
    ///
    /// # Errors
    /// As for [`Self::pose`].
    pub fn pose_of(&self, node: usize, mesh: &Mesh) -> Result<Option<RestPose>, WriteError> {
        let Some(PoseMaps { maps, is_skinned, weights }) = self.maps_of(node) else { return Ok(None) };
        let followed = if is_skinned { weights_of(mesh) } else { Vec::new() };
        let targets = moving_targets(mesh, &weights);
        let mut pose = RestPose { positions: Vec::new(), rounding: 0.0, stretch: 0.0, maps: Vec::new() };
        for (vertex, position) in mesh.positions().iter().enumerate() {
            let mut local = position.map(Interval::point);
            for (weight, moves) in &targets {
                let moves = moves.row(vertex);
                local =
                    std::array::from_fn(|k| local[k] + Interval::point(moves[k]) * Interval::point(*weight));
            }
            let map = blend(&maps, &followed, vertex);
            if !pose.add(&map, local) {
                let what = format!("vertex {vertex} at node {node} is not finite where its skin takes it");
                return Err(WriteError::Unsupported(what));
            }
        }
        Ok(Some(pose))
    }
}

impl RestPose {
    /// Adds a vertex; false if it is out of range.
    fn add(&mut self, map: &IntervalMap, local: [Interval; 3]) -> bool {
        let exact: [Interval; 3] = std::array::from_fn(|row| apply_row(map, local, row));
        let position = exact.map(|x| x.midpoint().unwrap_or(f64::NAN));
        let error =
            |k: usize| greater(sub_up(exact[k].hi(), position[k]), sub_up(position[k], exact[k].lo()));
        let error = length_up([0, 1, 2].map(error));
        let stretch = largest_stretch(map);
        self.positions.push(position);
        self.maps.push(map.map(|column| column.map(|x| x.midpoint().unwrap_or(f64::NAN))));
        self.rounding = greater(error, self.rounding);
        self.stretch = greater(stretch, self.stretch);
        position.iter().all(|x| x.is_finite()) && error.is_finite() && stretch.is_finite()
    }

    /// The map of its first vertex, as it is rounded: column-major, 4 × 4; the identity for a mesh without vertices.
    #[must_use]
    pub fn first_map(&self) -> [f64; 16] {
        let Some(map) = self.maps.first() else { return crate::matrix::IDENTITY };
        std::array::from_fn(|k| if k % 4 == 3 { f64::from(u8::from(k == 15)) } else { map[k / 4][k % 4] })
    }

    /// The mesh in this pose: with normals and tangents rotated, with the opposite winding if most of the
    /// maps mirror it, and without the attributes that would pose it again.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] for another mesh than the one that was posed.
    pub fn posed(&self, mesh: &Mesh) -> Result<Mesh, WriteError> {
        let is_mirror = self.is_mirror();
        let order = if is_mirror { [0, 2, 1] } else { [0, 1, 2] };
        let faces = mesh.faces().iter().map(|face| order.map(|corner| face[corner])).collect();
        let mut posed = Mesh::new(self.positions.clone(), faces);
        if let Some(ids) = kept_position_ids(mesh, &self.positions) {
            posed = posed.and_then(|posed| posed.with_position_id(ids));
        }
        let kept = mesh.attributes().iter().filter(|own| !matches!(own.semantic, Semantic::Blended(_)));
        for own in kept {
            let rows = own.values.len() / own.width;
            // Corners of a mirrored face change places, and their values with them.
            let source = |row: usize| match own.domain {
                Domain::Corner => 3 * (row / 3) + order[row % 3],
                Domain::Vertex | Domain::Face => row,
            };
            let vertex = |row: usize| match own.domain {
                Domain::Vertex => row,
                Domain::Corner => mesh.faces()[row / 3][row % 3] as usize,
                Domain::Face => mesh.faces()[row][0] as usize,
            };
            let turned =
                |row: usize| self.posed_row(vertex(source(row)), &own.semantic, own.row(source(row)));
            let values = (0..rows).flat_map(turned).collect();
            posed = posed.and_then(|posed| posed.with_attribute(Attribute { values, ..own.clone() }));
        }
        posed.map_err(|error| WriteError::Unsupported(error.to_string()))
    }

    fn is_mirror(&self) -> bool {
        let n = self.maps.iter().filter(|map| dot(cross(map[0], map[1]), map[2]) < 0.0).count();
        2 * n > self.maps.len()
    }

    /// A row of a vertex's attribute in the pose.
    fn posed_row(&self, vertex: usize, semantic: &Semantic, row: &[f64]) -> Vec<f64> {
        let [a, b, c, _] = self.maps[vertex];
        let along = |columns: [[f64; 3]; 3], v: &[f64]| {
            let sum: [f64; 3] =
                std::array::from_fn(|k| columns[0][k] * v[0] + columns[1][k] * v[1] + columns[2][k] * v[2]);
            unit(sum).unwrap_or_default()
        };
        match (semantic, row) {
            (Semantic::Normal, [_, _, _, rest @ ..]) => {
                let sign = if dot(cross(a, b), c) < 0.0 { -1.0 } else { 1.0 };
                let cofactors =
                    [cross(b, c), cross(c, a), cross(a, b)].map(|column| column.map(|x| sign * x));
                [&along(cofactors, row)[..], rest].concat()
            }
            (Semantic::Tangent, [_, _, _, side, rest @ ..]) => {
                let side = if self.is_mirror() { -side } else { *side };
                [&along([a, b, c], row)[..], &[side], rest].concat()
            }
            _ => row.to_vec(),
        }
    }
}

/// The position ids after posing: rows at one position that the pose moves apart lose their common id.
fn kept_position_ids(mesh: &Mesh, positions: &[[f64; 3]]) -> Option<Vec<u32>> {
    let ids = mesh.position_id()?;
    let mut first: Vec<Option<usize>> = vec![None; ids.len()];
    let mut is_one = true;
    for (row, id) in ids.iter().enumerate() {
        let first_row = *first.get_mut(*id as usize)?.get_or_insert(row);
        is_one &= positions[first_row] == positions[row];
    }
    is_one.then(|| ids.to_vec())
}

/// The bytes of a matrix of 16 numbers in single precision; defined by glTF.
const MATRIX_BYTES: usize = 64;

fn matrix_from_bytes(bytes: &[u8]) -> [f64; 16] {
    std::array::from_fn(|k| {
        let at = bytes.get(4 * k..4 * k + 4).and_then(|four| four.try_into().ok());
        at.map_or(f64::NAN, |four| f64::from(f32::from_le_bytes(four)))
    })
}

fn as_map(matrix: &[f64; 16]) -> IntervalMap {
    std::array::from_fn(|column| std::array::from_fn(|row| Interval::point(matrix[4 * column + row])))
}

/// Whether it is the identity exactly.
fn is_identity(map: &IntervalMap) -> bool {
    (0..4).all(|column| (0..3).all(|row| is_identity_entry(map, column, row)))
}

fn apply_row(map: &IntervalMap, v: [Interval; 3], row: usize) -> Interval {
    ((map[0][row] * v[0] + map[1][row] * v[1]) + map[2][row] * v[2]) + map[3][row]
}

/// The composition of two maps.
fn product(after: &IntervalMap, map: &IntervalMap) -> IntervalMap {
    if is_identity(after) || is_identity(map) {
        return if is_identity(after) { *map } else { *after };
    }
    std::array::from_fn(|column| {
        std::array::from_fn(|row| {
            let linear = (after[0][row] * map[column][0] + after[1][row] * map[column][1])
                + after[2][row] * map[column][2];
            if column == 3 { linear + after[3][row] } else { linear }
        })
    })
}

/// By node: its map to the scene.
fn globals(scene: &Scene) -> Vec<Option<IntervalMap>> {
    let n = scene.nodes.len();
    let (mut maps, mut has_parent) = (vec![None; n], vec![false; n]);
    let children = scene.nodes.iter().flat_map(|node| &node.children).filter(|child| **child < n);
    children.for_each(|child| has_parent[*child] = true);
    // Roots of the scene first: nodes above them are ignored.
    let others = (0..n).filter(|node| !has_parent[*node]);
    let starts: Vec<usize> = scene.roots.iter().copied().chain(others).collect();
    let identity = as_map(&crate::matrix::IDENTITY);
    for start in starts {
        let mut open = vec![(start, identity)];
        while let Some((at, above)) = open.pop() {
            let Some(node) = scene.nodes.get(at).filter(|_| maps[at].is_none()) else { continue };
            let map = product(&above, &as_map(&node.matrix));
            maps[at] = Some(map);
            open.extend(node.children.iter().map(|child| (*child, map)));
        }
    }
    maps
}

/// The morph targets that move positions at rest, with their weights.
fn moving_targets<'m>(mesh: &'m Mesh, weights: &[f64]) -> Vec<(f64, &'m Attribute)> {
    if weights.is_empty() {
        return Vec::new();
    }
    let targets = targets_of(mesh);
    let moves = targets.into_iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
    let positions = moves.flat_map(|(target, weight)| {
        target
            .into_iter()
            .filter(|(name, own)| *name == "POSITION" && own.width == 3)
            .map(|(_, own)| (*weight, own))
    });
    positions.collect()
}

/// The map of a vertex. A vertex without joints follows the first joint, as writers intend.
fn blend(maps: &[IntervalMap], followed: &[(usize, usize, &Attribute)], vertex: usize) -> IntervalMap {
    let rows = followed.iter().flat_map(|(first, _, own)| {
        own.row(vertex).iter().enumerate().map(move |(k, weight)| (first + k, *weight))
    });
    let mut sum: Option<(IntervalMap, Interval)> = None;
    let mut only = 0;
    let mut n = 0;
    for (joint, weight) in rows.filter(|(joint, weight)| *weight > 0.0 && *joint < maps.len()) {
        let weight = Interval::point(weight);
        let scaled = maps[joint].map(|column| column.map(|x| x * weight));
        sum = Some(match sum {
            None => (scaled, weight),
            Some((all, total)) => {
                (std::array::from_fn(|c| std::array::from_fn(|r| all[c][r] + scaled[c][r])), total + weight)
            }
        });
        (only, n) = (joint, n + 1);
    }
    match sum {
        // A single joint has all the weight, whatever its value.
        Some(_) if n == 1 => maps[only],
        Some((all, total)) => all.map(|column| column.map(|x| x / total)),
        None => maps[0],
    }
}

/// An upper bound of the largest singular value of the linear part M: no eigenvalue of MᵀM exceeds the
/// largest sum of absolute values in a row of it, nor its trace.
fn largest_stretch(map: &IntervalMap) -> f64 {
    let entry = |a: usize, b: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| map[a][k] * map[b][k]);
        ((x + y) + z).magnitude()
    };
    if (0..3).all(|c| (0..3).all(|r| is_identity_entry(map, c, r))) {
        return 1.0;
    }
    let row = |a: usize| add_up(add_up(entry(a, 0), entry(a, 1)), entry(a, 2));
    let rows = [1, 2].into_iter().fold(row(0), |most, a| greater(row(a), most));
    let trace = add_up(add_up(entry(0, 0), entry(1, 1)), entry(2, 2));
    sqrt_up(lesser(rows, trace))
}

fn is_identity_entry(map: &IntervalMap, column: usize, row: usize) -> bool {
    let one = if column == row { 1.0 } else { 0.0 };
    map[column][row].lo() == one && map[column][row].hi() == one
}

fn length_up(v: [f64; 3]) -> f64 {
    let [x, y, z] = v.map(|x| if x == 0.0 { 0.0 } else { mul_up(x, x) });
    let sum = add_up(add_up(x, y), z);
    if v == [0.0; 3] { 0.0 } else { sqrt_up(sum) }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
