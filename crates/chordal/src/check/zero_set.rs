//! The distance between the zero set of an interpolant on a lattice of cubes and triangles, in both
//! directions.
use crate::budget::{Bound, Job, JobError, Reference, Tolerance, par_map};
use crate::explicit::{Bvh, Mesh};
use crate::implicit::evaluation::SampleGrid;
use crate::math::{add_up, cross, difference, distance, dot, greater, length, lesser};
use std::sync::atomic::{AtomicBool, Ordering};

/// Proves that the surface on which the trilinear interpolant of samples changes its sign is within `max` of
/// triangles, and the triangles within `max` of it; `None` if that is not proved. The bound is the proved
/// distance, at most `max`.
///
/// *What it covers.* All points of both, rounding included, for any samples. *To the triangles:* cells with
/// both signs are halved until no point of a part is farther than `max`; on a part that lies over one
/// triangle, the interpolant minus the height over its plane is trilinear, so that the corners of the part
/// bound the height where the interpolant vanishes. *From the triangles:* each is cut until the interpolant
/// has both signs near the middle of a piece; over larger pieces, it has them a little above and below by the
/// same trilinear difference.
///
/// *Cost.* About a microsecond for each square with the side `max` on either surface; far less if triangles
/// are large and flat.
///
/// # Errors
/// As for [`Bvh::build`]; [`JobError::Cancelled`].
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::{Job, Mesh, Tolerance, check::zero_set_deviation};
/// // The heights over the faces of an octahedron.
/// let corners = (0..6).map(|i| { let mut p = [3.5; 3]; p[i / 2] += if i % 2 == 0 { 3.0 } else { -3.0 }; p }).collect();
/// let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mesh = Mesh::new(corners, faces).unwrap();
/// let value = |p: [f64; 3]| (p.iter().map(|x| (x - 3.5).abs()).sum::<f64>() - 3.0) / 3.0_f64.sqrt();
/// let samples = (0..512_u32).map(|n| value([n % 8, n / 8 % 8, n / 64].map(f64::from))).collect();
/// let grid = Grid::new([8; 3], Samples::F64(samples), Affine3::IDENTITY)?;
/// let within = |max: f64| zero_set_deviation(&mesh, &grid, Tolerance::new(max).unwrap(), &Job::default());
/// assert!(within(1.5).unwrap().unwrap().at_most().unwrap() <= 1.5);
/// assert!(within(0.01).unwrap().is_none());
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
pub fn zero_set_deviation<G: SampleGrid>(
    mesh: &Mesh,
    grid: &G,
    max: Tolerance,
    job: &Job,
) -> Result<Option<Bound>, JobError> {
    let Some(lattice) = CubeLattice::new(grid, mesh) else { return Ok(None) };
    let bvh = Bvh::build(mesh, job)?;
    let [nx, ny, nz] = grid.size();
    let n_tasks = mesh.faces().len().div_ceil(CHUNK) + nz;
    // A limit for each task and not for all: a common counter would depend on the order of the
    // threads.
    let most_parts =
        greater((job.work_left() / POINTS_A_PART / n_tasks as u64).saturating_mul(SHARES_A_TASK), 1);
    let failed = AtomicBool::new(false);
    let proof = ZeroSetProof { lattice, bvh: &bvh, mesh, max: max.get(), failed, job, most_parts };
    if nx < 2 || ny < 2 || nz < 2 || mesh.faces().is_empty() {
        return Ok(None);
    }
    // A violation usually shows at corners and edges, which take next to no time, so they come first.
    if (0..mesh.faces().len()).any(|face| proof.is_far(mesh.corners(face))) {
        return Ok(None);
    }
    let faces: Vec<usize> = (0..mesh.faces().len()).collect();
    let chunks: Vec<&[usize]> = faces.chunks(CHUNK).collect();
    let to_zeros = par_map(job, &chunks, |_, chunk| {
        let mut parts = 0;
        let most = chunk.iter().fold(0.0, |most, face| greater(most, proof.face_distance(*face, &mut parts)));
        (most, parts)
    });
    let layers: Vec<usize> = (0..nz - 1).collect();
    let to_faces = par_map(job, &layers, |_, k| proof.layer_distance(*k));
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    if proof.failed.into_inner() {
        return Ok(None);
    }
    let (most, parts) = to_zeros
        .into_iter()
        .chain(to_faces)
        .fold((0.0, 0), |(most, parts), (distance, n_own)| (greater(most, distance), parts + n_own));
    job.count_work(POINTS_A_PART * parts);
    Ok(Some(Bound::proved(0.0, most, Reference::InputTriangles)))
}

/// Triangles in one task.
const CHUNK: usize = 64;
/// Work units of a part of a cell or of a triangle. Chosen: it queries a nearest triangle, or takes some
/// dozens of samples.
const POINTS_A_PART: u64 = 64;
/// A task may evaluate this multiple of its share of the parts that the job may evaluate; if it reaches that,
/// nothing is proved, independent of the order of tasks. Chosen: tasks differ, and few of them are at the
/// surface.
const SHARES_A_TASK: u64 = 16;

/// A lattice of axis-parallel boxes whose border is outside, with an allowance for rounding.
struct CubeLattice<'a, G> {
    grid: &'a G,
    step: [f64; 3],
    origin: [f64; 3],
    /// A bound on the rounding of every position, height and value that is computed here.
    slack: f64,
}

/// A part of a cell: its lower corner and its size in cells, both exact, and the interpolant at its corners.
#[derive(Clone, Copy)]
struct CubePart {
    low: [f64; 3],
    size: f64,
    values: [f64; 8],
}

impl<'a, G: SampleGrid> CubeLattice<'a, G> {
    /// `None` if the axes are turned, a sample is NaN, or the surface reaches the border.
    fn new(grid: &'a G, mesh: &Mesh) -> Option<Self> {
        let (rows, size) = (grid.affine().rows(), grid.size());
        let is_straight =
            (0..3).all(|k| (0..3).all(|l| if k == l { rows[k][l] > 0.0 } else { rows[k][l] == 0.0 }));
        let (mut far, mut largest): (f64, f64) = (0.0, 0.0);
        for k in 0..3 {
            far = greater(rows[k][k] * size[k] as f64 + rows[k][3].abs(), far);
        }
        let bounds = mesh.bounds();
        far = bounds.min.iter().chain(&bounds.max).fold(far, |most, x| greater(x.abs(), most));
        let mut is_sound = is_straight && far.is_finite();
        for k in 0..size[2] {
            for j in 0..size[1] {
                let side = k == 0 || k + 1 == size[2] || j == 0 || j + 1 == size[1];
                for i in 0..size[0] {
                    let value = grid.sample([i, j, k]);
                    let is_border = side || i == 0 || i + 1 == size[0];
                    // This excludes NaN, too.
                    is_sound &= value.is_finite() && (!is_border || value > 0.0);
                    largest = greater(value.abs(), largest);
                }
            }
        }
        // Derived: a position has three roundings of numbers up to `far`, a height over a plane through a triangle
        // that is not thin some dozens, and a value ten for each halving, of which
        // there are fewer than fifty. A value's change with its place
        // is at most its samples' difference over a step.
        let slack = 512.0 * f64::EPSILON * (far + largest) * (1.0 + 2.0 * largest / shortest(&rows));
        is_sound.then(|| Self {
            grid,
            step: [rows[0][0], rows[1][1], rows[2][2]],
            origin: rows.map(|row| row[3]),
            slack: if slack.is_finite() { slack } else { f64::INFINITY },
        })
    }

    fn at(&self, index: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.step[k] * index[k] + self.origin[k])
    }

    fn index_of(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (p[k] - self.origin[k]) / self.step[k])
    }

    fn cell(&self, low: [usize; 3]) -> CubePart {
        let values =
            std::array::from_fn(|c| self.grid.sample(std::array::from_fn(|k| low[k] + (c >> k & 1))));
        CubePart { low: low.map(|i| i as f64), size: 1.0, values }
    }

    /// The interpolant at a position, by its index.
    fn value(&self, index: [f64; 3]) -> f64 {
        let size = self.grid.size();
        let low: [usize; 3] = std::array::from_fn(|k| {
            let floor = if index[k] > 0.0 { index[k].floor() as usize } else { 0 };
            floor.min(size[k] - 2)
        });
        let part = self.cell(low);
        part.value(std::array::from_fn(|k| (index[k] - low[k] as f64).clamp(0.0, 1.0)))
    }
}

fn shortest(rows: &[[f64; 4]; 3]) -> f64 {
    (0..3).fold(f64::INFINITY, |least, k| lesser(rows[k][k].abs(), least))
}

impl CubePart {
    /// The interpolant at fractions of the part.
    fn value(&self, [x, y, z]: [f64; 3]) -> f64 {
        let v = &self.values;
        let along = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        let line = |k: usize| along(v[k], v[k + 1], x);
        along(along(line(0), line(2), y), along(line(4), line(6), y), z)
    }

    fn corner(&self, c: usize) -> [f64; 3] {
        std::array::from_fn(|k| self.low[k] + if c >> k & 1 == 1 { self.size } else { 0.0 })
    }

    /// The least and the largest of the values at the corners.
    fn ends(&self) -> [f64; 2] {
        let fold = |pick: fn(f64, f64) -> f64| self.values.iter().copied().reduce(pick).unwrap_or(0.0);
        [fold(lesser), fold(greater)]
    }

    fn eighth(&self, c: usize) -> Self {
        let size = 0.5 * self.size;
        let part = |k: usize| if c >> k & 1 == 1 { 0.5 } else { 0.0 };
        let values = std::array::from_fn(|corner| {
            self.value(std::array::from_fn(|k| part(k) + if corner >> k & 1 == 1 { 0.5 } else { 0.0 }))
        });
        Self { low: std::array::from_fn(|k| self.low[k] + part(k) * self.size), size, values }
    }
}

/// A plane through a triangle that is not thin, with its sides.
struct FacePlane {
    corner: [f64; 3],
    normal: [f64; 3],
    /// Unit vectors in the plane, inwards, with a corner of their side.
    sides: [([f64; 3], [f64; 3]); 3],
}

impl FacePlane {
    /// `None` for a thin triangle, whose normal may be wrong by rounding.
    fn new(corners: [[f64; 3]; 3]) -> Option<Self> {
        let edges: [[f64; 3]; 3] = std::array::from_fn(|k| difference(corners[(k + 1) % 3], corners[k]));
        let n = cross(edges[0], edges[1]);
        let longest = edges.iter().fold(0.0, |most, e| greater(dot(*e, *e), most));
        // An aspect of about 1:8; then directions lose three bits.
        if dot(n, n) <= longest * longest / 64.0 {
            return None;
        }
        let unit = |v: [f64; 3]| v.map(|x| x / length(v));
        let normal = unit(n);
        let sides = std::array::from_fn(|k| (corners[k], unit(cross(normal, edges[k]))));
        Some(Self { corner: corners[0], normal, sides })
    }

    fn height(&self, p: [f64; 3]) -> f64 {
        dot(self.normal, difference(p, self.corner))
    }

    /// Whether the foot of the perpendicular from a point is on the triangle, up to rounding.
    fn holds(&self, p: [f64; 3]) -> bool {
        self.sides.iter().all(|(corner, inward)| dot(*inward, difference(p, *corner)) >= 0.0)
    }
}

struct ZeroSetProof<'a, G> {
    lattice: CubeLattice<'a, G>,
    bvh: &'a Bvh,
    mesh: &'a Mesh,
    max: f64,
    failed: AtomicBool,
    job: &'a Job,
    /// The number of parts that a task may evaluate.
    most_parts: u64,
}

impl<G: SampleGrid> ZeroSetProof<'_, G> {
    fn fail(&self) -> f64 {
        self.failed.store(true, Ordering::Relaxed);
        f64::INFINITY
    }

    fn is_over(&self) -> bool {
        self.failed.load(Ordering::Relaxed) || self.job.is_cancelled()
    }

    /// Counts a part that a task evaluates; returns whether it is one too many.
    fn is_too_many(&self, parts: &mut u64) -> bool {
        *parts += 1;
        *parts > self.most_parts
    }

    /// The distance of the zeros in a layer of cells from the triangles, and the number of parts evaluated.
    fn layer_distance(&self, k: usize) -> (f64, u64) {
        let [nx, ny, _] = self.lattice.grid.size();
        let (mut most, mut row, mut parts) = (0.0, 0, Vec::new());
        let mut n_evaluated = 0;
        for j in 0..ny - 1 {
            if self.is_over() {
                return (f64::INFINITY, n_evaluated);
            }
            for i in 0..nx - 1 {
                parts.push(self.lattice.cell([i, j, k]));
                while let Some(part) = parts.pop() {
                    let [low, high] = part.ends();
                    // No zero is outside the hull of the corners.
                    if low > self.lattice.slack || high < -self.lattice.slack {
                        continue;
                    }
                    if self.is_too_many(&mut n_evaluated) {
                        return (self.fail(), n_evaluated);
                    }
                    match self.part_distance(&part, &mut row) {
                        Some(distance) => most = greater(distance, most),
                        None if self.is_over() => return (f64::INFINITY, n_evaluated),
                        None => parts.extend((0..8).map(|c| part.eighth(c))),
                    }
                }
            }
        }
        (most, n_evaluated)
    }

    /// The distance of the zeros of a part from the triangles, if that is within the limit.
    fn part_distance(&self, part: &CubePart, row: &mut u32) -> Option<f64> {
        let CubeLattice { slack, step, .. } = self.lattice;
        let half = 0.5 * part.size;
        let middle = self.lattice.at(part.low.map(|x| x + half));
        let radius = half * length(step) + slack;
        let (_, nearest) = self.bvh.distance_with_hint(middle, *row)?;
        *row = nearest;
        let [_, up] = self.bvh.distance_bounds(middle, nearest)?;
        // Every point of the part is near its middle, and the middle near a triangle.
        let first = add_up(up, radius);
        if first <= self.max {
            return Some(first);
        }
        // The plane through the triangle speaks for the triangle only where the part projects into
        // it, which is convex: it is enough that the corners do.
        let corners: [[f64; 3]; 8] = std::array::from_fn(|c| self.lattice.at(part.corner(c)));
        let (triangle, _) = self.bvh.triangle_of(nearest);
        let plane = FacePlane::new(triangle).filter(|plane| corners.iter().all(|p| plane.holds(*p)));
        // Where the interpolant vanishes, the height over the plane is the height less the interpolant, which is
        // trilinear, and so no larger than at the corners.
        let second = plane.map(|plane| greatest_gap(&plane, &corners, &part.values) + 2.0 * slack);
        if let Some(second) = second.filter(|second| *second <= self.max) {
            return Some(second);
        }
        // There are zeros, and they are too far; or the part is so small that a smaller one would not help.
        let [low, high] = part.ends();
        let is_crossed = low < -slack && high > slack;
        if is_crossed && up - 2.0 * radius > self.max || radius < self.max / 8.0 || radius <= 2.0 * slack {
            self.fail();
        }
        None
    }

    /// Whether the interpolant is so large at a corner or at the middle of an edge that a zero within the
    /// limit is unlikely.
    fn is_far(&self, corners: [[f64; 3]; 3]) -> bool {
        (0..3).any(|k| {
            let next = corners[(k + 1) % 3];
            let middle = std::array::from_fn(|axis| 0.5 * corners[k][axis] + 0.5 * next[axis]);
            let is_far = |p| self.value_at(p).abs() > self.max + self.lattice.slack;
            is_far(corners[k]) || is_far(middle)
        })
    }

    /// The distance of a triangle from the zeros; counts the pieces into which it is cut.
    fn face_distance(&self, face: usize, n_evaluated: &mut u64) -> f64 {
        let corners = self.mesh.corners(face);
        let plane = FacePlane::new(corners);
        // Of the whole face, since pieces of it are too small to have a good one. A face without
        // area gets no direction, and is left to the signs around its pieces.
        let direction = {
            let n = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
            let size = length(n);
            if size > 0.0 { n.map(|x| x / size) } else { [0.0; 3] }
        };
        let (mut most, mut pieces) = (0.0, vec![corners]);
        while let Some(piece) = pieces.pop() {
            if self.is_over() {
                return f64::INFINITY;
            }
            if self.is_too_many(n_evaluated) {
                return self.fail();
            }
            let CubeLattice { slack, .. } = self.lattice;
            let middle: [f64; 3] = std::array::from_fn(|k| (piece[0][k] + piece[1][k] + piece[2][k]) / 3.0);
            let radius = piece.iter().fold(0.0, |most, p| greater(distance(*p, middle), most)) + slack;
            // A small piece is compared with the values around its middle, a large one with its plane.
            let bound = if radius < 0.5 * self.max {
                let around = || self.signs_around(middle, radius);
                self.both_signs(middle, radius, direction)
                    .or_else(|| (radius < 0.25 * self.max).then(around).flatten())
            } else {
                plane.as_ref().and_then(|plane| self.sandwiched(plane, &piece))
            };
            if let Some(distance) = bound {
                most = greater(distance, most);
                continue;
            }
            if radius < self.max / 8.0 || radius <= 2.0 * slack {
                return self.fail();
            }
            let half = |a: usize, b: usize| -> [f64; 3] {
                std::array::from_fn(|k| 0.5 * piece[a][k] + 0.5 * piece[b][k])
            };
            let (ab, bc, ca) = (half(0, 1), half(1, 2), half(2, 0));
            pieces.extend([[piece[0], ab, ca], [ab, piece[1], bc], [ca, bc, piece[2]], [ab, bc, ca]]);
        }
        most
    }

    /// The distance of a piece from a zero, if the interpolant has both signs around its middle, so near that
    /// the zero between them is within the limit of any point of the piece.
    fn both_signs(&self, middle: [f64; 3], radius: f64, direction: [f64; 3]) -> Option<f64> {
        let slack = self.lattice.slack;
        self.reaches(radius)?.into_iter().find_map(|reach| {
            let beside = |t: f64| self.value_at(std::array::from_fn(|k| middle[k] + t * direction[k]));
            let (a, b) = (beside(reach), beside(-reach));
            let is_crossed = lesser(a, b) < -slack && greater(a, b) > slack;
            is_crossed.then(|| self.distance_around(radius, reach))
        })
    }

    /// The distances from the middle of a piece at which signs are evaluated; `None` if none is within the
    /// limit.
    fn reaches(&self, radius: f64) -> Option<[f64; SHARES.len()]> {
        let most = self.max - radius - 4.0 * self.lattice.slack;
        (most > 0.0).then(|| SHARES.map(|share| share * most))
    }

    /// The distance of a piece from a zero that is within a reach of its middle.
    fn distance_around(&self, radius: f64, reach: f64) -> f64 {
        lesser(add_up(add_up(radius, reach), 3.0 * self.lattice.slack), self.max)
    }

    /// The interpolant at a point; beyond the lattice, that of the nearest index, above 0.
    fn value_at(&self, p: [f64; 3]) -> f64 {
        self.lattice.value(self.lattice.index_of(p))
    }

    /// The same with points in many directions, as needed near an edge or a corner that the samples cut off:
    /// the ball around the middle is convex, so it contains a zero if it has both signs.
    fn signs_around(&self, middle: [f64; 3], radius: f64) -> Option<f64> {
        let slack = self.lattice.slack;
        let [.., reach] = self.reaches(radius)?;
        let (mut is_below, mut is_above) = (false, false);
        for n in 0..27_u32 {
            let direction = [n % 3, n / 3 % 3, n / 9].map(|x| f64::from(x) - 1.0);
            // The middle itself is one of the points.
            let share = if direction == [0.0; 3] { 0.0 } else { reach / length(direction) };
            let value = self.value_at(std::array::from_fn(|k| middle[k] + share * direction[k]));
            is_below |= value < -slack;
            is_above |= value > slack;
        }
        (is_below && is_above).then(|| self.distance_around(radius, reach))
    }

    /// A piece above and below which the interpolant has opposite signs, if it differs from the height over
    /// the plane by less than the limit.
    fn sandwiched(&self, plane: &FacePlane, piece: &[[f64; 3]; 3]) -> Option<f64> {
        let slack = self.lattice.slack;
        // If zeros are farther from a corner, the piece cannot be proved.
        let far = piece.iter().any(|p| self.value_at(*p).abs() > self.max);
        if far {
            return None;
        }
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in piece {
            let index = self.lattice.index_of(*p);
            for k in 0..3 {
                let reach = (self.max + slack) / self.lattice.step[k];
                low[k] = lesser(index[k] - reach, low[k]);
                high[k] = greater(index[k] + reach, high[k]);
            }
        }
        let size = self.lattice.grid.size();
        // Only boxes of a few cells, since larger ones may take much time.
        let is_within = (0..3).all(|k| {
            low[k] >= 0.0 && high[k] <= (size[k] - 1) as f64 && high[k].ceil() - low[k].floor() <= MOST_CELLS
        });
        if !is_within {
            return None;
        }
        // Between the planes of samples the difference is trilinear, so its extremes are at the corners of
        // the parts.
        let stops = |k: usize| {
            let mut stops = vec![low[k]];
            let mut next = low[k].floor() + 1.0;
            while next < high[k] {
                stops.push(next);
                next += 1.0;
            }
            stops.push(high[k]);
            stops
        };
        let (xs, ys, zs) = (stops(0), stops(1), stops(2));
        let mut most = [0.0; 2];
        for z in &zs {
            for y in &ys {
                for x in &xs {
                    let index = [*x, *y, *z];
                    let (value, height) = (self.lattice.value(index), plane.height(self.lattice.at(index)));
                    most =
                        [greater((value - height).abs(), most[0]), greater((value + height).abs(), most[1])];
                }
            }
            // Outward or inward.
            if lesser(most[0], most[1]) > self.max {
                return None;
            }
        }
        let distance = add_up(lesser(most[0], most[1]), 4.0 * slack);
        (distance <= self.max).then_some(distance)
    }
}

/// Shares of the longest reach, tried in this order, since a smaller one is a smaller bound. Chosen: more of
/// them take time, fewer give larger bounds.
const SHARES: [f64; 3] = [0.25, 0.5, 1.0];
/// The most cells along a piece that is compared at once. Chosen: larger boxes contain more samples than they
/// save pieces.
const MOST_CELLS: f64 = 4.0;

/// The largest difference between values at the corners of a box and their heights over a plane, whichever side of it
/// is the outside.
fn greatest_gap(plane: &FacePlane, corners: &[[f64; 3]; 8], values: &[f64; 8]) -> f64 {
    let mut most = [0.0; 2];
    for (p, value) in corners.iter().zip(values) {
        let height = plane.height(*p);
        most = [greater((value - height).abs(), most[0]), greater((value + height).abs(), most[1])];
    }
    lesser(most[0], most[1])
}
