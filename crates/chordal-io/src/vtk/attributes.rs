//! `VtkAttributes`: the arrays of points and cells as attributes of vertices and faces.
use super::array_place::ArrayPlace;
use super::names::{COLOR, NORMALS, POSITION_ID, TANGENTS, TEXCOORDS, is_of_set};
use super::number_array::NumberArray;
use crate::ReadError;
use crate::assemble::checked_position_ids;
use crate::grow::with_room;
use crate::text::{grouped, show};
use crate::volume::element::SampleType;
use crate::warnings::Warnings;
use chordal::explicit::{Attribute, Domain, Semantic};

/// The role of an array, if the file states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArrayRole {
    /// Not stated: the name and type of the array decide.
    Unknown,
    Normals,
    TexCoords,
    Colors,
}

/// An array with its name.
#[derive(Clone, Debug)]
pub(super) struct NamedArray<'a> {
    pub name: &'a str,
    pub role: ArrayRole,
    pub width: usize,
    /// The type of its numbers in the file.
    pub kind: SampleType,
    /// The divisor for colours.
    pub divisor: f64,
    pub numbers: NumberArray<'a>,
    /// Its position.
    pub place: ArrayPlace<'a>,
}

/// The elements that the rows of arrays belong to.
#[derive(Clone, Copy, Debug)]
pub(super) enum ArrayRows<'c> {
    Points(usize),
    /// The number of cells, and the cell of each triangle.
    Cells(usize, &'c [u32]),
}

/// The widest array that is kept. Defined by [`Attribute::width`].
const MOST_WIDE: usize = 16;
/// Larger integers may be rounded to f64. Derived: 2⁵³.
const EXACT: i64 = 1 << 53;
/// The values that may be copied to triangles of cells, in addition to the decoded bytes: a cell of many
/// corners has many triangles, each with all values of the cell. Chosen: with 8 bytes each they are the 64
/// MiB that a reader may take for any file.
pub(super) const FREE_VALUES: u64 = 8 << 20;

/// The attributes of one mesh.
#[derive(Debug, Default)]
pub(super) struct VtkAttributes {
    pub list: Vec<Attribute>,
    pub position_id: Option<Vec<u32>>,
    pub n_texcoords: u32,
    pub n_colors: u32,
    /// The number of values copied to triangles.
    pub n_spread: u64,
}

impl VtkAttributes {
    /// Adds an array.
    ///
    /// # Errors
    /// If it has fewer values than rows need, or more than `most_spread` in all are copied to triangles.
    pub(super) fn push(
        &mut self,
        array: &NamedArray<'_>,
        rows: ArrayRows<'_>,
        most_spread: u64,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let NamedArray { name, width, .. } = *array;
        if !(1..=MOST_WIDE).contains(&width) {
            skip_array(name, &format!("it has {width} numbers a row"), array.place, warnings);
            return Ok(());
        }
        let (n_rows, domain) = match rows {
            ArrayRows::Points(n) => (n, Domain::Vertex),
            ArrayRows::Cells(n, _) => (n, Domain::Face),
        };
        let n_values = n_rows.saturating_mul(width);
        let n_present = array.numbers.len();
        if n_present < n_values {
            let message = format!(
                "array {} has {} values, where {} rows of {width} need {}",
                show(name.as_bytes()),
                grouped(n_present as u64),
                grouped(n_rows as u64),
                grouped(n_values as u64)
            );
            return Err(ReadError::new("truncated", array.place.location(), message));
        }
        warnings.count_many("values-left-over", (n_present - n_values) as u64, || {
            let message = format!("values of arrays have no row, of {} first", show(name.as_bytes()));
            (array.place.location(), message)
        });
        self.count_rounded(array, n_values, warnings);
        if name == "vtkGhostType" {
            let message = "the array vtkGhostType marks copies or hidden cells; all were kept";
            warnings.count("ghosts-kept", || (array.place.location(), message.to_owned()));
        }
        let (semantic, divisor) = self.semantic(array, domain);
        let value = |i: usize| array.numbers.real(i) / divisor;
        let values = match rows {
            ArrayRows::Points(_) => {
                let mut values = with_room(n_values)?;
                array.numbers.each_block(n_values, |block| values.extend(block.iter().map(|x| x / divisor)));
                values
            }
            ArrayRows::Cells(_, cells) => {
                let n = cells.len().saturating_mul(width);
                self.n_spread = self.n_spread.saturating_add(n as u64);
                if self.n_spread > most_spread {
                    let message = format!(
                        "the values of cells come to {} or more on their triangles, over the limit of {} here",
                        grouped(self.n_spread),
                        grouped(most_spread)
                    );
                    return Err(ReadError::new("too-many-values", array.place.location(), message));
                }
                let mut values = with_room(n)?;
                values.extend(
                    cells
                        .iter()
                        .flat_map(|cell| (0..width).map(move |k| *cell as usize * width + k))
                        .map(value),
                );
                values
            }
        };
        self.list.push(Attribute { semantic, domain, width, values });
        Ok(())
    }

    /// Stores the array if it links vertices at one position. Returns whether it did.
    pub(super) fn take_position_id(
        &mut self,
        array: &NamedArray<'_>,
        positions: &[[f64; 3]],
        warnings: &mut Warnings,
    ) -> Result<bool, ReadError> {
        let n = positions.len();
        if array.name != POSITION_ID || array.width != 1 || array.numbers.len() != n {
            return Ok(false);
        }
        let mut ids = with_room(n)?;
        for row in 0..n {
            match array.numbers.integer(row) {
                Some(id) => ids.push(id),
                None => return Ok(false),
            }
        }
        self.position_id = checked_position_ids(&ids, positions, warnings)?;
        Ok(true)
    }

    /// The semantic of an array, and the divisor of its values.
    fn semantic(&mut self, array: &NamedArray<'_>, domain: Domain) -> (Semantic, f64) {
        let NamedArray { name, role, width, divisor, .. } = *array;
        let is =
            |expected: ArrayRole, by_name: bool| role == expected || role == ArrayRole::Unknown && by_name;
        let on_points = domain == Domain::Vertex;
        if on_points && width == 3 && is(ArrayRole::Normals, name == NORMALS) {
            return (Semantic::Normal, 1.0);
        }
        if on_points && width == 4 && is(ArrayRole::Unknown, false) && name == TANGENTS {
            return (Semantic::Tangent, 1.0);
        }
        if on_points && width == 2 && is(ArrayRole::TexCoords, is_of_set(name, TEXCOORDS)) {
            self.n_texcoords += 1;
            return (Semantic::TexCoord(self.n_texcoords - 1), 1.0);
        }
        let is_wide = matches!(width, 3 | 4);
        if is_wide && is(ArrayRole::Colors, is_of_set(name, COLOR) && !array.numbers.is_wide()) {
            self.n_colors += 1;
            return (Semantic::Color(self.n_colors - 1), divisor);
        }
        // Arrays marked as colours may have other numbers of channels, but meshes cannot have such colours.
        (Semantic::Custom(name.to_owned()), if role == ArrayRole::Colors { divisor } else { 1.0 })
    }

    /// Warns about integers that f64 does not hold.
    fn count_rounded(&self, array: &NamedArray<'_>, n_values: usize, warnings: &mut Warnings) {
        if !array.numbers.is_wide() {
            return;
        }
        let is_rounded =
            |i: &usize| array.numbers.integer(*i).is_none_or(|x| x.unsigned_abs() > EXACT as u64);
        let n = (0..n_values).filter(is_rounded).count();
        warnings.count_many("values-rounded", n as u64, || {
            let message = format!(
                "whole numbers beyond 2^53 were rounded to 53 bits, of {} first",
                show(array.name.as_bytes())
            );
            (array.place.location(), message)
        });
    }
}

/// Warns about an array that is not kept.
pub(super) fn skip_array(name: &str, why: &str, place: ArrayPlace<'_>, warnings: &mut Warnings) {
    warnings.count("arrays-skipped", || {
        let message = format!("arrays were skipped, {} first: {why}", show(name.as_bytes()));
        (place.location(), message)
    });
}
