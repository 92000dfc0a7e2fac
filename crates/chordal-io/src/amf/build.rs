//! `AmfNodeBuilder`: the nodes of a scene from constellations, which place objects.
use super::document::{AmfConstellation, AmfInstance, AmfTarget};
use crate::matrix::{IDENTITY, sine_cosine};
use crate::text::{grouped, show};
use crate::{FileLocation, Node, ReadError, Scene};
use std::collections::BTreeMap;

/// The nodes that a file may have beyond those that it lists, since constellations contain others and are
/// expanded. Chosen as for 3MF: they take about the 64 MiB that a reader may take for any file.
const COPIES: u64 = 200_000;
/// The bytes of a node; a longer name counts as further nodes.
const NODE_BYTES: u64 = 192;

/// Creates nodes.
pub(super) struct AmfNodeBuilder<'a> {
    pub constellations: &'a [AmfConstellation],
    pub targets: &'a BTreeMap<String, AmfTarget>,
    pub n_objects: usize,
}

/// A node that is still to be created.
struct AmfNodeStep {
    target: AmfTarget,
    matrix: [f64; 16],
    parent: Option<usize>,
}

impl AmfNodeBuilder<'_> {
    fn target(&self, instance: &AmfInstance) -> Result<AmfTarget, ReadError> {
        self.targets.get(&instance.target).copied().ok_or_else(|| {
            let message =
                format!("the object or constellation {} is not there", show(instance.target.as_bytes()));
            ReadError::new("missing-object", FileLocation::Line(u64::from(instance.line)), message)
        })
    }

    /// Creates the nodes of all objects and constellations that are in no constellation.
    ///
    /// # Errors
    /// `missing-object`; `constellation-cycle`; `too-many-copies` if nested constellations exceed the limit.
    pub(super) fn nodes(&self, scene: &mut Scene) -> Result<(), ReadError> {
        let (mut is_object_used, mut is_used) =
            (vec![false; self.n_objects], vec![false; self.constellations.len()]);
        for instance in self.constellations.iter().flat_map(|constellation| &constellation.instances) {
            match self.target(instance)? {
                AmfTarget::Object(object) => is_object_used[object] = true,
                AmfTarget::Constellation(constellation) => is_used[constellation] = true,
            }
        }
        let weights = self.weights()?;
        let n_listed: usize = self.constellations.iter().map(|c| 1 + c.instances.len()).sum();
        let most = COPIES + (n_listed + self.n_objects) as u64;
        let free = |used: &[bool]| -> Vec<usize> { (0..used.len()).filter(|i| !used[*i]).collect() };
        let objects = free(&is_object_used).into_iter().map(AmfTarget::Object);
        let roots: Vec<AmfTarget> =
            objects.chain(free(&is_used).into_iter().map(AmfTarget::Constellation)).collect();
        // Counted before the first node is made: a few nested constellations can stand for
        // billions.
        let total = roots.iter().fold(0_u64, |sum, root| sum.saturating_add(weight(*root, &weights)));
        if total > most {
            let most = grouped(most);
            let message = format!("written out, constellations are more than the limit of {most} nodes here");
            return Err(ReadError::new("too-many-copies", FileLocation::File, message));
        }
        for root in roots {
            let mut open = vec![AmfNodeStep { target: root, matrix: IDENTITY, parent: None }];
            while let Some(AmfNodeStep { target, matrix, parent }) = open.pop() {
                let node = scene.nodes.len();
                match parent {
                    Some(parent) => scene.nodes[parent].children.push(node),
                    None => scene.roots.push(node),
                }
                let (name, part) = match target {
                    AmfTarget::Object(object) => (String::new(), Some(object)),
                    AmfTarget::Constellation(c) => (self.constellations[c].name.clone(), None),
                };
                scene.nodes.push(Node { name, matrix: matrix.into(), part, ..Node::default() });
                if let AmfTarget::Constellation(constellation) = target {
                    // Reversed, since the last item of the stack is taken first.
                    for instance in self.constellations[constellation].instances.iter().rev() {
                        let target = self.target(instance)?;
                        open.push(AmfNodeStep { target, matrix: matrix_of(instance), parent: Some(node) });
                    }
                }
            }
        }
        Ok(())
    }

    /// For each constellation the number of nodes that it expands to; computed for its members first.
    fn weights(&self) -> Result<Vec<u64>, ReadError> {
        let n = self.constellations.len();
        let (mut weights, mut is_open, mut is_done) = (vec![0_u64; n], vec![false; n], vec![false; n]);
        for root in 0..n {
            // A stack of our own: nesting is as deep as the file wants. The second number is the
            // next instance to look at.
            let mut open = vec![(root, 0)];
            while let Some((constellation, next)) = open.pop() {
                if is_done[constellation] {
                    continue;
                }
                is_open[constellation] = true;
                let instances = &self.constellations[constellation].instances;
                if let Some(instance) = instances.get(next) {
                    open.push((constellation, next + 1));
                    if let AmfTarget::Constellation(inner) = self.target(instance)? {
                        // Open and not done is an ancestor on the stack.
                        if is_open[inner] && !is_done[inner] {
                            let message = format!(
                                "the constellation {} holds itself",
                                show(instance.target.as_bytes())
                            );
                            let place = FileLocation::Line(u64::from(instance.line));
                            return Err(ReadError::new("constellation-cycle", place, message));
                        }
                        open.push((inner, 0));
                    }
                    continue;
                }
                let own_weight = 1 + self.constellations[constellation].name.len() as u64 / NODE_BYTES;
                let mut sum = own_weight;
                for instance in instances {
                    sum = sum.saturating_add(weight(self.target(instance)?, &weights));
                }
                (weights[constellation], is_done[constellation]) = (sum, true);
            }
        }
        Ok(weights)
    }
}

fn weight(target: AmfTarget, weights: &[u64]) -> u64 {
    match target {
        AmfTarget::Object(_) => 1,
        AmfTarget::Constellation(constellation) => weights[constellation],
    }
}

/// The matrix of an instance: rotated about x, then y, then z, then translated.
fn matrix_of(instance: &AmfInstance) -> [f64; 16] {
    let [[sx, cx], [sy, cy], [sz, cz]] = instance.turns_deg.map(sine_cosine);
    let [x, y, z] = instance.shift;
    // Rz · Ry · Rx, column by column. Adding 0 turns −0 into 0.
    [
        cz * cy,
        sz * cy,
        -sy,
        0.0,
        cz * sy * sx - sz * cx,
        sz * sy * sx + cz * cx,
        cy * sx,
        0.0,
        cz * sy * cx + sz * sx,
        sz * sy * cx - cz * sx,
        cy * cx,
        0.0,
        x,
        y,
        z,
        1.0,
    ]
    .map(|value| value + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_follow_each_other_about_x_y_and_z() {
        let turned = |turns_deg: [f64; 3], p: [f64; 3]| -> [f64; 3] {
            let m = matrix_of(&AmfInstance { turns_deg, shift: [10.0, 0.0, 0.0], ..AmfInstance::default() });
            std::array::from_fn(|k| m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k])
        };
        assert_eq!(turned([0.0; 3], [1.0, 2.0, 3.0]), [11.0, 2.0, 3.0]);
        assert_eq!(turned([90.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [10.0, 0.0, 1.0]);
        assert_eq!(turned([0.0, 90.0, 0.0], [0.0, 0.0, 1.0]), [11.0, 0.0, 0.0]);
        assert_eq!(turned([0.0, 0.0, -270.0], [1.0, 0.0, 0.0]), [10.0, 1.0, 0.0]);
        // The first rotation takes y to z, the second takes that to x, the third takes that to y.
        assert_eq!(turned([90.0, 90.0, 90.0], [0.0, 1.0, 0.0]), [10.0, 1.0, 0.0]);
        assert_eq!(
            matrix_of(&AmfInstance { turns_deg: [360.0, -0.0, 0.0], ..AmfInstance::default() }),
            IDENTITY
        );
    }
}
