//! `CsgMaterials`: the materials of a CSG tree's primitives, and which of them a face has.
//!
//! A primitive may occur at several places of a tree, each with its own material: the common top of two boxes
//! is one plane. So a face has the material of the place that creates it: the place whose solid is inside
//! just below the face and outside just above, with no other place covering it.
use super::subgraph::{mark_of, subgraph_terms};
use super::tree::joined;
use super::{CsgNode, CsgTree, Membership};
use crate::implicit::graph::{ExprGraph, Term, parts};
use crate::implicit::material::SurfaceMaterial;
use crate::implicit::op::{Binary, Unary};
use crate::implicit::tape::Tape;
use std::collections::HashSet;

/// The materials of the primitives of a CSG tree, at each place of the tree.
#[derive(Clone, Debug)]
pub struct CsgMaterials {
    list: Vec<SurfaceMaterial>,
    /// By node of the tree.
    nodes: Vec<NodeMaterial>,
}

/// The material of an operand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OperandMaterial {
    /// 0 for none.
    pub number: u32,
    /// Whether the part is subtracted, so that no point inside has its material.
    pub cuts: bool,
}

/// The material of a primitive at one place of the tree.
#[derive(Clone, Debug)]
struct NodeMaterial {
    /// The material of its faces.
    face: FaceMaterial,
    /// The number of the material of points inside; `None` if it is that of the faces. A subtracted part has
    /// none.
    volume: Option<u32>,
}

#[derive(Clone, Debug)]
enum FaceMaterial {
    /// The number of one material; 0 for none, and for operators.
    Whole(u32),
    /// The primitive blends parts: the material is that of the part that is nearest.
    Blend(Vec<BlendPart>),
}

/// A part of a primitive that is a blend.
#[derive(Clone, Debug)]
pub struct BlendPart {
    /// Its index among the parts of all blends.
    pub index: u32,
    /// The number of its material, 0 for none.
    pub material: u32,
    /// The factor that turns its value into the primitive's unit.
    pub scale: f64,
    /// Its value.
    pub tape: Tape,
}

/// The materials that a face may have, as far as known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialChoice {
    /// There is no face.
    Never,
    /// One material, by its number; 0 for none.
    One(u32),
    /// Several, or it is not known which.
    Several,
}

impl MaterialChoice {
    /// The choice if either holds.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Never, choice) | (choice, Self::Never) => choice,
            (choice, same) if choice == same => choice,
            _ => Self::Several,
        }
    }
}

/// A part of a tree at a face.
#[derive(Clone, Copy, Debug)]
struct NodeAtFace {
    /// The memberships just below the face, and just above.
    sides: [Membership; 2],
    /// The material of the face, if the part creates it.
    face: MaterialChoice,
    /// The material of the points inside.
    volume: MaterialChoice,
}

impl NodeAtFace {
    const FACE: [Membership; 2] = [Membership::Inside, Membership::Outside];

    fn makes_face(&self) -> bool {
        self.sides == Self::FACE
    }

    fn joined(operands: &[Self], is_union: bool) -> Self {
        let sides = [0, 1].map(|k| joined(operands.iter().map(|operand| operand.sides[k]), is_union));
        // With the same side below and above there is no face.
        let decided = sides[0] != Membership::Unknown && sides[0] == sides[1];
        let volume = Self::volume(operands, is_union);
        let mut face = MaterialChoice::Never;
        // The face has the material of the first operand that creates it.
        for operand in operands.iter().filter(|operand| !decided && operand.face != MaterialChoice::Never) {
            let material = match operand.face {
                // A cut through an unmarked face shows the material inside.
                MaterialChoice::One(0) if !is_union => volume,
                other => other,
            };
            face = face.or(material);
            // Until an operand certainly creates the face, any of them may.
            if operand.makes_face() {
                break;
            }
        }
        Self { sides, face, volume }
    }

    /// The material of a point inside: in a union, that of the first operand that contains it; in an
    /// intersection, that of the first operand with a material.
    fn volume(operands: &[Self], is_union: bool) -> MaterialChoice {
        let mut volume = MaterialChoice::Never;
        for operand in operands {
            if is_union && operand.sides[0] == Membership::Outside {
                continue;
            }
            if is_union {
                volume = volume.or(operand.volume);
                if operand.sides[0] == Membership::Inside {
                    break;
                }
            } else if operand.volume != MaterialChoice::One(0) {
                return operand.volume;
            }
        }
        if volume == MaterialChoice::Never { MaterialChoice::One(0) } else { volume }
    }
}

impl CsgMaterials {
    /// The materials, in the order of their numbers from 1.
    #[must_use]
    pub fn list(&self) -> &[SurfaceMaterial] {
        &self.list
    }

    /// The parts of each blend.
    pub fn blends(&self) -> impl Iterator<Item = &[BlendPart]> {
        fn parts(node: &NodeMaterial) -> Option<&[BlendPart]> {
            match &node.face {
                FaceMaterial::Whole(_) => None,
                FaceMaterial::Blend(parts) => Some(parts),
            }
        }
        self.nodes.iter().filter_map(parts)
    }

    /// The material of a face of a primitive, or of its complement, from the memberships in the other
    /// primitives; `nearest` chooses among the parts of a blend. `tree` is the tree of the same CSG.
    #[must_use]
    pub fn of_face(
        &self,
        tree: &CsgTree,
        (primitive, is_complement): (u32, bool),
        mut side: impl FnMut(u32) -> Membership,
        mut nearest: impl FnMut(&[BlendPart]) -> MaterialChoice,
    ) -> MaterialChoice {
        let mut stack: Vec<NodeAtFace> = Vec::new();
        for (node, material) in tree.nodes().iter().zip(&self.nodes) {
            let (p, is_node_complement) = match *node {
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    let first = stack.len() - n as usize;
                    let joined = NodeAtFace::joined(&stack[first..], matches!(node, CsgNode::Union(_)));
                    stack.truncate(first);
                    stack.push(joined);
                    continue;
                }
                CsgNode::Primitive(p) => (p, false),
                CsgNode::Complement(p) => (p, true),
            };
            let face_material = material.face.choice(&mut nearest);
            let volume = material.volume.map_or(face_material, MaterialChoice::One);
            let sides = match (p == primitive, is_node_complement == is_complement) {
                (true, true) => NodeAtFace::FACE,
                (true, false) => [Membership::Outside, Membership::Inside],
                (false, _) => [side(p).complement_if(is_node_complement); 2],
            };
            let face = if sides == NodeAtFace::FACE { face_material } else { MaterialChoice::Never };
            stack.push(NodeAtFace { sides, face, volume });
        }
        stack.pop().map_or(MaterialChoice::Never, |root| root.face)
    }

    /// The materials of each primitive and of its complement, one after the other, over all places of the
    /// tree.
    #[must_use]
    pub fn of_places(&self, tree: &CsgTree, n_primitives: usize) -> Vec<MaterialChoice> {
        let mut choices = vec![MaterialChoice::Never; 2 * n_primitives];
        for (node, material) in tree.nodes().iter().zip(&self.nodes) {
            let slot = match *node {
                CsgNode::Primitive(p) => 2 * p as usize,
                CsgNode::Complement(p) => 2 * p as usize + 1,
                CsgNode::Union(_) | CsgNode::Intersection(_) => continue,
            };
            choices[slot] = choices[slot].or(material.face.choice(&mut |_| MaterialChoice::Several));
        }
        choices
    }

    /// The material of a primitive, or of its complement, at its first place in the tree.
    #[must_use]
    pub fn first(
        &self,
        tree: &CsgTree,
        (primitive, is_complement): (u32, bool),
        mut nearest: impl FnMut(&[BlendPart]) -> MaterialChoice,
    ) -> MaterialChoice {
        let literal =
            if is_complement { CsgNode::Complement(primitive) } else { CsgNode::Primitive(primitive) };
        let first = tree.nodes().iter().position(|node| *node == literal);
        first.map_or(MaterialChoice::Never, |at| self.nodes[at].face.choice(&mut nearest))
    }
}

impl FaceMaterial {
    fn choice(&self, nearest: &mut impl FnMut(&[BlendPart]) -> MaterialChoice) -> MaterialChoice {
        match self {
            Self::Whole(number) => MaterialChoice::One(*number),
            Self::Blend(parts) => nearest(parts),
        }
    }
}

/// Collects the materials of a tree node by node.
#[derive(Default)]
pub(super) struct MaterialsBuilder {
    list: Vec<SurfaceMaterial>,
    nodes: Vec<NodeMaterial>,
    /// The number of parts of blends so far.
    n_parts: u32,
    /// By term: whether it or a term below has a mark, a node that carries a material. Empty until it is
    /// needed.
    has_marks: Vec<bool>,
}

impl MaterialsBuilder {
    /// The number of a material.
    pub fn number(&mut self, material: &SurfaceMaterial) -> u32 {
        let index = self.list.iter().position(|other| other == material);
        let at = index.unwrap_or_else(|| {
            self.list.push(material.clone());
            self.list.len() - 1
        });
        at as u32 + 1
    }

    /// Adds an operator.
    pub fn push_operator(&mut self) {
        self.nodes.push(NodeMaterial { face: FaceMaterial::Whole(0), volume: None });
    }

    /// Adds the primitive of a term, which already has a material if the number is not 0.
    pub fn push_literal(&mut self, terms: &[Term], literal: (u32, bool), material: OperandMaterial) {
        let OperandMaterial { number, cuts } = material;
        let node = match number {
            0 => self.material_of(terms, literal),
            _ => NodeMaterial { face: FaceMaterial::Whole(number), volume: cuts.then_some(0) },
        };
        self.nodes.push(node);
    }

    /// None without materials.
    pub fn finish(self) -> Option<CsgMaterials> {
        (!self.list.is_empty()).then_some(CsgMaterials { list: self.list, nodes: self.nodes })
    }

    /// The material of a primitive by the marks below its term. The parts of a blend are the operands of
    /// minima, maxima and smooth ones; of other operations only marked terms count.
    fn material_of(&mut self, terms: &[Term], (root, falls): (u32, bool)) -> NodeMaterial {
        if self.has_marks.is_empty() {
            self.has_marks = has_marks(terms);
        }
        let constant = |term: u32| match terms[term as usize] {
            Term::Const(value) => Some(value),
            _ => None,
        };
        // The material of a part, whether it is subtracted, its scale and its term.
        let mut part_marks: Vec<(u32, bool, f64, u32)> = Vec::new();
        let mut seen = HashSet::new(); // No order depends on it.
        let mut parts_seen = HashSet::new(); // No order depends on it.
        let mut open = vec![TermOfBlend { term: root, scale: 1.0, falls, is_part: false }];
        while let Some(next) = open.pop() {
            let TermOfBlend { term, scale, falls, is_part } = next;
            // A term may be reached as a part of the blend, and again as one that only shapes it.
            if constant(term).is_some() || !seen.insert((term, is_part)) {
                continue;
            }
            if let Some((material, below)) = mark_of(terms, term) {
                let number = self.number(material);
                // A part may occur again in terms that only shape the blend.
                if parts_seen.insert((number, below)) {
                    part_marks.push((number, falls, scale, below));
                }
                continue;
            }
            if !self.has_marks[term as usize] {
                if is_part && parts_seen.insert((0, term)) {
                    part_marks.push((0, falls, scale, term));
                }
                continue;
            }
            let times = |k: f64| TermOfBlend { scale: scale * k.abs(), falls: falls != (k < 0.0), ..next };
            match terms[term as usize] {
                Term::Unary(Unary::Neg, a) => open.push(TermOfBlend { term: a, ..times(-1.0) }),
                Term::Binary(Binary::Mul, a, b) if constant(a).or(constant(b)).is_some() => {
                    let k = constant(a).or(constant(b)).unwrap_or(1.0);
                    // The constant itself is skipped above.
                    open.extend([b, a].map(|term| TermOfBlend { term, ..times(k) }));
                }
                Term::Binary(Binary::Div, a, b) => {
                    let k = constant(b).map_or(1.0, |k| 1.0 / k);
                    open.push(TermOfBlend { term: a, ..times(k) });
                }
                Term::Binary(Binary::Sub, a, b) => {
                    open.push(TermOfBlend { term: b, is_part: false, ..times(-1.0) });
                    open.push(TermOfBlend { term: a, is_part: false, ..next });
                }
                Term::Binary(
                    Binary::SmoothMin | Binary::RoundMin | Binary::LogSumExp | Binary::Min | Binary::Max,
                    a,
                    b,
                ) => open.extend([b, a].map(|term| TermOfBlend { term, is_part: true, ..next })),
                ref other => {
                    let below: Vec<u32> = parts(other).collect();
                    let plain = |term| TermOfBlend { term, is_part: false, ..next };
                    open.extend(below.into_iter().rev().map(plain));
                }
            }
        }
        let mut inside: Vec<u32> = part_marks.iter().filter(|mark| !mark.1).map(|mark| mark.0).collect();
        inside.dedup();
        let volume = match inside[..] {
            [] => Some(0),
            [one] => Some(one),
            _ => None,
        };
        let first = part_marks.first().map_or(0, |mark| mark.0);
        if part_marks.iter().all(|mark| mark.0 == first) {
            return NodeMaterial { face: FaceMaterial::Whole(first), volume };
        }
        let first = self.n_parts;
        self.n_parts += part_marks.len() as u32;
        let part = |(index, (material, _, scale, term)): (u32, (u32, bool, f64, u32))| {
            let tape = Tape::from_graph(ExprGraph::from_terms(subgraph_terms(terms, term)));
            BlendPart { index, material, scale, tape }
        };
        NodeMaterial { face: FaceMaterial::Blend((first..).zip(part_marks).map(part).collect()), volume }
    }
}

/// A term in search of the marks below a primitive.
#[derive(Clone, Copy)]
struct TermOfBlend {
    term: u32,
    /// The factor that turns its value into the primitive's unit.
    scale: f64,
    /// Whether the primitive decreases as it increases.
    falls: bool,
    /// Whether it is an operand of a blend.
    is_part: bool,
}

fn has_marks(terms: &[Term]) -> Vec<bool> {
    let mut marked = vec![false; terms.len()];
    for term in 0..terms.len() {
        marked[term] =
            mark_of(terms, term as u32).is_some() || parts(&terms[term]).any(|part| marked[part as usize]);
    }
    marked
}
