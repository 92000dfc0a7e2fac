//! `SurfacePart`: a part of a surface that is built, simplified and joined piece by piece, never as a whole.
use super::reduction::ReductionStats;
use super::simplify::{ProgressiveSimplifier, SimplifyInput};
use super::surface::NONE;
use crate::budget::{AttributeLimits, Bound, ErrorLimit, Job, JobError, Refusal, RefusalCode, Tolerance};
use crate::convert::lattices::{GridBlock, VertexKey};
use crate::explicit::{Attribute, Domain, Mesh, Topology};
use std::borrow::Borrow;
use std::collections::BTreeMap;

/// A box of samples of a lattice, and the sides beyond which the lattice continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeBox {
    /// The index of its first sample.
    pub low: [i64; 3],
    /// The index of its last sample, which the neighbouring box contains, too.
    pub high: [i64; 3],
    /// For each axis: whether there is another box beyond its low and its high side.
    pub goes_on: [[bool; 2]; 3],
}

impl LatticeBox {
    /// Whether a vertex lies on a side that another box shares.
    #[must_use]
    pub fn shares(&self, key: &VertexKey) -> bool {
        let on = |axis: usize| {
            let at = key.lattice[axis];
            let [low, high] = self.goes_on[axis];
            // A vertex inside an edge along the axis is not on the side.
            usize::from(key.kind) != axis
                && ((low && at == self.low[axis]) || (high && at == self.high[axis]))
        };
        (0..3).any(on)
    }
}

/// The triangles of a part of a surface, with the vertices that join them to other parts.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePart {
    /// The triangles.
    pub mesh: Mesh,
    /// The rows shared with other parts, ascending, with their keys in the whole surface.
    pub shared: Vec<(u32, VertexKey)>,
    /// The distance of the triangles from this part of the true surface.
    pub bound: Bound,
}

impl SurfacePart {
    /// The triangles of a block as a part; `None` if it has none.
    #[must_use]
    pub fn from_block(block: GridBlock, part_box: &LatticeBox) -> Option<Self> {
        let GridBlock { positions, faces, normals, vertex_keys, bound, .. } = block;
        let bound = bound?;
        let mut mesh = Mesh::by_construction(positions, faces);
        if !normals.is_empty() {
            mesh = mesh.with_attribute(Attribute::vertex_normals(&normals)).ok()?;
        }
        let shared = (0..).zip(vertex_keys).filter(|(_, key)| part_box.shares(key)).collect();
        Some(Self { mesh, shared, bound })
    }

    /// Joins parts that fill a box: vertices with the same key become one vertex, and those that are no
    /// longer at a side become free. The bound is the largest of all parts.
    ///
    /// Cost: O(n log n) in the shared vertices, O(n) in all others.
    ///
    /// # Errors
    /// [`JobError::Refused`]: if vertices with the same key have different positions, so that these are no
    /// parts of one surface ([`RefusalCode::Unsupported`]); if there are more vertices than a mesh may have
    /// ([`RefusalCode::TooManyTriangles`]); without parts ([`RefusalCode::Empty`]).
    pub fn join<P: Borrow<Self>>(parts: &[P], part_box: &LatticeBox) -> Result<Self, JobError> {
        let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
        let parts: Vec<&Self> = parts.iter().map(Borrow::borrow).collect();
        let Some(first) = parts.first() else {
            return Err(refused(RefusalCode::Empty, "there are no parts to join".into()));
        };
        let mut positions: Vec<[f64; 3]> = Vec::new();
        let mut faces: Vec<[u32; 3]> = Vec::new();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); first.mesh.attributes().len()];
        let mut rows_by_key: BTreeMap<VertexKey, u32> = BTreeMap::new();
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
            // `shared` ascends by row, so that one pass finds the key of each row.
            let mut keys = part.shared.iter().peekable();
            let mut numbers = Vec::with_capacity(part.mesh.positions().len());
            for (row, point) in (0_u32..).zip(part.mesh.positions()) {
                let key = keys.next_if(|(shared, _)| *shared == row).map(|(_, key)| *key);
                if let Some(number) = key.and_then(|key| rows_by_key.get(&key)) {
                    if positions[*number as usize].map(f64::to_bits) != point.map(f64::to_bits) {
                        let lattice = key.map(|key| key.lattice).unwrap_or_default();
                        let message = format!(
                            "vertices of one key lie apart: these are no parts of one surface ({lattice:?})"
                        );
                        return Err(refused(RefusalCode::Unsupported, message));
                    }
                    numbers.push(*number);
                    continue;
                }
                // If there are more than an index can number, `Mesh::new` refuses them below.
                let number = u32::try_from(positions.len()).unwrap_or(NONE);
                positions.push(*point);
                for (values, attribute) in values.iter_mut().zip(attributes) {
                    values.extend_from_slice(attribute.row(row as usize));
                }
                numbers.push(number);
                if let Some(key) = key {
                    rows_by_key.insert(key, number);
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
        let mut shared: Vec<(u32, VertexKey)> = rows_by_key
            .into_iter()
            .filter(|(key, _)| part_box.shares(key))
            .map(|(key, row)| (row, key))
            .collect();
        shared.sort_unstable();
        let bound =
            Bound::of_parts(parts.iter().map(|part| &part.bound)).unwrap_or_else(|| first.bound.clone());
        Ok(Self { mesh, shared, bound })
    }

    /// The same part with as few triangles as fit within a length of the current ones. Shared vertices, the
    /// edges between them and the values there stay, and no edge is added between two of them: for any
    /// lengths with which the parts are simplified, all of them fit together, and they are manifold where
    /// they were.
    ///
    /// The bound is the sum of this part's bound and that of the simplification.
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
        let input = SimplifyInput { mesh: &self.mesh, topology, fixed_rows: &fixed, limit, attributes, job };
        job.run(|| {
            let mut simplifier = ProgressiveSimplifier::new(&input)?;
            let Some(simplified) = simplifier.simplify_within(&limit, job)? else {
                return Ok((self.clone(), simplifier.unchanged().shape.stats));
            };
            let key_of: BTreeMap<u32, VertexKey> = self.shared.iter().copied().collect();
            let rows = simplifier.fixed_rows();
            let shared = (0..).zip(&rows).filter_map(|(row, from)| Some((row, *key_of.get(from)?))).collect();
            let bound = self.bound.then(&simplified.bound);
            Ok((Self { mesh: simplified.shape.mesh, shared, bound }, simplified.shape.stats))
        })
    }
}
