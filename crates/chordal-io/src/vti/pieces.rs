//! Which array of image data is read, and its bytes in one, out of all pieces.
use super::blocks::ArrayDecoder;
use super::document::{VtiArray, VtiArrays, VtiDocument, VtiPiece};
use super::orientation::VtiExtent;
use crate::text::show;
use crate::volume::element::SampleType;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::{Message, Setting};

/// What samples belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleSite {
    Points,
    Cells,
}

/// The array that is read.
pub(super) struct ArrayChoice<'d> {
    pub site: SampleSite,
    pub array: &'d VtiArray,
    pub element: SampleType,
}

impl<'d> ArrayChoice<'d> {
    /// The array of one number a sample: the one that [`Limits::index`] names, else the scalars of the file,
    /// else the only one.
    ///
    /// # Errors
    /// When there is none, or several and none is chosen.
    pub(super) fn new(
        document: &'d VtiDocument<'_>,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, ReadError> {
        let first = document.pieces.first();
        let first =
            first.ok_or_else(|| document.error("bad-header", &document.image, "there is no piece"))?;
        let site = if first.points.arrays.is_empty() { SampleSite::Cells } else { SampleSite::Points };
        let arrays = arrays_of(first, site);
        if arrays.arrays.is_empty() {
            return Err(document.error("no-samples", &first.element, "the piece has no arrays"));
        }
        let singles: Vec<&VtiArray> = arrays.arrays.iter().filter(|array| n_components(array) == 1).collect();
        let active = arrays.element.get("Scalars").filter(|_| limits.index.is_none());
        let active = active.and_then(|name| arrays.arrays.iter().find(|array| name_of(array) == name));
        let array = match (active, limits.index) {
            (Some(array), _) => array,
            (None, Some(index)) => {
                let one = usize::try_from(index).ok().and_then(|index| singles.get(index).copied());
                one.ok_or_else(|| {
                    let message = format!(
                        "there is no array {index}, counted from 0: the arrays are {}",
                        listed(&singles)
                    );
                    document.error("no-such-volume", &arrays.element, message)
                })?
            }
            (None, None) => match singles.as_slice() {
                [] => &arrays.arrays[0],
                [one] => one,
                all => return Err(several(document, arrays, all)),
            },
        };
        if n_components(array) != 1 {
            let message = format!(
                "the array {} has several numbers a sample: colours or vectors are no volume",
                show(name_of(array).as_bytes())
            );
            return Err(document.error("several-channels", &array.element, message));
        }
        let others: Vec<&VtiArray> =
            arrays.arrays.iter().filter(|other| !std::ptr::eq(*other, array)).collect();
        warnings.count_many("arrays-ignored", others.len() as u64, || {
            let message = format!("other arrays of the file were not read: {}", listed(&others));
            (document.place(&others[0].element), message)
        });
        if site == SampleSite::Cells {
            warnings.count("cell-samples", || {
                let message = "samples belong to cells: each is taken to be at the centre of its cell";
                (document.place(&array.element), message)
            });
        }
        Ok(Self { site, array, element: element(document, array)? })
    }

    /// The bytes of its samples in the whole extent, the first axis running fastest.
    ///
    /// # Errors
    /// When a piece is damaged or lies outside the extent, or the pieces leave a gap.
    pub(super) fn bytes(
        &self,
        decoder: &ArrayDecoder<'_, '_>,
        whole: VtiExtent,
    ) -> Result<Vec<u8>, ReadError> {
        let document = decoder.document;
        let mut pieces = Vec::new();
        for piece in &document.pieces {
            let points = VtiExtent::read(document, &piece.element, "Extent")?;
            let extent = if self.site == SampleSite::Cells { points.cells() } else { points };
            let n = whole.holds(&extent).ok_or_else(|| {
                document.error("bad-extent", &piece.element, "the piece is not inside the whole extent")
            })?;
            let named = |array: &&VtiArray| name_of(array) == name_of(self.array);
            let array = arrays_of(piece, self.site).arrays.iter().find(named).ok_or_else(|| {
                let name = show(name_of(self.array).as_bytes());
                document.error("bad-header", &piece.element, format!("the piece has no array {name}"))
            })?;
            let format = |array: &VtiArray| array.element.get("format").map(str::to_owned);
            let is_same = format(array) == format(self.array) && n_components(array) == 1;
            if element(document, array)? != self.element || !is_same {
                let message = "the array has another type or format than in the first piece";
                return Err(document.error("bad-header", &array.element, message));
            }
            let bytes = decoder.decode(array, self.element, n)?;
            if extent == whole {
                return Ok(bytes);
            }
            crate::grow::push_large(&mut pieces, (extent, bytes))?;
        }
        self.assemble(document, whole, &pieces)
    }

    fn assemble(
        &self,
        document: &VtiDocument<'_>,
        whole: VtiExtent,
        pieces: &[(VtiExtent, Vec<u8>)],
    ) -> Result<Vec<u8>, ReadError> {
        let width = self.element.width();
        let gap = || document.error("bad-extent", &document.image, "the pieces do not fill the whole extent");
        let there: usize = pieces.iter().map(|(_, bytes)| bytes.len() / width).sum();
        // The size was counted before.
        let [n_x, n_y, n_z] = whole.size.map(|n| n as usize);
        let n_all = n_x * n_y * n_z;
        if there < n_all {
            return Err(gap());
        }
        let (mut all, mut is_there) = (Vec::new(), Vec::new());
        crate::grow::push_many(&mut all, 0, n_all * width)?;
        crate::grow::push_many(&mut is_there, false, n_all)?;
        for (extent, bytes) in pieces {
            let [x, y, z] = [0, 1, 2].map(|axis| (extent.low[axis] - whole.low[axis]) as usize);
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

impl VtiExtent {
    /// The number of points of another extent, if all are inside this one.
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

fn arrays_of(piece: &VtiPiece, site: SampleSite) -> &VtiArrays {
    match site {
        SampleSite::Points => &piece.points,
        SampleSite::Cells => &piece.cells,
    }
}

pub(super) fn name_of(array: &VtiArray) -> &str {
    array.element.get("Name").unwrap_or("")
}

/// The numbers of each sample; 0 where the file says nonsense.
fn n_components(array: &VtiArray) -> u64 {
    array.element.get("NumberOfComponents").map_or(1, |text| text.trim().parse().unwrap_or(0))
}

/// The names of arrays, as an error shows them.
fn listed(arrays: &[&VtiArray]) -> String {
    /// More names do not help.
    const MOST: usize = 12;
    let names: Vec<String> = arrays.iter().take(MOST).map(|array| show(name_of(array).as_bytes())).collect();
    let more = if arrays.len() > MOST { ", …" } else { "" };
    names.join(", ") + more
}

fn several(document: &VtiDocument<'_>, arrays: &VtiArrays, all: &[&VtiArray]) -> ReadError {
    let message = Message::from(format!("the file holds {} arrays, {}: ", all.len(), listed(all)))
        .setting(Setting::Index)
        .words(format_args!(" names one, from 0 to {}", all.len() - 1));
    let place: FileLocation = document.place(&arrays.element);
    ReadError::new("several-volumes", place, message)
}

fn element(document: &VtiDocument<'_>, array: &VtiArray) -> Result<SampleType, ReadError> {
    Ok(match document.need(&array.element, "type")? {
        "Int8" => SampleType::I8,
        "UInt8" => SampleType::U8,
        "Int16" => SampleType::I16,
        "UInt16" => SampleType::U16,
        "Int32" => SampleType::I32,
        "UInt32" => SampleType::U32,
        "Int64" => SampleType::I64,
        "UInt64" => SampleType::U64,
        "Float32" => SampleType::F32,
        "Float64" => SampleType::F64,
        other => {
            let message = format!(
                "samples of type {} are not read: Int8 to UInt64, Float32 and Float64 are",
                show(other.as_bytes())
            );
            return Err(document.error("unsupported-type", &array.element, message));
        }
    })
}
