//! Coordinates in single precision about an origin.
use crate::glb::deformation::is_deformed;
use chordal::Mesh;
use chordal::math::greater;

/// One step of single precision relative to a power of two, 2⁻²³.
pub(crate) const F32_STEP: f64 = f32::EPSILON as f64;

/// Half the smallest single-precision number above zero, 2⁻¹⁵⁰.
pub(crate) const F32_BOTTOM: f64 = 0.5 * f32::from_bits(1) as f64;

/// The stored form of a coordinate: its distance to the origin in single precision.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn store(origin: f64, x: f64) -> f32 {
    // Without an origin nothing is subtracted, so −0 keeps its sign.
    if origin == 0.0 { x as f32 } else { (x - origin) as f32 }
}

/// The coordinate that a reader computes from the stored number.
pub(crate) fn restore(origin: f64, stored: f32) -> f64 {
    if origin == 0.0 { f64::from(stored) } else { origin + f64::from(stored) }
}

/// The point about which GLB stores a mesh.
///
/// Each axis has origin zero unless that costs more than one bit of the extent. The few origins that an
/// earlier snap could have chosen are tried first, zero before all others, and the first that keeps every
/// coordinate is taken. So snapping is idempotent although it changes the bounds a little.
pub(crate) fn origin_of(mesh: &Mesh) -> [f64; 3] {
    let bounds = mesh.bounds();
    // The joints of a skin place a mesh, not its node, and the weights of morph targets belong to one node.
    if bounds.is_empty() || is_deformed(mesh) {
        return [0.0; 3];
    }
    std::array::from_fn(|k| {
        let exact = |origin: &f64| {
            mesh.positions()
                .iter()
                .all(|p| restore(*origin, store(*origin, p[k])).to_bits() == p[k].to_bits())
        };
        let (best, likely) = candidates(bounds.min[k], bounds.max[k]);
        std::iter::once(0.0).chain(likely).find(exact).unwrap_or(best)
    })
}

/// The origin for an axis range, and the origins that the range could have had before rounding.
#[allow(clippy::cast_possible_truncation)]
fn candidates(low: f64, high: f64) -> (f64, Vec<f64>) {
    let half = 0.5 * high - 0.5 * low;
    let centre = 0.5 * high + 0.5 * low;
    // A coarse grid leaves the origin few bits, so that coordinates that already lie on a grid stay exact
    // about it.
    let coarse = power_of_two_below(half / 8.0);
    let finest = power_of_two_below(centre.abs()) * F32_STEP;
    let step = greater(coarse, finest);
    let on_grid = |rounded: f64, step: f64| f64::from((rounded * step) as f32);
    let reach = low.abs().max(high.abs());
    if step == 0.0 {
        return (0.0, Vec::new());
    }
    // Snapping moves the range by less than a step, and at most doubles or halves the step itself.
    let likely = [step, 0.5 * step, 2.0 * step]
        .into_iter()
        .flat_map(|s| [on_grid((centre / s).floor(), s), on_grid((centre / s).ceil(), s)])
        .filter(|origin| *origin != 0.0 && origin.is_finite())
        .collect();
    let best = if reach <= 2.0 * half { 0.0 } else { on_grid((centre / step).round(), step) };
    (best, likely)
}

/// The largest power of two that is not above a positive normal number; 0 for smaller numbers.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    // Masks out the fraction and keeps the exponent.
    f64::from_bits(x.to_bits() & 0x7FF0_0000_0000_0000)
}
