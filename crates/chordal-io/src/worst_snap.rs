//! `worst_snap`: an upper bound of the error of rounding to a format, before a mesh exists.
use crate::format::Format;
use crate::format_columns::PositionPrecision;
use crate::single_precision::{F32_BOTTOM, F32_STEP};
use crate::snapped_mesh::distance_up;
use chordal::math::{Box3, add_up, mul_up};

/// An upper bound of the distance by which [`snap`] moves any vertex inside `bounds`.
///
/// Infinite if `snap` may fail. Zero for the empty box and for formats that keep every bit.
///
/// ```
/// use chordal::math::Box3;
/// use chordal_io::{Format, worst_snap};
///
/// let bounds = Box3 { min: [-1.0; 3], max: [1.0; 3] };
/// assert_eq!(worst_snap(&bounds, Format::Obj), 0.0);
/// assert!(worst_snap(&bounds, Format::Glb) < 2.1e-7);
/// ```
#[must_use]
pub fn worst_snap(bounds: &Box3, format: Format) -> f64 {
    let precision = format.precision();
    if bounds.is_empty() || precision == PositionPrecision::Double {
        return 0.0;
    }
    let axis = |k: usize| {
        let reach = bounds.min[k].abs().max(bounds.max[k].abs());
        if reach > f64::from(f32::MAX) {
            return f64::INFINITY;
        }
        // The largest stored number: a coordinate or, about an origin, either a coordinate (then reach ≤
        // 2·half) or the distance to the origin. The origin is off the centre by at most half / 16 or, far
        // out, by half a single-precision step of the centre, 2⁻²⁴·reach. 2·half + 2⁻²³·reach covers all
        // cases.
        let half = add_up(0.5 * bounds.max[k], -0.5 * bounds.min[k]);
        let about_centre = add_up(mul_up(2.0, half), mul_up(F32_STEP, reach));
        let stored =
            if precision == PositionPrecision::Single || reach < about_centre { reach } else { about_centre };
        // Rounding to f32 costs half a step, relative or at the bottom of the range. Subtracting the origin
        // and adding it back each cost half a step of f64, of numbers below 2·reach.
        let single = add_up(mul_up(stored, 0.5 * F32_STEP), F32_BOTTOM);
        add_up(single, mul_up(2.0 * f64::EPSILON, reach))
    };
    let side = [axis(0), axis(1), axis(2)];
    if side.iter().any(|s| s.is_infinite()) { f64::INFINITY } else { distance_up([0.0; 3], side) }
}
