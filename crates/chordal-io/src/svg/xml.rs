//! `XmlTree`: the elements of an SVG file in document order. An element takes 24 bytes, and each stored
//! attribute 12.
use super::names::{ElementTag, Key};
use crate::grow::push;
use crate::text::{grouped, show};
use crate::xml_text::{DTD_REFUSED, MOST_ATTRIBUTES, place, reference_error, wrong_encoding};
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;
use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::Event;
use quick_xml::events::attributes::Attributes;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The deepest nesting, whatever the limits allow. Chosen: later, each level takes some of the call stack.
const DEEPEST: usize = 256;
/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";

/// An element.
#[derive(Clone, Copy, Debug)]
struct XmlNode {
    tag: ElementTag,
    n_attributes: u16,
    /// Its first attribute.
    attributes: u32,
    /// The byte of its `<`.
    at: u32,
    /// The node after its last descendant.
    end: u32,
}

#[derive(Clone, Copy, Debug)]
struct XmlAttribute {
    key: Key,
    at: u32,
    len: u32,
}

/// The elements of a file.
#[derive(Debug)]
pub(super) struct XmlTree<'a> {
    text: &'a str,
    nodes: Vec<XmlNode>,
    attributes: Vec<XmlAttribute>,
    /// Style sheets with their nodes.
    pub sheets: Vec<(u32, String)>,
    /// The byte of a document type, which is ignored.
    pub doctype: Option<u32>,
    /// The byte of a reference to an external style sheet.
    pub style_sheet: Option<u32>,
    /// Whether the root is in SVG's namespace.
    pub has_namespace: bool,
    /// The certificate in `metadata`, as text.
    pub certificate: Option<String>,
}

impl<'a> XmlTree<'a> {
    /// Parses a file.
    ///
    /// # Errors
    /// If the text is not XML, has a document type with declarations, or exceeds the limits on size or depth.
    pub fn read(text: &'a str, limits: &Limits) -> Result<Self, ReadError> {
        if u32::try_from(text.len()).is_err() {
            let message = format!("{} bytes are over the limit of 4,294,967,295", grouped(text.len() as u64));
            return Err(ReadError::new("too-large", FileLocation::File, message));
        }
        XmlParser::new(text, limits).parse()
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The number of bytes of the file.
    pub fn bytes(&self) -> u64 {
        self.text.len() as u64
    }

    pub fn tag(&self, node: usize) -> ElementTag {
        self.nodes[node].tag
    }

    /// The node after the last descendant.
    pub fn end(&self, node: usize) -> usize {
        self.nodes[node].end as usize
    }

    /// The children, in order.
    pub fn children(&self, node: usize) -> impl Iterator<Item = usize> + use<'_, 'a> {
        let end = self.end(node);
        let first = node + 1;
        std::iter::successors((first < end).then_some(first), move |child| {
            let next = self.end(*child);
            (next < end).then_some(next)
        })
    }

    /// The location of the element.
    pub fn place(&self, node: usize) -> FileLocation {
        place(self.text, self.nodes[node].at as usize)
    }

    /// The name in the file.
    pub fn name(&self, node: usize) -> &'a str {
        let rest = &self.text[self.nodes[node].at as usize + 1..];
        rest.split(|c: char| c.is_ascii_whitespace() || c == '>' || c == '/').next().unwrap_or("")
    }

    /// The value of an attribute, with its escapes resolved, and the byte where it starts.
    pub fn get(&self, node: usize, key: Key) -> Option<(Cow<'a, str>, usize)> {
        let XmlNode { attributes, n_attributes, .. } = self.nodes[node];
        let range = &self.attributes[attributes as usize..attributes as usize + usize::from(n_attributes)];
        let attribute = range.iter().find(|a| a.key == key)?;
        Some((self.value(*attribute), attribute.at as usize))
    }

    /// All stored attributes.
    pub fn attributes(&self, node: usize) -> impl Iterator<Item = (Key, Cow<'a, str>, usize)> + '_ {
        let XmlNode { attributes, n_attributes, .. } = self.nodes[node];
        let range = &self.attributes[attributes as usize..attributes as usize + usize::from(n_attributes)];
        range.iter().map(|a| (a.key, self.value(*a), a.at as usize))
    }

    fn value(&self, attribute: XmlAttribute) -> Cow<'a, str> {
        let raw = &self.text[attribute.at as usize..(attribute.at + attribute.len) as usize];
        // The parser checked that the escapes can be resolved.
        if raw.contains('&') { unescape(raw).unwrap_or(Cow::Borrowed(raw)) } else { Cow::Borrowed(raw) }
    }

    /// The location of a byte in an attribute's value; of the start of the value if it has escapes.
    #[expect(clippy::ptr_arg, reason = "a borrowed value has no escapes")]
    pub fn place_in(&self, value: &Cow<'_, str>, start: usize, at: usize) -> FileLocation {
        let offset = if matches!(value, Cow::Borrowed(_)) { at } else { 0 };
        place(self.text, start + offset)
    }

    /// The location of a byte of the file.
    pub fn place_of(&self, at: usize) -> FileLocation {
        place(self.text, at)
    }
}

/// Builds a tree.
struct XmlParser<'a> {
    reader: Reader<&'a [u8]>,
    deepest: usize,
    rows: u64,
    tree: XmlTree<'a>,
    /// The open elements.
    open: Vec<u32>,
    /// For each prefix its namespace bindings, the innermost last: whether each is SVG's.
    bound: BTreeMap<&'a str, Vec<bool>>,
    /// The prefixes that each open element binds.
    binds: Vec<Vec<&'a str>>,
}

impl<'a> XmlParser<'a> {
    fn new(text: &'a str, limits: &Limits) -> Self {
        let tree = XmlTree {
            text,
            nodes: Vec::new(),
            attributes: Vec::new(),
            sheets: Vec::new(),
            doctype: None,
            style_sheet: None,
            has_namespace: false,
            certificate: None,
        };
        Self {
            reader: Reader::from_str(text),
            deepest: limits.depth.min(DEEPEST),
            rows: limits.rows,
            tree,
            open: Vec::new(),
            bound: BTreeMap::new(),
            binds: Vec::new(),
        }
    }

    fn error(&self, at: usize, code: &'static str, message: impl Into<Message>) -> ReadError {
        ReadError::new(code, place(self.tree.text, at), message)
    }

    fn parse(mut self) -> Result<XmlTree<'a>, ReadError> {
        loop {
            let at = self.reader.buffer_position() as usize;
            let event = match self.reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    let at = self.reader.error_position() as usize;
                    return Err(self.error(at, "not-xml", format!("this is no well-formed XML: {error}")));
                }
            };
            let end = self.reader.buffer_position() as usize;
            match event {
                Event::Start(_) => self.start(at, end - 1)?,
                Event::Empty(_) => {
                    self.start(at, end - 2)?;
                    self.finish();
                }
                Event::End(_) => self.finish(),
                Event::Text(text) => self.text(at, &text)?,
                Event::CData(text) => self.text(at, &text)?,
                Event::GeneralRef(name) => self.reference(at, &name)?,
                Event::DocType(declared) => self.doctype(at, &declared)?,
                Event::Decl(_) => self.declaration(at, end)?,
                Event::PI(text) if text.starts_with("xml-stylesheet") => {
                    self.tree.style_sheet.get_or_insert(at as u32);
                }
                Event::Comment(_) | Event::PI(_) => {}
                Event::Eof => break,
            }
        }
        self.done()
    }

    fn done(self) -> Result<XmlTree<'a>, ReadError> {
        if let Some(node) = self.open.last() {
            let name = show(self.tree.name(*node as usize).as_bytes());
            let at = self.tree.nodes[*node as usize].at as usize;
            return Err(self.error(
                at,
                "not-xml",
                format!("the element {name} is not closed when the file ends"),
            ));
        }
        let is_svg = self.tree.nodes.first().is_some_and(|node| node.tag == ElementTag::Svg);
        if is_svg {
            return Ok(self.tree);
        }
        let message = match self.tree.nodes.is_empty() {
            true => "the file has no element".to_owned(),
            false => format!("the root is {}, not 'svg'", show(self.tree.name(0).as_bytes())),
        };
        Err(ReadError::new("not-svg", FileLocation::File, message))
    }

    fn declaration(&self, at: usize, end: usize) -> Result<(), ReadError> {
        match wrong_encoding(&self.tree.text[at..end], self.tree.text) {
            Some(message) => Err(self.error(at, "not-utf8", message)),
            None => Ok(()),
        }
    }

    fn doctype(&mut self, at: usize, declared: &str) -> Result<(), ReadError> {
        if declared.contains('[') || declared.contains("<!") {
            return Err(self.error(at, "dtd-not-allowed", DTD_REFUSED));
        }
        self.tree.doctype = Some(at as u32);
        Ok(())
    }

    fn reference(&mut self, at: usize, name: &str) -> Result<(), ReadError> {
        let resolved = match unescape(&format!("&{name};")) {
            Ok(text) => text.into_owned(),
            Err(error) => return Err(self.error(at, "unknown-entity", reference_error(&error))),
        };
        self.text(at, &resolved)
    }

    /// Handles text, which matters in style sheets and in the certificate; none is allowed outside the root.
    fn text(&mut self, at: usize, text: &str) -> Result<(), ReadError> {
        let Some(node) = self.open.last() else {
            if text.trim_matches(|c: char| c.is_ascii_whitespace() || c == '\u{feff}').is_empty() {
                return Ok(());
            }
            return Err(self.error(at, "not-xml", "text outside the root element"));
        };
        match self.tree.nodes[*node as usize].tag {
            ElementTag::Style => match self.tree.sheets.last_mut() {
                Some((of, sheet)) if *of == *node => sheet.push_str(text),
                _ => push(&mut self.tree.sheets, (*node, text.to_owned()))?,
            },
            ElementTag::Foreign if self.tree.name(*node as usize) == super::CERTIFICATE => {
                self.tree.certificate.get_or_insert_default().push_str(text);
            }
            _ => {}
        }
        Ok(())
    }

    fn start(&mut self, at: usize, end: usize) -> Result<(), ReadError> {
        if self.open.is_empty() && !self.tree.nodes.is_empty() {
            return Err(self.error(at, "not-xml", "a second root element"));
        }
        if self.open.len() >= self.deepest {
            let message = format!("nested deeper than the limit of {} levels", self.deepest);
            return Err(self.error(at, "too-deep", message));
        }
        if self.tree.nodes.len() as u64 >= self.rows {
            let message = format!("more elements than the limit of {}", grouped(self.rows));
            return Err(self.error(at, "too-many-rows", message));
        }
        let text = self.tree.text;
        let body = &text[at + 1..end];
        let name_len = body.find(|c: char| c.is_ascii_whitespace()).unwrap_or(body.len());
        let name = &body[..name_len];
        let first = self.tree.attributes.len();
        let binds = self.attributes(body, name_len, at + 1)?;
        let (prefix, local) = name.split_once(':').unwrap_or(("", name));
        let is_root = self.tree.nodes.is_empty();
        let is_svg = match self.bound.get(prefix).and_then(|bindings| bindings.last()) {
            Some(is_svg) => *is_svg,
            // In a file without any namespace, all names are SVG's.
            None => prefix.is_empty() && !self.tree.has_namespace,
        };
        if is_root {
            self.tree.has_namespace =
                self.bound.get(prefix).is_some_and(|bindings| bindings.last() == Some(&true));
        }
        let tag = if is_svg { ElementTag::from_name(local) } else { ElementTag::Foreign };
        let node = XmlNode {
            tag,
            n_attributes: (self.tree.attributes.len() - first) as u16,
            attributes: first as u32,
            at: at as u32,
            end: 0,
        };
        let index = self.tree.nodes.len() as u32;
        push(&mut self.tree.nodes, node)?;
        self.open.push(index);
        self.binds.push(binds);
        Ok(())
    }

    fn finish(&mut self) {
        // The XML reader has already matched start and end tags.
        let Some(node) = self.open.pop() else { return };
        self.tree.nodes[node as usize].end = self.tree.nodes.len() as u32;
        for prefix in self.binds.pop().unwrap_or_default() {
            if let Some(all) = self.bound.get_mut(prefix) {
                all.pop();
            }
        }
    }

    /// Stores the known attributes. Returns the prefixes bound by this element.
    fn attributes(&mut self, body: &'a str, name_len: usize, at: usize) -> Result<Vec<&'a str>, ReadError> {
        let mut binds = Vec::new();
        let base = body.as_ptr() as usize;
        for (count, attribute) in Attributes::new(body, name_len).enumerate() {
            let attribute = match attribute {
                Ok(attribute) => attribute,
                Err(error) => {
                    return Err(self.error(
                        at,
                        "not-xml",
                        format!("an attribute is not well formed: {error}"),
                    ));
                }
            };
            if count >= MOST_ATTRIBUTES {
                let message = format!("more attributes than the limit of {MOST_ATTRIBUTES}");
                return Err(self.error(at, "too-many-attributes", message));
            }
            let name: &'a str = attribute.key.0;
            // Raw values are slices of the text; an owned value, which cannot occur, would become empty.
            let value: &'a str = match attribute.value {
                Cow::Borrowed(value) => value,
                Cow::Owned(_) => "",
            };
            let value_at = at + (value.as_ptr() as usize).saturating_sub(base);
            if value.contains('&')
                && let Err(error) = unescape(value)
            {
                return Err(self.error(value_at, "unknown-entity", reference_error(&error)));
            }
            if let Some(prefix) = name.strip_prefix("xmlns:").or((name == "xmlns").then_some("")) {
                self.bound.entry(prefix).or_default().push(value == SVG);
                binds.push(prefix);
            } else if let Some(key) = Key::from_name(local_of(name)) {
                let len = value.len() as u32;
                push(&mut self.tree.attributes, XmlAttribute { key, at: value_at as u32, len })?;
            }
        }
        Ok(binds)
    }
}

/// The local name of an attribute; a prefix other than that of links makes it foreign.
fn local_of(name: &str) -> &str {
    match name.split_once(':') {
        // Any prefix is accepted: no other namespace in use has an attribute of this name.
        Some((_, "href")) => "xlink:href",
        Some(_) => "",
        None => name,
    }
}
