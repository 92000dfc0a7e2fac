//! The repairs that `inspect` recommends: repairs that helped when they were tried on the triangles.
use super::{RepairStep, trial_steps};
use crate::scene::placements::part_scales;
use chordal::Job;
use chordal::budget::advice::Cure;
use chordal::check::Defect;
use chordal::check::findings::MeshConnectivity;
use chordal::explicit::Topology;
use chordal_io::{Format, Scene};

/// The options of `chordal mend` that help a scene read from a file of that format, in the order of application; `None` if
/// the job was stopped.
///
/// Each repair is tried on the result of the ones before. It is recommended if it changes something, leaves triangles, and
/// makes no kind of fault more frequent, except faults that it may expose ([`may_expose`]) and that later repairs remove. So
/// every recommended repair changes something, and following the recommendations terminates.
///
/// Splitting a surface is not recommended if the format ties equal positions again.
///
/// Cost: the repairs that are tried, and two validity checks each; nothing for valid triangles.
pub(crate) fn recommend_repairs(scene: &Scene, format: Format, job: &Job) -> Option<Vec<Cure>> {
    let mut trial = RepairTrial {
        scene: scene.clone(),
        stretch: part_scales(scene),
        topologies: vec![format.topology(); scene.parts.len()],
        faults: Vec::new(),
        cures: Vec::new(),
    };
    trial.faults = trial.count_faults();
    let ties = format.topology() == Topology::Positions;
    for cure in trial_steps() {
        let skipped = match cure {
            // Such a format ties equal positions, so that there is nothing to weld, and splits are lost.
            RepairStep::Weld(_) | RepairStep::SplitNonManifold => ties,
            // A crack along T-junctions is not a hole, and a one-sided piece has no inside to close.
            RepairStep::FillHoles(_) => trial.count(Defect::TJunctions) > 0 || !trial.is_orientable(),
            _ => false,
        };
        if !skipped {
            // On what the repairs before it have left: by itself it may do nothing, or harm.
            trial.attempt(cure, job)?;
        }
    }
    Some(Cure::ALL.into_iter().filter(|cure| trial.cures.contains(cure)).collect())
}

/// The state of the triangles between repairs.
struct RepairTrial {
    scene: Scene,
    /// By part: the largest factor by which its nodes lengthen.
    stretch: Vec<f64>,
    topologies: Vec<Topology>,
    /// The count of each of [`FAULTS`].
    faults: Vec<u64>,
    /// The repairs that helped.
    cures: Vec<Cure>,
}

/// Faults that no repair may make more frequent. Duplicate vertices and slivers are only remarks, and the other defects
/// take a search.
const FAULTS: [Defect; 9] = [
    Defect::BoundaryEdges,
    Defect::NonManifoldEdges,
    Defect::NonManifoldVertices,
    Defect::TJunctions,
    Defect::InconsistentEdges,
    Defect::DuplicateFaces,
    Defect::CollapsedFaces,
    Defect::ZeroAreaFaces,
    Defect::UnusedVertices,
];

/// Whether a repair may expose a defect that was there before, hidden by a defect that the repair removes.
fn may_expose(cure: RepairStep, defect: Defect) -> bool {
    match defect {
        // Copies of an edge with three faces become boundaries; a face that is dropped, or cut, leaves its edges open.
        Defect::BoundaryEdges => {
            !matches!(cure, RepairStep::Weld(_) | RepairStep::Orient(_) | RepairStep::FillHoles(_))
        }
        // At an edge with three faces, consistency is not defined.
        Defect::InconsistentEdges => {
            matches!(
                cure,
                RepairStep::SplitNonManifold
                    | RepairStep::DropDuplicates(_)
                    | RepairStep::ResolveTJunctions(_)
            )
        }
        // A face between equal points has no area before and after, but without tied indices it does not count as collapsed.
        Defect::CollapsedFaces => matches!(cure, RepairStep::Weld(_)),
        Defect::UnusedVertices => matches!(cure, RepairStep::DropDuplicates(_) | RepairStep::DropDegenerate),
        _ => false,
    }
}

impl RepairTrial {
    /// Applies a repair, and reverts it if it does not help. `None` if the job was stopped.
    fn attempt(&mut self, cure: RepairStep, job: &Job) -> Option<()> {
        let (mut scene, mut topologies) = (self.scene.clone(), self.topologies.clone());
        let (facts, _) = cure.apply(&mut scene, &self.stretch, &mut topologies, job).ok()?;
        // What begins so counts places that a repair found and did not touch.
        let changed = facts.changes.iter().any(|change| !change.what.starts_with("left_"));
        if !changed || scene.parts.iter().all(|part| part.mesh.faces().is_empty()) {
            return Some(());
        }
        let before =
            (std::mem::replace(&mut self.scene, scene), std::mem::replace(&mut self.topologies, topologies));
        let faults = self.count_faults();
        let is_worse = FAULTS
            .iter()
            .zip(self.faults.iter().zip(&faults))
            .any(|(defect, (was, is))| is > was && !may_expose(cure, *defect));
        if is_worse {
            (self.scene, self.topologies) = before;
            return Some(());
        }
        self.faults = faults;
        self.cures.push(cure.cure());
        Some(())
    }

    fn count(&self, defect: Defect) -> u64 {
        FAULTS.iter().zip(&self.faults).find(|(fault, _)| **fault == defect).map_or(0, |(_, count)| *count)
    }

    fn count_faults(&self) -> Vec<u64> {
        let mut totals = vec![0; FAULTS.len()];
        for (part, topology) in self.scene.parts.iter().zip(&self.topologies) {
            let surface = MeshConnectivity::new(&part.mesh, *topology);
            let validity = surface.validity();
            let counts = [
                validity.boundary_edges.count,
                validity.non_manifold_edges.count,
                validity.non_manifold_vertices.count,
                surface.t_junctions(None).count,
                validity.inconsistent_edges.count,
                validity.duplicate_faces.count,
                validity.collapsed_faces.count,
                validity.zero_area_faces.count,
                validity.unused_vertices.count,
            ];
            totals.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
        totals
    }

    fn is_orientable(&self) -> bool {
        let mut parts = self.scene.parts.iter().zip(&self.topologies);
        parts.all(|(part, topology)| MeshConnectivity::new(&part.mesh, *topology).validity().orientable)
    }
}
