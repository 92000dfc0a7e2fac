//! The triangles around a vertex by Loop's scheme: a round, and the vertex's point and tangents on the limit
//! surface.
//!
//! Sources: C. Loop, *Smooth subdivision surfaces based on triangles*, 1987, for smooth vertices; on creases
//! the eigenvectors of OpenSubdiv's rules, derived here. Every round shrinks the wave with the angle `t`
//! between neighbours by `λ = 3/8 + cos(t)/4`.
use super::super::refinement_step::loop_weight;
use super::super::vertex_rule::{CagePoint, plus};
use super::one_ring::{OneRing, VertexKind};
use crate::math::elementary::{cos, sin};
use std::f64::consts::{PI, TAU};

impl OneRing {
    /// The neighbours after a round.
    pub(super) fn refined_neighbours_loop(&self) -> Vec<CagePoint> {
        let n = self.edges.len();
        let is_closed = n == self.faces.len();
        let next = |k: usize| {
            let is_end = !is_closed && (k == 0 || k + 1 == n);
            if is_end || self.kind == VertexKind::Dart(k) {
                return [0, 1, 2].map(|i| 0.5 * self.here[i] + 0.5 * self.edges[k][i]);
            }
            let (before, after) = (self.edges[(k + n - 1) % n], self.edges[(k + 1) % n]);
            [0, 1, 2].map(|i| 0.375 * (self.here[i] + self.edges[k][i]) + 0.125 * (before[i] + after[i]))
        };
        (0..n).map(next).collect()
    }

    /// The vertex after a round by the smooth rule.
    pub(super) fn smooth_point_loop(&self) -> CagePoint {
        let share = loop_weight(self.edges.len());
        let start = self.here.map(|x| (1.0 - self.edges.len() as f64 * share) * x);
        self.edges.iter().fold(start, |sum, p| plus(sum, share, *p))
    }

    /// The limit point of a smooth vertex: with the weight `β` of a neighbour in a round, `8β/3` of each
    /// neighbour to one of the vertex.
    pub(super) fn limit_point_loop(&self) -> CagePoint {
        let ratio = 8.0 / 3.0 * loop_weight(self.edges.len());
        let total = 1.0 + self.edges.len() as f64 * ratio;
        let sum = self.edges.iter().fold(self.here, |sum, p| plus(sum, ratio, *p));
        sum.map(|x| x / total)
    }

    /// The tangents at a smooth vertex of more than two triangles, or on a crease: left eigenvectors of the
    /// round's matrix.
    pub(super) fn limit_tangents_loop(&self) -> Option<[CagePoint; 2]> {
        let (n, last) = (self.faces.len(), self.edges.len() - 1);
        let sum = |weight: &dyn Fn(usize) -> f64| {
            self.edges.iter().enumerate().fold([0.0; 3], |sum, (k, p)| plus(sum, weight(k), *p))
        };
        match self.kind {
            VertexKind::Smooth if n > 2 => {
                let turn = TAU / n as f64;
                Some([sum(&|k| cos(k as f64 * turn)), sum(&|k| sin(k as f64 * turn))])
            }
            VertexKind::Crease if n > 1 => {
                let along = [0, 1, 2].map(|k| self.edges[0][k] - self.edges[last][k]);
                // Sines over the inner neighbours, and the resulting weights of the ends and the vertex by
                // two linear equations, whose determinant is (λ − 1)(λ − 1/4).
                let turn = PI / n as f64;
                let lambda = 0.375 + 0.25 * cos(turn);
                let wave = |k: usize| if k == 0 || k == n { 0.0 } else { sin(k as f64 * turn) };
                let (p, q) = (0.125 * wave(1), 0.375 * (0..n).map(wave).sum::<f64>());
                let determinant = (lambda - 1.0) * (lambda - 0.25);
                let ends = ((lambda - 0.75) * p + 0.125 * q) / determinant;
                let vertex_weight = (p + (lambda - 0.5) * q) / determinant;
                let inside = sum(&|k| if k == 0 || k == last { ends } else { wave(k) });
                Some([along, plus(inside, vertex_weight, self.here)])
            }
            _ => None,
        }
    }
}
