//! `VtkDocument`: the pieces of a VTK XML file and their arrays, before they are unpacked.
use super::data_array::{AppendedBytes, ArrayEncoding, ArraySource, BlockCompressor, DataArray, number_type};
use super::encoded_bytes::BytePacking;
use crate::grow::{push, push_large};
use crate::text::{IntegerError, integer, show, trim};
use crate::volume::element::{Endian, SampleType};
use crate::xml_elements::{AnyNamespace, XmlElements, XmlStep};
use crate::xml_text::place;
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;

/// The kind of data set in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataSetKind {
    PolyData,
    UnstructuredGrid,
    ImageData,
}

impl DataSetKind {
    /// The name of its element, which is also the type of the file.
    fn element(self) -> &'static str {
        match self {
            Self::PolyData => "PolyData",
            Self::UnstructuredGrid => "UnstructuredGrid",
            Self::ImageData => "ImageData",
        }
    }
}

/// The role that a section assigns to an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ActiveArray {
    PointNormals,
    PointTexCoords,
    PointScalars,
    CellScalars,
}

/// The element of image data: its attributes as text.
#[derive(Clone, Debug, Default)]
pub(super) struct ImageElement {
    pub extent: Option<String>,
    pub origin: Option<String>,
    pub spacing: Option<String>,
    pub direction: Option<String>,
    /// The offset in the document at which it starts.
    pub at: usize,
}

/// The elements that an array of a piece belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PieceSection {
    PointData,
    CellData,
    Points,
    Verts,
    Lines,
    Strips,
    Polys,
    Cells,
}

/// The sections by element name.
const SECTIONS: [(&str, PieceSection); 8] = [
    ("PointData", PieceSection::PointData),
    ("CellData", PieceSection::CellData),
    ("Points", PieceSection::Points),
    ("Verts", PieceSection::Verts),
    ("Lines", PieceSection::Lines),
    ("Strips", PieceSection::Strips),
    ("Polys", PieceSection::Polys),
    ("Cells", PieceSection::Cells),
];

/// The attributes of sections that assign roles to arrays.
const ACTIVE: [(PieceSection, &str, ActiveArray); 4] = [
    (PieceSection::PointData, "Normals", ActiveArray::PointNormals),
    (PieceSection::PointData, "TCoords", ActiveArray::PointTexCoords),
    (PieceSection::PointData, "Scalars", ActiveArray::PointScalars),
    (PieceSection::CellData, "Scalars", ActiveArray::CellScalars),
];

/// A piece: counts and arrays.
#[derive(Clone, Debug, Default)]
pub(super) struct VtkPiece<'a> {
    pub n_points: u64,
    pub n_verts: u64,
    pub n_lines: u64,
    pub n_strips: u64,
    pub n_polys: u64,
    pub n_cells: u64,
    /// The extent of the lattice, as text.
    pub extent: Option<Box<str>>,
    pub arrays: Vec<(PieceSection, DataArray<'a>)>,
    /// The names of the arrays with a role.
    active: Vec<(ActiveArray, String)>,
    /// The offset in the document at which it starts.
    pub at: usize,
}

impl<'a> VtkPiece<'a> {
    /// The name of the array with a role.
    pub(super) fn active(&self, of: ActiveArray) -> Option<&str> {
        self.active.iter().find(|(known, _)| *known == of).map(|(_, name)| name.as_str())
    }

    /// The first array of a section, or the one with a name.
    pub(super) fn array(&self, section: PieceSection, name: Option<&str>) -> Option<&DataArray<'a>> {
        let is_named = |array: &DataArray| name.is_none_or(|name| array.name == name);
        self.arrays.iter().find(|(of, array)| *of == section && is_named(array)).map(|(_, array)| array)
    }
}

/// A document.
#[derive(Clone, Debug)]
pub(super) struct VtkDocument<'a> {
    pub kind: DataSetKind,
    /// The text, up to the appended bytes.
    pub text: &'a str,
    pub encoding: ArrayEncoding,
    pub appended: Option<AppendedBytes<'a>>,
    /// The element of image data, empty for other data sets.
    pub image: ImageElement,
    pub pieces: Vec<VtkPiece<'a>>,
    /// The field data of the data set.
    pub fields: Vec<DataArray<'a>>,
    /// The number of arrays of later time steps.
    pub n_other_times: u64,
}

/// The most arrays of a piece. Chosen: simulations write tens, and each is compared with all previous ones.
const MOST_ARRAYS: usize = 4096;

/// Where the text ends and the appended bytes begin.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<usize>), ReadError> {
    let Some(tag) = memchr::memmem::find(bytes, b"<AppendedData") else { return Ok((bytes, None)) };
    let rest = &bytes[tag..];
    let end = memchr::memchr(b'>', rest).map(|end| tag + end + 1);
    let end = end.filter(|end| bytes[end - 2] != b'/');
    let Some(end) = end else {
        let message = "the element AppendedData is cut off or empty";
        return Err(ReadError::new("truncated", FileLocation::Byte(tag as u64), message));
    };
    let mark = bytes[end..].iter().position(|b| !crate::text::is_space(*b)).map(|at| end + at);
    match mark.filter(|mark| bytes[*mark] == b'_') {
        Some(mark) => Ok((&bytes[..end], Some(mark + 1))),
        None => {
            let message = "the appended data does not begin with '_'";
            Err(ReadError::new("bad-appended-data", FileLocation::Byte(end as u64), message))
        }
    }
}

impl<'a> VtkDocument<'a> {
    /// Reads the elements of a file with one of these data sets.
    ///
    /// # Errors
    /// If it is not XML, or another data set; if an attribute is missing or unknown; if a limit is exceeded.
    pub(super) fn read(
        bytes: &'a [u8],
        kinds: &'static [DataSetKind],
        limits: &Limits,
    ) -> Result<Self, ReadError> {
        let (head, appended_at) = split(bytes)?;
        let text = crate::xml_text::text_of(head)?;
        let mut reader = DocumentReader {
            elements: XmlElements::new(text, "", limits),
            kinds,
            open: Vec::new(),
            array: None,
            document: Self {
                kind: kinds[0],
                text,
                encoding: ArrayEncoding { endian: Endian::Little, header: SampleType::U32, compressor: None },
                appended: None,
                image: ImageElement::default(),
                pieces: Vec::new(),
                fields: Vec::new(),
                n_other_times: 0,
            },
        };
        reader.read(appended_at.map(|start| AppendedBytes {
            bytes: &bytes[start..],
            start: start as u64,
            packing: BytePacking::Raw,
        }))?;
        Ok(reader.document)
    }

    /// An error at the element that starts at an offset.
    pub(super) fn error(&self, at: usize, code: &'static str, message: impl Into<String>) -> ReadError {
        ReadError::new(code, place(self.text, at), message.into())
    }
}

/// The meaning of an open element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum VtkElement {
    File,
    DataSet,
    Fields,
    Piece,
    Section(PieceSection),
    /// An array that is kept.
    Array,
    Skipped,
}

/// Reads a document.
struct DocumentReader<'a> {
    elements: XmlElements<'a, AnyNamespace>,
    kinds: &'static [DataSetKind],
    open: Vec<VtkElement>,
    array: Option<DataArray<'a>>,
    document: VtkDocument<'a>,
}

impl<'a> DocumentReader<'a> {
    fn read(&mut self, appended: Option<AppendedBytes<'a>>) -> Result<(), ReadError> {
        while let Some(step) = self.elements.next()? {
            match step {
                XmlStep::Start(element) => {
                    if self.open == [VtkElement::File] && element.local == "AppendedData" {
                        // The bytes after this are not text.
                        return self.append(appended);
                    }
                    let meaning = self.start(element.local)?;
                    self.open.push(meaning);
                }
                XmlStep::Text(text) if self.open.last() == Some(&VtkElement::Array) => self.text(text)?,
                XmlStep::Text(_) => {}
                XmlStep::End => {
                    if self.open.pop() == Some(VtkElement::Array)
                        && let Some(array) = self.array.take()
                    {
                        self.keep(array)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn append(&mut self, appended: Option<AppendedBytes<'a>>) -> Result<(), ReadError> {
        let packing = match self.elements.get("encoding") {
            Some("raw") => BytePacking::Raw,
            Some("base64") => BytePacking::Base64,
            other => return Err(self.unknown("encoding", other.unwrap_or(""), "raw and base64")),
        };
        self.document.appended = appended.map(|appended| AppendedBytes { packing, ..appended });
        Ok(())
    }

    fn unknown(&self, name: &str, value: &str, supported: &str) -> ReadError {
        let message = format!("{name} = {} is none of {supported}", show(value.as_bytes()));
        self.elements.error("unknown-value", message)
    }

    fn start(&mut self, name: &str) -> Result<VtkElement, ReadError> {
        let Some(parent) = self.open.last() else { return self.file(name) };
        Ok(match (parent, name) {
            (VtkElement::File, name) if name == self.document.kind.element() => {
                self.document.image = self.image();
                VtkElement::DataSet
            }
            (VtkElement::DataSet, "FieldData") => VtkElement::Fields,
            (VtkElement::DataSet, "Piece") => {
                self.piece()?;
                VtkElement::Piece
            }
            (VtkElement::Piece, name) => match SECTIONS.iter().find(|(element, _)| *element == name) {
                Some((_, section)) => {
                    self.begin_section(*section);
                    VtkElement::Section(*section)
                }
                None => VtkElement::Skipped,
            },
            (VtkElement::Section(_) | VtkElement::Fields, "DataArray" | "Array") => {
                self.array = Some(self.data_array(name)?);
                VtkElement::Array
            }
            _ => VtkElement::Skipped,
        })
    }

    fn file(&mut self, name: &str) -> Result<VtkElement, ReadError> {
        if name != "VTKFile" {
            let message = format!("the root is {}, not the 'VTKFile' of VTK", show(name.as_bytes()));
            return Err(self.elements.error("not-vtk", message));
        }
        let data_set = self.elements.need("type")?;
        let kind = self.kinds.iter().find(|kind| kind.element() == data_set);
        self.document.kind = *kind.ok_or_else(|| {
            let supported: Vec<&str> = self.kinds.iter().map(|kind| kind.element()).collect();
            let supported = supported.join(" or ");
            let message = format!("the data set is {}, not {supported}", show(data_set.as_bytes()));
            self.elements.error("unsupported-data-set", message)
        })?;
        let encoding = &mut self.document.encoding;
        match self.elements.get("byte_order").unwrap_or("LittleEndian") {
            "LittleEndian" => {}
            "BigEndian" => encoding.endian = Endian::Big,
            other => return Err(self.unknown("byte_order", other, "LittleEndian and BigEndian")),
        }
        // Older files do not name it.
        match self.elements.get("header_type").unwrap_or("UInt32") {
            "UInt32" => {}
            "UInt64" => encoding.header = SampleType::U64,
            other => return Err(self.unknown("header_type", other, "UInt32 and UInt64")),
        }
        match self.elements.get("compressor").unwrap_or("") {
            "" => {}
            "vtkZLibDataCompressor" => encoding.compressor = Some(BlockCompressor::Zlib),
            "vtkLZ4DataCompressor" => encoding.compressor = Some(BlockCompressor::Lz4),
            other => {
                let supported = "vtkZLibDataCompressor and vtkLZ4DataCompressor";
                return Err(self.unknown("compressor", other, supported));
            }
        }
        Ok(VtkElement::File)
    }

    /// A count in an attribute, or 0.
    fn count(&self, name: &str) -> Result<u64, ReadError> {
        let Some(text) = self.elements.get(name) else { return Ok(0) };
        let token = trim(text.as_bytes());
        match integer(token) {
            Ok(value) if value >= 0 => Ok(value as u64),
            Ok(_) | Err(IntegerError::TooLarge) => {
                let message = format!("{name} = {} is no possible count", show(token));
                Err(self.elements.error("count-out-of-range", message))
            }
            Err(IntegerError::Spelling) => {
                let message = format!("{name} = {} is not a whole number", show(token));
                Err(self.elements.error("not-a-number", message))
            }
        }
    }

    fn image(&self) -> ImageElement {
        let spelled = |name| self.elements.get(name).map(str::to_owned);
        ImageElement {
            extent: spelled("WholeExtent"),
            origin: spelled("Origin"),
            spacing: spelled("Spacing"),
            direction: spelled("Direction"),
            at: self.elements.offset(),
        }
    }

    fn piece(&mut self) -> Result<(), ReadError> {
        let piece = VtkPiece {
            n_points: self.count("NumberOfPoints")?,
            n_verts: self.count("NumberOfVerts")?,
            n_lines: self.count("NumberOfLines")?,
            n_strips: self.count("NumberOfStrips")?,
            n_polys: self.count("NumberOfPolys")?,
            n_cells: self.count("NumberOfCells")?,
            extent: self.elements.get("Extent").map(Box::from),
            at: self.elements.offset(),
            ..VtkPiece::default()
        };
        push_large(&mut self.document.pieces, piece)
    }

    fn begin_section(&mut self, section: PieceSection) {
        let Some(piece) = self.document.pieces.last_mut() else { return };
        for (of, attribute, active) in ACTIVE {
            if of == section
                && let Some(name) = self.elements.get(attribute)
            {
                piece.active.push((active, name.to_owned()));
            }
        }
    }

    fn data_array(&self, element: &str) -> Result<DataArray<'a>, ReadError> {
        let name = self.elements.get("Name").unwrap_or("").to_owned();
        let type_name = self.elements.need("type")?;
        let kind = if element == "Array" { None } else { number_type(type_name) };
        if kind.is_none() && !matches!(type_name, "String" | "Bit" | "Variant") {
            return Err(self.unknown("type", type_name, "the types of VTK, as in Float32"));
        }
        let n_components = match self.elements.get("NumberOfComponents") {
            // Some writers of old files leave 0 for one component.
            Some(_) => usize::try_from(self.count("NumberOfComponents")?).unwrap_or(usize::MAX).max(1),
            None => 1,
        };
        let at = self.elements.offset();
        let source = match self.elements.get("format").unwrap_or("ascii") {
            "ascii" => ArraySource::Text(Cow::Borrowed(""), at),
            "binary" => ArraySource::Base64(Cow::Borrowed(""), at),
            "appended" => {
                self.elements.need("offset")?;
                ArraySource::Appended(self.count("offset")?)
            }
            other => return Err(self.unknown("format", other, "ascii, binary and appended")),
        };
        Ok(DataArray { name, kind, n_components, source, at })
    }

    /// Text directly in an array. It is contiguous except for comments and the like.
    fn text(&mut self, more: Cow<'a, str>) -> Result<(), ReadError> {
        let is_blank = more.bytes().all(crate::text::is_space);
        let Some(array) = &mut self.array else { return Ok(()) };
        if let ArraySource::Text(text, at) | ArraySource::Base64(text, at) = &mut array.source
            && !is_blank
        {
            if text.is_empty() {
                (*text, *at) = (more, self.elements.offset());
            } else {
                text.to_mut().push_str(&more);
            }
        }
        Ok(())
    }

    fn keep(&mut self, array: DataArray<'a>) -> Result<(), ReadError> {
        match (self.open.last(), self.document.pieces.last_mut()) {
            (Some(VtkElement::Section(section)), Some(piece)) => {
                if piece.arrays.len() >= MOST_ARRAYS {
                    let message = format!("more arrays of a piece than the limit of {MOST_ARRAYS}");
                    return Err(self.elements.error("too-many-arrays", message));
                }
                let is_known =
                    piece.arrays.iter().any(|(of, known)| of == section && known.name == array.name);
                // Arrays of later time steps have the same name as the first.
                if is_known && !array.name.is_empty() {
                    self.document.n_other_times += 1;
                    return Ok(());
                }
                push_large(&mut piece.arrays, (*section, array))
            }
            (Some(VtkElement::Fields), _) => push(&mut self.document.fields, array),
            _ => Ok(()),
        }
    }
}
