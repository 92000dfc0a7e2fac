//! Where the samples of image data are: extent, origin, spacing and direction.
use super::document::{VtiDocument, VtiElement};
use crate::ReadError;
use crate::text::{finite, integer, show};
use chordal::implicit::Affine3;

/// A box of the lattice: its lowest index, and the number of points along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct VtiExtent {
    pub low: [i64; 3],
    pub size: [i64; 3],
}

impl VtiExtent {
    /// The extent that an attribute says.
    ///
    /// # Errors
    /// When it is missing, or is not six whole numbers in order.
    pub(super) fn read(
        document: &VtiDocument<'_>,
        element: &VtiElement,
        name: &str,
    ) -> Result<Self, ReadError> {
        let text = document.need(element, name)?;
        let wrong = || {
            let message = format!("{name} {} is no extent, as in 0 9 0 9 0 9", show(text.as_bytes()));
            document.error("bad-header", element, message)
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
/// When it is singular, or a number is not finite.
pub(super) fn affine(document: &VtiDocument<'_>, shift: [f64; 3]) -> Result<Affine3, ReadError> {
    let origin = numbers(document, "Origin", [0.0; 3])?;
    let spacing = numbers(document, "Spacing", [1.0; 3])?;
    let turn = numbers(document, "Direction", [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    let rows = [0, 1, 2].map(|k| {
        let steps = [0, 1, 2].map(|axis| turn[3 * k + axis] * spacing[axis]);
        let start = origin[k] + steps[0] * shift[0] + steps[1] * shift[1] + steps[2] * shift[2];
        [steps[0], steps[1], steps[2], start]
    });
    Affine3::new(rows).map_err(|error| document.error("singular", &document.image, error.to_string()))
}

/// The numbers of an attribute of the image, or what they are without it.
fn numbers<const N: usize>(
    document: &VtiDocument<'_>,
    name: &str,
    without: [f64; N],
) -> Result<[f64; N], ReadError> {
    let Some(text) = document.image.get(name) else { return Ok(without) };
    let mut all = without;
    let mut words = text.split_ascii_whitespace();
    let wrong = || {
        let message = format!("{name} {} is not {N} numbers", show(text.as_bytes()));
        document.error("bad-header", &document.image, message)
    };
    for number in &mut all {
        let word = words.next().ok_or_else(wrong)?;
        *number = finite(word.as_bytes(), || document.place(&document.image))?;
    }
    if words.next().is_some() { Err(wrong()) } else { Ok(all) }
}
