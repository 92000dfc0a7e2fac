//! `NodeBuilder`: the nodes of a scene from items and components, which place objects.
use super::meshes::NOTHING;
use super::model::{ModelDocument, ModelObject, ModelSet, ObjectReference, ObjectShape};
use crate::grow::{push, with_room};
use crate::matrix::IDENTITY;
use crate::text::grouped;
use crate::{FileLocation, Node, ReadError, Scene};
use std::collections::BTreeMap;

/// The nodes that a file may have beyond those that it lists, since objects contain others and are expanded.
/// Chosen: they take about as much memory as the 64 MiB that a reader may take for any file.
const COPIES: u64 = 200_000;
/// The bytes of a node; a longer name counts as further nodes.
const NODE_BYTES: u64 = 192;

/// The nodes that an object expands to.
#[derive(Clone, Copy, Debug, Default)]
struct NodeCount {
    n_nodes: u64,
    /// The same, with long names counted as nodes.
    weight: u64,
}

/// Creates the nodes for the objects of all model parts.
pub(super) struct NodeBuilder<'a> {
    set: &'a ModelSet,
    documents: &'a [ModelDocument],
    /// The objects, with the index of their document.
    objects: Vec<(usize, &'a ModelObject)>,
    numbers: BTreeMap<(u32, u32), u32>,
    /// For each component of each document, its object.
    targets: Vec<Vec<u32>>,
    counts: Vec<NodeCount>,
}

impl<'a> NodeBuilder<'a> {
    /// Checks that every referenced object exists, and that none contains itself.
    ///
    /// # Errors
    /// `missing-object`, `component-cycle`, `too-many-copies`.
    pub(super) fn new(set: &'a ModelSet, documents: &'a [ModelDocument]) -> Result<Self, ReadError> {
        let (mut objects, mut numbers) = (Vec::new(), BTreeMap::new());
        for (d, document) in documents.iter().enumerate() {
            for (id, object) in &document.objects {
                numbers.insert((d as u32, *id), objects.len() as u32);
                push(&mut objects, (d, object))?;
            }
        }
        let counts = vec![NodeCount::default(); objects.len()];
        let mut builder = Self { set, documents, objects, numbers, targets: Vec::new(), counts };
        for (d, document) in documents.iter().enumerate() {
            let mut targets = with_room(document.components.len())?;
            for component in &document.components {
                targets.push(builder.object(d, component)?);
            }
            builder.targets.push(targets);
        }
        builder.count()?;
        Ok(builder)
    }

    fn error(&self, document: usize, line: u32, code: &'static str, message: String) -> ReadError {
        let part = self.set.documents.get(document).map_or("", |name| name);
        ReadError::new(code, FileLocation::Line(u64::from(line)), format!("{part}: {message}"))
    }

    /// The object of a reference in a document.
    fn object(&self, document: usize, reference: &ObjectReference) -> Result<u32, ReadError> {
        self.numbers.get(&(reference.document, reference.object)).copied().ok_or_else(|| {
            let document_name = self.set.documents.get(reference.document as usize).map_or("", |name| name);
            let message = format!("object {} is not in {document_name}", reference.object);
            self.error(document, reference.line, "missing-object", message)
        })
    }

    /// The components of an object: its document, the components and the objects that they show.
    fn components(&self, object: u32) -> (usize, &'a [ObjectReference], &[u32]) {
        let (d, object) = self.objects[object as usize];
        match object.shape {
            ObjectShape::Mesh(_) => (d, &[], &[]),
            ObjectShape::Components { first, n } => {
                (d, &self.documents[d].components[first..first + n], &self.targets[d][first..first + n])
            }
        }
    }

    /// The part that an object itself shows. An object with a single untransformed mesh only gives that mesh
    /// a name.
    fn part(&self, object: u32) -> Option<usize> {
        if let ObjectShape::Mesh(part) = self.objects[object as usize].1.shape {
            return Some(part);
        }
        match self.components(object) {
            (_, [only], [target]) if only.transform == NOTHING => {
                match self.objects[*target as usize].1.shape {
                    ObjectShape::Mesh(part) => Some(part),
                    ObjectShape::Components { .. } => None,
                }
            }
            _ => None,
        }
    }

    /// Counts the nodes of each object, those of its components first.
    fn count(&mut self) -> Result<(), ReadError> {
        let n = self.objects.len();
        let (mut is_open, mut is_done) = (vec![false; n], vec![false; n]);
        for root in 0..n as u32 {
            // A stack of its own instead of recursion: a file may nest objects as deeply as it
            // likes.
            let mut open = vec![(root, 0)];
            while let Some((object, next)) = open.pop() {
                let i = object as usize;
                if is_done[i] {
                    continue;
                }
                is_open[i] = true;
                let (document, components, targets) = self.components(object);
                if let (Some(component), Some(target)) = (components.get(next), targets.get(next)) {
                    // Begun and not finished: the target is on the stack, above this object.
                    if is_open[*target as usize] && !is_done[*target as usize] {
                        let message = format!("object {} is a component of itself", component.object);
                        return Err(self.error(document, component.line, "component-cycle", message));
                    }
                    let target = *target;
                    push(&mut open, (object, next + 1))?;
                    push(&mut open, (target, 0))?;
                    continue;
                }
                self.counts[i] = self.count_of(object);
                is_done[i] = true;
            }
        }
        Ok(())
    }

    fn count_of(&self, object: u32) -> NodeCount {
        let name = &self.objects[object as usize].1.name;
        let mut count = NodeCount { n_nodes: 1, weight: 1 + name.len() as u64 / NODE_BYTES };
        if self.part(object).is_none() {
            for target in self.components(object).2 {
                let component = self.counts[*target as usize];
                count.n_nodes = count.n_nodes.saturating_add(component.n_nodes);
                count.weight = count.weight.saturating_add(component.weight);
            }
        }
        count
    }

    /// The nodes of the root model's items.
    ///
    /// # Errors
    /// `missing-object`; `too-many-copies` if nested objects exceed the limit.
    pub(super) fn nodes(&self, scene: &mut Scene) -> Result<(), ReadError> {
        let Some(root) = self.documents.first() else { return Ok(()) };
        let listed: u64 = self.documents.iter().map(|d| (d.components.len() + d.items.len()) as u64).sum();
        let most = COPIES + listed;
        let mut total = NodeCount::default();
        let mut shown = with_room(root.items.len())?;
        // Counted before memory is reserved: components of components multiply, so a short file can
        // mean billions of nodes.
        for item in &root.items {
            let object = self.object(0, item)?;
            let count = self.counts[object as usize];
            total.n_nodes = total.n_nodes.saturating_add(count.n_nodes);
            total.weight = total.weight.saturating_add(count.weight);
            if total.weight > most {
                let most = grouped(most);
                let message = format!("written out, components are more than the limit of {most} nodes here");
                return Err(self.error(0, item.line, "too-many-copies", message));
            }
            shown.push(object);
        }
        scene.nodes = with_room(total.n_nodes as usize)?;
        scene.roots = with_room(root.items.len())?;
        let mut open: Vec<OpenNode> = Vec::new();
        for (item, object) in root.items.iter().zip(shown) {
            open.push(OpenNode { object, parent: NOTHING, document: 0, reference: item });
            while let Some(OpenNode { object, parent, document, reference }) = open.pop() {
                let node = scene.nodes.len();
                match scene.nodes.get_mut(parent as usize) {
                    Some(parent) => parent.children.push(node),
                    None => scene.roots.push(node),
                }
                let part = self.part(object);
                let (own, components, targets) = match part {
                    Some(_) => (0, &[][..], &[][..]),
                    None => self.components(object),
                };
                let name = self.objects[object as usize].1.name.clone();
                let matrix = matrix(&self.documents[document as usize], reference);
                scene.nodes.push(Node {
                    name,
                    matrix: matrix.into(),
                    children: with_room(components.len())?,
                    part,
                    ..Node::default()
                });
                // Reversed, since what is pushed last is placed first: nodes are in the order of
                // the file.
                for (component, target) in components.iter().zip(targets).rev() {
                    let (parent, document) = (node as u32, own as u32);
                    push(&mut open, OpenNode { object: *target, parent, document, reference: component })?;
                }
            }
        }
        Ok(())
    }
}

/// A node that is still to be created: the object of a reference in a document.
struct OpenNode<'a> {
    object: u32,
    /// `NOTHING` for a root.
    parent: u32,
    document: u32,
    reference: &'a ObjectReference,
}

/// The matrix of a reference. The rows of the file, which are for row vectors, are the columns of our matrix
/// for column vectors.
fn matrix(document: &ModelDocument, reference: &ObjectReference) -> [f64; 16] {
    let mut matrix = IDENTITY;
    if let Some(transform) = document.transforms.get(reference.transform as usize) {
        for (column, row) in matrix.chunks_exact_mut(4).zip(transform.chunks_exact(3)) {
            column[..3].copy_from_slice(row);
        }
    }
    matrix
}
