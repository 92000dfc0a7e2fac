//! `XmlElements`: the elements of an XML part one after the other, with their namespaces, within limits.
use super::namespace::ModelNamespace;
use crate::text::show;
use crate::xml_text::{DTD_REFUSED, MOST_ATTRIBUTES, place, reference_error, wrong_encoding};
use crate::{FileLocation, Limits, ReadError};
use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::Event;
use quick_xml::events::attributes::Attributes;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// An element that starts; its attributes are asked of [`XmlElements`].
#[derive(Clone, Copy, Debug)]
pub(super) struct XmlElement<'a> {
    pub namespace: ModelNamespace,
    /// The name without its prefix.
    pub local: &'a str,
}

/// What comes next in a part.
#[derive(Clone, Debug)]
pub(super) enum XmlStep<'a> {
    Start(XmlElement<'a>),
    Text(Cow<'a, str>),
    End,
}

/// An attribute of the element that started last.
struct XmlValue<'a> {
    namespace: ModelNamespace,
    local: &'a str,
    value: Cow<'a, str>,
}

/// A walk over the elements of a part.
pub(super) struct XmlElements<'a> {
    text: &'a str,
    /// The name of the part, for messages.
    part: &'a str,
    reader: Reader<&'a [u8]>,
    deepest: usize,
    /// The byte of the step that came last, its line, and the byte up to which lines were counted.
    at: usize,
    line: u32,
    counted: usize,
    values: Vec<XmlValue<'a>>,
    /// The prefixes that each open element binds.
    open: Vec<Vec<&'a str>>,
    /// For each prefix what it is bound to, the innermost last.
    bound: BTreeMap<&'a str, Vec<ModelNamespace>>,
    /// Whether the element that came last was empty, so that its end comes next.
    ends: bool,
    has_root: bool,
}

impl<'a> XmlElements<'a> {
    pub(super) fn new(text: &'a str, part: &'a str, limits: &Limits) -> Self {
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

    /// An error at the step that came last.
    pub(super) fn error(&self, code: &'static str, message: impl std::fmt::Display) -> ReadError {
        ReadError::new(code, self.place(), format!("{}: {message}", self.part))
    }

    /// The location of the step that came last.
    pub(super) fn place(&self) -> FileLocation {
        place(self.text, self.at)
    }

    /// The line of the step that came last, counted from 1.
    pub(super) fn line(&mut self) -> u32 {
        let newlines = memchr::memchr_iter(b'\n', &self.text.as_bytes()[self.counted..self.at]).count();
        self.line = self.line.saturating_add(newlines as u32);
        self.counted = self.at;
        self.line
    }

    /// An attribute without a namespace.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.get_in(ModelNamespace::None, name)
    }

    /// An attribute of a namespace.
    pub(super) fn get_in(&self, namespace: ModelNamespace, name: &str) -> Option<&str> {
        let is_it = |v: &&XmlValue| v.local == name && v.namespace == namespace;
        self.values.iter().find(is_it).map(|v| &*v.value)
    }

    /// An attribute that has to be there.
    pub(super) fn need(&self, name: &str) -> Result<&str, ReadError> {
        self.get(name).ok_or_else(|| {
            self.error("missing-attribute", format_args!("the element has no attribute '{name}'"))
        })
    }

    /// What a prefix stands for here.
    pub(super) fn namespace_of(&self, prefix: &str) -> Option<ModelNamespace> {
        self.bound.get(prefix).and_then(|all| all.last()).copied()
    }

    /// The next step, or `None` at the end of the part.
    ///
    /// # Errors
    /// When the text is no well-formed XML, has a document type, or passes a limit.
    pub(super) fn next(&mut self) -> Result<Option<XmlStep<'a>>, ReadError> {
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

    fn text(&self, text: Cow<'a, str>) -> Result<Option<XmlStep<'a>>, ReadError> {
        let is_blank = || text.chars().all(|c| c.is_ascii_whitespace() || c == '\u{feff}');
        if self.open.is_empty() && !is_blank() {
            return Err(self.error("not-xml", "text outside the root element"));
        }
        Ok(Some(XmlStep::Text(text)))
    }

    fn finish(&mut self) {
        // The reader has matched start and end tags.
        for prefix in self.open.pop().unwrap_or_default() {
            if let Some(all) = self.bound.get_mut(prefix) {
                all.pop();
            }
        }
    }

    /// Opens the element whose tag ends at a byte.
    fn start(&mut self, end: usize) -> Result<XmlElement<'a>, ReadError> {
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
            None if prefix.is_empty() => Ok(XmlElement { namespace: ModelNamespace::None, local }),
            None => {
                let message = format!("the prefix {} has no namespace", show(prefix.as_bytes()));
                Err(self.error("not-xml", message))
            }
        }
    }

    /// Keeps the attributes, and binds prefixes. Returns those that are bound here.
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
            // Raw values are slices of the text; any other would become empty.
            let raw: &'a str = match attribute.value {
                Cow::Borrowed(value) => value,
                Cow::Owned(_) => "",
            };
            let value = match unescape(raw) {
                Ok(value) => value,
                Err(error) => return Err(self.error("unknown-entity", reference_error(&error))),
            };
            if let Some(prefix) = name.strip_prefix("xmlns:").or((name == "xmlns").then_some("")) {
                self.bound.entry(prefix).or_default().push(ModelNamespace::from_address(&value));
                binds.push(prefix);
                continue;
            }
            let (prefix, local) = split(name);
            n_prefixed += usize::from(!prefix.is_empty());
            self.values.push(XmlValue { namespace: ModelNamespace::None, local, value });
        }
        if n_prefixed > 0 {
            self.resolve_prefixes(body, n_name);
        }
        Ok(binds)
    }

    /// Sets the namespaces of attributes with a prefix: one may be bound by an attribute after it.
    fn resolve_prefixes(&mut self, body: &'a str, n_name: usize) {
        let names = Attributes::new(body, n_name).flatten().map(|attribute| attribute.key.0);
        let kept = names.filter(|name| *name != "xmlns" && !name.starts_with("xmlns:"));
        let found: Vec<ModelNamespace> = kept
            .map(|name| match split(name).0 {
                "" => ModelNamespace::None,
                prefix => self.namespace_of(prefix).unwrap_or(ModelNamespace::Unknown),
            })
            .collect();
        self.values.iter_mut().zip(found).for_each(|(value, namespace)| value.namespace = namespace);
    }
}

/// The prefix of a name, or nothing, and the rest.
pub(super) fn split(name: &str) -> (&str, &str) {
    name.split_once(':').unwrap_or(("", name))
}
