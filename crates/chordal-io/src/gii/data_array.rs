//! `GiftiArray`: one array of a GIFTI file, and its numbers.
use crate::files::FileOpener;
use crate::grow::{out_of_memory, with_room};
use crate::text::{IntegerError, grouped, integer, show};
use crate::volume::data_files::DataFiles;
use crate::volume::element::{Endian, SampleType};
use crate::volume::inflate::{InflateReader, check_ratio};
use crate::vtk::array_place::ArrayPlace;
use crate::vtk::encoded_bytes::{BytePacking, EncodedBytes};
use crate::vtk::number_array::NumberArray;
use crate::xml_elements::{AnyNamespace, XmlElements};
use crate::xml_text::place;
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;

/// The encoding of an array's numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
enum GiftiEncoding {
    Ascii,
    Base64,
    /// Base64 of a zlib stream, although the encoding is called gzip.
    PackedBase64,
    /// In a separate file, from a byte offset on.
    External(String, u64),
}

/// An array as declared by its element.
#[derive(Debug)]
pub(super) struct GiftiArray<'a> {
    pub kind: SampleType,
    /// The number of rows, and of numbers in each.
    pub size: [u64; 2],
    /// Whether numbers are stored by columns instead of by rows.
    pub is_by_columns: bool,
    endian: Endian,
    encoding: GiftiEncoding,
    /// The content of its `Data`.
    pub data: Cow<'a, str>,
    /// The byte of the text at which the element starts.
    pub at: usize,
}

/// The context in which an array is decoded.
pub(super) struct GiftiFile<'f, 'o, 't> {
    pub text: &'t str,
    pub open: Option<&'f mut FileOpener<'o>>,
    pub limits: &'f Limits,
}

impl<'a> GiftiArray<'a> {
    /// The array of the element that started last.
    ///
    /// # Errors
    /// At the element, if an attribute is missing or invalid.
    pub(super) fn new(elements: &XmlElements<'a, AnyNamespace>) -> Result<Self, ReadError> {
        let unknown = |name: &str, value: &str| {
            elements
                .error("unknown-value", format!("{name} is {}, which is not known", show(value.as_bytes())))
        };
        let kind = elements.need("DataType")?;
        let kind = number_type(kind).ok_or_else(|| unknown("DataType", kind))?;
        let is_by_columns = match elements.get("ArrayIndexingOrder").unwrap_or("RowMajorOrder") {
            "RowMajorOrder" => false,
            "ColumnMajorOrder" => true,
            other => return Err(unknown("ArrayIndexingOrder", other)),
        };
        let endian = match elements.get("Endian").unwrap_or("LittleEndian") {
            "LittleEndian" => Endian::Little,
            "BigEndian" => Endian::Big,
            other => return Err(unknown("Endian", other)),
        };
        let encoding = match elements.need("Encoding")? {
            "ASCII" => GiftiEncoding::Ascii,
            "Base64Binary" => GiftiEncoding::Base64,
            "GZipBase64Binary" => GiftiEncoding::PackedBase64,
            "ExternalFileBinary" => {
                let offset = elements.get("ExternalFileOffset").unwrap_or("").trim();
                let offset = if offset.is_empty() { 0 } else { count(elements, "ExternalFileOffset")? };
                GiftiEncoding::External(elements.need("ExternalFileName")?.to_owned(), offset)
            }
            other => return Err(unknown("Encoding", other)),
        };
        let size = match count(elements, "Dimensionality")? {
            1 => [count(elements, "Dim0")?, 1],
            2 => [count(elements, "Dim0")?, count(elements, "Dim1")?],
            n => {
                return Err(
                    elements.error("wrong-width", format!("an array has {n} axes; one or two are read"))
                );
            }
        };
        Ok(Self {
            kind,
            size,
            is_by_columns,
            endian,
            encoding,
            data: Cow::Borrowed(""),
            at: elements.offset(),
        })
    }

    pub(super) fn place(&self, text: &str) -> FileLocation {
        place(text, self.at)
    }

    /// Its numbers, as many as it declares.
    ///
    /// # Errors
    /// If their count differs, or they are damaged, or over the limits.
    pub(super) fn numbers(&self, file: &mut GiftiFile<'_, '_, '_>) -> Result<NumberArray<'_>, ReadError> {
        let here = || self.place(file.text);
        let [rows, width] = self.size;
        let too_large = || {
            let message = format!("{} rows of {} numbers are over the limits", grouped(rows), grouped(width));
            ReadError::new("too-many-rows", here(), message)
        };
        let n = rows.checked_mul(width).filter(|_| rows <= file.limits.rows).ok_or_else(too_large)?;
        let n_bytes = n.checked_mul(self.kind.width() as u64).filter(|n| *n <= file.limits.bytes);
        let n_bytes = n_bytes.ok_or_else(too_large)?;
        let encoded = || {
            let at = ArrayPlace::Text(file.text, self.at);
            EncodedBytes::new(self.data.as_bytes(), BytePacking::Base64, at)
        };
        let bytes = match &self.encoding {
            GiftiEncoding::Ascii => {
                let numbers = NumberArray::from_text(&self.data, self.kind)
                    .map_err(|bad| ReadError::new(bad.code, here(), bad.message))?;
                return if numbers.len() as u64 == n {
                    Ok(numbers)
                } else {
                    Err(self.other_count(numbers.len() as u64, n, here()))
                };
            }
            GiftiEncoding::Base64 => encoded().rest()?,
            GiftiEncoding::PackedBase64 => {
                let packed = encoded().rest()?;
                // Before unpacking: the array says how many bytes it has.
                check_ratio(Some(n_bytes), packed.len() as u64, &here())?;
                self.unpacked(&packed, n_bytes, here())?
            }
            GiftiEncoding::External(name, offset) => {
                // What the file itself takes counts towards the limit of bytes.
                let used = file.text.len() as u64;
                let mut files = DataFiles::new(file.open.as_deref_mut(), used, file.limits.bytes);
                let mut bytes = files.fetch(name, &place(file.text, self.at))?;
                let end = offset.checked_add(n_bytes).filter(|end| *end <= bytes.len() as u64);
                let place = place(file.text, self.at);
                let end = end.ok_or_else(|| {
                    let n_bytes = grouped(bytes.len() as u64);
                    let message = format!("the file beside has {n_bytes} bytes, fewer than the array needs");
                    ReadError::new("truncated", place, message)
                })?;
                bytes.truncate(end as usize);
                bytes.drain(..*offset as usize);
                bytes
            }
        };
        if bytes.len() as u64 != n_bytes {
            let n_numbers = bytes.len() as u64 / self.kind.width() as u64;
            return Err(self.other_count(n_numbers, n, place(file.text, self.at)));
        }
        Ok(NumberArray::Packed { kind: self.kind, endian: self.endian, bytes: Cow::Owned(bytes) })
    }

    fn other_count(&self, there: u64, declared: u64, place: FileLocation) -> ReadError {
        let code = if there < declared { "truncated" } else { "trailing-bytes" };
        let message = format!("the array declares {} numbers, and has {}", grouped(declared), grouped(there));
        ReadError::new(code, place, message)
    }

    /// The unpacked stream: at most the declared bytes and one more, which shows that there are too many.
    fn unpacked(&self, packed: &[u8], n_bytes: u64, here: FileLocation) -> Result<Vec<u8>, ReadError> {
        const STEP: usize = 1 << 16;
        let mut stream = InflateReader::either(packed, 0);
        let most = n_bytes as usize + 1;
        let mut bytes: Vec<u8> = with_room(most.min(STEP))?;
        // Memory grows with the bytes that come, not with the number that the file declares.
        while bytes.len() < most {
            let (from, step) = (bytes.len(), STEP.min(most - bytes.len()));
            bytes.try_reserve(step).map_err(|_| out_of_memory(from))?;
            bytes.resize(from + step, 0);
            // Offsets in the stream do not exist in the file, which holds it as text.
            let n = stream
                .fill(&mut bytes[from..])
                .map_err(|error| ReadError { place: here.clone(), ..error })?;
            bytes.truncate(from + n);
            if n < step {
                break;
            }
        }
        Ok(bytes)
    }
}

/// The type for a name in the standard.
fn number_type(name: &str) -> Option<SampleType> {
    Some(match name.strip_prefix("NIFTI_TYPE_")? {
        "INT8" => SampleType::I8,
        "UINT8" => SampleType::U8,
        "INT16" => SampleType::I16,
        "UINT16" => SampleType::U16,
        "INT32" => SampleType::I32,
        "UINT32" => SampleType::U32,
        "INT64" => SampleType::I64,
        "UINT64" => SampleType::U64,
        "FLOAT32" => SampleType::F32,
        "FLOAT64" => SampleType::F64,
        _ => return None,
    })
}

/// A count in an attribute of the element that started last.
fn count(elements: &XmlElements<'_, AnyNamespace>, name: &str) -> Result<u64, ReadError> {
    let word = elements.need(name)?.trim();
    match integer(word.as_bytes()) {
        Ok(value) if value >= 0 => Ok(value as u64),
        Ok(_) | Err(IntegerError::TooLarge) => {
            let message = format!("{name} {} is no possible count", show(word.as_bytes()));
            Err(elements.error("count-out-of-range", message))
        }
        Err(IntegerError::Spelling) => {
            let message = format!("{name} {} is not a whole number", show(word.as_bytes()));
            Err(elements.error("not-a-number", message))
        }
    }
}
