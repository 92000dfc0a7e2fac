//! `ZeroAreaFaces`: faces without area that close no gap, set aside while a surface is simplified.
use super::simplified_mesh::{ROUNDINGS, SimplifiedMesh};
use crate::budget::{Bound, Bounded, ErrorLimit, Job, JobError, Reference, Tolerance};
use crate::check::{Goal, deviation, has_zero_area, tolerance_violations};
use crate::explicit::{Attribute, Domain, InvalidMesh, Mesh, Topology, Twin, Twins};
use crate::math::{greater, lesser};

/// Meshes of up to this many triangles are compared again with their faces of no area. Chosen: it takes a
/// tenth of a second.
const SMALL: usize = 1 << 14;

/// A mesh without its faces of no area, and these faces.
///
/// Such a face covers a segment or a point. If the remaining surface is near it, it is dropped; otherwise it
/// is put back unchanged, since nothing else replaces it. A face without area that joins two others across
/// its sides stays in the mesh: without it, these would be separated by a crack.
pub(super) struct ZeroAreaFaces<'a> {
    mesh: &'a Mesh,
    /// All rows, and the faces that were not set aside.
    pub rest: Mesh,
    /// The faces that were set aside, ascending.
    aside: Vec<u32>,
}

impl<'a> ZeroAreaFaces<'a> {
    /// Sets the faces aside; `None` if there are none, or no others.
    pub fn set_aside(mesh: &'a Mesh, topology: Topology) -> Option<Self> {
        let n_faces = mesh.faces().len() as u32;
        let flat: Vec<u32> =
            (0..n_faces).filter(|face| has_zero_area(mesh.corners(*face as usize))).collect();
        if flat.is_empty() {
            return None;
        }
        let twins = Twins::with_ids(mesh, topology.ids(mesh).as_deref());
        let is_joined = |h: u32| matches!(twins.get(h), Twin::Pair(_) | Twin::Flipped(_));
        let joins_two = |face: &u32| (3 * face..3 * face + 3).filter(|h| is_joined(*h)).count() > 1;
        let aside: Vec<u32> = flat.into_iter().filter(|face| !joins_two(face)).collect();
        if aside.is_empty() || aside.len() == mesh.faces().len() {
            return None;
        }
        let rest = without_faces(mesh, &aside);
        Some(Self { mesh, rest, aside })
    }

    /// Completes a simplified rest, with a bound for the whole surface: faces within the length of it are
    /// dropped, the others are put back. Without a length all of them are dropped.
    ///
    /// # Errors
    /// As for [`deviation`].
    pub fn restore(
        &self,
        simplified_rest: Bounded<SimplifiedMesh>,
        within: Option<&ErrorLimit>,
        job: &Job,
    ) -> Result<Bounded<SimplifiedMesh>, JobError> {
        let Bounded { shape: SimplifiedMesh { mesh, worst, mut stats, attributes }, mut bound } =
            simplified_rest;
        let n_rest = mesh.faces().len() as u32;
        // 1. The faces that are farther than the length, or possibly so.
        let (mut far, mut pixels) = (Vec::new(), 0.0);
        if let Some(within) = within {
            // The faces of the rest are in both meshes, so only those behind them can be far.
            let report = tolerance_violations(&self.joined(&mesh, &self.aside), &mesh, within, job)?;
            let faces = report.violations[0].iter().filter_map(|far| far.face.checked_sub(n_rest));
            far = faces.map(|face| self.aside[face as usize]).collect();
            pixels = report.pixels;
        }
        let near: Vec<u32> = self.aside.iter().filter(|face| !far.contains(face)).copied().collect();
        // 2. The distance of the other faces.
        let (mut least, mut most) = (0.0, 0.0);
        if !near.is_empty() {
            let joined = self.joined(&mesh, &near);
            let close = Tolerance::new(ROUNDINGS * self.mesh.bounds().diagonal()).ok();
            let goal = Goal { absolute: close, ..Goal::default() };
            let one_sided = deviation(&joined, &mesh, &goal, job)?.forward;
            (least, most) = (one_sided.at_least, one_sided.at_most);
            if let Some(within) = within.filter(|within| within.constant().is_none() && !far.is_empty()) {
                pixels = tolerance_violations(&joined, &mesh, within, job)?.pixels;
            }
        }
        // 3. A bound that is proved of both parts of a surface holds for the whole. The lower bound does not:
        //    a face without area may be nearer than the rest.
        stats.degenerate_faces += near.len() as u64;
        stats.kept_degenerate_faces += far.len() as u64;
        let at_most = greater(bound.at_most().unwrap_or(f64::INFINITY), most);
        let least = if far.is_empty() { lesser(least, at_most) } else { 0.0 };
        let mut combined = Bound::proved(least, at_most, Reference::InputTriangles);
        combined.pixels = bound.pixels.take().map(|seen| greater(seen, pixels));
        let mesh = if far.is_empty() { mesh } else { self.with_faces(&mesh, &far) };
        let mut shape = SimplifiedMesh { mesh, worst, stats, attributes };
        // 4. A small mesh is compared again in both directions, which makes the lower bound as good as
        //    without such faces.
        if self.mesh.faces().len() <= SMALL {
            let again = deviation(self.mesh, &shape.mesh, &Goal::default(), job)?;
            let most = lesser(at_most, again.bound.at_most().unwrap_or(f64::INFINITY));
            let least = greater(least, again.bound.at_least());
            shape.worst = (least > 0.0).then(|| *again.worst());
            let pixels = combined.pixels;
            combined = Bound::proved(lesser(least, most), most, Reference::InputTriangles);
            combined.pixels = pixels;
        }
        Ok(Bounded { shape, bound: combined })
    }

    /// The positions and faces of a mesh and the given faces, without attributes.
    fn joined(&self, mesh: &Mesh, aside: &[u32]) -> Mesh {
        let mut positions = mesh.positions().to_vec();
        let mut faces = mesh.faces().to_vec();
        for face in aside {
            let first = positions.len() as u32;
            positions.extend(self.mesh.corners(*face as usize));
            faces.push([first, first + 1, first + 2]);
        }
        Mesh::by_construction(positions, faces)
    }

    /// A simplified rest with the given faces unchanged, in additional rows.
    fn with_faces(&self, simplified_rest: &Mesh, back: &[u32]) -> Mesh {
        let rows = self.mesh.rows_of(back);
        let n = simplified_rest.positions().len();
        let new_row = |row: u32| (n + rows.partition_point(|known| *known < row)) as u32;
        let mut positions = simplified_rest.positions().to_vec();
        positions.extend(rows.iter().map(|row| self.mesh.positions()[*row as usize]));
        let mut faces = simplified_rest.faces().to_vec();
        faces.extend(back.iter().map(|face| self.mesh.faces()[*face as usize].map(new_row)));
        let mut mesh = Mesh::by_construction(positions, faces);
        if simplified_rest.position_id().is_some() || self.mesh.position_id().is_some() {
            let mut ids: Vec<u32> = (0..n as u32).map(|row| simplified_rest.position_of(row)).collect();
            for (at, row) in rows.iter().enumerate() {
                let same = |other: &u32| self.mesh.position_of(*other) == self.mesh.position_of(*row);
                let first = rows[..at].iter().position(same).unwrap_or(at);
                ids.push((n + first) as u32);
            }
            mesh = mesh.with_position_id(ids).unwrap_or_else(empty_on_error);
        }
        for (attribute, original) in simplified_rest.attributes().iter().zip(self.mesh.attributes()) {
            let mut values = attribute.values.clone();
            let more: Vec<u32> = match attribute.domain {
                Domain::Vertex => rows.clone(),
                Domain::Corner => back.iter().flat_map(|face| 3 * face..3 * face + 3).collect(),
                Domain::Face => back.to_vec(),
            };
            more.iter().for_each(|row| values.extend_from_slice(original.row(*row as usize)));
            let attribute_of_both = Attribute {
                semantic: attribute.semantic.clone(),
                domain: attribute.domain,
                width: attribute.width,
                values,
            };
            mesh = mesh.with_attribute(attribute_of_both).unwrap_or_else(empty_on_error);
        }
        mesh
    }
}

/// All rows of a mesh, and its faces except some.
fn without_faces(mesh: &Mesh, left_out: &[u32]) -> Mesh {
    let n_faces = mesh.faces().len() as u32;
    let kept_faces: Vec<u32> = (0..n_faces).filter(|face| left_out.binary_search(face).is_err()).collect();
    let faces = kept_faces.iter().map(|face| mesh.faces()[*face as usize]).collect();
    let mut rest = Mesh::by_construction(mesh.positions().to_vec(), faces);
    if let Some(ids) = mesh.position_id() {
        rest = rest.with_position_id(ids.to_vec()).unwrap_or_else(empty_on_error);
    }
    for attribute in mesh.attributes() {
        let rows: Box<dyn Iterator<Item = u32>> = match attribute.domain {
            Domain::Vertex => Box::new(0..mesh.positions().len() as u32),
            Domain::Corner => Box::new(kept_faces.iter().flat_map(|face| 3 * face..3 * face + 3)),
            Domain::Face => Box::new(kept_faces.iter().copied()),
        };
        let values = rows.flat_map(|row| attribute.row(row as usize)).copied().collect();
        let (semantic, domain, width) = (attribute.semantic.clone(), attribute.domain, attribute.width);
        let same = Attribute { semantic, domain, width, values };
        rest = rest.with_attribute(same).unwrap_or_else(empty_on_error);
    }
    rest
}

/// Cannot happen: rows and values are those of a valid mesh.
fn empty_on_error(error: InvalidMesh) -> Mesh {
    debug_assert!(false, "{error}");
    Mesh::default()
}
