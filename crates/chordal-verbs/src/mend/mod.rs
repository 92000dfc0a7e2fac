//! `mend`: repairs the defects that `inspect` finds, one repair at a time; the result is as a reader of the format gets it.
pub(crate) mod recommend;
use crate::mesh::request::MeshRequest;
use crate::output::finish::finish_triangles;
use crate::output::pass_through::pass_through;
use crate::report::{BoundFacts, Certificate, CountedTriangles, RepairFacts, VerbFacts};
use crate::scene::placements::part_scales;
use crate::scene::shown_parts::max_bound;
use crate::{BudgetSpec, Input, MeshFailure, MeshOutcome, OutputForm, Shape, formats};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::budget::{Bound, Budget, Length, Reference, RefusalCode, Tolerance};
use chordal::explicit::Topology;
use chordal::math::div_down;
use chordal::mend::nesting::NestedShells;
use chordal::mend::{
    Duplicates, HoleSelection, MendedMesh, Weld, drop_degenerate, drop_duplicates, drop_unused, fill_holes,
    orient, resolve_t_junctions, split_non_manifold, weld,
};
use chordal::{Job, Mesh};
use chordal_io::Scene;

/// The repairs to apply; at least one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MendSpec {
    /// Merge vertices at the same point into one position.
    pub weld: Option<WeldTolerance>,
    /// Drop faces that repeat the positions of an earlier one.
    pub drop_duplicates: Option<Duplicates>,
    /// Drop faces without area.
    pub drop_degenerate: bool,
    /// Split faces at vertices in the interior of their edges.
    pub resolve_t_junctions: Option<WeldTolerance>,
    /// Split the surface where it is not manifold.
    pub split_non_manifold: bool,
    /// Orient faces consistently, and outwards if they enclose a volume.
    pub orient: bool,
    /// The orientation of closed pieces within others after that.
    pub nested: NestedShells,
    /// Fill boundary loops.
    pub fill_holes: Option<HoleSelection>,
    /// Drop vertices that no face uses.
    pub drop_unused: bool,
}

/// How close vertices must be to be merged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WeldTolerance {
    /// Equal coordinates.
    Exact,
    /// Within this length.
    Within(Length),
}

/// A repair with its parameters, in the order of application.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RepairStep {
    Weld(Option<Tolerance>),
    DropDuplicates(Duplicates),
    DropDegenerate,
    ResolveTJunctions(Option<Tolerance>),
    SplitNonManifold,
    Orient(NestedShells),
    FillHoles(HoleSelection),
    DropUnused,
}

/// Applies the repairs in `spec` to every part by itself, and returns the triangles as they read back from a file of the
/// format `to`.
///
/// The order: weld, drop duplicates, drop degenerate, resolve T-junctions, split, orient, fill; orient once more if a hole
/// was filled, since the closed surface now has an outside; drop unused. Lengths are in scene units: for a part that is
/// scaled up, the length is divided by the scale. The bound adds the displacement of each repair, as scaled in the scene,
/// and the rounding to the format. [`Certificate::mended`] lists the changes, and [`Certificate::valid_before`] the state
/// before.
///
/// # Errors
/// If no repair is requested, the shape has no triangles or the length no meaning for it; if the work is refused or
/// cancelled; if nothing would be left; if a coordinate does not fit the format.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{FormatHint, MendSpec, load, mend};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// let spec = MendSpec { drop_unused: true, ..MendSpec::default() };
/// let outcome = mend(input, &spec, Format::Ply, &Default::default())?;
/// assert_eq!(outcome.certificate.verb.repairs()[0].changes[0].what, "dropped_vertices");
/// assert_eq!(outcome.certificate.valid.unwrap().counts.unused_vertices, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mend(
    input: Input,
    spec: &MendSpec,
    to: impl Into<OutputForm>,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let form: OutputForm = to.into();
    let to = form.format;
    let cures = spec.cures(&input.shape)?;
    if cures.is_empty() {
        return Err(MeshFailure::Usage("no repair is requested".into()));
    }
    formats::check_output(&input.shape, to).map_err(MeshFailure::Usage)?;
    let mut certificate = Certificate::from_input(&input);
    let bounds = input.shape.bounds()?;
    let kinds = input.shape.kinds();
    let Shape::Scene(mut scene) = input.shape else {
        return Err(MeshFailure::Usage(formats::only_triangles("mended", kinds)));
    };
    let valid_before = Box::new(CountedTriangles::from_scene(&scene, input.format)?.valid);
    let mut bound = Bound::exact(Reference::InputTriangles);
    let mut mended = Vec::new();
    let mut topologies = vec![input.format.topology(); scene.parts.len()];
    let stretch = part_scales(&scene);
    for cure in cures {
        let (facts, cured) = cure.apply(&mut scene, &stretch, &mut topologies, job)?;
        bound = bound.then(&cured);
        mended.push(facts);
    }
    certificate.notes.extend(nesting_note(&mended));
    certificate.verb = VerbFacts::Mended { valid_before, mended };
    if certificate.was_split() && to.topology() == Topology::Positions {
        certificate.notes.push(
            format!("{to} has no indices of positions: copies on each other are one there again").into(),
        );
    }
    // Readers refuse a file of nothing.
    if scene.parts.iter().all(|part| part.mesh.positions().is_empty()) {
        return Err(MeshFailure::refused(
            RefusalCode::Empty,
            "nothing would be left: there are no triangles, only points",
        ));
    }
    let (scene, rounded) = pass_through(scene, form, &mut certificate.notes)?;
    let request = MeshRequest::new(Budget::default(), form, bounds);
    finish_triangles(scene, bound.then(&rounded), &request, certificate)
}

/// A note on closed pieces within others that do not face as a cavity does, with the assumption about them.
fn nesting_note(mended: &[RepairFacts]) -> Option<Message> {
    // The last, since pieces may be oriented twice, and the second time decides.
    let last_count = |what: &str| {
        let changes = mended.iter().rev().flat_map(|facts| &facts.changes);
        changes.filter(|change| change.what == what).map(|change| change.count).next().unwrap_or(0)
    };
    let (kept, turned) = (last_count("left_nested_shells"), last_count("turned_nested_shells"));
    let pieces = |n: u64| if n == 1 { "a closed piece".to_owned() } else { format!("{n} closed pieces") };
    if kept > 0 {
        let start =
            format!("{} within another faces the same way as that one: taken as solid; ", pieces(kept));
        return Some(
            Message::from(start).value(Setting::Nested, "cavity").words(" takes it out of the solid"),
        );
    }
    if turned > 0 {
        let start = format!(
            "{} within another faced the same way as that one: turned into a cavity; ",
            pieces(turned)
        );
        return Some(Message::from(start).value(Setting::Nested, "keep").words(" leaves it solid"));
    }
    None
}

impl MendSpec {
    /// Every repair: by equal positions, and of all holes.
    pub const ALL: Self = Self {
        weld: Some(WeldTolerance::Exact),
        drop_duplicates: Some(Duplicates::EitherWay),
        drop_degenerate: true,
        resolve_t_junctions: Some(WeldTolerance::Exact),
        split_non_manifold: true,
        orient: true,
        nested: NestedShells::Keep,
        fill_holes: Some(HoleSelection::All),
        drop_unused: true,
    };

    /// The repairs in their order.
    fn cures(&self, shape: &Shape) -> Result<Vec<RepairStep>, MeshFailure> {
        let length = |closeness: WeldTolerance| match closeness {
            WeldTolerance::Exact => Ok(None),
            WeldTolerance::Within(length) => {
                let spec = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
                spec.resolve(shape).map(|(budget, _)| budget.length)
            }
        };
        let weld = self.weld.map(length).transpose()?;
        let resolve_t_junctions = self.resolve_t_junctions.map(length).transpose()?;
        Ok(self.in_order(weld, resolve_t_junctions))
    }

    /// The order of [`Cure::ALL`]; orients a second time after filling, since a filled surface has an outside.
    fn in_order(
        &self,
        weld: Option<Option<Tolerance>>,
        resolve_t_junctions: Option<Option<Tolerance>>,
    ) -> Vec<RepairStep> {
        let requested = |flag: bool, cure: RepairStep| flag.then_some(cure);
        let steps = [
            weld.map(RepairStep::Weld),
            self.drop_duplicates.map(RepairStep::DropDuplicates),
            requested(self.drop_degenerate, RepairStep::DropDegenerate),
            resolve_t_junctions.map(RepairStep::ResolveTJunctions),
            requested(self.split_non_manifold, RepairStep::SplitNonManifold),
            requested(self.orient, RepairStep::Orient(self.nested)),
            self.fill_holes.map(RepairStep::FillHoles),
            requested(self.orient && self.fill_holes.is_some(), RepairStep::Orient(self.nested)),
            requested(self.drop_unused, RepairStep::DropUnused),
        ];
        steps.into_iter().flatten().collect()
    }
}

/// All repairs by exact positions, in their order.
pub(crate) fn trial_steps() -> Vec<RepairStep> {
    MendSpec::ALL.in_order(Some(None), Some(None))
}

impl RepairStep {
    /// The kind of the repair, without its length or number.
    pub fn cure(self) -> Cure {
        match self {
            Self::Weld(_) => Cure::Weld,
            Self::DropDuplicates(_) => Cure::DropDuplicates,
            Self::DropDegenerate => Cure::DropDegenerate,
            Self::ResolveTJunctions(_) => Cure::ResolveTJunctions,
            Self::SplitNonManifold => Cure::SplitNonManifold,
            Self::Orient(_) => Cure::Orient,
            Self::FillHoles(_) => Cure::FillHoles,
            Self::DropUnused => Cure::DropUnused,
        }
    }

    /// Repairs every part. Returns the changes, and a bound for how far the scene moved.
    pub fn apply(
        self,
        scene: &mut Scene,
        stretch: &[f64],
        topologies: &mut [Topology],
        job: &Job,
    ) -> Result<(RepairFacts, Bound), MeshFailure> {
        let within = match self {
            Self::Weld(within) | Self::ResolveTJunctions(within) => within.map(Tolerance::get),
            _ => None,
        };
        let mut bound = Bound::exact(Reference::InputTriangles);
        let mut facts = RepairFacts {
            cure: self.cure().name(),
            within,
            changes: Vec::new(),
            bound: BoundFacts::new(&bound),
        };
        for (number, part) in scene.parts.iter_mut().enumerate() {
            let mended = self.apply_to_part(&part.mesh, topologies[number], stretch[number], job)?;
            facts.add(number, &mended);
            bound = max_bound(bound, &mended.bound, stretch[number])?;
            if matches!(self, Self::SplitNonManifold) && !mended.is_unchanged() {
                // From now on the rows identify positions: equal coordinates would tie the copies again.
                topologies[number] = Topology::Indices;
            }
            part.mesh = mended.mesh;
        }
        facts.bound = BoundFacts::new(&bound);
        Ok((facts, bound))
    }

    fn apply_to_part(
        self,
        mesh: &Mesh,
        topology: Topology,
        stretch: f64,
        job: &Job,
    ) -> Result<MendedMesh, MeshFailure> {
        let in_part =
            |within: Option<Tolerance>| within.map(|within| part_tolerance(within, stretch)).transpose();
        let mended = match self {
            Self::Weld(within) => weld(mesh, in_part(within)?.map_or(Weld::Exact, Weld::Within), job),
            Self::DropDuplicates(which) => drop_duplicates(mesh, topology, which, job),
            Self::DropDegenerate => drop_degenerate(mesh, topology, job),
            Self::ResolveTJunctions(within) => resolve_t_junctions(mesh, topology, in_part(within)?, job),
            Self::SplitNonManifold => split_non_manifold(mesh, topology, job),
            Self::Orient(nested) => orient(mesh, topology, nested, job),
            Self::FillHoles(holes) => fill_holes(mesh, topology, holes, job),
            Self::DropUnused => drop_unused(mesh, job),
        };
        Ok(mended?)
    }
}

/// A scene length in the coordinates of a part that is scaled by at most `stretch`.
fn part_tolerance(within: Tolerance, stretch: f64) -> Result<Tolerance, MeshFailure> {
    // A part that no node shows has no scale: its own coordinates count.
    if stretch == 0.0 || stretch == 1.0 {
        return Ok(within);
    }
    Tolerance::new(div_down(within.get(), stretch)).map_err(|_| {
        MeshFailure::refused(
            RefusalCode::BelowPrecision,
            format!("{within} is no length for a part that is shown {stretch} times as large"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_one_list() {
        let mut cures: Vec<Cure> = trial_steps().iter().map(|step| step.cure()).collect();
        assert_eq!(cures.remove(7), Cure::Orient);
        assert_eq!(cures, Cure::ALL);
    }
}
