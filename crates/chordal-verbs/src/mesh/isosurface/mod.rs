//! Isosurfaces of volumes: one at a level, or one for each label, at the lattice's own resolution or within a
//! budget.
pub(crate) mod label_looks;
pub(crate) mod simplified;
mod smoothing;
pub(crate) mod zero_set;
use crate::input::volume::{LabelSelection, SuggestedLevel, ValueRange, VolumeShape};
use crate::mesh::request::MeshRequest;
use crate::report::SmoothingFacts;
use crate::{MeshFailure, SmoothingWidth, SurfaceSpec};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Budget, RefusalCode};
use chordal::convert::{self, Border, Inside, Polygonize};
use chordal::implicit::{Grid, Samples};
use chordal::math::lesser;
use chordal::{Bounded, Job, Mesh};
use chordal_io::{Format, Node, Scene};
use label_looks::LabelLooks;
use simplified::{simplified, simplified_isosurface, simplified_labels};
use smoothing::{smoothed_surface, smoothing_note};

/// The triangles of a surface within a budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SurfaceForm {
    /// The triangles of the cells: for inspection, or for callers that simplify them.
    Cells,
    /// As few triangles as the budget allows.
    Simplified,
}

/// The surface of a volume.
pub(crate) struct VolumeSurface {
    pub scene: Scene,
    /// Against the trilinear interpolant of the samples.
    pub bound: Bound,
    pub smoothed: Option<SmoothingFacts>,
}

/// The isosurface of a volume at the precision of the format, with its bound against the trilinear
/// interpolant.
///
/// # Errors
/// If neither the request nor the samples determine a surface; if there is none; as for
/// [`convert::grid_to_mesh`].
pub(crate) fn mesh_volume(
    sampled: &VolumeShape,
    (request, form): (&MeshRequest, SurfaceForm),
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<VolumeSurface, MeshFailure> {
    let grid = &sampled.volume.grid;
    let range = ValueRange::from_samples(grid.samples());
    if let Some(space) = &sampled.volume.space {
        notes.push(
            format!("coordinates are those of the file, in its space {space}: nothing was rotated").into(),
        );
    }
    if range.nan > 0 {
        notes.push(format!("{} samples are NaN and count as outside", range.nan).into());
    }
    if range.infinite > 0 {
        notes
            .push(format!("{} samples are infinite and count as the largest numbers", range.infinite).into());
    }
    if let Some(labels) = &sampled.surface.labels {
        let labels = selected_labels(labels, sampled, &range)?;
        let (scene, bound) = mesh_labels(sampled, &labels, (request, form), notes, job)?;
        return Ok(VolumeSurface { scene, bound, smoothed: None });
    }
    let rule = polygonize_rule(sampled, &range, notes)?;
    note_border(grid, &rule, notes);
    let mesher = SurfaceMesher { sampled, request, job };
    let (surface, smoothed) = match sampled.surface.smooth {
        Some(width) => {
            let suggested = range.suggest(&sampled.volume);
            let (surface, facts) = mesher.make_smooth((&rule, suggested.as_ref()), (width, form), notes)?;
            (surface, Some(facts))
        }
        None => (mesher.make(grid, (&rule, form), notes)?, None),
    };
    let mut scene = Scene::from_mesh("surface", surface.shape, sampled.volume.frame);
    set_names(&mut scene, &sampled.volume.name);
    Ok(VolumeSurface { scene, bound: surface.bound, smoothed })
}

/// The isosurface of a volume at the full precision of its numbers, for callers that write no file.
///
/// # Errors
/// As for [`mesh_volume`].
pub(crate) fn surface_of(
    sampled: &VolumeShape,
    budget: Budget,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    // PLY rounds nothing.
    let request = MeshRequest::new(budget, Format::Ply, sampled.bounds()).widened();
    let surface = mesh_volume(sampled, (&request, SurfaceForm::Cells), notes, job)?;
    Ok((surface.scene, surface.bound))
}

/// Gives the name that a volume has in its file to the mesh.
fn set_names(scene: &mut Scene, name: &str) {
    if !name.is_empty() {
        scene.parts.iter_mut().for_each(|part| part.name = name.to_owned());
        scene.nodes.iter_mut().for_each(|node| node.name = name.to_owned());
    }
}

/// Builds meshes under the conditions of a request.
struct SurfaceMesher<'a> {
    sampled: &'a VolumeShape,
    request: &'a MeshRequest,
    job: &'a Job,
}

impl SurfaceMesher<'_> {
    /// One mesh at the precision of the format.
    fn make(
        &self,
        grid: &Grid,
        (rule, form): (&Polygonize, SurfaceForm),
        notes: &mut Vec<Message>,
    ) -> Result<Bounded<Mesh>, MeshFailure> {
        let Self { sampled, request, job } = self;
        let rule = Polygonize { margin: margin(&sampled.volume.grid, request.rounding()), ..*rule };
        // Without a budget the surface has the lattice's own resolution.
        if request.budget == Budget::default() {
            return request.run(job, |_| convert::grid_to_mesh(grid, &rule, None, job));
        }
        request.run(job, |budget| match form {
            SurfaceForm::Cells => convert::grid_to_mesh(grid, &rule, Some(budget), job),
            SurfaceForm::Simplified => {
                let limits = (budget, &request.bounds, request.effort);
                let (mesh, note) = simplified_isosurface(grid, &rule, limits, job)?;
                notes.extend(note);
                Ok(mesh)
            }
        })
    }
}

impl SurfaceMesher<'_> {
    /// The mesh of a smoothed mask at the precision of the format, and the error of smoothing.
    fn make_smooth(
        &self,
        (rule, suggested): (&Polygonize, Option<&SuggestedLevel>),
        (width, form): (SmoothingWidth, SurfaceForm),
        notes: &mut Vec<Message>,
    ) -> Result<(Bounded<Mesh>, SmoothingFacts), MeshFailure> {
        let Self { sampled, request, job } = self;
        let rule = Polygonize { margin: margin(&sampled.volume.grid, request.rounding()), ..*rule };
        let budget = request.reserve_rounding(request.rounding())?;
        let length = budget.length_in(&request.bounds).unwrap_or(0.0);
        let (mesh, facts) = smoothed_surface(sampled, (&rule, suggested), (width, length), job)?;
        notes.push(smoothing_note(width, &facts));
        let mesh = match form {
            SurfaceForm::Simplified if budget.has_limit() => {
                let (mesh, note) = simplified(mesh, (&budget, length, request.effort), job)
                    .map_err(|failure| MeshFailure::from_missed(failure, ""))?;
                notes.extend(note);
                mesh
            }
            _ => mesh,
        };
        Ok((request.snap(&mesh.shape, mesh.bound, job)?, facts))
    }
}

/// How near to a sample a vertex may come, as a fraction of an edge, so that rounding to the format keeps
/// vertices apart.
fn margin(grid: &Grid, lost: f64) -> f64 {
    if lost == 0.0 {
        return Polygonize::MARGIN;
    }
    let squares = grid.affine().steps().map(|[x, y, z]| x * x + y * y + z * z);
    let shortest = squares.into_iter().fold(f64::INFINITY, |least, s| lesser(s, least)).sqrt();
    let mut margin = Polygonize::MARGIN_F32;
    // Two vertices at a sample are a margin away from it each, so each may be rounded by half a margin; with more than an
    // eighth of an edge, the surface would be a different one.
    while margin * shortest < 4.0 * lost && margin < 0.125 {
        margin *= 2.0;
    }
    margin
}

/// The level and the inside, from the request and the samples.
fn polygonize_rule(
    sampled: &VolumeShape,
    range: &ValueRange,
    notes: &mut Vec<Message>,
) -> Result<Polygonize, MeshFailure> {
    let SurfaceSpec { level, inside, border, .. } = &sampled.surface;
    let suggested = range.suggest(&sampled.volume);
    let Some([low, high]) = range.ends else {
        return Err(MeshFailure::refused(
            RefusalCode::Empty,
            "no sample is a finite number, so that there is no surface",
        ));
    };
    let level = match (level, &suggested) {
        (Some(level), _) => *level,
        (None, Some(suggestion)) if suggestion.follows() => suggestion.level,
        (None, Some(suggestion)) => {
            let between =
                format!("samples lie between {low} and {high}, and the level of the surface is not known: ");
            let message = Message::from(between)
                .value(Setting::Iso, "LEVEL")
                .words(format_args!(" sets it; {} separates them best", suggestion.level));
            return Err(MeshFailure::Usage(if range.may_be_labels() {
                let labels = message.words("; if they are labels, ").setting(Setting::Labels);
                labels.words(" gives a surface of each")
            } else {
                message
            }));
        }
        (None, None) => {
            return Err(MeshFailure::refused(
                RefusalCode::Empty,
                format!("all samples are {low}, so that there is no surface at any level"),
            ));
        }
    };
    let side = inside.unwrap_or_else(|| range.default_side(level, &sampled.volume));
    let kind_note = match (suggested, side) {
        (Some(suggestion), _) if sampled.surface.level.is_none() => {
            let article = if suggestion.kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
            format!(" (taken for {article} {})", suggestion.kind)
        }
        _ => String::new(),
    };
    let words = if side == Inside::High { "above" } else { "below" };
    notes.push(format!(
        "the surface is where samples are {level}, with samples {words} that inside{kind_note}; samples lie between {low} and {high}"
    ).into());
    let rule = if side == Inside::High { Polygonize::above(level) } else { Polygonize::below(level) };
    // Before the check of the range, which a level of 0 passes if 0 is the least sample, although nothing is below.
    if suggested.is_some_and(|suggestion| suggestion.kind == "signed distance" && suggestion.level == level)
        && low >= 0.0
    {
        let message = format!(
            "no distance is below 0, they lie between {low} and {high}: the shape that they were measured from has no \
             inside, so that there is no surface; "
        );
        let message =
            Message::from(message).value(Setting::Iso, 0.5 * high).words(" gives one that far away");
        return Err(MeshFailure::refused(RefusalCode::Empty, message));
    }
    if !(level >= low && level <= high) {
        let message = format!(
            "level {level} is not among the samples, which lie between {low} and {high}: there is no surface"
        );
        return Err(MeshFailure::refused(RefusalCode::Empty, message));
    }
    Ok(if *border == Border::Open { rule.open() } else { rule })
}

/// Adds a note if the shape reaches the border of the volume.
fn note_border(grid: &Grid, rule: &Polygonize, notes: &mut Vec<Message>) {
    let is_inside = |x: f64| match rule.inside {
        Inside::Low => x < rule.level,
        Inside::High => x > rule.level,
    };
    let [nx, ny, nz] = grid.size();
    let mut n = 0_u64;
    for z in 0..nz {
        for y in 0..ny {
            // A row within the volume is on its border with the first and the last sample alone.
            let is_border = z == 0 || z + 1 == nz || y == 0 || y + 1 == ny;
            let step = if is_border { 1 } else { (nx - 1).max(1) };
            n += (0..nx).step_by(step).filter(|x| is_inside(grid.sample([*x, y, z]))).count() as u64;
        }
    }
    if n > 0 && rule.border == [[Border::Capped; 2]; 3] {
        let closed = format!(
            "the shape reaches the border of the volume ({n} samples) and is closed there by flat faces; "
        );
        notes.push(Message::from(closed).setting(Setting::Open).words(" leaves it open"));
    } else if n > 0 {
        notes.push(format!("the shape reaches the border of the volume ({n} samples) and ends there").into());
    }
}

/// The labels that get a surface, in their order.
fn selected_labels(
    labels: &LabelSelection,
    sampled: &VolumeShape,
    range: &ValueRange,
) -> Result<Vec<i64>, MeshFailure> {
    if sampled.surface.smooth.is_some() {
        let message = Message::from("smoothed one by one, labels would no longer fit together: ");
        return Err(MeshFailure::Usage(message.setting(Setting::Smooth).words(" is for masks")));
    }
    if sampled.surface.level.is_some() || sampled.surface.inside.is_some() {
        let message = Message::from("labels have no level and no side: give ").setting(Setting::Labels);
        return Err(MeshFailure::Usage(message.words(" alone, or ").setting(Setting::Iso)));
    }
    let Some(present) = &range.labels else {
        let message = if range.is_whole {
            "labels are at most 65,536 different whole numbers; these samples are more"
        } else {
            "labels are whole numbers, and not all of these samples are"
        };
        return Err(MeshFailure::Usage(message.into()));
    };
    match labels {
        LabelSelection::All => {
            let selected: Vec<i64> = present.keys().copied().filter(|label| *label != 0).collect();
            if selected.is_empty() {
                let message = "every sample is label 0, the background: there is no surface";
                return Err(MeshFailure::refused(RefusalCode::Empty, message));
            }
            Ok(selected)
        }
        LabelSelection::Listed(listed) => {
            let mut selected = listed.clone();
            selected.sort_unstable();
            selected.dedup();
            if let Some(missing) = selected.iter().find(|label| !present.contains_key(label)) {
                let (first, last) = (present.keys().next(), present.keys().next_back());
                let ends = first.zip(last).map_or_else(String::new, |(a, b)| format!(" between {a} and {b}"));
                let message =
                    format!("no sample has label {missing}; there are {} labels{ends}", present.len());
                return Err(MeshFailure::refused(RefusalCode::Empty, message));
            }
            Ok(selected)
        }
    }
}

/// One part for each label, halfway between its samples and others. Adjacent labels share their vertices, also after they
/// are simplified.
fn mesh_labels(
    sampled: &VolumeShape,
    labels: &[i64],
    (request, form): (&MeshRequest, SurfaceForm),
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    // Refuses a budget that rounding to the format alone would exceed.
    let budget = request.reserve_rounding(request.rounding())?;
    let rule = convert::lattices::LabelOptions {
        border: [[sampled.surface.border; 2]; 3],
        ..convert::lattices::LabelOptions::default()
    };
    let numbered = label_indices(&sampled.volume.grid, labels, job)?;
    let meshes = convert::lattices::labels_to_meshes(&numbered, &rule, job)
        .map_err(|failure| MeshFailure::from_missed(failure, ""))?;
    let (numbers, meshes): (Vec<u32>, Vec<Bounded<Mesh>>) = meshes.into_iter().unzip();
    let (meshes, note) = match form {
        SurfaceForm::Simplified if budget.has_limit() => {
            simplified_labels(meshes, (&budget, &request.bounds), job)?
        }
        _ => (meshes, None),
    };
    let mut scene = Scene { frame: sampled.volume.frame, ..Scene::default() };
    let looks = LabelLooks::new(&sampled.volume, labels);
    let mut worst: Option<Bound> = None;
    for (number, Bounded { shape, bound }) in numbers.into_iter().zip(meshes) {
        let Bounded { shape, bound } = request.snap(&shape, bound, job)?;
        let label = labels[number as usize - 1];
        let label_scene = Scene::from_mesh(&looks.name(label), looks.paint(shape, number), scene.frame);
        let at = scene.parts.len();
        scene.parts.extend(label_scene.parts);
        scene.nodes.extend(label_scene.nodes.into_iter().map(|node| Node { part: Some(at), ..node }));
        // Each label has one part and one node, so that the index of the one is that of the other.
        scene.roots.push(at);
        // An unknown error may be any.
        let largest = |bound: &Bound| bound.at_most().unwrap_or(f64::INFINITY);
        let is_worse = worst.as_ref().is_none_or(|worst| largest(&bound) > largest(worst));
        worst = if is_worse { Some(bound) } else { worst };
    }
    looks.add_materials(&mut scene);
    notes.push(
        format!(
            "each of {} labels has a surface of its own, halfway between its samples and others",
            labels.len()
        )
        .into(),
    );
    notes.extend(note);
    let worst = worst.ok_or_else(|| MeshFailure::refused(RefusalCode::Empty, "no label was requested"))?;
    Ok((scene, worst))
}

/// The index of each sample's label in the list, counted from 1; 0 for labels that are not in it.
fn label_indices(grid: &Grid, labels: &[i64], job: &Job) -> Result<Grid, MeshFailure> {
    let samples = grid.samples();
    let bytes = 4 * samples.len() as u64;
    if bytes > job.memory_limit {
        let message =
            format!("{} labels need {bytes} bytes; the limit is {}", samples.len(), job.memory_limit);
        return Err(MeshFailure::refused(RefusalCode::TooMuchMemory, message));
    }
    // A run of equal samples is looked up once.
    let mut last: Option<(i64, u32)> = None;
    let values = (0..samples.len()).map(|at| {
        let label = samples.get(at) as i64;
        let number = match last {
            Some((last_label, number)) if last_label == label => number,
            _ => labels.binary_search(&label).map_or(0, |row| row as u32 + 1),
        };
        last = Some((label, number));
        number
    });
    let values = Samples::U32(values.collect());
    Ok(Grid::new(grid.size(), values, *grid.affine()).expect("as many values as the lattice had"))
}
