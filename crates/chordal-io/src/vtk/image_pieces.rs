//! Chooses the array of image data to read, and joins its bytes from all pieces.
use super::data_array::{ArrayDecoder, ArraySource, DataArray};
use super::image_extent::ImageExtent;
use super::xml_document::{ActiveArray, PieceSection, VtkDocument, VtkPiece};
use crate::text::show;
use crate::volume::element::SampleType;
use crate::volume::text_bytes::{check_count, text_bytes};
use crate::warnings::Warnings;
use crate::xml_text::place;
use crate::{Limits, ReadError};
use chordal::budget::advice::{Message, Setting};
use std::borrow::Cow;
use std::mem::discriminant;

/// The chosen array.
pub(super) struct ArrayChoice<'d, 'a> {
    /// Whether its values are at points or at cells.
    pub section: PieceSection,
    pub array: &'d DataArray<'a>,
    pub kind: SampleType,
}

impl<'d, 'a> ArrayChoice<'d, 'a> {
    /// Chooses the array with one number per sample: the one that [`Limits::index`] selects, else the scalars
    /// of the file, else the only one.
    ///
    /// # Errors
    /// If there is none, or there are several and none is selected.
    pub(super) fn new(
        document: &'d VtkDocument<'a>,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, ReadError> {
        let Some(first) = document.pieces.first() else {
            return Err(document.error(document.image.at, "bad-header", "there is no piece"));
        };
        let of_points = arrays_of(first, PieceSection::PointData);
        let (section, scalars, arrays) = if of_points.is_empty() {
            (PieceSection::CellData, ActiveArray::CellScalars, arrays_of(first, PieceSection::CellData))
        } else {
            (PieceSection::PointData, ActiveArray::PointScalars, of_points)
        };
        let active = first.active(scalars).filter(|_| limits.index.is_none());
        let active = active.and_then(|name| arrays.iter().copied().find(|array| array.name == name));
        let array = match active {
            Some(array) => array,
            None => Self::without_scalars(document, first, &arrays, limits)?,
        };
        let kind = sample_type(document, array)?;
        let others: Vec<&DataArray> =
            arrays.iter().copied().filter(|other| !std::ptr::eq(*other, array)).collect();
        warnings.count_many("arrays-ignored", others.len() as u64, || {
            let message = format!("other arrays of the file were not read: {}", listed(&others));
            (place(document.text, others[0].at), message)
        });
        let message = "arrays of a name that the piece has already were skipped: the first is read";
        warnings.count_all("arrays-repeated", document.n_other_times, message);
        if section == PieceSection::CellData {
            warnings.count("cell-samples", || {
                let message = "samples belong to cells: each is taken to be at the centre of its cell";
                (place(document.text, array.at), message)
            });
        }
        Ok(Self { section, array, kind })
    }

    /// The array if the file declares no scalars.
    fn without_scalars(
        document: &VtkDocument<'_>,
        first: &VtkPiece<'_>,
        arrays: &[&'d DataArray<'a>],
        limits: &Limits,
    ) -> Result<&'d DataArray<'a>, ReadError> {
        let is_single = |array: &&DataArray| array.kind.is_some() && array.n_components == 1;
        let singles: Vec<&DataArray> = arrays.iter().copied().filter(is_single).collect();
        let Some(index) = limits.index else {
            return match (arrays, singles.as_slice()) {
                ([], _) => Err(document.error(first.at, "no-samples", "the piece has no arrays")),
                (_, [one]) => Ok(one),
                // The caller's check of its type says why it is not read.
                ([first, ..], []) => Ok(first),
                (_, all) => {
                    let message =
                        Message::from(format!("the file holds {} arrays, {}: ", all.len(), listed(all)))
                            .setting(Setting::Index)
                            .words(format_args!(" names one, from 0 to {}", all.len() - 1));
                    Err(ReadError::new("several-volumes", place(document.text, first.at), message))
                }
            };
        };
        let one = usize::try_from(index).ok().and_then(|index| singles.get(index).copied());
        one.ok_or_else(|| {
            let names = listed(&singles);
            let message = format!("there is no array {index}, counted from 0: the arrays are {names}");
            document.error(first.at, "no-such-volume", message)
        })
    }

    /// The bytes of its samples in the whole extent; the first axis varies fastest.
    ///
    /// # Errors
    /// If a piece is damaged or outside the extent, or the pieces leave a gap.
    pub(super) fn bytes(
        &self,
        document: &'d VtkDocument<'a>,
        decoder: &mut ArrayDecoder<'a>,
        full: ImageExtent,
    ) -> Result<Cow<'d, [u8]>, ReadError> {
        let mut pieces = Vec::new();
        for piece in &document.pieces {
            let points = ImageExtent::read(document, piece.at, "Extent", piece.extent.as_deref())?;
            let extent = if self.section == PieceSection::CellData { points.cells() } else { points };
            let n = full.holds(&extent).ok_or_else(|| {
                document.error(piece.at, "bad-extent", "the piece is not inside the whole extent")
            })?;
            let array = piece.array(self.section, Some(&self.array.name)).ok_or_else(|| {
                let name = show(self.array.name.as_bytes());
                document.error(piece.at, "bad-header", format!("the piece has no array {name}"))
            })?;
            let is_same = discriminant(&array.source) == discriminant(&self.array.source);
            if sample_type(document, array)? != self.kind || !is_same {
                let message = "the array has another type or format than in the first piece";
                return Err(document.error(array.at, "bad-header", message));
            }
            let bytes = self.decode(decoder, array, n)?;
            if extent == full {
                return Ok(bytes);
            }
            crate::grow::push_large(&mut pieces, (extent, bytes))?;
        }
        self.assemble(document, full, &pieces).map(Cow::Owned)
    }

    /// The bytes of an array of `n` samples; those from text are little-endian.
    fn decode(
        &self,
        decoder: &mut ArrayDecoder<'a>,
        array: &'d DataArray<'a>,
        n: u64,
    ) -> Result<Cow<'d, [u8]>, ReadError> {
        let width = self.kind.width() as u64;
        let ArraySource::Text(text, at) = &array.source else {
            return decoder.exact_bytes(array, n.saturating_mul(width));
        };
        // Not through f64, which does not hold every integer, and would round to single precision twice.
        let bytes = text_bytes(text.as_bytes(), self.kind, |byte| place(decoder.text, at + byte))?;
        check_count(bytes.len() as u64 / width, n, || place(decoder.text, at + text.len()))?;
        Ok(Cow::Owned(bytes))
    }

    fn assemble(
        &self,
        document: &VtkDocument<'_>,
        full: ImageExtent,
        pieces: &[(ImageExtent, Cow<'_, [u8]>)],
    ) -> Result<Vec<u8>, ReadError> {
        let width = self.kind.width();
        let gap =
            || document.error(document.image.at, "bad-extent", "the pieces do not fill the whole extent");
        // Before memory is taken. Enough samples may still leave gaps, since pieces may overlap.
        let n_present: usize = pieces.iter().map(|(_, bytes)| bytes.len() / width).sum();
        // The size was checked before.
        let [n_x, n_y, n_z] = full.size.map(|n| n as usize);
        let n_all = n_x * n_y * n_z;
        if n_present < n_all {
            return Err(gap());
        }
        let (mut all, mut is_there) = (Vec::new(), Vec::new());
        crate::grow::push_many(&mut all, 0, n_all * width)?;
        crate::grow::push_many(&mut is_there, false, n_all)?;
        for (extent, bytes) in pieces {
            let [x, y, z] = [0, 1, 2].map(|axis| (extent.low[axis] - full.low[axis]) as usize);
            let [rows_x, rows_y, rows_z] = extent.size.map(|n| n as usize);
            for k in 0..rows_z {
                for j in 0..rows_y {
                    let from = (k * rows_y + j) * rows_x;
                    let to = ((z + k) * n_y + y + j) * n_x + x;
                    all[to * width..(to + rows_x) * width]
                        .copy_from_slice(&bytes[from * width..(from + rows_x) * width]);
                    is_there[to..to + rows_x].fill(true);
                }
            }
        }
        if is_there.contains(&false) { Err(gap()) } else { Ok(all) }
    }
}

impl ImageExtent {
    /// The number of points of another extent, if it is inside this one.
    fn holds(&self, other: &Self) -> Option<u64> {
        let mut n = 1_u64;
        for axis in 0..3 {
            let start = other.low[axis].checked_sub(self.low[axis]).filter(|start| *start >= 0)?;
            start.checked_add(other.size[axis]).filter(|end| *end <= self.size[axis])?;
            n = n.checked_mul(u64::try_from(other.size[axis]).ok().filter(|n| *n > 0)?)?;
        }
        Some(n)
    }
}

/// The arrays of a section.
fn arrays_of<'p, 'a>(piece: &'p VtkPiece<'a>, section: PieceSection) -> Vec<&'p DataArray<'a>> {
    piece.arrays.iter().filter(|(of, _)| *of == section).map(|(_, array)| array).collect()
}

/// The names of arrays, for messages.
fn listed(arrays: &[&DataArray<'_>]) -> String {
    /// Chosen: more names do not help.
    const MOST: usize = 12;
    let names: Vec<String> = arrays.iter().take(MOST).map(|array| show(array.name.as_bytes())).collect();
    let more = if arrays.len() > MOST { ", …" } else { "" };
    names.join(", ") + more
}

/// The type of an array with one number per sample.
fn sample_type(document: &VtkDocument<'_>, array: &DataArray<'_>) -> Result<SampleType, ReadError> {
    let name = || show(array.name.as_bytes());
    let Some(kind) = array.kind else {
        let message =
            format!("the array {} is of texts or bits: Int8 to UInt64, Float32 and Float64 are read", name());
        return Err(document.error(array.at, "unsupported-type", message));
    };
    if array.n_components != 1 {
        let message =
            format!("the array {} has several numbers a sample: colours or vectors are no volume", name());
        return Err(document.error(array.at, "several-channels", message));
    }
    Ok(kind)
}
