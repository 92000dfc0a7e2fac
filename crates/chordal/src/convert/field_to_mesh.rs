//! The arrow from a field to triangles.
use super::fields::{Ask, Wanted, search};
use crate::budget::{Bounded, Budget, Code, Failure, Job, PixelBudget, Refusal, Require, Stopped, Tolerance};
use crate::explicit::{Mesh, Semantic, Shading, Topology, Weight, with_normals, with_vertex_normals};
use crate::implicit::{Field, Tape};
use crate::math::{Box3, dot, flushes_subnormals, length};

/// The surface of a field, the boundary of where it is negative, as triangles within a budget: marching cubes on a lattice
/// that is fine enough for most of it, with vertices on sharp edges and corners, and triangles divided where they are still too far.
///
/// *What the bound covers.* The Hausdorff distance between all points of the triangles and all points of the field's
/// surface, proved by [`crate::check::field_deviation`] for the very numbers of the mesh, with [`Field::sign`] as the rule and
/// [`Field::bounds`] at its word. Sharp edges that are not found are bevelled, which the bound counts like everything else. Parts of the
/// surface that fall between the points of the lattice are found by the proof and make cells smaller until they
/// are met. Where a leaf of the field knows no ranges the budget's length is aimed at and the result measured; that needs
/// [`Require::Measured`].
///
/// [`with_gradient_normals`] adds the normals of the surface. The mesh is always closed, manifold and oriented;
/// at edges thinner than its cells triangles may touch or cross. A length, pixels at a view, and a number of triangles can be asked for, also
/// together.
///
/// *Cost.* Proportional to the triangles and to the terms of the expression that matter in each brick of cells; the error falls
/// with the square of the cells' size, but for edges so thin that cells do not show them. Where no proof comes cells become smaller.
///
/// # Errors
/// [`Failure::Unmet`] with the best mesh; refusals with [`Code::Empty`] where the field is nowhere negative, [`Code::Unsupported`] without
/// finite bounds, [`Code::Budget`], [`Code::TooManyTriangles`] and [`Code::TooMuchMemory`] before the work, [`Code::LeafFailed`];
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::implicit::{Expr, Field};
/// use chordal::math::Box3;
/// use chordal::{Budget, Job, Tolerance, check, convert, explicit::Topology};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new((x.square() + y.square() + z.square()).sqrt() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let made = convert::field_to_mesh(&ball, &Budget::length(Tolerance::new(0.01)?), &Job::default())?;
/// assert!(made.bound.at_most().unwrap() <= 0.01);
/// assert!(check::validity(&made.shape, Topology::Indices).closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: W. Lorensen, H. Cline, *Marching cubes*, 1987; pruning by ranges: T. Duff, *Interval arithmetic and recursive
/// subdivision for implicit functions and constructive solid geometry*, 1992; sharp edges: L. Kobbelt and others, *Feature sensitive
/// surface extraction from volume data*, 2001.
pub fn field_to_mesh(field: &Field, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let bounds = field.bounds();
    if flushes_subnormals() {
        let message =
            "the floating-point environment flushes subnormal numbers, so that nothing can be proved";
        return Err(Failure::refused(Code::FlushesSubnormals, message));
    }
    if bounds.is_empty() {
        return Err(Failure::refused(
            Code::Empty,
            "there is no surface to mesh: the box of the shape is empty",
        ));
    }
    if !bounds.diagonal().is_finite() {
        let message = "the shape has no finite bounds: cut it off with a box";
        return Err(Failure::refused(Code::Unsupported, message));
    }
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(Code::Unsupported, "an angle is no budget for fields in this version"));
    }
    let seen = match &budget.pixels {
        None => None,
        Some(px) => Some(length_on(&bounds, px)?),
    };
    let length = match (budget.length.map(Tolerance::get), seen) {
        (Some(a), Some(b)) => Some(if a < b { a } else { b }),
        (a, b) => a.or(b),
    };
    let length = match length.map(Tolerance::new) {
        None => None,
        Some(Ok(length)) => Some(length),
        Some(Err(_)) => return Err(Failure::refused(Code::Budget, "the budget in pixels leaves no length")),
    };
    let measured = budget.require == Require::Measured;
    let wanted = Wanted { length, triangles: budget.triangles, measured };
    let mut made = job.run(|| search(field, &wanted, job))?;
    if let (Some(px), Some(most)) = (budget.pixels, made.bound.at_most()) {
        made.bound.pixels = px.view.pixels_of(most, &made.shape.bounds().union(bounds));
    }
    Ok(made)
}

/// Triangles that turn more than this against each other have a crease between them: 30°, as where triangles are all there is.
const CREASE_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// At creases the gradient is asked for this share of the way into the triangles, where it is that of their side.
const INTO: f64 = 1.0 / 32.0;

/// A mesh with normals from the gradient of a field: that of [`Field::sign`], which points outward. Vertices at creases of more than 30° are
/// doubled, tied by [`Mesh::position_id`], and have a normal for each side. Where the gradient has no direction (no value, or
/// the field stands still) or is more than 30° off, the normal is that of the triangles around.
///
/// On a mesh by [`field_to_mesh`] that is the normal of the true surface, as the vertices lie on it. No bound speaks of normals.
/// Cost: one gradient a vertex.
///
/// # Errors
/// [`Stopped::Refused`] with [`Code::LeafFailed`] when a leaf does; [`Stopped::Cancelled`].
///
/// ```
/// use chordal::explicit::Semantic;
/// use chordal::implicit::shapes::sphere;
/// use chordal::{Budget, Job, Tolerance, convert};
/// let ball = sphere(1.0)?;
/// let made = convert::field_to_mesh(&ball, &Budget::length(Tolerance::new(0.05)?), &Job::default())?;
/// let mesh = convert::with_gradient_normals(&made.shape, &ball, &Job::default())?;
/// let normals = mesh.attribute(&Semantic::Normal).expect("one for each vertex");
/// let (p, n) = (mesh.positions()[0], normals.row(0));
/// assert!((0..3).all(|k| (p[k] - n[k]).abs() < 1e-6)); // half a crossing's bracket, measured
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn with_gradient_normals(mesh: &Mesh, field: &Field, job: &Job) -> Result<Mesh, Stopped> {
    let tape = Tape::of(field.sign());
    let crease = Shading::Crease { angle_rad: CREASE_RAD, weight: Weight::Angle };
    let too_many = |_| {
        Stopped::Refused(Refusal {
            code: Code::TooManyTriangles,
            message: "the mesh would have more than 2^32 vertices".into(),
        })
    };
    let mesh = with_normals(mesh, Topology::Indices, crease).map_err(too_many)?;
    let points = sides(&mesh);
    let slopes = Ask { tape: &tape, job }
        .slopes(&points)
        .map_err(|error| Stopped::Refused(Refusal { code: Code::LeafFailed, message: error.message }))?;
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    let old = mesh.attribute(&Semantic::Normal).expect("it was given one");
    let mut normals: Vec<[f64; 3]> =
        (0..points.len()).map(|row| std::array::from_fn(|k| old.row(row)[k])).collect();
    for (normal, slope) in normals.iter_mut().zip(&slopes) {
        let steep = length(slope.gradient);
        let direction = slope.gradient.map(|d| d / steep);
        if dot(direction, *normal) > libm::cos(CREASE_RAD)
            || *normal == [0.0; 3] && steep > 0.0 && steep.is_finite()
        {
            *normal = direction;
        }
    }
    Ok(with_vertex_normals(&mesh, normals).expect("one finite normal for each vertex"))
}

/// Where the gradient is asked for: at the vertex, and for one of several rows of a position a little into its triangles.
fn sides(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut points = mesh.positions().to_vec();
    let Some(ids) = mesh.position_id() else { return points };
    let mut rows = vec![0_u32; points.len()];
    ids.iter().for_each(|id| rows[*id as usize] += 1);
    let mut sums = vec![([0.0; 3], 0_u32); points.len()];
    for (number, face) in mesh.faces().iter().enumerate() {
        let [a, b, c] = mesh.corners(number);
        let middle: [f64; 3] = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        for row in face.iter().filter(|row| rows[ids[**row as usize] as usize] > 1) {
            let (sum, n) = &mut sums[*row as usize];
            (0..3).for_each(|k| sum[k] += middle[k]);
            *n += 1;
        }
    }
    for (point, (sum, n)) in points.iter_mut().zip(sums).filter(|(_, (_, n))| *n > 0) {
        *point = std::array::from_fn(|k| point[k] + INTO * (sum[k] / f64::from(n) - point[k]));
    }
    points
}

/// What a budget in pixels allows anywhere about the box: the mesh may stick out by as much.
pub(super) fn length_on<T>(bounds: &Box3, px: &PixelBudget) -> Result<f64, Failure<T>> {
    let too_close = || {
        Failure::refused(
            Code::TooClose,
            "the shape comes so close to the eye that there is no bound in pixels",
        )
    };
    let alone = px.view.length_of(px.pixels, bounds).ok_or_else(too_close)?;
    let about = Box3 { min: bounds.min.map(|x| x - alone), max: bounds.max.map(|x| x + alone) };
    px.view.length_of(px.pixels, &about).ok_or_else(too_close)
}
