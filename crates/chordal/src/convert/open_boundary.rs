//! `OpenBoundary`: the edges at which a mesh is not closed, and how fast the winding number changes near
//! them.
//!
//! Between triangles the winding number is smooth. Its gradient depends on the open edges alone: by Stokes'
//! theorem the solid angle of a surface changes like the Biot–Savart integral over its border,
//! `∇w = 1/4π · ∮ (x − p) × dx / |x − p|³`, which is at most `1/4π · Σ length / distance²`.
use crate::explicit::{Mesh, OpenEdge, open_edges};
use crate::math::{add_up, distance, greater};

/// A ball of edges is opened if it is nearer than this many of its radii. Chosen: there its bound is too large by a
/// factor of two at most.
const OPENED: f64 = 3.0;
/// A factor above all roundings of a sum of 2²⁸ positive terms, with some dozen each. Derived: 2²⁸ · 2⁻⁵³ is
/// far below it.
const ROUNDED: f64 = 1.0 + 1.0 / (1_u64 << 20) as f64;

/// A ball around some edges, with their length.
#[derive(Clone, Copy, Debug)]
struct EdgeBall {
    centre: [f64; 3],
    radius: f64,
    /// The length of all its edges, each times its multiplicity.
    length: f64,
    /// The index of the second of its two children, which are consecutive; 0 for a single edge.
    children: u32,
}

/// The open edges as a tree of balls.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenBoundary {
    /// The root is the last; empty for a closed mesh.
    balls: Vec<EdgeBall>,
    root: Option<u32>,
}

impl OpenBoundary {
    /// Of the edges that, by position, run one way more often than the other. O(n log n).
    pub(super) fn new(mesh: &Mesh) -> Self {
        let at = |row: u32| mesh.positions()[row as usize];
        let ball = |edge: &OpenEdge| EdgeBall::around(edge.rows.map(at), f64::from(edge.times));
        let mut edges: Vec<EdgeBall> = open_edges(mesh).iter().map(ball).collect();
        let mut border = Self::default();
        if !edges.is_empty() {
            border.root = Some(border.add(&mut edges));
        }
        border
    }

    /// Adds the balls of some edges and returns the index of the ball around all of them.
    fn add(&mut self, edges: &mut [EdgeBall]) -> u32 {
        if let [edge] = edges {
            self.balls.push(*edge);
            return self.balls.len() as u32 - 1;
        }
        let span = |k: usize| {
            let ends = edges.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], edge| {
                [crate::math::lesser(edge.centre[k], low), greater(edge.centre[k], high)]
            });
            ends[1] - ends[0]
        };
        let spans = [span(0), span(1), span(2)];
        let axis = (0..3).fold(0, |best, k| if spans[k] > spans[best] { k } else { best });
        let middle = edges.len() / 2;
        edges.select_nth_unstable_by(middle, |a, b| a.centre[axis].total_cmp(&b.centre[axis]));
        let (first, second) = edges.split_at_mut(middle);
        let left = self.add(first);
        let right = self.add(second);
        let both = [self.balls[left as usize], self.balls[right as usize]];
        // The two children are stored once more, side by side, after everything below them.
        let children = self.balls.len() as u32;
        self.balls.extend(both);
        self.balls.push(EdgeBall { children: children + 1, ..EdgeBall::around_both(both) });
        children + 2
    }

    /// An upper bound of the change of the winding number between `p` and any point within `radius` of it
    /// that is reached without crossing a triangle; infinite if an open edge may be within `radius`.
    pub(super) fn most_change(&self, p: [f64; 3], radius: f64) -> f64 {
        let Some(root) = self.root else { return 0.0 };
        let mut pending = vec![root];
        let mut sum = 0.0;
        while let Some(index) = pending.pop() {
            let ball = self.balls[index as usize];
            let distance = distance(p, ball.centre) / ROUNDED - ball.radius * ROUNDED - radius * ROUNDED;
            if ball.children > 0 && distance < (OPENED - 1.0) * ball.radius {
                pending.extend([ball.children - 1, ball.children]);
                continue;
            }
            if distance <= 0.0 {
                return f64::INFINITY;
            }
            sum += ball.length / (distance * distance);
        }
        let change = ROUNDED * sum * radius / (4.0 * std::f64::consts::PI);
        if change.is_finite() { change * ROUNDED } else { f64::INFINITY }
    }
}

impl EdgeBall {
    fn around([a, b]: [[f64; 3]; 2], times: f64) -> Self {
        let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]);
        let (to_a, to_b) = (distance(centre, a), distance(centre, b));
        let radius = ROUNDED * greater(to_a, to_b);
        Self { centre, radius, length: ROUNDED * times * distance(a, b), children: 0 }
    }

    fn around_both([a, b]: [Self; 2]) -> Self {
        let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * a.centre[k] + 0.5 * b.centre[k]);
        let reach = |ball: Self| ROUNDED * add_up(distance(centre, ball.centre), ball.radius);
        let (reach_a, reach_b) = (reach(a), reach(b));
        Self {
            centre,
            radius: greater(reach_a, reach_b),
            length: ROUNDED * (a.length + b.length),
            children: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Job;
    use crate::explicit::{Bvh, WindingMoments};

    /// A fan of triangles around the origin in the plane z = 0: a disc of so many corners.
    fn disc(n: u32) -> Mesh {
        let corner = |k: u32| {
            let angle = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
            [libm::cos(angle), libm::sin(angle), 0.0]
        };
        let corners = std::iter::once([0.0; 3]).chain((0..n).map(corner)).collect();
        Mesh::new(corners, (0..n).map(|k| [0, k + 1, (k + 1) % n + 1]).collect()).unwrap()
    }

    #[test]
    fn the_winding_number_never_changes_by_more() {
        let mesh = disc(40);
        let border = OpenBoundary::new(&mesh);
        let bvh = Bvh::build(&mesh, &Job::default()).unwrap();
        let sides = WindingMoments::new(&mesh, &bvh);
        let winding = |p| sides.enclosure(&bvh).winding_number(p, 1e-9).unwrap().value;
        let mut tightest: f64 = 0.0;
        for step in 0..200_u32 {
            let angle = f64::from(step) * 2.4;
            let far = 0.2 + f64::from(step % 20) * 0.1;
            let p = [far * libm::cos(angle), far * libm::sin(angle), 0.3 + f64::from(step % 7) * 0.1];
            let by = 0.01 + 0.02 * f64::from(step % 5);
            for to in [[by, 0.0, 0.0], [0.0, -by, 0.0], [0.0, 0.0, by], [0.0, 0.0, -by]] {
                let q = std::array::from_fn(|k| p[k] + to[k]);
                let (change, most) = ((winding(p) - winding(q)).abs(), border.most_change(p, by));
                assert!(change <= most + 2e-9, "{p:?} {by}: {change} > {most}");
                tightest = greater(tightest, change / most);
            }
        }
        // A bound that is never nearly reached would be too large to be of use.
        assert!(tightest > 0.2, "{tightest}");
    }

    #[test]
    fn closed_meshes_have_none() {
        let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let closed = OpenBoundary::new(&Mesh::new(corners.clone(), faces.clone()).unwrap());
        assert_eq!(closed.most_change([0.25; 3], 10.0), 0.0);
        let open = OpenBoundary::new(&Mesh::new(corners, faces[1..].to_vec()).unwrap());
        assert_eq!(open.most_change([0.5, 0.1, 0.0], 0.2), f64::INFINITY);
        let far = open.most_change([0.5, 0.1, 100.0], 0.2);
        assert!(far > 0.0 && far < 1e-3, "{far}");
    }
}
