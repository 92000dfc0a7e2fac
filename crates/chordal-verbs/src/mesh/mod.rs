//! `mesh`: any shape into triangles, or curves into polylines, within a budget; the result is as a reader of the format
//! gets it.
pub(crate) mod cage;
pub(crate) mod field;
mod filled_regions;
pub(crate) mod isosurface;
pub(crate) mod offset;
mod polylines;
pub(crate) mod request;
pub(crate) mod tessellate;
use crate::output::file_rows::order_new_triangles;
use crate::output::finish::finish_triangles;
use crate::output::notes::too_fine_note;
use crate::output::pass_through::pass_through;
use crate::report::{BudgetFacts, Certificate, VerbFacts};
use crate::scene::drop_attributes::drop_normals;
use crate::simplify::simplify_scene;
use crate::{BudgetSpec, Input, MeshFailure, MeshOutcome, Normals, OutputForm, Shape, formats};
use chordal::budget::RefusalCode;
use chordal::budget::advice::Message;
use chordal::math::{Box3, add_up, sub_down};
use chordal::{Job, convert};
use chordal_io::Scene;
use field::slack::NOT_COUNTED;
use isosurface::SurfaceForm;
use offset::{SolidOffset, offset_scene};
use request::MeshRequest;

/// Turns a shape into triangles within a budget, or curves into polylines if the format holds polylines.
///
/// The bound covers everything from the parsed numbers to the triangles as they read back from a file of the format `to`:
/// the rounding to that format, or to a lattice of 16 bits, is reserved from the budget first, and its actual size is added
/// to the bound. Triangle meshes are simplified, part by part; see `chordal::lod::simplify`. For a format of triangles, the
/// regions that a drawing's outlines enclose are filled in the plane z = 0, or raised to a solid.
///
/// # Errors
/// If the budget or the format has no meaning for this shape; if the budget is not met, with the best result that was
/// reached; if the work is refused, or cancelled; if a coordinate does not fit the format.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BudgetSpec, FormatHint, load, mesh};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// let spec = BudgetSpec { length: Some("1%".parse()?), ..BudgetSpec::default() };
/// let outcome = mesh(input, &spec, Format::Ply, &Default::default())?;
/// assert_eq!(outcome.bound.at_most(), Some(0.0)); // one triangle cannot become fewer
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mesh(
    mut input: Input,
    spec: &BudgetSpec,
    to: impl Into<OutputForm>,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let spec = &spec.with_usual_length();
    let form: OutputForm = to.into();
    let unit_note = spec.usual_unit(&mut input);
    let to = form.format;
    formats::check_output(&input.shape, to).map_err(MeshFailure::Usage)?;
    let lines = to.holds_polylines();
    spec.check_counts(lines).map_err(MeshFailure::Usage)?;
    if !spec.has_limit() && needs_budget(&input.shape, spec.normals) {
        return Err(MeshFailure::refused(
            RefusalCode::Budget,
            "the budget has no limit: no length, no pixels, no count",
        ));
    }
    spec.check_attributes(&input.shape)?;
    let solid = spec.solid(&input.shape, lines)?;
    let offset = spec.resolve_offset(&input.shape)?;
    let mut certificate = Certificate::from_input(&input);
    let (budget, note) = spec.resolve(&input.shape)?;
    certificate.budget = spec.has_limit().then(|| BudgetFacts::new(&budget));
    certificate.notes.extend(unit_note.into_iter().chain(note));
    let request = MeshRequest::new(budget, form, reach_of(&input.shape, offset)?)
        .with_spacing(spec.spacing)
        .with_effort(spec.effort);
    // The parts of a scene were put in order when they were simplified.
    let are_all_new = offset.is_some() || !matches!(input.shape, Shape::Scene(_));
    let (mut scene, bound) = match input.shape {
        Shape::Drawing(drawing) if lines => {
            return polylines::flatten_drawing(drawing, &request, certificate, job);
        }
        Shape::Curves(curves) => return polylines::flatten_curves(curves, &request, certificate, job),
        Shape::Field(implicit) if lines => {
            return polylines::contour_field(&implicit, &request, certificate, job);
        }
        Shape::Drawing(drawing) => {
            let (mut scene, bound, request) =
                filled_regions::fill((&drawing, solid), &request, &mut certificate, job)?;
            spec.normals.apply(&mut scene, [input.format, to], &mut certificate.notes)?;
            order_new_triangles(&mut scene)?;
            return finish_triangles(scene, bound, &request, certificate);
        }
        Shape::Patches { patches, frame } => {
            let converted = request.run(job, |budget| convert::patches_to_mesh(&patches, budget, job))?;
            // A descriptive name; a file name would make the bytes depend on a path.
            (Scene::from_mesh("patches", converted.shape, frame), converted.bound)
        }
        Shape::Surfaces { surfaces, frame } => {
            let converted =
                request.run(job, |budget| convert::trimmed_surfaces_to_mesh(&surfaces, budget, job))?;
            (Scene::from_mesh("surfaces", converted.shape, frame), converted.bound)
        }
        Shape::Cage(polygons) => {
            certificate.notes.extend(cage::notes_of_mesh(&polygons));
            cage::limit_surface(&polygons, &request, job)?
        }
        Shape::Volume(sampled) => {
            let request = (&request.widened(), SurfaceForm::Simplified);
            let surface = isosurface::mesh_volume(&sampled, request, &mut certificate.notes, job)?;
            if let Some(smoothed) = surface.smoothed {
                certificate.verb = VerbFacts::Smoothed { smoothed };
            }
            (surface.scene, surface.bound)
        }
        Shape::Field(implicit) => {
            let meshed = field::mesh_field(&implicit, &request.widened(), &mut certificate.notes, job)?;
            let is_warning =
                |note: &&Message| note.starts_with(NOT_COUNTED) || note.starts_with(field::DRAFT);
            certificate.warned.extend(certificate.notes.iter().filter(is_warning).cloned());
            meshed
        }
        Shape::Scene(mut scene) => {
            if has_new_normals(spec.normals) {
                drop_normals(&mut scene, &mut certificate.notes)?;
            }
            if !spec.has_limit() {
                let (mut scene, bound) = pass_through(scene, form, &mut certificate.notes)?;
                spec.normals.apply(&mut scene, [input.format, to], &mut certificate.notes)?;
                return finish_triangles(scene, bound, &request, certificate);
            }
            match offset {
                Some(offset) => {
                    certificate.verb = VerbFacts::Offset { offset: offset.0.facts(offset.1) };
                    offset_scene(&scene, offset, &request, &mut certificate.notes, job)?
                }
                None => simplify_scene(scene, &request, &mut certificate, job)?,
            }
        }
    };
    // At the positions that will be written, and before rows are counted: hard edges double some rows.
    spec.normals.apply(&mut scene, [input.format, to], &mut certificate.notes)?;
    if are_all_new {
        order_new_triangles(&mut scene)?;
    }
    certificate.notes.extend(too_fine_note(&scene, &budget, job)?);
    finish_triangles(scene, bound, &request, certificate)
}

/// The box of a shape, or of its offset: pixels and lattices are for all of the result.
fn reach_of(shape: &Shape, offset: Option<(SolidOffset, f64)>) -> Result<Box3, MeshFailure> {
    let bounds = shape.bounds()?;
    Ok(match offset {
        Some((SolidOffset::Outward(_), by)) => {
            Box3 { min: bounds.min.map(|x| sub_down(x, by)), max: bounds.max.map(|x| add_up(x, by)) }
        }
        _ => bounds,
    })
}

/// Whether a shape needs a budget to become triangles: volumes have a resolution of their own, and triangles that only get
/// new normals stay as they are.
pub fn needs_budget(shape: &Shape, normals: Normals) -> bool {
    match shape {
        Shape::Volume(_) => false,
        Shape::Scene(_) => !has_new_normals(normals),
        _ => true,
    }
}

fn has_new_normals(normals: Normals) -> bool {
    !matches!(normals, Normals::Auto | Normals::Keep)
}
