//! Orientation of a NIfTI volume: its sform, else its qform, else the steps between its samples.
use super::header::{NiftiHeader, header_error};
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::implicit::Affine3;

/// The map from indices to patient coordinates: the first of the standard's three methods that the file
/// provides.
///
/// # Errors
/// If it is singular, or a number in it is not finite.
pub(super) fn affine(header: &NiftiHeader, warnings: &mut Warnings) -> Result<Affine3, ReadError> {
    let refused = |at: usize, error: &dyn std::fmt::Display| header_error("singular", at, error.to_string());
    if header.sform > 0 {
        return Affine3::new(header.rows).map_err(|error| refused(header.rows_at, &error));
    }
    let steps = steps(header)?;
    if header.qform > 0 {
        let rows = by_quaternion(header, steps)?;
        return Affine3::new(rows).map_err(|error| refused(header.quaternion_at, &error));
    }
    warnings.count("no-orientation", || {
        let message = "the file does not say how its volume lies in space (neither sform nor qform): \
                       axes run along its indices, and left and right are not known";
        (FileLocation::Byte(header.pixdim_at as u64), message.to_owned())
    });
    let [x, y, z] = steps;
    Affine3::new([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
        .map_err(|error| refused(header.pixdim_at, &error))
}

/// The steps between samples, checked to be positive and finite.
fn steps(header: &NiftiHeader) -> Result<[f64; 3], ReadError> {
    let mut steps = [0.0; 3];
    for (axis, step) in steps.iter_mut().enumerate() {
        *step = header.pixdim[axis + 1];
        if !(*step > 0.0 && step.is_finite()) {
            let message = format!("the step along axis {axis} is {step}, which is no length");
            return Err(header_error("singular", header.pixdim_at, message));
        }
    }
    Ok(steps)
}

/// Rows of the map of a unit quaternion (a, b, c, d) whose a is not stored: "method 2" of `nifti1.h`.
fn by_quaternion(header: &NiftiHeader, [x, y, z]: [f64; 3]) -> Result<[[f64; 4]; 3], ReadError> {
    let [mut b, mut c, mut d] = header.quaternion;
    let squares = b * b + c * c + d * d;
    if !squares.is_finite() {
        return Err(header_error(
            "singular",
            header.quaternion_at,
            "the quaternion of the qform is not finite",
        ));
    }
    // Below this, a is rounding noise of b, c and d, which have single precision. Derived: 2⁻²³, as in the
    // standard's own code.
    const NOISE: f64 = 1e-7;
    let mut a = 1.0 - squares;
    if a < NOISE {
        let scale = 1.0 / squares.sqrt();
        (a, b, c, d) = (0.0, b * scale, c * scale, d * scale);
    } else {
        a = a.sqrt();
    }
    // A negative first entry flips the third axis.
    let z = if header.pixdim[0] < 0.0 { -z } else { z };
    let [p, q, r] = header.shift;
    Ok([
        [(a * a + b * b - c * c - d * d) * x, 2.0 * (b * c - a * d) * y, 2.0 * (b * d + a * c) * z, p],
        [2.0 * (b * c + a * d) * x, (a * a + c * c - b * b - d * d) * y, 2.0 * (c * d - a * b) * z, q],
        [2.0 * (b * d - a * c) * x, 2.0 * (c * d + a * b) * y, (a * a + d * d - b * b - c * c) * z, r],
    ])
}
