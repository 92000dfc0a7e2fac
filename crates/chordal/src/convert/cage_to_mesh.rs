//! The arrow from a cage's limit surface to triangles: adaptive, crack-free by shared indices, proved.
use super::patches::adjacency::{PatchAdjacency, PatchEdge, SideBoundary, classify_corners, side_corners};
use super::patches::allowance::{Allowance, InfeasibleTolerance, TessellationFailure};
use super::patches::budget::mesh_within;
use super::patches::extraordinary_tile;
use super::patches::plan;
use super::patches::subpatch::{PatchSurface, Subpatch, SubpatchShape};
use super::patches::texcoords::SheetTexcoords;
use super::triangles::{self, mesher::LoopMesher};
use crate::budget::{Bounded, Budget, Failure, Job, Reference, RefusalCode, par_map};
use crate::explicit::cage::limit::QuadPatchTree;
use crate::explicit::{
    Cage, Chart, DisjointSets, LimitSheet, LimitSurface, Mesh, Patch, PatchEdgeUse, PatchSide, Scheme,
};
use crate::math::{Box3, flushes_subnormals, greater};

/// Meshes the limit surface of a cage within a budget.
///
/// **Bound.** Two-sided Hausdorff distance between the limit surface of the cage, taken exactly as given, and
/// the triangles. It is *proved*, rounding included, with creases, borders, darts, corners and vertices of
/// any valence. (For the mathematics see `patches/derivative_bound.rs` and `patches/extraordinary_tile.rs`,
/// for Loop's scheme `triangles/derivative_bound.rs` and `triangles/hull_distance.rs`, and
/// `docs/cage_to_mesh.md`.) `at_least` is the distance at one point of the surface. With a budget of pixels the
/// bound is also given in pixels at the view.
///
/// **Mesh.** Faces share the vertices on their edges by index, so there are no cracks and no T-junctions at
/// any budget. Every vertex lies on the limit surface (up to rounding) and has the surface's own unit normal.
/// Along infinitely sharp edges, where there are two normals, vertices are split and tied by
/// [`Mesh::position_id`]. A closed manifold cage gives a closed manifold mesh; but with Loop's scheme, edges of
/// two faces with the same three vertices may coincide in coarse meshes.
///
/// **Budgets.** As for [`patches_to_mesh`](super::patches_to_mesh).
///
/// **Cost.** O(triangles) time and about 200 bytes a triangle; with Loop's scheme some 50 µs and 700 bytes.
/// Before that, some microseconds a regular face and about a millisecond for each face beside an
/// extraordinary vertex of few edges. At a vertex of hundreds of edges each face has all others in its
/// one-ring, so that the time grows with the square of their number (3.5 s for two of 360 at half a pixel).
///
/// # Errors
/// [`Failure::Refused`]: as for [`patches_to_mesh`](super::patches_to_mesh). [`Failure::Unmet`] with the best
/// mesh: the length or pixels need more triangles than the budget allows. [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Tolerance, convert, explicit::Cage};
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let budget = Budget::length(Tolerance::new(1e-2)?);
/// let mesh = convert::cage_to_mesh(&cube, &budget, &Job::default()).unwrap();
/// assert!(mesh.bound.at_most().unwrap() <= 1e-2);
/// assert!(mesh.shape.faces().len() < 1500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986, for
/// patches; around extraordinary vertices the proof is Chordal's own.
pub fn cage_to_mesh(cage: &Cage, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, TessellationFailure> {
    check_budget(cage, budget)?;
    CageMesher::new(cage, job)?.mesh(budget, job)
}

/// Meshes one cage repeatedly, within any budgets.
///
/// It keeps the data that do not depend on the budget: the sheets of the limit surface, and their subdivisions
/// around extraordinary vertices so far. Every mesh is bit for bit that of [`cage_to_mesh()`]. For a moving
/// camera, a [`ViewDependentMesher`](super::batch::ViewDependentMesher) also keeps triangles.
///
/// *Cost.* The first mesh takes as long as with [`cage_to_mesh()`]; later ones reuse the subdivided parts of the
/// limit surface. Memory: some hundred bytes a regular face, and up to some hundred thousand for each face beside
/// an extraordinary vertex.
///
/// ```
/// use chordal::{Budget, Job, View, budget::Pixels, convert, explicit::Cage};
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let mesher = convert::batch::CageMesher::new(&cube, &Job::default()).unwrap();
/// for x in [3.0, 4.0, 5.0] {
///     let view: View = format!("640x480 fov=45 eye={x},2,1 target=0,0,0").parse()?;
///     let budget = Budget::pixels(Pixels::new(1.0)?, view);
///     let frame = mesher.mesh(&budget, &Job::default()).unwrap();
///     assert!(frame.bound.pixels.unwrap() <= 1.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CageMesher<'a> {
    limit: LimitSurface<'a>,
    sheets: Vec<LimitSheet>,
    chart: Option<Chart>,
}

impl<'a> CageMesher<'a> {
    /// Prepares the limit surface of a cage for meshing.
    ///
    /// # Errors
    /// [`Failure::Refused`] for reasons that lie in the cage, and [`Failure::Cancelled`].
    pub fn new(cage: &'a Cage, job: &Job) -> Result<Self, TessellationFailure> {
        check_cage(cage)?;
        let limit =
            cage.limit().map_err(|error| Failure::refused(RefusalCode::Unsupported, error.to_string()))?;
        if limit.n_sheets() == 0 {
            return Err(Failure::refused(RefusalCode::Empty, "the cage has no face with a surface"));
        }
        let numbers: Vec<usize> = (0..limit.n_sheets()).collect();
        let sheets =
            job.run(|| par_map(job, &numbers, |_, sheet| (!job.is_cancelled()).then(|| limit.sheet(*sheet))));
        let sheets: Option<Result<Vec<LimitSheet>, _>> = sheets.into_iter().collect();
        let sheets = sheets.ok_or(Failure::Cancelled)?;
        let sheets = sheets.map_err(|error| Failure::refused(RefusalCode::NotFinite, error.to_string()))?;
        Ok(Self { limit, sheets, chart: cage.chart() })
    }

    /// Meshes the cage within a budget; see [`cage_to_mesh()`].
    ///
    /// # Errors
    /// As there.
    pub fn mesh(&self, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, TessellationFailure> {
        check_budget(self.limit.cage(), budget)?;
        job.run(|| {
            if self.scheme() == Scheme::Loop {
                let texcoords = self.texcoords();
                let mut mesher = LoopMesher::new(&self.limit, &self.sheets, job);
                mesher.texcoords = texcoords.as_ref();
                return triangles::budget::mesh_within(&mesher, budget, job);
            }
            mesh_within(&self.quad_sheets(), budget, job)
        })
    }

    pub(super) fn scheme(&self) -> Scheme {
        self.limit.cage().scheme()
    }

    /// The surface, if its sheets are quads: for schemes other than Loop's.
    pub(super) fn quad_sheets(&self) -> CageSheets<'_> {
        CageSheets { texcoords: self.texcoords(), ..CageSheets::new(&self.limit, &self.sheets) }
    }

    fn texcoords(&self) -> Option<SheetTexcoords<'_>> {
        self.chart.as_ref().and_then(SheetTexcoords::from_chart)
    }
}

/// Derivatives multiply coordinates by less than 1e3, and squares of those must stay below 1e308.
const LARGEST: f64 = 1e150;

fn check_budget(cage: &Cage, budget: &Budget) -> Result<(), TessellationFailure> {
    budget.check_for_surfaces().map_err(Failure::Refused)?;
    if budget.angle_deg.is_some() && cage.scheme() == Scheme::Loop {
        let message = "limits of Loop's scheme cannot be meshed to an angle yet; give a length or pixels";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    Ok(())
}

fn check_cage(cage: &Cage) -> Result<(), TessellationFailure> {
    if let Some(row) = cage.positions().iter().position(|p| p.iter().any(|x| x.abs() > LARGEST)) {
        let message = format!(
            "vertex {row} has a coordinate beyond {LARGEST:e}, where squares leave the range of numbers"
        );
        return Err(Failure::refused(RefusalCode::NotFinite, message));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
    }
    Ok(())
}

/// The sheets of a limit surface as a [`PatchSurface`].
pub(super) struct CageSheets<'a> {
    sheets: &'a [LimitSheet],
    /// The same sheets in texture space.
    texcoords: Option<SheetTexcoords<'a>>,
    /// The boundary of each side of each sheet.
    seams: Vec<[SideBoundary; 4]>,
    /// The uses of each edge, and the sheet corners at its ends; `None` at the midpoint of a halved edge.
    edges: Vec<(Vec<PatchEdgeUse>, [Option<u32>; 2])>,
    /// Pairs of corners that are one vertex; a corner is 4 · sheet + corner.
    same: Vec<[u32; 2]>,
}

impl<'a> CageSheets<'a> {
    fn new(limit: &LimitSurface<'_>, sheets: &'a [LimitSheet]) -> Self {
        let (cage, table) = (limit.cage(), limit.edges());
        let n_edges = table.ends.len();
        // An edge beside a face that is not a quad has a vertex at its midpoint.
        let mut is_halved = vec![false; n_edges];
        for sheet in 0..limit.n_sheets() {
            let (face, _) = limit.face_of(sheet);
            let n = cage.face(face).len();
            if n != 4 {
                (0..n).for_each(|k| is_halved[table.of_corner[cage.begin(face) + k] as usize] = true);
            }
        }
        // Edge numbers: whole edges and first halves as in the cage, then second halves, then the edges
        // inside polygons by corner.
        let inside = |face: usize, k: usize| (2 * n_edges + cage.begin(face) + k) as u32;
        // The half at the edge's first vertex keeps the edge's number.
        let half = |edge: u32, vertex: u32| {
            if table.ends[edge as usize][0] == vertex { edge } else { n_edges as u32 + edge }
        };
        let mut seams = Vec::with_capacity(sheets.len());
        for sheet in 0..limit.n_sheets() {
            let (face, k) = limit.face_of(sheet);
            let (of, begin) = (cage.face(face), cage.begin(face));
            let n = of.len();
            let edge = |k: usize| table.of_corner[begin + k % n];
            if n != 4 {
                let last = k + n - 1;
                seams.push([
                    SideBoundary::Edge { edge: half(edge(k), of[k]), reversed: false },
                    SideBoundary::Edge { edge: inside(face, k), reversed: false },
                    SideBoundary::Edge { edge: inside(face, last % n), reversed: true },
                    SideBoundary::Edge { edge: half(edge(last), of[k]), reversed: true },
                ]);
                continue;
            }
            seams.push(std::array::from_fn(|k| {
                let (edge, from, to) = (edge(k), of[k], of[(k + 1) % 4]);
                if !is_halved[edge as usize] {
                    return SideBoundary::Edge { edge, reversed: table.ends[edge as usize][0] != from };
                }
                let halves = [(half(edge, from), false), (half(edge, to), true)];
                // In the order of the parameter; the last two sides run against it.
                SideBoundary::Halves(if k < 2 { halves } else { [halves[1], halves[0]] })
            }));
        }
        let mut cage_sheets = Self { sheets, texcoords: None, seams, edges: Vec::new(), same: Vec::new() };
        cage_sheets.number_edges();
        cage_sheets
    }

    /// Numbers the used edges consecutively, and lists their uses.
    fn number_edges(&mut self) {
        let mut uses: Vec<(u32, PatchEdgeUse, [Option<u32>; 2])> = Vec::new();
        for (sheet, seams) in self.seams.iter().enumerate() {
            for (side, seam) in PatchSide::ALL.into_iter().zip(seams) {
                let [start, end] = side_corners(sheet as u32, side).map(Some);
                let sheet = sheet as u32;
                match *seam {
                    SideBoundary::Edge { edge, reversed } => {
                        let ends = if reversed { [end, start] } else { [start, end] };
                        uses.push((edge, PatchEdgeUse { sheet, side, reversed }, ends));
                    }
                    SideBoundary::Halves(halves) => {
                        for (edge, reversed) in halves {
                            // The other end of a half is in the middle of the side, at no corner of the
                            // sheet.
                            let ends = [if reversed { end } else { start }, None];
                            uses.push((edge, PatchEdgeUse { sheet, side, reversed }, ends));
                        }
                    }
                    SideBoundary::Point => {}
                }
            }
        }
        uses.sort_by_key(|(edge, used, _)| (*edge, used.sheet, used.side));
        let mut numbers = Vec::new();
        for run in uses.chunk_by(|a, b| a.0 == b.0) {
            numbers.push(run[0].0);
            let mut ends = [None; 2];
            for (_, _, own) in run {
                for (end, own) in ends.iter_mut().zip(own) {
                    // All uses of an edge have the same corners at its ends.
                    match (*end, *own) {
                        (Some(first), Some(own)) => self.same.push([first, own]),
                        (None, own) => *end = own,
                        _ => {}
                    }
                }
            }
            self.edges.push((run.iter().map(|(_, used, _)| *used).collect(), ends));
        }
        let number = |edge: &mut u32| *edge = numbers.partition_point(|n| *n < *edge) as u32;
        for seam in self.seams.as_flattened_mut() {
            match seam {
                SideBoundary::Edge { edge, .. } => number(edge),
                SideBoundary::Halves(halves) => halves.iter_mut().for_each(|(edge, _)| number(edge)),
                SideBoundary::Point => {}
            }
        }
    }

    /// Whether one of the sides along u, and one of those along v, is halved.
    fn is_halved(&self, sheet: usize) -> [bool; 2] {
        let is_halved = |side: usize| matches!(self.seams[sheet][side], SideBoundary::Halves(_));
        [is_halved(0) || is_halved(2), is_halved(1) || is_halved(3)]
    }
}

/// The most halvings of a sheet toward an extraordinary vertex. Tile coordinates stay exact, and 2⁻³⁰ of a
/// face is below any practical tolerance.
const DEEPEST: u32 = 30;

impl<'a> PatchSurface<'a> for CageSheets<'a> {
    fn count(&self) -> usize {
        self.sheets.len()
    }

    fn subpatches(
        &self,
        sheet: usize,
        allowance: &Allowance,
        safety_factor: f64,
    ) -> Result<Vec<Subpatch<'a>>, InfeasibleTolerance> {
        let mut subpatches = Vec::new();
        let halved = self.is_halved(sheet);
        let Some(square) = self.sheets[sheet].square() else { return Ok(subpatches) };
        let mut open = vec![(square, [0.0, 0.0], 0)];
        while let Some((square, [u, v], depth)) = open.pop() {
            let width = 1.0 / f64::from(1_u32 << depth);
            match square {
                QuadPatchTree::Regular(patches) => {
                    let on = |[from, to]: [f64; 2], begin: f64| [begin + width * from, begin + width * to];
                    for piece in &patches.patches {
                        let whole = (piece.patch, on(piece.u, u), on(piece.v, v));
                        for (patch, u, v) in cut_in_middle(whole, halved) {
                            let shape = SubpatchShape::Bezier(Box::new(patch));
                            subpatches.push(Subpatch {
                                sheet: sheet as u32,
                                u,
                                v,
                                shape,
                                slack: patches.off,
                            });
                        }
                    }
                }
                QuadPatchTree::Extraordinary(extraordinary) => {
                    let place = Box3::from_points(extraordinary.ring().hull());
                    // No tile may extend across the middle of a halved side, so such a sheet is cut at least
                    // once.
                    let is_split = depth == 0 && (halved[0] || halved[1]);
                    let tolerance = plan::tolerance(place, allowance, extraordinary.rounding_error());
                    let is_last = depth == DEEPEST;
                    let is_flat = match tolerance {
                        Ok(tolerance) => {
                            !is_split && extraordinary_tile::is_flat(extraordinary, tolerance / safety_factor)
                        }
                        Err(obstacle) if is_last => return Err(obstacle),
                        Err(_) => false,
                    };
                    if is_flat || is_last {
                        let (u, v) = ([u, u + width], [v, v + width]);
                        subpatches.push(Subpatch {
                            sheet: sheet as u32,
                            u,
                            v,
                            shape: SubpatchShape::Extraordinary(extraordinary),
                            slack: 0.0,
                        });
                        continue;
                    }
                    let Ok(quarters) = extraordinary.quarters() else { continue };
                    let half = 0.5 * width;
                    let places = [[u, v], [u + half, v], [u + half, v + half], [u, v + half]];
                    // In reverse, so that they leave the stack in order.
                    open.extend(
                        quarters.iter().zip(places).map(|(quarter, at)| (quarter, at, depth + 1)).rev(),
                    );
                }
            }
        }
        Ok(subpatches)
    }

    fn adjacency(&self) -> PatchAdjacency {
        let n = self.sheets.len();
        let mut classes = DisjointSets::new(4 * n);
        self.same.iter().for_each(|[a, b]| classes.union(*a, *b));
        let (number, count) = classes.labels();
        let corners: Vec<[u32; 4]> = (0..n).map(|s| std::array::from_fn(|k| number[4 * s + k])).collect();
        let mut positions = vec![None; count];
        for (sheet, ids) in self.sheets.iter().zip(&corners) {
            let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            for ((u, v), id) in places.into_iter().zip(ids) {
                let position = &mut positions[*id as usize];
                // One point for all sheets at a corner, whatever their roundings.
                if position.is_none() {
                    *position = sheet.at(u, v).ok().map(|jet| jet.point);
                }
            }
        }
        let edge = |(uses, ends): &(Vec<PatchEdgeUse>, [Option<u32>; 2])| PatchEdge {
            ends: ends.map(|end| end.map_or(0, |end| number[end as usize])),
            uses: uses.clone(),
            min_segments: 1,
        };
        let mut adjacency = PatchAdjacency {
            edges: self.edges.iter().map(edge).collect(),
            sides: self.seams.clone(),
            corner_kinds: classify_corners(&self.seams),
            corners,
            corner_positions: positions.into_iter().map(Option::unwrap_or_default).collect(),
        };
        adjacency.set_least_segments();
        adjacency
    }

    fn longest_diagonal(&self) -> f64 {
        let own = |sheet: &LimitSheet| {
            let (hull, lost) = match sheet.square() {
                Some(QuadPatchTree::Extraordinary(extraordinary)) => {
                    (Box3::from_points(extraordinary.ring().hull()), extraordinary.rounding_error())
                }
                None => return 0.0,
                Some(QuadPatchTree::Regular(patches)) => {
                    let points =
                        patches.patches.iter().flat_map(|piece| piece.patch.control.iter().flatten());
                    (Box3::from_points(points), patches.off)
                }
            };
            let diagonal = hull.diagonal();
            greater(diagonal, lost)
        };
        self.sheets.iter().map(own).fold(0.0, |longest, d| greater(d, longest))
    }

    fn reference(&self) -> Reference {
        Reference::LimitSurface
    }

    fn has_texcoords(&self) -> bool {
        self.texcoords.is_some()
    }

    fn texcoords(&self, sheet: usize) -> Option<LimitSheet> {
        self.texcoords.as_ref()?.sheet(sheet)
    }
}

type SubpatchDomain = (Patch, [f64; 2], [f64; 2]);

/// Cuts a patch that reaches over the middle of its sheet, in the directions that are halved.
fn cut_in_middle(whole: SubpatchDomain, [in_u, in_v]: [bool; 2]) -> Vec<SubpatchDomain> {
    let reaches = |[from, to]: [f64; 2]| from < 0.5 && to > 0.5;
    // The cut is at the middle of the patch, except in strips beside creases, which begin at dyadic parameters.
    let share = |[from, to]: [f64; 2]| (0.5 - from) / (to - from);
    let mut parts = vec![whole];
    if in_u && reaches(whole.1) {
        let (patch, u, v) = whole;
        let at = share(u);
        let (left, right) = (patch.part([0.0, at], [0.0, 1.0]), patch.part([at, 1.0], [0.0, 1.0]));
        parts = vec![(left, [u[0], 0.5], v), (right, [0.5, u[1]], v)];
    }
    if in_v && reaches(whole.2) {
        let cut = |(patch, u, v): SubpatchDomain| {
            let at = share(v);
            let (low, high) = (patch.part([0.0, 1.0], [0.0, at]), patch.part([0.0, 1.0], [at, 1.0]));
            [(low, u, [v[0], 0.5]), (high, u, [0.5, v[1]])]
        };
        parts = parts.into_iter().flat_map(cut).collect();
    }
    parts
}
