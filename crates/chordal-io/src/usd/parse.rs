//! `UsdaParser`: reads USD's text form into a layer.
//!
//! Source: Pixar Animation Studios, *USDA File Format* and *USD Glossary*, openusd.org, 2024; Alliance for
//! OpenUSD, *Core Specification* 1.0, 2025.
use super::layer::{
    NO_PRIM, UsdLayer, UsdLayerAbout, UsdPrim, UsdProperty, UsdPropertyMore, UsdReference, UsdSpecifier,
    UsdVariant, UsdVariantSet, is_kept, push_prim, sorted_by_name, too_deep,
};
use super::scanner::UsdaScanner;
use super::value::UsdType;
use crate::grow::push;
use crate::text::LineIndex;
use crate::{Limits, ReadError};
use std::borrow::Cow;

/// The first bytes of the text form.
pub(super) const USDA_MAGIC: &[u8] = b"#usda ";

/// Reads a text.
///
/// # Errors
/// At the line where the text is not USD, is truncated, or nested too deeply.
pub(super) fn parse<'a>(
    bytes: Cow<'a, [u8]>,
    path: &str,
    limits: &Limits,
) -> Result<UsdLayer<'a>, ReadError> {
    let text = crate::text::text_of(&bytes)?;
    let mut parser = UsdaParser {
        scanner: UsdaScanner { bytes: text, at: 0 },
        prims: vec![UsdPrim::new("", UsdSpecifier::Def)],
        about: UsdLayerAbout::default(),
        depth: limits.depth,
    };
    parser.layer()?;
    let UsdaParser { prims, about, .. } = parser;
    let by_name = sorted_by_name(&prims)?;
    Ok(UsdLayer {
        path: path.to_owned(),
        bytes,
        lines: LineIndex::default(),
        prims,
        by_name,
        about,
        tables: None,
    })
}

struct UsdaParser<'a> {
    scanner: UsdaScanner<'a>,
    prims: Vec<UsdPrim>,
    about: UsdLayerAbout,
    depth: usize,
}

/// The keywords before an edited list.
const LIST_EDITS: [&str; 5] = ["prepend", "append", "add", "delete", "reorder"];

impl UsdaParser<'_> {
    fn layer(&mut self) -> Result<(), ReadError> {
        if !self.scanner.bytes.starts_with(USDA_MAGIC) {
            return Err(self.scanner.error("not-usd", "the first line is not '#usda 1.0'"));
        }
        if self.scanner.take(b'(')? {
            while !self.scanner.take(b')')? {
                self.layer_entry()?;
            }
        }
        while self.scanner.peek()? != 0 {
            let start = self.scanner.at;
            let word = self.scanner.word()?;
            match word {
                "def" | "over" | "class" => self.prim(word, 0, 0)?,
                "reorder" => {
                    self.scanner.word()?;
                    self.scanner.need(b'=')?;
                    self.scanner.skip_value(self.depth)?;
                }
                _ => {
                    self.scanner.at = start;
                    return Err(self.scanner.expected("def, over or class"));
                }
            }
        }
        Ok(())
    }

    /// One entry of the file's metadata.
    fn layer_entry(&mut self) -> Result<(), ReadError> {
        if matches!(self.scanner.peek()?, b'"' | b'\'') {
            self.scanner.string()?;
            return Ok(());
        }
        let mut key = self.scanner.word()?;
        if LIST_EDITS.contains(&key) {
            key = self.scanner.word()?;
        }
        if key.is_empty() {
            return Err(self.scanner.expected("a word"));
        }
        self.scanner.need(b'=')?;
        match key {
            "defaultPrim" => self.about.default_prim = Some(self.scanner.string()?.into()),
            "upAxis" => self.about.up_axis = Some(self.scanner.string()?.into()),
            "metersPerUnit" => {
                let word = self.scanner.word()?;
                let value = crate::text::finite(word.as_bytes(), || self.scanner.place())?;
                self.about.metres_per_unit = Some(value);
            }
            "subLayers" => {
                self.scanner.need(b'[')?;
                while !self.scanner.take(b']')? {
                    let path = self.scanner.asset()?;
                    push(&mut self.about.sublayers, path.into())?;
                    self.scanner.skip_brackets_of_arc(self.depth)?;
                    self.scanner.take(b',')?;
                }
            }
            "customLayerData" => self.custom_data()?,
            _ => self.scanner.skip_value(self.depth)?,
        }
        Ok(())
    }

    /// A dictionary that may hold a certificate.
    fn custom_data(&mut self) -> Result<(), ReadError> {
        self.scanner.need(b'{')?;
        while !self.scanner.take(b'}')? {
            let kind = self.scanner.word()?;
            let is_quoted = matches!(self.scanner.peek()?, b'"' | b'\'');
            let key = if is_quoted { self.scanner.string()? } else { self.scanner.word()?.to_owned() };
            if kind.is_empty() || key.is_empty() {
                return Err(self.scanner.expected("a type and a name"));
            }
            self.scanner.need(b'=')?;
            if kind == "string" && key == super::CERTIFICATE {
                let text = self.scanner.string()?;
                self.about.take_certificate(&text);
            } else {
                self.scanner.skip_value(self.depth)?;
            }
            self.scanner.take(b',')?;
        }
        Ok(())
    }

    /// A prim after its specifier.
    fn prim(&mut self, specifier: &str, parent: u32, depth: usize) -> Result<(), ReadError> {
        if depth >= self.depth {
            return Err(too_deep(self.depth, self.scanner.place()));
        }
        let at = self.scanner.at;
        let type_name = self.scanner.word()?;
        let name = self.scanner.string()?;
        let specifier = match specifier {
            "def" => UsdSpecifier::Def,
            "class" => UsdSpecifier::Class,
            _ => UsdSpecifier::Over,
        };
        let mut prim = UsdPrim::new(&name, specifier);
        prim.at = at as u32;
        if !type_name.is_empty() {
            prim.more_mut().type_name = Some(type_name.into());
        }
        let number = push_prim(&mut self.prims, parent, prim)?;
        self.prim_rest(number, depth)
    }

    /// The metadata and the content of a prim or variant.
    fn prim_rest(&mut self, prim: u32, depth: usize) -> Result<(), ReadError> {
        if self.scanner.take(b'(')? {
            while !self.scanner.take(b')')? {
                self.prim_entry(prim)?;
            }
        }
        self.scanner.need(b'{')?;
        while !self.scanner.take(b'}')? {
            self.item(prim, depth)?;
        }
        Ok(())
    }

    fn prim_entry(&mut self, prim: u32) -> Result<(), ReadError> {
        // A string without a key is a comment.
        if matches!(self.scanner.peek()?, b'"' | b'\'') {
            self.scanner.string()?;
            return Ok(());
        }
        let mut key = self.scanner.word()?;
        let is_edit = LIST_EDITS.contains(&key);
        let is_deletion = key == "delete";
        let is_taken_away = is_deletion || key == "reorder";
        if is_edit {
            key = self.scanner.word()?;
        }
        if key.is_empty() {
            return Err(self.scanner.expected("a word"));
        }
        self.scanner.need(b'=')?;
        if is_taken_away {
            self.about.n_deletions += u64::from(is_deletion);
            return self.scanner.skip_value(self.depth);
        }
        let arcs = |parser: &mut Self| parser.arcs();
        match key {
            "references" => {
                let references = arcs(self)?;
                self.prims[prim as usize].arcs_mut().references.extend(references);
            }
            "payload" => {
                let payloads = arcs(self)?;
                self.prims[prim as usize].arcs_mut().payloads.extend(payloads);
            }
            "inherits" | "specializes" => {
                let paths = arcs(self)?.into_iter().map(|arc| arc.path);
                let prim_arcs = self.prims[prim as usize].arcs_mut();
                let list =
                    if key == "inherits" { &mut prim_arcs.inherits } else { &mut prim_arcs.specializes };
                list.extend(paths);
            }
            "variants" => self.selections(prim)?,
            "active" => {
                let word = self.scanner.word()?;
                let is_inactive = matches!(word, "false" | "False" | "0");
                if is_inactive {
                    self.prims[prim as usize].arcs_mut().is_inactive = true;
                }
            }
            "displayName" => {
                let name = self.scanner.string()?;
                self.prims[prim as usize].arcs_mut().display_name = Some(name.into());
            }
            _ => self.scanner.skip_value(self.depth)?,
        }
        Ok(())
    }

    /// References, payloads or inherited prims: one, or a list.
    fn arcs(&mut self) -> Result<Vec<UsdReference>, ReadError> {
        let mut references = Vec::new();
        if self.scanner.peek_word()? == "None" {
            self.scanner.word()?;
            return Ok(references);
        }
        if !self.scanner.take(b'[')? {
            references.push(self.arc()?);
            return Ok(references);
        }
        while !self.scanner.take(b']')? {
            let arc = self.arc()?;
            push(&mut references, arc)?;
            self.scanner.take(b',')?;
        }
        Ok(references)
    }

    fn arc(&mut self) -> Result<UsdReference, ReadError> {
        let mut arc = UsdReference::default();
        if self.scanner.peek()? == b'@' {
            arc.asset = self.scanner.asset()?.into();
        }
        if self.scanner.peek()? == b'<' {
            arc.path = self.scanner.path()?.into();
        } else if arc.asset.is_empty() {
            return Err(self.scanner.expected("a path"));
        }
        self.scanner.skip_brackets_of_arc(self.depth)?;
        Ok(arc)
    }

    /// The selected variants.
    fn selections(&mut self, prim: u32) -> Result<(), ReadError> {
        self.scanner.need(b'{')?;
        while !self.scanner.take(b'}')? {
            if self.scanner.word()? != "string" {
                return Err(self.scanner.expected("a string"));
            }
            let is_quoted = matches!(self.scanner.peek()?, b'"' | b'\'');
            let set = if is_quoted { self.scanner.string()? } else { self.scanner.word()?.to_owned() };
            self.scanner.need(b'=')?;
            let chosen = self.scanner.string()?;
            let arcs = self.prims[prim as usize].arcs_mut();
            push(&mut arcs.selections, [set.into(), chosen.into()])?;
        }
        Ok(())
    }

    /// A prim, a property, or a set of variants.
    fn item(&mut self, prim: u32, depth: usize) -> Result<(), ReadError> {
        let at = self.scanner.at;
        let mut word = self.scanner.word()?;
        match word {
            "def" | "over" | "class" => return self.prim(word, prim, depth + 1),
            "variantSet" => return self.variant_set(prim, depth),
            _ => {}
        }
        let is_deletion = word == "delete";
        let is_taken_away = is_deletion || word == "reorder";
        loop {
            match word {
                "custom" | "uniform" | "varying" | "config" => {}
                _ if LIST_EDITS.contains(&word) => {}
                _ => break,
            }
            word = self.scanner.word()?;
        }
        if is_taken_away && self.scanner.peek()? == b'=' {
            // The order of children or properties.
            self.scanner.need(b'=')?;
            return self.scanner.skip_value(self.depth);
        }
        if word.is_empty() {
            return Err(self.scanner.expected("a property, a prim or '}'"));
        }
        if word == "rel" {
            self.about.n_deletions += u64::from(is_deletion);
            return self.relationship(prim, at, is_taken_away);
        }
        let mut type_name = word.to_owned();
        if self.scanner.take(b'[')? {
            self.scanner.need(b']')?;
            type_name.push_str("[]");
        }
        self.attribute(prim, at, UsdType::from_name(&type_name))
    }

    /// An attribute after its type.
    fn attribute(&mut self, prim: u32, at: usize, kind: UsdType) -> Result<(), ReadError> {
        let word = self.scanner.word()?;
        let (name, field) = word.split_once('.').unwrap_or((word, ""));
        if name.is_empty() {
            return Err(self.scanner.expected("the name of an attribute"));
        }
        let is_wanted = is_kept(name);
        let mut value = None;
        let mut more = UsdPropertyMore::default();
        let mut has_more = false;
        if self.scanner.take(b'=')? {
            match field {
                "connect" => {
                    more.targets = self.targets()?;
                    more.has_targets = true;
                    has_more = true;
                }
                "timeSamples" if is_wanted => {
                    more.first_sample = self.first_sample(kind)?;
                    has_more = more.first_sample.is_some();
                }
                "" if is_wanted => value = Some(self.scanner.value(kind, self.depth)?),
                _ => self.scanner.skip_value(self.depth)?,
            }
        }
        if self.scanner.take(b'(')? {
            has_more |= self.attribute_entries(&mut more)?;
        }
        if !is_wanted {
            let Self { about, prims, .. } = self;
            about.skip(&prims[prim as usize], name);
            return Ok(());
        }
        let more = has_more.then(|| Box::new(more));
        let property = UsdProperty { name: name.into(), kind, at: at as u32, value, more };
        self.keep(prim, property)
    }

    /// Extends an existing property (`.connect`, `.timeSamples`), or stores a new one.
    fn keep(&mut self, prim: u32, new: UsdProperty) -> Result<(), ReadError> {
        let prim = &mut self.prims[prim as usize];
        // The statements of one attribute are consecutive, so only the last property is compared.
        let is_known = prim.properties().last().is_some_and(|known| known.name == new.name);
        let existing = if is_known { prim.more_mut().properties.last_mut() } else { None };
        let Some(existing) = existing else { return prim.push_property(new) };
        if new.value.is_some() {
            existing.value = new.value;
        }
        let Some(new) = new.more else { return Ok(()) };
        let more = existing.more.get_or_insert_default();
        if new.has_targets {
            more.targets = new.targets;
            more.has_targets = true;
        }
        if new.interpolation.is_some() {
            more.interpolation = new.interpolation;
        }
        if new.element_size.is_some() {
            more.element_size = new.element_size;
        }
        if new.first_sample.is_some() {
            more.first_sample = new.first_sample;
        }
        Ok(())
    }

    /// The metadata of an attribute. Returns whether there is anything to keep.
    fn attribute_entries(&mut self, more: &mut UsdPropertyMore) -> Result<bool, ReadError> {
        let mut has_some = false;
        while !self.scanner.take(b')')? {
            if matches!(self.scanner.peek()?, b'"' | b'\'') {
                self.scanner.string()?;
                continue;
            }
            let mut key = self.scanner.word()?;
            if LIST_EDITS.contains(&key) {
                key = self.scanner.word()?;
            }
            if key.is_empty() {
                return Err(self.scanner.expected("a word"));
            }
            self.scanner.need(b'=')?;
            match key {
                "interpolation" => {
                    more.interpolation = Some(self.scanner.string()?.into());
                    has_some = true;
                }
                "elementSize" => {
                    let word = self.scanner.word()?;
                    more.element_size = Some(crate::text::finite(word.as_bytes(), || self.scanner.place())?);
                    has_some = true;
                }
                _ => self.scanner.skip_value(self.depth)?,
            }
        }
        Ok(has_some)
    }

    /// The first of several time samples; the others are skipped.
    fn first_sample(&mut self, kind: UsdType) -> Result<Option<super::value::UsdValue>, ReadError> {
        self.scanner.need(b'{')?;
        let mut first = None;
        while !self.scanner.take(b'}')? {
            let time = self.scanner.word()?;
            // A colon may be part of a word, as in names with a namespace.
            if !time.ends_with(':') {
                let is_number = crate::text::number(time.as_bytes()).is_some();
                if !is_number || self.scanner.word()? != ":" {
                    return Err(self.scanner.expected("a time and ':'"));
                }
            }
            if first.is_none() {
                first = Some(self.scanner.value(kind, self.depth)?);
            } else {
                self.scanner.skip_value(self.depth)?;
            }
            self.scanner.take(b',')?;
        }
        Ok(first)
    }

    fn relationship(&mut self, prim: u32, at: usize, is_taken_away: bool) -> Result<(), ReadError> {
        let name = self.scanner.word()?;
        if name.is_empty() {
            return Err(self.scanner.expected("the name of a relationship"));
        }
        let mut more = UsdPropertyMore::default();
        if self.scanner.take(b'=')? {
            more.targets = self.targets()?;
            more.has_targets = !is_taken_away;
        }
        if self.scanner.take(b'(')? {
            self.attribute_entries(&mut UsdPropertyMore::default())?;
        }
        if !is_kept(name) || is_taken_away {
            return Ok(());
        }
        let property = UsdProperty {
            name: name.into(),
            kind: UsdType::default(),
            at: at as u32,
            value: None,
            more: Some(Box::new(more)),
        };
        self.keep(prim, property)
    }

    /// Paths, one or a list.
    fn targets(&mut self) -> Result<Vec<Box<str>>, ReadError> {
        Ok(self.arcs()?.into_iter().map(|arc| arc.path).collect())
    }

    fn variant_set(&mut self, prim: u32, depth: usize) -> Result<(), ReadError> {
        if depth >= self.depth {
            return Err(too_deep(self.depth, self.scanner.place()));
        }
        let name = self.scanner.string()?;
        self.scanner.need(b'=')?;
        self.scanner.need(b'{')?;
        let mut variants = Vec::new();
        while !self.scanner.take(b'}')? {
            let name = self.scanner.string()?;
            let mut variant = UsdPrim::new(&name, UsdSpecifier::Over);
            variant.at = self.scanner.at as u32;
            if let Some(name) = self.prims[prim as usize].type_name() {
                variant.more_mut().type_name = Some(name.into());
            }
            // A variant is no child of the prim: its content counts only if it is chosen.
            let number = push_prim(&mut self.prims, NO_PRIM, variant)?;
            self.prim_rest(number, depth + 1)?;
            push(&mut variants, UsdVariant { name: name.into(), prim: number })?;
        }
        let set = UsdVariantSet { name: name.into(), variants };
        push(&mut self.prims[prim as usize].arcs_mut().variant_sets, set)
    }
}
