//! The distance between different ways to cut a polygon into triangles.
use crate::explicit::closest_on_segments;
use crate::math::{add_up, cross, difference, div_up, greater, length_up, lesser, mul_up, sub_up};

/// Rounding of a sum of up to four products of three factors, relative to the sum of their sizes. Derived: a
/// product has five roundings of half an `EPSILON`, and the sum of sizes as many.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// An upper bound of the distance between two ways to cut a polygon into triangles: from any point of one to
/// the other. 0 for a triangle, and at most its rounding for a flat polygon.
///
/// For a quadrilateral it is the distance of its diagonals, and holds for any two ways. Proof: call the
/// points p of a diagonal and q of the other. The four triangles between the sides and p are one way to cut
/// it, since p lies on the edge that divides it, and those between the sides and q are the other. Map each to
/// its counterpart, corner to corner and p to q: a linear map moves no point farther than |p − q|, and every
/// point has a counterpart in both.
///
/// For more corners it is the thickness of the polygon along its Newell normal: two ways that do not overlap
/// themselves, seen along the normal, are two heights over one area, between those of the corners. For ways
/// that do overlap there is no bound.
///
/// ```
/// use chordal::explicit::triangulate::other_cut_within;
/// // A unit square with two corners a tenth above the others: its diagonals pass at that distance.
/// let bent = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];
/// let apart = other_cut_within(&bent);
/// assert!((0.1..0.1 + 1e-14).contains(&apart));
/// assert_eq!(other_cut_within(&bent[..3]), 0.0);
/// ```
#[must_use]
pub fn other_cut_within(corners: &[[f64; 3]]) -> f64 {
    match corners {
        [] | [_] | [_, _] | [_, _, _] => 0.0,
        &[a, b, c, d] => between_diagonals([a, b, c, d]),
        corners => thickness(corners),
    }
}

fn between_diagonals([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let [s, t] = closest_on_segments([a, c], [b, d], 0.0);
    // After rounding they are still between 0 and 1, and any point of a diagonal serves.
    let difference_up: [f64; 3] = std::array::from_fn(|k| {
        let terms = [(1.0 - s) * a[k], s * c[k], -(1.0 - t) * b[k], -t * d[k]];
        let sizes = terms.iter().fold(0.0, |sum, x| add_up(sum, x.abs()));
        add_up(((terms[0] + terms[1]) + (terms[2] + terms[3])).abs(), mul_up(ROUNDED, sizes))
    });
    length_up(difference_up)
}

fn thickness(corners: &[[f64; 3]]) -> f64 {
    let from = corners[0];
    let mut normal = [0.0; 3];
    for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let area = cross(difference(*p, from), difference(*q, from));
        (0..3).for_each(|k| normal[k] += area[k]);
    }
    let (mut low, mut high, mut rounding) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
    for p in corners {
        let terms: [f64; 3] = std::array::from_fn(|k| normal[k] * p[k]);
        let height = terms[0] + terms[1] + terms[2];
        let sizes = terms.iter().fold(0.0, |sum, x| add_up(sum, x.abs()));
        (low, high) = (lesser(low, height), greater(high, height));
        rounding = greater(rounding, mul_up(ROUNDED, sizes));
    }
    // The rounding of the length is far less than this share of it.
    let length = length_up(normal) * (1.0 - ROUNDED);
    let thick = div_up(add_up(sub_up(high, low), mul_up(2.0, rounding)), length);
    let across = (0..3).map(|k| {
        let extreme =
            |best: fn(f64, f64) -> f64, start: f64| corners.iter().fold(start, |m, p| best(m, p[k]));
        sub_up(extreme(greater, f64::NEG_INFINITY), extreme(lesser, f64::INFINITY))
    });
    let mut sides = [0.0; 3];
    sides.iter_mut().zip(across).for_each(|(side, across)| *side = across);
    // Both ways lie in the box of the corners, for any normal.
    let diagonal = length_up(sides);
    if thick < diagonal { thick } else { diagonal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    /// The distance from a point to a triangle, by a fine lattice of the triangle: never too small.
    fn to_triangle(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
        const STEPS: usize = 60;
        let mut smallest = f64::INFINITY;
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let (u, v) = (i as f64 / STEPS as f64, j as f64 / STEPS as f64);
                let offset: [f64; 3] =
                    std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) - p[k]);
                smallest = lesser(smallest, offset.iter().map(|x| x * x).sum::<f64>().sqrt());
            }
        }
        smallest
    }

    #[test]
    fn no_point_of_one_cut_is_farther_from_the_other() {
        let mut random = Random::new(18);
        for _ in 0..40 {
            let quad: [[f64; 3]; 4] = std::array::from_fn(|_| random.point_within(1.0));
            let [a, b, c, d] = quad;
            let bound = other_cut_within(&quad);
            let other = [[a, b, d], [b, c, d]];
            // The middle of the diagonal is at or near the point where the two are farthest apart.
            for share in [0.25, 0.5, 0.75] {
                let p = std::array::from_fn(|k| a[k] + share * (c[k] - a[k]));
                let away = other.iter().map(|t| to_triangle(p, *t)).fold(f64::INFINITY, lesser);
                // The lattice is off by less than half of its step, a thirtieth of edges shorter than 3.5.
                assert!(away <= bound + 0.06, "{away} {bound} {quad:?}");
            }
        }
    }

    #[test]
    fn flat_polygons_are_apart_by_rounding_alone() {
        let mut random = Random::new(19);
        for n in 4..9 {
            let circle: Vec<[f64; 3]> = (0..n)
                .map(|i| {
                    let (u, v) = [
                        (1.0, 0.0),
                        (0.5, 0.6),
                        (-0.2, 0.9),
                        (-0.8, 0.4),
                        (-0.9, -0.3),
                        (-0.4, -0.9),
                        (0.2, -1.0),
                        (0.7, -0.7),
                    ][i];
                    [u, v, 0.5 * u - 0.25 * v + 3.0]
                })
                .collect();
            assert!(other_cut_within(&circle) < 1e-13, "{n}");
            let mut bent = circle;
            bent[1][2] += random.between(0.1, 0.2);
            assert!(other_cut_within(&bent) > 0.03, "{n}");
        }
    }

    #[test]
    fn a_polygon_without_normal_is_bounded_by_its_box() {
        let spike = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
        assert!((0.0..=2.000_001).contains(&other_cut_within(&spike)));
        assert!(other_cut_within(&[[1.0; 3]; 5]) < 1e-100);
    }
}
