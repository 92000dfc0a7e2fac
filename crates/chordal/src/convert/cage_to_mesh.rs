//! The limit surface of a cage to triangles: adaptive, crack-free by shared index, proved.
use super::patches::ground::{Ground, Shape, Sheets};
use super::patches::mesher::Failed;
use super::patches::plan::{self, Allowance, Obstacle};
use super::patches::quilt::{Edge, Quilt, Seam, Use, corners_of, meetings};
use super::patches::texcoords::Texcoords;
use super::patches::tip;
use super::patches::within::{check_angle, mesh_within};
use super::triangles::{self, mesher::Mesher};
use crate::budget::{Bounded, Budget, Code, Failure, Job, Reference, par_map};
use crate::explicit::cage::limit::Square;
use crate::explicit::{Cage, Chart, LimitSurface, Mesh, Patch, Scheme, Sets, Sheet, Side};
use crate::math::{Box3, flushes_subnormals};

/// Meshes the limit surface of a cage so that nothing is farther from it than the budget allows.
///
/// **Bound.** Two-sided Hausdorff distance between the limit surface of the cage, taken exactly as given, and the triangles, *proved*,
/// rounding included, with creases, borders, darts, corners and vertices of any valence. (The mathematics stands in `patches/bend.rs` and
/// `patches/tip.rs`, for Loop's scheme in `triangles/bend.rs` and `triangles/height.rs`, and in `docs/cage_to_mesh.md`.) `at_least` is a distance that was found. With a budget of pixels the bound also says how many
/// pixels that is at the view.
///
/// **Mesh.** Faces share the vertices on their edges by index, so there are no cracks and no T-junctions at any budget. Every vertex lies on the
/// limit surface (up to rounding) with the surface's own unit normal; along infinitely sharp edges, where it has two, vertices
/// are split and tied by [`Mesh::position_id`]. A closed manifold cage gives a closed manifold mesh,
/// but by Loop's scheme edges of two faces with the same three vertices may fall together in coarse ones.
///
/// **Budgets.** As for [`patches_to_mesh`](super::patches_to_mesh).
///
/// **Cost.** O(triangles) time and about 200 bytes a triangle, by Loop's scheme some 50 µs and 700 bytes; before that some microseconds a regular face and about a millisecond for
/// each face beside an irregular vertex of few edges; at one of hundreds each face has all others in its ring, so that the time grows with
/// the square of their number (3.5 s for two of 360 at half a pixel).
///
/// # Errors
/// [`Failure::Refused`]: as for [`patches_to_mesh`](super::patches_to_mesh).
/// [`Failure::Unmet`] with the best mesh: the length or pixels need more triangles than the budget has. [`Failure::Cancelled`].
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
/// Source: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986, for patches; around
/// irregular vertices the proof is Chordal's own.
pub fn cage_to_mesh(cage: &Cage, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failed> {
    check_budget(cage, budget)?;
    CageMesher::new(cage, job)?.mesh(budget, job)
}

/// A cage that is meshed again and again, for a camera that moves.
///
/// What does not hang on the budget is kept: the sheets of the limit surface and, of those that are divided around irregular vertices, all that was
/// divided so far. Every mesh is bit for bit that of [`cage_to_mesh()`].
///
/// *Cost.* The first mesh takes as long as with [`cage_to_mesh()`]; others no time for the limit surface, as far as it was divided before. Some hundred bytes
/// a regular face, and up to some hundred thousand for each beside an irregular vertex.
///
/// ```
/// use chordal::{Budget, Job, View, budget::Pixels, convert, explicit::Cage};
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let mesher = convert::CageMesher::new(&cube, &Job::default()).unwrap();
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
    sheets: Vec<Sheet>,
    chart: Option<Chart>,
}

impl<'a> CageMesher<'a> {
    /// The limit surface of a cage, ready to be meshed.
    ///
    /// # Errors
    /// [`Failure::Refused`], as far as the cage is the cause, and [`Failure::Cancelled`].
    pub fn new(cage: &'a Cage, job: &Job) -> Result<Self, Failed> {
        check_cage(cage)?;
        let limit = cage.limit().map_err(|error| Failure::refused(Code::Unsupported, error.to_string()))?;
        if limit.n_sheets() == 0 {
            return Err(Failure::refused(Code::Empty, "the cage has no face with a surface"));
        }
        let numbers: Vec<usize> = (0..limit.n_sheets()).collect();
        let sheets =
            job.run(|| par_map(job, &numbers, |_, sheet| (!job.is_cancelled()).then(|| limit.sheet(*sheet))));
        let sheets: Option<Result<Vec<Sheet>, _>> = sheets.into_iter().collect();
        let sheets = sheets.ok_or(Failure::Cancelled)?;
        let sheets = sheets.map_err(|error| Failure::refused(Code::NotFinite, error.to_string()))?;
        Ok(Self { limit, sheets, chart: cage.chart() })
    }

    /// Its mesh within a budget; see [`cage_to_mesh()`].
    ///
    /// # Errors
    /// As there.
    pub fn mesh(&self, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failed> {
        check_budget(self.limit.cage(), budget)?;
        job.run(|| {
            let texcoords = self.chart.as_ref().and_then(Texcoords::of);
            if self.limit.cage().scheme() == Scheme::Loop {
                let mut mesher = Mesher::new(&self.limit, &self.sheets, job);
                mesher.texcoords = texcoords.as_ref();
                return triangles::within::mesh_within(&mesher, budget, job);
            }
            let sheets = CageSheets { texcoords, ..CageSheets::new(&self.limit, &self.sheets) };
            mesh_within(&sheets, budget, job)
        })
    }
}

/// Derivatives multiply coordinates by less than 1e3, and squares of those must stay below 1e308.
const LARGEST: f64 = 1e150;

fn check_budget(cage: &Cage, budget: &Budget) -> Result<(), Failed> {
    if !budget.has_limit() {
        let message = "a budget needs a length, pixels at a view, or a number of triangles";
        return Err(Failure::refused(Code::Budget, message));
    }
    check_angle(budget)?;
    if budget.angle_deg.is_some() && cage.scheme() == Scheme::Loop {
        let message = "limits of Loop's scheme cannot be meshed to an angle yet; give a length or pixels";
        return Err(Failure::refused(Code::Unsupported, message));
    }
    Ok(())
}

fn check_cage(cage: &Cage) -> Result<(), Failed> {
    if let Some(row) = cage.positions().iter().position(|p| p.iter().any(|x| x.abs() > LARGEST)) {
        let message = format!(
            "vertex {row} has a coordinate beyond {LARGEST:e}, where squares leave the range of numbers"
        );
        return Err(Failure::refused(Code::NotFinite, message));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(Code::FlushesSubnormals, message));
    }
    Ok(())
}

/// The sheets of a limit surface as the mesher takes them.
struct CageSheets<'a> {
    sheets: &'a [Sheet],
    /// The same sheets in the plane of textures.
    texcoords: Option<Texcoords<'a>>,
    /// By sheet and side.
    seams: Vec<[Seam; 4]>,
    /// Uses of each edge, and the corners at its ends as far as a sheet has one there.
    edges: Vec<(Vec<Use>, [Option<u32>; 2])>,
    /// Corners that are one, by sheet and corner.
    same: Vec<[u32; 2]>,
}

impl<'a> CageSheets<'a> {
    fn new(limit: &LimitSurface<'_>, sheets: &'a [Sheet]) -> Self {
        let (cage, table) = (limit.cage(), limit.edges());
        let n_edges = table.ends.len();
        // An edge beside a face that is no quad has a vertex in its middle.
        let mut is_halved = vec![false; n_edges];
        for sheet in 0..limit.n_sheets() {
            let (face, _) = limit.face_of(sheet);
            let n = cage.face(face).len();
            if n != 4 {
                (0..n).for_each(|k| is_halved[table.of_corner[cage.begin(face) + k] as usize] = true);
            }
        }
        // Numbers: whole edges and first halves as in the cage, second halves after them, then those inside of polygons by corner.
        let inside = |face: usize, k: usize| (2 * n_edges + cage.begin(face) + k) as u32;
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
                    Seam::Edge { edge: half(edge(k), of[k]), reversed: false },
                    Seam::Edge { edge: inside(face, k), reversed: false },
                    Seam::Edge { edge: inside(face, last % n), reversed: true },
                    Seam::Edge { edge: half(edge(last), of[k]), reversed: true },
                ]);
                continue;
            }
            seams.push(std::array::from_fn(|k| {
                let (edge, from, to) = (edge(k), of[k], of[(k + 1) % 4]);
                if !is_halved[edge as usize] {
                    return Seam::Edge { edge, reversed: table.ends[edge as usize][0] != from };
                }
                let halves = [(half(edge, from), false), (half(edge, to), true)];
                // By rising parameter, against which the last two sides run.
                Seam::Halves(if k < 2 { halves } else { [halves[1], halves[0]] })
            }));
        }
        let mut made = Self { sheets, texcoords: None, seams, edges: Vec::new(), same: Vec::new() };
        made.number_edges();
        made
    }

    /// Gives edges that are used numbers in a row, and lists their uses.
    fn number_edges(&mut self) {
        let mut uses: Vec<(u32, Use, [Option<u32>; 2])> = Vec::new();
        for (sheet, seams) in self.seams.iter().enumerate() {
            for (side, seam) in Side::ALL.into_iter().zip(seams) {
                let [start, end] = corners_of(sheet as u32, side).map(Some);
                let sheet = sheet as u32;
                match *seam {
                    Seam::Edge { edge, reversed } => {
                        let ends = if reversed { [end, start] } else { [start, end] };
                        uses.push((edge, Use { sheet, side, reversed }, ends));
                    }
                    Seam::Halves(halves) => {
                        for (edge, reversed) in halves {
                            let ends = [if reversed { end } else { start }, None];
                            uses.push((edge, Use { sheet, side, reversed }, ends));
                        }
                    }
                    Seam::Point => {}
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
                Seam::Edge { edge, .. } => number(edge),
                Seam::Halves(halves) => halves.iter_mut().for_each(|(edge, _)| number(edge)),
                Seam::Point => {}
            }
        }
    }

    /// Whether sides along u, and along v, are in two parts.
    fn is_halved(&self, sheet: usize) -> [bool; 2] {
        let is_halved = |side: usize| matches!(self.seams[sheet][side], Seam::Halves(_));
        [is_halved(0) || is_halved(2), is_halved(1) || is_halved(3)]
    }
}

/// Halvings of a sheet on the way to an irregular vertex; places of tiles stay exact, and 2⁻³⁰ of a face is no tolerance that anybody has.
const DEEPEST: u32 = 30;

impl Sheets for CageSheets<'_> {
    fn count(&self) -> usize {
        self.sheets.len()
    }

    fn grounds(
        &self,
        sheet: usize,
        (allowance, strain): (&Allowance, f64),
    ) -> Result<Vec<Ground<'_>>, Obstacle> {
        let mut grounds = Vec::new();
        let halved = self.is_halved(sheet);
        let Some(square) = self.sheets[sheet].square() else { return Ok(grounds) };
        let mut open = vec![(square, [0.0, 0.0], 0)];
        while let Some((square, [u, v], depth)) = open.pop() {
            let width = 1.0 / f64::from(1_u32 << depth);
            match square {
                Square::Patches(patches) => {
                    let on = |[from, to]: [f64; 2], begin: f64| [begin + width * from, begin + width * to];
                    for piece in &patches.pieces {
                        let whole = (piece.patch, on(piece.u, u), on(piece.v, v));
                        for (patch, u, v) in cut_in_middle(whole, halved) {
                            let shape = Shape::Bezier(Box::new(patch));
                            grounds.push(Ground { sheet: sheet as u32, u, v, shape, off: patches.off });
                        }
                    }
                }
                Square::Rough(rough) => {
                    let place = Box3::around(rough.ring().hull());
                    let is_split = depth == 0 && (halved[0] || halved[1]);
                    let tolerance = plan::tolerance(place, (allowance, rough.lost()));
                    let is_last = depth == DEEPEST;
                    let is_flat = match tolerance {
                        Ok(tolerance) => !is_split && tip::is_flat(rough, tolerance / strain),
                        Err(obstacle) if is_last => return Err(obstacle),
                        Err(_) => false,
                    };
                    if is_flat || is_last {
                        let (u, v) = ([u, u + width], [v, v + width]);
                        grounds.push(Ground {
                            sheet: sheet as u32,
                            u,
                            v,
                            shape: Shape::Rough(rough),
                            off: 0.0,
                        });
                        continue;
                    }
                    let Ok(quarters) = rough.quarters() else { continue };
                    let half = 0.5 * width;
                    let places = [[u, v], [u + half, v], [u + half, v + half], [u, v + half]];
                    open.extend(
                        quarters.iter().zip(places).map(|(quarter, at)| (quarter, at, depth + 1)).rev(),
                    );
                }
            }
        }
        Ok(grounds)
    }

    fn quilt(&self) -> Quilt {
        let n = self.sheets.len();
        let mut classes = Sets::new(4 * n);
        self.same.iter().for_each(|[a, b]| classes.join(*a, *b));
        let (number, count) = classes.numbered();
        let corners: Vec<[u32; 4]> = (0..n).map(|s| std::array::from_fn(|k| number[4 * s + k])).collect();
        let mut positions = vec![None; count];
        for (sheet, ids) in self.sheets.iter().zip(&corners) {
            let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            for ((u, v), id) in places.into_iter().zip(ids) {
                let position = &mut positions[*id as usize];
                if position.is_none() {
                    *position = sheet.at(u, v).ok().map(|jet| jet.point);
                }
            }
        }
        let edge = |(uses, ends): &(Vec<Use>, [Option<u32>; 2])| Edge {
            ends: ends.map(|end| end.map_or(0, |end| number[end as usize])),
            uses: uses.clone(),
            least: 1,
        };
        let mut quilt = Quilt {
            edges: self.edges.iter().map(edge).collect(),
            seams: self.seams.clone(),
            meetings: meetings(&self.seams),
            corners,
            corner_positions: positions.into_iter().map(Option::unwrap_or_default).collect(),
        };
        quilt.set_least_segments();
        quilt
    }

    fn longest_diagonal(&self) -> f64 {
        let own = |sheet: &Sheet| {
            let (hull, lost) = match sheet.square() {
                Some(Square::Rough(rough)) => (Box3::around(rough.ring().hull()), rough.lost()),
                None => return 0.0,
                Some(Square::Patches(patches)) => {
                    let points = patches.pieces.iter().flat_map(|piece| piece.patch.control.iter().flatten());
                    (Box3::around(points), patches.off)
                }
            };
            let diagonal = hull.diagonal();
            if diagonal > lost { diagonal } else { lost }
        };
        self.sheets.iter().map(own).fold(0.0, |longest, d| if d > longest { d } else { longest })
    }

    fn reference(&self) -> Reference {
        Reference::LimitSurface
    }

    fn has_texcoords(&self) -> bool {
        self.texcoords.is_some()
    }

    fn texcoords(&self, sheet: usize) -> Option<Sheet> {
        self.texcoords.as_ref()?.sheet(sheet)
    }
}

type Rectangle = (Patch, [f64; 2], [f64; 2]);

/// Cuts a patch where it reaches over the middle of its sheet, in the directions that ask for it.
fn cut_in_middle(whole: Rectangle, [in_u, in_v]: [bool; 2]) -> Vec<Rectangle> {
    let reaches = |[from, to]: [f64; 2]| from < 0.5 && to > 0.5;
    // The middle of the sheet is the middle of what reaches over it, but for strips beside creases, whose begin is dyadic.
    let share = |[from, to]: [f64; 2]| (0.5 - from) / (to - from);
    let mut parts = vec![whole];
    if in_u && reaches(whole.1) {
        let (patch, u, v) = whole;
        let at = share(u);
        let (left, right) = (patch.part([0.0, at], [0.0, 1.0]), patch.part([at, 1.0], [0.0, 1.0]));
        parts = vec![(left, [u[0], 0.5], v), (right, [0.5, u[1]], v)];
    }
    if in_v && reaches(whole.2) {
        let cut = |(patch, u, v): Rectangle| {
            let at = share(v);
            let (low, high) = (patch.part([0.0, 1.0], [0.0, at]), patch.part([0.0, 1.0], [at, 1.0]));
            [(low, u, [v[0], 0.5]), (high, u, [0.5, v[1]])]
        };
        parts = parts.into_iter().flat_map(cut).collect();
    }
    parts
}
