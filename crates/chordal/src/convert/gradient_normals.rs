//! Normals of a mesh from the gradient of a field.
use super::fields::FieldSampler;
use crate::budget::{Job, JobError, Refusal, RefusalCode};
use crate::explicit::{Mesh, NormalWeight, Semantic, Shading, Topology, with_normals, with_vertex_normals};
use crate::implicit::{Field, Tape};
use crate::math::{dot, length};

/// Two triangles that meet at a larger angle than this have a crease between them: 30°, the same as for plain
/// meshes.
const CREASE_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// At creases the gradient is sampled this fraction of the way into the triangles, where it is the gradient of their
/// side of the crease.
const INTO: f64 = 1.0 / 32.0;

/// Gives a mesh normals from the gradient of a field's [`Field::sign`], which points outward. Vertices at
/// creases of more than 30° are doubled, tied by [`Mesh::position_id`], with a normal for each side. If the
/// gradient has no direction (no value, or zero), or differs by more than 30° from the normal of the triangles around
/// the vertex, that normal is taken.
///
/// On a mesh by [`field_to_mesh`](super::field_to_mesh()) these are the normals of the true surface, since the
/// vertices lie on it. No bound covers normals. Cost: one gradient a vertex.
///
/// # Errors
/// [`JobError::Refused`] with [`RefusalCode::LeafFailed`] if a leaf fails; [`JobError::Cancelled`].
///
/// ```
/// use chordal::explicit::Semantic;
/// use chordal::implicit::shapes::sphere;
/// use chordal::{Budget, Job, Tolerance, convert};
/// let ball = sphere(1.0)?;
/// let bounded = convert::field_to_mesh(&ball, &Budget::length(Tolerance::new(0.05)?), &Job::default())?;
/// let mesh = convert::with_gradient_normals(&bounded.shape, &ball, &Job::default())?;
/// let normals = mesh.attribute(&Semantic::Normal).expect("one for each vertex");
/// let (p, n) = (mesh.positions()[0], normals.row(0));
/// assert!((0..3).all(|k| (p[k] - n[k]).abs() < 1e-6)); // half a crossing's bracket, measured
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn with_gradient_normals(mesh: &Mesh, field: &Field, job: &Job) -> Result<Mesh, JobError> {
    let tape = Tape::new(field.sign());
    let crease = Shading::Crease { angle_rad: CREASE_RAD, weight: NormalWeight::Angle };
    let too_many = |_| {
        let message = "the mesh would have more than 2^32 vertices";
        JobError::Refused(Refusal::new(RefusalCode::TooManyTriangles, message))
    };
    let mesh = with_normals(mesh, Topology::Indices, crease).map_err(too_many)?;
    let points = gradient_points(&mesh);
    let slopes = FieldSampler { tape: &tape, job }
        .duals(&points)
        .map_err(|error| JobError::Refused(Refusal::new(RefusalCode::LeafFailed, error.message)))?;
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let from_triangles = mesh.attribute(&Semantic::Normal).expect("it was given one");
    let mut normals: Vec<[f64; 3]> =
        (0..points.len()).map(|row| std::array::from_fn(|k| from_triangles.row(row)[k])).collect();
    for (normal, slope) in normals.iter_mut().zip(&slopes) {
        let slope_length = length(slope.gradient);
        let direction = slope.gradient.map(|d| d / slope_length);
        if dot(direction, *normal) > libm::cos(CREASE_RAD)
            || *normal == [0.0; 3] && slope_length > 0.0 && slope_length.is_finite()
        {
            *normal = direction;
        }
    }
    Ok(with_vertex_normals(&mesh, normals).expect("one finite normal for each vertex"))
}

/// The points at which the gradient is sampled: the vertices, but a little into the triangles for a position with
/// several rows.
fn gradient_points(mesh: &Mesh) -> Vec<[f64; 3]> {
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
