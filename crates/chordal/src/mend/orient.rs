//! `orient`: turns faces so that neighbours are wound consistently and closed components face outwards.
use super::mend_builder::{MendBuilder, MendFace, check_limits};
use super::mended_mesh::{MendedMesh, refusal};
use crate::Mesh;
use crate::budget::{Job, JobError, RefusalCode};
use crate::check::{Component, Facing, Finding, MeshConnectivity, Witness};
use crate::explicit::{DisjointSets, Topology, Twin, Twins};

/// The direction in which closed components inside others should face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NestedShells {
    /// As they are wound, compared to the component around them: one that faces the same way is a separate
    /// body inside it, one that faces the other way is a cavity. Solid regions stay solid.
    #[default]
    Keep,
    /// By their depth: inside an odd number of others they are cavities, inside an even number bodies.
    Cavity,
}

/// Turns faces, component by component. Here a *component* is connected by edges with exactly two faces.
///
/// - In each component neighbours are made consistent. The orientation of the majority of its faces is kept;
///   with equal numbers, that of its first face.
/// - Then closed components that no other one encloses are turned if
///   [`check::components`](crate::check::components) finds them inside out, together with those inside them
///   ([`NestedShells::Keep`]). With [`NestedShells::Cavity`] all that are found inside out are turned:
///   cavities, which lie inside an odd number of others, face inwards, however they were wound. Undecided
///   components stay as they are.
/// - A non-orientable component, such as a Möbius strip, stays as it is and is reported.
///
/// The surface does not change: bound 0. The changes are `turned_faces`; `left_unorientable`, with the first
/// face of such a component; and `left_nested_shells` or `turned_nested_shells`, with the first face of each
/// component whose depth contradicts its winding. Attributes stay with their corners; normals are not turned,
/// since they define the shading of the file.
///
/// Linear; if several closed components enclose each other, also a bounding volume hierarchy and some
/// microseconds each.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend, mend::nesting::NestedShells};
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let inside_out = Mesh::new(corners, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 3, 2]])?;
/// let mended = mend::orient(&inside_out, Topology::Indices, NestedShells::Keep, &Job::default())?;
/// assert_eq!(mended.count("turned_faces"), 3);
/// assert!(check::findings::measure(&mended.mesh).signed_volume > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn orient(
    mesh: &Mesh,
    topology: Topology,
    nested: NestedShells,
    job: &Job,
) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    let mut flips = FaceFlips { flipped: vec![false; mesh.faces().len()], components: Vec::new() };
    flips.make_consistent(&twins);
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    // Which side is outside is determined on the consistent mesh: windings of the input may contradict each
    // other.
    let consistent = flips.consistent_mesh(mesh)?;
    let components = MeshConnectivity::new(&consistent, topology).components_under(job)?;
    let ShellTurns { turned_shells, at_odds } = ShellTurns::new(&components, nested);
    flips.turn(&turned_shells, &twins);
    let mut shells = Finding::default();
    at_odds.into_iter().for_each(|face| shells.add(|| Witness::face(mesh, face)));
    let name = match nested {
        NestedShells::Keep => "left_nested_shells",
        NestedShells::Cavity => "turned_nested_shells",
    };
    let mut unorientable = Finding::default();
    for piece in flips.components.iter().filter(|piece| !piece.is_orientable) {
        unorientable.add(|| Witness::face(mesh, piece.faces[0]));
    }
    let mut turned = Finding::default();
    for (face, _) in (0..).zip(&flips.flipped).filter(|(_, turned)| **turned) {
        turned.add(|| Witness::face(mesh, face));
    }
    let changes = [("left_unorientable", unorientable), (name, shells), ("turned_faces", turned)];
    if changes[2].1.is_none() {
        return Ok(MendedMesh::exact(mesh.clone(), changes));
    }
    let mut draft = MendBuilder::without_faces(mesh);
    for (face, &turned) in (0..).zip(&flips.flipped) {
        let mend_face = MendFace::from_mesh(mesh, face);
        draft.faces.push(if turned { mend_face.flipped() } else { mend_face });
    }
    Ok(MendedMesh::exact(draft.finish()?, changes))
}

/// Faces connected by edges with two faces.
struct OrientableComponent {
    /// Ascending.
    faces: Vec<u32>,
    is_orientable: bool,
}

/// The faces to be turned.
struct FaceFlips {
    flipped: Vec<bool>,
    components: Vec<OrientableComponent>,
}

impl FaceFlips {
    /// Finds the components and makes the faces of each consistent.
    fn make_consistent(&mut self, twins: &Twins) {
        let mut visited = vec![false; self.flipped.len()];
        for start in 0..self.flipped.len() as u32 {
            if visited[start as usize] || twins.get(3 * start) == Twin::Collapsed {
                continue;
            }
            let piece = self.collect_component(start, twins, &mut visited);
            let n_turned = piece.faces.iter().filter(|&&face| self.flipped[face as usize]).count();
            // A piece that cannot be made consistent gets its original winding back. If most faces of
            // a piece were turned, the others are turned instead, so that the majority keeps its winding.
            let is_restored = !piece.is_orientable;
            let is_inverted = 2 * n_turned > piece.faces.len();
            for &face in piece.faces.iter().filter(|_| is_restored || is_inverted) {
                let turned = &mut self.flipped[face as usize];
                *turned = !is_restored && !*turned;
            }
            self.components.push(piece);
        }
    }

    /// The component of a face; inconsistent faces in it are turned.
    fn collect_component(&mut self, start: u32, twins: &Twins, visited: &mut [bool]) -> OrientableComponent {
        let mut piece = OrientableComponent { faces: vec![start], is_orientable: true };
        visited[start as usize] = true;
        // The list of the component's faces is also the queue of the search.
        let mut next = 0;
        while let Some(&face) = piece.faces.get(next) {
            next += 1;
            let turned = self.flipped[face as usize];
            for h in 3 * face..3 * face + 3 {
                let (neighbour, wanted) = match twins.get(h) {
                    Twin::Pair(t) => (t / 3, turned),
                    Twin::Flipped(t) => (t / 3, !turned),
                    Twin::Boundary | Twin::NonManifold | Twin::Collapsed => continue,
                };
                // A face that is reached again must be wound as it is already; on a Möbius strip one is
                // not.
                if !std::mem::replace(&mut visited[neighbour as usize], true) {
                    self.flipped[neighbour as usize] = wanted;
                    piece.faces.push(neighbour);
                } else if self.flipped[neighbour as usize] != wanted {
                    piece.is_orientable = false;
                }
            }
        }
        piece.faces.sort_unstable();
        piece
    }

    /// The mesh with its faces turned.
    fn consistent_mesh(&self, mesh: &Mesh) -> Result<Mesh, JobError> {
        let side =
            |(face, turned): (&[u32; 3], &bool)| if *turned { [face[0], face[2], face[1]] } else { *face };
        let faces = mesh.faces().iter().zip(&self.flipped).map(side).collect();
        let mut consistent = Mesh::new(mesh.positions().to_vec(), faces);
        if let Some(ids) = mesh.position_id() {
            consistent = consistent.and_then(|consistent| consistent.with_position_id(ids.to_vec()));
        }
        // The rows of a valid mesh, and the same number of faces, so this cannot fail.
        consistent.map_err(|error| refusal(RefusalCode::TooManyTriangles, error.to_string()))
    }

    /// Turns the components with these first faces, which are in the order of the components.
    fn turn(&mut self, turned_shells: &[u32], twins: &Twins) {
        if turned_shells.is_empty() {
            return;
        }
        // A component of [`MeshConnectivity`] may contain several of these components, which meet at edges
        // with more than two faces.
        let mut sets = DisjointSets::new(self.flipped.len());
        for h in 0..twins.len() as u32 {
            if let Twin::Pair(t) | Twin::Flipped(t) = twins.get(h) {
                sets.union(h / 3, t / 3);
            }
        }
        twins
            .non_manifold_edges()
            .for_each(|edge| edge.windows(2).for_each(|h| sets.union(h[0] / 3, h[1] / 3)));
        for (face, turned) in (0..).zip(&mut self.flipped) {
            // Components are listed in the order of their first faces.
            *turned ^= turned_shells.binary_search(&sets.find(face)).is_ok();
        }
    }
}

/// The components to be turned, given by their first faces.
struct ShellTurns {
    turned_shells: Vec<u32>,
    /// Nested components whose depth contradicts their winding.
    at_odds: Vec<u32>,
}

impl ShellTurns {
    fn new(components: &[Component], nested: NestedShells) -> Self {
        let is_inside_out = |component: &Component| component.facing == Facing::InsideOut;
        let (mut turned_shells, mut at_odds) = (Vec::new(), Vec::new());
        for component in components.iter().filter(|component| component.depth.is_some()) {
            let enclosing = component.outermost.and_then(|number| components.get(number as usize));
            // A nested component turns together with the outermost one around it.
            let turns_with_outermost =
                enclosing.map_or(component.depth == Some(0) && is_inside_out(component), is_inside_out);
            let is_at_odds = component.depth != Some(0) && turns_with_outermost != is_inside_out(component);
            at_odds.extend(is_at_odds.then_some(component.first_face));
            let turns = match nested {
                NestedShells::Keep => turns_with_outermost,
                NestedShells::Cavity => is_inside_out(component),
            };
            turned_shells.extend(turns.then_some(component.first_face));
        }
        Self { turned_shells, at_odds }
    }
}
