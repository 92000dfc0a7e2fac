//! `VtiDocument`: the elements of a `.vti` file, without the samples that they hold.
use crate::text::show;
use crate::xml_text::{DTD_REFUSED, MOST_ATTRIBUTES, place, text_of, wrong_encoding};
use crate::{FileLocation, Limits, ReadError};
use memchr::memmem;
use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::Event;
use quick_xml::events::attributes::Attributes;
use std::borrow::Cow;
use std::ops::Range;

/// Whether bytes look like a file of VTK in XML.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    /// A declaration and a comment may stand in front.
    const LOOKED_AT: usize = 4096;
    bytes.starts_with(b"<") && memmem::find(&bytes[..bytes.len().min(LOOKED_AT)], b"<VTKFile").is_some()
}

/// The attributes of an element, and where it is.
#[derive(Clone, Debug, Default)]
pub(super) struct VtiElement {
    attributes: Vec<(String, String)>,
    at: usize,
}

impl VtiElement {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

/// An array of samples: its element, and its text.
#[derive(Clone, Debug)]
pub(super) struct VtiArray {
    pub element: VtiElement,
    /// The bytes of the file between its tags.
    pub text: Range<usize>,
}

/// The arrays at points, or in cells.
#[derive(Clone, Debug, Default)]
pub(super) struct VtiArrays {
    pub element: VtiElement,
    pub arrays: Vec<VtiArray>,
}

/// A box of the lattice with its arrays.
#[derive(Clone, Debug, Default)]
pub(super) struct VtiPiece {
    pub element: VtiElement,
    pub points: VtiArrays,
    pub cells: VtiArrays,
}

/// The appended data.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appended {
    /// The byte after the underscore.
    pub start: usize,
    pub is_base64: bool,
}

/// The elements of a file.
#[derive(Default)]
pub(super) struct VtiDocument<'a> {
    /// The part of the file that is text.
    text: &'a str,
    /// The bytes before the text: a byte order mark.
    shift: usize,
    pub file: VtiElement,
    pub image: VtiElement,
    pub pieces: Vec<VtiPiece>,
    pub appended: Option<Appended>,
}

impl<'a> VtiDocument<'a> {
    /// Reads all elements up to the appended data.
    ///
    /// # Errors
    /// When it is no well-formed XML, or no image data.
    pub(super) fn read(bytes: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        // Raw data behind this tag is no text.
        let cut = memmem::find(bytes, b"<AppendedData");
        let text = text_of(&bytes[..cut.unwrap_or(bytes.len())])?;
        let mut document = Self { text, shift: cut.unwrap_or(bytes.len()) - text.len(), ..Self::default() };
        document.elements(limits, cut.is_some())?;
        if let Some(at) = cut {
            document.appended = Some(appended(bytes, at)?);
        }
        Ok(document)
    }

    /// An error at an element.
    pub(super) fn error(
        &self,
        code: &'static str,
        element: &VtiElement,
        message: impl Into<String>,
    ) -> ReadError {
        ReadError::new(code, self.place(element), message.into())
    }

    /// The location of an element.
    pub(super) fn place(&self, element: &VtiElement) -> FileLocation {
        place(self.text, element.at)
    }

    /// The numbers of an attribute that has to be there, as they are spelled.
    pub(super) fn need<'e>(&self, element: &'e VtiElement, name: &str) -> Result<&'e str, ReadError> {
        element.get(name).ok_or_else(|| {
            self.error("missing-attribute", element, format!("the element has no attribute '{name}'"))
        })
    }

    fn not_xml(&self, at: usize, message: impl std::fmt::Display) -> ReadError {
        ReadError::new("not-xml", place(self.text, at), format!("this is no well-formed XML: {message}"))
    }

    fn elements(&mut self, limits: &Limits, is_cut: bool) -> Result<(), ReadError> {
        let text = self.text;
        let mut reader = Reader::from_str(text);
        let mut open: Vec<&str> = Vec::new();
        loop {
            let at = reader.buffer_position() as usize;
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(error) => return Err(self.not_xml(reader.error_position() as usize, error)),
            };
            let end = reader.buffer_position() as usize;
            match event {
                Event::Start(_) | Event::Empty(_) => {
                    let is_empty = matches!(event, Event::Empty(_));
                    // Without the brackets, and the slash of an empty element.
                    let body = &text[at + 1..end - if is_empty { 2 } else { 1 }];
                    if open.len() >= limits.depth {
                        let message = format!("nested deeper than the limit of {} levels", limits.depth);
                        return Err(ReadError::new("too-deep", place(text, at), message));
                    }
                    let n_name = body.find(|c: char| c.is_ascii_whitespace()).unwrap_or(body.len());
                    open.push(&body[..n_name]);
                    let element = VtiElement { attributes: self.attributes(body, n_name, at)?, at };
                    self.start(&open, element, end)?;
                    if is_empty {
                        open.pop();
                    }
                }
                Event::End(_) => {
                    self.end(&open, at);
                    open.pop();
                }
                Event::DocType(_) => {
                    return Err(ReadError::new("dtd-not-allowed", place(text, at), DTD_REFUSED));
                }
                Event::Decl(_) => {
                    if let Some(message) = wrong_encoding(&text[at..end], text) {
                        return Err(ReadError::new("not-utf8", place(text, at), message));
                    }
                }
                Event::Eof if open.is_empty() || is_cut => return Ok(()),
                Event::Eof => return Err(self.not_xml(at, "the text ends before its elements are closed")),
                _ => {}
            }
        }
    }

    fn attributes(&self, body: &str, n_name: usize, at: usize) -> Result<Vec<(String, String)>, ReadError> {
        let mut all = Vec::new();
        for attribute in Attributes::new(body, n_name) {
            let attribute = attribute.map_err(|error| self.not_xml(at, error))?;
            if all.len() >= MOST_ATTRIBUTES {
                let message = format!("more attributes than the limit of {MOST_ATTRIBUTES}");
                return Err(ReadError::new("too-many-attributes", place(self.text, at), message));
            }
            let raw: &str = match &attribute.value {
                Cow::Borrowed(value) => value,
                Cow::Owned(value) => value,
            };
            let value = unescape(raw).map_err(|error| self.not_xml(at, error))?;
            all.push((attribute.key.0.to_owned(), value.into_owned()));
        }
        Ok(all)
    }

    /// An element that starts below the others of `open`; its content begins at `end`.
    fn start(&mut self, open: &[&str], element: VtiElement, end: usize) -> Result<(), ReadError> {
        match open {
            ["VTKFile"] => {
                if let Some(other) = element.get("type").filter(|kind| *kind != "ImageData") {
                    let message =
                        format!("VTK data of type {} is not read: ImageData is", show(other.as_bytes()));
                    return Err(self.error("unsupported", &element, message));
                }
                self.file = element;
            }
            [other] => {
                let message = format!("the root element is {}, not VTKFile", show(other.as_bytes()));
                return Err(self.error("not-vti", &element, message));
            }
            ["VTKFile", "ImageData"] => self.image = element,
            ["VTKFile", "ImageData", "Piece"] => {
                crate::grow::push_large(&mut self.pieces, VtiPiece { element, ..VtiPiece::default() })?;
            }
            ["VTKFile", "ImageData", "Piece", kind @ ("PointData" | "CellData"), below @ ..] => {
                let Some(piece) = self.pieces.last_mut() else { return Ok(()) };
                let arrays = if *kind == "PointData" { &mut piece.points } else { &mut piece.cells };
                match below {
                    [] => arrays.element = element,
                    ["DataArray" | "Array"] => {
                        let start = end + self.shift;
                        let array = VtiArray { element, text: start..start };
                        crate::grow::push_large(&mut arrays.arrays, array)?;
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The last element of `open` ends: its end tag starts at `at`.
    fn end(&mut self, open: &[&str], at: usize) {
        if let ["VTKFile", "ImageData", "Piece", kind, "DataArray" | "Array"] = open
            && let Some(piece) = self.pieces.last_mut()
        {
            let arrays = if *kind == "PointData" { &mut piece.points } else { &mut piece.cells };
            // Elements inside, as of information keys, are no samples: the text ends before them.
            if let Some(array) = arrays.arrays.last_mut() {
                let text = &self.text[array.text.start - self.shift..at];
                array.text.end = array.text.start + text.find('<').unwrap_or(text.len());
            }
        }
    }
}

/// The appended data, whose tag begins at byte `at`.
fn appended(bytes: &[u8], at: usize) -> Result<Appended, ReadError> {
    let wrong = |message: &str| {
        ReadError::new("bad-appended-data", FileLocation::Byte(at as u64), message.to_owned())
    };
    let tag = memchr::memchr(b'>', &bytes[at..]).map(|end| &bytes[at..at + end]);
    let tag = tag.and_then(|tag| std::str::from_utf8(tag).ok()).ok_or_else(|| wrong("the tag has no end"))?;
    let name = "<AppendedData";
    let mut encoding = None;
    for attribute in Attributes::new(&tag[1..], name.len() - 1).flatten() {
        if attribute.key.0 == "encoding" {
            encoding = Some(attribute.value.into_owned());
        }
    }
    let is_base64 = match encoding.as_deref() {
        Some("base64") => true,
        Some("raw") => false,
        _ => return Err(wrong("appended data is raw or base64, and its tag says neither")),
    };
    let after = at + tag.len() + 1;
    let spaces = bytes[after..].iter().take_while(|b| crate::text::is_space(**b)).count();
    if bytes.get(after + spaces) != Some(&b'_') {
        return Err(wrong("no underscore is in front of the appended data"));
    }
    Ok(Appended { start: after + spaces + 1, is_base64 })
}
