//! The two-sided distance between a mesh and a surface, by dense samples and climbs to the maxima.
use super::climb::climb;
use super::surface::{Surface, evaluate};
use super::triangles::Triangles;
use super::vector::{Point, add, scale};

/// The density of the samples.
#[derive(Clone, Copy, Debug)]
pub struct SamplingEffort {
    /// The number of samples along each side of a patch.
    pub grid: usize,
    /// The number of the highest samples, of each patch or of the mesh, from which a climb starts.
    pub climbs: usize,
    /// The halvings of a climb's step.
    pub halvings: u32,
}

impl SamplingEffort {
    /// About three samples along each side of an average triangle.
    pub fn for_triangles(a_patch: usize) -> Self {
        let grid = (3.0 * (a_patch as f64 / 2.0).sqrt()) as usize;
        Self { grid: grid.clamp(32, 600), climbs: 12, halvings: 8 }
    }
}

/// The relative gap between a distance to the surface and its proved lower bound. Chosen: three digits
/// suffice, and smaller gaps take longer.
const PROOF: f64 = 1e-3;
/// The most further samples of a mesh whose feet may turn out not to be the nearest before the search gives
/// up. Chosen: such samples are rare.
const MOST_WRONG: usize = 200;

/// The measured distances, as lower bounds: each is attained at a sample, exactly up to rounding, or proved.
#[derive(Clone, Copy, Debug, Default)]
pub struct TwoSidedDistance {
    /// The distance from the surface to the mesh.
    pub to_mesh: f64,
    /// Its point on the surface.
    pub surface_at: Point,
    /// The distance from the mesh to the surface. The lower bound is proved by branch and bound, up to
    /// `PROOF`.
    pub to_surface: f64,
    /// Its point on the mesh.
    pub mesh_at: Point,
}

impl TwoSidedDistance {
    /// The larger of both distances.
    pub fn both(&self) -> f64 {
        self.to_mesh.max(self.to_surface)
    }
}

/// Both distances, with a density that fits the number of triangles.
pub fn measure(surface: &Surface, mesh: &Triangles) -> TwoSidedDistance {
    let effort = SamplingEffort::for_triangles(mesh.corners.len() / surface.patches.len().max(1));
    let (to_mesh, surface_at) = surface_to_mesh(surface, mesh, effort);
    let (to_surface, mesh_at) = mesh_to_surface(surface, mesh, effort);
    TwoSidedDistance { to_mesh, surface_at, to_surface, mesh_at }
}

/// The largest distance from a point of the surface to the mesh, and that point.
pub fn surface_to_mesh(surface: &Surface, mesh: &Triangles, effort: SamplingEffort) -> (f64, Point) {
    let first = surface.patches.first().map_or([0.0; 3], |control| control[0][0]);
    let mut worst = (0.0, first);
    for control in &surface.patches {
        let (n, mut guess) = (effort.grid, 0);
        let mut distance = |uv: [f64; 2]| {
            let (distance, triangle) = mesh.nearest(evaluate(control, uv), guess);
            guess = triangle;
            distance
        };
        let mut values = Vec::with_capacity((n + 1) * (n + 1));
        for i in 0..=n {
            for j in 0..=n {
                // Rows alternate in direction, so that the next sample is always a neighbour, which `guess`
                // relies on.
                let j = if i % 2 == 0 { j } else { n - j };
                let uv = [j as f64 / n as f64, i as f64 / n as f64];
                values.push((distance(uv), uv));
            }
        }
        highest_first(&mut values, effort.climbs);
        for &(value, uv) in values.iter().take(effort.climbs) {
            let (value, uv) = climb(uv, value, (0.5 / n as f64, effort.halvings), &mut distance);
            if value > worst.0 {
                worst = (value, evaluate(control, uv));
            }
        }
    }
    worst
}

/// Moves the `n` highest values to the front, sorted.
fn highest_first<T: Copy>(values: &mut [(f64, T)], n: usize) {
    if n < values.len() {
        values.select_nth_unstable_by(n, |a, b| b.0.total_cmp(&a.0));
    }
    let n = n.min(values.len());
    values[..n].sort_by(|a, b| b.0.total_cmp(&a.0));
}

/// The point of a triangle at `(a, b)` of the unit square, which is folded along its diagonal.
fn on_triangle([p, q, r]: [Point; 3], [a, b]: [f64; 2]) -> Point {
    let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
    add(scale(p, 1.0 - a - b), add(scale(q, a), scale(r, b)))
}

/// The largest distance from a point of the mesh to the surface, and that point.
pub fn mesh_to_surface(surface: &Surface, mesh: &Triangles, effort: SamplingEffort) -> (f64, Point) {
    const SAMPLES: [[f64; 2]; 5] = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5], [1.0 / 3.0, 1.0 / 3.0]];
    let mut values = Vec::with_capacity(SAMPLES.len() * mesh.corners.len());
    let mut foot = None;
    for (i, corners) in mesh.corners.iter().enumerate() {
        for ab in SAMPLES {
            let next = surface.nearest(on_triangle(*corners, ab), foot);
            values.push((next.distance, (i, ab, next)));
            foot = Some(next);
        }
    }
    let wanted = effort.climbs + MOST_WRONG;
    highest_first(&mut values, wanted);
    let mut worst = (0.0, mesh.corners.first().map_or([0.0; 3], |corners| corners[0]));
    for (n, &(value, (i, ab, foot))) in values.iter().take(wanted).enumerate() {
        // After the regular climbs, only samples above the proved distance matter: their feet were not the
        // nearest.
        if value <= surface.floor || (n >= effort.climbs && value <= worst.0) {
            break;
        }
        let corners = mesh.corners[i];
        let distance = |ab| surface.nearest(on_triangle(corners, ab), Some(foot)).distance;
        let (claim, ab) = climb(ab, value, (0.25, effort.halvings), distance);
        let p = on_triangle(corners, ab);
        if claim * (1.0 - PROOF) <= worst.0 {
            continue;
        }
        let foot = surface.proved_nearest(p, None, PROOF).filter(|foot| foot.distance > surface.floor);
        let proved = foot.map_or(0.0, |foot| foot.distance * (1.0 - PROOF));
        if proved > worst.0 {
            worst = (proved, p);
        }
    }
    worst
}
