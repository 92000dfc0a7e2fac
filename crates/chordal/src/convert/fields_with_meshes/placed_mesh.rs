//! `PlacedMesh`: a field that is one solid mesh under an affine map.
//!
//! Its surface is the mapped triangles; only their corners are rounded.
use crate::budget::{Bound, Bounded, Failure, Reference, RefusalCode};
use crate::convert::mesh_leaf::{MeshLeaf, MeshSource};
use crate::explicit::{Mesh, position_id_by_bits};
use crate::implicit::evaluation::{Binary, Unary};
use crate::implicit::{ExprGraph, Field, Leaf, Term};
use crate::math::{Interval, add_up, greater, mul_up, sqrt_up};
use std::sync::Arc;

/// A linear form in x, y and z with a constant, enclosed.
pub(super) type LinearForm = [Interval; 4];

/// A solid mesh, and the map from space to its coordinates.
pub(super) struct PlacedMesh {
    leaf: Arc<dyn Leaf>,
    /// `None` if it is the identity.
    map: Option<[LinearForm; 3]>,
}

impl PlacedMesh {
    /// The mesh, if the sign of a field is that of one solid mesh.
    pub(super) fn from_field(field: &Field) -> Option<Self> {
        let graph = ExprGraph::from_expr(field.sign());
        let terms = graph.terms();
        // Positive factors do not change the sign.
        let mut root = terms.len() - 1;
        let constant = |k: u32| if let Term::Const(value) = terms[k as usize] { Some(value) } else { None };
        let (leaf, at) = loop {
            root = match &terms[root] {
                Term::Leaf(leaf, at) => break (Arc::clone(leaf), *at),
                Term::Binary(Binary::Mul | Binary::Div, a, b) if constant(*b).is_some_and(|c| c > 0.0) => *a,
                Term::Binary(Binary::Mul, a, b) if constant(*a).is_some_and(|c| c > 0.0) => *b,
                _ => return None,
            } as usize;
        };
        source_of(&leaf).filter(|source| source.is_solid)?;
        let forms = linear_forms(terms);
        Self::new(&leaf, at.map(|term| forms[term as usize]))
    }

    /// A mesh under the map of three linear forms, if the leaf has kept its mesh.
    pub(super) fn new(leaf: &Arc<dyn Leaf>, at: [Option<LinearForm>; 3]) -> Option<Self> {
        source_of(leaf)?;
        let map = [at[0]?, at[1]?, at[2]?];
        let is_axis = |k: usize| (0..4).all(|j| map[k][j] == Interval::point(f64::from(u8::from(j == k))));
        Some(Self { leaf: Arc::clone(leaf), map: (!(0..3).all(is_axis)).then_some(map) })
    }

    /// Its triangles in space.
    pub(super) fn triangles(&self, field: &Field) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let Some(source) = source_of(&self.leaf) else {
            return Err(Failure::refused(
                RefusalCode::Empty,
                "there is no surface: the triangles of the mesh are not known",
            ));
        };
        let bare = welded(&source.mesh)?;
        let Some(map) = &self.map else { return Ok(self.bounded(field, bare, 0.0, 1.0)) };
        let back = invert(map).ok_or_else(|| {
            Failure::refused(RefusalCode::Unsupported, "a mesh is transformed by a map without an inverse")
        })?;
        let (mut mapped, mut rounding) = (Vec::with_capacity(bare.positions().len()), 0.0);
        for p in bare.positions() {
            let from: [Interval; 3] = std::array::from_fn(|k| Interval::point(p[k]) - map[k][3]);
            let to: [Interval; 3] =
                std::array::from_fn(|k| (back[k][0] * from[0] + back[k][1] * from[1]) + back[k][2] * from[2]);
            let middle = to.map(|x| x.midpoint().unwrap_or(f64::NAN));
            // The full width instead of half of it, to be safe.
            let square = to.iter().fold(0.0, |sum, x| add_up(sum, mul_up(x.width(), x.width())));
            rounding = greater(sqrt_up(square), rounding);
            mapped.push(middle);
        }
        let [a, b, c] = back;
        let volume = (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]))
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        // A map that mirrors would turn all fronts inward.
        let faces = bare
            .faces()
            .iter()
            .map(|face| if volume.hi() < 0.0 { [face[0], face[2], face[1]] } else { *face });
        let mesh = Mesh::new(mapped, faces.collect());
        let mesh = mesh.map_err(|error| Failure::refused(RefusalCode::NotFinite, error.to_string()))?;
        if !rounding.is_finite() {
            return Err(Failure::refused(
                RefusalCode::NotFinite,
                "a mesh is transformed beyond the range of numbers",
            ));
        }
        Ok(self.bounded(field, mesh, rounding, norm(&back)))
    }

    /// The triangles with the bound of their rounding, under a map that stretches vectors by `norm` at most.
    fn bounded(&self, field: &Field, shape: Mesh, error: f64, norm: f64) -> Bounded<Mesh> {
        let lost = source_of(&self.leaf).and_then(|source| source.lost.clone());
        let rounding = match field.evidence() {
            // The loss of the source is added below as a length, so it is not a condition here.
            _ if lost.is_some() => Bound::proved(0.0, error, Reference::Field),
            evidence => Bound::with_evidence(0.0, Some(error), evidence, Reference::Field),
        };
        let scaled = lost.and_then(|lost| {
            let most = lost.at_most().map(|most| mul_up(most, norm)).filter(|most| most.is_finite())?;
            Some(Bound::with_evidence(0.0, Some(most), lost.evidence().clone(), Reference::Field))
        });
        let bound = match scaled {
            Some(lost) => lost.then(&rounding),
            None => rounding,
        };
        Bounded { shape, bound }
    }
}

/// The triangles, with one row for each position, so that a triangle soup becomes closed by its indices. Triangles with
/// two corners at one position are left out.
fn welded(mesh: &Mesh) -> Result<Mesh, Failure<Mesh>> {
    let ids = position_id_by_bits(mesh.positions());
    let corners = mesh.faces().iter().map(|face| face.map(|row| ids[row as usize]));
    let faces: Vec<[u32; 3]> = corners.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let mut is_used = vec![false; ids.len()];
    faces.as_flattened().iter().for_each(|id| is_used[*id as usize] = true);
    // In the order of the file, so that a mesh without duplicates stays the same.
    let mut row_of = vec![0; ids.len()];
    let mut positions = Vec::new();
    for (id, position) in mesh.positions().iter().enumerate().filter(|(id, _)| is_used[*id]) {
        row_of[id] = positions.len() as u32;
        positions.push(*position);
    }
    let faces = faces.into_iter().map(|face| face.map(|id| row_of[id as usize])).collect();
    Mesh::new(positions, faces).map_err(|error| Failure::refused(RefusalCode::NotFinite, error.to_string()))
}

fn source_of(leaf: &Arc<dyn Leaf>) -> Option<&MeshSource> {
    leaf.as_any()?.downcast_ref::<MeshLeaf>()?.source()
}

/// Each term as a linear form, if it is one.
pub(super) fn linear_forms(terms: &[Term]) -> Vec<Option<LinearForm>> {
    let zero = Interval::point(0.0);
    let mut forms: Vec<Option<LinearForm>> = Vec::with_capacity(terms.len());
    for term in terms {
        let of = |k: u32| forms[k as usize];
        let both = |a: u32, b: u32, join: fn(Interval, Interval) -> Interval| {
            let (a, b) = (of(a)?, of(b)?);
            Some(std::array::from_fn(|k| join(a[k], b[k])))
        };
        let constant = |k: u32| if let Term::Const(value) = terms[k as usize] { Some(value) } else { None };
        forms.push(match term {
            Term::Const(value) if value.is_finite() => Some([zero, zero, zero, Interval::point(*value)]),
            Term::Axis(axis) => {
                Some(std::array::from_fn(|k| Interval::point(f64::from(k == usize::from(*axis)))))
            }
            Term::Unary(Unary::Neg, a) => of(*a).map(|form| form.map(|x| -x)),
            Term::Binary(Binary::Add, a, b) => both(*a, *b, |a, b| a + b),
            Term::Binary(Binary::Sub, a, b) => both(*a, *b, |a, b| a - b),
            Term::Binary(Binary::Mul, a, b) => match (constant(*a), constant(*b)) {
                (Some(factor), _) => of(*b).map(|form| form.map(|x| x * Interval::point(factor))),
                (_, Some(factor)) => of(*a).map(|form| form.map(|x| x * Interval::point(factor))),
                _ => None,
            },
            Term::Binary(Binary::Div, a, b) => {
                let divisor = constant(*b).filter(|divisor| *divisor != 0.0);
                divisor.and_then(|by| of(*a).map(|form| form.map(|x| x / Interval::point(by))))
            }
            _ => None,
        });
    }
    forms
}

/// The inverse of the linear part, enclosed; `None` if its determinant may be 0.
fn invert(map: &[LinearForm; 3]) -> Option<[[Interval; 3]; 3]> {
    let minor = |i: usize, j: usize| {
        let ([a, b], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        map[a][c] * map[b][d] - map[a][d] * map[b][c]
    };
    let volume = map[0][0] * minor(0, 0) + map[0][1] * minor(0, 1) + map[0][2] * minor(0, 2);
    if !volume.is_defined() || volume.lo() <= 0.0 && volume.hi() >= 0.0 {
        return None;
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / volume)))
}

/// An upper bound of the factor by which a linear map stretches vectors: `‖A‖₂ ≤ √(‖A‖₁ · ‖A‖∞)`.
fn norm(rows: &[[Interval; 3]; 3]) -> f64 {
    let size = |i: usize, j: usize| rows[i][j].magnitude();
    let sum = |term: &dyn Fn(usize) -> f64| (0..3).fold(0.0, |sum, k| add_up(sum, term(k)));
    let by_rows = (0..3).map(|i| sum(&|j| size(i, j))).fold(0.0, |most, x| greater(x, most));
    let by_columns = (0..3).map(|j| sum(&|i| size(i, j))).fold(0.0, |most, x| greater(x, most));
    sqrt_up(mul_up(by_rows, by_columns))
}
