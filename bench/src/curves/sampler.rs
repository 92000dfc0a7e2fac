//! How far a cubic and a polyline are apart, both ways, by dense samples and climbs; it knows control points
//! and vertices only.
use super::Cubic;

type Point = [f64; 2];

fn at(cubic: &Cubic, t: f64) -> Point {
    let between = |a: Point, b: Point| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    let [a, b, c, d] = *cubic;
    let [ab, bc, cd] = [between(a, b), between(b, c), between(c, d)];
    between(between(ab, bc), between(bc, cd))
}

fn distance(a: Point, b: Point) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

fn to_segment(p: Point, [a, b]: [Point; 2]) -> f64 {
    let (along, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let t =
        if square > 0.0 { ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(p, [a[0] + t * along[0], a[1] + t * along[1]])
}

/// The largest distance found, from the curve to the polyline or back.
pub fn farthest(cubic: &Cubic, points: &[Point]) -> f64 {
    if points.len() < 2 {
        return (0..=64).map(|i| distance(at(cubic, f64::from(i) / 64.0), points[0])).fold(0.0, f64::max);
    }
    let looked = Looked::new(cubic, points);
    let to_polyline = looked.to_polyline();
    to_polyline.max(looked.to_curve(to_polyline))
}

struct Looked<'a> {
    cubic: &'a Cubic,
    points: &'a [Point],
    /// Places at equal steps, 16 for every segment, and for each the segment that is near.
    samples: Vec<Point>,
    near: Vec<usize>,
}

impl<'a> Looked<'a> {
    fn new(cubic: &'a Cubic, points: &'a [Point]) -> Self {
        let n = 64 + 16 * points.len();
        let samples = (0..=n).map(|i| at(cubic, i as f64 / n as f64)).collect();
        let mut looked = Self { cubic, points, samples, near: Vec::new() };
        let mut segment = 0;
        looked.near = looked
            .samples
            .iter()
            .map(|p| {
                segment = looked.around(*p, segment).1;
                segment
            })
            .collect();
        looked
    }

    fn segment(&self, i: usize) -> [Point; 2] {
        [self.points[i], self.points[i + 1]]
    }

    /// The nearest of the segments around one.
    fn around(&self, p: Point, segment: usize) -> (f64, usize) {
        let last = self.points.len() - 2;
        let range = segment.saturating_sub(1)..=(segment + 2).min(last);
        let found = range.map(|i| (to_segment(p, self.segment(i)), i));
        found.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a segment")
    }

    /// The distance to the nearest of all segments; more than that where it is below `least` anyway.
    fn to_all(&self, p: Point, segment: usize, least: f64) -> f64 {
        let (near, _) = self.around(p, segment);
        if near <= least {
            return near;
        }
        (0..self.points.len() - 1).map(|i| to_segment(p, self.segment(i))).fold(near, f64::min)
    }

    fn to_polyline(&self) -> f64 {
        let n = self.samples.len() - 1;
        let own: Vec<f64> =
            (0..=n).map(|i| to_segment(self.samples[i], self.segment(self.near[i]))).collect();
        let mut peaks: Vec<usize> =
            (1..n).filter(|&i| own[i] >= own[i - 1] && own[i] >= own[i + 1]).collect();
        peaks.sort_by(|a, b| own[*b].total_cmp(&own[*a]));
        let mut most = 0.0_f64;
        for i in peaks {
            // A climb adds little to a sample of sixteen.
            if 1.02 * own[i] <= most {
                break;
            }
            let value = |t: f64| self.to_all(at(self.cubic, t), self.near[i], most);
            let step = 1.0 / n as f64;
            let (_, value) = climb(value, (i as f64 - 1.0) * step, (i as f64 + 1.0) * step);
            most = most.max(value).max(self.to_all(self.samples[i], self.near[i], most));
        }
        most
    }

    fn to_curve(&self, least: f64) -> f64 {
        let n = self.samples.len() - 1;
        let mut most = least;
        let mut sample = 0_usize;
        for i in 0..self.points.len() - 1 {
            let [a, b] = self.segment(i);
            for f in [0.125, 0.375, 0.5, 0.625, 0.875] {
                let q = [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])];
                let nearest = |range: std::ops::RangeInclusive<usize>| {
                    range
                        .min_by(|i, j| {
                            distance(q, self.samples[*i]).total_cmp(&distance(q, self.samples[*j]))
                        })
                        .expect("samples")
                };
                sample = nearest(sample.saturating_sub(4)..=(sample + 24).min(n));
                // The samples' own polyline is some 1/256 of a segment's distance off: what it leaves far
                // below needs no search.
                if self.roughly(q, sample) < 0.98 * most {
                    continue;
                }
                let near = self.refined(q, sample);
                // What differs by less is the same place, found by rounding.
                if near > most * (1.0 + 1e-9) {
                    most = most.max(self.to_anywhere(q, near));
                }
            }
        }
        most
    }

    /// The distance to the straight lines between a sample and its neighbours.
    fn roughly(&self, q: Point, sample: usize) -> f64 {
        let n = self.samples.len() - 1;
        let line = |i: usize| to_segment(q, [self.samples[i], self.samples[i + 1]]);
        let before = if sample > 0 { line(sample - 1) } else { f64::INFINITY };
        if sample < n { before.min(line(sample)) } else { before }
    }

    /// The distance to the curve, by a search around every sample that is nearer than its neighbours.
    fn to_anywhere(&self, q: Point, least: f64) -> f64 {
        let n = self.samples.len() - 1;
        let far: Vec<f64> = self.samples.iter().map(|p| distance(q, *p)).collect();
        let valley = |i: &usize| far[*i] <= far[i.max(&1) - 1] && far[*i] <= far[(i + 1).min(n)];
        let closely = |i: usize| {
            // The curve may turn back between two samples: each part of their range is searched by itself.
            let (low, high) = (i.max(1) - 1, (i + 1).min(n));
            let at = |j: usize| (low as f64 + (high - low) as f64 * j as f64 / 64.0) / n as f64;
            (0..64).map(|j| self.between(q, at(j), at(j + 1))).fold(f64::INFINITY, f64::min)
        };
        (0..=n).filter(valley).map(closely).fold(least, f64::min)
    }

    /// The distance to the curve around a sample.
    fn refined(&self, q: Point, sample: usize) -> f64 {
        let step = 1.0 / (self.samples.len() - 1) as f64;
        let (low, high) = ((sample.max(1) - 1) as f64 * step, ((sample + 1) as f64 * step).min(1.0));
        self.between(q, low, high).min(distance(q, self.samples[sample]))
    }

    /// The distance to the curve between two parameters.
    fn between(&self, q: Point, low: f64, high: f64) -> f64 {
        let (a, b) = (at(self.cubic, low), at(self.cubic, high));
        // A place straight across from q, by halving; and the least that a search finds.
        let ahead = |t: f64| {
            let p = at(self.cubic, t);
            (p[0] - q[0]) * (b[0] - a[0]) + (p[1] - q[1]) * (b[1] - a[1])
        };
        let (mut from, mut to) = (low, high);
        for _ in 0..40 {
            let middle = 0.5 * (from + to);
            if ahead(middle) < 0.0 { from = middle } else { to = middle }
        }
        let (_, least) = climb(|t| -distance(q, at(self.cubic, t)), low, high);
        (-least).min(distance(q, at(self.cubic, 0.5 * (from + to))))
    }
}

/// The maximum between two places: golden section.
fn climb(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..20 {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = value(b);
        }
    }
    if at_a > at_b { (a, at_a) } else { (b, at_b) }
}

/// `∫ √(|v|/8) dt`, `v` the part of `P''` across `P'`: by the root of a tolerance, about the fewest segments
/// that keep it.
pub fn bending(cubic: &Cubic) -> f64 {
    let n = 2000;
    let side = |i: usize| [cubic[i + 1][0] - cubic[i][0], cubic[i + 1][1] - cubic[i][1]];
    let (a, b, c) = (side(0), side(1), side(2));
    let at = |i: u32| {
        let t = (f64::from(i) + 0.5) / f64::from(n);
        let s = 1.0 - t;
        let first = [0, 1].map(|k| 3.0 * (s * s * a[k] + 2.0 * s * t * b[k] + t * t * c[k]));
        let second = [0, 1].map(|k| 6.0 * (s * (b[k] - a[k]) + t * (c[k] - b[k])));
        let speed = first[0].hypot(first[1]);
        let across = (first[0] * second[1] - first[1] * second[0]).abs();
        if speed > 0.0 { (across / speed / 8.0).sqrt() } else { 0.0 }
    };
    (0..n).map(at).sum::<f64>() / f64::from(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_an_arch_over_its_foot_and_a_spike() {
        let arch = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        assert!((farthest(&arch, &[[0.0, 0.0], [1.0, 0.0]]) - 0.75).abs() < 1e-9);
        let line = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]];
        let spike = farthest(&line, &[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [1.0, 0.0], [3.0, 0.0]]);
        assert!((1.7..=2.0).contains(&spike), "{spike}");
    }

    #[test]
    fn the_bending_of_a_parabola_is_that_of_its_formula() {
        // P'' = 6·(second difference), along which the curve never runs: (x, y) = (3t, 3t(1−t)) has y'' = −6
        // across (3, 3 − 6t), of which 18/√(9 + (3−6t)²) is the part across.
        let cubic = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 0.0]];
        let n = 100_000;
        let exact: f64 = (0..n)
            .map(|i| {
                let t = (f64::from(i) + 0.5) / f64::from(n);
                (18.0 / (9.0 + (3.0 - 6.0 * t).powi(2)).sqrt() / 8.0).sqrt()
            })
            .sum::<f64>()
            / f64::from(n);
        assert!((bending(&cubic) / exact - 1.0).abs() < 1e-6);
    }
}
