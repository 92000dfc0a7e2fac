//! The limit surfaces of cages within a budget, beside uniform levels: `limit_meshes CAGE...` prints a line
//! of JSON for each cage and budget.
//!
//! **Uniform levels.** Level n has the vertices of n rounds, moved to the limit by masks, and two triangles a
//! quad. All levels of a cage are every so many-th vertex of one fine level: a vertex stays on its limit
//! point. So levels are on the true limit surface even where creases have not ended.
//!
//! **Measured error.** Nothing of `cage_to_mesh` takes part in it. From the surface: the largest distance to
//! the mesh, of the fine level's vertices, and of points of `Sheet::at` that come ever closer to corners and
//! sides. To the surface: the largest distance of points spread over the triangles from the fine level's
//! triangles. Both are distances of samples, and the same samples for both sides.
use chordal::budget::{Budget, Job, Tolerance};
use chordal::check::{Goal, deviation};
use chordal::convert::cage_to_mesh;
use chordal::explicit::Cage;
use chordal::explicit::query::Bvh;
use chordal::{Mesh, math::Box3};
use chordal_bench::cages::read;
use std::time::Instant;

type Point = [f64; 3];

/// Budgets as shares of the diagonal of the cage's box.
const SHARES: [f64; 2] = [1e-2, 1e-3];
/// The deepest level that is tried, and the most triangles of one; chosen.
const DEEPEST: u32 = 7;
const MOST: usize = 4_000_000;
/// What counts as no error on flat cages, as a share of the diagonal; far above the rounding of masks.
/// Chosen.
const ROUNDING: f64 = 1e-12;
/// Quads of a fine level, unless a level comes too close to it; and then. Chosen.
const QUADS: usize = 450_000;
const MORE_QUADS: usize = 3_000_000;

/// A level so fine that it stands for the limit surface.
struct Fine {
    level: u32,
    /// On the limit surface.
    points: Vec<Point>,
    /// Quads of the first round, as rows of vertices, `side + 1` each way.
    grids: Vec<Vec<u32>>,
    mesh: Mesh,
    bvh: Bvh,
}

/// The vertices of quads on their limit surface, by masks: smooth, on a crease, in a corner.
fn limit_points(cage: &Cage) -> Vec<Point> {
    let n = cage.positions().len();
    let at = |v: u32| cage.positions()[v as usize];
    // Edges with the direction in which a face runs along them; the smooth ones have one use each way.
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(4 * cage.n_faces());
    let (mut sums, mut counts) = (vec![[0.0; 3]; n], vec![0_u32; n]);
    for face in cage.faces() {
        for k in 0..4 {
            let (v, next, across) = (face[k], face[(k + 1) % 4], face[(k + 2) % 4]);
            edges.push((v.min(next), v.max(next), v < next));
            counts[v as usize] += 1;
            let (next, across) = (at(next), at(across));
            (0..3).for_each(|i| sums[v as usize][i] += 4.0 * next[i] + across[i]);
        }
    }
    edges.sort_unstable();
    let mut sharp: Vec<[u32; 2]> = Vec::new();
    for run in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if !matches!(run, [(.., false), (.., true)]) {
            sharp.push([run[0].0, run[0].1]);
        }
    }
    sharp.extend(
        cage.creases()
            .iter()
            .filter(|(_, sharpness)| *sharpness > 0.0)
            .map(|([a, b], _)| [*a.min(b), *a.max(b)]),
    );
    sharp.sort_unstable();
    sharp.dedup();
    let mut around: Vec<(u32, u32)> = sharp.iter().flat_map(|[a, b]| [(*a, *b), (*b, *a)]).collect();
    around.sort_unstable();
    let smooth = |v: usize| {
        let m = f64::from(counts[v]);
        let p = at(v as u32);
        [0, 1, 2].map(|i| (m * m * p[i] + sums[v][i]) / (m * m + 5.0 * m))
    };
    let mut points: Vec<Point> =
        (0..n).map(|v| if counts[v] == 0 { at(v as u32) } else { smooth(v) }).collect();
    for run in around.chunk_by(|a, b| a.0 == b.0) {
        let v = run[0].0;
        match run {
            [_] => {}
            [(_, a), (_, b)] => {
                let (p, a, b) = (at(v), at(*a), at(*b));
                points[v as usize] = [0, 1, 2].map(|i| (4.0 * p[i] + a[i] + b[i]) / 6.0);
            }
            _ => points[v as usize] = at(v),
        }
    }
    for (v, sharpness) in cage.sharp_vertices() {
        if *sharpness > 0.0 {
            points[*v as usize] = at(*v);
        }
    }
    points
}

/// How many quads the first round makes.
fn n_parts(cage: &Cage) -> usize {
    cage.faces().map(<[u32]>::len).sum()
}

impl Fine {
    fn of(cage: &Cage, quads: usize) -> Self {
        let mut level = 2;
        while n_parts(cage) << (2 * level) <= quads {
            level += 1;
        }
        let fine = cage.refined_times(level).expect("refined");
        let points = limit_points(&fine);
        let side = 1_usize << (level - 1);
        let mut grids = Vec::new();
        for part in 0..n_parts(cage) {
            let first = part * side * side;
            if fine.holes().binary_search(&(first as u32)).is_ok() {
                grids.push(Vec::new());
                continue;
            }
            let corner = |i: usize, j: usize, k: usize| fine.face(first + j * side + i)[k];
            let mut grid = Vec::with_capacity((side + 1) * (side + 1));
            for j in 0..=side {
                for i in 0..=side {
                    let (column, row) = (i.min(side - 1), j.min(side - 1));
                    let k = [[0, 1], [3, 2]][usize::from(j == side)][usize::from(i == side)];
                    let v = corner(column, row, k);
                    assert!(i == 0 || j == side || corner(i - 1, j, 1) == v, "rows run otherwise");
                    assert!(j == 0 || i == side || corner(i, j - 1, 3) == v, "columns run otherwise");
                    grid.push(v);
                }
            }
            grids.push(grid);
        }
        let mesh = triangles(&points, &grids, (side, 1));
        let bvh = Bvh::build(&mesh, &Job::default()).expect("a tree");
        Self { level, points, grids, mesh, bvh }
    }

    /// The triangles of a level, which is no finer than this one.
    fn uniform(&self, cage: &Cage, level: u32) -> Mesh {
        if level > 0 {
            let side = 1 << (self.level - 1);
            return triangles(&self.points, &self.grids, (side, 1 << (self.level - level)));
        }
        // The vertices of a cage come first in all of its levels.
        let mut faces = Vec::new();
        let mut part = 0;
        for face in cage.faces() {
            if !self.grids[part].is_empty() {
                assert_eq!(self.grids[part][0], face[0], "vertices are numbered otherwise");
                faces.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
            }
            part += face.len();
        }
        Mesh::new(self.points.clone(), faces).expect("a mesh")
    }
}

/// Two triangles for every square of `step` between points.
fn triangles(points: &[Point], grids: &[Vec<u32>], (side, step): (usize, usize)) -> Mesh {
    let mut faces = Vec::new();
    for grid in grids.iter().filter(|grid| !grid.is_empty()) {
        let at = |i: usize, j: usize| grid[j * (side + 1) + i];
        for j in (0..side).step_by(step) {
            for i in (0..side).step_by(step) {
                let [a, b, c, d] = [at(i, j), at(i + step, j), at(i + step, j + step), at(i, j + step)];
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new(points.to_vec(), faces).expect("a mesh")
}

/// Points of the limit surface that come ever closer to corners and sides of its sheets.
fn close_samples(cage: &Cage) -> Vec<Point> {
    let limit = cage.limit().expect("a limit surface");
    let mut samples = Vec::new();
    for sheet in 0..limit.n_sheets() {
        let sheet = limit.sheet(sheet).expect("a sheet");
        let mut take = |u: f64, v: f64| samples.push(sheet.at(u, v).expect("a point").point);
        // From a quarter of the sheet to the scale where the surface is its tangents for any budget here;
        // chosen.
        for depth in 2..10 {
            let near = 1.0 / f64::from(1 << depth);
            for (a, b) in [(1.0, 1.0), (1.0, 0.6), (0.6, 1.0), (1.0, 0.2), (0.2, 1.0)] {
                let (a, b) = (near * a, near * b);
                [(a, b), (1.0 - b, a), (1.0 - a, 1.0 - b), (b, 1.0 - a)]
                    .into_iter()
                    .for_each(|(u, v)| take(u, v));
            }
            for k in 0..8 {
                let along = (f64::from(k) + 0.5) / 8.0;
                [(along, near), (along, 1.0 - near), (near, along), (1.0 - near, along)]
                    .into_iter()
                    .for_each(|(u, v)| take(u, v));
            }
        }
    }
    samples
}

/// Points spread over triangles, corners, middles of sides and centres among them.
fn spread(mesh: &Mesh) -> Vec<Point> {
    // Some 300,000 in all, but at least 28 a triangle; chosen.
    let n = ((6e5 / mesh.faces().len() as f64).sqrt() as u32 / 6 * 6).clamp(6, 60);
    let mut samples = Vec::new();
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face);
        for i in 0..=n {
            for j in 0..=n - i {
                let weights = [i, j, n - i - j].map(|w| f64::from(w) / f64::from(n));
                samples.push([0, 1, 2].map(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum()));
            }
        }
    }
    samples
}

fn farthest(samples: &[Point], bvh: &Bvh) -> f64 {
    let squares = bvh.closest_points(samples, &Job::default()).into_iter();
    squares.map(|closest| closest.map_or(f64::INFINITY, |c| c.distance_sq)).fold(0.0, f64::max).sqrt()
}

/// The measured error of a mesh: from the surface, and to it.
fn measured(mesh: &Mesh, fine: &Fine, close: &[Point]) -> [f64; 2] {
    let bvh = Bvh::build(mesh, &Job::default()).expect("a tree");
    let from = farthest(&fine.points_of_surface(), &bvh).max(farthest(close, &bvh));
    [from, farthest(&spread(mesh), &fine.bvh)]
}

impl Fine {
    /// Its vertices on faces that carry surface.
    fn points_of_surface(&self) -> Vec<Point> {
        let mut used = vec![false; self.points.len()];
        self.mesh.faces().as_flattened().iter().for_each(|v| used[*v as usize] = true);
        self.points.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| *p).collect()
    }
}

fn worse(error: [f64; 2]) -> f64 {
    error[0].max(error[1])
}

fn compare(path: &str) {
    let name = path.rsplit('/').next().unwrap_or(path).trim_end_matches(".obj");
    let cage = match read(path) {
        Ok(cage) => cage,
        Err(error) => return println!("{{\"cage\": \"{name}\", \"refused\": \"{error}\"}}"),
    };
    let diagonal = Box3::from_points(cage.positions()).diagonal();
    let close = close_samples(&cage);
    let mut fine = Fine::of(&cage, QUADS);
    let mut levels: Vec<(usize, f64)> = Vec::new();
    for share in SHARES {
        let budget = Budget::length(Tolerance::new(share * diagonal).expect("a length"));
        let start = Instant::now();
        let ours = cage_to_mesh(&cage, &budget, &Job::default()).expect("a mesh");
        let seconds = start.elapsed().as_secs_f64();
        let n_ours = ours.shape.faces().len();
        let bound = ours.bound.at_most().expect("a bound");
        let mut error = measured(&ours.shape, &fine, &close);
        let mut level = 0;
        let found = loop {
            let n = fine.grids.iter().filter(|grid| !grid.is_empty()).count() << (2 * level) >> 1;
            if level > DEEPEST || n > MOST {
                break None;
            }
            // A level must be two rounds coarser than what it is measured against.
            if level + 2 > fine.level {
                let finer = Fine::of(&cage, MORE_QUADS);
                if finer.level == fine.level {
                    break None;
                }
                fine = finer;
                levels.clear();
                error = measured(&ours.shape, &fine, &close);
                level = 0;
                continue;
            }
            if levels.len() == level as usize {
                let mesh = fine.uniform(&cage, level);
                levels.push((mesh.faces().len(), worse(measured(&mesh, &fine, &close))));
            }
            let (n, theirs) = levels[level as usize];
            if theirs <= worse(error).max(ROUNDING * diagonal) {
                break Some((level, n, theirs));
            }
            level += 1;
        };
        let off = farthest(&close, &fine.bvh);
        let full =
            deviation(&ours.shape, &fine.mesh, &Goal::default(), &Job::default()).expect("a distance").bound;
        let (last, error) = (levels.last().expect("a level"), error.map(|e| e / diagonal));
        let (level, n, theirs) = found.map_or((-1, last.0, last.1), |(level, n, e)| (i64::from(level), n, e));
        println!(
            "{{\"cage\": \"{name}\", \"share\": {share:e}, \"faces\": {}, \"ours\": {n_ours}, \"bound\": {:e}, \"from\": {:e}, \"to\": {:e}, \
             \"enclosed\": [{:e}, {:e}], \"seconds\": {seconds:.4}, \"level\": {level}, \"theirs\": {n}, \"their_error\": {:e}, \
             \"fine\": {}, \"levels\": {:?}, \"off\": {:e}}}",
            cage.n_faces(),
            bound / diagonal,
            error[0],
            error[1],
            full.at_least() / diagonal,
            full.at_most().unwrap_or(f64::INFINITY) / diagonal,
            theirs / diagonal,
            fine.level,
            levels.iter().map(|(n, error)| (*n as f64, error / diagonal).into()).collect::<Vec<[f64; 2]>>(),
            off / diagonal,
        );
    }
}

pub fn main() {
    std::env::args().skip(1).for_each(|path| compare(&path));
}
