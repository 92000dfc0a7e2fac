//! `UsdShapes`: the curves and NURBS surfaces of a stage, transformed by their prims.
//!
//! Source: Pixar Animation Studios, *UsdGeomBasisCurves*, *UsdGeomNurbsCurves* and *UsdGeomNurbsPatch*, openusd.org,
//! 2024. Points of a patch run along u first, as RenderMan and Maya have them.
use super::basis::{UsdBasis, UsdWrap, curve, misfit};
use super::cage::{determinant, moved};
use super::primvar::{row_numbers, row_place};
use super::shape_kind::UsdShapeKind;
use super::stage::{StagePrim, UsdStage};
use super::value::UsdNumbers;
use crate::ReadError;
use crate::assemble::too_many_rows;
use crate::drawing::{Curves, DrawingElement};
use crate::grow::push;
use crate::matrix::IDENTITY;
use crate::text::{grouped, not_finite};
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsCurve, NurbsSurface, TrimmedSurface};
use chordal::explicit::parametric::AffineMap;
use chordal::explicit::{Curve, FillRule};

/// The most points of copies by instancers. Chosen: a hundred times those of the fur in files that were seen.
const MOST_COPIED: u64 = 4_000_000;

/// A prim with curves or a surface, and its transform.
#[derive(Debug)]
pub(super) struct UsdShape {
    pub prim: StagePrim,
    pub kind: UsdShapeKind,
    pub world: [f64; 16],
    /// Whether an instancer placed it.
    pub is_copy: bool,
}

/// The shapes of a stage.
#[derive(Debug, Default)]
pub(super) struct UsdShapes {
    pub list: Vec<UsdShape>,
}

/// Counts the points of copies.
#[derive(Default)]
struct CopiedPoints(u64);

impl CopiedPoints {
    fn add(&mut self, stage: &UsdStage<'_, '_>, shape: &UsdShape, n: usize) -> Result<(), ReadError> {
        self.0 += if shape.is_copy { n as u64 } else { 0 };
        if self.0 <= MOST_COPIED {
            return Ok(());
        }
        let limit = grouped(MOST_COPIED);
        let message = format!("{}: points of instances are over the limit of {limit}", shape.prim.path);
        Err(ReadError::new("too-many-copies", stage.place(&shape.prim), message))
    }
}

impl UsdShapes {
    /// Whether there are surfaces, which take precedence over curves.
    pub(super) fn has_surfaces(&self) -> bool {
        self.list.iter().any(|shape| shape.kind == UsdShapeKind::NurbsPatch)
    }

    /// All surfaces.
    ///
    /// # Errors
    /// If one is damaged.
    pub(super) fn surfaces(&self, stage: &UsdStage<'_, '_>) -> Result<Vec<TrimmedSurface>, ReadError> {
        let (mut surfaces, mut copied) = (Vec::new(), CopiedPoints::default());
        for shape in self.list.iter().filter(|shape| shape.kind == UsdShapeKind::NurbsPatch) {
            if let Some(surface) = surface(stage, shape)? {
                copied.add(stage, shape, surface.control().len())?;
                push(&mut surfaces, TrimmedSurface::from(surface))?;
            }
        }
        Ok(surfaces)
    }

    /// All curves.
    ///
    /// # Errors
    /// If one is damaged.
    pub(super) fn curves(&self, stage: &UsdStage<'_, '_>) -> Result<Curves, ReadError> {
        let (mut curves, mut copied) = (Curves::default(), CopiedPoints::default());
        for shape in self.list.iter().filter(|shape| shape.kind != UsdShapeKind::NurbsPatch) {
            let Some(points) = points(stage, shape)? else { continue };
            copied.add(stage, shape, points.len())?;
            let counts = curve_counts(stage, shape, points.len())?;
            let source = curves.elements.len();
            let element = DrawingElement {
                kind: shape.kind.name(),
                name: stage.name(&shape.prim).into(),
                source: source as u64,
                rule: FillRule::default(),
                filled: false,
            };
            push(&mut curves.elements, element)?;
            let paths = match shape.kind {
                UsdShapeKind::BasisCurves => basis_curves(stage, shape, &points, &counts)?,
                _ => nurbs_curves(stage, shape, &points, &counts)?,
            };
            for (row, path) in paths.into_iter().enumerate() {
                let path =
                    placed(path, &shape.world).map_err(|why| wrong_curve(shape, row, &why.to_string()))?;
                push(&mut curves.owners, source as u32)?;
                push(&mut curves.lines, path)?;
            }
        }
        Ok(curves)
    }
}

/// The points of a prim; `None`, with a note, if it has no points.
fn points(stage: &UsdStage<'_, '_>, shape: &UsdShape) -> Result<Option<Vec<[f64; 3]>>, ReadError> {
    let prim = &shape.prim;
    let points = stage.numbers(prim, "points")?.filter(|points| points.width == 3 && points.n_rows() > 0);
    let Some(points) = points else {
        stage.note("empty-shapes", "curves and surfaces without points were left out", &prim.path);
        return Ok(None);
    };
    let limit = stage.limits.rows;
    if points.n_rows() as u64 > limit {
        return Err(too_many_rows(stage.place(prim), "points", points.n_rows() as u64, limit));
    }
    if let Some(at) = points.values.iter().position(|x| !x.is_finite()) {
        let error = not_finite(points.values[at].to_string().as_bytes(), row_place("points", at / 3));
        let message = error.message.words(format_args!(" ({}.points)", prim.path));
        return Err(ReadError { message, ..error });
    }
    let mut rows = crate::grow::with_room(points.n_rows())?;
    rows.extend(points.values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
    Ok(Some(rows))
}

/// The number of points of each curve.
fn curve_counts(
    stage: &UsdStage<'_, '_>,
    shape: &UsdShape,
    n_points: usize,
) -> Result<Vec<usize>, ReadError> {
    let path = &shape.prim.path;
    let counts = stage.numbers(&shape.prim, "curveVertexCounts")?.map(|counts| counts.into_owned().values);
    let counts = counts.unwrap_or_default();
    let counts = row_numbers(&counts, u32::MAX as usize, |row| {
        let message = format!("{path}: a curve has {} points", counts[row]);
        ReadError::new("bad-count", row_place("curveVertexCounts", row), message)
    })?;
    let n: u64 = counts.iter().map(|n| u64::from(*n)).sum();
    if n != n_points as u64 {
        let (n, n_points) = (grouped(n), grouped(n_points as u64));
        let message = format!("{path}: curves have {n} points in all, and {n_points} are there");
        return Err(ReadError::new("count-mismatch", stage.place(&shape.prim), message));
    }
    Ok(counts.into_iter().map(|n| n as usize).collect())
}

/// The points of each curve.
fn split<'p, T>(mut items: &'p [T], counts: &[usize]) -> Vec<&'p [T]> {
    let mut parts = Vec::with_capacity(counts.len());
    for n in counts {
        let (part, rest) = items.split_at((*n).min(items.len()));
        parts.push(part);
        items = rest;
    }
    parts
}

fn wrong_curve(shape: &UsdShape, row: usize, why: &str) -> ReadError {
    let message = format!("{}: curve {row}: {why}", shape.prim.path);
    ReadError::new("invalid-curve", row_place("curveVertexCounts", row), message)
}

fn basis_curves(
    stage: &UsdStage<'_, '_>,
    shape: &UsdShape,
    points: &[[f64; 3]],
    counts: &[usize],
) -> Result<Vec<Curve<3>>, ReadError> {
    let prim = &shape.prim;
    let word = |name: &str, usual: &str| {
        Ok::<_, ReadError>(stage.word(prim, name)?.unwrap_or_else(|| usual.to_owned()))
    };
    let (kind, basis, wrap) =
        (word("type", "cubic")?, word("basis", "bezier")?, word("wrap", "nonperiodic")?);
    let (Some(basis), Some(wrap)) = (UsdBasis::from_words(&kind, &basis), UsdWrap::from_word(&wrap)) else {
        let message = format!(
            "{}: curves of the type {kind:?}, the basis {basis:?} and the wrap {wrap:?} are not read",
            prim.path
        );
        return Err(ReadError::new("unknown-basis", stage.place(prim), message));
    };
    let mut paths = Vec::new();
    for (row, points) in split(points, counts).into_iter().enumerate() {
        if let Some(needed) = misfit(points.len(), basis, wrap) {
            let n = grouped(points.len() as u64);
            let why = format!("it has {n} points, and its basis and wrap take {needed}");
            return Err(wrong_curve(shape, row, &why));
        }
        let path = curve(points, basis, wrap).map_err(|why| wrong_curve(shape, row, &why.to_string()))?;
        push(&mut paths, path)?;
    }
    Ok(paths)
}

fn nurbs_curves(
    stage: &UsdStage<'_, '_>,
    shape: &UsdShape,
    points: &[[f64; 3]],
    counts: &[usize],
) -> Result<Vec<Curve<3>>, ReadError> {
    let prim = &shape.prim;
    let list = |name| Ok::<_, ReadError>(stage.numbers(prim, name)?.map(|list| list.into_owned().values));
    let orders = list("order")?.unwrap_or_default();
    let knots = list("knots")?.unwrap_or_default();
    let weights = weights(stage, shape, points.len())?;
    if orders.len() != counts.len() {
        let message = format!("{}: {} orders for {} curves", prim.path, orders.len(), counts.len());
        return Err(ReadError::new("count-mismatch", stage.place(prim), message));
    }
    let ranges = stage.numbers(prim, "ranges")?;
    // One list has the knots of all curves; each takes its part from the front.
    let mut knots = &knots[..];
    let mut paths = Vec::new();
    let both = split(points, counts).into_iter().zip(split(&weights, counts));
    for (row, (points, weights)) in both.enumerate() {
        let invalid = |error: InvalidNurbs| wrong_curve(shape, row, &error.to_string());
        let degree = degree(orders[row]).map_err(|why| wrong_curve(shape, row, &why))?;
        let n_knots = points.len().saturating_add(degree + 1);
        let Some((curve_knots, rest)) = knots.split_at_checked(n_knots) else {
            let why =
                format!("its {} points take {n_knots} knots, and {} are left", points.len(), knots.len());
            return Err(wrong_curve(shape, row, &why));
        };
        knots = rest;
        let vector = KnotVector::new(degree, curve_knots.to_vec()).map_err(invalid)?;
        note_range(stage, shape, &vector, ranges.as_ref().and_then(|ranges| ranges.row(row)));
        let spline = NurbsCurve::new(vector, points.to_vec(), weights.to_vec()).map_err(invalid)?;
        push(&mut paths, spline.to_curve().map_err(|why| wrong_curve(shape, row, &why.to_string()))?)?;
    }
    Ok(paths)
}

/// The degree for an order; the order is one more.
fn degree(order: f64) -> Result<usize, String> {
    let is_order = order >= 2.0 && order.fract() == 0.0;
    // An order that is too large saturates, and is refused as a degree.
    if is_order {
        Ok(order as usize - 1)
    } else {
        Err(format!("its order {order} is no whole number from 2 on"))
    }
}

/// The weights of the points, 1 if the file has none.
fn weights(stage: &UsdStage<'_, '_>, shape: &UsdShape, n: usize) -> Result<Vec<f64>, ReadError> {
    let prim = &shape.prim;
    let Some(weights) = stage.numbers(prim, "pointWeights")?.filter(|weights| !weights.values.is_empty())
    else {
        return Ok(vec![1.0; n]);
    };
    if weights.values.len() != n {
        let message = format!("{}: {} weights for {n} points", prim.path, weights.values.len());
        return Err(ReadError::new("count-mismatch", stage.place(prim), message));
    }
    Ok(weights.into_owned().values)
}

/// Reports a range that covers only part of a curve or surface.
fn note_range(stage: &UsdStage<'_, '_>, shape: &UsdShape, knots: &KnotVector, range: Option<[f64; 2]>) {
    if range.is_some_and(|range| range != knots.domain()) {
        let what = "curves and surfaces with a range that ends inside their knots were read whole";
        stage.note("ranges-skipped", what, &shape.prim.path);
    }
}

/// A curve transformed by a matrix.
fn placed(path: Curve<3>, world: &[f64; 16]) -> Result<Curve<3>, chordal::explicit::InvalidCurve> {
    if *world == IDENTITY {
        return Ok(path);
    }
    let column = |c: usize| [world[4 * c], world[4 * c + 1], world[4 * c + 2]];
    path.transformed(&AffineMap { columns: [column(0), column(1), column(2)], offset: column(3) })
}

/// A surface transformed by its prim; `None`, with a note, if it has no points.
fn surface(stage: &UsdStage<'_, '_>, shape: &UsdShape) -> Result<Option<NurbsSurface>, ReadError> {
    let prim = &shape.prim;
    let Some(mut points) = points(stage, shape)? else { return Ok(None) };
    let wrong =
        |why: String| ReadError::new("invalid-surface", stage.place(prim), format!("{}: {why}", prim.path));
    let one = |name: &str| {
        let number = stage.numbers(prim, name)?.and_then(|number| number.first::<1>()).map(|[x]| x);
        number.ok_or_else(|| wrong(format!("there is no {name}")))
    };
    let mut vectors = Vec::new();
    for (letter, order, count, knots, range) in [
        ("u", "uOrder", "uVertexCount", "uKnots", "uRange"),
        ("v", "vOrder", "vVertexCount", "vKnots", "vRange"),
    ] {
        let along = |why: String| wrong(format!("along {letter}: {why}"));
        let degree = degree(one(order)?).map_err(along)?;
        let values = stage.numbers(prim, knots)?.map(|list| list.into_owned().values).unwrap_or_default();
        let vector = KnotVector::new(degree, values).map_err(|error| along(error.to_string()))?;
        let n = one(count)?;
        if vector.n_control() as f64 != n {
            return Err(along(format!("{n} points, where the knots take {}", vector.n_control())));
        }
        let range = stage.numbers(prim, range)?;
        note_range(stage, shape, &vector, range.as_deref().and_then(UsdNumbers::first));
        vectors.push(vector);
    }
    let Ok([mut u, v]) = <[KnotVector; 2]>::try_from(vectors) else { return Ok(None) };
    if stage.numbers(prim, "trimCurve:counts")?.is_some_and(|counts| !counts.values.is_empty()) {
        stage.note("trims-skipped", "NURBS surfaces are trimmed by curves, and were read whole", &prim.path);
    }
    let mut weights = weights(stage, shape, points.len())?;
    if shape.world != IDENTITY {
        let what = "surfaces have no transforms: control points were moved to where nodes place them";
        stage.note("transforms-applied", what, &prim.path);
        points.iter_mut().for_each(|point| *point = moved(&shape.world, *point));
    }
    // A mirror turns a surface inside out; so does reversing a parameter.
    let is_left_handed = stage.word(prim, "orientation")?.is_some_and(|word| word == "leftHanded");
    let n_u = u.n_control();
    // The mirrored parameter: points along u in reverse, and knots negated so that they ascend
    // again. A wrong number of points is refused below.
    if is_left_handed != (determinant(&shape.world) < 0.0) && points.len() == n_u * v.n_control() {
        points.chunks_mut(n_u).for_each(<[_]>::reverse);
        weights.chunks_mut(n_u).for_each(<[_]>::reverse);
        let turned = u.knots().iter().rev().map(|knot| -knot).collect();
        u = KnotVector::new(u.degree(), turned).map_err(|error| wrong(error.to_string()))?;
    }
    NurbsSurface::new([u, v], points, weights).map(Some).map_err(|error| wrong(error.to_string()))
}
