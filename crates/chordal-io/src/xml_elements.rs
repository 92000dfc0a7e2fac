//! `XmlElements`: the elements of an XML part in order, with their namespaces, within limits.
use crate::text::show;
use crate::xml_text::{DTD_REFUSED, MOST_ATTRIBUTES, place, reference_error, wrong_encoding};
use crate::{FileLocation, Limits, ReadError};
use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::Event;
use quick_xml::events::attributes::Attributes;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The namespaces that a format distinguishes, by their addresses.
pub(crate) trait NamespaceKind: Copy + PartialEq {
    /// No namespace, as most attributes have.
    const NONE: Self;
    /// A namespace that the format does not know.
    const UNKNOWN: Self;
    /// The namespace with an address.
    fn from_address(address: &str) -> Self;
}

/// Namespaces for formats whose elements are recognised by local name only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AnyNamespace {
    /// No namespace.
    None,
    /// Any namespace.
    Other,
}

impl NamespaceKind for AnyNamespace {
    const NONE: Self = Self::None;
    const UNKNOWN: Self = Self::Other;
    fn from_address(address: &str) -> Self {
        if address.is_empty() { Self::None } else { Self::Other }
    }
}

/// The start of an element; [`XmlElements`] holds its attributes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct XmlElement<'a, N> {
    pub namespace: N,
    /// The name without its prefix.
    pub local: &'a str,
}

/// The next step in a part.
#[derive(Clone, Debug)]
pub(crate) enum XmlStep<'a, N> {
    Start(XmlElement<'a, N>),
    Text(Cow<'a, str>),
    End,
}

/// An attribute of the element that started last.
struct XmlValue<'a, N> {
    namespace: N,
    local: &'a str,
    value: Cow<'a, str>,
}

/// A cursor over the elements of a part.
pub(crate) struct XmlElements<'a, N> {
    text: &'a str,
    /// The name of the part, for messages; empty for a file without parts.
    part: &'a str,
    reader: Reader<&'a [u8]>,
    deepest: usize,
    /// The byte of the last step, its line, and the byte up to which lines were counted.
    at: usize,
    line: u32,
    counted: usize,
    values: Vec<XmlValue<'a, N>>,
    /// The prefixes that each open element binds.
    open: Vec<Vec<&'a str>>,
    /// The namespaces bound to each prefix, the innermost last.
    bound: BTreeMap<&'a str, Vec<N>>,
    /// Whether the last element was empty, so that its end comes next.
    ends: bool,
    has_root: bool,
}

impl<'a, N: NamespaceKind> XmlElements<'a, N> {
    pub(crate) fn new(text: &'a str, part: &'a str, limits: &Limits) -> Self {
        Self {
            text,
            part,
            reader: Reader::from_str(text),
            deepest: limits.depth,
            at: 0,
            line: 1,
            counted: 0,
            values: Vec::new(),
            open: Vec::new(),
            bound: BTreeMap::new(),
            ends: false,
            has_root: false,
        }
    }

    /// An error at the last step.
    pub(crate) fn error(&self, code: &'static str, message: impl std::fmt::Display) -> ReadError {
        let message = match self.part {
            "" => message.to_string(),
            part => format!("{part}: {message}"),
        };
        ReadError::new(code, self.place(), message)
    }

    /// The location of the last step.
    pub(crate) fn place(&self) -> FileLocation {
        place(self.text, self.at)
    }

    /// The byte of the last step.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// The line of the last step, counted from 1.
    pub(crate) fn line(&mut self) -> u32 {
        let newlines = memchr::memchr_iter(b'\n', &self.text.as_bytes()[self.counted..self.at]).count();
        self.line = self.line.saturating_add(newlines as u32);
        self.counted = self.at;
        self.line
    }

    /// An attribute without a namespace.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.get_in(N::NONE, name)
    }

    /// An attribute of a namespace.
    pub(crate) fn get_in(&self, namespace: N, name: &str) -> Option<&str> {
        let is_named = |v: &&XmlValue<N>| v.local == name && v.namespace == namespace;
        self.values.iter().find(is_named).map(|v| &*v.value)
    }

    /// A required attribute.
    pub(crate) fn need(&self, name: &str) -> Result<&str, ReadError> {
        self.get(name).ok_or_else(|| {
            self.error("missing-attribute", format_args!("the element has no attribute '{name}'"))
        })
    }

    /// The namespace that a prefix is bound to here.
    pub(crate) fn namespace_of(&self, prefix: &str) -> Option<N> {
        self.bound.get(prefix).and_then(|bindings| bindings.last()).copied()
    }

    /// The next step, or `None` at the end of the part.
    ///
    /// # Errors
    /// If the text is not well-formed XML, has a document type, or exceeds a limit.
    pub(crate) fn next(&mut self) -> Result<Option<XmlStep<'a, N>>, ReadError> {
        // An element without content is reported like any other: its end follows its start.
        if std::mem::take(&mut self.ends) {
            self.finish();
            return Ok(Some(XmlStep::End));
        }
        loop {
            self.at = self.reader.buffer_position() as usize;
            let event = match self.reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    self.at = self.reader.error_position() as usize;
                    return Err(self.error("not-xml", format_args!("this is no well-formed XML: {error}")));
                }
            };
            let end = self.reader.buffer_position() as usize;
            match event {
                // The tag ends before its `>`, or its `/>`.
                Event::Start(_) => return self.start(end - 1).map(|e| Some(XmlStep::Start(e))),
                Event::Empty(_) => {
                    self.ends = true;
                    return self.start(end - 2).map(|e| Some(XmlStep::Start(e)));
                }
                Event::End(_) => {
                    self.finish();
                    return Ok(Some(XmlStep::End));
                }
                Event::Text(text) => return self.text(text.into_inner()),
                Event::CData(text) => return self.text(text.into_inner()),
                Event::GeneralRef(name) => match unescape(&format!("&{};", &*name)) {
                    Ok(text) => return self.text(Cow::Owned(text.into_owned())),
                    Err(error) => return Err(self.error("unknown-entity", reference_error(&error))),
                },
                Event::DocType(_) => return Err(self.error("dtd-not-allowed", DTD_REFUSED)),
                Event::Decl(_) => {
                    if let Some(message) = wrong_encoding(&self.text[self.at..end], self.text) {
                        return Err(self.error("not-utf8", message));
                    }
                }
                Event::Comment(_) | Event::PI(_) => {}
                Event::Eof if self.open.is_empty() && self.has_root => return Ok(None),
                Event::Eof => {
                    let message = "the text ends before its elements are closed";
                    return Err(self.error("not-xml", message));
                }
            }
        }
    }

    fn text(&self, text: Cow<'a, str>) -> Result<Option<XmlStep<'a, N>>, ReadError> {
        let is_blank = || text.chars().all(|c| c.is_ascii_whitespace() || c == '\u{feff}');
        if self.open.is_empty() && !is_blank() {
            return Err(self.error("not-xml", "text outside the root element"));
        }
        Ok(Some(XmlStep::Text(text)))
    }

    fn finish(&mut self) {
        // The XML reader has already matched start and end tags.
        for prefix in self.open.pop().unwrap_or_default() {
            if let Some(bindings) = self.bound.get_mut(prefix) {
                bindings.pop();
            }
        }
    }

    /// Opens the element whose tag ends at a byte.
    fn start(&mut self, end: usize) -> Result<XmlElement<'a, N>, ReadError> {
        if self.open.is_empty() && std::mem::replace(&mut self.has_root, true) {
            return Err(self.error("not-xml", "a second root element"));
        }
        if self.open.len() >= self.deepest {
            let message = format!("nested deeper than the limit of {} levels", self.deepest);
            return Err(self.error("too-deep", message));
        }
        let body = &self.text[self.at + 1..end];
        let n_name = body.find(|c: char| c.is_ascii_whitespace()).unwrap_or(body.len());
        let binds = self.attributes(body, n_name)?;
        self.open.push(binds);
        let (prefix, local) = split(&body[..n_name]);
        match self.namespace_of(prefix) {
            Some(namespace) => Ok(XmlElement { namespace, local }),
            None if prefix.is_empty() => Ok(XmlElement { namespace: N::NONE, local }),
            None => {
                let message = format!("the prefix {} has no namespace", show(prefix.as_bytes()));
                Err(self.error("not-xml", message))
            }
        }
    }

    /// Stores the attributes, and binds prefixes. Returns the prefixes bound by this element.
    fn attributes(&mut self, body: &'a str, n_name: usize) -> Result<Vec<&'a str>, ReadError> {
        let mut binds = Vec::new();
        self.values.clear();
        let mut n_prefixed = 0;
        for (count, attribute) in Attributes::new(body, n_name).enumerate() {
            let attribute = attribute.map_err(|error| {
                self.error("not-xml", format_args!("an attribute is not well formed: {error}"))
            })?;
            if count >= MOST_ATTRIBUTES {
                let message = format!("more attributes than the limit of {MOST_ATTRIBUTES}");
                return Err(self.error("too-many-attributes", message));
            }
            let name: &'a str = attribute.key.0;
            // Raw values are slices of the text; an owned value, which cannot occur, would become empty.
            let raw: &'a str = match attribute.value {
                Cow::Borrowed(value) => value,
                Cow::Owned(_) => "",
            };
            let value = match unescape(raw) {
                Ok(value) => value,
                Err(error) => return Err(self.error("unknown-entity", reference_error(&error))),
            };
            if let Some(prefix) = name.strip_prefix("xmlns:").or((name == "xmlns").then_some("")) {
                // A stack for each prefix: an inner binding hides the outer one until its element
                // ends.
                self.bound.entry(prefix).or_default().push(N::from_address(&value));
                binds.push(prefix);
                continue;
            }
            let (prefix, local) = split(name);
            n_prefixed += usize::from(!prefix.is_empty());
            self.values.push(XmlValue { namespace: N::NONE, local, value });
        }
        // Only now, since a prefix may be bound after the attribute that uses it.
        if n_prefixed > 0 {
            self.resolve_prefixes(body, n_name);
        }
        Ok(binds)
    }

    /// Resolves the namespaces of attributes with a prefix; a later attribute may bind the prefix.
    fn resolve_prefixes(&mut self, body: &'a str, n_name: usize) {
        let names = Attributes::new(body, n_name).flatten().map(|attribute| attribute.key.0);
        let kept = names.filter(|name| *name != "xmlns" && !name.starts_with("xmlns:"));
        let namespaces: Vec<N> = kept
            .map(|name| match split(name).0 {
                "" => N::NONE,
                prefix => self.namespace_of(prefix).unwrap_or(N::UNKNOWN),
            })
            .collect();
        self.values.iter_mut().zip(namespaces).for_each(|(value, namespace)| value.namespace = namespace);
    }
}

/// The prefix of a name, which may be empty, and the local name.
fn split(name: &str) -> (&str, &str) {
    name.split_once(':').unwrap_or(("", name))
}
