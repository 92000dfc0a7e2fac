//! Which samples of a screen a mesh covers, and how far those are from what another covers. Plain arithmetic,
//! nothing of the library.
use chordal::Mesh;
use chordal_testkit::sampler::{Point, cross, dot};

type Spot = [f64; 2];

fn unit(a: Point) -> Point {
    let size = dot(a, a).sqrt();
    a.map(|x| x / size)
}

/// Three directions at right angles, the first of them given.
fn frame(first: Point, aside: Point) -> [Point; 3] {
    let second = unit(cross(first, aside));
    [first, second, cross(first, second)]
}

/// A pinhole over a square screen: columns run right, rows down.
pub struct Camera {
    eye: Point,
    /// Right, down, ahead.
    axes: [Point; 3],
    focal_px: f64,
    size_px: u32,
}

impl Camera {
    /// The eye that sees a point of space at a spot of the screen, in pixels; `aside` turns the picture
    /// around it.
    pub fn that_sees(p: Point, spot: Spot, eye: Point, size_px: u32, fov_deg: f64, aside: Point) -> Self {
        let half = 0.5 * f64::from(size_px);
        let focal_px = half / (0.5 * fov_deg.to_radians()).tan();
        // The direction of the spot in the frame of the camera, and that of the point in space, each with two
        // beside it.
        let seen = unit([spot[0] - half, spot[1] - half, focal_px]);
        let least = if seen[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let inner = frame(seen, least);
        let outer = frame(unit([0, 1, 2].map(|k| p[k] - eye[k])), aside);
        let axes =
            [0, 1, 2].map(|axis| [0, 1, 2].map(|k| (0..3).map(|i| outer[i][k] * inner[i][axis]).sum()));
        Self { eye, axes, focal_px, size_px }
    }

    /// Right, down, ahead.
    fn local(&self, p: Point) -> Point {
        let from_eye = [0, 1, 2].map(|k| p[k] - self.eye[k]);
        self.axes.map(|axis| dot(axis, from_eye))
    }

    fn spot(&self, [x, y, z]: Point) -> Spot {
        let half = 0.5 * f64::from(self.size_px);
        [half + self.focal_px * x / z, half + self.focal_px * y / z]
    }

    /// A triangle as it stands on the screen: what is ahead of the eye by more than a hair, in up to two
    /// pieces.
    fn project(&self, corners: [Point; 3]) -> Vec<[Spot; 3]> {
        let local = corners.map(|p| self.local(p));
        let reach = local.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let least = 1e-4 * reach;
        let mut kept: Vec<Point> = Vec::new();
        for k in 0..3 {
            let (p, q) = (local[k], local[(k + 1) % 3]);
            if p[2] >= least {
                kept.push(p);
            }
            if (p[2] >= least) != (q[2] >= least) {
                let t = (least - p[2]) / (q[2] - p[2]);
                kept.push([0, 1, 2].map(|k| p[k] + t * (q[k] - p[k])));
            }
        }
        let spots: Vec<Spot> = kept.into_iter().map(|p| self.spot(p)).collect();
        (2..spots.len()).map(|k| [spots[0], spots[k - 1], spots[k]]).collect()
    }
}

/// Samples along a side of a pixel.
const SAMPLES: usize = 4;
/// Pixels along a side of a cell, and how far around a sample cells are looked into: farther is "at least
/// this".
const CELL_PX: f64 = 2.0;
const FAR_PX: f64 = 8.0;

/// The triangles on a screen, which of its samples they cover, and which triangles are near a place.
pub struct Picture {
    n_samples: usize,
    covered: Vec<bool>,
    triangles: Vec<[Spot; 3]>,
    n_cells: usize,
    cells: Vec<Vec<u32>>,
}

fn area(a: Spot, b: Spot, c: Spot) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The lowest and highest coordinate of a triangle along an axis.
fn extent(t: &[Spot; 3], axis: usize) -> [f64; 2] {
    let x = t.map(|p| p[axis]);
    [x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2])]
}

fn holds(t: &[Spot; 3], p: Spot) -> bool {
    let s = [area(t[0], t[1], p), area(t[1], t[2], p), area(t[2], t[0], p)];
    s.iter().all(|x| *x >= 0.0) || s.iter().all(|x| *x <= 0.0)
}

/// The distance from a spot to a triangle of the screen.
fn to_triangle(p: Spot, t: &[Spot; 3]) -> f64 {
    if area(t[0], t[1], t[2]) != 0.0 && holds(t, p) {
        return 0.0;
    }
    let to_side = |k: usize| {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let s = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square;
        let s = if square > 0.0 { s.clamp(0.0, 1.0) } else { 0.0 };
        (p[0] - a[0] - s * along[0]).hypot(p[1] - a[1] - s * along[1])
    };
    (0..3).map(to_side).fold(f64::INFINITY, f64::min)
}

impl Picture {
    pub fn of(mesh: &Mesh, camera: &Camera) -> Self {
        let n_samples = SAMPLES * camera.size_px as usize;
        let n_cells = ((f64::from(camera.size_px) + 2.0 * FAR_PX) / CELL_PX).ceil() as usize;
        let mut picture = Self {
            n_samples,
            covered: vec![false; n_samples * n_samples],
            triangles: (0..mesh.faces().len()).flat_map(|f| camera.project(mesh.corners(f))).collect(),
            n_cells,
            cells: vec![Vec::new(); n_cells * n_cells],
        };
        for k in 0..picture.triangles.len() {
            picture.draw(k);
        }
        picture
    }

    /// The middle of a sample.
    fn sample(&self, i: usize) -> Spot {
        [i % self.n_samples, i / self.n_samples].map(|x| (x as f64 + 0.5) / SAMPLES as f64)
    }

    fn draw(&mut self, k: usize) {
        let t = self.triangles[k];
        let rows = [0, 1].map(|axis| {
            // From the first sample at or after the lowest to the last; clamped before it becomes a whole
            // number.
            let [low, high] =
                extent(&t, axis).map(|x| (x * SAMPLES as f64).clamp(-1.0, self.n_samples as f64 + 1.0));
            ((low - 1.0).max(0.0) as usize)..((high + 1.0).min(self.n_samples as f64).max(0.0) as usize)
        });
        for y in rows[1].clone() {
            for x in rows[0].clone() {
                let i = y * self.n_samples + x;
                self.covered[i] = self.covered[i] || holds(&t, self.sample(i));
            }
        }
        let cells = [0, 1].map(|axis| {
            let [low, high] =
                extent(&t, axis).map(|x| ((x + FAR_PX) / CELL_PX).clamp(-1.0, self.n_cells as f64));
            (low.max(0.0) as usize)..((high + 1.0).floor().min(self.n_cells as f64) as usize)
        });
        for y in cells[1].clone() {
            for x in cells[0].clone() {
                self.cells[y * self.n_cells + x].push(k as u32);
            }
        }
    }

    pub fn n_covered(&self) -> usize {
        self.covered.iter().filter(|covered| **covered).count()
    }

    /// How far a spot is from what this picture covers, between samples too; [`FAR_PX`] where it is farther.
    fn distance(&self, p: Spot) -> f64 {
        let reach = (FAR_PX / CELL_PX) as usize;
        let at = p.map(|x| ((x + FAR_PX) / CELL_PX) as usize);
        let mut least = FAR_PX;
        // Rings of cells, until what is outside of them is farther.
        for ring in 0..=reach {
            if least <= CELL_PX * (ring as f64 - 1.0) {
                break;
            }
            for y in at[1].saturating_sub(ring)..(at[1] + ring + 1).min(self.n_cells) {
                for x in at[0].saturating_sub(ring)..(at[0] + ring + 1).min(self.n_cells) {
                    if x.abs_diff(at[0]).max(y.abs_diff(at[1])) == ring {
                        let near =
                            self.cells[y * self.n_cells + x].iter().map(|k| &self.triangles[*k as usize]);
                        least = near.fold(least, |least, t| least.min(to_triangle(p, t)));
                    }
                }
            }
        }
        least
    }

    /// How far the covered samples are from what the other covers, at most, and how many were not covered
    /// there. The other is taken as it is and not by its samples, so that a tip between two samples is no
    /// excuse and no failure.
    pub fn farthest_from(&self, other: &Self) -> (f64, usize) {
        let outside = |i: &usize| self.covered[*i] && !other.covered[*i];
        let outside: Vec<usize> = (0..self.covered.len()).filter(outside).collect();
        let far = outside.iter().map(|i| other.distance(self.sample(*i))).fold(0.0, f64::max);
        (far, outside.len())
    }
}
