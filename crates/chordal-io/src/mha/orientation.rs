//! The positions of a MetaImage's samples: spacing, directions and origin.
use super::fields::MetaFields;
use crate::warnings::Warnings;
use crate::{Axis, FileLocation, Frame, ReadError};
use chordal::implicit::Affine3;

/// The map from the indices of the first three of `n_axes` axes.
///
/// # Errors
/// If it is singular, or a fourth axis has a direction in space.
pub(super) fn affine(
    fields: &MetaFields<'_>,
    n_axes: usize,
    warnings: &mut Warnings,
) -> Result<Affine3, ReadError> {
    let spacing = fields.get("ElementSpacing").or_else(|| fields.get("ElementSize"));
    let steps = match &spacing {
        Some(field) => {
            let steps = field.numbers(n_axes)?;
            if let Some(axis) = steps[..3].iter().position(|step| *step == 0.0) {
                let message = format!("the spacing of axis {axis} is 0, which is no step");
                return Err(ReadError::new("singular", field.place(), message));
            }
            steps
        }
        None => {
            warnings.count("no-orientation", || {
                let message = "the file says no spacing: its samples are 1 apart";
                (FileLocation::Line(fields.last_line), message)
            });
            vec![1.0; n_axes]
        }
    };
    let matrix = fields.one_of(&["TransformMatrix", "Rotation", "Orientation"])?;
    let directions = match &matrix {
        Some(field) => field.numbers(n_axes * n_axes)?,
        None => (0..n_axes * n_axes).map(|k| if k % (n_axes + 1) == 0 { 1.0 } else { 0.0 }).collect(),
    };
    let origin = match fields.one_of(&["Offset", "Position", "Origin"])? {
        Some(field) => field.numbers(n_axes)?,
        None => vec![0.0; n_axes],
    };
    count_centre(fields, warnings)?;
    let line = matrix.or(spacing).map_or(fields.last_line, |field| field.line);
    let singular = |message: String| ReadError::new("singular", FileLocation::Line(line), message);
    // The numbers of one index axis are consecutive in the matrix.
    let along = |axis: usize, k: usize| directions[axis * n_axes + k];
    if n_axes == 4 && (0..3).any(|k| along(k, 3) != 0.0 || along(3, k) != 0.0) {
        return Err(singular("the fourth axis is not apart from the three of space".to_owned()));
    }
    let row = |k: usize| [along(0, k) * steps[0], along(1, k) * steps[1], along(2, k) * steps[2], origin[k]];
    let affine = Affine3::new([row(0), row(1), row(2)]).map_err(|error| singular(error.to_string()))?;
    count_contradiction(fields, &affine, warnings);
    Ok(affine)
}

/// The frame and the name of its axes. A file with anatomical directions is in the space of ITK.
pub(super) fn space(
    fields: &MetaFields<'_>,
    warnings: &mut Warnings,
) -> Result<(Frame, Option<String>), ReadError> {
    let metres_per_unit = match fields.get("DistanceUnits") {
        None => None,
        Some(field) => match field.value {
            b"mm" => Some(0.001),
            b"cm" => Some(0.01),
            b"m" => Some(1.0),
            // A micrometre, exact to the last place.
            b"um" => Some(1e-6),
            b"?" | b"" => None,
            _ => {
                warnings.count("unknown-unit", || {
                    (field.place(), format!("the unit {} is not known", field.shown()))
                });
                None
            }
        },
    };
    let is_anatomy = anatomy(fields).is_some();
    let up = is_anatomy.then_some(Axis::Z);
    Ok((Frame { up, metres_per_unit, ..Frame::default() }, is_anatomy.then(|| "LPS".to_owned())))
}

/// The sides at which the three index axes begin, as in "RAI" for right, front and feet.
fn anatomy<'a>(fields: &MetaFields<'a>) -> Option<&'a [u8]> {
    let value = fields.get("AnatomicalOrientation")?.value;
    let axis = |letter: &u8| b"RLAPIS".iter().position(|known| known == letter).map(|k| k / 2);
    let letters = value.get(..3)?;
    let mut axes: Vec<usize> = letters.iter().filter_map(axis).collect();
    axes.sort_unstable();
    (axes == [0, 1, 2]).then_some(letters)
}

/// Counts letters that contradict the directions.
fn count_contradiction(fields: &MetaFields<'_>, affine: &Affine3, warnings: &mut Warnings) {
    let (Some(letters), Some(field)) = (anatomy(fields), fields.get("AnatomicalOrientation")) else { return };
    let letter = |step: [f64; 3]| {
        let size = step.map(f64::abs);
        // x runs to the left, y to the back, z to the head; a letter is the side where an axis begins.
        let axis = (0..3).fold(0, |most, k| if size[k] > size[most] { k } else { most });
        let is_tie = (0..3).any(|k| k != axis && size[k] == size[axis]);
        (!is_tie).then(|| [b"RL", b"AP", b"IS"][axis][usize::from(step[axis] < 0.0)])
    };
    let differs = affine
        .steps()
        .iter()
        .zip(letters)
        .any(|(step, declared)| letter(*step).is_some_and(|l| l != *declared));
    if differs {
        warnings.count("orientation-differs", || {
            let message = format!(
                "AnatomicalOrientation {} is not what the directions say; these place the samples",
                field.shown()
            );
            (field.place(), message)
        });
    }
}

/// Counts a centre of rotation, which programs ignore for images.
fn count_centre(fields: &MetaFields<'_>, warnings: &mut Warnings) -> Result<(), ReadError> {
    let Some(field) = fields.get("CenterOfRotation") else { return Ok(()) };
    let n = field.value.split(|b| crate::text::is_space(*b)).filter(|token| !token.is_empty()).count();
    if field.numbers(n)?.iter().any(|x| *x != 0.0) {
        warnings.count("centre-ignored", || {
            let message = "CenterOfRotation was not used, as by ITK: the offset is where sample 0 is";
            (field.place(), message)
        });
    }
    Ok(())
}
