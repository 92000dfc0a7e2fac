//! Reads USD's binary form into a layer: specs become prims, variants and properties.
use super::crate_tables::{CrateCursor, CrateField, CrateTables};
use super::crate_value::CrateValues;
use super::layer::{
    NO_PRIM, UsdArcs, UsdLayer, UsdLayerAbout, UsdPrim, UsdProperty, UsdPropertyMore, UsdSpecifier,
    UsdVariant, UsdVariantSet, is_kept, sorted_by_name,
};
use super::value::{UsdType, UsdValue};
use crate::grow::{push, push_large, push_many};
use crate::text::LineIndex;
use crate::{Limits, ReadError};
use std::borrow::Cow;

/// Kinds of specs.
const ATTRIBUTE: u32 = 1;
const PRIM: u32 = 6;
const ROOT: u32 = 7;
const RELATIONSHIP: u32 = 8;
const VARIANT: u32 = 10;

/// Reads a binary file. Values of attributes stay packed until they are needed.
///
/// # Errors
/// At the byte where the file is truncated or damaged.
pub(super) fn read_crate<'a>(
    bytes: Cow<'a, [u8]>,
    path: &str,
    limits: &Limits,
) -> Result<UsdLayer<'a>, ReadError> {
    let tables = CrateTables::read(&bytes, limits)?;
    let mut reader = CrateReader {
        values: CrateValues { bytes: &bytes, tables: &tables },
        prims: vec![UsdPrim::new("", UsdSpecifier::Def)],
        of_path: Vec::new(),
        about: UsdLayerAbout::default(),
    };
    push_many(&mut reader.of_path, NO_PRIM, tables.paths.len())?;
    reader.prims()?;
    reader.properties()?;
    let CrateReader { mut prims, about, .. } = reader;
    let by_name = sorted_by_name(&prims)?;
    link(&mut prims, &by_name, &tables, &bytes)?;
    Ok(UsdLayer {
        path: path.to_owned(),
        prims,
        by_name,
        about,
        tables: Some(tables),
        bytes,
        lines: LineIndex::default(),
    })
}

struct CrateReader<'a> {
    values: CrateValues<'a>,
    prims: Vec<UsdPrim>,
    /// The prim of each path.
    of_path: Vec<u32>,
    about: UsdLayerAbout,
}

impl CrateReader<'_> {
    /// Creates the prims and variants, at first without parents, since these may come later.
    fn prims(&mut self) -> Result<(), ReadError> {
        let tables = self.values.tables;
        for (at, spec) in tables.specs.iter().enumerate() {
            let Some(path) = tables.paths.get(spec.path as usize).filter(|path| path.is_known) else {
                continue;
            };
            let number = match spec.kind {
                ROOT => 0,
                PRIM | VARIANT => self.prims.len() as u32,
                _ => continue,
            };
            // Only damaged files have two specs of one path, or a path that is its own parent.
            if self.of_path[spec.path as usize] != NO_PRIM || (number > 0 && path.parent == spec.path) {
                continue;
            }
            self.of_path[spec.path as usize] = number;
            if number > 0 {
                let name = tables.token(path.token).unwrap_or_default();
                let mut prim = UsdPrim::new(name, UsdSpecifier::Over);
                prim.at = at as u32;
                tables.budget.take((std::mem::size_of::<UsdPrim>() / 16 + name.len()) as u64, 0)?;
                push_large(&mut self.prims, prim)?;
            }
            for field in tables.fields_of(spec.field_set) {
                if number == 0 {
                    self.layer_field(field)?;
                } else {
                    self.prim_field(number, field)?;
                }
            }
        }
        for spec in &tables.specs {
            let Some(path) = tables.paths.get(spec.path as usize).filter(|path| path.is_known) else {
                continue;
            };
            let number = self.of_path[spec.path as usize];
            let parent = self.of_path.get(path.parent as usize).copied().unwrap_or(NO_PRIM);
            if number == NO_PRIM || number == 0 || parent == NO_PRIM {
                continue;
            }
            match spec.kind {
                PRIM => self.prims[number as usize].parent = parent,
                VARIANT => self.variant(number, parent)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Puts a variant, whose name is `{set=name}`, into its set.
    fn variant(&mut self, number: u32, parent: u32) -> Result<(), ReadError> {
        let full = self.prims[number as usize].name.clone();
        let inside = full.strip_prefix('{').and_then(|rest| rest.strip_suffix('}'));
        let Some((set, name)) = inside.and_then(|inside| inside.split_once('=')) else { return Ok(()) };
        self.prims[number as usize].name = name.into();
        let type_name = self.prims[parent as usize].type_name().map(Box::from);
        self.prims[number as usize].more_mut().type_name = type_name;
        let sets = &mut self.prims[parent as usize].arcs_mut().variant_sets;
        let variant = UsdVariant { name: name.into(), prim: number };
        match sets.iter_mut().find(|known| &*known.name == set) {
            Some(known) => push(&mut known.variants, variant),
            None => push(sets, UsdVariantSet { name: set.into(), variants: vec![variant] }),
        }
    }

    fn word(&self, value: u64) -> Result<Option<Box<str>>, ReadError> {
        match self.values.unpack(value)? {
            UsdValue::Words(words) => Ok(words.into_iter().next()),
            _ => Ok(None),
        }
    }

    fn number(&self, value: u64) -> Result<Option<f64>, ReadError> {
        match self.values.unpack(value)? {
            UsdValue::Numbers(numbers) => Ok(numbers.first::<1>().map(|[x]| x)),
            _ => Ok(None),
        }
    }

    fn layer_field(&mut self, field: CrateField) -> Result<(), ReadError> {
        match self.values.tables.token(field.token).unwrap_or_default() {
            "defaultPrim" => self.about.default_prim = self.word(field.value)?,
            "upAxis" => self.about.up_axis = self.word(field.value)?,
            "metersPerUnit" => {
                self.about.metres_per_unit = self.number(field.value)?.filter(|x| x.is_finite())
            }
            "subLayers" => {
                // A vector of strings: 4 bytes each.
                let mut cursor = CrateCursor::at(self.values.bytes, field.value & ((1 << 48) - 1));
                for _ in 0..cursor.count(4)? {
                    let path = self.values.tables.string(cursor.u32()?).unwrap_or_default();
                    push(&mut self.about.sublayers, path.into())?;
                }
            }
            "customLayerData" => {
                if let Some(text) = self.values.string_in(field.value, super::CERTIFICATE)? {
                    self.about.take_certificate(&text);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn prim_field(&mut self, number: u32, field: CrateField) -> Result<(), ReadError> {
        let values = self.values;
        let value = field.value;
        let name = values.tables.token(field.token).unwrap_or_default();
        match name {
            "specifier" => {
                // In the order of `SdfSpecifier`: def, over, class.
                self.prims[number as usize].specifier = match value as u8 {
                    0 => UsdSpecifier::Def,
                    2 => UsdSpecifier::Class,
                    _ => UsdSpecifier::Over,
                };
                return Ok(());
            }
            "typeName" => {
                let name = self.word(value)?.filter(|name| !name.is_empty());
                self.prims[number as usize].more_mut().type_name = name;
                return Ok(());
            }
            "active" if self.number(value)? != Some(0.0) => return Ok(()),
            _ => {}
        }
        let word = if name == "displayName" { self.word(value)? } else { None };
        let arcs = |prim: &mut UsdPrim, fill: &mut dyn FnMut(&mut UsdArcs) -> Result<(), ReadError>| {
            fill(prim.arcs_mut())
        };
        let prim = &mut self.prims[number as usize];
        match name {
            "references" | "payload" => {
                let items = values.list_items(value)?;
                arcs(prim, &mut |arcs| {
                    let list = if name == "payload" { &mut arcs.payloads } else { &mut arcs.references };
                    list.extend_from_slice(&items);
                    Ok(())
                })
            }
            "inheritPaths" | "specializes" => {
                let items = values.list_items(value)?;
                arcs(prim, &mut |arcs| {
                    let list = if name == "specializes" { &mut arcs.specializes } else { &mut arcs.inherits };
                    list.extend(items.iter().map(|item| item.path.clone()));
                    Ok(())
                })
            }
            "variantSelection" => {
                let selections = values.selections(value)?;
                arcs(prim, &mut |arcs| {
                    arcs.selections.extend_from_slice(&selections);
                    Ok(())
                })
            }
            "active" => {
                prim.arcs_mut().is_inactive = true;
                Ok(())
            }
            "displayName" => {
                prim.arcs_mut().display_name = word;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn properties(&mut self) -> Result<(), ReadError> {
        let tables = self.values.tables;
        for (at, spec) in tables.specs.iter().enumerate() {
            if spec.kind != ATTRIBUTE && spec.kind != RELATIONSHIP {
                continue;
            }
            let Some(path) = tables.paths.get(spec.path as usize).filter(|path| path.is_property) else {
                continue;
            };
            let prim = self.of_path.get(path.parent as usize).copied().unwrap_or(NO_PRIM);
            let name = tables.token(path.token).unwrap_or_default();
            if prim == NO_PRIM {
                continue;
            }
            if !is_kept(name) {
                let Self { about, prims, .. } = self;
                about.skip(&prims[prim as usize], name);
                continue;
            }
            let mut property = UsdProperty {
                name: name.into(),
                kind: UsdType::default(),
                at: at as u32,
                value: None,
                more: None,
            };
            tables.budget.take((std::mem::size_of::<UsdProperty>() / 16 + name.len()) as u64, 0)?;
            for field in tables.fields_of(spec.field_set) {
                self.property_field(&mut property, field)?;
            }
            self.prims[prim as usize].push_property(property)?;
        }
        Ok(())
    }

    fn property_field(&self, property: &mut UsdProperty, field: CrateField) -> Result<(), ReadError> {
        let value = field.value;
        fn more(property: &mut UsdProperty) -> &mut UsdPropertyMore {
            property.more.get_or_insert_default()
        }
        match self.values.tables.token(field.token).unwrap_or_default() {
            "typeName" => {
                let name = self.word(value)?.unwrap_or_default();
                property.kind = UsdType::from_name(&name);
            }
            "default" => property.value = Some(UsdValue::Packed(value)),
            "timeSamples" if CrateValues::is_samples(value) => {
                let first = self.values.first_sample(value)?;
                more(property).first_sample = first.map(UsdValue::Packed);
            }
            "interpolation" => more(property).interpolation = self.word(value)?,
            "elementSize" => more(property).element_size = self.number(value)?,
            "connectionPaths" | "targetPaths" => {
                let items = self.values.list_items(value)?;
                let more = more(property);
                more.has_targets = true;
                more.targets = items.into_iter().map(|item| item.path).collect();
            }
            _ => {}
        }
        Ok(())
    }
}

/// Links the children of each prim in the order that the prim lists.
fn link(prims: &mut [UsdPrim], by_name: &[u32], tables: &CrateTables, bytes: &[u8]) -> Result<(), ReadError> {
    let values = CrateValues { bytes, tables };
    let mut is_linked = Vec::new();
    push_many(&mut is_linked, false, prims.len())?;
    for parent in 0..prims.len() as u32 {
        let spec = if parent == 0 {
            tables.specs.iter().find(|spec| spec.kind == ROOT)
        } else {
            tables.specs.get(prims[parent as usize].at as usize)
        };
        let Some(spec) = spec else { continue };
        let children =
            tables.fields_of(spec.field_set).find(|field| tables.token(field.token) == Some("primChildren"));
        let Some(children) = children else { continue };
        for name in values.words(children.value)? {
            let key = |i: u32| (prims[i as usize].parent, &*prims[i as usize].name);
            let at = by_name.partition_point(|i| key(*i) < (parent, &*name));
            let Some(child) = by_name.get(at).copied().filter(|i| key(*i) == (parent, &*name)) else {
                continue;
            };
            // A name that is listed twice would close the list of siblings to a ring.
            if std::mem::replace(&mut is_linked[child as usize], true) {
                continue;
            }
            let last = std::mem::replace(&mut prims[parent as usize].last_child, child);
            match last {
                NO_PRIM => prims[parent as usize].first_child = child,
                last => prims[last as usize].next = child,
            }
        }
    }
    Ok(())
}
