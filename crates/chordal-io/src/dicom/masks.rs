//! The volume of labels that the masks of a segmentation make.
//!
//! Source: NEMA, *DICOM PS3.3*, 2024, C.8.20.
use super::series::{DicomSlice, PLACE, affine_of, check_alike, dot, normal_of, refused};
use crate::grow::{push_many, with_room};
use crate::unpack_cap::UnpackCap;
use crate::volume::count::size_of;
use crate::volume::element::SampleType;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::implicit::{Affine3, Samples};

/// The labels of masks, one mask for each segment and slice, or one map of numbers of segments for each slice;
/// slices without either are empty. A sample in several segments has the smallest of their numbers, with a
/// warning.
///
/// # Errors
/// If masks are not at steps of a lattice, have no segment, or the lattice exceeds a limit.
pub(super) fn labels_of(
    mut masks: Vec<DicomSlice<'_>>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<([usize; 3], Samples, Affine3), ReadError> {
    check_alike(&masks)?;
    let first = masks[0];
    let normal = normal_of(&first);
    let length = dot(normal, normal).sqrt();
    let along = |slice: &DicomSlice<'_>| dot(slice.frame().position, normal) / length;
    masks.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let lowest = masks[0];
    let (low, high) = (along(&lowest), along(&masks[masks.len() - 1]));
    let gaps = masks.windows(2).map(|two| along(&two[1]) - along(&two[0]));
    // Masks of several segments are at one position.
    let apart = gaps.filter(|gap| *gap > PLACE * first.frame().spacing[0]);
    let step = lowest.frame().between.filter(|step| *step > 0.0).or_else(|| apart.min_by(f64::total_cmp));
    let Some(step) = step.filter(|step| high - low > PLACE * step) else {
        let message = "the segmentation has one slice; a volume has 2 or more along each axis";
        return Err(refused("flat-volume", &lowest, message));
    };
    // A stated distance may be rounded, which adds up over many slices.
    let n_steps = ((high - low) / step + 0.5).floor();
    let (off, even) = (high - low - n_steps * step, (high - low) / n_steps);
    let is_rounded = off.abs() > PLACE * step && (even - step).abs() <= PLACE * step;
    let step = if is_rounded { even } else { step };
    let format = first.file.format;
    // The conversion saturates; the size is checked below.
    let n_slices = ((high - low) / step + 0.5).floor() as i64 + 1;
    let place = FileLocation::File;
    let largest = masks.iter().filter_map(|mask| mask.frame().segment).max().unwrap_or(0);
    let element = match format.element {
        SampleType::Bool if largest > 0xFF => SampleType::U16,
        SampleType::Bool => SampleType::U8,
        map => map,
    };
    let size = size_of([format.columns as i64, format.rows as i64, n_slices], element, &place, limits)?;
    let n = size.iter().product::<usize>();
    let stored: u64 =
        masks.iter().map(|mask| mask.file.sizes().0.div_ceil(mask.file.frames.len() as u64)).sum();
    if UnpackCap::VOLUME.is_too_dense((n * element.width()) as u64, stored) {
        let message = format!("the segmentation {}", UnpackCap::VOLUME.too_dense(stored));
        return Err(refused("too-dense", &first, &message));
    }
    let mut labels: Vec<u16> = Vec::new();
    push_many(&mut labels, 0, n)?;
    masks.sort_by_key(|mask| mask.frame().segment);
    let n_pixels = size[0] * size[1];
    let mut overlaps = 0;
    let origin = lowest.frame().position;
    let steps = normal.map(|x| x / length * step);
    for mask in &masks {
        let numbers = numbers_of(mask).map_err(|error| error.within(&mask.name()))?;
        let k = ((along(mask) - low) / step + 0.5).floor();
        let offset: [f64; 3] =
            std::array::from_fn(|axis| mask.frame().position[axis] - (origin[axis] + k * steps[axis]));
        let off = dot(offset, offset).sqrt() / step;
        if off > PLACE {
            let message = format!("the mask is {off:.3} steps from its place, and at most {PLACE} is read");
            return Err(refused("uneven-slices", mask, &message));
        }
        let slice = &mut labels[k as usize * n_pixels..][..n_pixels];
        for (label, number) in slice.iter_mut().zip(numbers).filter(|(_, number)| *number > 0) {
            overlaps += u64::from(*label != 0 && *label != number);
            *label = if *label == 0 || number < *label { number } else { *label };
        }
    }
    if overlaps > 0 {
        warnings.count_all(
            "segments-overlap",
            overlaps,
            "samples are in several segments and were given to the one with the smallest number",
        );
    }
    let affine = affine_of(&first, steps, origin)?;
    if element == SampleType::U16 {
        return Ok((size, Samples::U16(labels), affine));
    }
    let mut bytes = with_room(n)?;
    bytes.extend(labels.iter().map(|label| *label as u8));
    Ok((size, Samples::U8(bytes), affine))
}

/// The number of a segment for each sample of a mask or of a map, 0 outside.
fn numbers_of(mask: &DicomSlice<'_>) -> Result<Vec<u16>, ReadError> {
    let format = mask.file.format;
    // The size of a slice is checked by now.
    let mut numbers = with_room(format.n_pixels() as usize)?;
    if format.element == SampleType::Bool {
        mask.file.check_bits()?;
        let Some(number) = mask.frame().segment.filter(|number| *number > 0) else {
            let message = "the mask names no segment";
            return Err(ReadError::new("missing-attribute", FileLocation::File, message));
        };
        let is_in = |pixel: usize| mask.file.bit(mask.number, pixel);
        numbers.extend((0..format.n_pixels() as usize).map(|pixel| if is_in(pixel) { number } else { 0 }));
        return Ok(numbers);
    }
    let mut bytes = Vec::new();
    mask.file.append_samples(mask.number, &mut bytes)?;
    let number = |sample: &[u8]| sample.iter().rev().fold(0, |number, byte| number << 8 | u16::from(*byte));
    numbers.extend(bytes.chunks_exact(format.element.width()).map(number));
    Ok(numbers)
}
