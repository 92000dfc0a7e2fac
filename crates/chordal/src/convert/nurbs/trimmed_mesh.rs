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
use crate::math::{Box3, difference, greater, length};
use glam::DVec3;

/// The parts of a length that go to patches, to loops, and to sewing. Chosen: the number of triangles goes like 1 over
/// what is left.
const PATCHES: f64 = 0.05;
const LOOPS: f64 = 0.3;
const SEWING: f64 = 0.25;
/// What triangles are first expected to need. Chosen: a little less than what is left.
const TRIANGLES: f64 = 0.55;
/// What goes to the loops of a plane, whose triangles lose nothing, or to the triangles between straight loops.
const ONLY: f64 = 0.85;
/// Below this something is as if it were straight.
const STRAIGHT: f64 = 0.05;
/// Faces nearer than this part of the whole are sewn even where the length would allow more: what is farther apart is
/// meant so. Chosen.
const NEAREST: f64 = 1e-4;
/// Cells of all faces. Chosen: as many take some GB and a minute; where the budget needs more, the mesh is coarser.
const MOST_CELLS: u64 = 1 << 23;
/// How much coarser it then becomes at once. Chosen.
const COARSER: f64 = 4.0;
/// A mesh that uses less of the length than this is made again with larger triangles, so many times at most. Chosen.
const USED: f64 = 0.9;
const LARGER: usize = 2;
/// Rounds until what triangles are expected to need is what they need. Chosen.
const ROUNDS: usize = 5;

/// A mesh, and how far it is from its surfaces, at most.
pub(in crate::convert) struct TrimmedMesh {
    pub mesh: Mesh,
    pub at_most: f64,
    /// The middle of the triangle that is farthest, as far as is known.
    pub worst: Option<[f64; 3]>,
}

/// The triangles of one face and what they lose.
struct BoundedFace {
    triangles: Vec<[u32; 3]>,
    /// What is left of loops as edges and vertices beside no triangle.
    stray: Vec<[u32; 2]>,
    /// Of the vertices that are not on a loop.
    inner: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    /// What triangles lose.
    bent: f64,
    /// What patches, polygons and rounding lose.
    off: f64,
    worst: Option<[f64; 3]>,
}

/// A mesh within a length of surfaces, or the nearest that was reached.
pub(in crate::convert) fn mesh_within(
    faces: &[TrimmedSurface],
    wanted: f64,
    bounds: &Box3,
    job: &Job,
) -> Result<TrimmedMesh, Failure<Mesh>> {
    let fitted = par_map(job, faces, |_, face| {
        let pieces = TrimPieces::new(face.surface(), face.loops());
        let fitted = fit(face.surface(), PATCHES * wanted, &job.clone().with_threads(1));
        PreparedFace::new(face, pieces, fitted)
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let of = |face: &PreparedFace| face.lattice.rounding + 5.0 * face.lattice.parameter_rounding;
    let rounding = fitted.iter().map(of);
    let rounding = rounding.fold(0.0, greater);
    if rounding >= wanted {
        let message = format!(
            "rounding alone can lose {rounding:.1e}, so no mesh in double precision can be proved to meet the budget"
        );
        return Err(Failure::refused(RefusalCode::BelowPrecision, message));
    }
    let mut prepared = fitted;
    let near = {
        let all = NEAREST * bounds.diagonal();
        let part = SEWING * wanted;
        if part < all { part } else { all }
    };
    let mut best: Option<TrimmedMesh> = None;
    let mut scale = 1.0;
    let most = (job.memory_limit / CELL_BYTES).min(job.triangle_limit).min(MOST_CELLS);
    'rounds: for round in 0..ROUNDS {
        while cut(faces, &mut prepared, scale, wanted, job) > most {
            if best.is_some() {
                break 'rounds;
            }
            if job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            // Triangles that may lose more than all there is are as few as there can be: a few for each patch.
            if scale * wanted > bounds.diagonal() {
                return Err(too_many(&prepared, most, job));
            }
            scale *= COARSER;
        }
        let (made, bent, kept) = one_round(faces, prepared, wanted, near, job)?;
        prepared = kept;
        let reached = made.at_most;
        let is_better = best.as_ref().is_none_or(|best| match (reached <= wanted, best.at_most <= wanted) {
            (true, true) => made.mesh.faces().len() < best.mesh.faces().len(),
            (false, false) => reached < best.at_most,
            (is_met, _) => is_met,
        });
        if is_better {
            best = Some(made);
        }
        // What is left where patches, loops and sewing have taken theirs.
        let left = wanted - (reached - bent);
        let is_used = reached > USED * wanted || round >= LARGER;
        if reached <= wanted && is_used || left <= 0.0 || bent <= 0.0 {
            break;
        }
        // Errors go with what is expected.
        scale *= 0.95 * left / bent;
    }
    best.ok_or(Failure::Cancelled)
}

/// Cuts all faces into cells whose triangles are expected within a part of a length; how many.
fn cut(
    faces: &[TrimmedSurface],
    prepared: &mut Vec<PreparedFace>,
    scale: f64,
    wanted: f64,
    job: &Job,
) -> u64 {
    let all: Vec<(&TrimmedSurface, PreparedFace)> = faces.iter().zip(std::mem::take(prepared)).collect();
    *prepared = par_map_owned(job, all, |(surface, mut face)| {
        let is_straight = face.pieces.bulge(&face.lattice) <= STRAIGHT * wanted;
        face.cut(surface, scale * wanted * if is_straight { ONLY } else { TRIANGLES }, job);
        face
    });
    let counts = prepared.iter().map(|face| face.lattice.cells.count() as u64);
    counts.fold(0, u64::saturating_add)
}

/// One mesh of faces that are cut into cells; what triangles lose of its bound.
fn one_round(
    surfaces: &[TrimmedSurface],
    prepared: Vec<PreparedFace>,
    wanted: f64,
    near: f64,
    job: &Job,
) -> Result<(TrimmedMesh, f64, Vec<PreparedFace>), Failure<Mesh>> {
    let mut loops = Vec::new();
    let mut faces = Vec::with_capacity(prepared.len());
    for (prepared, surface) in prepared.into_iter().zip(surfaces) {
        let is_flat = prepared.lattice.bending() <= STRAIGHT * wanted;
        loops.push(wanted * if is_flat { ONLY } else { LOOPS });
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
    let made = par_map(job, &indices, |_, index| {
        triangulate(&faces[*index].prepared.lattice, &faces[*index].polygons)
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let mut triangles = Vec::with_capacity(made.len());
    for (index, one) in made.into_iter().enumerate() {
        triangles.push(one.map_err(|conflict| refusal(index, &faces[index], conflict))?);
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
    let bent = bounded.iter().fold(0.0, |most: f64, face| greater(face.bent, most));
    let mesh = join(&faces, &sewn.first, &same, &moved, bounded)?;
    let kept = faces.into_iter().map(|face| face.prepared).collect();
    Ok((mesh, bent, kept))
}

/// Why there is no mesh where even the coarsest one has more cells than there may be.
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

/// What a cell needs until its triangles are joined. Measured: some 150 bytes a triangle.
const CELL_BYTES: u64 = 400;

/// Where each vertex of a loop goes: where the first one that is the same is.
fn moved_to(faces: &[TrimmedFace<'_>], same: &[u32]) -> Vec<[f64; 3]> {
    let all: Vec<[f64; 3]> = faces.iter().flat_map(|face| face.positions.iter().copied()).collect();
    same.iter().map(|leader| all[*leader as usize]).collect()
}

/// The triangles of a face with what they lose.
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
    let moved: Vec<f64> = (0..n_border)
        .map(|k| length(difference(positions[k], targets[k])) * (1.0 + 8.0 * f64::EPSILON))
        .collect();
    let shift = |corners: &[u32]| {
        let all = corners.iter().filter_map(|k| moved.get(*k as usize));
        all.fold(0.0, |most: f64, moved| greater(*moved, most))
    };
    let (mut bent, mut worst) = (0.0, None);
    for (corners, patch) in &triangles.triangles {
        let places = corners.map(|k| triangles.vertices[k as usize]);
        let at = corners.map(|k| positions[k as usize]);
        let bound = lattice.triangle_bound(*patch, places, at) + shift(corners);
        if bound > bent {
            bent = bound;
            worst = Some(std::array::from_fn(|k| (at[0][k] + at[1][k] + at[2][k]) / 3.0));
        }
        if bound.is_nan() {
            bent = f64::INFINITY;
        }
    }
    // Vertices of polygons that are no corner of a triangle, with the edges that are none's side.
    let mut is_used = vec![false; n_border];
    let corners = triangles.triangles.iter().flat_map(|(t, _)| t).filter(|k| (**k as usize) < n_border);
    corners.for_each(|k| is_used[*k as usize] = true);
    let alone = triangles.same.iter().filter(|k| !is_used[**k as usize]).map(|k| [*k; 2]);
    let stray: Vec<[u32; 2]> = triangles.stray.iter().map(|(edge, _)| *edge).chain(alone).collect();
    let left = triangles.stray.iter().map(|(edge, patch)| {
        let places = edge.map(|k| triangles.vertices[k as usize]);
        lattice.edge_bound(*patch, places, edge.map(|k| positions[k as usize]))
    });
    let left = left.chain(std::iter::repeat(0.0)).zip(&stray).map(|(bent, edge)| bent + shift(edge));
    bent = left.fold(bent, greater);
    let off = face.prepared.off + face.polygons.off + lattice.rounding + lattice.parameter_rounding;
    let ordered = |t: [u32; 3]| if is_flipped { [t[0], t[2], t[1]] } else { t };
    BoundedFace {
        triangles: triangles.triangles.iter().map(|(t, _)| ordered(*t)).collect(),
        stray,
        inner: positions[n_border..].to_vec(),
        normals,
        bent,
        off,
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
    // Positions: those of loops by their first, then those within faces.
    let n_border = same.len() as u32;
    let mut positions: Vec<[f64; 3]> = moved.to_vec();
    let (mut corners, mut flat): (Vec<[u32; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let mut normals: Vec<[f64; 3]> = vec![[0.0; 3]; positions.len()];
    let (mut at_most, mut worst) = (0.0, None);
    for (index, one) in bounded.iter().enumerate() {
        let (first, own) = (first[index], faces[index].positions.len() as u32);
        let inner = positions.len() as u32;
        positions.extend_from_slice(&one.inner);
        for (k, normal) in one.normals.iter().enumerate() {
            let k = k as u32;
            if k < own { normals[(first + k) as usize] = *normal } else { normals.push(*normal) }
        }
        let number = |k: u32| if k < own { first + k } else { inner + (k - own) };
        corners.extend(one.triangles.iter().map(|t| t.map(number)));
        flat.extend(one.stray.iter().map(|[a, b]| [*a, *b, *b].map(number)));
        // Derived: a few roundings of sums.
        let total = (one.bent + one.off) * (1.0 + 8.0 * f64::EPSILON);
        if total > at_most || total.is_nan() {
            (at_most, worst) = (if total.is_nan() { f64::INFINITY } else { total }, one.worst);
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
    if !flat.is_empty() {
        let of = |all: &[[u32; 3]]| all.iter().map(|t| t.map(leader)).collect::<Vec<_>>();
        at_most += uncovered(&of(&flat), &of(&kept), &positions);
    }
    if !at_most.is_finite() {
        let message = "a patch near a surface would leave the range of numbers: the weights differ too much";
        return Err(Failure::refused(RefusalCode::NotFinite, message));
    }
    Ok(TrimmedMesh { mesh: shaded(&positions, &normals, kept, leader), at_most: at_most.next_up(), worst })
}

/// The mesh, with vertices split where normals differ.
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

/// What is said of loops that enclose no area.
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
