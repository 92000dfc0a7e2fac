//! Trimmed surfaces as one mesh: patches near each surface, polygons near its loops, sewn, cut into cells, triangulated,
//! joined.
use super::fit::fit;
use super::prepared_face::PreparedFace;
use super::sew::{TrimmedFace, sew};
use super::sewn_faces::same_vertices;
use super::trim_cells::{FaceTriangles, TrimConflict, triangulate};
use super::trim_loops::TrimPieces;
use super::uncovered::uncovered;
use crate::budget::{Failure, Job, RefusalCode, par_map, par_map_owned};
use crate::convert::patches::assemble::{COS_SAME_NORMAL, fill_missing_normals, mesh_with_normals};
use crate::explicit::Mesh;
use crate::explicit::nurbs::TrimmedSurface;
use crate::math::{Box3, distance, greater};
use glam::DVec3;

/// The shares of a length for patches, loops and sewing. Chosen: the number of triangles is inverse to the rest of the
/// length.
const PATCHES: f64 = 0.05;
const LOOPS: f64 = 0.3;
const SEWING: f64 = 0.25;
/// The first share for triangles. Chosen: a little more than the rest, since the others seldom use their shares up.
const TRIANGLES: f64 = 0.55;
/// The share for the loops of a plane, whose triangles are exact, or for the triangles between straight loops.
const ONLY: f64 = 0.85;
/// Loops and surfaces that bend by less than this share of the length count as straight.
const STRAIGHT: f64 = 0.05;
/// Sewing is limited to this part of the diagonal even if the length would allow more. Chosen: wider gaps are meant.
const NEAREST: f64 = 1e-4;
/// The most cells of all faces. Chosen: so many take some GB and a minute; if the budget needs more, the mesh is coarser.
const MOST_CELLS: u64 = 1 << 23;
/// The length for triangles is then multiplied by this. Chosen: it halves the cells in each direction.
const COARSER: f64 = 4.0;
/// A mesh that uses less of the length than this is made again with larger triangles, so many times at most. Chosen:
/// more rounds would save few triangles.
const USED: f64 = 0.9;
const LARGER: usize = 2;
/// The most meshes until one is within the length. Chosen: estimates are close after a few.
const ROUNDS: usize = 5;

/// A mesh, and a bound for its distance from its surfaces.
pub(in crate::convert) struct TrimmedMesh {
    pub mesh: Mesh,
    pub at_most: f64,
    /// The middle of the triangle with the largest bound, if there is one.
    pub worst: Option<[f64; 3]>,
}

/// The triangles of one face and their errors.
struct BoundedFace {
    triangles: Vec<[u32; 3]>,
    /// Edges and vertices of loops without a triangle beside them.
    stray: Vec<[u32; 2]>,
    /// The positions of the vertices that are not on a loop.
    inner: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    /// The error of triangles.
    bending: f64,
    /// The error of patches, polygons and rounding.
    other_error: f64,
    worst: Option<[f64; 3]>,
}

/// A mesh within a length of surfaces, or the nearest of all rounds.
pub(in crate::convert) fn mesh_within(
    faces: &[TrimmedSurface],
    length: f64,
    bounds: &Box3,
    job: &Job,
) -> Result<TrimmedMesh, Failure<Mesh>> {
    let fitted = par_map(job, faces, |_, face| {
        let pieces = TrimPieces::new(face.surface(), face.loops());
        let fitted = fit(face.surface(), PATCHES * length, &job.clone().with_threads(1));
        PreparedFace::new(face, pieces, fitted)
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let rounding_of = |face: &PreparedFace| face.lattice.rounding + 5.0 * face.lattice.parameter_rounding;
    let rounding = fitted.iter().map(rounding_of);
    let rounding = rounding.fold(0.0, greater);
    if rounding >= length {
        let message = format!(
            "rounding alone can lose {rounding:.1e}, so no mesh in double precision can be proved to meet the budget"
        );
        return Err(Failure::refused(RefusalCode::BelowPrecision, message));
    }
    let mut prepared = fitted;
    let near = {
        let most_near = NEAREST * bounds.diagonal();
        let sewing_share = SEWING * length;
        if sewing_share < most_near { sewing_share } else { most_near }
    };
    let mut best: Option<TrimmedMesh> = None;
    let mut scale = 1.0;
    let most = (job.memory_limit / CELL_BYTES).min(job.triangle_limit).min(MOST_CELLS);
    'rounds: for round in 0..ROUNDS {
        while cut(faces, &mut prepared, scale, length, job) > most {
            // The next mesh would be too large; an earlier one is there already.
            if best.is_some() {
                break 'rounds;
            }
            if job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            // With a length above the diagonal the triangles are as few as possible: a few for each patch.
            if scale * length > bounds.diagonal() {
                return Err(too_many(&prepared, most, job));
            }
            scale *= COARSER;
        }
        let (round_mesh, bending, returned) = one_round(faces, prepared, length, near, job)?;
        prepared = returned;
        let at_most = round_mesh.at_most;
        let is_better = best.as_ref().is_none_or(|best| match (at_most <= length, best.at_most <= length) {
            (true, true) => round_mesh.mesh.faces().len() < best.mesh.faces().len(),
            (false, false) => at_most < best.at_most,
            (is_met, _) => is_met,
        });
        if is_better {
            best = Some(round_mesh);
        }
        // The rest of the length after patches, loops and sewing.
        let allowance = length - (at_most - bending);
        let is_used = at_most > USED * length || round >= LARGER;
        if at_most <= length && is_used || allowance <= 0.0 || bending <= 0.0 {
            break;
        }
        // Errors are proportional to the expected length.
        scale *= 0.95 * allowance / bending;
    }
    best.ok_or(Failure::Cancelled)
}

/// Cuts all faces into cells for triangles with an expected distance of a share of the length; the number of cells.
fn cut(
    faces: &[TrimmedSurface],
    prepared: &mut Vec<PreparedFace>,
    scale: f64,
    length: f64,
    job: &Job,
) -> u64 {
    let pairs: Vec<(&TrimmedSurface, PreparedFace)> = faces.iter().zip(std::mem::take(prepared)).collect();
    *prepared = par_map_owned(job, pairs, |(surface, mut face)| {
        let is_straight = face.pieces.bulge(&face.lattice) <= STRAIGHT * length;
        face.cut(surface, scale * length * if is_straight { ONLY } else { TRIANGLES }, job);
        face
    });
    let counts = prepared.iter().map(|face| face.lattice.cells.count() as u64);
    counts.fold(0, u64::saturating_add)
}

/// One mesh of faces that are cut into cells, and the part of its bound from triangles.
fn one_round(
    surfaces: &[TrimmedSurface],
    prepared: Vec<PreparedFace>,
    length: f64,
    near: f64,
    job: &Job,
) -> Result<(TrimmedMesh, f64, Vec<PreparedFace>), Failure<Mesh>> {
    let mut loops = Vec::new();
    let mut faces = Vec::with_capacity(prepared.len());
    for (prepared, surface) in prepared.into_iter().zip(surfaces) {
        // Loops of a face that hardly bends may take nearly all of the length.
        let is_flat = prepared.lattice.bending() <= STRAIGHT * length;
        loops.push(length * if is_flat { ONLY } else { LOOPS });
        let polygons = prepared.pieces.polygons(&prepared.lattice);
        let net = surface.surface().bezier_net();
        let mut face = TrimmedFace { net, prepared, polygons, positions: Vec::new() };
        face.positions = face.polygons.vertices.iter().map(|at| face.surface_point(*at)).collect();
        faces.push(face);
    }
    let sewn = sew(&mut faces, &loops, near, job);
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let indices: Vec<usize> = (0..faces.len()).collect();
    let results = par_map(job, &indices, |_, index| {
        triangulate(&faces[*index].prepared.lattice, &faces[*index].polygons)
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let mut triangles = Vec::with_capacity(results.len());
    for (index, result) in results.into_iter().enumerate() {
        triangles.push(result.map_err(|conflict| refusal(index, &faces[index], conflict))?);
    }
    let same = same_vertices(&faces, &triangles, &sewn);
    let moved = moved_to(&faces, &same);
    let bounded = par_map(job, &indices, |_, index| {
        let face = &faces[*index];
        let first = sewn.first[*index] as usize;
        let targets = &moved[first..first + face.positions.len()];
        bounded_face(face, &triangles[*index], targets, surfaces[*index].is_flipped())
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let bending = bounded.iter().fold(0.0, |most: f64, face| greater(face.bending, most));
    let mesh = join(&faces, &sewn.first, &same, &moved, bounded)?;
    let prepared = faces.into_iter().map(|face| face.prepared).collect();
    Ok((mesh, bending, prepared))
}

/// The refusal if even the coarsest mesh has too many cells.
fn too_many(prepared: &[PreparedFace], most: u64, job: &Job) -> Failure<Mesh> {
    let least: u64 = prepared.iter().map(|face| face.lattice.cells.count() as u64).sum();
    let (code, limit) = if most < job.triangle_limit {
        (RefusalCode::TooMuchMemory, "the memory allows")
    } else {
        (RefusalCode::TooManyTriangles, "the limit is")
    };
    let message = format!("the surfaces need at least {least} cells for this length, and {limit} {most}");
    Failure::refused(code, message)
}

/// The memory of a cell until its triangles are joined. Measured: some 150 bytes for a triangle.
const CELL_BYTES: u64 = 400;

/// The new position of each vertex of a loop: the position of the first vertex of its set.
fn moved_to(faces: &[TrimmedFace<'_>], same: &[u32]) -> Vec<[f64; 3]> {
    let positions: Vec<[f64; 3]> = faces.iter().flat_map(|face| face.positions.iter().copied()).collect();
    same.iter().map(|leader| positions[*leader as usize]).collect()
}

/// The triangles of a face with their errors.
fn bounded_face(
    face: &TrimmedFace<'_>,
    triangles: &FaceTriangles,
    targets: &[[f64; 3]],
    is_flipped: bool,
) -> BoundedFace {
    let n_border = targets.len();
    let lattice = &face.prepared.lattice;
    let positions: Vec<[f64; 3]> = triangles.vertices.iter().map(|at| lattice.position(*at)).collect();
    let turned = |normal: [f64; 3]| if is_flipped { normal.map(|x| -x) } else { normal };
    let normals =
        triangles.vertices.iter().map(|at| turned(lattice.normal(*at).unwrap_or_default())).collect();
    // A few roundings of a length.
    let moved: Vec<f64> =
        (0..n_border).map(|k| distance(positions[k], targets[k]) * (1.0 + 8.0 * f64::EPSILON)).collect();
    let shift = |corners: &[u32]| {
        let moves = corners.iter().filter_map(|k| moved.get(*k as usize));
        moves.fold(0.0, |most: f64, moved| greater(*moved, most))
    };
    let (mut bending, mut worst) = (0.0, None);
    for (corners, patch) in &triangles.triangles {
        let places = corners.map(|k| triangles.vertices[k as usize]);
        let at = corners.map(|k| positions[k as usize]);
        let bound = lattice.triangle_bound(*patch, places, at) + shift(corners);
        if bound > bending {
            bending = bound;
            worst = Some(std::array::from_fn(|k| (at[0][k] + at[1][k] + at[2][k]) / 3.0));
        }
        // The comparison above is false for NaN.
        if bound.is_nan() {
            bending = f64::INFINITY;
        }
    }
    // Vertices of polygons at no triangle, and edges beside no triangle.
    let mut is_used = vec![false; n_border];
    let corners = triangles.triangles.iter().flat_map(|(t, _)| t).filter(|k| (**k as usize) < n_border);
    corners.for_each(|k| is_used[*k as usize] = true);
    let alone = triangles.same.iter().filter(|k| !is_used[**k as usize]).map(|k| [*k; 2]);
    let stray: Vec<[u32; 2]> = triangles.stray.iter().map(|(edge, _)| *edge).chain(alone).collect();
    let stray_bounds = triangles.stray.iter().map(|(edge, patch)| {
        let places = edge.map(|k| triangles.vertices[k as usize]);
        lattice.edge_bound(*patch, places, edge.map(|k| positions[k as usize]))
    });
    let stray_bounds =
        stray_bounds.chain(std::iter::repeat(0.0)).zip(&stray).map(|(bending, edge)| bending + shift(edge));
    bending = stray_bounds.fold(bending, greater);
    let other_error =
        face.prepared.patch_error + face.polygons.loop_error + lattice.rounding + lattice.parameter_rounding;
    let ordered = |t: [u32; 3]| if is_flipped { [t[0], t[2], t[1]] } else { t };
    BoundedFace {
        triangles: triangles.triangles.iter().map(|(t, _)| ordered(*t)).collect(),
        stray,
        inner: positions[n_border..].to_vec(),
        normals,
        bending,
        other_error,
        worst,
    }
}

/// All faces as one mesh.
fn join(
    faces: &[TrimmedFace<'_>],
    first: &[u32],
    same: &[u32],
    moved: &[[f64; 3]],
    bounded: Vec<BoundedFace>,
) -> Result<TrimmedMesh, Failure<Mesh>> {
    // The positions of loops' vertices, then of vertices within faces.
    let n_border = same.len() as u32;
    let mut positions: Vec<[f64; 3]> = moved.to_vec();
    let (mut corners, mut flat): (Vec<[u32; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let mut normals: Vec<[f64; 3]> = vec![[0.0; 3]; positions.len()];
    let (mut at_most, mut worst) = (0.0, None);
    for (index, face) in bounded.iter().enumerate() {
        let (first, n_loop_vertices) = (first[index], faces[index].positions.len() as u32);
        let inner = positions.len() as u32;
        positions.extend_from_slice(&face.inner);
        for (k, normal) in face.normals.iter().enumerate() {
            let k = k as u32;
            if k < n_loop_vertices { normals[(first + k) as usize] = *normal } else { normals.push(*normal) }
        }
        let number = |k: u32| if k < n_loop_vertices { first + k } else { inner + (k - n_loop_vertices) };
        corners.extend(face.triangles.iter().map(|t| t.map(number)));
        flat.extend(face.stray.iter().map(|[a, b]| [*a, *b, *b].map(number)));
        // Derived: a few roundings of sums.
        let total = (face.bending + face.other_error) * (1.0 + 8.0 * f64::EPSILON);
        if total > at_most || total.is_nan() {
            (at_most, worst) = (if total.is_nan() { f64::INFINITY } else { total }, face.worst);
        }
    }
    let leader = |k: u32| if k < n_border { same[k as usize] } else { k };
    let is_flat = |t: &[u32; 3]| {
        let [a, b, c] = t.map(leader);
        a == b || b == c || c == a
    };
    let (dropped, kept): (Vec<[u32; 3]>, Vec<[u32; 3]>) = corners.into_iter().partition(is_flat);
    if kept.is_empty() {
        let message = "the surfaces have no area: their triangles are points and lines";
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    flat.extend(dropped);
    // Parts of the surface for which the mesh has no triangle.
    if !flat.is_empty() {
        let by_leader = |list: &[[u32; 3]]| list.iter().map(|t| t.map(leader)).collect::<Vec<_>>();
        at_most += uncovered(&by_leader(&flat), &by_leader(&kept), &positions);
    }
    if !at_most.is_finite() {
        let message = "a patch near a surface would leave the range of numbers: the weights differ too much";
        return Err(Failure::refused(RefusalCode::NotFinite, message));
    }
    Ok(TrimmedMesh { mesh: shaded(&positions, &normals, kept, leader), at_most: at_most.next_up(), worst })
}

/// The mesh, with vertices split if their normals differ.
fn shaded(
    positions: &[[f64; 3]],
    normals: &[[f64; 3]],
    faces: Vec<[u32; 3]>,
    leader: impl Fn(u32) -> u32,
) -> Mesh {
    // Vertices at one position, one after the other.
    let mut used: Vec<u32> = faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    used.sort_by_key(|vertex| (leader(*vertex), *vertex));
    let mut becomes = vec![u32::MAX; positions.len()];
    let (mut points, mut ids): (Vec<[f64; 3]>, Vec<u32>) = (Vec::new(), Vec::new());
    let mut sums: Vec<DVec3> = Vec::new();
    for run in used.chunk_by(|a, b| leader(*a) == leader(*b)) {
        let first = points.len() as u32;
        let mut groups: Vec<(DVec3, u32)> = Vec::new();
        for vertex in run {
            let normal = DVec3::from(normals[*vertex as usize]);
            let known =
                // A vertex without a normal joins the first group.
                groups.iter().find(|group| group.0.dot(normal) >= COS_SAME_NORMAL || normal == DVec3::ZERO);
            let target = known.map(|group| group.1).unwrap_or_else(|| {
                points.push(positions[*vertex as usize]);
                ids.push(first);
                sums.push(DVec3::ZERO);
                groups.push((normal, points.len() as u32 - 1));
                points.len() as u32 - 1
            });
            sums[target as usize] += normal;
            becomes[*vertex as usize] = target;
        }
    }
    let faces: Vec<[u32; 3]> = faces.into_iter().map(|t| t.map(|k| becomes[k as usize])).collect();
    let mut normals: Vec<[f64; 3]> = sums.into_iter().map(|sum| sum.normalize_or_zero().into()).collect();
    fill_missing_normals(&points, &faces, &mut normals);
    let is_split = ids.iter().enumerate().any(|(k, id)| *id != k as u32);
    mesh_with_normals(points, faces, normals, is_split.then_some(ids))
}

/// The refusal for loops that enclose no area.
fn refusal(surface: usize, face: &TrimmedFace<'_>, conflict: TrimConflict) -> Failure<Mesh> {
    let (lattice, polygons) = (&face.prepared.lattice, &face.polygons);
    let message = if let Some([u, v]) = TrimPieces::crossing_edges(lattice, polygons) {
        format!("a trim loop of surface {surface} crosses itself or another one near u {u:.6}, v {v:.6}")
    } else if let Some(index) = TrimPieces::backward(lattice, polygons) {
        format!(
            "trim loop {index} of surface {surface} runs backwards: outer loops run counter-clockwise, holes clockwise"
        )
    } else if conflict == TrimConflict::Open {
        format!("the trim loops of surface {surface} do not enclose the inside: an outer loop is missing")
    } else {
        format!("a trim loop of surface {surface} touches itself or another one, or runs along it")
    };
    Failure::refused(RefusalCode::Unsupported, message)
}
