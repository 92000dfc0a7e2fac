//! The referee of fitted cubics: samples the shapes and the cubics by its own arithmetic, and looks for places that are
//! farther apart than the bound says.
mod curves;
mod points;
mod polylines;

use chordal::explicit::{Curve, CurveSegment};

/// A path as a function of its parameter, from 0 to the number of its pieces.
pub struct Sampled<'a, const D: usize> {
    pub at: Box<dyn Fn(f64) -> [f64; D] + 'a>,
    pub end: f64,
}

pub fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let most = (0..D).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
    if most == 0.0 { 0.0 } else { most * (0..D).map(|k| ((a[k] - b[k]) / most).powi(2)).sum::<f64>().sqrt() }
}

fn between<const D: usize>(a: [f64; D], b: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

/// The result: lines and cubics, by de Casteljau's construction.
pub fn fitted<const D: usize>(curve: &Curve<D>) -> Sampled<'_, D> {
    let end = curve.segments().len() as f64;
    let at = move |s: f64| {
        let Some(last) = curve.segments().len().checked_sub(1) else { return curve.start() };
        let i = (s.floor() as usize).min(last);
        let t = s - i as f64;
        match &curve.segments()[i] {
            CurveSegment::Line([a, b]) => between(*a, *b, t),
            CurveSegment::Cubic(cubic) => {
                let [a, b, c, d] = cubic.control;
                let [ab, bc, cd] = [between(a, b, t), between(b, c, t), between(c, d, t)];
                between(between(ab, bc, t), between(bc, cd, t), t)
            }
            other => panic!("neither line nor cubic: {other:?}"),
        }
    };
    Sampled { at: Box::new(at), end }
}

impl<const D: usize> Sampled<'_, D> {
    /// The distance of a point: the nearest of many samples, and then nearer and nearer places between its neighbours,
    /// wherever one could be nearer.
    pub fn distance(&self, p: [f64; D], grid: &[(f64, [f64; D])]) -> f64 {
        let far: Vec<f64> = grid.iter().map(|(_, q)| distance(p, *q)).collect();
        let mut best = far.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        // Between two samples nothing is nearer than the sides of a triangle say, nearly: ends of pieces are samples.
        let least = |i: usize| 0.5 * (far[i] + far[i + 1] - 1.1 * distance(grid[i].1, grid[i + 1].1));
        let mut order: Vec<(f64, usize)> =
            (0..grid.len() - 1).map(|i| (least(i), i)).filter(|(least, _)| *least < best).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (least, i) in order {
            if least > best {
                break;
            }
            let (mut low, mut high) = (grid[i].0, grid[i + 1].0);
            // The best of nine places and what is beside it, again and again: a bend between may be sharp.
            while high > low {
                let at = |k: usize| low + (high - low) * k as f64 / 8.0;
                let far: Vec<f64> = (0..=8).map(|k| distance(p, (self.at)(at(k)))).collect();
                let nearest = (0..=8).min_by(|a, b| far[*a].total_cmp(&far[*b])).expect("nine places");
                best = best.min(far[nearest]);
                let next = (at(nearest.saturating_sub(1)), at((nearest + 1).min(8)));
                if next.1 - next.0 < 1e-15 * (1.0 + next.1) || next == (low, high) {
                    break;
                }
                (low, high) = next;
            }
        }
        best
    }

    /// Samples: about so many, all ends of pieces among them, and more where they would be far apart.
    pub fn grid(&self, n: usize) -> Vec<(f64, [f64; D])> {
        let n = (n as f64 / self.end.max(1.0)).ceil() as usize * self.end.max(1.0) as usize;
        let at = |s: f64| (s, (self.at)(s));
        let even: Vec<_> = (0..=n).map(|i| at(self.end * i as f64 / n as f64)).collect();
        let step = 4.0 / n as f64 * even.windows(2).map(|w| distance(w[0].1, w[1].1)).sum::<f64>();
        let mut grid = vec![even[0]];
        for pair in even.windows(2) {
            let mut left = vec![pair[1]];
            while let Some(next) = left.last().copied() {
                let last = grid[grid.len() - 1];
                let middle = 0.5 * (last.0 + next.0);
                if distance(last.1, next.1) > step && middle > last.0 && middle < next.0 {
                    left.push(at(middle));
                } else {
                    grid.push(next);
                    left.pop();
                }
            }
        }
        grid
    }

    /// The largest distance found of a sample of this from the other.
    pub fn farthest_from(&self, other: &Self, n: usize) -> f64 {
        let grid = other.grid(2 * n);
        self.grid(n).iter().map(|(_, p)| other.distance(*p, &grid)).fold(0.0, f64::max)
    }
}

/// The largest angle by which a path turns where pieces meet, the start of a closed one included.
pub fn sharpest<const D: usize>(curve: &Curve<D>) -> f64 {
    let joins = chordal::check::curves::joins(curve);
    joins.iter().map(|join| join.angle_rad.unwrap_or(0.0)).fold(0.0, f64::max)
}

#[test]
fn the_referee_sees_a_shift() {
    let arch = chordal::Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
    let moved = chordal::Bezier { control: arch.control.map(|[x, y]| [x, y + 1e-6]) };
    let (a, b) = (Curve::from(arch), Curve::from(moved));
    let found = fitted(&a).farthest_from(&fitted(&b), 200);
    assert!(found > 0.999e-6 && found < 1.001e-6, "{found}");
}
