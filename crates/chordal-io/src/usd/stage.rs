//! `UsdStage`: the prims of a shape, composed from those of its files: sublayers, inherited prims, selected
//! variants, references and payloads.
//!
//! Source: Pixar Animation Studios, *USD Glossary*, "LIVRPS Strength Ordering", openusd.org, 2024.
use super::crate_value::CrateValues;
use super::files::UsdFiles;
use super::layer::{NO_PRIM, UsdArcs, UsdLayer, UsdPrim, UsdProperty, UsdReference, UsdSpecifier};
use super::value::{UsdNumbers, UsdType, UsdValue};
use crate::grow::push;
use crate::notes::NamedNotes;
use crate::text::grouped;
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The most sources of prims that references and variants may add to the prims of the files. Chosen: as many
/// as copies of objects in 3MF.
const COPIES: u64 = 200_000;
/// The most sources of one prim. Chosen: real files have tens.
const MOST_SOURCES: usize = 4096;
/// The most files that one may refer to. Chosen: real packages have a few.
const MOST_LAYERS: usize = 256;

/// A prim of a file whose content is part of a composed prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StageSource {
    pub layer: u32,
    pub prim: u32,
    /// The index of the map from its paths to those of the shape.
    pub map: u32,
}

/// A composed prim: its sources, the strongest first.
#[derive(Clone, Debug)]
pub(super) struct StagePrim {
    pub path: String,
    pub sources: Vec<StageSource>,
    pub depth: usize,
}

/// Maps paths at and below `from` to paths at and below `to`.
#[derive(Clone, Debug, Default, PartialEq)]
struct PathMap {
    from: String,
    to: String,
}

/// An attribute with its strongest value.
pub(super) struct StageAttribute<'s> {
    pub value: Option<Cow<'s, UsdValue>>,
    pub kind: UsdType,
    pub interpolation: Option<&'s str>,
    pub element_size: Option<f64>,
    pub place: FileLocation,
}

/// The files of a shape.
pub(super) struct UsdStage<'a, 'b> {
    pub layers: Vec<UsdLayer<'a>>,
    pub files: UsdFiles<'a, 'b>,
    pub limits: Limits,
    pub notes: RefCell<NamedNotes>,
    /// The files that were requested, each with its layer if it was opened.
    opened: BTreeMap<String, Option<u32>>,
    /// The path maps; the first is the identity.
    maps: Vec<PathMap>,
    left: u64,
    /// The layer stack of the first file: it and its sublayers.
    stack: Vec<u32>,
}

impl<'a, 'b> UsdStage<'a, 'b> {
    /// A shape from one file and the files that it refers to.
    ///
    /// # Errors
    /// If one of its sublayers is damaged.
    pub(super) fn new(
        root: UsdLayer<'a>,
        files: UsdFiles<'a, 'b>,
        limits: &Limits,
    ) -> Result<Self, ReadError> {
        let left = COPIES + root.prims.len() as u64;
        let mut stage = Self {
            layers: vec![root],
            files,
            limits: *limits,
            notes: RefCell::default(),
            opened: BTreeMap::new(),
            maps: vec![PathMap::default()],
            left,
            stack: vec![0],
        };
        let mut at = 0;
        while at < stage.stack.len() {
            let layer = stage.stack[at];
            at += 1;
            let mut below = at;
            for asset in stage.layers[layer as usize].about.sublayers.clone() {
                if let Some(sublayer) = stage.open(layer, &asset)?
                    && !stage.stack.contains(&sublayer)
                {
                    // Depth first: what a sublayer includes is stronger than the sublayer after it.
                    stage.stack.insert(below, sublayer);
                    below += 1;
                }
            }
        }
        Ok(stage)
    }

    pub(super) fn note(&self, code: &'static str, what: &'static str, name: &str) {
        self.notes.borrow_mut().add(code, what, name);
    }

    /// The root of all prims.
    pub(super) fn root(&self) -> StagePrim {
        let source = |layer: &u32| StageSource { layer: *layer, prim: 0, map: 0 };
        StagePrim { path: String::new(), sources: self.stack.iter().map(source).collect(), depth: 0 }
    }

    /// Opens a referenced file, once.
    fn open(&mut self, from: u32, asset: &str) -> Result<Option<u32>, ReadError> {
        let missing = "files that others refer to could not be read: their content is missing";
        let from_path = self.layers[from as usize].path.clone();
        let resolved = self.files.resolve(&from_path, asset);
        let path = match resolved {
            Ok(path) => path,
            Err(why) => {
                self.note("layer-missing", missing, &format!("{asset} ({why})"));
                return Ok(None);
            }
        };
        if let Some(known) = self.opened.get(&path) {
            return Ok(*known);
        }
        if self.layers.len() >= MOST_LAYERS {
            let message = format!("{MOST_LAYERS} files of one shape are the limit");
            return Err(ReadError::new("too-many-files", FileLocation::File, message));
        }
        // Remembered before it is read, so that a file that cannot be is tried and reported once.
        self.opened.insert(path.clone(), None);
        match self.files.read(&path) {
            Ok(bytes) => {
                let layer = super::forms::layer(Cow::Owned(bytes), &path, &self.limits).map_err(|error| {
                    ReadError { message: format!("{path}: {}", &*error.message).into(), ..error }
                })?;
                self.left = self.left.saturating_add(layer.prims.len() as u64);
                let number = self.layers.len() as u32;
                self.layers.push(layer);
                self.opened.insert(path, Some(number));
                Ok(Some(number))
            }
            Err(why) => {
                self.note("layer-missing", missing, &format!("{asset} ({why})"));
                Ok(None)
            }
        }
    }

    pub(super) fn spec(&self, source: StageSource) -> &UsdPrim {
        self.layers[source.layer as usize].prim(source.prim)
    }

    /// The location of a prim's strongest source.
    pub(super) fn place(&self, prim: &StagePrim) -> FileLocation {
        let first = prim.sources.first().copied();
        first.map_or(FileLocation::File, |source| {
            self.layers[source.layer as usize].place(self.spec(source).at)
        })
    }

    /// The child of a prim.
    ///
    /// # Errors
    /// If arcs lead to damaged data, form a cycle, or exceed the limits.
    pub(super) fn child(&mut self, parent: &StagePrim, name: &str) -> Result<Option<StagePrim>, ReadError> {
        let mut child = StagePrim {
            path: format!("{}/{name}", parent.path),
            sources: Vec::new(),
            depth: parent.depth + 1,
        };
        if child.depth > self.limits.depth {
            return Err(super::layer::too_deep(self.limits.depth, self.place(parent)));
        }
        for source in &parent.sources {
            if let Some(prim) = self.layers[source.layer as usize].child(source.prim, name) {
                self.expand(StageSource { prim, ..*source }, &mut child, 0)?;
            }
        }
        Ok(if child.sources.is_empty() { None } else { Some(child) })
    }

    /// The names of all children, in their order.
    pub(super) fn child_names(&self, parent: &StagePrim) -> Result<Vec<Box<str>>, ReadError> {
        let (mut names, mut seen) = (Vec::new(), BTreeSet::new());
        // The strongest source comes first in the list, and its names come last.
        for source in parent.sources.iter().rev() {
            let layer = &self.layers[source.layer as usize];
            for child in layer.children(source.prim) {
                let name = &layer.prim(child).name;
                if parent.sources.len() == 1 || seen.insert(name) {
                    push(&mut names, name.clone())?;
                }
            }
        }
        Ok(names)
    }

    /// The prim at a path.
    pub(super) fn prim_at(&mut self, path: &str) -> Result<Option<StagePrim>, ReadError> {
        let mut prim = self.root();
        for name in path.split('/').filter(|name| !name.is_empty()) {
            let Some(child) = self.child(&prim, name)? else { return Ok(None) };
            prim = child;
        }
        Ok(Some(prim))
    }

    /// Adds a source and everything that its arcs add, the strongest first.
    fn expand(&mut self, source: StageSource, into: &mut StagePrim, depth: usize) -> Result<(), ReadError> {
        // A prim that several arcs lead to has its opinions once, at its strongest place.
        if into.sources.iter().any(|known| [known.layer, known.prim] == [source.layer, source.prim]) {
            return Ok(());
        }
        let place = self.layers[source.layer as usize].place(self.spec(source).at);
        let left = self.left.checked_sub(1);
        let fits = depth <= self.limits.depth && into.sources.len() < MOST_SOURCES;
        let Some(left) = left.filter(|_| fits) else {
            let message = format!(
                "{}: references and variants bring more prims than the limit of {} copies",
                into.path,
                grouped(COPIES)
            );
            return Err(ReadError::new("too-many-copies", place, message));
        };
        self.left = left;
        push(&mut into.sources, source)?;
        let Some(arcs) = self.spec(source).arcs() else { return Ok(()) };
        let UsdArcs { references, payloads, inherits, specializes, .. } = arcs;
        let lists = (inherits.clone(), references.clone(), payloads.clone(), specializes.clone());
        let chosen = self.chosen_variants(arcs, into);
        // In the order of strength, after the prim itself: inherited prims, variants, references,
        // payloads, specialized prims.
        for path in lists.0 {
            self.follow(source, UsdReference { asset: "".into(), path }, into, depth)?;
        }
        for prim in chosen {
            self.expand(StageSource { prim, ..source }, into, depth + 1)?;
        }
        for reference in lists.1.into_iter().chain(lists.2) {
            self.follow(source, reference, into, depth)?;
        }
        for path in lists.3 {
            self.follow(source, UsdReference { asset: "".into(), path }, into, depth)?;
        }
        Ok(())
    }

    /// The variants selected by a prim's strongest opinions. Other variants are counted.
    fn chosen_variants(&self, arcs: &UsdArcs, into: &StagePrim) -> Vec<u32> {
        let mut variants = Vec::new();
        for set in &arcs.variant_sets {
            let sources = into.sources.iter();
            let selections = sources.filter_map(|source| self.spec(*source).arcs());
            let choice = selections.flat_map(|arcs| &arcs.selections).find(|[name, _]| *name == set.name);
            let variant = choice.and_then(|[_, name]| set.variants.iter().find(|known| known.name == *name));
            variants.extend(variant.map(|variant| variant.prim));
            let name = format!("{} of {}", set.name, into.path);
            if variant.is_none() && !set.variants.is_empty() {
                self.note("variants-unset", "sets of variants of which none is chosen were left out", &name);
            } else if set.variants.len() > 1 {
                self.note("variants-skipped", "of sets of variants only the chosen one was read", &name);
            }
        }
        variants
    }

    /// Follows an arc of a source.
    fn follow(
        &mut self,
        source: StageSource,
        reference: UsdReference,
        into: &mut StagePrim,
        depth: usize,
    ) -> Result<(), ReadError> {
        let layer = match &*reference.asset {
            "" => Some(source.layer),
            asset => self.open(source.layer, asset)?,
        };
        let Some(layer) = layer else { return Ok(()) };
        let target = &self.layers[layer as usize];
        let path = match &*reference.path {
            "" => {
                target.about.default_prim.as_deref().map(|name| format!("/{}", name.trim_start_matches('/')))
            }
            path => Some(path.to_owned()),
        };
        let place = self.layers[source.layer as usize].place(self.spec(source).at);
        let Some(path) = path else {
            let what = "references to files without a default prim were left out";
            self.note("no-default-prim", what, &reference.asset);
            return Ok(());
        };
        // A prim of the same file may be in any of its sublayers.
        let layers = if self.stack.contains(&layer) { self.stack.clone() } else { vec![layer] };
        let mut is_found = false;
        for layer in layers {
            let Some(prim) = self.layers[layer as usize].find(&path) else { continue };
            is_found = true;
            if self.is_inside(source, layer, prim) {
                let message = format!("{} refers to {path}, which it is in", into.path);
                return Err(ReadError::new("reference-cycle", place, message));
            }
            let map = PathMap { from: path.clone(), to: into.path.clone() };
            let last = self.maps.len() - 1;
            let map = if self.maps[last] == map {
                last
            } else {
                push(&mut self.maps, map)?;
                last + 1
            };
            self.expand(StageSource { layer, prim, map: map as u32 }, into, depth + 1)?;
        }
        if !is_found {
            let what = "arcs lead to prims that are not there";
            self.note("target-missing", what, &format!("{path} from {}", into.path));
        }
        Ok(())
    }

    /// Whether a source is a given prim, or a descendant of it.
    fn is_inside(&self, source: StageSource, layer: u32, prim: u32) -> bool {
        let mut at = source.prim;
        while source.layer == layer && at != NO_PRIM {
            if at == prim {
                return true;
            }
            at = self.layers[layer as usize].prim(at).parent;
        }
        false
    }

    /// Whether the prim is defined and not a class.
    pub(super) fn is_defined(&self, prim: &StagePrim) -> bool {
        let kinds = prim.sources.iter().map(|source| self.spec(*source).specifier);
        kinds.into_iter().find(|kind| *kind != UsdSpecifier::Over) == Some(UsdSpecifier::Def)
    }

    pub(super) fn type_name(&self, prim: &StagePrim) -> &str {
        prim.sources.iter().find_map(|source| self.spec(*source).type_name()).unwrap_or("")
    }

    pub(super) fn is_inactive(&self, prim: &StagePrim) -> bool {
        let mut arcs = prim.sources.iter().filter_map(|source| self.spec(*source).arcs());
        arcs.any(|arcs| arcs.is_inactive)
    }

    /// The display name, or else the last step of the path.
    pub(super) fn name(&self, prim: &StagePrim) -> String {
        let mut arcs = prim.sources.iter().filter_map(|source| self.spec(*source).arcs());
        let shown = arcs.find_map(|arcs| arcs.display_name.as_deref());
        shown.unwrap_or_else(|| prim.path.rsplit('/').next().unwrap_or_default()).to_owned()
    }

    /// The opinions on a property, the strongest first.
    fn opinions<'s>(
        &'s self,
        prim: &'s StagePrim,
        name: &'s str,
    ) -> impl Iterator<Item = (StageSource, &'s UsdProperty)> {
        prim.sources.iter().filter_map(move |source| Some((*source, self.spec(*source).property(name)?)))
    }

    /// The attribute with a name, if there is an opinion on it.
    ///
    /// # Errors
    /// If its value is damaged.
    pub(super) fn attribute<'s>(
        &'s self,
        prim: &'s StagePrim,
        name: &'s str,
    ) -> Result<Option<StageAttribute<'s>>, ReadError> {
        let mut strongest: Option<StageAttribute<'s>> = None;
        for (source, property) in self.opinions(prim, name) {
            let layer = &self.layers[source.layer as usize];
            let attribute = strongest.get_or_insert_with(|| StageAttribute {
                value: None,
                kind: property.kind,
                interpolation: None,
                element_size: None,
                place: layer.place(property.at),
            });
            let more = property.more.as_deref();
            attribute.interpolation =
                attribute.interpolation.or(more.and_then(|more| more.interpolation.as_deref()));
            attribute.element_size = attribute.element_size.or(more.and_then(|more| more.element_size));
            // Weaker sources may still say how it is interpolated.
            if attribute.value.is_some() {
                continue;
            }
            let sample = more.and_then(|more| more.first_sample.as_ref());
            if sample.is_some() {
                let what =
                    "attributes change over time: the value without a time was read, or else the first";
                self.note("time-samples", what, &format!("{}.{name}", prim.path));
            }
            if let Some(value) = property.value.as_ref().or(sample) {
                attribute.value = Some(match (value, &layer.tables) {
                    (UsdValue::Packed(packed), Some(tables)) => {
                        let values = CrateValues { bytes: &layer.bytes, tables };
                        Cow::Owned(values.unpack(*packed).map_err(|error| {
                            let message =
                                format!("{}{}.{name}: {}", layer.prefix(), prim.path, &*error.message);
                            ReadError { message: message.into(), ..error }
                        })?)
                    }
                    (value, _) => Cow::Borrowed(value),
                });
                attribute.kind = property.kind;
                attribute.place = layer.place(property.at);
            }
        }
        Ok(strongest)
    }

    /// The numbers of an attribute.
    pub(super) fn numbers<'s>(
        &'s self,
        prim: &'s StagePrim,
        name: &'s str,
    ) -> Result<Option<Cow<'s, UsdNumbers>>, ReadError> {
        let value = self.attribute(prim, name)?.and_then(|attribute| attribute.value);
        Ok(match value {
            Some(Cow::Borrowed(UsdValue::Numbers(numbers))) => Some(Cow::Borrowed(numbers)),
            Some(Cow::Owned(UsdValue::Numbers(numbers))) => Some(Cow::Owned(numbers)),
            _ => None,
        })
    }

    /// The first word of an attribute.
    pub(super) fn word(&self, prim: &StagePrim, name: &str) -> Result<Option<String>, ReadError> {
        let value = self.attribute(prim, name)?.and_then(|attribute| attribute.value);
        Ok(match value.as_deref() {
            Some(UsdValue::Words(words)) => words.first().map(|word| word.to_string()),
            _ => None,
        })
    }

    /// The words of an attribute.
    pub(super) fn words(&self, prim: &StagePrim, name: &str) -> Result<Vec<Box<str>>, ReadError> {
        let value = self.attribute(prim, name)?.and_then(|attribute| attribute.value);
        Ok(match value.map(Cow::into_owned) {
            Some(UsdValue::Words(words)) => words,
            _ => Vec::new(),
        })
    }

    /// The targets of a relationship, or the connections of an attribute, as paths of the shape.
    pub(super) fn targets(&self, prim: &StagePrim, name: &str) -> Vec<String> {
        for (source, property) in self.opinions(prim, name) {
            if let Some(more) = property.more.as_deref().filter(|more| more.has_targets) {
                return more.targets.iter().map(|path| self.map_path(source, path)).collect();
            }
        }
        Vec::new()
    }

    /// The layer with the strongest opinion on an attribute: file paths are relative to it.
    pub(super) fn layer_of(&self, prim: &StagePrim, name: &str) -> u32 {
        self.opinions(prim, name)
            .find(|(_, found)| found.value.is_some())
            .map_or(0, |(source, _)| source.layer)
    }

    /// The names of properties with a prefix, each once, in order.
    pub(super) fn property_names(&self, prim: &StagePrim, beginning: &str) -> BTreeSet<String> {
        let properties = prim.sources.iter().flat_map(|source| self.spec(*source).properties());
        properties
            .filter(|found| found.name.starts_with(beginning))
            .map(|found| found.name.to_string())
            .collect()
    }

    /// Maps a path in a source to a path of the shape.
    fn map_path(&self, source: StageSource, path: &str) -> String {
        let path = if path.starts_with('/') { path.to_owned() } else { self.absolute(source, path) };
        let PathMap { from, to } = &self.maps[source.map as usize];
        match path.strip_prefix(&**from) {
            Some(rest) if rest.is_empty() || rest.starts_with(['/', '.']) || from.is_empty() => {
                format!("{to}{rest}")
            }
            _ => path,
        }
    }

    /// The absolute form of a path that is relative to a source's prim.
    fn absolute(&self, source: StageSource, path: &str) -> String {
        let mut steps = Vec::new();
        let mut at = source.prim;
        while at != NO_PRIM && at != 0 {
            let prim = self.layers[source.layer as usize].prim(at);
            steps.push(&*prim.name);
            at = prim.parent;
        }
        steps.reverse();
        for step in path.split('/') {
            match step {
                "" | "." => {}
                ".." => drop(steps.pop()),
                name => steps.push(name),
            }
        }
        format!("/{}", steps.join("/"))
    }
}
