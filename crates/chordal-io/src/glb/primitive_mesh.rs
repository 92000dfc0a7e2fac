//! `PrimitiveMesh`: the triangles of one material of a part, with their own vertices and attributes.
use super::material_runs::material_runs;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic};
use serde_json::Value;

/// The mesh of one glTF primitive.
pub(super) struct PrimitiveMesh {
    /// Its triangles, unless they are all of the part.
    submesh: Option<Mesh>,
    /// The group of its faces, 0 for none.
    pub group: usize,
}

impl PrimitiveMesh {
    /// The primitives of a mesh that [`split`](super::split) returned, in order. Unused vertices belong to
    /// the first one.
    ///
    /// # Errors
    /// None for a valid mesh: an error means that the mesh was invalid before.
    pub fn of(mesh: &Mesh) -> Result<Vec<Self>, InvalidMesh> {
        let runs = material_runs(mesh);
        if let [(group, _)] = runs[..] {
            return Ok(vec![Self { submesh: None, group }]);
        }
        // After splitting, no vertex belongs to two runs. Vertices of no face stay at run 0.
        let mut run_of = vec![0; mesh.positions().len()];
        let mut first = 0;
        for (run, (_, n)) in runs.iter().enumerate() {
            let faces = &mesh.faces()[first..first + n];
            faces.as_flattened().iter().for_each(|vertex| run_of[*vertex as usize] = run);
            first += n;
        }
        let mut rows = vec![Vec::new(); runs.len()];
        // `number` is the index of a vertex within its own run.
        let mut number = vec![0; run_of.len()];
        for (vertex, run) in (0..).zip(&run_of) {
            number[vertex as usize] = rows[*run].len() as u32;
            rows[*run].push(vertex);
        }
        let mut first = 0;
        let mut primitives = Vec::with_capacity(runs.len());
        for ((group, n), rows) in runs.into_iter().zip(&rows) {
            let faces = &mesh.faces()[first..first + n];
            first += n;
            let faces = faces.iter().map(|face| face.map(|vertex| number[vertex as usize])).collect();
            primitives.push(Self { submesh: Some(with_rows(mesh, rows, faces)?), group });
        }
        Ok(primitives)
    }

    /// Its triangles. These are the mesh of the part if it has one material.
    pub fn mesh<'m>(&'m self, of_part: &'m Mesh) -> &'m Mesh {
        self.submesh.as_ref().unwrap_or(of_part)
    }

    /// Whether an attribute holds information for these vertices. White and zeros are fillers for vertices
    /// without colour or texture coordinates in a part where others have them.
    pub fn says(&self, attribute: &Attribute, material: Option<&Value>) -> bool {
        match attribute.semantic {
            Semantic::Color(_) => attribute.values.iter().any(|x| *x != 1.0),
            Semantic::TexCoord(_) => {
                attribute.values.iter().any(|x| *x != 0.0) || material.is_some_and(names_textures)
            }
            _ => true,
        }
    }
}

/// A mesh of these rows and faces. Vertices that shared a position still do.
fn with_rows(mesh: &Mesh, rows: &[u32], faces: Vec<[u32; 3]>) -> Result<Mesh, InvalidMesh> {
    let positions = rows.iter().map(|vertex| mesh.positions()[*vertex as usize]).collect();
    let mut out = Mesh::new(positions, faces)?;
    for attribute in mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex) {
        let values = rows.iter().flat_map(|vertex| attribute.row(*vertex as usize)).copied().collect();
        out = out.with_attribute(Attribute { values, ..attribute.clone() })?;
    }
    Ok(out)
}

/// Whether a material has a texture: a member called `…Texture`, also inside its extensions.
fn names_textures(material: &Value) -> bool {
    match material {
        Value::Object(members) => members
            .iter()
            .any(|(key, value)| key.ends_with("Texture") || key != "extras" && names_textures(value)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::super::split;
    use super::*;
    use crate::MATERIAL;
    use serde_json::json;

    /// A strip of four triangles over six vertices, in two materials.
    fn strip() -> Mesh {
        let positions = (0..6).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let groups = Attribute {
            semantic: Semantic::Group(MATERIAL.to_owned()),
            domain: Domain::Face,
            width: 1,
            values: vec![1.0, 2.0, 1.0, 2.0],
        };
        let colors = Attribute {
            semantic: Semantic::Color(0),
            domain: Domain::Face,
            width: 3,
            values: [[1.0; 3], [0.5; 3], [1.0; 3], [0.25; 3]].concat(),
        };
        let mesh = Mesh::new(positions, vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]).unwrap();
        mesh.with_attribute(groups).and_then(|mesh| mesh.with_attribute(colors)).unwrap()
    }

    #[test]
    fn each_material_has_vertices_of_its_own() {
        let mesh = split(&strip()).unwrap().into_owned();
        let primitives = PrimitiveMesh::of(&mesh).unwrap();
        let sizes: Vec<_> = primitives
            .iter()
            .map(|p| (p.group, p.mesh(&mesh).positions().len(), p.mesh(&mesh).faces().len()))
            .collect();
        assert_eq!(sizes, [(1, 5, 2), (2, 6, 2)]);
        assert_eq!(mesh.positions().len(), 11);
        let corners = |mesh: &Mesh, face: usize| mesh.faces()[face].map(|i| mesh.positions()[i as usize]);
        let strip = strip();
        for (primitive, faces) in primitives.iter().zip([[0, 2], [1, 3]]) {
            for (i, face) in faces.into_iter().enumerate() {
                assert_eq!(corners(primitive.mesh(&mesh), i), corners(&strip, face));
            }
        }
    }

    #[test]
    fn colours_and_texture_coordinates_are_not_invented() {
        let mesh = split(&strip()).unwrap().into_owned();
        let primitives = PrimitiveMesh::of(&mesh).unwrap();
        let says: Vec<bool> = primitives
            .iter()
            .map(|p| p.says(p.mesh(&mesh).attribute(&Semantic::Color(0)).unwrap(), None))
            .collect();
        assert_eq!(says, [false, true]);
        let zeros = Attribute {
            semantic: Semantic::TexCoord(0),
            domain: Domain::Vertex,
            width: 2,
            values: vec![0.0; 2],
        };
        let textured = json!({ "extensions": { "KHR_x": { "sheenColorTexture": { "index": 0 } } } });
        assert!(!primitives[0].says(&zeros, Some(&json!({ "extras": { "aTexture": 1 } }))));
        assert!(primitives[0].says(&zeros, Some(&textured)));
    }
}
