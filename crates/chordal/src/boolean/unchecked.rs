//! `boolean_unchecked`: the cuts of [`boolean()`](super::boolean()) without its checks.
use super::arrangement::{EngineFailure, check_status, combine_in_order};
use super::{BooleanOp, BooleanStep, check_limits};
use crate::budget::{Failure, Job, RefusalCode, Tolerance};
use crate::explicit::Mesh;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, MeshGLP};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// [`boolean()`](super::boolean()) in floating point, without its checks: for surfaces that are cut many
/// times and checked as a whole afterwards. With a `tolerance`, vertices in flat faces and on their straight
/// edges are removed as long as the surface stays within it.
///
/// The distance of the result from the combined solid has no bound; the result may cross itself by
/// roundings, and more if an operand does. Its edges have two triangles each. Vertices are distinguished by
/// their rows: solids that touch along an edge stay two. Cost: n log n in the triangles of all operands, some
/// microseconds each.
///
/// ```
/// use chordal::boolean::{BooleanOp, BooleanStep, boolean_unchecked};
/// use chordal::convert::solids::SolidMesher;
/// use chordal::implicit::construction::SolidForm;
/// use chordal::math::Box3;
/// use chordal::{Job, Tolerance};
/// let room = Box3 { min: [-2.0; 3], max: [2.0; 3] };
/// let mesher = SolidMesher { length: Tolerance::new(0.01)?, room };
/// let [wide, high] = [[2.0, 2.0, 1.0], [1.0, 1.0, 2.0]]
///     .map(|sides| mesher.mesh(&SolidForm::Cuboid { half: sides }).map(|bounded| bounded.shape).unwrap_or_default());
/// let step = BooleanStep { op: BooleanOp::Union, mesh: &high };
/// let combined = boolean_unchecked(&wide, &[step], None, &Job::default())?;
/// assert!(chordal::check::validity(&combined, chordal::explicit::Topology::Indices).closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Failure::Refused`] for an operand whose edges do not have two triangles each, and for more memory or
/// triangles than the job allows; [`Failure::Cancelled`] if the job is cancelled or its time ends.
pub fn boolean_unchecked(
    first: &Mesh,
    steps: &[BooleanStep],
    tolerance: Option<Tolerance>,
    job: &Job,
) -> Result<Mesh, Failure<Mesh>> {
    let meshes: Vec<&Mesh> = std::iter::once(first).chain(steps.iter().map(|step| step.mesh)).collect();
    check_limits(&meshes, job)?;
    let ops: Vec<BooleanOp> = steps.iter().map(|step| step.op).collect();
    let work = || {
        let others = steps.iter().map(|step| imported(step.mesh)).zip(&ops);
        let solid = combine_in_order(imported(first)?, others, BooleanEngine::Exact, (job, &is_ended))?;
        let Some(tolerance) = tolerance else { return Ok(exported(&solid)) };
        let simplified = solid.as_original().simplify(tolerance.get());
        check_status(&simplified)?;
        Ok(exported(&simplified))
    };
    // In rare cases the engine panics on malformed input, which must not end the program.
    let cut = job.run(|| catch_unwind(AssertUnwindSafe(work)));
    let cut = cut.unwrap_or_else(|_| Err(EngineFailure::Failed("the cutting stopped half way".to_owned())));
    let (positions, faces) = cut.map_err(|failure| match failure {
        EngineFailure::Cancelled => Failure::Cancelled,
        EngineFailure::Failed(why) => Failure::refused(
            RefusalCode::Unsupported,
            format!("the meshes could not be cut along each other: {why}"),
        ),
    })?;
    if faces.len() as u64 > job.triangle_limit {
        let message =
            format!("the result has {} triangles; the limit is {}", faces.len(), job.triangle_limit);
        return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
    }
    Mesh::new(positions, faces).map_err(|invalid| {
        Failure::refused(RefusalCode::NotFinite, format!("the result is no mesh: {invalid}"))
    })
}

fn is_ended(job: &Job) -> bool {
    job.is_cancelled() || job.is_finishing()
}

/// A mesh in the engine's form, with the faces of each plane as one.
fn imported(mesh: &Mesh) -> Result<Manifold, EngineFailure> {
    if mesh.faces().is_empty() {
        return Ok(Manifold::empty());
    }
    // Adding zero turns −0.0 into 0.0.
    let solid = Manifold::from_mesh_glp(&MeshGLP::<f64, u32> {
        num_prop: 3,
        vert_properties: mesh.positions().as_flattened().iter().map(|x| x + 0.0).collect(),
        tri_verts: mesh.faces().as_flattened().to_vec(),
        ..MeshGLP::default()
    });
    check_status(&solid)?;
    Ok(solid)
}

fn exported(solid: &Manifold) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let arrays: MeshGLP<f64, u32> = solid.get_mesh_glp(-1);
    let stride = if arrays.num_prop == 0 { 3 } else { arrays.num_prop as usize };
    let positions = arrays.vert_properties.chunks_exact(stride).map(|row| [row[0], row[1], row[2]]).collect();
    (positions, arrays.tri_verts.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect())
}
