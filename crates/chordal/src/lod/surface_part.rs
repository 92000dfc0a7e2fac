//! `SurfacePart`: a part of a surface that is made piece by piece, simplified and joined without the rest of it.
use super::reduction::ReductionStats;
use super::simplify::{ProgressiveSimplifier, SimplifyInput};
use super::surface::NONE;
use crate::budget::{AttributeLimits, Bound, ErrorLimit, Job, JobError, Refusal, RefusalCode, Tolerance};
use crate::convert::lattices::{GridBlock, VertexKey};
use crate::explicit::{Attribute, Domain, Mesh, Topology};
use std::borrow::Borrow;
use std::collections::BTreeMap;

/// A box of samples of a lattice, and on which sides the lattice goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeBox {
    /// The index of its first sample.
    pub low: [i64; 3],
    /// That of its last one, which the box beside it has, too.
    pub high: [i64; 3],
    /// For each axis, whether another box is beyond its low and its high side.
    pub goes_on: [[bool; 2]; 3],
}

impl LatticeBox {
    /// Whether a vertex lies on a side beyond which another box is.
    #[must_use]
    pub fn shares(&self, key: &VertexKey) -> bool {
        let on = |axis: usize| {
            let at = key.lattice[axis];
            let [low, high] = self.goes_on[axis];
            // A vertex within an edge along the axis is beside the side.
            usize::from(key.kind) != axis
                && ((low && at == self.low[axis]) || (high && at == self.high[axis]))
        };
        (0..3).any(on)
    }
}

/// The triangles of a part of a surface, with what joins them to the other parts.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePart {
    /// The triangles.
    pub mesh: Mesh,
    /// The rows at which other parts go on, ascending, with their keys in the whole.
    pub shared: Vec<(u32, VertexKey)>,
    /// How far the triangles are from this part of the true surface.
    pub bound: Bound,
}

impl SurfacePart {
    /// The triangles of a block as a part; `None` where it has none.
    #[must_use]
    pub fn from_block(block: GridBlock, place: &LatticeBox) -> Option<Self> {
        let GridBlock { positions, faces, normals, vertex_keys, bound, .. } = block;
        let bound = bound?;
        let mut mesh = Mesh::by_construction(positions, faces);
        if !normals.is_empty() {
            mesh = mesh.with_attribute(Attribute::vertex_normals(&normals)).ok()?;
        }
        let shared = (0..).zip(vertex_keys).filter(|(_, key)| place.shares(key)).collect();
        Some(Self { mesh, shared, bound })
    }

    /// Parts that fill a box as one: vertices of one key are one vertex, and those that are no longer at a side are free.
    /// The bound is the largest of all.
    ///
    /// Cost: O(n log n) in the shared vertices, O(n) in the rest.
    ///
    /// # Errors
    /// [`JobError::Refused`]: vertices of one key lie apart: these are no parts of one surface
    /// ([`RefusalCode::Unsupported`]); more vertices than a mesh may have ([`RefusalCode::TooManyTriangles`]);
    /// no parts ([`RefusalCode::Empty`]).
    pub fn join<P: Borrow<Self>>(parts: &[P], place: &LatticeBox) -> Result<Self, JobError> {
        let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
        let parts: Vec<&Self> = parts.iter().map(Borrow::borrow).collect();
        let Some(first) = parts.first() else {
            return Err(refused(RefusalCode::Empty, "there are no parts to join".into()));
        };
        let mut positions: Vec<[f64; 3]> = Vec::new();
        let mut faces: Vec<[u32; 3]> = Vec::new();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); first.mesh.attributes().len()];
        let mut known: BTreeMap<VertexKey, u32> = BTreeMap::new();
        for part in &parts {
            let attributes = part.mesh.attributes();
            let is_alike = attributes.len() == values.len()
                && attributes.iter().zip(first.mesh.attributes()).all(|(a, b)| {
                    a.domain == Domain::Vertex && a.width == b.width && a.semantic == b.semantic
                });
            if !is_alike {
                let message =
                    "parts have other attributes than the first one, or some that belong to no vertex";
                return Err(refused(RefusalCode::Unsupported, message.into()));
            }
            let mut keys = part.shared.iter().peekable();
            let mut numbers = Vec::with_capacity(part.mesh.positions().len());
            for (row, here) in (0_u32..).zip(part.mesh.positions()) {
                let key = keys.next_if(|(shared, _)| *shared == row).map(|(_, key)| *key);
                if let Some(number) = key.and_then(|key| known.get(&key)) {
                    if positions[*number as usize].map(f64::to_bits) != here.map(f64::to_bits) {
                        let place = key.map(|key| key.lattice).unwrap_or_default();
                        let message = format!(
                            "vertices of one key lie apart: these are no parts of one surface ({place:?})"
                        );
                        return Err(refused(RefusalCode::Unsupported, message));
                    }
                    numbers.push(*number);
                    continue;
                }
                let number = u32::try_from(positions.len()).unwrap_or(NONE);
                positions.push(*here);
                for (values, attribute) in values.iter_mut().zip(attributes) {
                    values.extend_from_slice(attribute.row(row as usize));
                }
                numbers.push(number);
                if let Some(key) = key {
                    known.insert(key, number);
                }
            }
            faces.extend(part.mesh.faces().iter().map(|face| face.map(|row| numbers[row as usize])));
        }
        let too_many = |error| refused(RefusalCode::TooManyTriangles, format!("the parts together: {error}"));
        let mut mesh = Mesh::new(positions, faces).map_err(too_many)?;
        for (values, attribute) in values.into_iter().zip(first.mesh.attributes()) {
            let joined = Attribute { values, ..attribute.clone() };
            mesh = mesh.with_attribute(joined).map_err(too_many)?;
        }
        let mut shared: Vec<(u32, VertexKey)> =
            known.into_iter().filter(|(key, _)| place.shares(key)).map(|(key, row)| (row, key)).collect();
        shared.sort_unstable();
        let bound =
            Bound::of_parts(parts.iter().map(|part| &part.bound)).unwrap_or_else(|| first.bound.clone());
        Ok(Self { mesh, shared, bound })
    }

    /// The same part with as few triangles as fit within a length of these. Shared vertices, the edges between them and
    /// the values there stay, and no edge is made between two of them: whatever length other parts are simplified with, all
    /// of them fit, and together they are manifold where they were.
    ///
    /// The bound is that of this part and the length that was lost, added.
    ///
    /// Cost: as for [`simplify`](super::simplify()).
    ///
    /// # Errors
    /// As for [`simplify`](super::simplify()).
    pub fn simplified(&self, length: Tolerance, job: &Job) -> Result<(Self, ReductionStats), JobError> {
        let mut fixed = vec![false; if self.shared.is_empty() { 0 } else { self.mesh.positions().len() }];
        self.shared.iter().for_each(|(row, _)| fixed[*row as usize] = true);
        let limit = ErrorLimit::uniform(length.get());
        let attributes = AttributeLimits::default();
        let topology = Topology::Indices;
        let asked = SimplifyInput { mesh: &self.mesh, topology, fixed_rows: &fixed, limit, attributes, job };
        job.run(|| {
            let mut simplifier = ProgressiveSimplifier::new(&asked)?;
            let Some(made) = simplifier.simplify_within(&limit, job)? else {
                return Ok((self.clone(), simplifier.unchanged().shape.stats));
            };
            let key_of: BTreeMap<u32, VertexKey> = self.shared.iter().copied().collect();
            let rows = simplifier.fixed_rows();
            let shared = (0..).zip(&rows).filter_map(|(row, from)| Some((row, *key_of.get(from)?))).collect();
            let bound = self.bound.then(&made.bound);
            Ok((Self { mesh: made.shape.mesh, shared, bound }, made.shape.stats))
        })
    }
}
