//! Distances by a tree of boxes and plain arithmetic. Nothing of the library.
use super::random::Random;
use chordal::Mesh;

pub type Point = [f64; 3];

pub fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The point of a triangle by weights.
pub fn on(t: [Point; 3], w: [f64; 3]) -> Point {
    std::array::from_fn(|k| w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k])
}

/// The weights of the point nearest to `p` on a triangle: inside by areas, or the nearest of the three sides.
pub fn nearest(p: Point, t: [Point; 3]) -> [f64; 3] {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let w: [f64; 3] = std::array::from_fn(|k| {
        let (from, to) = (t[(k + 1) % 3], t[(k + 2) % 3]);
        dot(cross(sub(to, from), sub(p, from)), n)
    });
    let mut best = [1.0, 0.0, 0.0];
    let mut least = f64::INFINITY;
    let mut see = |w: [f64; 3]| {
        let d = norm(sub(p, on(t, w)));
        if d < least {
            (least, best) = (d, w);
        }
    };
    if dot(n, n) > 0.0 && w.iter().all(|x| *x >= 0.0) {
        let whole = w[0] + w[1] + w[2];
        let foot = w.map(|x| x / whole);
        see(foot);
        // Once more from there, since the weights of a needle are known less well.
        let left = sub(p, on(t, foot));
        let more: [f64; 3] = std::array::from_fn(|k| {
            foot[k] + dot(cross(sub(t[(k + 2) % 3], t[(k + 1) % 3]), left), n) / dot(n, n)
        });
        if more.iter().all(|x| *x >= 0.0) {
            let whole = more[0] + more[1] + more[2];
            see(more.map(|x| x / whole));
        }
    }
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let along = sub(b, a);
        let square = dot(along, along);
        let s = if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let mut w = [0.0; 3];
        (w[k], w[(k + 1) % 3]) = (1.0 - s, s);
        see(w);
    }
    best
}

pub fn to_triangle(p: Point, t: [Point; 3]) -> f64 {
    norm(sub(p, on(t, nearest(p, t))))
}

/// Triangles in boxes in boxes.
pub struct Tree {
    triangles: Vec<([Point; 3], u32)>,
    /// Boxes over halves of halves: the lowest and highest corner, and the range of triangles.
    boxes: Vec<([Point; 2], [usize; 2], [usize; 2])>,
}

impl Tree {
    pub fn new(mesh: &Mesh) -> Self {
        let mut triangles: Vec<_> =
            (0..mesh.faces().len()).map(|face| (mesh.corners(face), face as u32)).collect();
        let mut boxes = Vec::new();
        let n = triangles.len();
        Self::split(&mut triangles, [0, n], &mut boxes);
        Self { triangles, boxes }
    }

    fn split(
        all: &mut [([Point; 3], u32)],
        [from, to]: [usize; 2],
        boxes: &mut Vec<([Point; 2], [usize; 2], [usize; 2])>,
    ) -> usize {
        let corners = || all[from..to].iter().flat_map(|(t, _)| t);
        let low: Point = std::array::from_fn(|k| corners().map(|p| p[k]).fold(f64::INFINITY, f64::min));
        let high: Point = std::array::from_fn(|k| corners().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max));
        let this = boxes.len();
        boxes.push(([low, high], [from, to], [0, 0]));
        if to - from > 4 {
            let size = sub(high, low);
            let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).expect("three");
            let key = |t: &([Point; 3], u32)| t.0[0][axis] + t.0[1][axis] + t.0[2][axis];
            all[from..to].sort_by(|a, b| key(a).total_cmp(&key(b)));
            let middle = (from + to) / 2;
            let a = Self::split(all, [from, middle], boxes);
            let b = Self::split(all, [middle, to], boxes);
            boxes[this].2 = [a, b];
        }
        this
    }

    /// The distance of a point, and whose face is nearest.
    pub fn distance(&self, p: Point) -> (f64, u32) {
        let mut best = (f64::INFINITY, 0);
        self.walk(p, &mut |d, face, reach| {
            if d < best.0 {
                best = (d, face);
                *reach = d;
            }
        });
        best
    }

    /// All faces within a distance of a point.
    pub fn within(&self, p: Point, length: f64) -> Vec<u32> {
        let mut found = Vec::new();
        self.walk(p, &mut |d, face, reach| {
            *reach = length;
            if d <= length {
                found.push(face);
            }
        });
        found
    }

    fn walk(&self, p: Point, see: &mut dyn FnMut(f64, u32, &mut f64)) {
        let mut reach = f64::INFINITY;
        let off = |i: usize| {
            let [low, high] = self.boxes[i].0;
            norm(std::array::from_fn(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0)))
        };
        let mut open = vec![0];
        while let Some(i) = open.pop() {
            if off(i) > reach {
                continue;
            }
            let (_, [from, to], [a, b]) = self.boxes[i];
            if a == 0 {
                self.triangles[from..to]
                    .iter()
                    .for_each(|(t, face)| see(to_triangle(p, *t), *face, &mut reach));
            } else if off(a) < off(b) {
                open.extend([b, a]);
            } else {
                open.extend([a, b]);
            }
        }
    }
}

/// Weights of `n` random points of a triangle.
pub fn weights(random: &mut Random) -> [f64; 3] {
    let (a, b) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
    if a + b < 1.0 { [a, b, 1.0 - a - b] } else { [1.0 - a, 1.0 - b, a + b - 1.0] }
}

/// Points of a face that are always looked at, by their weights: corners, the middles of edges, and the middle.
pub const FIXED: [Point; 7] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [1.0 / 3.0; 3],
];

/// The farthest of many points of one surface from another: corners, middles, and random points by area, `n` of them
/// about.
pub fn farthest(from: &Mesh, to: &Mesh, (n, random): (usize, &mut Random)) -> f64 {
    let tree = Tree::new(to);
    let triangles: Vec<_> = (0..from.faces().len()).map(|face| from.corners(face)).collect();
    let area = |t: &[Point; 3]| norm(cross(sub(t[1], t[0]), sub(t[2], t[0])));
    let whole: f64 = triangles.iter().map(area).sum();
    let mut most = 0.0_f64;
    for t in &triangles {
        FIXED.iter().for_each(|w| most = most.max(tree.distance(on(*t, *w)).0));
        for _ in 0..(n as f64 * area(t) / whole).ceil() as usize {
            most = most.max(tree.distance(on(*t, weights(random))).0);
        }
    }
    most
}

/// Both ways.
pub fn apart(a: &Mesh, b: &Mesh, random: &mut Random) -> f64 {
    farthest(a, b, (20_000, random)).max(farthest(b, a, (20_000, random)))
}
