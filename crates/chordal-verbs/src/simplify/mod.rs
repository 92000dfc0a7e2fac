//! Simplifies the triangles of a scene, part by part: the `mesh` verb for triangles.
// Long because reasons stand beside the steps that they explain.
mod held_faces;
use crate::MeshFailure;
use crate::mesh::request::MeshRequest;
use crate::output::file_rows::{order_new_mesh, unsupported};
use crate::output::format_rounding::{self, RoundingTarget, length_for_lattice, limits_left, storage_within};
use crate::output::notes::{deformation_notes, reduction_notes, unsettled_note};
use crate::output::pass_through::rounded_deformation;
use crate::report::{AttributeFacts, Certificate, VerbFacts};
use crate::scene::flatten::{self, TransformedScene};
use crate::scene::merged_parts::MergedParts;
use crate::scene::placements;
use crate::scene::shown_parts::{ShownParts, in_pose, out_of_pose};
use chordal::budget::advice::Message;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Bound, Budget, Failure, JobError, Reference, RefusalCode, Tolerance, View};
use chordal::check::findings::{AttributeDeviation, attribute_deviation};
use chordal::check::{self, Goal};
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::lod::count::{Effort, simplify_to_count};
use chordal::lod::{ReductionStats, SimplifiedMesh, simplify};
use chordal::math::{Box3, add_up, greater, lesser};
use chordal::{Bounded, Job, Mesh, mend};
use chordal_io::glb::VertexStorage;
use chordal_io::{CoordinateOverflow, Part, Scene, worst_snap};
use held_faces::{FrozenFaces, HeldFaces, pieces_note};

/// Simplifies a scene within the budget. Returns it as it will be written, with its overall bound, and adds the other facts
/// to the certificate.
pub(crate) fn simplify_scene(
    scene: Scene,
    request: &MeshRequest,
    certificate: &mut Certificate,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let Certificate { notes, verb, stayed, .. } = certificate;
    let MeshRequest { budget, to, .. } = request;
    notes.extend(deformation_notes(&scene));
    let transformed = flatten::flatten_for(scene, *to)?;
    notes.extend(transformed.note());
    let TransformedScene { mut scene, moved_at_most: place_error, .. } = transformed;
    if scene.parts.iter().all(|part| part.mesh.faces().is_empty()) {
        return Err(MeshFailure::refused(RefusalCode::Empty, "there is no triangle to simplify"));
    }
    for part in &scene.parts {
        let bounds = part.mesh.bounds();
        if worst_snap(&bounds, *to) == f64::INFINITY {
            let farthest = |most: f64, x: &f64| if x.abs() > most.abs() { *x } else { most };
            let value = bounds.min.iter().chain(&bounds.max).fold(0.0, farthest);
            return Err(MeshFailure::TooWide(CoordinateOverflow { value }));
        }
    }
    let mut attributes = Vec::new();
    let stretch = placements::part_scales(&scene);
    // 1. The budget of each part, in its own coordinates: the length that transforms and rounding leave.
    let eye = budget.pixels.filter(|pixels| matches!(pixels.view, View::Camera(_)));
    let lengths = allowed_lengths(&scene, request)?;
    let targets = format_rounding::targets(&scene, &stretch, request.form(), |part| {
        length_for_lattice(lengths[part], &budget.attributes)
    });
    let places = RoundedPlaces { stretch: &stretch, targets: &targets, place_error };
    let mut shares: Vec<PartBudget> = match &eye {
        Some(_) => view_budgets(&scene, &places, request)?,
        None => uniform_budgets(&scene, &places, request, job)?,
    };
    let is_quantized = request.form().is_quantized();
    for ((part, share), target) in scene.parts.iter_mut().zip(&mut shares).zip(&targets) {
        if is_quantized {
            let storage = storage_within(target.lattice, &budget.attributes);
            share.budget.attributes = limits_left(share.budget.attributes, &storage);
            part.storage = Some(Box::new(storage));
        }
    }
    // 2. Part by part.
    let before: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
    let is_alone = placements::n_places(&scene) == 1;
    let mut stats = ReductionStats::default();
    let mut held = HeldFaces::default();
    let mut worst: Option<Bound> = None;
    let mut pixels = eye.map(|_| 0.0);
    let rounded = stretch.iter().zip(&targets);
    // A copy: poses are compared with those of the scene as it was, while its parts are replaced one by one.
    let posed = flatten::is_posed(&scene).then(|| scene.clone());
    let shown = posed.as_ref().map(ShownParts::new);
    for (number, ((part, (stretch, target)), share)) in
        scene.parts.iter_mut().zip(rounded).zip(&shares).enumerate()
    {
        let shown = shown.as_ref().filter(|shown| shown.is_posed(number));
        let fitting = PartToFit { number, shown, length: lengths[number], target, effort: request.effort };
        let Some(FittedPart { simplified, mut rounded, step, moved }) =
            fitting.fit(part, &share.budget, (&budget.attributes, job))?
        else {
            continue;
        };
        stats += simplified.shape.stats;
        let counts = [&part.mesh, &simplified.shape.mesh].map(|mesh| mesh.faces().len());
        // Simplified a second time, since refusals of the first time do not tell: an edge that one limit refuses is
        // often refused by the length, too.
        if HeldFaces::is_worth_asking(&share.budget, counts) {
            let free = Budget { attributes: AttributeLimits::default(), ..share.budget };
            let free = simplify_part(part, (&free, request.effort), job)?;
            let n_free = free.map_or(counts[1], |free| free.shape.mesh.faces().len());
            held.add([counts[0], counts[1], n_free]);
        }
        // Triangles that all stay keep the order of their file, which may have a meaning there.
        if rounded.faces().len() < part.mesh.faces().len() {
            order_new_mesh(&mut rounded)?;
        }
        let before = std::mem::replace(&mut part.mesh, rounded);
        let snapped = placements::scaled_up(step.at_most().unwrap_or(f64::INFINITY), *stretch);
        let seen = eye.filter(|_| shown.is_none());
        let seen = seen.and_then(|eye| share.pixels_of(&simplified, snapped, place_error, &eye.view));
        let bound = simplified.bound.then(&step);
        // Without fewer triangles, only the storage in fewer bits can have changed an attribute.
        if is_quantized || part.mesh.faces().len() < before.faces().len() {
            notes.extend(measure_attributes(&mut attributes, [&before, &part.mesh], &bound, job)?);
        }
        let part_error = bound.at_most().unwrap_or(f64::INFINITY);
        // A posed part was measured where the scene shows it; a stretch says nothing of a pose by several joints.
        let most = moved.unwrap_or_else(|| placements::scaled_up(part_error, *stretch));
        let most = if place_error == 0.0 { most } else { add_up(most, place_error) };
        if !most.is_finite() {
            let message = "the transforms of the scene take its coordinates out of range";
            return Err(MeshFailure::refused(RefusalCode::NotFinite, message));
        }
        // Parts that were simplified within a length, and posed ones, have no pixels of their own: their length is
        // seen at each of their places.
        let seen = seen.or_else(|| eye.and_then(|eye| pixels_at(&share.boxes, most, &eye.view)));
        pixels = pixels.zip(seen).map(|(most, seen)| greater(seen, most));
        if worst.as_ref().is_none_or(|worst| worst.at_most() < Some(most)) {
            // Another part may make up for the error of one, so that there is a lower bound only for a single part.
            let alone = is_alone && *stretch == 1.0 && place_error == 0.0 && shown.is_none();
            let least = if alone { bound.at_least() } else { 0.0 };
            let mut scene_bound = Bound::proved(lesser(least, most), most, Reference::InputTriangles);
            scene_bound.at = bound.at.filter(|_| alone);
            worst = Some(scene_bound);
        }
    }
    let after: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
    *verb = VerbFacts::Simplified { attributes };
    notes.push(format!("{before} triangles were simplified to {after}").into());
    notes.extend(reduction_notes(&stats));
    stayed.extend(held.note(&budget.attributes));
    let frozen = FrozenFaces::find(&scene, &stats, [before, after]);
    stayed.extend(frozen.map(|frozen| frozen.note()));
    // Pieces explain nothing if the triangles that stay in any case are more than the count by themselves.
    if !frozen.is_some_and(|frozen| frozen.are_more_than(budget, &stats)) {
        stayed.extend(pieces_note(&scene, budget));
    }
    notes.extend(stayed.iter().cloned());
    // The notes have it already.
    stayed.extend(unsettled_note(&stats).filter(|_| after == before));
    let mut worst = worst.unwrap_or_else(|| Bound::proved(0.0, 0.0, Reference::InputTriangles));
    if after < before {
        worst = with_margin(worst, budget.length);
    }
    worst.pixels = pixels;
    Ok((scene, worst))
}

/// A bound with a margin for another prover, who rounds otherwise; without it if the length has no room.
fn with_margin(bound: Bound, length: Option<Tolerance>) -> Bound {
    /// Measured: other provers get up to 6e-15 of the bound more.
    const MARGIN: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;
    let widened = bound.at_most().map(|most| most * MARGIN);
    match widened.filter(|most| length.is_none_or(|length| *most <= length.get()) && most.is_finite()) {
        Some(most) => {
            let mut wider = Bound::proved(bound.at_least(), most, bound.reference.clone());
            (wider.at, wider.metric) = (bound.at, bound.metric);
            wider
        }
        None => bound,
    }
}

/// A part to simplify so that it keeps the length where the scene shows it.
struct PartToFit<'a> {
    number: usize,
    /// The poses by a skin or morph targets.
    shown: Option<&'a ShownParts<'a>>,
    /// The largest distance that a point of the part may move in the scene; 0 without a limit.
    length: f64,
    target: &'a RoundingTarget,
    effort: Effort,
}

/// A part that was simplified.
struct FittedPart {
    simplified: Bounded<SimplifiedMesh>,
    /// The mesh as its file stores it.
    rounded: Mesh,
    /// The largest distance by which storing moved it, in the coordinates of the part.
    step: Bound,
    /// For a posed part: the largest distance that it moved in the scene.
    moved: Option<f64>,
}

impl PartToFit<'_> {
    /// Simplifies the part. If its poses are too far apart, tries again in its pose, then with shorter lengths, and at last
    /// leaves it unchanged.
    fn fit(
        &self,
        part: &mut Part,
        budget: &Budget,
        (attributes, job): (&AttributeLimits, &Job),
    ) -> Result<Option<FittedPart>, MeshFailure> {
        /// Chosen: each try takes as long as the first, and after eight the length is below a thousandth.
        const MOST_TRIES: usize = 8;
        /// The largest share of a length from one try to the next. Chosen: a larger share needs more tries, a smaller one
        /// may give up length that would have held.
        const SHORTER: f64 = 0.7;
        let limit = budget.length.is_some().then_some(self.length);
        let full_budget = budget;
        let mut budget = *budget;
        for tries_left in (0..=MOST_TRIES).rev() {
            let Some(simplified) = simplify_part(part, (&budget, self.effort), job)? else { return Ok(None) };
            let (rounded, step) = stored(part, &simplified, self.target, (attributes, job))?;
            let Some(shown) = self.shown else {
                return Ok(Some(FittedPart { simplified, rounded, step, moved: None }));
            };
            let part_error = simplified.bound.then(&step).at_most().unwrap_or(f64::INFINITY);
            let moved = shown.moved(self.number, [&part.mesh, &rounded], part_error, (limit, job))?;
            let Some(exceeded_limit) = limit.filter(|limit| moved > *limit && tries_left > 0) else {
                return Ok(Some(FittedPart { simplified, rounded, step, moved: Some(moved) }));
            };
            // At the first length that is missed: with the next one, nothing may collapse any more, and a pose of all
            // triangles keeps any length.
            if tries_left == MOST_TRIES
                && let Some(fitted) =
                    self.fit_in_pose(part, (full_budget, exceeded_limit), (attributes, job))?
            {
                return Ok(Some(fitted));
            }
            let share = lesser(SHORTER, exceeded_limit / moved);
            let shorter = budget.length.and_then(|length| Tolerance::new(share * length.get()).ok());
            // The last try has no length, so that nothing is simplified: what remains is the error of storing.
            budget.length = shorter.filter(|_| tries_left > 1);
        }
        Ok(None)
    }

    /// Simplifies a part as the scene shows it: collapses that change nothing in the coordinates of the file are seen in the
    /// pose if weights change from joint to joint. The error is checked in the pose; in its own coordinates the part may be
    /// farther off.
    fn fit_in_pose(
        &self,
        part: &mut Part,
        (budget, limit): (&Budget, f64),
        (attributes, job): (&AttributeLimits, &Job),
    ) -> Result<Option<FittedPart>, MeshFailure> {
        /// The shares of the length to try. Chosen: collapses also blend weights, which bends edges a little more than the
        /// length.
        const SHARES: [f64; 3] = [0.8, 0.4, 0.2];
        let Some(shown) = self.shown else { return Ok(None) };
        let Some(pose) = shown.first_pose(self.number, &part.mesh)? else { return Ok(None) };
        let posed = in_pose(&part.mesh, &pose).map_err(unsupported)?;
        let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
        for share in SHARES {
            let Ok(length) = Tolerance::new(share * limit) else { break };
            let budget = Budget { length: Some(length), pixels: None, ..*budget };
            let simplified = simplify_mesh(&posed, (&budget, self.effort), topology, job);
            let simplified = simplified.or_else(Failure::best_effort)?;
            let mesh = out_of_pose(&simplified.shape.mesh).map_err(unsupported)?;
            let bound = check::deviation(&mesh, &part.mesh, &Goal::default(), job)?.bound;
            let simplified =
                Bounded { shape: SimplifiedMesh { mesh, worst: None, ..simplified.shape }, bound };
            let (rounded, step) = stored(part, &simplified, self.target, (attributes, job))?;
            let part_error = simplified.bound.then(&step).at_most().unwrap_or(f64::INFINITY);
            let moved = shown.moved(self.number, [&part.mesh, &rounded], part_error, (Some(limit), job))?;
            if moved <= limit && rounded.faces().len() < part.mesh.faces().len() {
                return Ok(Some(FittedPart { simplified, rounded, step, moved: Some(moved) }));
            }
        }
        Ok(None)
    }
}

/// The stored form of a simplified part, and the largest distance by which storing moved it. If rounding to a lattice moves
/// attributes past their limits, positions stay in single precision.
fn stored(
    part: &mut Part,
    simplified: &Bounded<SimplifiedMesh>,
    target: &RoundingTarget,
    (limits, job): (&AttributeLimits, &Job),
) -> Result<(Mesh, Bound), MeshFailure> {
    let with_attributes = |storage: Option<&VertexStorage>, (mesh, step): (Mesh, Bound)| {
        let mesh = match storage {
            Some(storage) => storage.round_attributes(&mesh),
            None => Ok(mesh),
        };
        mesh.map(|mesh| (mesh, step)).map_err(unsupported)
    };
    let (mesh, step) = with_attributes(part.storage.as_deref(), round(&simplified.shape.mesh, target, job)?)?;
    let on_lattice = (rounded_deformation(mesh, part.storage.as_deref(), target.format)?, step);
    if target.lattice.is_none() || !limits.is_set() {
        return Ok(on_lattice);
    }
    let moved = simplified.bound.then(&on_lattice.1).at_most().and_then(|most| Tolerance::new(most).ok());
    let deviations = match attribute_deviation(&part.mesh, &on_lattice.0, moved, job) {
        Ok(deviations) => deviations,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => return Ok(on_lattice),
    };
    if !deviations.iter().any(|deviation| exceeds(limits, deviation)) {
        return Ok(on_lattice);
    }
    // The writer asks the part, not the target, how positions are stored.
    if let Some(storage) = &mut part.storage {
        storage.lattice = None;
    }
    let single = RoundingTarget { lattice: None, ..*target };
    Ok(with_attributes(part.storage.as_deref(), round(&simplified.shape.mesh, &single, job)?)?)
}

/// Whether an attribute deviates by more than its limit.
pub(crate) fn exceeds(limits: &AttributeLimits, deviation: &AttributeDeviation) -> bool {
    match deviation.semantic {
        Semantic::TexCoord(_) => limits.texcoord().is_some_and(|limit| deviation.largest > limit),
        Semantic::Normal => limits.normal_deg().is_some_and(|limit| deviation.largest > limit),
        _ => false,
    }
}

/// A mesh at the positions of its file, and the largest distance by which that moved it. On a lattice, triangles that were
/// left with two corners at one point are dropped: their neighbours share the edge.
fn round(mesh: &Mesh, target: &RoundingTarget, job: &Job) -> Result<(Mesh, Bound), MeshFailure> {
    let snapped = target.snap(mesh)?;
    let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles);
    if target.lattice.is_none() {
        return Ok((snapped.mesh, step));
    }
    // By positions: corners that a step of the lattice brought together still have indices of their own.
    let cleaned = mend::drop_collapsed(&snapped.mesh, Topology::Positions, job)?;
    let total = step.then(&cleaned.bound);
    // A collapsed triangle is no farther from its neighbours than rounding moved it. If more would be lost, all stay.
    let is_covered = cleaned.bound.at_most().is_some_and(|most| most <= snapped.moved_at_most);
    Ok(if is_covered { (cleaned.mesh, total) } else { (snapped.mesh, step) })
}

/// How the parts of a scene are placed and rounded.
#[derive(Clone, Copy)]
struct RoundedPlaces<'a> {
    /// By part: the largest factor by which its nodes lengthen.
    stretch: &'a [f64],
    targets: &'a [RoundingTarget],
    /// The largest distance by which applied transforms have moved a vertex through rounding.
    place_error: f64,
}

/// By part: the largest distance that a point of it may move in the scene.
fn allowed_lengths(scene: &Scene, request: &MeshRequest) -> Result<Vec<f64>, MeshFailure> {
    let MeshRequest { budget, bounds, .. } = request;
    let within = |place: &Box3| budget.length_in(place).unwrap_or(0.0);
    if !budget.pixels.is_some_and(|pixels| matches!(pixels.view, View::Camera(_))) {
        return Ok(vec![within(bounds); scene.parts.len()]);
    }
    let least = |places: &Vec<Box3>| {
        places
            .iter()
            .filter(|place| !place.is_empty())
            .fold(f64::INFINITY, |least, place| lesser(within(place), least))
    };
    Ok(placements::boxes_of_parts(scene)?.iter().map(|(places, _)| least(places)).collect())
}

/// The budget of one part.
struct PartBudget {
    /// In the coordinates of the part; a part without any limit stays as it is.
    budget: Budget,
    /// If an eye sees the scene: the boxes of the part's placements.
    boxes: Vec<Box3>,
}

impl PartBudget {
    /// Adds limits on attributes, which apply if a length or pixels are limited.
    fn limited(mut self, attributes: AttributeLimits) -> Self {
        self.budget.attributes = attributes;
        self
    }

    /// The error on the screen of a part that was simplified by pixels, or not at all: of the simplification, of rounding to
    /// the format and of its transform.
    fn pixels_of(
        &self,
        simplified: &Bounded<SimplifiedMesh>,
        snapped: f64,
        place_error: f64,
        view: &View,
    ) -> Option<f64> {
        let pixels = simplified.bound.pixels?;
        // The result may extend beyond the original box.
        let own = [simplified.shape.mesh.bounds()];
        // Only a part in world coordinates has a budget in pixels, so that its own box is its box in the scene.
        let now = if self.budget.pixels.is_some() { &own } else { self.boxes.as_slice() };
        let rounded = if snapped == 0.0 || place_error == 0.0 {
            snapped + place_error
        } else {
            add_up(snapped, place_error)
        };
        view.pixels_of_two_steps(pixels, pixels_at(now, rounded, view)?)
    }
}

/// The projection of a length of the scene to the screen: the largest over some boxes.
fn pixels_at(places: &[Box3], length: f64, view: &View) -> Option<f64> {
    let mut most = 0.0;
    for place in places {
        let seen = view.pixels_of(length, place)?;
        most = greater(seen, most);
    }
    Some(most)
}

/// Budgets that do not depend on the placement: the same length for all parts, or a triangle count for each part.
fn uniform_budgets(
    scene: &Scene,
    places: &RoundedPlaces<'_>,
    request: &MeshRequest,
    job: &Job,
) -> Result<Vec<PartBudget>, MeshFailure> {
    let MeshRequest { budget, bounds, .. } = request;
    let RoundedPlaces { stretch, targets, place_error } = *places;
    let length = length_for_all(budget, bounds)?;
    let lost = format_rounding::worst_rounding(scene, stretch, targets);
    let lost = if place_error == 0.0 || lost == 0.0 { lost + place_error } else { add_up(lost, place_error) };
    let remaining = match length {
        Some(length) => {
            request.with_budget(Budget::length(length)).reserve_rounding(lost)?.length.map(Tolerance::get)
        }
        None => None,
    };
    // Beside a length a count is no share of a part: each part goes as far as the length allows, and the sum is
    // compared with the count at the end.
    let counts = match budget.triangles {
        Some(most) if length.is_none() => Some(triangle_shares(scene, (most, request.effort), job)?),
        _ => None,
    };
    let share = |(part, stretch): (usize, &f64)| {
        let triangles = counts.as_ref().map(|counts| counts[part]);
        PartBudget { budget: Budget { triangles, ..part_budget(remaining, *stretch) }, boxes: Vec::new() }
    };
    Ok(stretch.iter().enumerate().map(share).map(|share| share.limited(budget.attributes)).collect())
}

/// Budgets if one eye sees the scene: the length that the placements of each part allow; for a part in world coordinates,
/// the pixels themselves.
fn view_budgets(
    scene: &Scene,
    places: &RoundedPlaces<'_>,
    request: &MeshRequest,
) -> Result<Vec<PartBudget>, MeshFailure> {
    let MeshRequest { budget, to, .. } = request;
    let RoundedPlaces { stretch, targets, place_error } = *places;
    let limits = Budget { length: budget.length, pixels: budget.pixels, ..Budget::default() };
    let boxes = placements::boxes_of_parts(scene)?;
    let mut shares = Vec::with_capacity(boxes.len());
    let rounded = stretch.iter().zip(targets);
    for ((part, (stretch, target)), (boxes, is_as_it_is)) in scene.parts.iter().zip(rounded).zip(boxes) {
        let boxes: Vec<Box3> = boxes.iter().map(|place| placements::pad_box(place, place_error)).collect();
        let lost = placements::scaled_up(target.worst(&part.mesh.bounds()), *stretch);
        let lost =
            if place_error == 0.0 || lost == 0.0 { lost + place_error } else { add_up(lost, place_error) };
        let mut remaining = Budget::default();
        for place in boxes.iter().filter(|place| !place.is_empty()) {
            // By placement, since the same rounding is more pixels in the one that is nearest to the eye.
            let here = MeshRequest::new(limits, *to, *place).reserve_rounding(ROOM_TO_THE_EYE * lost)?;
            if is_as_it_is {
                remaining = here;
                continue;
            }
            // A part that comes too close in one of its placements stays as it is.
            let length = here.length_in(place).unwrap_or(0.0);
            let least = remaining.length.map_or(f64::INFINITY, Tolerance::get);
            remaining = part_budget(Some(lesser(length, least)), 1.0);
            if remaining.length.is_none() {
                break;
            }
        }
        if !is_as_it_is {
            remaining = part_budget(remaining.length.map(Tolerance::get), *stretch);
        }
        shares.push(PartBudget { budget: remaining, boxes }.limited(budget.attributes));
    }
    Ok(shares)
}

/// The factor on the reserve for rounding if an eye sees the part: the result may be nearer to the eye than the input, by
/// the pixels' fraction of half the picture. Chosen: enough for 8 % of it.
const ROOM_TO_THE_EYE: f64 = 1.125;

/// A length of the scene as the budget of a part that is scaled by `stretch`; no limit if nothing is left of the length.
fn part_budget(length: Option<f64>, stretch: f64) -> Budget {
    let length = length.and_then(|length| placements::length_in_part(length, stretch));
    Budget { length, ..Budget::default() }
}

/// Adds the attribute deviation between two meshes; returns a note if it could not be measured. Lines between charts are
/// within the bound of their old places.
fn measure_attributes(
    attributes: &mut Vec<AttributeFacts>,
    [before, after]: [&Mesh; 2],
    bound: &Bound,
    job: &Job,
) -> Result<Option<Message>, MeshFailure> {
    let moved = bound.at_most().and_then(|most| Tolerance::new(most).ok());
    match attribute_deviation(before, after, moved, job) {
        Ok(deviations) => {
            deviations.iter().for_each(|deviation| AttributeFacts::add(attributes, deviation));
            Ok(None)
        }
        Err(JobError::Cancelled) => Err(MeshFailure::Cancelled),
        Err(JobError::Refused(refusal)) => Ok(Some(
            Message::from("the deviation of attributes was not measured: ").message(&refusal.message),
        )),
    }
}

/// The length that the budget allows everywhere.
fn length_for_all(budget: &Budget, bounds: &Box3) -> Result<Option<Tolerance>, MeshFailure> {
    let close = || {
        MeshFailure::refused(
            RefusalCode::TooClose,
            "the shape comes so close to the eye that there is no bound in pixels",
        )
    };
    let length = budget.length_in(bounds).ok_or_else(close)?;
    if length == f64::INFINITY {
        return Ok(None);
    }
    Tolerance::new(length).map(Some).map_err(|_| close())
}

/// Simplifies one part; `None` if there is nothing to do.
fn simplify_part(
    part: &Part,
    (budget, effort): (&Budget, Effort),
    job: &Job,
) -> Result<Option<Bounded<SimplifiedMesh>>, MeshFailure> {
    let n_faces = part.mesh.faces().len() as u64;
    let unchanged = || {
        let mut bound = Bound::proved(0.0, 0.0, Reference::InputTriangles);
        bound.pixels = Some(0.0);
        let shape = SimplifiedMesh {
            mesh: part.mesh.clone(),
            worst: None,
            stats: ReductionStats::default(),
            attributes: Vec::new(),
        };
        (n_faces > 0).then_some(Bounded { shape, bound })
    };
    let enough = budget.triangles.is_none_or(|count| count >= n_faces);
    let is_count_alone = budget.length.is_none() && budget.pixels.is_none();
    if n_faces == 0 || (is_count_alone && enough) {
        return Ok(unchanged());
    }
    let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
    match simplify_mesh(&part.mesh, (budget, effort), topology, job) {
        // The eye is close to all of this part, and perhaps not to others.
        Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::TooClose => Ok(unchanged()),
        simplified => Ok(Some(simplified.or_else(Failure::best_effort)?)),
    }
}

/// Simplifies a mesh; `effort` applies only to a budget of a count alone.
pub(crate) fn simplify_mesh(
    mesh: &Mesh,
    (budget, effort): (&Budget, Effort),
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, Failure<SimplifiedMesh>> {
    match budget.triangles {
        Some(most) if *budget == Budget::triangles(most) => {
            simplify_to_count(mesh, most, effort, topology, job)
        }
        _ => simplify(mesh, budget, topology, job),
    }
}

/// Distributes a triangle count over the parts, as if they were one mesh, so that triangles are kept where
/// they matter most.
fn triangle_shares(scene: &Scene, (most, effort): (u64, Effort), job: &Job) -> Result<Vec<u64>, MeshFailure> {
    let n_parts = scene.parts.len();
    // One placement shows one part: the others, which no node shows, may keep as many.
    if placements::n_places(scene) == 1 {
        return Ok(vec![most; n_parts]);
    }
    let MergedParts { mesh, places } = MergedParts::from_scene(scene, Topology::Positions)?;
    let ends = places.iter().skip(1).map(|(_, first)| *first).chain([mesh.faces().len() as u32]);
    let mut place_of_face = Vec::with_capacity(mesh.faces().len());
    for (place, ((_, first), end)) in places.iter().zip(ends).enumerate() {
        place_of_face.extend((*first..end).map(|_| place as f64));
    }
    let place_of = Attribute {
        semantic: Semantic::Group(PLACE.to_owned()),
        domain: Domain::Face,
        width: 1,
        values: place_of_face,
    };
    let mesh = mesh.with_attribute(place_of.clone()).map_err(unsupported)?;
    let simplified = simplify_to_count(&mesh, most, effort, Topology::Indices, job)
        .or_else(Failure::best_effort)?
        .shape
        .mesh;
    // A part with several placements has one triangle count: the least over them.
    let mut kept = vec![0_u64; places.len()];
    if let Some(place_of_face) = simplified.attribute(&place_of.semantic) {
        place_of_face.values.iter().for_each(|place| kept[*place as usize] += 1);
    }
    let mut counts = vec![u64::MAX; n_parts];
    for ((part, _), kept) in places.iter().zip(kept) {
        counts[*part] = counts[*part].min(kept);
    }
    Ok(counts)
}

/// The attribute that holds the placement of a triangle.
const PLACE: &str = "place";
