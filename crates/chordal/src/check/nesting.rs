//! Nesting of components: exact winding numbers around a few vertices of each.
use super::component::{Component, ComponentSet, NONE};
use super::winding::{RayCrossing, crossing};
use crate::budget::{Job, JobError, par_map};
use crate::explicit::{Bvh, Mesh};
use crate::math::Box3;

/// The other components that enclose a component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NestingDepth {
    /// These, ascending.
    Within(Vec<u32>),
    /// All tested vertices lie on the surface of another component, or none was tested.
    Touching,
}

/// For up to this many pairs of components, the boxes are compared one by one.
const FEW_PAIRS: usize = 1 << 16;

/// Finds the components with an inside that enclose each component; only those with an inside are tested.
///
/// # Errors
/// Those of [`Bvh::build`], and [`JobError::Cancelled`] if the job was cancelled.
pub(super) fn nesting_depths(
    mesh: &Mesh,
    shapes: &ComponentSet,
    job: &Job,
) -> Result<Vec<NestingDepth>, JobError> {
    let ComponentSet { components, labels, signs } = shapes;
    let has_inside = |i: usize| signs[i].is_some();
    let mut nested = vec![NestingDepth::Within(Vec::new()); components.len()];
    let solid: Vec<usize> = (0..components.len()).filter(|i| has_inside(*i)).collect();
    let encloses = |outer: usize, inner: usize| {
        outer != inner && is_within(&components[inner].bounds, &components[outer].bounds)
    };
    // Comparing boxes saves the tree if no component can be inside another, as in most files. With
    // many components the pairs would cost more than the tree.
    let may_be_within = |inner: usize| solid.iter().any(|outer| encloses(*outer, inner));
    let few = solid.len() * solid.len() <= FEW_PAIRS;
    let tested: Vec<usize> = solid.iter().copied().filter(|i| !few || may_be_within(*i)).collect();
    if tested.is_empty() || solid.len() < 2 {
        return Ok(nested);
    }
    let tree = Bvh::build(mesh, job)?;
    let outermost = outermost_rows(mesh, labels, components);
    let search = NestingSearch {
        mesh,
        tree,
        labels,
        may_enclose: |outer, inner| has_inside(outer) && encloses(outer, inner),
    };
    let depths = par_map(job, &tested, |_, inner| {
        // The result of a cancelled job is discarded.
        if job.is_cancelled() { NestingDepth::Touching } else { search.depth(*inner, &outermost[*inner]) }
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    tested.iter().zip(depths).for_each(|(i, depth)| nested[*i] = depth);
    Ok(nested)
}

fn is_within(inner: &Box3, outer: &Box3) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// The first corner of each component, and its lowest and highest corner along each axis; ties go to the
/// first.
fn outermost_rows(mesh: &Mesh, labels: &[u32], components: &[Component]) -> Vec<[u32; 7]> {
    let mut rows: Vec<[u32; 7]> =
        components.iter().map(|c| [mesh.faces()[c.first_face as usize][0]; 7]).collect();
    let positions = mesh.positions();
    for (face, label) in mesh.faces().iter().zip(labels).filter(|(_, label)| **label != NONE) {
        let rows = &mut rows[*label as usize];
        for &row in face {
            for k in 0..3 {
                let x = |row: u32| positions[row as usize][k];
                rows[1 + k] = if x(row) < x(rows[1 + k]) { row } else { rows[1 + k] };
                rows[4 + k] = if x(row) > x(rows[4 + k]) { row } else { rows[4 + k] };
            }
        }
    }
    rows
}

struct NestingSearch<'a, F> {
    mesh: &'a Mesh,
    tree: Bvh,
    labels: &'a [u32],
    /// Whether a component has an inside and its box encloses that of another one.
    may_enclose: F,
}

/// The position of a point relative to a component.
#[derive(Clone, Copy, PartialEq, Eq)]
enum BoundedSide {
    Inside,
    On,
    Outside,
}

impl<F: Fn(usize, usize) -> bool> NestingSearch<'_, F> {
    fn depth(&self, inner: usize, rows: &[u32; 7]) -> NestingDepth {
        // The ray upwards from the first corner crosses every enclosing component.
        // A component encloses another if its surface has a vertex of it inside and none outside.
        // Vertices that lie on its surface decide nothing, so the other extreme vertices are asked.
        let mut outer: Vec<(u32, BoundedSide)> = self.sides(inner, rows[0]);
        outer.retain(|(_, side)| *side != BoundedSide::Outside);
        for &row in &rows[1..] {
            if outer.is_empty() {
                break;
            }
            let sides = self.sides(inner, row);
            outer.retain_mut(|(label, known_side)| {
                let side_found = sides.iter().find(|(other, _)| other == label);
                // Not crossed by the ray from this vertex, so outside.
                match side_found.map_or(BoundedSide::Outside, |(_, side)| *side) {
                    BoundedSide::Outside => return false,
                    BoundedSide::Inside => *known_side = BoundedSide::Inside,
                    BoundedSide::On => {}
                }
                true
            });
        }
        if outer.iter().any(|(_, side)| *side == BoundedSide::On) {
            return NestingDepth::Touching;
        }
        NestingDepth::Within(outer.into_iter().map(|(label, _)| label).collect())
    }

    /// The position of a vertex relative to each component above it that may enclose `inner`, by component
    /// number.
    fn sides(&self, inner: usize, row: u32) -> Vec<(u32, BoundedSide)> {
        let point = self.mesh.positions()[row as usize];
        let mut crossings: Vec<(u32, RayCrossing)> = Vec::new();
        self.tree.faces_above(point, |face| {
            let label = self.labels[face as usize];
            if label != NONE && (self.may_enclose)(label as usize, inner) {
                let met = crossing(point, self.mesh.corners(face as usize));
                crossings.extend((met != RayCrossing::None).then_some((label, met)));
            }
        });
        crossings.sort_unstable_by_key(|(label, _)| *label);
        let side = |met: &[(u32, RayCrossing)]| {
            if met.iter().any(|(_, crossing)| *crossing == RayCrossing::On) {
                return BoundedSide::On;
            }
            // As many faces crossed from behind as from the front: winding number 0.
            let upward = met.iter().filter(|(_, crossing)| *crossing == RayCrossing::FromBehind).count();
            if 2 * upward == met.len() { BoundedSide::Outside } else { BoundedSide::Inside }
        };
        crossings.chunk_by(|a, b| a.0 == b.0).map(|met| (met[0].0, side(met))).collect()
    }
}
