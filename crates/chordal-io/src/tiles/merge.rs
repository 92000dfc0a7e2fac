//! Merges the scenes of several tiles: their triangles, each scene below its own node.
use crate::grow::push_large;
use crate::matrix::product;
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Node, Part, ReadError, ReadOutcome, Scene};
use chordal::Mesh;

/// Rotates y-up to z-up as a viewer of tiles does, (x, y, z) → (x, −z, y); by columns.
const TO_Z_UP: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const TO_Y_UP: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A map of z-up tile space, converted to the y-up space of contents. The two rotations are exact.
pub(super) fn for_content(of_tiles: &[f64; 16]) -> [f64; 16] {
    product(&TO_Y_UP, &product(of_tiles, &TO_Z_UP))
}

/// A translation.
pub(super) fn moved_by([x, y, z]: [f64; 3]) -> [f64; 16] {
    let mut matrix = crate::matrix::IDENTITY;
    (matrix[12], matrix[13], matrix[14]) = (x, y, z);
    matrix
}

/// Collects scenes into one.
#[derive(Debug, Default)]
pub(super) struct SceneMerge {
    scene: Scene,
    pub warnings: Warnings,
}

impl SceneMerge {
    /// Adds the content of a tile, transformed by `matrix`. Materials are dropped, since each file numbers
    /// its own.
    ///
    /// # Errors
    /// If memory runs out.
    pub(super) fn add(&mut self, read: ReadOutcome, matrix: &[f64; 16]) -> Result<(), ReadError> {
        for warning in read.warnings {
            self.warnings.count_many(warning.code, warning.count, || (warning.place, warning.message));
        }
        let Content::Scene(scene) = read.content else { return Ok(()) };
        let (n_parts, n_nodes) = (self.scene.parts.len(), self.scene.nodes.len());
        let mut n_looks = 0;
        for part in scene.parts {
            n_looks += part.mesh.attributes().len() + part.marks.len();
            let mesh = without_looks(&part.mesh)?;
            push_large(
                &mut self.scene.parts,
                Part { name: part.name, mesh, indexed: part.indexed, ..Part::default() },
            )?;
        }
        let message =
            "materials, normals and other attributes of tiles were left out: each file numbers its own";
        self.warnings.count_all("looks-skipped", n_looks as u64, message);
        for node in scene.nodes {
            let children = node.children.iter().map(|child| child + n_nodes).collect();
            let part = node.part.map(|part| part + n_parts);
            push_large(&mut self.scene.nodes, Node { children, part, ..node })?;
        }
        let children = scene.roots.iter().map(|root| root + n_nodes).collect();
        self.scene.roots.push(self.scene.nodes.len());
        push_large(&mut self.scene.nodes, Node { matrix: (*matrix).into(), children, ..Node::default() })
    }

    /// The scene.
    ///
    /// # Errors
    /// `empty` if nothing was added.
    pub(super) fn finish(mut self) -> Result<ReadOutcome, ReadError> {
        if self.scene.parts.is_empty() {
            return Err(ReadError::new("no-triangles", FileLocation::File, "no tile has triangles"));
        }
        self.scene.frame = Frame { up: Some(Axis::Y), metres_per_unit: Some(1.0), ..Frame::default() };
        Ok(ReadOutcome { content: Content::Scene(self.scene), warnings: self.warnings.into_list() })
    }
}

/// The triangles without materials.
fn without_looks(mesh: &Mesh) -> Result<Mesh, ReadError> {
    let invalid = |error| ReadError::new("invalid-mesh", FileLocation::File, format!("{error}"));
    let plain = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).map_err(invalid)?;
    match mesh.position_id() {
        Some(id) => plain.with_position_id(id.to_vec()).map_err(invalid),
        None => Ok(plain),
    }
}
