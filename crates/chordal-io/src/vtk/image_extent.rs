//! The positions of the samples of image data: extent, origin, spacing and direction.
use super::xml_document::VtkDocument;
use crate::ReadError;
use crate::text::{finite, integer, show};
use crate::xml_text::place;
use chordal::implicit::Affine3;

/// A box of the lattice: its lowest index, and the number of points along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ImageExtent {
    pub low: [i64; 3],
    pub size: [i64; 3],
}

impl ImageExtent {
    /// The extent in the attribute `name` of the element at an offset.
    ///
    /// # Errors
    /// If it is missing, or is not six whole numbers in order.
    pub(super) fn read(
        document: &VtkDocument<'_>,
        at: usize,
        name: &str,
        text: Option<&str>,
    ) -> Result<Self, ReadError> {
        let text = text.ok_or_else(|| {
            document.error(at, "missing-attribute", format!("the element has no attribute '{name}'"))
        })?;
        let wrong = || {
            let message = format!("{name} {} is no extent, as in 0 9 0 9 0 9", show(text.as_bytes()));
            document.error(at, "bad-header", message)
        };
        let mut numbers = [0; 6];
        let mut words = text.split_ascii_whitespace();
        for number in &mut numbers {
            *number = words.next().and_then(|word| integer(word.as_bytes()).ok()).ok_or_else(wrong)?;
        }
        if words.next().is_some() {
            return Err(wrong());
        }
        let mut size = [0; 3];
        for (axis, n) in size.iter_mut().enumerate() {
            let points = numbers[2 * axis + 1].checked_sub(numbers[2 * axis]).and_then(|n| n.checked_add(1));
            *n = points.filter(|n| *n > 0).ok_or_else(wrong)?;
        }
        Ok(Self { low: [numbers[0], numbers[2], numbers[4]], size })
    }

    /// The box of the cells between its points.
    pub(super) fn cells(self) -> Self {
        Self { low: self.low, size: self.size.map(|n| n - 1) }
    }
}

/// The map from the indices of a lattice that begins `shift` steps after index 0.
///
/// # Errors
/// If it is singular, or a number is not finite.
pub(super) fn affine(document: &VtkDocument<'_>, shift: [f64; 3]) -> Result<Affine3, ReadError> {
    let image = &document.image;
    let origin = numbers(document, "Origin", &image.origin, [0.0; 3])?;
    let spacing = numbers(document, "Spacing", &image.spacing, [1.0; 3])?;
    let straight = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let turn = numbers(document, "Direction", &image.direction, straight)?;
    let rows = [0, 1, 2].map(|k| {
        let steps = [0, 1, 2].map(|axis| turn[3 * k + axis] * spacing[axis]);
        let start = origin[k] + steps[0] * shift[0] + steps[1] * shift[1] + steps[2] * shift[2];
        [steps[0], steps[1], steps[2], start]
    });
    Affine3::new(rows).map_err(|error| document.error(image.at, "singular", error.to_string()))
}

/// The numbers of an attribute of the image, or their default.
fn numbers<const N: usize>(
    document: &VtkDocument<'_>,
    name: &str,
    text: &Option<String>,
    without: [f64; N],
) -> Result<[f64; N], ReadError> {
    let Some(text) = text else { return Ok(without) };
    let mut values = without;
    let mut words = text.split_ascii_whitespace();
    let wrong = || {
        let message = format!("{name} {} is not {N} numbers", show(text.as_bytes()));
        document.error(document.image.at, "bad-header", message)
    };
    for number in &mut values {
        let word = words.next().ok_or_else(wrong)?;
        *number = finite(word.as_bytes(), || place(document.text, document.image.at))?;
    }
    if words.next().is_some() { Err(wrong()) } else { Ok(values) }
}
