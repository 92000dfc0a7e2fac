//! `ColladaBuilder`: the nodes of a scene from those of a visual scene, with the meshes that they show.
use super::document::{ColladaDocument, ColladaInstance, InstanceKind, UpAxis};
use crate::grow::push;
use crate::text::{grouped, show};
use crate::warnings::Warnings;
use crate::{FileLocation, Node, ReadError, Scene};

/// The nodes that a file may have beyond those that it lists, since a node can be instanced at other places
/// and is then copied. Chosen as for 3MF: they take about the 64 MiB that a reader may take for any file.
const COPIES: usize = 200_000;
/// The most controllers between an instance and its mesh. Chosen: a morph of a skin has two.
const MOST_CONTROLLERS: usize = 8;
/// x is up, y points left and z to the viewer: rotated so that y is up.
const X_UP: [f64; 16] = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// An item of the stack: a node to create, or the end of one.
enum BuildStep {
    Enter { node: usize, parent: Option<usize> },
    Leave { node: usize },
}

/// Creates nodes.
pub(super) struct ColladaBuilder<'a> {
    pub document: &'a ColladaDocument,
    pub warnings: &'a mut Warnings,
    /// For each geometry the material bindings of its first instance, once it has one.
    pub bindings: Vec<Option<Vec<[String; 2]>>>,
}

impl ColladaBuilder<'_> {
    /// Creates the nodes of the scene that is shown.
    ///
    /// # Errors
    /// If a referenced object is missing, a node contains itself, or there are too many nodes.
    pub(super) fn nodes(&mut self, scene: &mut Scene) -> Result<(), ReadError> {
        let document = self.document;
        let top = if document.up == UpAxis::X {
            push(&mut scene.nodes, Node { matrix: X_UP.into(), ..Node::default() })?;
            scene.roots.push(0);
            Some(0)
        } else {
            None
        };
        let Some(roots) = self.roots()? else {
            // Without a scene, all meshes are shown untransformed.
            for part in 0..document.geometries.len() {
                attach(scene, Node { part: Some(part), ..Node::default() }, top)?;
            }
            return Ok(());
        };
        let most = COPIES + document.nodes.len();
        let mut is_open = vec![false; document.nodes.len()];
        // Enter and leave: a node is open while its descendants are on the stack, and meeting it
        // again then is a loop. Meeting it later is an instance, which is a copy.
        let mut steps: Vec<BuildStep> =
            roots.iter().rev().map(|node| BuildStep::Enter { node: *node, parent: top }).collect();
        while let Some(step) = steps.pop() {
            let (node, parent) = match step {
                BuildStep::Enter { node, parent } => (node, parent),
                BuildStep::Leave { node } => {
                    is_open[node] = false;
                    continue;
                }
            };
            let from = &document.nodes[node];
            if std::mem::replace(&mut is_open[node], true) {
                let message = format!("the node {} shows itself", show(from.name.as_bytes()));
                return Err(ReadError::new("node-loop", FileLocation::File, message));
            }
            push(&mut steps, BuildStep::Leave { node })?;
            let node_idx = attach(
                scene,
                Node { name: from.name.clone(), matrix: from.matrix.into(), ..Node::default() },
                parent,
            )?;
            for child in from.children.iter().rev() {
                push(&mut steps, BuildStep::Enter { node: *child, parent: Some(node_idx) })?;
            }
            for instance in &from.instances {
                if instance.kind == InstanceKind::Node {
                    let Some(node) = document.node_ids.get(&instance.target) else {
                        return Err(missing("node", instance));
                    };
                    push(&mut steps, BuildStep::Enter { node: *node, parent: Some(node_idx) })?;
                    continue;
                }
                let Some(part) = self.geometry(instance)? else { continue };
                // A node can show one part; further parts get their own nodes.
                match scene.nodes[node_idx].part {
                    None => scene.nodes[node_idx].part = Some(part),
                    Some(_) => {
                        attach(scene, Node { part: Some(part), ..Node::default() }, Some(node_idx))?;
                    }
                }
            }
            // What waits on the stack counts too, or one node with a million children would be
            // listed before it is refused.
            if scene.nodes.len() + steps.len() > most.saturating_mul(2) {
                let message =
                    format!("written out, nodes are more than the limit of {} here", grouped(most as u64));
                return Err(ReadError::new("too-many-copies", FileLocation::File, message));
            }
        }
        Ok(())
    }

    /// The roots of the scene that is shown.
    fn roots(&self) -> Result<Option<&[usize]>, ReadError> {
        let scenes = &self.document.scenes;
        match &self.document.shown {
            None => Ok(scenes.first().map(|(_, roots)| &**roots)),
            Some(id) => match scenes.iter().find(|(known, _)| known == id) {
                Some((_, roots)) => Ok(Some(roots)),
                None => {
                    let message = format!("the visual scene {} is not there", show(id.as_bytes()));
                    Err(ReadError::new("missing-object", FileLocation::File, message))
                }
            },
        }
    }

    /// The geometry of an instance; the first instance decides the materials of the mesh.
    fn geometry(&mut self, instance: &ColladaInstance) -> Result<Option<usize>, ReadError> {
        let mut id = &instance.target;
        if instance.kind == InstanceKind::Controller {
            for _ in 0..MOST_CONTROLLERS {
                match self.document.controllers.get(id) {
                    Some(source) => id = source,
                    None => break,
                }
            }
        }
        let Some(geometry) = self.document.geometry_ids.get(id) else {
            return Err(missing("geometry or controller", instance));
        };
        match &self.bindings[*geometry] {
            None => self.bindings[*geometry] = Some(instance.bindings.clone()),
            Some(known) if *known != instance.bindings => self.warnings.count("bindings-differ", || {
                let place = FileLocation::Line(u64::from(instance.line));
                let message = "meshes that are shown with other materials again keep those of the first time";
                (place, message.to_owned())
            }),
            Some(_) => {}
        }
        Ok(Some(*geometry))
    }
}

fn missing(what: &str, instance: &ColladaInstance) -> ReadError {
    let message = format!("the {what} {} is not there", show(instance.target.as_bytes()));
    ReadError::new("missing-object", FileLocation::Line(u64::from(instance.line)), message)
}

/// Appends a node below another one, or as a root.
fn attach(scene: &mut Scene, node: Node, parent: Option<usize>) -> Result<usize, ReadError> {
    let index = scene.nodes.len();
    push(&mut scene.nodes, node)?;
    match parent {
        Some(parent) => push(&mut scene.nodes[parent].children, index)?,
        None => push(&mut scene.roots, index)?,
    }
    Ok(index)
}
