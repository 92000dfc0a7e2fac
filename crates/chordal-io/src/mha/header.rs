//! `MetaHeader`: the format of a MetaImage's samples, from its fields.
use super::fields::{MetaField, MetaFields};
use crate::volume::element::{Endian, SampleType};
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::budget::advice::{Message, Setting};

/// The fields that are used, and those that do not affect the positions and values of samples.
const KNOWN: [&str; 40] = [
    "ObjectType",
    "ObjectSubType",
    "Comment",
    "NDims",
    "Name",
    "ID",
    "ParentID",
    "AcquisitionDate",
    "Color",
    "BinaryData",
    "BinaryDataByteOrderMSB",
    "ElementByteOrderMSB",
    "CompressedData",
    "CompressedDataSize",
    "CompressionLevel",
    "TransformType",
    "TransformMatrix",
    "Rotation",
    "Orientation",
    "Offset",
    "Position",
    "Origin",
    "CenterOfRotation",
    "DistanceUnits",
    "AnatomicalOrientation",
    "ElementSpacing",
    "ElementSize",
    "ElementMin",
    "ElementMax",
    "ElementNumberOfChannels",
    "ElementNBits",
    "ElementToIntensityFunctionSlope",
    "ElementToIntensityFunctionOffset",
    "DimSize",
    "HeaderSize",
    "HeaderSizePerSlice",
    "SequenceID",
    "Modality",
    "ElementType",
    super::fields::LAST_KEY,
];

/// The encoding of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MetaEncoding {
    Raw,
    Text,
    /// Compressed by zlib or gzip.
    Packed,
}

/// The samples of a MetaImage.
pub(super) struct MetaHeader {
    /// The sizes of three spatial axes, and of an optional fourth axis.
    pub sizes: Vec<i64>,
    pub sizes_place: FileLocation,
    pub element: SampleType,
    pub endian: Endian,
    pub encoding: MetaEncoding,
    /// The number of compressed bytes, if the header states it.
    pub n_packed: Option<u64>,
    /// The bytes before the samples of a file; `None` if the samples end with the file.
    pub skip: Option<u64>,
}

impl MetaHeader {
    /// Reads the fields.
    ///
    /// # Errors
    /// At a field that is invalid, missing, or not supported.
    pub(super) fn read(fields: &MetaFields<'_>, warnings: &mut Warnings) -> Result<Self, ReadError> {
        if let Some(kind) = fields.get("ObjectType").filter(|kind| kind.value != b"Image") {
            let message = format!("an object of type {} is no volume: Image is", kind.shown());
            return Err(ReadError::new("unsupported", kind.place(), message));
        }
        let axes = fields.need("NDims")?;
        let sizes = fields.need("DimSize")?;
        let n_axes = axes.integer()?;
        let integers = sizes.integers()?;
        if integers.len() as i64 != n_axes {
            return Err(sizes.wrong(format!("{} sizes for {n_axes} axes", integers.len())));
        }
        if !(3..=4).contains(&n_axes) {
            let words = format!("{n_axes} axes are no volume: three are expected, or four with ");
            let message = Message::from(words).setting(Setting::Index).words(" for one of the fourth");
            return Err(ReadError::new("not-3d", axes.place(), message));
        }
        refuse_channels(fields)?;
        let element = element(&fields.need("ElementType")?)?;
        let encoding = encoding(fields)?;
        count_unused(fields, warnings)?;
        Ok(Self {
            sizes: integers,
            sizes_place: sizes.place(),
            element,
            endian: endian(fields, element, warnings)?,
            encoding,
            n_packed: n_packed(fields)?,
            skip: skip(fields, encoding)?,
        })
    }
}

/// Several numbers per sample are a picture or a vector field.
fn refuse_channels(fields: &MetaFields<'_>) -> Result<(), ReadError> {
    let Some(channels) = fields.get("ElementNumberOfChannels") else { return Ok(()) };
    match channels.integer()? {
        1 => Ok(()),
        n if n > 1 => {
            let message = format!(
                "ElementNumberOfChannels is {n}: an image with colours or vectors is no volume, which has one \
                 number a sample"
            );
            Err(ReadError::new("several-channels", channels.place(), message))
        }
        n => Err(channels.wrong(format!("{n} channels are none"))),
    }
}

fn encoding(fields: &MetaFields<'_>) -> Result<MetaEncoding, ReadError> {
    let says = |key: &str| fields.get(key).map(|field| field.truth()).transpose();
    let is_packed = says("CompressedData")?.unwrap_or(false);
    match (says("BinaryData")?.unwrap_or(true), is_packed) {
        (true, false) => Ok(MetaEncoding::Raw),
        (true, true) => Ok(MetaEncoding::Packed),
        (false, false) => Ok(MetaEncoding::Text),
        (false, true) => {
            let field = fields.need("CompressedData")?;
            Err(ReadError::new("unsupported", field.place(), "samples as text are not packed"))
        }
    }
}

/// The byte order, needed only for numbers of several bytes.
fn endian(
    fields: &MetaFields<'_>,
    element: SampleType,
    warnings: &mut Warnings,
) -> Result<Endian, ReadError> {
    let field = fields.one_of(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"])?;
    let Some(field) = field else {
        if element.width() > 1 {
            warnings.count("no-byte-order", || {
                let message = "the header does not say its byte order: the low byte was taken for the first";
                (FileLocation::Line(fields.last_line), message)
            });
        }
        return Ok(Endian::Little);
    };
    Ok(if field.truth()? { Endian::Big } else { Endian::Little })
}

fn n_packed(fields: &MetaFields<'_>) -> Result<Option<u64>, ReadError> {
    let Some(field) = fields.get("CompressedDataSize") else { return Ok(None) };
    match u64::try_from(field.integer()?) {
        // Programs that do not know the size write 0.
        Ok(0) => Ok(None),
        Ok(n) => Ok(Some(n)),
        Err(_) => Err(field.wrong(format!("{} packed bytes are none", field.shown()))),
    }
}

/// The bytes to skip in a data file.
fn skip(fields: &MetaFields<'_>, encoding: MetaEncoding) -> Result<Option<u64>, ReadError> {
    // With several files, each has this header.
    let Some(field) = fields.one_of(&["HeaderSize", "HeaderSizePerSlice"])? else { return Ok(Some(0)) };
    let n = field.integer()?;
    match n {
        -1 if encoding == MetaEncoding::Raw => Ok(None),
        -1 => {
            let message =
                "only plain samples are counted from the end of their file: HeaderSize is 0 or more";
            Err(field.wrong(message))
        }
        n => u64::try_from(n).map(Some).map_err(|_| field.wrong(format!("{} has no meaning", field.shown()))),
    }
}

/// Counts unused fields that would change samples in other programs.
fn count_unused(fields: &MetaFields<'_>, warnings: &mut Warnings) -> Result<(), ReadError> {
    for (key, plain) in [("ElementToIntensityFunctionSlope", 1.0), ("ElementToIntensityFunctionOffset", 0.0)]
    {
        let Some(field) = fields.get(key) else { continue };
        if field.numbers(1)? != [plain] {
            warnings.count("scaling-ignored", || {
                let message = format!("{key} was not applied, as by ITK: samples are as they are stored");
                (field.place(), message)
            });
        }
    }
    let others: Vec<&MetaField<'_>> = fields.others(&KNOWN).collect();
    warnings.count_many("fields-ignored", others.len() as u64, || {
        let message = format!("fields that do not concern samples were not kept, '{}' first", others[0].key);
        (others[0].place(), message)
    });
    Ok(())
}

/// The sample type for a name. Sizes are those of MetaIO, not those of a C compiler.
fn element(field: &MetaField<'_>) -> Result<SampleType, ReadError> {
    Ok(match field.value {
        b"MET_CHAR" | b"MET_ASCII_CHAR" => SampleType::I8,
        b"MET_UCHAR" => SampleType::U8,
        b"MET_SHORT" => SampleType::I16,
        b"MET_USHORT" => SampleType::U16,
        b"MET_INT" | b"MET_LONG" => SampleType::I32,
        b"MET_UINT" | b"MET_ULONG" => SampleType::U32,
        b"MET_LONG_LONG" => SampleType::I64,
        b"MET_ULONG_LONG" => SampleType::U64,
        b"MET_FLOAT" => SampleType::F32,
        b"MET_DOUBLE" => SampleType::F64,
        _ => {
            let message = format!(
                "samples of type {} are not read: whole numbers from MET_CHAR to MET_ULONG_LONG, MET_FLOAT \
                 and MET_DOUBLE are",
                field.shown()
            );
            return Err(ReadError::new("unsupported-type", field.place(), message));
        }
    })
}
