//! The two-sided distance between a path and a polyline, from below, by samples and climbs of its own.
//!
//! 1. Every range of the path between two vertices is sampled against its own segment; around the best places
//!    the search closes in. What is found there may be nearer to another segment, so the best by that count
//!    are held against all segments, until none that is left can be better. 2. Points of every segment are
//!    held against their own range of the path, and those that would count against all of the path.
use super::double::Double;
use super::truth::{Part, Path};
use chordal::explicit::Polyline;

/// The largest distances found, each a lower bound up to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// From the path to the polyline.
    pub to_polyline: f64,
    /// From the polyline to the path.
    pub to_path: f64,
}

impl Distance {
    pub fn both(&self) -> f64 {
        self.to_polyline.max(self.to_path)
    }
}

/// How closely to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// The best few places of each segment.
    Quick,
    /// Every sample counts, and there are more of them.
    Close,
}

impl Look {
    fn samples(self) -> u32 {
        match self {
            Self::Quick => 8,
            Self::Close => 64,
        }
    }
}

/// A range of one part that belongs to one segment.
struct Range {
    part: usize,
    from: f64,
    to: f64,
    segment: usize,
}

pub fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let d: [f64; D] = std::array::from_fn(|k| (a[k] - b[k]).abs());
    let most = d.iter().fold(0.0_f64, |most, x| most.max(*x));
    if most > 1e-100 && most < 1e100 {
        return d.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    // Squares may leave the range of numbers.
    if most == 0.0 { 0.0 } else { most * d.iter().map(|x| (x / most).powi(2)).sum::<f64>().sqrt() }
}

pub fn to_segment<const D: usize>(p: [f64; D], [a, b]: [[f64; D]; 2]) -> f64 {
    let along: [f64; D] = std::array::from_fn(|k| b[k] - a[k]);
    let most = along.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if most == 0.0 {
        return distance(p, a);
    }
    let unit = along.map(|x| x / most);
    let square: f64 = unit.iter().map(|x| x * x).sum();
    let t = (0..D).map(|k| ((p[k] - a[k]) / most) * unit[k]).sum::<f64>() / square;
    let t = t.clamp(0.0, 1.0);
    distance(
        p,
        std::array::from_fn(|k| if t < 0.5 { a[k] + t * along[k] } else { b[k] - (1.0 - t) * along[k] }),
    )
}

/// The distance to a segment with twice the digits.
fn precisely_to_segment<const D: usize>(p: [Double; D], [a, b]: [[f64; D]; 2]) -> f64 {
    let wide = |p: [f64; D]| p.map(Double::from);
    let minus = |a: [Double; D], b: [Double; D]| -> [Double; D] { std::array::from_fn(|k| a[k].minus(b[k])) };
    let dot =
        |a: [Double; D], b: [Double; D]| (0..D).fold(Double::from(0.0), |sum, k| sum.plus(a[k].times(b[k])));
    let (along, from) = (minus(wide(b), wide(a)), minus(p, wide(a)));
    let square = dot(along, along);
    let t = if square.value() > 0.0 { dot(along, from).over(square) } else { 0.0.into() };
    let t = if t.value() <= 0.0 {
        Double::from(0.0)
    } else if t.value() >= 1.0 {
        Double::from(1.0)
    } else {
        t
    };
    let off: [Double; D] = std::array::from_fn(|k| from[k].minus(along[k].times(t)));
    dot(off, off).root().value()
}

/// The points of a polyline, and the ranges of the path that belong to its segments.
struct Pair<'a, const D: usize> {
    path: &'a Path<D>,
    segments: Vec<[[f64; D]; 2]>,
    ranges: Vec<Range>,
}

impl<'a, const D: usize> Pair<'a, D> {
    fn new(path: &'a Path<D>, made: &Polyline<D>) -> Self {
        let n = made.points.len();
        let count = if made.closed && n > 1 { n } else { n - 1 };
        let segments: Vec<_> = (0..count).map(|i| [made.points[i], made.points[(i + 1) % n]]).collect();
        let end = path.parts.len() as f64;
        let mut ranges = Vec::new();
        for i in 0..count.max(1) {
            // The last one goes to the end, also where pieces that come back to their start have no vertex of
            // their own.
            let (from, to) = (made.places[i], if i + 1 < count { made.places[i + 1] } else { end });
            // A range is cut where pieces end: those that are a point have no vertex of their own.
            let mut at = from;
            while at < to {
                let part = (at.floor() as usize).min(path.parts.len() - 1);
                let next = ((part + 1) as f64).min(to);
                ranges.push(Range { part, from: at - part as f64, to: next - part as f64, segment: i });
                at = next;
            }
        }
        if segments.is_empty() {
            return Self { path, segments: vec![[made.points[0]; 2]], ranges };
        }
        Self { path, segments, ranges }
    }

    fn to_all(&self, p: [f64; D]) -> f64 {
        self.segments.iter().map(|s| to_segment(p, *s)).fold(f64::INFINITY, f64::min)
    }

    fn precisely_to_all(&self, part: &Part<D>, t: f64) -> f64 {
        let p = part.precisely_at(t);
        let near = p.map(Double::value);
        let least = self.to_all(near);
        // Segments that rounding keeps out of the running need no more digits.
        let close =
            self.segments.iter().filter(|s| to_segment(near, **s) <= 1.001 * least + 4.0 * self.path.slack());
        close.map(|s| precisely_to_segment(p, *s)).fold(f64::INFINITY, f64::min)
    }

    /// The largest distance from the path to the polyline that is found.
    fn to_polyline(&self, look: Look) -> f64 {
        // Own distance, part, parameter.
        let mut found: Vec<(f64, usize, f64)> = Vec::new();
        let n = look.samples();
        for range in &self.ranges {
            let (part, segment) =
                (&self.path.parts[range.part], self.segments[range.segment.min(self.segments.len() - 1)]);
            let at = |i: u32| range.from + (range.to - range.from) * f64::from(i) / f64::from(n);
            let own = |t: f64| to_segment(part.at(t), segment);
            let values: Vec<f64> = (0..=n).map(|i| own(at(i))).collect();
            for i in 1..n as usize {
                let peak = values[i] >= values[i - 1] && values[i] >= values[i + 1];
                if peak {
                    let (t, value) = climb(own, at(i as u32 - 1), at(i as u32 + 1));
                    found.push(if value > values[i] {
                        (value, range.part, t)
                    } else {
                        (values[i], range.part, at(i as u32))
                    });
                }
                if look == Look::Close {
                    found.push((values[i], range.part, at(i as u32)));
                }
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best = (0.0, 0, 0.0);
        for (own, part, t) in found {
            if own <= best.0 {
                break;
            }
            let far = self.to_all(self.path.parts[part].at(t));
            if far > best.0 {
                best = (far, part, t);
            }
        }
        self.precisely_to_all(&self.path.parts[best.1], best.2)
    }

    /// The largest distance from the polyline to the path that is found and is more than `least`.
    fn to_path(&self, look: Look, least: f64) -> f64 {
        let n = match look {
            Look::Quick => 4,
            Look::Close => 16,
        };
        let mut best = least;
        for (index, segment) in self.segments.iter().enumerate() {
            for i in 1..n {
                let f = f64::from(i) / f64::from(n);
                let q = std::array::from_fn(|k| segment[0][k] + f * (segment[1][k] - segment[0][k]));
                // A segment's own ranges lie next to each other in the list; usually there is one.
                let first = self.ranges.partition_point(|range| range.segment < index);
                let own = self.ranges[first..].iter().take_while(|range| range.segment == index);
                let own: f64 = own.map(|range| self.to_range(q, range, 8)).fold(f64::INFINITY, f64::min);
                if own > best * (1.0 + 1e-9) {
                    let all = self.ranges.iter().map(|range| self.to_range(q, range, 32));
                    let all = all.fold(f64::INFINITY, f64::min);
                    if all > best {
                        // Before it is said aloud: the curve may turn back between two samples.
                        let zoomed = self.ranges.iter().map(|range| self.zoom(q, range));
                        best = best.max(zoomed.fold(all, f64::min));
                    }
                }
            }
        }
        if best > least { best } else { 0.0 }
    }

    /// The distance from a point that should be on the range, by looking closer and closer at every place
    /// that is near.
    fn zoom(&self, q: [f64; D], range: &Range) -> f64 {
        const N: u32 = 64;
        let part = &self.path.parts[range.part];
        let far = |t: f64| distance(q, part.at(t));
        let first = |i: u32| range.from + (range.to - range.from) * f64::from(i) / f64::from(N);
        let valley = |i: u32| {
            let (mut low, mut high, mut least) =
                (first(i.saturating_sub(1)), first((i + 1).min(N)), far(first(i)));
            for _ in 0..12 {
                let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(N);
                let best = (0..=N).min_by(|a, b| far(at(*a)).total_cmp(&far(at(*b)))).expect("samples");
                least = far(at(best)).min(least);
                (low, high) = (at(best.saturating_sub(1)), at((best + 1).min(N)));
            }
            least
        };
        let near = |i: &u32| {
            let beside = [i.saturating_sub(1), (i + 1).min(N)];
            beside.iter().all(|j| far(first(*i)) <= far(first(*j)))
        };
        (0..=N).filter(near).map(valley).fold(f64::INFINITY, f64::min)
    }

    fn to_range(&self, q: [f64; D], range: &Range, n: u32) -> f64 {
        let part = &self.path.parts[range.part];
        let at = |i: u32| range.from + (range.to - range.from) * f64::from(i) / f64::from(n);
        let far = |t: f64| distance(q, part.at(t));
        let best = (0..=n).map(|i| (i, far(at(i)))).min_by(|a, b| a.1.total_cmp(&b.1)).expect("samples");
        let (low, high) = (at(best.0.saturating_sub(1)), at((best.0 + 1).min(n)));
        let (t, least) = climb(|t| -far(t), low, high);
        // The least of a root is flat where it is measured; a place straight across is found to the last
        // digit.
        let (a, b) = (part.at(low), part.at(high));
        let ahead = |t: f64| {
            let p = part.at(t);
            (0..D).map(|k| (p[k] - q[k]) * (b[k] - a[k])).sum::<f64>()
        };
        best.1.min(-least).min(far(crossing(ahead, [low, t, high])))
    }
}

/// A place where a value changes its sign, by halving; the first one when it does not.
fn crossing(value: impl Fn(f64) -> f64, [low, middle, high]: [f64; 3]) -> f64 {
    let at_middle = value(middle);
    // Signs, because products of small numbers vanish.
    let side = if (value(low) > 0.0) != (at_middle > 0.0) { [low, middle] } else { [middle, high] };
    let [mut a, mut b] = side;
    let at_a = value(a) > 0.0;
    for _ in 0..45 {
        let m = 0.5 * (a + b);
        if (value(m) > 0.0) == at_a { a = m } else { b = m }
    }
    0.5 * (a + b)
}

/// The maximum between two places, if there is one: golden section.
fn climb(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let mut a = high - golden * (high - low);
    let mut b = low + golden * (high - low);
    let (mut at_a, mut at_b) = (value(a), value(b));
    // 0.618^24 is 1e-5, and a maximum is flat: 1e-10 of the range's distance.
    for _ in 0..24 {
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

/// Measures a polyline that carries its places.
pub fn measure<const D: usize>(path: &Path<D>, made: &Polyline<D>, look: Look) -> Distance {
    let pair = Pair::new(path, made);
    let to_polyline = pair.to_polyline(look);
    Distance { to_polyline, to_path: pair.to_path(look, to_polyline) }
}

/// How far the two are apart for sure, if `p` is said to be a point of the path: its distance to the
/// polyline, less that to the path.
pub fn witnessed<const D: usize>(path: &Path<D>, made: &Polyline<D>, p: [f64; D]) -> f64 {
    let pair = Pair::new(path, made);
    let off = pair.ranges.iter().map(|range| pair.zoom(p, range)).fold(f64::INFINITY, f64::min);
    to_polyline(p, made) - off
}

/// The distance from a point to all of a polyline.
pub fn to_polyline<const D: usize>(p: [f64; D], made: &Polyline<D>) -> f64 {
    let n = made.points.len();
    let count = if made.closed && n > 1 { n } else { n - 1 };
    let first = distance(p, made.points[0]);
    (0..count).map(|i| to_segment(p, [made.points[i], made.points[(i + 1) % n]])).fold(first, f64::min)
}
