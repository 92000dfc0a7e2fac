//! Triangulates a small flat polygon, with or without holes, so that the worst triangle is as good as possible.
use crate::math::{cross, difference, dot, greater, length, lesser};

/// Triangulates a polygon; indices run through its loops one after the other. Any loop may be the outer one;
/// all have the polygon on their left. `is_straight` marks corners in line with their two neighbours; no triangle
/// consists of such a corner and these neighbours. For polygons of a few corners; the cost is cubic.
pub(super) fn triangulate(loops: &[&[[f64; 3]]], is_straight: &[bool], into: &mut Vec<[u32; 3]>) {
    let n: usize = loops.iter().map(|corners| corners.len()).sum();
    if loops.len() == 1 && n == 3 {
        into.push([0, 1, 2]);
        return;
    }
    let corners: Vec<[f64; 3]> = loops.concat();
    let normal = normal(loops);
    let mut ring: Vec<u32> = (0..loops[0].len() as u32).collect();
    let mut start = loops[0].len() as u32;
    for inner_loop in &loops[1..] {
        let inner: Vec<u32> = (start..start + inner_loop.len() as u32).collect();
        let candidate = |ring: &[u32]| {
            BridgedPolygon { ring, corners: &corners, is_straight, normal }.triangulate_best(&mut Vec::new())
        };
        ring = bridge_loops(&ring, &inner, candidate);
        start += inner_loop.len() as u32;
    }
    BridgedPolygon { ring: &ring, corners: &corners, is_straight, normal }.triangulate_best(into);
}

/// Twice the sum of the loops' vector areas.
fn normal(loops: &[&[[f64; 3]]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for ring in loops {
        for k in 1..ring.len().saturating_sub(1) {
            let part = cross(difference(ring[k], ring[0]), difference(ring[k + 1], ring[0]));
            sum = std::array::from_fn(|k| sum[k] + part[k]);
        }
    }
    sum
}

/// Joins two loops to one by the bridge that gives the best triangles.
fn bridge_loops(outer: &[u32], inner: &[u32], quality: impl Fn(&[u32]) -> f64) -> Vec<u32> {
    let mut best: Option<(f64, Vec<u32>)> = None;
    for a in 0..outer.len() {
        for b in 0..inner.len() {
            // Both ends of the bridge occur twice, once for each of its sides.
            let ring: Vec<u32> = outer[..=a]
                .iter()
                .chain(&inner[b..])
                .chain(&inner[..=b])
                .chain(&outer[a..])
                .copied()
                .collect();
            let worst = quality(&ring);
            if best.as_ref().is_none_or(|(other, _)| worst > *other) {
                best = Some((worst, ring));
            }
        }
    }
    best.map_or_else(|| outer.to_vec(), |(_, ring)| ring)
}

struct BridgedPolygon<'a> {
    ring: &'a [u32],
    corners: &'a [[f64; 3]],
    is_straight: &'a [bool],
    normal: [f64; 3],
}

/// The quality of a forbidden triangle. Defined: below that of all others, which is above −2/√3.
const FORBIDDEN: f64 = -9.0;

impl BridgedPolygon<'_> {
    /// Twice the signed area over the square of the longest side. If it is positive for all triangles, they cover the
    /// polygon once.
    fn quality(&self, triangle: [usize; 3]) -> f64 {
        let n = self.ring.len();
        let is_flat = |k: usize| {
            let neighbours = [triangle[(k + 1) % 3], triangle[(k + 2) % 3]];
            let at = triangle[k];
            self.is_straight[self.ring[at] as usize]
                && neighbours.contains(&((at + 1) % n))
                && neighbours.contains(&((at + n - 1) % n))
        };
        // A flat triangle, whatever rounding makes of its area.
        if (0..3).any(is_flat) {
            return FORBIDDEN;
        }
        let [a, b, c] = triangle.map(|k| self.corners[self.ring[k] as usize]);
        let (ab, ac, bc) = (difference(b, a), difference(c, a), difference(c, b));
        let longest = [ab, ac, bc].iter().map(|side| dot(*side, *side)).fold(0.0, |x, y| greater(y, x));
        let area = dot(cross(ab, ac), self.normal) / length(self.normal);
        let quality = area / longest;
        if quality.is_nan() { -1.0 } else { quality }
    }

    /// Adds the triangulation whose worst triangle is best, and returns the quality of that triangle.
    ///
    /// Source: G. Klincsek, *Minimal Triangulations of Polygonal Domains*, 1980.
    fn triangulate_best(&self, into: &mut Vec<[u32; 3]>) -> f64 {
        let n = self.ring.len();
        // Between neighbours there is no triangle, and thus no bad one. Entry a·n + c is for the corners from
        // a to c.
        let mut worst = vec![f64::INFINITY; n * n];
        let mut apex = vec![0_usize; n * n];
        // By ascending gaps, so that both parts beside a triangle are known.
        for gap in 2..n {
            for a in 0..n - gap {
                let c = a + gap;
                let mut best = f64::NEG_INFINITY;
                for b in a + 1..c {
                    let parts = [worst[a * n + b], worst[b * n + c], self.quality([a, b, c])];
                    let least = parts.iter().fold(f64::INFINITY, |x, y| lesser(*y, x));
                    if least > best {
                        best = least;
                        apex[a * n + c] = b;
                    }
                }
                worst[a * n + c] = best;
            }
        }
        let mut pending = vec![(0, n - 1)];
        while let Some((a, c)) = pending.pop() {
            if c - a < 2 {
                continue;
            }
            let b = apex[a * n + c];
            into.push([a, b, c].map(|k| self.ring[k]));
            pending.extend([(a, b), (b, c)]);
        }
        worst[n - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(loops: &[&[[f64; 3]]], triangles: &[[u32; 3]]) -> (f64, f64) {
        let corners = loops.concat();
        let parts = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|k| corners[k as usize]);
            0.5 * cross(difference(b, a), difference(c, a))[2]
        });
        parts.fold((0.0, f64::INFINITY), |(sum, least), x| (sum + x, lesser(x, least)))
    }

    fn at(corners: &[[f64; 2]]) -> Vec<[f64; 3]> {
        corners.iter().map(|[x, y]| [*x, *y, 0.5]).collect()
    }

    #[test]
    fn corners_in_a_line_make_no_flat_triangles() {
        // A triangle with a corner at the midpoint of one of its sides.
        let ring = at(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]]);
        let mut triangles = Vec::new();
        triangulate(&[&ring], &[false, true, false, false, false], &mut triangles);
        let (sum, least) = area(&[&ring], &triangles);
        assert!(triangles.len() == 3 && sum == 2.0 && least > 0.2);
    }

    #[test]
    fn notches_and_holes_are_left_out() {
        let outer = at(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 3.0], [0.0, 4.0]]);
        let hole = at(&[[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]);
        for loops in [[&outer[..], &hole[..]], [&hole[..], &outer[..]]] {
            let mut triangles = Vec::new();
            triangulate(&loops, &[false; 9], &mut triangles);
            let (sum, least) = area(&loops, &triangles);
            assert!(triangles.len() == 9 && (sum - 13.0).abs() < 1e-12 && least > 0.0, "{sum} {least}");
        }
    }
}
