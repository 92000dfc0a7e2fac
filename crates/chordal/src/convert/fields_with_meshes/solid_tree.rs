//! `SolidTree`: a field with closed meshes as unions, intersections and differences of solids.
//!
//! Its leaves are placed meshes, and the largest parts of the field without meshes. Each part is meshed separately,
//! and the triangles are then combined by mesh booleans. So the distance to a mesh, with its kinks everywhere, is
//! never meshed.
use super::placed_mesh::{PlacedMesh, linear_forms};
use crate::budget::{Bounded, Failure};
use crate::convert::mesh_leaf::MeshLeaf;
use crate::explicit::Mesh;
use crate::implicit::evaluation::{Binary, Unary};
use crate::implicit::shapes::cuboid;
use crate::implicit::{Expr, ExprGraph, Field, Term};
use crate::math::{Box3, greater};

/// A field as booleans of closed meshes and of fields without any.
#[derive(Clone, Debug)]
pub struct SolidTree {
    /// Operands come before the nodes that combine them; the last node is the whole solid.
    pub nodes: Vec<SolidNode>,
}

/// A solid of a [`SolidTree`]. Numbers are indices of earlier nodes.
#[derive(Clone, Debug)]
pub enum SolidNode {
    /// The placed triangles of a closed mesh, with the error of placing them.
    Triangles(Bounded<Mesh>),
    /// A part without meshes, clipped to a box that contains the whole solid.
    Field(Field),
    /// All points of either solid.
    Union(usize, usize),
    /// All points of both solids.
    Intersection(usize, usize),
    /// All points of the first solid that are not in the second.
    Difference(usize, usize),
}

/// The margin of the box to which parts are clipped, as a share of its longest side. Chosen: the sides of the box have to
/// be far from all relevant surfaces.
const CLIP_MARGIN: f64 = 1.0 / 16.0;

impl SolidTree {
    /// The tree of a field. `None` if some mesh is not closed or its map is not affine, if a mesh is joined with the
    /// rest by other operations than minima, maxima and complements (offsets, blends), and for a field without meshes
    /// or with a single mesh.
    ///
    /// The solid is the same if [`Field::bounds`] is right: every part is clipped to the same box, beyond which no mesh
    /// and no other part extends. Cost: that of placing the meshes.
    ///
    /// # Errors
    /// If the map of a mesh has no inverse, or a placed coordinate is not finite.
    pub fn from_field(field: &Field) -> Result<Option<Self>, Failure<Mesh>> {
        let graph = ExprGraph::from_expr(field.sign());
        match TreeTerms::new(graph.terms(), field) {
            Some(terms) => terms.solids(),
            None => Ok(None),
        }
    }
}

/// The index of a node, and whether the solid is its complement.
type SidedNode = (usize, bool);

/// The terms of a field that is being taken apart.
struct TreeTerms<'a> {
    field: &'a Field,
    terms: &'a [Term],
    exprs: Vec<Expr>,
    /// Whether a term depends on a mesh.
    has_mesh: Vec<bool>,
    forms: Vec<Option<super::placed_mesh::LinearForm>>,
    /// The box of the whole solid and of all meshes, with a margin.
    clip: Box3,
}

impl<'a> TreeTerms<'a> {
    /// `None` if some mesh is not closed, or its map is not affine.
    fn new(terms: &'a [Term], field: &'a Field) -> Option<Self> {
        let mut tree = Self {
            field,
            terms,
            exprs: expressions(terms),
            has_mesh: meshes_below(terms),
            forms: linear_forms(terms),
            clip: field.bounds(),
        };
        for (number, term) in terms.iter().enumerate() {
            let Term::Leaf(leaf, _) = term else { continue };
            let Some(mesh) = leaf.as_any().and_then(|any| any.downcast_ref::<MeshLeaf>()) else { continue };
            if !mesh.has_sides() || !mesh.is_closed() {
                return None;
            }
            let placed = tree.placed(number)?;
            let mesh = placed.triangles(field).ok()?;
            tree.clip = tree.clip.union(mesh.shape.bounds());
        }
        let Box3 { min, max } = tree.clip;
        let longest = (0..3).fold(0.0, |most, k| greater(max[k] - min[k], most));
        let margin = CLIP_MARGIN * longest;
        tree.clip = Box3 { min: min.map(|x| x - margin), max: max.map(|x| x + margin) };
        (longest.is_finite() && tree.has_mesh.last() == Some(&true)).then_some(tree)
    }

    fn placed(&self, leaf: usize) -> Option<PlacedMesh> {
        let Term::Leaf(leaf, at) = &self.terms[leaf] else { return None };
        PlacedMesh::new(leaf, at.map(|term| self.forms[term as usize]))
    }

    fn solids(&self) -> Result<Option<SolidTree>, Failure<Mesh>> {
        let root = self.terms.len() - 1;
        // 1. Marks the terms that are solids of the tree, from the root down.
        let mut is_solid = vec![false; self.terms.len()];
        is_solid[root] = true;
        for number in (0..=root).rev() {
            if is_solid[number] {
                self.mark_below(number, &mut is_solid);
            }
        }
        // 2. Builds the nodes, from the leaves up.
        let mut nodes = Vec::new();
        let mut node_of: Vec<Option<SidedNode>> = vec![None; self.terms.len()];
        for number in (0..=root).filter(|number| is_solid[*number]) {
            let Some(node) = self.solid(number, &node_of, &mut nodes)? else { return Ok(None) };
            node_of[number] = Some(node);
        }
        let is_whole = matches!(node_of[root], Some((_, false)));
        let combines = !matches!(nodes.last(), None | Some(SolidNode::Triangles(_) | SolidNode::Field(_)));
        Ok((is_whole && combines).then_some(SolidTree { nodes }))
    }

    /// Marks the operands of a term.
    fn mark_below(&self, number: usize, is_solid: &mut [bool]) {
        match self.shape_of(number) {
            TermShape::Same(below) | TermShape::Complement(below) => is_solid[below] = true,
            TermShape::Choice(_, a, b) => [a, b].into_iter().for_each(|below| is_solid[below] = true),
            TermShape::Part | TermShape::Mesh | TermShape::Other => {}
        }
    }

    fn shape_of(&self, number: usize) -> TermShape {
        let is_positive = |k: u32| matches!(self.terms[k as usize], Term::Const(value) if value > 0.0);
        match &self.terms[number] {
            Term::Unary(Unary::Neg, below) => TermShape::Complement(*below as usize),
            _ if !self.has_mesh[number] => TermShape::Part,
            // Positive factors do not change the solid.
            Term::Binary(Binary::Mul | Binary::Div, a, b) if is_positive(*b) => TermShape::Same(*a as usize),
            Term::Binary(Binary::Mul, a, b) if is_positive(*a) => TermShape::Same(*b as usize),
            Term::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                TermShape::Choice(*op, *a as usize, *b as usize)
            }
            Term::Leaf(..) => TermShape::Mesh,
            _ => TermShape::Other,
        }
    }

    /// The node of a term, from those of earlier terms.
    fn solid(
        &self,
        number: usize,
        node_of: &[Option<SidedNode>],
        nodes: &mut Vec<SolidNode>,
    ) -> Result<Option<SidedNode>, Failure<Mesh>> {
        let node = match self.shape_of(number) {
            TermShape::Same(below) => return Ok(node_of[below]),
            TermShape::Complement(below) => return Ok(node_of[below].map(|(node, is_not)| (node, !is_not))),
            TermShape::Choice(op, a, b) => {
                let (Some(a), Some(b)) = (node_of[a], node_of[b]) else { return Ok(None) };
                let (node, is_complement) = joined(a, b, op);
                nodes.push(node);
                return Ok(Some((nodes.len() - 1, is_complement)));
            }
            TermShape::Part => SolidNode::Field(self.clipped(number)?),
            TermShape::Mesh => match self.placed(number) {
                Some(placed) => SolidNode::Triangles(placed.triangles(self.field)?),
                None => return Ok(None),
            },
            TermShape::Other => return Ok(None),
        };
        nodes.push(node);
        Ok(Some((nodes.len() - 1, false)))
    }

    /// The field of a term, clipped to the box.
    fn clipped(&self, term: usize) -> Result<Field, Failure<Mesh>> {
        let part = Field::new(self.exprs[term].clone());
        if part.is_within(&self.clip) {
            return Ok(part.known_bounds(self.clip));
        }
        let Box3 { min, max } = self.clip;
        let unbounded = |_| {
            Failure::refused(crate::budget::RefusalCode::NotFinite, "the box of the shape has no finite size")
        };
        let sides = cuboid(std::array::from_fn(|k| max[k] - min[k])).map_err(unbounded)?;
        let middle = std::array::from_fn(|k| min[k] + 0.5 * (max[k] - min[k]));
        let sides = sides.moved(middle).map_err(unbounded)?;
        Ok(part.intersection(&sides))
    }
}

/// The role of a term in a tree of solids.
enum TermShape {
    /// The solid of another term.
    Same(usize),
    Complement(usize),
    /// A minimum or a maximum.
    Choice(Binary, usize, usize),
    /// A part without meshes.
    Part,
    Mesh,
    /// Another operation on a mesh.
    Other,
}

/// The union or the intersection of two solids, each of which may be a complement.
fn joined((a, a_is_not): SidedNode, (b, b_is_not): SidedNode, op: Binary) -> (SolidNode, bool) {
    match (op, a_is_not, b_is_not) {
        (Binary::Min, false, false) => (SolidNode::Union(a, b), false),
        (Binary::Min, true, true) => (SolidNode::Intersection(a, b), true),
        // a ∪ ¬b is the complement of b − a.
        (Binary::Min, false, true) => (SolidNode::Difference(b, a), true),
        (Binary::Min, true, false) => (SolidNode::Difference(a, b), true),
        (_, false, false) => (SolidNode::Intersection(a, b), false),
        (_, true, true) => (SolidNode::Union(a, b), true),
        (_, false, true) => (SolidNode::Difference(a, b), false),
        (_, true, false) => (SolidNode::Difference(b, a), false),
    }
}

/// Each term as an expression.
fn expressions(terms: &[Term]) -> Vec<Expr> {
    let axes = Expr::axes();
    let mut exprs: Vec<Expr> = Vec::with_capacity(terms.len());
    for term in terms {
        let of = |k: &u32| &exprs[*k as usize];
        exprs.push(match term {
            Term::Const(value) => Expr::constant(*value),
            Term::Axis(axis) => axes[usize::from(*axis)].clone(),
            Term::Unary(op, a) => Expr::unary(*op, of(a)),
            Term::Binary(op, a, b) => Expr::binary(*op, of(a), of(b)),
            Term::Leaf(leaf, at) => Expr::leaf(leaf.clone(), at.each_ref().map(|k| of(k).clone())),
        });
    }
    exprs
}

fn meshes_below(terms: &[Term]) -> Vec<bool> {
    let mut has_mesh: Vec<bool> = Vec::with_capacity(terms.len());
    for term in terms {
        let of = |k: &u32| has_mesh[*k as usize];
        has_mesh.push(match term {
            Term::Const(_) | Term::Axis(_) => false,
            Term::Unary(_, a) => of(a),
            Term::Binary(_, a, b) => of(a) || of(b),
            Term::Leaf(leaf, at) => {
                leaf.as_any().is_some_and(|any| any.is::<MeshLeaf>()) || at.iter().any(of)
            }
        });
    }
    has_mesh
}
