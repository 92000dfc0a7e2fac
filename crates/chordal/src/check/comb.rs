//! The curvature comb of a planar path: normals with lengths proportional to the curvature.
use crate::explicit::{Curve, CurveSegment};
use crate::math::length;

/// One tooth of a comb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tooth {
    /// The parameter on the path (see [`Curve::at`]).
    pub place: f64,
    /// The point of the path where the tooth starts.
    pub on_curve: [f64; 2],
    /// The end of the tooth: on the outer side of the bend.
    pub tip: [f64; 2],
    /// The inverse of the radius of the osculating circle, positive if the path turns left.
    pub curvature: f64,
}

/// The comb of each piece, in order: `n + 1` teeth at equal parameter steps, both ends of the piece included,
/// each as long as the curvature there times `scale`. Two teeth start where two pieces meet; they end in the
/// same point exactly if direction and curvature are the same.
///
/// A point with zero speed, as in a cusp, has no curvature and no tooth.
///
/// ```
/// use chordal::{Bezier, check};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let comb = check::curves::curvature_comb(&arch.into(), 2, 0.5);
/// // In the middle the first derivative is (3/2, 0) and the second (0, -6): the path turns right.
/// let middle = &comb[0][1];
/// assert_eq!(middle.on_curve, [0.5, 0.75]);
/// assert!((middle.curvature + 6.0 / 2.25).abs() < 1e-12);
/// assert!((middle.tip[1] - (0.75 + 0.5 * 6.0 / 2.25)).abs() < 1e-12);
/// ```
#[must_use]
pub fn curvature_comb(curve: &Curve<2>, n: usize, scale: f64) -> Vec<Vec<Tooth>> {
    let steps = n.max(1);
    let of_piece = |(index, piece): (usize, &CurveSegment<2>)| {
        (0..=steps)
            .filter_map(|i| {
                let t = i as f64 / steps as f64;
                tooth(piece, t, scale).map(|tooth| Tooth { place: index as f64 + t, ..tooth })
            })
            .collect()
    };
    curve.segments().iter().enumerate().map(of_piece).collect()
}

fn tooth(piece: &CurveSegment<2>, t: f64, scale: f64) -> Option<Tooth> {
    let (on_curve, first, second) = (piece.at(t), piece.tangent(t), piece.second_derivative(t));
    let speed = length(first);
    let curvature = (first[0] * second[1] - first[1] * second[0]) / (speed * speed * speed);
    if !curvature.is_finite() {
        return None;
    }
    // The left normal is (-y', x') / speed; the outer side of a left turn is on the right.
    let reach = scale * curvature / speed;
    let tip = [on_curve[0] + reach * first[1], on_curve[1] - reach * first[0]];
    tip.iter().all(|x| x.is_finite()).then_some(Tooth { place: t, on_curve, tip, curvature })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::{Bezier, CurveEnds};

    #[test]
    fn an_almost_circle_has_teeth_of_almost_one_length_pointing_outwards() {
        // The usual cubic for a quarter of the unit circle. Its curvature is least at the ends, where it is
        // two thirds of the distance of the third control point from the tangent over the square of that of
        // the second: 0.97853.
        let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
        let quarter = Bezier { control: [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]] };
        let least = 2.0 / 3.0 * (1.0 - k) / (k * k);
        let comb = &curvature_comb(&quarter.into(), 16, 1.0)[0];
        for tooth in [comb[0], comb[16]] {
            assert!((tooth.curvature - least).abs() < 1e-12, "{tooth:?}");
        }
        for tooth in comb {
            assert!((tooth.curvature - 1.0).abs() <= 1.0 - least + 1e-12, "{tooth:?}");
            let [x, y] = tooth.tip;
            // The radius of this cubic is accurate to 3e-4.
            assert!(((x * x + y * y).sqrt() - 1.0 - tooth.curvature).abs() < 5e-4, "{tooth:?}");
        }
        let back = &curvature_comb(&quarter.reversed().into(), 16, 1.0)[0];
        for (tooth, twin) in back.iter().zip(comb.iter().rev()) {
            assert!((tooth.curvature + twin.curvature).abs() < 1e-12, "{tooth:?}");
        }
    }

    #[test]
    fn a_line_has_teeth_without_length_and_a_point_none() {
        let line = Curve::new(vec![CurveSegment::Line([[0.0, 0.0], [2.0, 1.0]])], CurveEnds::Open).unwrap();
        let comb = curvature_comb(&line, 4, 3.0);
        assert!(comb[0].len() == 5 && comb[0].iter().all(|tooth| tooth.tip == tooth.on_curve));
        let still = Bezier { control: [[1.0, 1.0]; 4] };
        assert!(curvature_comb(&still.into(), 4, 1.0)[0].is_empty());
    }

    #[test]
    fn a_cusp_has_no_tooth() {
        let cusp = Bezier { control: [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]] };
        let comb = curvature_comb(&cusp.into(), 2, 1.0);
        assert_eq!(comb[0].iter().map(|tooth| tooth.place).collect::<Vec<_>>(), [0.0, 1.0]);
    }
}
