//! `split`: moves attributes of corners and faces to vertices, and duplicates vertices whose corners differ.
use super::material_runs::{is_material, material_groups, material_runs};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh};
use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Returns the same triangles with every attribute on vertices, as [`super::write`] writes them.
///
/// glTF has only vertex attributes. A vertex whose corners disagree becomes several rows with one
/// `position_id`: the first keeps its index, the others follow after all old vertices. Triangles of one
/// material become consecutive, in the order of its first triangle, and share no vertex with those of another
/// material: each material becomes a primitive with its own vertices. Otherwise triangles keep their order.
///
/// O(m log m) time for m faces, 8 bytes of memory per corner; nothing is done if all attributes are already
/// on vertices.
///
/// # Errors
/// [`InvalidMesh`] if the result has more vertices than a mesh can have.
pub fn split(mesh: &Mesh) -> Result<Cow<'_, Mesh>, InvalidMesh> {
    let mesh = grouped_by_material(mesh)?;
    let has_runs = material_runs(&mesh).len() > 1;
    let is_loose = |attribute: &&Attribute| match is_material(attribute) {
        true => has_runs,
        false => attribute.domain != Domain::Vertex,
    };
    let loose: Vec<&Attribute> = mesh.attributes().iter().filter(is_loose).collect();
    if loose.is_empty() || loose.iter().all(|attribute| is_material(attribute)) && !has_shared_vertices(&mesh)
    {
        return Ok(mesh);
    }
    split_rows(&mesh, &loose).map(Cow::Owned)
}

/// The same triangles, sorted by material in the order of first appearance.
fn grouped_by_material(mesh: &Mesh) -> Result<Cow<'_, Mesh>, InvalidMesh> {
    let Some(groups) = material_groups(mesh) else { return Ok(Cow::Borrowed(mesh)) };
    // The rank of each material by its first appearance.
    let mut place = BTreeMap::new();
    for value in &groups.values {
        let next = place.len();
        place.entry(value.to_bits()).or_insert(next);
    }
    let places: Vec<usize> = groups.values.iter().map(|value| place[&value.to_bits()]).collect();
    if places.is_sorted() {
        return Ok(Cow::Borrowed(mesh));
    }
    let mut order: Vec<usize> = (0..places.len()).collect();
    // The sort is stable: triangles of one material stay in the order in which they are drawn.
    order.sort_by_key(|face| places[*face]);
    let faces = order.iter().map(|face| mesh.faces()[*face]).collect();
    let mut sorted = Mesh::new(mesh.positions().to_vec(), faces)?;
    if let Some(ids) = mesh.position_id() {
        sorted = sorted.with_position_id(ids.to_vec())?;
    }
    for attribute in mesh.attributes() {
        let rows_of_face = match attribute.domain {
            Domain::Vertex => 0,
            Domain::Corner => 3,
            Domain::Face => 1,
        };
        let values = match rows_of_face * attribute.width {
            0 => attribute.values.clone(),
            n => order.iter().flat_map(|face| &attribute.values[face * n..][..n]).copied().collect(),
        };
        sorted = sorted.with_attribute(Attribute { values, ..attribute.clone() })?;
    }
    Ok(Cow::Owned(sorted))
}

/// Whether triangles of two materials share a vertex.
fn has_shared_vertices(mesh: &Mesh) -> bool {
    let mut run_of = vec![usize::MAX; mesh.positions().len()];
    let mut faces = mesh.faces().iter();
    for (run, (_, n)) in material_runs(mesh).into_iter().enumerate() {
        for vertex in faces.by_ref().take(n).flatten() {
            let vertex_run = &mut run_of[*vertex as usize];
            if *vertex_run != usize::MAX && *vertex_run != run {
                return true;
            }
            *vertex_run = run;
        }
    }
    false
}

fn split_rows(mesh: &Mesh, loose: &[&Attribute]) -> Result<Mesh, InvalidMesh> {
    let rows = SplitRows::number(mesh, loose);
    let positions = rows.vertex.iter().map(|v| mesh.positions()[*v as usize]).collect();
    let ids = rows.vertex.iter().map(|v| mesh.position_of(*v)).collect();
    let mut out = Mesh::new(positions, rows.faces)?.with_position_id(ids)?;
    for attribute in mesh.attributes() {
        if is_material(attribute) {
            out = out.with_attribute(attribute.clone())?;
            continue;
        }
        let mut values = Vec::with_capacity(rows.vertex.len() * attribute.width);
        for (&vertex, &corner) in rows.vertex.iter().zip(&rows.corner) {
            match (attribute.domain, corner) {
                (Domain::Vertex, _) => values.extend_from_slice(attribute.row(vertex as usize)),
                (_, Some(corner)) => values.extend_from_slice(row_of(attribute, corner)),
                // No face uses this vertex, so it has no value.
                (_, None) => values.resize(values.len() + attribute.width, 0.0),
            }
        }
        let (semantic, width) = (attribute.semantic.clone(), attribute.width);
        out = out.with_attribute(Attribute { semantic, domain: Domain::Vertex, width, values })?;
    }
    Ok(out)
}

/// For each new vertex the old vertex and a corner with its attributes; and the faces over the new vertices.
struct SplitRows {
    vertex: Vec<u32>,
    corner: Vec<Option<usize>>,
    faces: Vec<[u32; 3]>,
}

impl SplitRows {
    fn number(mesh: &Mesh, loose: &[&Attribute]) -> Self {
        let vertex_of = |corner: usize| mesh.faces()[corner / 3][corner % 3];
        let order = |a: usize, b: usize| vertex_of(a).cmp(&vertex_of(b)).then_with(|| compare(loose, a, b));
        let mut corners: Vec<usize> = (0..3 * mesh.faces().len()).collect();
        corners.sort_unstable_by(|a, b| order(*a, *b).then(a.cmp(b)));
        let n = mesh.positions().len();
        let mut rows =
            Self { vertex: (0..n as u32).collect(), corner: vec![None; n], faces: mesh.faces().to_vec() };
        let mut number = 0;
        for (k, &corner) in corners.iter().enumerate() {
            if k == 0 || order(corners[k - 1], corner) != Ordering::Equal {
                number = rows.add(vertex_of(corner), corner);
            }
            rows.faces[corner / 3][corner % 3] = number;
        }
        rows
    }

    /// Adds a row for a new combination of attributes at a vertex and returns its index.
    fn add(&mut self, vertex: u32, corner: usize) -> u32 {
        let slot = &mut self.corner[vertex as usize];
        if slot.is_none() {
            *slot = Some(corner);
            return vertex;
        }
        self.vertex.push(vertex);
        self.corner.push(Some(corner));
        // The index may wrap, but a mesh with that many positions is refused.
        (self.vertex.len() - 1) as u32
    }
}

/// Orders corners by the bits of their attributes.
fn compare(loose: &[&Attribute], a: usize, b: usize) -> Ordering {
    let bits = |attribute, corner| row_of(attribute, corner).iter().map(|x: &f64| x.to_bits());
    loose
        .iter()
        .map(|attribute| bits(attribute, a).cmp(bits(attribute, b)))
        .find(|order| *order != Ordering::Equal)
        .unwrap_or(Ordering::Equal)
}

fn row_of(attribute: &Attribute, corner: usize) -> &[f64] {
    match attribute.domain {
        Domain::Face => attribute.row(corner / 3),
        Domain::Corner | Domain::Vertex => attribute.row(corner),
    }
}
