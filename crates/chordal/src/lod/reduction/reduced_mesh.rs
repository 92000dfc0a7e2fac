//! `MeshReduction::mesh`: the simplified mesh, with the values of its attributes.
use super::super::edge_collapse::CollapseVertexKind;
use super::MeshReduction;
use crate::explicit::{Attribute, Domain, InvalidMesh, Mesh};
use crate::lod::flat_normals::{is_flat, updated_normal};
use crate::lod::surface::NONE;
use crate::lod::wedges::is_carried;

impl MeshReduction<'_> {
    /// The current mesh.
    pub fn mesh(&self) -> Mesh {
        let surface = &self.engine.surface;
        let mut rows = ReducedRows::new(self);
        let (mut faces, mut origin) = (Vec::with_capacity(surface.n_faces), Vec::new());
        for face in self.faces() {
            let normal = rows.flat.map_or([0.0; 3], |flat| self.normal(flat, face));
            faces.push([0, 1, 2].map(|k| rows.row_of_corner(self, 3 * face + k, normal)));
            origin.push(face);
        }
        let mut mesh = Mesh::by_construction(rows.positions, faces);
        if rows.id.iter().enumerate().any(|(row, id)| row as u32 != *id) {
            mesh = mesh.with_position_id(rows.id).unwrap_or_else(empty_on_error);
        }
        for (attribute, column) in self.mesh.attributes().iter().zip(self.reduced_values()) {
            let values = match (column, attribute.domain) {
                (ReducedValues::FlatNormals, Domain::Vertex) => rows.normal.as_flattened().to_vec(),
                (ReducedValues::FlatNormals, domain) => {
                    let n = if domain == Domain::Corner { 3 } else { 1 };
                    let normals = origin.iter().flat_map(|f| [self.normal(attribute, *f)].repeat(n));
                    normals.flatten().collect()
                }
                (ReducedValues::Faces, _) => {
                    let source = origin.iter().map(|face| self.source_face[*face as usize] as usize);
                    source.flat_map(|face| attribute.row(face)).copied().collect()
                }
                (ReducedValues::Wedges(from), Domain::Vertex) => {
                    self.wedge_values(rows.wedge.iter().copied(), from, attribute.width)
                }
                (ReducedValues::Wedges(from), _) => {
                    let wedges = self.engine.wedges.as_ref();
                    let wedges_of = |face: &u32| {
                        [0, 1, 2].map(|k| wedges.map_or(0, |w| w.corner_row[3 * *face as usize + k]))
                    };
                    self.wedge_values(origin.iter().flat_map(wedges_of), from, attribute.width)
                }
            };
            let reduced = Attribute { values, ..clone_without_values(attribute) };
            mesh = mesh.with_attribute(reduced).unwrap_or_else(empty_on_error);
        }
        mesh
    }

    /// By row of [`Self::mesh`]: the row of the original mesh that is fixed there, or [`NONE`].
    pub fn fixed_rows(&self) -> Vec<u32> {
        let mut rows = ReducedRows::new(self);
        for face in self.faces() {
            let normal = rows.flat.map_or([0.0; 3], |flat| self.normal(flat, face));
            (0..3).for_each(|k| _ = rows.row_of_corner(self, 3 * face + k, normal));
        }
        rows.fixed
    }

    /// The source of the values, by attribute.
    fn reduced_values(&self) -> Vec<ReducedValues> {
        let mut next = 0;
        let mut column = |attribute: &Attribute| {
            if is_carried(self.mesh, attribute) {
                next += attribute.width;
                ReducedValues::Wedges(next - attribute.width)
            } else if is_flat(self.mesh, attribute) {
                ReducedValues::FlatNormals
            } else {
                ReducedValues::Faces
            }
        };
        self.mesh.attributes().iter().map(&mut column).collect()
    }

    /// The normal of a face as it is now, for flat shading.
    fn normal(&self, attribute: &Attribute, face: u32) -> [f64; 3] {
        let corners = self.engine.surface.corners(face).map(|v| self.engine.at[v as usize]);
        updated_normal(corners, self.mesh, attribute, self.source_face[face as usize])
    }

    fn wedge_values(&self, wedges: impl Iterator<Item = u32>, from: usize, width: usize) -> Vec<f64> {
        let Some(wedge_rows) = &self.engine.wedges else { return Vec::new() };
        wedges.flat_map(|wedge| wedge_rows.row(wedge)[from..from + width].iter().copied()).collect()
    }
}

/// Cannot happen: rows and values are counted by the same lists.
fn empty_on_error(error: InvalidMesh) -> Mesh {
    debug_assert!(false, "{error}");
    Mesh::default()
}

#[derive(Clone, Copy, Debug)]
enum ReducedValues {
    /// The rows of the wedges, starting at this column.
    Wedges(usize),
    /// The values of faces of the original mesh.
    Faces,
    /// The current faces: normals of flat shading.
    FlatNormals,
}

fn clone_without_values(attribute: &Attribute) -> Attribute {
    Attribute {
        semantic: attribute.semantic.clone(),
        domain: attribute.domain,
        width: attribute.width,
        values: Vec::new(),
    }
}

/// The rows of the extracted mesh: one for each vertex, or for each wedge around it.
struct ReducedRows<'a> {
    positions: Vec<[f64; 3]>,
    /// By row: the first row of the same position.
    id: Vec<u32>,
    wedge: Vec<u32>,
    /// By row: its row in the original mesh, if it is fixed.
    fixed: Vec<u32>,
    /// By the key of a position: its first row; by row: the next one of the same position.
    first: Vec<u32>,
    next: Vec<u32>,
    by_wedge: bool,
    /// Vertex normals of flat shading, and the normal of each row.
    flat: Option<&'a Attribute>,
    normal: Vec<[f64; 3]>,
}

impl<'a> ReducedRows<'a> {
    fn new(reduction: &MeshReduction<'a>) -> Self {
        let mesh = reduction.mesh;
        let mut of_vertices = mesh.attributes().iter().filter(|a| a.domain == Domain::Vertex);
        let by_wedge = of_vertices.clone().any(|a| is_carried(mesh, a));
        let flat = of_vertices.find(|a| is_flat(mesh, a));
        Self {
            positions: Vec::new(),
            id: Vec::new(),
            wedge: Vec::new(),
            fixed: Vec::new(),
            first: vec![NONE; reduction.engine.first_fan.len()],
            next: Vec::new(),
            by_wedge,
            flat,
            normal: Vec::new(),
        }
    }

    /// The row of a corner; it is added if it does not exist yet.
    fn row_of_corner(&mut self, reduction: &MeshReduction<'_>, corner: u32, normal: [f64; 3]) -> u32 {
        let engine = &reduction.engine;
        let v = engine.surface.start[corner as usize];
        // Fans of one position are merged again, since only fixed positions have more than one.
        let key = reduction.engine.first_fan[engine.source_vertex[v as usize] as usize] as usize;
        let wedge =
            engine.wedges.as_ref().filter(|_| self.by_wedge).map_or(0, |w| w.corner_row[corner as usize]);
        let mut row = self.first[key];
        let is_other = |this: &Self, row: usize| this.wedge[row] != wedge || this.normal[row] != normal;
        while row != NONE && is_other(self, row as usize) {
            row = self.next[row as usize];
        }
        if row != NONE {
            return row;
        }
        let row = self.positions.len() as u32;
        let head = self.first[key];
        self.id.push(if head == NONE { row } else { self.id[head as usize] });
        self.positions.push(reduction.world_position(v));
        self.wedge.push(wedge);
        let is_fixed = engine.kind[v as usize] == CollapseVertexKind::Locked;
        self.fixed.push(if is_fixed { reduction.row[key] } else { NONE });
        self.normal.push(normal);
        self.next.push(head);
        self.first[key] = row;
        row
    }
}

impl MeshReduction<'_> {
    /// The world position of a vertex: bit for bit the original one unless it moved.
    fn world_position(&self, v: u32) -> [f64; 3] {
        if self.engine.is_original[v as usize] {
            // All fans of a position use one row, since zeros may differ in their signs.
            let first = self.engine.first_fan[self.engine.source_vertex[v as usize] as usize];
            self.mesh.positions()[self.row[first as usize] as usize]
        } else {
            self.frame.in_world(self.engine.at[v as usize])
        }
    }
}
