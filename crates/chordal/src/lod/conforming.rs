//! `simplify_conforming`: meshes that share faces, each with fewer triangles, and still with the same faces
//! shared.
use super::simplify::{ProgressiveSimplifier, SimplifyInput};
use super::surface::NONE;
use crate::budget::{
    Bound, Bounded, Budget, ErrorLimit, Failure, Job, JobError, Reference, Refusal, RefusalCode, Tolerance,
    par_map,
};
use crate::explicit::{Mesh, Topology};
use crate::math::{Box3, distance, greater, lesser};
use std::collections::BTreeMap;

/// Meshes, each with its bound.
type ConformingMeshes = Vec<Bounded<Mesh>>;

/// Meshes that share faces, as the borders of adjacent materials do, each with as few triangles as a budget allows,
/// and with the same faces shared.
///
/// A face is shared if two meshes have it with opposite windings and with the same corners bit for bit. The
/// faces that one pair of meshes shares are simplified once, as by [`simplify`](super::simplify()), and used
/// in both meshes; so are the other faces of each mesh. Vertices at which two such sets meet, and positions
/// that meshes share without a face, stay as they are, and no edge is added between two of them. Hence there
/// is no gap and no overlap along shared faces, and each mesh that is a closed manifold stays one.
///
/// With a length or pixels, which become one length for the box around all meshes, each mesh is within it.
/// With a count of triangles alone, all meshes together have at most that many, and all sets about the same
/// error. With both, the meshes are within the length, and the result is [`Failure::Unmet`] if they have more
/// triangles than the count.
///
/// *What a bound covers.* For each mesh the two-sided Hausdorff distance between the result and the input,
/// proved: the largest bound of its sets, since unions of sets within a length of each other are within that
/// length, too. The outer bound is the largest of all meshes. Not covered: whether faces that are not shared
/// pass through each other if meshes are closer than twice the bound.
///
/// *Inputs.* Meshes of positions and indices, joined by index; no attributes. If several rows of one mesh are
/// at one position, they stay as they are. The results are in the order of `meshes`.
///
/// *Cost.* A length: as for [`simplify`](super::simplify()), each shared face once; sets run in parallel,
/// with the same result on any number of threads. A count: the same for about three lengths, and 1.5 to 7 µs
/// a triangle for each length that is tried before, starting at a fraction of an edge and doubling. In
/// addition 60 bytes a triangle.
///
/// # Errors
/// [`Failure::Unmet`] with the best result if a count cannot be reached: the result within the first length
/// that comes within a twentieth of the fewest triangles; [`RefusalCode::Budget`] without a limit, with an
/// angle or limits on attributes; [`RefusalCode::Empty`] without a triangle; [`RefusalCode::Unsupported`] for
/// attributes; [`RefusalCode::TooClose`] if the box around all meshes reaches the eye;
/// [`RefusalCode::TooMuchMemory`] for more than 2³² − 1 vertices; the refusals of
/// [`check::deviation`](crate::check::deviation).
///
/// ```
/// use chordal::convert::lattices::{LabelOptions, labels_to_meshes};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::{Budget, Job, Mesh, Tolerance, lod::simplify_conforming};
/// // Two labels that fill a half of a box each.
/// let labels = (0..12 * 12 * 12).map(|at| if at % 12 < 6 { 1 } else { 2 }).collect();
/// let grid = Grid::new([12; 3], Samples::U8(labels), Affine3::IDENTITY)?;
/// let labels = labels_to_meshes(&grid, &LabelOptions::default(), &Job::default()).expect("labels");
/// let meshes: Vec<Mesh> = labels.into_iter().map(|(_, part)| part.shape).collect();
/// let budget = Budget::length(Tolerance::new(1e-6)?);
/// let bounded = simplify_conforming(&meshes, &budget, &Job::default()).expect("reachable");
/// assert!(bounded.bound.at_most().unwrap() <= 1e-6);
/// // Of 528 triangles each, 242 of them shared.
/// assert!(bounded.shape.iter().all(|simplified| simplified.shape.faces().len() < 300));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source of the fixed borders between sets: those of tiles in [`tree`](super::tiling::tree).
pub fn simplify_conforming(
    meshes: &[Mesh],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<ConformingMeshes>, Failure<ConformingMeshes>> {
    check(meshes, budget)?;
    let bounds = meshes.iter().fold(Box3::EMPTY, |all, mesh| all.union(mesh.bounds()));
    let Some(length) = budget.length_in(&bounds) else {
        let message = "the meshes come so close to the eye that there is no bound in pixels";
        return Err(Failure::refused(RefusalCode::TooClose, message));
    };
    let complex = InterfaceComplex::new(meshes)?;
    let results = job.run(|| match (Tolerance::new(length), budget.triangles) {
        (Ok(length), _) => complex.simplify_within(length.get(), &[], job),
        (Err(_), Some(most)) => complex.simplify_to_count(most, bounds.diagonal(), job),
        (Err(_), None) => {
            let message = "the budget has no limit: no length, no pixels, no triangles";
            Err(JobError::Refused(Refusal::new(RefusalCode::Budget, message)))
        }
    })?;
    let results = complex.joined(&results);
    let mut worst = Bound::exact(Reference::InputTriangles);
    for Bounded { bound, .. } in &results {
        worst = if bound.at_most() > worst.at_most() { bound.clone() } else { worst };
    }
    if meshes.len() > 1 {
        // A point may be nearer to another mesh, so nothing is known from below.
        worst = Bound::proved(0.0, worst.at_most().unwrap_or(f64::INFINITY), Reference::InputTriangles);
    }
    worst.pixels = budget.pixels.and_then(|px| px.view.pixels_of(worst.at_most()?, &bounds));
    let n = results.iter().map(|result| result.shape.faces().len() as u64).sum::<u64>();
    let result = Bounded { shape: results, bound: worst };
    if budget.triangles.is_some_and(|most| n > most) {
        Err(Failure::Unmet(Box::new(result)))
    } else {
        Ok(result)
    }
}

fn check(meshes: &[Mesh], budget: &Budget) -> Result<(), JobError> {
    let refused = |code, message: &str| Err(JobError::Refused(Refusal::new(code, message)));
    if budget.angle_deg.is_some() || budget.attributes.is_set() {
        let message =
            "meshes that share faces have no budget for angles and attributes: only distances are bounded";
        return refused(RefusalCode::Budget, message);
    }
    if meshes.iter().any(|mesh| !mesh.attributes().is_empty()) {
        let message = "meshes that share faces are simplified by their positions alone and must have no \
             attributes";
        return refused(RefusalCode::Unsupported, message);
    }
    if meshes.iter().all(|mesh| mesh.faces().is_empty()) {
        return refused(RefusalCode::Empty, "there is no triangle to simplify");
    }
    let n_rows = meshes.iter().map(|mesh| mesh.positions().len()).sum::<usize>();
    if n_rows >= NONE as usize {
        let message = "meshes that share faces have at most 2^32 - 1 vertices together";
        return refused(RefusalCode::TooMuchMemory, message);
    }
    Ok(())
}

/// The first length that is tried for a count, as a fraction of the mean edge. Chosen: steps of voxels are flattened
/// within less than half of one.
const FIRST: f64 = 0.25;
/// No length below this fraction of the extent is tried: at most 40 are. Exact: 2⁻⁴⁰.
const SHORTEST: f64 = 1.0 / 1_099_511_627_776.0;
/// If no length reaches the count, aim for this multiple of the fewest triangles that were reached. Chosen: a
/// smaller multiple saves few triangles for a much larger error.
const NEARLY: f64 = 1.05;
/// The ratio of the lengths that are tried for a count. Chosen: a smaller ratio tries more lengths, each of
/// which takes time.
const FACTOR: f64 = 2.0;
/// While a length is searched, a set of faces with less than this fraction of its share of the count is not
/// simplified further. Chosen: curved sets have more than their share within a length, and flat ones less.
const FEW: f64 = 0.25;

/// The faces that one pair of meshes shares, or the faces of one mesh that it does not share.
struct Interface {
    /// The mesh of the faces, and the mesh that has them with opposite winding, or [`NONE`].
    sides: [u32; 2],
    mesh: Mesh,
    /// By row: the number of its position.
    vertices: Vec<u32>,
    /// By row: whether it is fixed. Empty if none is.
    fixed: Vec<bool>,
}

/// An interface with fewer triangles.
struct SimplifiedInterface {
    mesh: Mesh,
    /// By row: the number of the fixed position there, or [`NONE`].
    vertices: Vec<u32>,
    bound: Bound,
}

impl Interface {
    /// The number of meshes that have the faces.
    fn n_sides(&self) -> u64 {
        if self.sides[1] == NONE { 1 } else { 2 }
    }

    fn input<'a>(&'a self, length: f64, job: &'a Job) -> SimplifyInput<'a> {
        SimplifyInput {
            mesh: &self.mesh,
            topology: Topology::Indices,
            fixed_rows: &self.fixed,
            limit: ErrorLimit::uniform(length),
            attributes: Default::default(),
            job,
        }
    }

    /// As few triangles as fit within a length, or `enough` of them.
    fn simplify(&self, length: f64, enough: usize, job: &Job) -> Result<SimplifiedInterface, JobError> {
        let input = self.input(length, job);
        let mut progress = ProgressiveSimplifier::new(&input)?.with_enough(enough);
        Ok(match progress.simplify_within(&input.limit, job)? {
            Some(Bounded { shape, bound }) => {
                let vertex = |row: u32| if row == NONE { NONE } else { self.vertices[row as usize] };
                let vertices = progress.fixed_rows().into_iter().map(vertex).collect();
                SimplifiedInterface { mesh: shape.mesh, vertices, bound }
            }
            None => {
                let bound = Bound::exact(Reference::InputTriangles);
                SimplifiedInterface { mesh: self.mesh.clone(), vertices: self.vertices.clone(), bound }
            }
        })
    }

    /// The number of triangles for each of some growing lengths; once it is at most `few`, that number for
    /// all longer ones.
    fn counts(&self, lengths: &[f64], few: f64, job: &Job) -> Result<Vec<usize>, JobError> {
        let mut n = self.mesh.faces().len();
        let mut counts = Vec::with_capacity(lengths.len());
        let Some(first) = lengths.first() else { return Ok(counts) };
        let mut progress = ProgressiveSimplifier::new(&self.input(*first, job))?;
        for length in lengths {
            if n as f64 > few {
                let fewer = progress.simplify_within(&ErrorLimit::uniform(*length), job)?;
                n = fewer.map_or(n, |fewer| fewer.shape.mesh.faces().len());
            }
            counts.push(n);
        }
        Ok(counts)
    }
}

/// Meshes as the interfaces between them.
struct InterfaceComplex<'a> {
    meshes: &'a [Mesh],
    interfaces: Vec<Interface>,
    n_vertices: usize,
}

impl<'a> InterfaceComplex<'a> {
    fn new(meshes: &'a [Mesh]) -> Result<Self, JobError> {
        let SharedVertices { vertices, mut is_fixed } = SharedVertices::new(meshes);
        let n_vertices = is_fixed.len();
        let mut sets: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (mesh, across) in shared_faces(meshes, &vertices).into_iter().enumerate() {
            for (face, other) in across.into_iter().enumerate() {
                // The other mesh adds the faces as well.
                if other == NONE || other as usize > mesh {
                    sets.entry([mesh as u32, other]).or_default().push(face as u32);
                }
            }
        }
        let mut first = vec![NONE; n_vertices];
        for (number, ([mesh, _], faces)) in (0_u32..).zip(&sets) {
            let rows = faces.iter().flat_map(|face| meshes[*mesh as usize].faces()[*face as usize]);
            for vertex in rows.map(|row| vertices[*mesh as usize][row as usize] as usize) {
                // A position of two interfaces is where they meet.
                is_fixed[vertex] |= first[vertex] != NONE && first[vertex] != number;
                first[vertex] = number;
            }
        }
        let interface = |(sides, faces): ([u32; 2], Vec<u32>)| {
            let (mesh, vertices) = (&meshes[sides[0] as usize], &vertices[sides[0] as usize]);
            let rows = mesh.rows_of(&faces);
            let vertices: Vec<u32> = rows.iter().map(|row| vertices[*row as usize]).collect();
            let mut fixed: Vec<bool> = vertices.iter().map(|vertex| is_fixed[*vertex as usize]).collect();
            if !fixed.contains(&true) {
                fixed.clear();
            }
            Interface { sides, mesh: mesh.some_faces(&faces, &rows), vertices, fixed }
        };
        Ok(Self { meshes, interfaces: sets.into_iter().map(interface).collect(), n_vertices })
    }

    /// Each interface simplified within a length, down to `enough` triangles each, or as few as possible.
    fn simplify_within(
        &self,
        length: f64,
        enough: &[usize],
        job: &Job,
    ) -> Result<Vec<SimplifiedInterface>, JobError> {
        let simplify_one = |at: usize, interface: &Interface| {
            interface.simplify(length, enough.get(at).copied().unwrap_or(0), job)
        };
        par_map(job, &self.interfaces, simplify_one).into_iter().collect()
    }

    /// The number of triangles of all meshes, from the number of each interface.
    fn total(&self, count: impl Fn(usize) -> usize) -> u64 {
        let n = |(at, interface): (usize, &Interface)| interface.n_sides() * count(at) as u64;
        self.interfaces.iter().enumerate().map(n).sum()
    }

    /// At most `most` triangles, within about the shortest length for which there are so few.
    fn simplify_to_count(
        &self,
        most: u64,
        extent: f64,
        job: &Job,
    ) -> Result<Vec<SimplifiedInterface>, JobError> {
        let before = |at: usize| self.interfaces[at].mesh.faces().len();
        let n_before = self.total(before);
        // 1. Growing lengths, until there are few enough triangles.
        let shortest = greater(FIRST * self.mean_edge(), SHORTEST * extent);
        let mut lengths = vec![lesser(shortest, extent)];
        while let Some(last) = lengths.last().filter(|last| **last < extent && n_before > most) {
            lengths.push(lesser(FACTOR * last, extent));
        }
        // An interface without a share would be simplified for lengths that the others do not need.
        let share = FEW * most as f64 / n_before as f64;
        let counts = par_map(job, &self.interfaces, |_, interface| {
            interface.counts(&lengths, share * interface.mesh.faces().len() as f64, job)
        });
        let counts: Vec<Vec<usize>> = counts.into_iter().collect::<Result<_, _>>()?;
        // A longer length that removes hardly any triangle is not worth its distance.
        let total = |step: usize| self.total(|at| counts[at][step]);
        let fewest = total(lengths.len() - 1);
        let most = if fewest > most { (NEARLY * fewest as f64) as u64 } else { most };
        let step = (0..lengths.len()).find(|step| total(*step) <= most).unwrap_or(lengths.len() - 1);
        // 2. A number of triangles for each interface, between its numbers for the last two lengths.
        let after = |at: usize| counts[at][step];
        let before = |at: usize| if step == 0 { before(at) } else { counts[at][step - 1] };
        let (n_before, n_after) = (self.total(before), self.total(after));
        let part = if n_before > n_after && most > n_after {
            lesser((most - n_after) as f64 / (n_before - n_after) as f64, 1.0)
        } else {
            0.0
        };
        let enough: Vec<usize> = (0..self.interfaces.len())
            .map(|at| after(at) + (part * before(at).saturating_sub(after(at)) as f64) as usize)
            .collect();
        // 3. The result within the shortest of a few lengths that reaches these numbers.
        // Halfway between this length and the one before it, on a logarithmic scale.
        let between = lengths[step] / FACTOR.sqrt();
        let mut fewest: Option<(u64, Vec<SimplifiedInterface>)> = None;
        for length in std::iter::once(&between).chain(&lengths[step..]) {
            let simplified = self.simplify_within(*length, &enough, job)?;
            let n = self.total(|at| simplified[at].mesh.faces().len());
            if fewest.as_ref().is_none_or(|(least, _)| n < *least) {
                fewest = Some((n, simplified));
            }
            if n <= most {
                break;
            }
        }
        Ok(fewest.map(|(_, simplified)| simplified).unwrap_or_default())
    }

    /// The mean length of an edge.
    fn mean_edge(&self) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for mesh in self.interfaces.iter().map(|interface| &interface.mesh) {
            for face in 0..mesh.faces().len() {
                let [a, b, c] = mesh.corners(face);
                sum += [[a, b], [b, c], [c, a]].map(|[p, q]| distance(q, p)).iter().sum::<f64>();
                n += 3.0;
            }
        }
        if n > 0.0 { sum / n } else { 0.0 }
    }

    /// Each mesh, joined from its interfaces.
    fn joined(&self, simplified: &[SimplifiedInterface]) -> Vec<Bounded<Mesh>> {
        // Entries of earlier meshes are told by their number, so that the list is not cleared between meshes.
        let mut row_of = vec![(NONE, NONE); self.n_vertices];
        let mut with: Vec<Vec<(usize, bool)>> = vec![Vec::new(); self.meshes.len()];
        for (at, Interface { sides: [front, back], .. }) in self.interfaces.iter().enumerate() {
            with[*front as usize].push((at, false));
            if let Some(with) = with.get_mut(*back as usize) {
                with.push((at, true));
            }
        }
        let join = |(mesh, with): (usize, Vec<(usize, bool)>)| {
            let (mut positions, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = Default::default();
            let mut bound = Bound::exact(Reference::InputTriangles);
            for (at, is_turned) in &with {
                let part = &simplified[*at];
                let mut row = |(vertex, position): (&u32, &[f64; 3])| {
                    let new = positions.len() as u32;
                    // `NONE` has no entry: such a row is in this interface alone.
                    if let Some(entry) = row_of.get_mut(*vertex as usize) {
                        if entry.0 == mesh as u32 {
                            return entry.1;
                        }
                        *entry = (mesh as u32, new);
                    }
                    positions.push(*position);
                    new
                };
                let rows: Vec<u32> = part.vertices.iter().zip(part.mesh.positions()).map(&mut row).collect();
                faces.extend(part.mesh.faces().iter().map(|face| {
                    let [a, b, c] = face.map(|row| rows[row as usize]);
                    if *is_turned { [a, c, b] } else { [a, b, c] }
                }));
                bound = if part.bound.at_most() > bound.at_most() { part.bound.clone() } else { bound };
            }
            if with.len() > 1 {
                // A point may be nearer to another interface, so nothing is known from below.
                let at = bound.at;
                bound =
                    Bound::proved(0.0, bound.at_most().unwrap_or(f64::INFINITY), Reference::InputTriangles);
                bound.at = at;
            }
            Bounded { shape: Mesh::by_construction(positions, faces), bound }
        };
        with.into_iter().enumerate().map(join).collect()
    }
}

/// The positions of all meshes, each with one number.
struct SharedVertices {
    /// By mesh and row.
    vertices: Vec<Vec<u32>>,
    /// By number: whether a mesh has it twice.
    is_fixed: Vec<bool>,
}

impl SharedVertices {
    fn new(meshes: &[Mesh]) -> Self {
        // The sign of a zero is no difference.
        let key = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
        let rows = |(mesh, rows): (u32, &Mesh)| {
            rows.positions().iter().zip(0..).map(move |(p, row)| (key(p), [mesh, row])).collect::<Vec<_>>()
        };
        let mut keyed_rows: Vec<([u64; 3], [u32; 2])> = (0..).zip(meshes).flat_map(rows).collect();
        keyed_rows.sort_unstable();
        let mut vertices: Vec<Vec<u32>> =
            meshes.iter().map(|mesh| vec![NONE; mesh.positions().len()]).collect();
        let mut is_fixed = Vec::new();
        for same_position in keyed_rows.chunk_by(|a, b| a.0 == b.0) {
            // If a mesh has two rows here, nobody knows which one is shared.
            let is_double = same_position.windows(2).any(|pair| pair[0].1[0] == pair[1].1[0]);
            for (at, (_, [mesh, row])) in same_position.iter().enumerate() {
                if at == 0 || is_double {
                    is_fixed.push(is_double);
                }
                vertices[*mesh as usize][*row as usize] = is_fixed.len() as u32 - 1;
            }
        }
        Self { vertices, is_fixed }
    }
}

/// By mesh and face: the mesh that has the same face turned around, if it is the only one, or [`NONE`].
fn shared_faces(meshes: &[Mesh], vertices: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut keyed_faces: Vec<([u32; 3], [u32; 2], bool)> = Vec::new();
    for (mesh, (mesh_of_faces, vertices)) in (0..).zip(meshes.iter().zip(vertices)) {
        for (face, rows) in (0..).zip(mesh_of_faces.faces()) {
            let corners = rows.map(|row| vertices[row as usize]);
            let mut sorted = corners;
            sorted.sort_unstable();
            // Whether the face visits its sorted corners in cyclic order, which gives its winding.
            let first = corners.iter().position(|corner| *corner == sorted[0]).unwrap_or(0);
            keyed_faces.push((sorted, [mesh, face], corners[(first + 1) % 3] == sorted[1]));
        }
    }
    keyed_faces.sort_unstable();
    let mut across: Vec<Vec<u32>> = meshes.iter().map(|mesh| vec![NONE; mesh.faces().len()]).collect();
    for same_corners in keyed_faces.chunk_by(|a, b| a.0 == b.0) {
        if let [(corners, a, front), (_, b, back)] = same_corners
            && front != back
            && a[0] != b[0]
            && corners[0] != corners[1]
            && corners[1] != corners[2]
        {
            across[a[0] as usize][a[1] as usize] = b[0];
            across[b[0] as usize][b[1] as usize] = a[0];
        }
    }
    across
}
