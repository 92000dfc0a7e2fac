//! Orientation of a NRRD volume: the map from indices to space, and the name of that space.
use super::fields::{NrrdField, NrrdHeader};
use crate::warnings::Warnings;
use crate::{Axis, FileLocation, Frame, ReadError};
use chordal::budget::advice::Message;
use chordal::implicit::Affine3;

fn singular(line: u64, message: impl Into<Message>) -> ReadError {
    ReadError::new("singular", FileLocation::Line(line), message)
}

/// The map from the indices of the three spatial axes: directions and origin, else spacings.
///
/// # Errors
/// If it is singular, or does not have three axes.
pub(super) fn affine(
    fields: &NrrdHeader,
    axes: [usize; 3],
    warnings: &mut Warnings,
) -> Result<Affine3, ReadError> {
    let origin = fields.origin.as_ref().map_or([0.0; 3], |origin| origin.value);
    let (steps, line) = match (&fields.directions, &fields.spacings) {
        (Some(NrrdField { value, line }), _) => {
            let step = |axis: usize| value.get(axis).copied().flatten();
            let steps: Option<Vec<[f64; 3]>> = axes.iter().map(|axis| step(*axis)).collect();
            let steps = steps.ok_or_else(|| singular(*line, "an axis of space has no direction"))?;
            ([steps[0], steps[1], steps[2]], *line)
        }
        (None, Some(NrrdField { value, line })) => {
            let mut steps = [[0.0; 3]; 3];
            for (k, axis) in axes.into_iter().enumerate() {
                let step = value.get(axis).copied().unwrap_or(f64::NAN);
                if !(step.is_finite() && step != 0.0) {
                    return Err(singular(
                        *line,
                        format!("the spacing of axis {axis} is {step}, which is no step"),
                    ));
                }
                steps[k][k] = step;
            }
            (steps, *line)
        }
        (None, None) => {
            warnings.count("no-orientation", || {
                let message = "the file says neither directions nor spacings: its samples are 1 apart";
                (FileLocation::File, message.to_owned())
            });
            ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 1)
        }
    };
    if let (Some(line), None) = (fields.mins, &fields.directions) {
        warnings.count("axis-mins-ignored", || {
            let message = "axis mins and maxs were not used: directions, or spacings from the origin, place the samples";
            (FileLocation::Line(line), message.to_owned())
        });
    }
    // The steps are the columns of the map.
    let row = |k: usize| [steps[0][k], steps[1][k], steps[2][k], origin[k]];
    Affine3::new([row(0), row(1), row(2)]).map_err(|error| singular(line, error.to_string()))
}

/// The frame, and the name of its axes.
///
/// # Errors
/// If it does not have three axes.
pub(super) fn space(
    fields: &NrrdHeader,
    warnings: &mut Warnings,
) -> Result<(Frame, Option<String>), ReadError> {
    if let Some(NrrdField { value, line }) = fields.space_dimension.as_ref().filter(|n| n.value != 3) {
        let message = format!("a space of {value} axes; three are expected");
        return Err(ReadError::new("not-3d", FileLocation::Line(*line), message));
    }
    let mut frame = Frame { up: None, metres_per_unit: unit(fields), ..Frame::default() };
    let Some(NrrdField { value, line }) = &fields.space else { return Ok((frame, None)) };
    let lower_case = value.to_ascii_lowercase();
    let (name, is_anatomy, is_left_handed) = match &lower_case[..] {
        "right-anterior-superior" | "ras" => ("RAS", true, false),
        "left-anterior-superior" | "las" => ("LAS", true, true),
        "left-posterior-superior" | "lps" => ("LPS", true, false),
        "scanner-xyz" => ("scanner-xyz", false, false),
        "3d-right-handed" => ("3D-right-handed", false, false),
        "3d-left-handed" => ("3D-left-handed", false, true),
        _ => {
            let message = format!(
                "space {} is not read: it has to have three axes",
                crate::text::show(value.as_bytes())
            );
            return Err(ReadError::new("unsupported", FileLocation::Line(*line), message));
        }
    };
    // The third axis points to the head in all anatomical spaces.
    frame.up = is_anatomy.then_some(Axis::Z);
    if is_left_handed {
        warnings.count("left-handed", || {
            let message = format!(
                "space {name} is left-handed: shapes come out as mirror images in programs that take \
                                   it for a right-handed one"
            );
            (FileLocation::Line(*line), message)
        });
    }
    Ok((frame, Some(name.to_owned())))
}

/// The length of one unit in metres, if all axes have the same known unit.
fn unit(fields: &NrrdHeader) -> Option<f64> {
    let units = &fields.units.as_ref()?.value;
    let named: Vec<&String> = units.iter().filter(|unit| !unit.is_empty() && *unit != "???").collect();
    let first = named.first()?;
    if !named.iter().all(|unit| unit == first) {
        return None;
    }
    match first.as_str() {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "mm" => Some(0.001),
        // A micrometre, exact to the last place.
        "um" | "µm" | "micron" | "microns" => Some(1e-6),
        _ => None,
    }
}
