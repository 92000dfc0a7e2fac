//! Which components lie within which others: exact winding numbers around a few vertices of each.
use super::components::{Component, NONE, Shapes};
use super::winding::{Crossing, crossing};
use crate::budget::{Job, Stopped, par_map};
use crate::explicit::{Bvh, Mesh};
use crate::math::Box3;

/// How many others enclose a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nested {
    /// So many.
    Within(u32),
    /// All vertices looked at lie on the surface of another one; or nobody looked.
    Touching,
}

/// Pairs of components up to which their boxes are compared one by one.
const FEW_PAIRS: usize = 1 << 16;

/// How many components with an inside enclose each component, of which only those with an inside are looked at.
///
/// # Errors
/// Those of [`Bvh::build`], and [`Stopped::Cancelled`] when the job was.
pub(super) fn nest(mesh: &Mesh, shapes: &Shapes, job: &Job) -> Result<Vec<Nested>, Stopped> {
    let Shapes { found: components, labels, signs } = shapes;
    let has_inside = |i: usize| signs[i].is_some();
    let mut nested = vec![Nested::Within(0); components.len()];
    let solid: Vec<usize> = (0..components.len()).filter(|i| has_inside(*i)).collect();
    let encloses = |outer: usize, inner: usize| {
        outer != inner && is_within(&components[inner].bounds, &components[outer].bounds)
    };
    let may_be_within = |inner: usize| solid.iter().any(|outer| encloses(*outer, inner));
    let few = solid.len() * solid.len() <= FEW_PAIRS;
    let asked: Vec<usize> = solid.iter().copied().filter(|i| !few || may_be_within(*i)).collect();
    if asked.is_empty() || solid.len() < 2 {
        return Ok(nested);
    }
    let tree = Bvh::build(mesh, job)?;
    let outermost = outermost_rows(mesh, labels, components);
    let search = Search {
        mesh,
        tree,
        labels,
        may_enclose: |outer, inner| has_inside(outer) && encloses(outer, inner),
    };
    let depths = par_map(job, &asked, |_, inner| {
        // A job that was cancelled wants no answer.
        if job.is_cancelled() { Nested::Touching } else { search.depth(*inner, &outermost[*inner]) }
    });
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    asked.iter().zip(depths).for_each(|(i, depth)| nested[*i] = depth);
    Ok(nested)
}

fn is_within(inner: &Box3, outer: &Box3) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// The first corner of each component, and the lowest and highest along each axis; the first of those that tie.
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

struct Search<'a, F> {
    mesh: &'a Mesh,
    tree: Bvh,
    labels: &'a [u32],
    /// Whether a component has an inside and its box encloses that of another one.
    may_enclose: F,
}

/// Where a point lies with respect to a component.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Inside,
    On,
    Outside,
}

impl<F: Fn(usize, usize) -> bool> Search<'_, F> {
    fn depth(&self, inner: usize, rows: &[u32; 7]) -> Nested {
        // Whoever encloses it is crossed on the way up from its first corner.
        let mut outer: Vec<(u32, Side)> = self.sides(inner, rows[0]);
        outer.retain(|(_, side)| *side != Side::Outside);
        for &row in &rows[1..] {
            if outer.is_empty() {
                break;
            }
            let sides = self.sides(inner, row);
            outer.retain_mut(|(label, known)| {
                let found = sides.iter().find(|(other, _)| other == label);
                match found.map_or(Side::Outside, |(_, side)| *side) {
                    Side::Outside => return false,
                    Side::Inside => *known = Side::Inside,
                    Side::On => {}
                }
                true
            });
        }
        if outer.iter().any(|(_, side)| *side == Side::On) {
            return Nested::Touching;
        }
        Nested::Within(outer.len() as u32)
    }

    /// Where a vertex lies with respect to the components above it that may enclose `inner`, by their numbers.
    fn sides(&self, inner: usize, row: u32) -> Vec<(u32, Side)> {
        let point = self.mesh.positions()[row as usize];
        let mut crossings: Vec<(u32, Crossing)> = Vec::new();
        self.tree.above(point, |face| {
            let label = self.labels[face as usize];
            if label != NONE && (self.may_enclose)(label as usize, inner) {
                let met = crossing(point, self.mesh.corners(face as usize));
                crossings.extend((met != Crossing::None).then_some((label, met)));
            }
        });
        crossings.sort_unstable_by_key(|(label, _)| *label);
        let side = |met: &[(u32, Crossing)]| {
            if met.iter().any(|(_, crossing)| *crossing == Crossing::On) {
                return Side::On;
            }
            let upward = met.iter().filter(|(_, crossing)| *crossing == Crossing::FromBehind).count();
            if 2 * upward == met.len() { Side::Outside } else { Side::Inside }
        };
        crossings.chunk_by(|a, b| a.0 == b.0).map(|met| (met[0].0, side(met))).collect()
    }
}
