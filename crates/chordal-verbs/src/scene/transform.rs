//! `transform`: the triangles of a scene under an affine map, and the effect of the map and its rounding on distances.
use super::placements::{
    IDENTITY, largest_stretch, nodes_rounding, parts_in_order, scaled_up, smallest_stretch,
};
use chordal::math::{add_up, greater, mul_down, sub_down};
use chordal_io::{Node, Part, Scene, WriteError};

/// A scene under an affine map.
#[derive(Clone, Debug)]
pub struct MovedScene {
    /// The scene with everything in it moved.
    pub scene: Scene,
    /// The effect of the map on distances.
    pub stretch: Stretch,
}

/// The effect of an affine map on distances, rounding included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The largest factor by which the map lengthens, rounded up.
    longest: f64,
    /// The smallest such factor, rounded down.
    shortest: f64,
    /// The largest distance of a vertex from its exact image, rounded up.
    rounding: f64,
}

impl Stretch {
    /// Maps an interval that holds the distance of the scene to another shape, if both shapes are moved by the map.
    #[must_use]
    pub fn interval(self, at_least: f64, at_most: Option<f64>) -> (f64, Option<f64>) {
        let least = sub_down(mul_down(at_least, self.shortest), self.rounding);
        let most = at_most.map(|most| add_up(scaled_up(most, self.longest), self.rounding));
        (greater(least, 0.0), most)
    }
}

/// The triangles of a scene under a map by its column-major 4 × 4 matrix, with all other data of the scene. If the map
/// mirrors, faces are wound the other way round, so that front sides stay front sides.
///
/// If every part is shown once without a transform, and nothing is animated, the coordinates of the parts change:
/// positions, normals and tangents. Otherwise the scene gets a node above all others, and its parts stay as they are.
///
/// # Errors
/// [`WriteError::Unsupported`] for a map that is not affine or leads out of range.
///
/// ```
/// use chordal::Mesh;
/// use chordal_verbs::{Frame, Scene, transform};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut map = [0.0; 16];
/// (map[0], map[5], map[10], map[12], map[15]) = (2.0, 2.0, 2.0, 5.0, 1.0);
/// let twice = transform(&Scene::from_mesh("triangle", mesh, Frame::default()), &map)?;
/// assert_eq!(twice.scene.parts[0].mesh.positions()[1], [7.0, 0.0, 0.0]);
/// let (_, at_most) = twice.stretch.interval(0.0, Some(0.5));
/// assert!((1.0..1.0 + 1e-13).contains(&at_most.unwrap()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn transform(scene: &Scene, matrix: &[f64; 16]) -> Result<MovedScene, WriteError> {
    let mut moved = scene.clone();
    // The certificate is for the old place.
    moved.certificate = None;
    moved.roots = vec![moved.nodes.len()];
    moved.nodes.push(Node { matrix: (*matrix).into(), children: scene.roots.clone(), ..Node::default() });
    // The rounding of the scene's own nodes is stretched, too.
    let longest = largest_stretch(matrix);
    let rounding = add_up(nodes_rounding(&moved), scaled_up(nodes_rounding(scene), longest));
    let shortest = smallest_stretch(matrix);
    // Also for a scene that keeps its nodes: this refuses a map that is not affine, or leads out of range.
    let placed = moved.world_meshes()?;
    if is_plain(scene) {
        let mut parts = scene.parts.clone();
        for (part, (_, mesh)) in parts_in_order(scene).into_iter().zip(placed) {
            parts[part] = Part { mesh: mesh.into_owned(), ..parts[part].clone() };
        }
        moved = Scene { parts, nodes: scene.nodes.clone(), roots: scene.roots.clone(), ..moved };
    }
    Ok(MovedScene { scene: moved, stretch: Stretch { longest, shortest, rounding } })
}

/// A bound for the distance of a scene from the shapes that it was composed of, rounded up. `bounds` has nodes, each with
/// the distance of everything below it in its own coordinates; all other parts are exact. The nodes above stretch these
/// distances, and the rounding of the nodes is added.
///
/// ```
/// use chordal::Mesh;
/// use chordal_verbs::{Frame, Scene, composed_bound};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut scene = Scene::from_mesh("triangle", mesh, Frame::default());
/// assert_eq!(composed_bound(&scene, &[(0, 0.5)]), 0.5);
/// (scene.nodes[0].matrix[0], scene.nodes[0].matrix[5], scene.nodes[0].matrix[10]) = (3.0, 3.0, 3.0);
/// assert!((1.5..1.5 + 1e-13).contains(&composed_bound(&scene, &[(0, 0.5)])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn composed_bound(scene: &Scene, bounds: &[(usize, f64)]) -> f64 {
    let mut stretches = vec![0.0; scene.nodes.len()];
    let mut open: Vec<(usize, f64)> = scene.roots.iter().map(|root| (*root, 1.0)).collect();
    while let Some((at, above)) = open.pop() {
        let node = &scene.nodes[at];
        stretches[at] = scaled_up(largest_stretch(&node.matrix), above);
        open.extend(node.children.iter().map(|child| (*child, stretches[at])));
    }
    let stretched =
        |(node, bound): &(usize, f64)| scaled_up(*bound, stretches.get(*node).copied().unwrap_or(0.0));
    // A scene without transforms is not rounded; and adding 0 upwards would still round up.
    let rounding = nodes_rounding(scene);
    let largest = bounds.iter().map(stretched).fold(0.0, greater);
    if rounding > 0.0 { add_up(largest, rounding) } else { largest }
}

/// Whether every part is shown once and untransformed, by a node without other data, and nothing is animated.
fn is_plain(scene: &Scene) -> bool {
    let mut shown = vec![0_u32; scene.parts.len()];
    parts_in_order(scene).into_iter().for_each(|part| shown[part] += 1);
    // Points and lines, cameras, joints and animations would stay behind if only the coordinates of triangles moved.
    let says_nothing = |node: &Node| *node.matrix == IDENTITY && node.properties.is_empty();
    let is_still = |part: &Part| !part.is_deformed() && part.marks.is_empty();
    let assets = &scene.assets;
    shown.iter().all(|count| *count == 1)
        && scene.nodes.iter().all(says_nothing)
        && scene.parts.iter().all(is_still)
        && assets.animations.is_empty()
        && assets.skins.is_empty()
        && assets.cameras.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::Mesh;
    use chordal_io::Frame;
    use chordal_testkit::Random;

    /// The mirror along x, twice as large along y, one unit up.
    const MAP: [f64; 16] = [-1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0];

    fn triangle() -> Scene {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        Scene::from_mesh("triangle", mesh.expect("valid"), Frame::default())
    }

    #[test]
    fn bounds_of_composed_scenes_are_stretched_by_every_node_above() {
        let mut scene = triangle();
        let mut twice = Node { children: vec![0], ..Node::default() };
        (twice.matrix[0], twice.matrix[5], twice.matrix[10]) = (2.0, 2.0, 2.0);
        scene.nodes.push(Node { children: vec![1], ..twice.clone() });
        scene.nodes.insert(1, twice);
        scene.roots = vec![2];
        let near = |found: f64, wanted: f64| (wanted..wanted + 1e-13).contains(&found);
        assert!(
            near(composed_bound(&scene, &[(0, 1.0)]), 4.0) && near(composed_bound(&scene, &[(1, 1.0)]), 4.0)
        );
        assert!(near(composed_bound(&scene, &[(2, 1.0), (0, 0.25)]), 2.0));
        // Moved parts are rounded, even without a bound of their own.
        let rounding = composed_bound(&scene, &[]);
        assert!(rounding > 0.0 && rounding < 1e-13);
        assert!(composed_bound(&triangle(), &[]) <= 0.0);
    }

    #[test]
    fn a_mirror_turns_the_faces_and_a_translation_keeps_the_interval() {
        let mirrored = transform(&triangle(), &MAP).expect("affine");
        let mesh = &mirrored.scene.parts[0].mesh;
        assert_eq!((mesh.positions()[2], mesh.faces()[0]), ([0.0, 2.0, 1.0], [0, 2, 1]));
        let (least, most) = mirrored.stretch.interval(1.0, Some(1.0));
        assert!((0.5..=1.0).contains(&least) && (2.0..2.1).contains(&most.expect("bounded")));
        let mut up = IDENTITY;
        up[14] = 3.0;
        let (least, most) = transform(&triangle(), &up).expect("affine").stretch.interval(1.0, Some(1.0));
        assert!(1.0 - least < 1e-13 && most.expect("bounded") - 1.0 < 1e-13);
    }

    #[test]
    fn a_scene_with_nodes_of_its_own_gets_one_above_them() {
        let mut scene = triangle();
        scene.nodes[0].matrix[12] = 4.0;
        let moved = transform(&scene, &MAP).expect("affine").scene;
        assert_eq!(moved.parts, scene.parts);
        let (_, placed) = &moved.world_meshes().expect("a tree")[0];
        assert_eq!((placed.positions()[1], placed.faces()[0]), ([-5.0, 0.0, 1.0], [0, 2, 1]));
    }

    #[test]
    fn the_interval_holds_what_becomes_of_distances() {
        let mut random = Random::new(31);
        for _ in 0..500 {
            let mut map = IDENTITY;
            [0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14].into_iter().for_each(|k| map[k] = random.signed() * 3.0);
            let moved = transform(&triangle(), &map).expect("affine");
            let v: [f64; 3] = std::array::from_fn(|_| random.signed());
            let long = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let image = [0, 1, 2].map(|r| map[r] * v[0] + map[4 + r] * v[1] + map[8 + r] * v[2]);
            let (least, most) = moved.stretch.interval(long(v), Some(long(v)));
            // 1e-12 of the length covers the rounding of the lengths here.
            assert!(
                least <= long(image) * (1.0 + 1e-12) && long(image) <= most.expect("bounded") * (1.0 + 1e-12)
            );
        }
    }
}
