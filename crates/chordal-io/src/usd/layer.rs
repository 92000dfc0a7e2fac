//! `UsdLayer`: the content of one file of USD, whatever its form: a tree of prims with properties, and the
//! arcs to other prims.
use super::crate_tables::CrateTables;
use super::shape_kind::UsdShapeKind;
use super::value::{UsdType, UsdValue};
use crate::grow::push_large;
use crate::text::{LineIndex, grouped};
use crate::{FileLocation, ReadError};
use serde_json::Value;
use std::borrow::Cow;

/// The index for "no prim".
pub(super) const NO_PRIM: u32 = u32::MAX;

/// The specifier of a prim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum UsdSpecifier {
    /// Defines the prim.
    Def,
    /// Overrides a prim that is defined elsewhere.
    #[default]
    Over,
    /// A class that other prims inherit.
    Class,
}

/// A prim in one file, or a variant of one.
#[derive(Debug)]
pub(super) struct UsdPrim {
    pub name: Box<str>,
    pub parent: u32,
    pub first_child: u32,
    pub last_child: u32,
    pub next: u32,
    /// Its offset in a text; its index in a binary file.
    pub at: u32,
    pub specifier: UsdSpecifier,
    more: Option<Box<UsdPrimMore>>,
}

/// The further fields of a prim, boxed, since a text can have a prim for every nine bytes.
#[derive(Debug, Default)]
pub(super) struct UsdPrimMore {
    pub type_name: Option<Box<str>>,
    pub properties: Vec<UsdProperty>,
    pub arcs: Option<Box<UsdArcs>>,
}

/// The composition arcs and metadata of a prim.
#[derive(Debug, Default)]
pub(super) struct UsdArcs {
    pub references: Vec<UsdReference>,
    pub payloads: Vec<UsdReference>,
    pub inherits: Vec<Box<str>>,
    pub specializes: Vec<Box<str>>,
    pub selections: Vec<[Box<str>; 2]>,
    pub variant_sets: Vec<UsdVariantSet>,
    pub display_name: Option<Box<str>>,
    pub is_inactive: bool,
}

/// A set of variants.
#[derive(Debug)]
pub(super) struct UsdVariantSet {
    pub name: Box<str>,
    pub variants: Vec<UsdVariant>,
}

/// A variant of a set.
#[derive(Debug)]
pub(super) struct UsdVariant {
    pub name: Box<str>,
    /// Its prim, which has no parent.
    pub prim: u32,
}

/// A reference to a prim of this or of another file, whose content is composed into another prim.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UsdReference {
    /// The other file; empty for the same file.
    pub asset: Box<str>,
    /// The prim; empty for the default one.
    pub path: Box<str>,
}

/// An attribute or a relationship.
#[derive(Debug)]
pub(super) struct UsdProperty {
    pub name: Box<str>,
    pub kind: UsdType,
    /// Its offset in a text; its index in a binary file.
    pub at: u32,
    pub value: Option<UsdValue>,
    pub more: Option<Box<UsdPropertyMore>>,
}

/// The rarer fields of a property.
#[derive(Debug, Default)]
pub(super) struct UsdPropertyMore {
    pub interpolation: Option<Box<str>>,
    pub element_size: Option<f64>,
    /// Targets of a relationship or connections of an attribute.
    pub targets: Vec<Box<str>>,
    pub has_targets: bool,
    /// The first of several time samples.
    pub first_sample: Option<UsdValue>,
}

/// The content of a file.
#[derive(Debug)]
pub(super) struct UsdLayer<'a> {
    /// Its path below the folder or in the package; empty for the first file.
    pub path: String,
    pub bytes: Cow<'a, [u8]>,
    pub lines: LineIndex,
    /// The first is the root; its children are the top-level prims.
    pub prims: Vec<UsdPrim>,
    /// All prims, sorted by parent and name.
    pub by_name: Vec<u32>,
    pub about: UsdLayerAbout,
    /// `None` for a text.
    pub tables: Option<CrateTables>,
}

/// The metadata of a file.
#[derive(Debug, Default)]
pub(super) struct UsdLayerAbout {
    pub default_prim: Option<Box<str>>,
    pub metres_per_unit: Option<f64>,
    pub up_axis: Option<Box<str>>,
    pub sublayers: Vec<Box<str>>,
    pub certificate: Option<Value>,
    /// Why a certificate could not be read.
    pub bad_certificate: Option<String>,
    /// The number of list edits that delete; they are not applied.
    pub n_deletions: u64,
    /// The number of unknown attributes of meshes, curves and surfaces; `skipped` has the name of the first.
    pub n_skipped: u64,
    pub first_skipped: Option<Box<str>>,
}

impl UsdLayerAbout {
    /// Stores a certificate.
    pub(super) fn take_certificate(&mut self, text: &str) {
        match serde_json::from_str(text) {
            Ok(value) => self.certificate = Some(value),
            Err(error) => self.bad_certificate = Some(error.to_string()),
        }
    }

    /// Counts a skipped property, if its prim is a mesh, curves or a surface.
    pub(super) fn skip(&mut self, prim: &UsdPrim, name: &str) {
        let is_expected = UNUSED.contains(&name)
            || ["ui:", "subsetFamily:", "trimCurve:"].iter().any(|start| name.starts_with(start));
        let is_read = |kind: &str| kind == "Mesh" || UsdShapeKind::from_type(kind).is_some();
        if prim.type_name().is_some_and(is_read) && !is_expected {
            self.n_skipped += 1;
            self.first_skipped.get_or_insert_with(|| name.into());
        }
    }
}

/// Properties that are kept, and prefixes of names of others.
const KEPT: [&str; 45] = [
    "points",
    "faceVertexCounts",
    "faceVertexIndices",
    "orientation",
    "subdivisionScheme",
    "normals",
    "creaseIndices",
    "creaseLengths",
    "creaseSharpnesses",
    "cornerIndices",
    "cornerSharpnesses",
    "holeIndices",
    "interpolateBoundary",
    "faceVaryingLinearInterpolation",
    "triangleSubdivisionRule",
    "doubleSided",
    "visibility",
    "purpose",
    "xformOpOrder",
    "elementType",
    "familyName",
    "indices",
    "protoIndices",
    "prototypes",
    "positions",
    "orientations",
    "scales",
    "invisibleIds",
    "curveVertexCounts",
    "type",
    "basis",
    "wrap",
    "order",
    "knots",
    "ranges",
    "pointWeights",
    "uVertexCount",
    "vVertexCount",
    "uOrder",
    "vOrder",
    "uKnots",
    "vKnots",
    "uRange",
    "vRange",
    "trimCurve:counts",
];
const KEPT_BEGINNINGS: [&str; 7] =
    ["primvars:", "xformOp:", "inputs:", "outputs:", "info:", "material:binding", "chordal:"];
/// Attributes of meshes, curves and surfaces that are redundant, or have no effect here.
const UNUSED: [&str; 5] = ["extent", "proxyPrim", "ids", "uForm", "vForm"];

/// Whether a property of this name is kept.
pub(super) fn is_kept(name: &str) -> bool {
    KEPT.contains(&name) || KEPT_BEGINNINGS.iter().any(|beginning| name.starts_with(beginning))
}

impl UsdPrim {
    pub(super) fn new(name: &str, specifier: UsdSpecifier) -> Self {
        Self {
            name: name.into(),
            parent: NO_PRIM,
            first_child: NO_PRIM,
            last_child: NO_PRIM,
            next: NO_PRIM,
            at: 0,
            specifier,
            more: None,
        }
    }

    pub(super) fn more_mut(&mut self) -> &mut UsdPrimMore {
        self.more.get_or_insert_default()
    }

    pub(super) fn arcs_mut(&mut self) -> &mut UsdArcs {
        self.more_mut().arcs.get_or_insert_default()
    }

    pub(super) fn type_name(&self) -> Option<&str> {
        self.more.as_ref()?.type_name.as_deref()
    }

    pub(super) fn arcs(&self) -> Option<&UsdArcs> {
        self.more.as_ref()?.arcs.as_deref()
    }

    pub(super) fn properties(&self) -> &[UsdProperty] {
        self.more.as_ref().map_or(&[], |more| &more.properties)
    }

    pub(super) fn property(&self, name: &str) -> Option<&UsdProperty> {
        self.properties().iter().find(|property| &*property.name == name)
    }

    /// Appends a property. Most prims have few, so the first allocation has room for one.
    pub(super) fn push_property(&mut self, property: UsdProperty) -> Result<(), ReadError> {
        let list = &mut self.more_mut().properties;
        if list.len() == list.capacity() {
            let step = (list.len() / 4).max(1);
            list.try_reserve_exact(step).map_err(|_| crate::grow::out_of_memory(list.len()))?;
        }
        list.push(property);
        Ok(())
    }
}

/// Appends a prim below a parent, or without one, and returns its index.
pub(super) fn push_prim(prims: &mut Vec<UsdPrim>, parent: u32, prim: UsdPrim) -> Result<u32, ReadError> {
    let number = prims.len() as u32;
    push_large(prims, UsdPrim { parent, ..prim })?;
    if parent != NO_PRIM {
        let last = std::mem::replace(&mut prims[parent as usize].last_child, number);
        match last {
            NO_PRIM => prims[parent as usize].first_child = number,
            last => prims[last as usize].next = number,
        }
    }
    Ok(number)
}

/// All prims, sorted by parent and name.
pub(super) fn sorted_by_name(prims: &[UsdPrim]) -> Result<Vec<u32>, ReadError> {
    let mut by_name = crate::grow::with_room(prims.len())?;
    by_name.extend(0..prims.len() as u32);
    by_name.sort_unstable_by(|a, b| {
        let key = |i: u32| (prims[i as usize].parent, &prims[i as usize].name, i);
        key(*a).cmp(&key(*b))
    });
    Ok(by_name)
}

impl UsdLayer<'_> {
    pub(super) fn prim(&self, number: u32) -> &UsdPrim {
        &self.prims[number as usize]
    }

    /// The child of a prim by its name.
    pub(super) fn child(&self, parent: u32, name: &str) -> Option<u32> {
        let key = |i: u32| (self.prim(i).parent, &*self.prim(i).name);
        let at = self.by_name.partition_point(|i| key(*i) < (parent, name));
        self.by_name.get(at).copied().filter(|i| key(*i) == (parent, name))
    }

    pub(super) fn children(&self, parent: u32) -> impl Iterator<Item = u32> {
        let first = self.prim(parent).first_child;
        let is_some = |number: &u32| *number != NO_PRIM;
        std::iter::successors(Some(first).filter(is_some), move |i| Some(self.prim(*i).next).filter(is_some))
    }

    /// The prim with an absolute path.
    pub(super) fn find(&self, path: &str) -> Option<u32> {
        let names = path.strip_prefix('/')?.split('/').filter(|name| !name.is_empty());
        names.into_iter().try_fold(0, |parent, name| self.child(parent, name))
    }

    /// The location of an offset in a text, or of an index in a binary file.
    pub(super) fn place(&self, at: u32) -> FileLocation {
        match self.tables {
            Some(_) => FileLocation::Row { list: "spec", row: u64::from(at) },
            None => FileLocation::Line(self.lines.line_at(&self.bytes, at as usize)),
        }
    }

    /// The beginning of messages about this file: its name, unless it is the first file.
    pub(super) fn prefix(&self) -> String {
        if self.path.is_empty() { String::new() } else { format!("{}: ", self.path) }
    }
}

/// The error for a tree that is too deep.
pub(super) fn too_deep(depth: usize, place: FileLocation) -> ReadError {
    let message = format!("prims or values are nested deeper than the limit of {}", grouped(depth as u64));
    ReadError::new("too-deep", place, message)
}
