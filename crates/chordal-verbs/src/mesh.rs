//! `mesh`: any shape into triangles, or curves into polylines, within a budget, as they will read back from a format.
use crate::failure::best_of;
use crate::file_rows::to_file_rows;
use crate::flatten::{self, TransformedScene};
use crate::polylines::{self, MeshRequest};
use crate::report::{BoundFacts, BudgetFacts, Certificate, CountedTriangles, Output};
use crate::simplify::{simplify_scene, without_normals};
use crate::{
    BudgetSpec, Input, MeshFailure, Normals, Shape, cage, filled_regions, formats, implicit, isosurface,
    write, write_polylines,
};
use chordal::budget::{
    Bound, Budget, JobError, PixelBudget, Pixels, Reference, Refusal, RefusalCode, RequiredEvidence,
    Tolerance, View,
};
use chordal::check::{self, MicroTriangles};
use chordal::explicit::Topology;
use chordal::math::{Box3, add_up, sub_down, sub_up};
use chordal::{Bounded, Job, Mesh, Patch, convert, mend};
use chordal_io::{Format, Frame, Polylines, Scene, WriteError, losses, snap, worst_snap};
use std::io::Write;

/// What came of a shape, at the precision of its format: what a reader of the file will get.
#[derive(Clone, Debug, PartialEq)]
pub enum Tessellation {
    /// Triangles.
    Triangles(Scene),
    /// Polylines, for formats that hold those.
    Polylines(Polylines),
}

/// Triangles or polylines at the precision of their format, with everything that is known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOutcome {
    /// What will be written.
    pub made: Tessellation,
    /// The format that it is for.
    pub format: Format,
    /// How far it is from the true shape, rounding to the format included.
    pub bound: Bound,
    /// The same and more, for the file and the report.
    pub certificate: Certificate,
}

impl MeshOutcome {
    /// The triangles, where there are some.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        match &self.made {
            Tessellation::Triangles(scene) => Some(scene),
            Tessellation::Polylines(_) => None,
        }
    }

    /// The polylines, where there are some.
    #[must_use]
    pub fn polylines(&self) -> Option<&Polylines> {
        match &self.made {
            Tessellation::Triangles(_) => None,
            Tessellation::Polylines(polylines) => Some(polylines),
        }
    }

    /// Writes what was made, and the certificate where the format can carry it.
    ///
    /// # Errors
    /// When the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificate = self.certificate.to_value();
        match &self.made {
            Tessellation::Triangles(scene) => write(scene, Some(&certificate), self.format, out),
            Tessellation::Polylines(polylines) => {
                write_polylines(polylines, Some(&certificate), self.format, out)
            }
        }
    }
}

/// Turns a shape into triangles within a budget, or curves into polylines where the format holds those.
///
/// The bound covers the whole way from the parsed numbers to the triangles as they read back from a file of the
/// format `to`: what rounding to that format will cost is set aside from the budget first, and what it did cost is
/// added to the bound. Triangles become fewer, part by part; see `chordal::lod::simplify`. A drawing for a
/// format of triangles is filled: what its outlines enclose, in the plane z = 0.
///
/// # Errors
/// When the budget or the format has no meaning for this shape; when the budget is not met, with the best that was reached; when
/// the work is refused, or cancelled; when a coordinate does not fit the format.
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
pub fn mesh(input: Input, spec: &BudgetSpec, to: Format, job: &Job) -> Result<MeshOutcome, MeshFailure> {
    formats::check_output(&input.shape, to).map_err(MeshFailure::Usage)?;
    let lines = formats::holds_polylines(to);
    spec.check_counts(lines).map_err(MeshFailure::Usage)?;
    if !spec.has_limit() && !matches!(input.shape, Shape::Volume(_)) {
        return Err(refusal(RefusalCode::Budget, "the budget has no limit: no length, no pixels, no count"));
    }
    let mut certificate = Certificate::from_input(&input);
    let (budget, note) = spec.resolve(&input.shape)?;
    certificate.budget = spec.has_limit().then(|| BudgetFacts::new(&budget));
    certificate.notes.extend(note);
    let place = input.shape.hull()?;
    let (mut scene, bound) = match input.shape {
        Shape::Drawing(drawing) if lines => {
            return polylines::flatten_drawing(
                drawing,
                &MeshRequest { spec, budget, to, place },
                certificate,
                job,
            );
        }
        Shape::Curves(curves) => {
            return polylines::flatten_curves(
                curves,
                &MeshRequest { spec, budget, to, place },
                certificate,
                job,
            );
        }
        Shape::Field(implicit) if lines => {
            return polylines::contour_field(
                &implicit,
                &MeshRequest { spec, budget, to, place },
                certificate,
                job,
            );
        }
        Shape::Drawing(drawing) => {
            let asked = MeshRequest { spec, budget, to, place };
            let (mut scene, bound, place) = filled_regions::fill(&drawing, &asked, &mut certificate, job)?;
            spec.normals.apply(&mut scene, [input.format, to], &mut certificate.notes)?;
            return finish(scene, bound, &MeshRequest { place, ..asked }, certificate);
        }
        Shape::Patches { patches, frame } => {
            let source = PatchSource { patches, frame, place };
            tessellate(&source, &budget, to, job)?
        }
        Shape::Cage(polygons) => {
            certificate.notes.extend(cage::notes_of_mesh(&polygons));
            cage::limit_surface(&polygons, &MeshRequest { spec, budget, to, place }, job)?
        }
        Shape::Volume(sampled) => {
            let asked = MeshRequest { spec, budget, to, place: widen_box(&place) };
            isosurface::mesh_volume(&sampled, &asked, &mut certificate.notes, job)?
        }
        Shape::Field(implicit) => {
            let asked = MeshRequest { spec, budget, to, place: widen_box(&place) };
            implicit::mesh_field(&implicit, &asked, &mut certificate.notes, job)?
        }
        Shape::Scene(mut scene) => {
            if !matches!(spec.normals, Normals::Auto | Normals::Keep) {
                without_normals(&mut scene)?;
            }
            simplify_scene(scene, &MeshRequest { spec, budget, to, place }, &mut certificate, job)?
        }
    };
    // At the positions that will be written, and before rows are counted: hard edges double some.
    spec.normals.apply(&mut scene, [input.format, to], &mut certificate.notes)?;
    certificate.notes.extend(too_fine(&scene, &budget, job)?);
    finish(scene, bound, &MeshRequest { spec, budget, to, place }, certificate)
}

/// The triangles as the format has them, judged, with the bound on the screen.
pub(crate) fn finish(
    scene: Scene,
    mut bound: Bound,
    asked: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    let to = asked.to;
    certificate.notes.extend(losses(&scene, to)?.iter().map(ToString::to_string));
    let scene = to_file_rows(scene, to)?;
    bound.pixels = on_screen(&asked.budget, &bound, &asked.place);
    certificate.bound = Some(BoundFacts::new(&bound));
    let counted = CountedTriangles::from_scene(&scene, to)?;
    let triangles = counted.output.triangles;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    let budget = &asked.budget;
    let met = lengths_are_met(budget, &bound, &asked.place)
        && bound.angle_deg.zip(budget.angle_deg).is_none_or(|(found, asked)| found <= asked)
        && budget.triangles.is_none_or(|most| triangles <= most);
    if !met {
        certificate.notes.push(NOT_MET.to_owned());
    }
    let outcome = MeshOutcome { made: Tessellation::Triangles(scene), format: to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}

/// A note where most triangles are smaller than a pixel at the view of the budget: more than half, since every mesh has some
/// at its poles and seams.
pub(crate) fn too_fine(scene: &Scene, budget: &Budget, job: &Job) -> Result<Option<String>, MeshFailure> {
    let Some(PixelBudget { view, .. }) = budget.pixels else { return Ok(None) };
    // What cannot be put together, or is too large to look at: nothing is known, and nothing is said.
    let Ok(mesh) = flatten::one_mesh(scene) else { return Ok(None) };
    let found = match check::micro_triangles(&mesh, &view, job) {
        Ok(found) => found,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => return Ok(None),
    };
    let MicroTriangles { n_micro, n_triangles } = found;
    let most = n_micro > n_triangles / 2;
    let (of, at) = match view {
        View::Camera(_) => ("triangles in view", "there"),
        View::MinDistance(_) => ("triangles", "even where the eye is nearest and faces them"),
    };
    Ok(most.then(|| {
        format!(
            "{n_micro} of {n_triangles} {of} are smaller than a pixel {at}: more than the screen can show"
        )
    }))
}

pub(crate) const NOT_MET: &str = "the budget was not met: this is the best that was reached";

pub(crate) fn refusal(code: RefusalCode, message: impl Into<String>) -> MeshFailure {
    MeshFailure::Refused(Refusal { code, message: message.into() })
}

/// What is to be tessellated.
struct PatchSource {
    patches: Vec<Patch>,
    frame: Frame,
    /// A box around the patches.
    place: Box3,
}

fn tessellate(
    source: &PatchSource,
    budget: &Budget,
    to: Format,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let lost = worst_snap(&widen_box(&source.place), to);
    let inner = reserve_rounding(budget, lost, &source.place, to)?;
    let made = best_of(convert::patches_to_mesh(&source.patches, &inner, job))?;
    let Bounded { shape, bound } = made;
    let (mesh, bound) = snap_to_format(&shape, bound, budget, to, job)?;
    // A name that says what it is; no file name, which would tie the bytes to a place.
    Ok((Scene::from_mesh("patches", mesh, true, source.frame), bound))
}

/// The mesh at the precision of the format, and the bound with what that moved added. Pixels add as lengths do: a
/// point of the true shape moves on the screen to its point of the mesh, and from there to the rounded one. OfFaces
/// whose corners rounding put on one line are dropped, and their neighbours keep the surface closed.
pub(crate) fn snap_to_format(
    mesh: &Mesh,
    bound: Bound,
    budget: &Budget,
    to: Format,
    job: &Job,
) -> Result<(Mesh, Bound), MeshFailure> {
    let snapped = snap(mesh, to).map_err(MeshFailure::TooWide)?;
    if snapped.moved_at_most == 0.0 {
        return Ok((snapped.mesh, bound));
    }
    let whole = mend::drop_degenerate(&snapped.mesh, Topology::Positions, job)?;
    let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles).then(&whole.bound);
    let moved_at_most = step.at_most().unwrap_or(f64::INFINITY);
    let moved_px = budget.pixels.and_then(|px| px.view.pixels_of(moved_at_most, &mesh.bounds()));
    let mut chain = bound.then(&step);
    // What rounding to the format does to normals is not seen at angles that make sense.
    chain.angle_deg = bound.angle_deg;
    let both = |px: PixelBudget| px.view.pixels_of_two_steps(bound.pixels?, moved_px?);
    chain.pixels = budget.pixels.and_then(both);
    Ok((whole.mesh, chain))
}

/// The budget of the arrow: what the user gave, less what rounding to the format may cost.
pub(crate) fn reserve_rounding(
    budget: &Budget,
    lost: f64,
    place: &Box3,
    to: Format,
) -> Result<Budget, MeshFailure> {
    if lost == 0.0 || budget.length.is_none() && budget.pixels.is_none() {
        return Ok(*budget);
    }
    let name = to;
    let too_small = |asked: String, lost: String| {
        let message = format!(
            "{asked} is less than what rounding to the single precision of {name} may cost here, {lost}; \
             obj and ply keep every digit"
        );
        refusal(RefusalCode::BelowPrecision, message)
    };
    let mut inner = *budget;
    if let Some(length) = budget.length {
        let left = Tolerance::new(sub_down(length.get(), lost));
        inner.length = Some(left.map_err(|_| too_small(length.to_string(), format!("{lost:.3e}")))?);
    }
    if let Some(PixelBudget { pixels, view }) = budget.pixels {
        let lost_px = view.pixels_of(lost, place).ok_or_else(|| {
            refusal(
                RefusalCode::TooClose,
                "the shape comes so close to the eye that there is no bound in pixels",
            )
        })?;
        // What is left may be less than what is lost, where the sum is more than theirs.
        let both = view.pixels_of_two_steps(pixels.get(), lost_px).unwrap_or(f64::INFINITY);
        let left = Pixels::new(sub_down(pixels.get(), sub_up(both, pixels.get())));
        let pixels = left.map_err(|_| too_small(pixels.to_string(), format!("{lost_px:.3e}px")))?;
        inner.pixels = Some(PixelBudget { pixels, view });
    }
    Ok(inner)
}

/// The box with room for the rounding of evaluated points, which may leave the hull of their control points: an
/// evaluation has less than 32 roundings of half a step each.
pub(crate) fn widen_box(place: &Box3) -> Box3 {
    let reach =
        place.min.iter().chain(&place.max).fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
    let room = 16.0 * f64::EPSILON * reach;
    Box3 { min: place.min.map(|x| x - room), max: place.max.map(|x| x + room) }
}

/// Triangles as they are, at the precision of the format.
pub(crate) fn pass_through(
    scene: Scene,
    to: Format,
    notes: &mut Vec<String>,
) -> Result<(Scene, Bound), MeshFailure> {
    let TransformedScene { mut scene, moved_at_most: placed, left_out } =
        if to == Format::Glb { TransformedScene::unchanged(scene) } else { flatten::flatten(scene)? };
    if left_out > 0 {
        notes.push(format!("parts that stand nowhere in the scene were left out ({left_out}x)"));
    }
    let stretch = flatten::part_scales(&scene);
    let mut moved = 0.0;
    for (part, stretch) in scene.parts.iter_mut().zip(stretch) {
        let snapped = snap(&part.mesh, to).map_err(MeshFailure::TooWide)?;
        let part_moved = flatten::scaled_up(snapped.moved_at_most, stretch);
        moved = if part_moved > moved { part_moved } else { moved };
        part.mesh = snapped.mesh;
    }
    let all = if moved == 0.0 || placed == 0.0 { moved + placed } else { add_up(moved, placed) };
    if !all.is_finite() {
        return Err(refusal(
            RefusalCode::NotFinite,
            "the transforms of the scene take its coordinates out of range",
        ));
    }
    Ok((scene, Bound::proved(0.0, all, Reference::InputTriangles)))
}

/// The bound on the screen: what came along the chain, or what the length in space becomes, whichever is less.
pub(crate) fn on_screen(budget: &Budget, bound: &Bound, place: &Box3) -> Option<f64> {
    let view = budget.pixels?.view;
    let of_length = bound.at_most().and_then(|most| view.pixels_of(most, place));
    match (bound.pixels, of_length) {
        (Some(a), Some(b)) => Some(if a < b { a } else { b }),
        (a, b) => a.or(b),
    }
}

/// Whether the length and the pixels of a budget hold of what is certified; where a measurement is enough and there is nothing
/// else, of what was measured.
pub(crate) fn lengths_are_met(budget: &Budget, bound: &Bound, place: &Box3) -> bool {
    let measured = budget.require == RequiredEvidence::Measured && bound.at_most().is_none();
    let length = if measured { Some(bound.at_least()) } else { bound.at_most() };
    let pixels = match budget.pixels {
        Some(PixelBudget { view, .. }) if measured => view.pixels_of(bound.at_least(), place),
        _ => bound.pixels,
    };
    let within = |most: Option<f64>, limit: Option<f64>| {
        limit.is_none_or(|limit| most.is_some_and(|most| most <= limit))
    };
    within(length, budget.length.map(Tolerance::get))
        && within(pixels, budget.pixels.map(|px| px.pixels.get()))
}
