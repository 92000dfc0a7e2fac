//! Normals as a mesh is meant to be seen: flat, smooth, or smooth up to its hard edges.
use super::angle::angle_of;
use super::face_normal;
use super::smooth::{Weight, scale_of, smooth_normals, terms, unit};
use crate::explicit::{
    Attribute, Domain, InvalidMesh, Mesh, Semantic, Sets, Topology, Twin, Twins, next_in_face,
};
use crate::math::dot;
use std::collections::BTreeMap;

/// Where a surface is to look smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// Nowhere: each face its own normal.
    Flat,
    /// Everywhere.
    Smooth(Weight),
    /// Across edges at which the normals of both faces are no further apart than this.
    Crease {
        /// From 0 to π.
        angle_rad: f64,
        /// How much each face counts.
        weight: Weight,
    },
    /// Between faces of one smoothing group: a face attribute `Semantic::Group("s")` with the same number, not 0. A mesh
    /// without that attribute is flat.
    Groups(Weight),
}

/// The mesh with normals of this kind instead of those that it had; tangents, which belong to normals, go with them.
///
/// - *Flat*: one row a face, zero where a face has no area.
/// - *Smooth*: one row a vertex, [`smooth_normals`].
/// - *Crease* and *groups*: one row a vertex. Vertices are doubled along hard edges only, tied by
///   [`Mesh::position_id`], so that what was closed is closed. The first fan at a row keeps it, copies come after all old
///   rows, and the order of faces stays.
///
/// Hard is, beside edges that are too sharp or part two groups, each edge that has not exactly two faces, or two that are
/// wound against each other, or one without area. Two rows are one position where `topology` says so. A fan whose
/// normals cancel gets the mean of all faces at its position, zero where those cancel too; nothing becomes NaN.
///
/// Linear: 1,000,000 triangles in about 0.2 s with creases.
///
/// # Errors
/// [`InvalidMesh`] when there are more rows than a mesh can have.
///
/// ```
/// use chordal::Mesh;
/// use chordal::explicit::{Shading, Topology, Weight, with_normals};
/// let corners = (0..8).map(|i| [0, 1, 2].map(|k| f64::from(i >> k & 1))).collect();
/// let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
/// let cube = Mesh::new(corners, quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect())?;
/// let crease = Shading::Crease { angle_rad: 0.5, weight: Weight::Angle };
/// let creased = with_normals(&cube, Topology::Indices, crease)?;
/// assert_eq!((creased.positions().len(), creased.n_positions()), (24, 8));
/// assert_eq!(with_normals(&cube, Topology::Indices, Shading::Smooth(Weight::Angle))?.positions().len(), 8);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
pub fn with_normals(mesh: &Mesh, topology: Topology, shading: Shading) -> Result<Mesh, InvalidMesh> {
    match shading {
        Shading::Flat => {
            let normals =
                (0..mesh.faces().len()).flat_map(|f| face_normal(mesh.corners(f)).unwrap_or_default());
            rebuilt(mesh, &Rows::kept(mesh), (Domain::Face, normals.collect()))
        }
        Shading::Smooth(weight) => {
            let normals = match (topology, mesh.position_id()) {
                (Topology::Positions, _) => smooth_over(mesh, topology.ids(mesh).as_deref(), weight),
                (Topology::Indices, _) => smooth_normals(mesh, weight),
            };
            rebuilt(mesh, &Rows::kept(mesh), (Domain::Vertex, normals.into_flattened()))
        }
        Shading::Crease { angle_rad, weight } => {
            let normals: Vec<[f64; 3]> =
                (0..mesh.faces().len()).map(|f| face_normal(mesh.corners(f)).unwrap_or_default()).collect();
            let is_soft = |f: u32, g: u32| {
                let (p, q) = (normals[f as usize], normals[g as usize]);
                let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
                p != [0.0; 3] && q != [0.0; 3] && angle_of(dot(p, q), dot(cross, cross).sqrt()) <= angle_rad
            };
            creased(mesh, topology, (weight, &is_soft))
        }
        Shading::Groups(weight) => {
            let groups = mesh.attribute(&Semantic::Group("s".to_owned()));
            let Some(groups) = groups.filter(|groups| groups.domain == Domain::Face) else {
                return with_normals(mesh, topology, Shading::Flat);
            };
            let number = |f: u32| groups.row(f as usize)[0];
            creased(mesh, topology, (weight, &|f, g| number(f) == number(g) && number(f) != 0.0))
        }
    }
}

/// Smooth normals where ids of positions are not those of the mesh.
fn smooth_over(mesh: &Mesh, ids: Option<&[u32]>, weight: Weight) -> Vec<[f64; 3]> {
    let id = |row: u32| ids.map_or(row, |ids| ids[row as usize]);
    let sums = position_sums(mesh, &id, weight);
    (0..mesh.positions().len() as u32).map(|row| unit(sums[id(row) as usize])).collect()
}

fn position_sums(mesh: &Mesh, id: &dyn Fn(u32) -> u32, weight: Weight) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; mesh.positions().len()];
    let scale = scale_of(mesh);
    for (number, face) in mesh.faces().iter().enumerate() {
        for (row, term) in face.iter().zip(terms(mesh.corners(number), scale, weight).into_iter().flatten()) {
            add(&mut sums[id(*row) as usize], term);
        }
    }
    sums
}

fn add(sum: &mut [f64; 3], term: [f64; 3]) {
    *sum = [sum[0] + term[0], sum[1] + term[1], sum[2] + term[2]];
}

/// Whether two faces look smooth across the edge that they share.
type IsSoft<'a> = &'a dyn Fn(u32, u32) -> bool;

/// One normal for each fan of faces that soft edges hold together around a position.
fn creased(
    mesh: &Mesh,
    topology: Topology,
    (weight, is_soft): (Weight, IsSoft),
) -> Result<Mesh, InvalidMesh> {
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    // 1. Corners that hang together, by the numbers of their half-edges.
    let mut sets = Sets::new(twins.len());
    for h in 0..twins.len() as u32 {
        if let Twin::Pair(t) = twins.get(h)
            && h < t
            && is_soft(h / 3, t / 3)
        {
            sets.join(h, next_in_face(t));
            sets.join(next_in_face(h), t);
        }
    }
    let fans: Vec<u32> = (0..twins.len() as u32).map(|h| sets.root(h)).collect();
    // 2. Their normals.
    let scale = scale_of(mesh);
    let mut sums = vec![[0.0; 3]; fans.len()];
    for face in 0..mesh.faces().len() {
        let Some(terms) = terms(mesh.corners(face), scale, weight) else { continue };
        (0..3).for_each(|k| add(&mut sums[fans[3 * face + k] as usize], terms[k]));
    }
    // 3. Rows, and what each of them shows.
    let rows = Rows::of_fans(mesh, &fans);
    let mut whole: Option<Vec<[f64; 3]>> = None;
    let mut normals = Vec::with_capacity(3 * rows.source.len());
    for (&source, &fan) in rows.source.iter().zip(&rows.fan) {
        let mut normal = if fan == NO_FAN { [0.0; 3] } else { unit(sums[fan as usize]) };
        if normal == [0.0; 3] {
            let whole = whole.get_or_insert_with(|| position_sums(mesh, &id, weight));
            normal = unit(whole[id(source) as usize]);
        }
        normals.extend(normal);
    }
    rebuilt(mesh, &rows, (Domain::Vertex, normals))
}

/// Of a row that no face names.
const NO_FAN: u32 = u32::MAX;

/// The rows of a mesh to be.
struct Rows {
    /// The old row of each.
    source: Vec<u32>,
    /// The fan of each.
    fan: Vec<u32>,
    faces: Vec<[u32; 3]>,
}

impl Rows {
    /// All as they are.
    fn kept(mesh: &Mesh) -> Self {
        Self {
            source: (0..mesh.positions().len() as u32).collect(),
            fan: Vec::new(),
            faces: mesh.faces().to_vec(),
        }
    }

    /// One for each old row and fan there.
    fn of_fans(mesh: &Mesh, fans: &[u32]) -> Self {
        let mut rows = Self::kept(mesh);
        rows.fan = vec![NO_FAN; rows.source.len()];
        let mut copies: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (corner, row) in rows.faces.as_flattened_mut().iter_mut().enumerate() {
            let fan = fans[corner];
            let known = &mut rows.fan[*row as usize];
            *known = if *known == NO_FAN { fan } else { *known };
            if *known != fan {
                let source = *row;
                *row = *copies.entry((source, fan)).or_insert_with(|| {
                    rows.source.push(source);
                    rows.fan.push(fan);
                    // A wrapped number cannot pass unseen: with that many positions the mesh is refused.
                    (rows.source.len() - 1) as u32
                });
            }
        }
        rows
    }
}

/// The mesh with these normals, one a vertex, instead of those that it had; tangents go with them.
///
/// # Errors
/// [`InvalidMesh`] when there are not as many as vertices, or one is not finite.
pub(crate) fn with_vertex_normals(mesh: &Mesh, normals: Vec<[f64; 3]>) -> Result<Mesh, InvalidMesh> {
    rebuilt(mesh, &Rows::kept(mesh), (Domain::Vertex, normals.into_flattened()))
}

/// The mesh over these rows, with normals in place of normals and tangents.
fn rebuilt(mesh: &Mesh, rows: &Rows, (domain, values): (Domain, Vec<f64>)) -> Result<Mesh, InvalidMesh> {
    let has_copies = rows.source.len() > mesh.positions().len();
    let positions = rows.source.iter().map(|&row| mesh.positions()[row as usize]).collect();
    let mut made = Mesh::new(positions, rows.faces.clone())?;
    if has_copies || mesh.position_id().is_some() {
        made = made.with_position_id(rows.source.iter().map(|&row| mesh.position_of(row)).collect())?;
    }
    for attribute in mesh.attributes() {
        if matches!(attribute.semantic, Semantic::Normal | Semantic::Tangent) {
            continue;
        }
        let mut attribute = attribute.clone();
        if has_copies && attribute.domain == Domain::Vertex {
            let copies = &rows.source[mesh.positions().len()..];
            let more: Vec<f64> =
                copies.iter().flat_map(|&row| attribute.row(row as usize).to_vec()).collect();
            attribute.values.extend(more);
        }
        made = made.with_attribute(attribute)?;
    }
    made.with_attribute(Attribute { semantic: Semantic::Normal, domain, width: 3, values })
}
