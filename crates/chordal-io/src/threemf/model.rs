//! `ModelDocument`: the objects, properties and items of one model part.
use super::meshes::{ModelMesh, NOTHING, index, needed_index};
use super::namespace::{ModelElements, ModelNamespace};
use super::package::part_name;
use super::properties::{PropertyGroup, PropertyReader, WHITE, color};
use crate::assemble::{RawMesh, mesh, too_many_rows};
use crate::grow::{push, push_large, reserve_large};
use crate::text::{LineTokens, finite, show};
use crate::warnings::Warnings;
use crate::xml_elements::{XmlElement, XmlElements, XmlStep};
use crate::{FileLocation, Limits, Part, ReadError};
use serde_json::Value;
use std::collections::BTreeMap;

/// The content of an object.
#[derive(Clone, Copy, Debug)]
pub(super) enum ObjectShape {
    /// The index of the scene's part for its mesh.
    Mesh(usize),
    /// A run of the document's references.
    Components { first: usize, n: usize },
}

/// An object of a model.
#[derive(Clone, Debug)]
pub(super) struct ModelObject {
    /// Empty for a mesh; its part has the name.
    pub name: String,
    pub shape: ObjectShape,
}

/// A component or an item: an instance of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectReference {
    /// The index of the model part with the object, in the reader's list.
    pub document: u32,
    pub object: u32,
    /// Index of the document's transforms, `NOTHING` for the identity.
    pub transform: u32,
    pub line: u32,
}

/// One model part.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelDocument {
    pub metres_per_unit: f64,
    pub objects: BTreeMap<u32, ModelObject>,
    pub components: Vec<ObjectReference>,
    pub items: Vec<ObjectReference>,
    /// Row by row, as in the file.
    pub transforms: Vec<[f64; 12]>,
    pub certificate: Option<Value>,
}

/// The data shared by the documents of a package.
#[derive(Debug, Default)]
pub(super) struct ModelSet {
    /// The names of the model parts, the root first, in reading order.
    pub documents: Vec<String>,
    /// The location of the first reference to each.
    pub places: Vec<FileLocation>,
    /// The indices of those names.
    numbers: BTreeMap<String, u32>,
    pub parts: Vec<Part>,
    /// The names of all materials.
    pub materials: Vec<String>,
    pub warnings: Warnings,
}

impl ModelSet {
    /// The index of a document. A new one is added to the list and read later.
    pub(super) fn document(&mut self, name: &str, place: FileLocation) -> u32 {
        let key = name.to_ascii_lowercase();
        if let Some(known) = self.numbers.get(&key) {
            return *known;
        }
        let number = self.documents.len() as u32;
        self.numbers.insert(key, number);
        self.documents.push(name.to_owned());
        self.places.push(place);
        number
    }
}

/// The units of 3MF, in metres.
pub(super) const UNITS: [(&str, f64); 6] = [
    // Defined by the 3MF core specification, 3.4; inch and foot are the international ones of 1959.
    ("micron", 0.000_001),
    ("centimeter", 0.01),
    ("millimeter", 0.001),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("meter", 1.0),
];
/// The default unit of a file.
pub(super) const DEFAULT_UNIT: &str = "millimeter";

/// The meaning of an open element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OpenElement {
    Model,
    Certificate,
    Resources,
    Group(GroupKind),
    Object,
    Mesh,
    Vertices,
    Triangles,
    Components,
    Build,
    Skipped,
}

/// The kind of a property group, by the element of its properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GroupKind {
    Materials,
    Colors,
    Skipped(&'static str),
}

/// An object while it is read.
struct ObjectDraft {
    id: u32,
    name: String,
    group: u32,
    property: u32,
    mesh: Option<ModelMesh>,
    components: Option<usize>,
}

/// Reads one model part.
pub(super) struct ModelReader<'a, 's> {
    elements: ModelElements<'a>,
    /// The name of the part, and its index.
    part: &'a str,
    number: u32,
    limits: &'a Limits,
    set: &'s mut ModelSet,
    document: ModelDocument,
    groups: BTreeMap<u32, PropertyGroup>,
    /// The meshes, in the order of the file, with the names of their objects.
    meshes: Vec<(ModelMesh, String)>,
    object: Option<ObjectDraft>,
    group: Option<(u32, PropertyGroup)>,
    certificate: String,
}

impl<'a, 's> ModelReader<'a, 's> {
    pub(super) fn new(
        text: &'a str,
        number: u32,
        part: &'a str,
        limits: &'a Limits,
        set: &'s mut ModelSet,
    ) -> Self {
        Self {
            elements: XmlElements::new(text, part, limits),
            part,
            number,
            limits,
            set,
            document: ModelDocument::default(),
            groups: BTreeMap::new(),
            meshes: Vec::new(),
            object: None,
            group: None,
            certificate: String::new(),
        }
    }

    /// Reads the whole part; its meshes become parts of the scene.
    ///
    /// # Errors
    /// With the line and the column, and the name of the part.
    pub(super) fn read(mut self) -> Result<ModelDocument, ReadError> {
        let mut open = Vec::new();
        while let Some(step) = self.elements.next()? {
            match step {
                XmlStep::Start(element) => {
                    let meaning = self.start(open.last().copied(), element)?;
                    open.push(meaning);
                }
                XmlStep::Text(text) if open.last() == Some(&OpenElement::Certificate) => {
                    self.certificate.push_str(&text);
                }
                XmlStep::Text(_) => {}
                XmlStep::End => {
                    if let Some(meaning) = open.pop() {
                        self.finish(meaning)?;
                    }
                }
            }
        }
        self.assemble()?;
        Ok(self.document)
    }

    fn start(
        &mut self,
        parent: Option<OpenElement>,
        element: XmlElement<'_, ModelNamespace>,
    ) -> Result<OpenElement, ReadError> {
        use ModelNamespace as Ns;
        let XmlElement { namespace, local } = element;
        let Some(parent) = parent else {
            if (namespace, local) != (Ns::Core, "model") {
                let message = format!("the root is {}, not the 'model' of 3MF", show(local.as_bytes()));
                return Err(self.elements.error("not-3mf", message));
            }
            return self.model();
        };
        match (parent, namespace, local) {
            (OpenElement::Skipped | OpenElement::Certificate, ..) => Ok(OpenElement::Skipped),
            (OpenElement::Model, Ns::Core, "metadata") => Ok(self.metadata()),
            (OpenElement::Model, Ns::Core, "resources") => Ok(OpenElement::Resources),
            (OpenElement::Model, Ns::Core, "build") => Ok(OpenElement::Build),
            (OpenElement::Resources, Ns::Core, "object") => self.object(),
            (OpenElement::Resources, Ns::Core, "basematerials") => self.group(GroupKind::Materials),
            (OpenElement::Resources, Ns::Materials, "colorgroup") => self.group(GroupKind::Colors),
            (OpenElement::Resources, Ns::Materials, "texture2dgroup") => {
                self.group(GroupKind::Skipped("tex2coord"))
            }
            (OpenElement::Resources, Ns::Materials, "compositematerials") => {
                self.group(GroupKind::Skipped("composite"))
            }
            (OpenElement::Resources, Ns::Materials, "multiproperties") => {
                self.group(GroupKind::Skipped("multi"))
            }
            (OpenElement::Resources, Ns::Materials, "texture2d") => {
                Ok(self.skip("textures-skipped", element))
            }
            (OpenElement::Group(kind), ..) => self.property(kind, element),
            (OpenElement::Object, Ns::Core, "mesh") => self.mesh(),
            (OpenElement::Object, Ns::Core, "components") => self.components(),
            (OpenElement::Object, Ns::Core, "metadatagroup") => Ok(OpenElement::Skipped),
            (OpenElement::Object, Ns::Boolean | Ns::Displacement | Ns::Volumetric, _) => {
                let message = format!(
                    "the object is made of {}, an element of the {} extension, which is not read",
                    show(local.as_bytes()),
                    namespace.title()
                );
                Err(self.elements.error("unsupported-extension", message))
            }
            (OpenElement::Mesh, Ns::Core, "vertices") => Ok(OpenElement::Vertices),
            (OpenElement::Mesh, Ns::Core, "triangles") => Ok(OpenElement::Triangles),
            (OpenElement::Mesh, Ns::BeamLattice, "beamlattice") => {
                Ok(self.skip("beam-lattice-skipped", element))
            }
            (OpenElement::Resources, Ns::Slice, "slicestack") => Ok(self.skip("slices-skipped", element)),
            (OpenElement::Vertices, Ns::Core, "vertex") => {
                let Self { object, elements, limits, .. } = self;
                if let Some(mesh) = object.as_mut().and_then(|object| object.mesh.as_mut()) {
                    mesh.push_vertex(elements, limits)?;
                }
                Ok(OpenElement::Skipped)
            }
            (OpenElement::Triangles, Ns::Core, "triangle") => {
                let Self { object, elements, limits, .. } = self;
                if let Some(mesh) = object.as_mut().and_then(|object| object.mesh.as_mut()) {
                    mesh.push_triangle(elements, limits)?;
                }
                Ok(OpenElement::Skipped)
            }
            (OpenElement::Components, Ns::Core, "component") => {
                let reference = self.reference()?;
                push(&mut self.document.components, reference)?;
                Ok(OpenElement::Skipped)
            }
            (OpenElement::Build, Ns::Core, "item") => {
                let reference = self.reference()?;
                push(&mut self.document.items, reference)?;
                Ok(OpenElement::Skipped)
            }
            _ => Ok(self.skip("elements-skipped", element)),
        }
    }

    /// Counts an element that is skipped with its content.
    fn skip(&mut self, code: &'static str, element: XmlElement<'_, ModelNamespace>) -> OpenElement {
        let Self { elements, set, part, .. } = self;
        set.warnings.count(code, || {
            let name = show(element.local.as_bytes());
            let message = match code {
                "beam-lattice-skipped" => {
                    "beam lattices were not read, only the triangles beside them".to_owned()
                }
                "slices-skipped" => "slices were not read, only triangles".to_owned(),
                "textures-skipped" => "textures were not kept".to_owned(),
                _ => format!(
                    "elements of the {} namespace were skipped, {name} first",
                    element.namespace.title()
                ),
            };
            (elements.place(), format!("{part}: {message}"))
        });
        OpenElement::Skipped
    }

    fn model(&mut self) -> Result<OpenElement, ReadError> {
        let unit = self.elements.get("unit").unwrap_or(DEFAULT_UNIT);
        let Some((_, metres)) = UNITS.iter().find(|(name, _)| *name == unit) else {
            let names = UNITS.map(|(name, _)| name).join(", ");
            let message = format!("the unit {} is none of {names}", show(unit.as_bytes()));
            return Err(self.elements.error("unknown-unit", message));
        };
        self.document.metres_per_unit = *metres;
        for prefix in self.elements.get("requiredextensions").unwrap_or("").split_ascii_whitespace() {
            let namespace = self.elements.namespace_of(prefix).unwrap_or(ModelNamespace::Unknown);
            if !namespace.is_read() {
                let message = format!(
                    "the extension {} ({}) is required and not read",
                    show(prefix.as_bytes()),
                    namespace.title()
                );
                return Err(self.elements.error("unsupported-extension", message));
            }
        }
        Ok(OpenElement::Model)
    }

    /// Metadata does not affect the shape; the certificate is in an entry of it.
    fn metadata(&self) -> OpenElement {
        let name = self.elements.get("name").unwrap_or("");
        let is_certificate = name.split_once(':').is_some_and(|(prefix, local)| {
            let namespace = self.elements.namespace_of(prefix);
            local == super::CERTIFICATE && namespace == Some(ModelNamespace::Certificate)
        });
        if is_certificate { OpenElement::Certificate } else { OpenElement::Skipped }
    }

    /// The id of a new resource.
    fn resource(&self) -> Result<u32, ReadError> {
        let id = needed_index(&self.elements, "id")?;
        if self.document.objects.contains_key(&id) || self.groups.contains_key(&id) {
            return Err(self.elements.error("duplicate-id", format_args!("two resources have the id {id}")));
        }
        let n = self.document.objects.len() + self.groups.len();
        if n as u64 >= self.limits.rows {
            return Err(too_many_rows(self.elements.place(), "resources", n as u64 + 1, self.limits.rows));
        }
        Ok(id)
    }

    fn group(&mut self, kind: GroupKind) -> Result<OpenElement, ReadError> {
        let id = self.resource()?;
        let group = match kind {
            GroupKind::Materials => {
                PropertyGroup::Materials { first: self.set.materials.len() as u32, colors: Vec::new() }
            }
            GroupKind::Colors => PropertyGroup::Colors(Vec::new()),
            GroupKind::Skipped(_) => PropertyGroup::Skipped(0),
        };
        if let GroupKind::Skipped(what) = kind {
            let Self { elements, set, part, .. } = self;
            set.warnings.count("properties-skipped", || {
                let message = "textures, composites and multiple properties of triangles were not kept";
                (elements.place(), format!("{part}: {message}: a group of '{what}'"))
            });
        }
        self.group = Some((id, group));
        Ok(OpenElement::Group(kind))
    }

    fn property(
        &mut self,
        kind: GroupKind,
        element: XmlElement<'_, ModelNamespace>,
    ) -> Result<OpenElement, ReadError> {
        let (namespace, local, value) = match kind {
            GroupKind::Materials => (ModelNamespace::Core, "base", "displaycolor"),
            GroupKind::Colors => (ModelNamespace::Materials, "color", "color"),
            GroupKind::Skipped(local) => (ModelNamespace::Materials, local, ""),
        };
        if (element.namespace, element.local) != (namespace, local) {
            return Ok(self.skip("elements-skipped", element));
        }
        let Some((_, group)) = &mut self.group else { return Ok(OpenElement::Skipped) };
        if let PropertyGroup::Skipped(n) = group {
            *n = n.saturating_add(1);
            return Ok(OpenElement::Skipped);
        }
        let Self { elements, set, part, .. } = self;
        let text = elements.get(value).unwrap_or_default();
        let color = color(text).unwrap_or_else(|| {
            set.warnings.count("not-a-color", || {
                let text = show(text.as_bytes());
                let message =
                    format!("{part}: {text} is no colour as in #RRGGBB or #RRGGBBAA: white was taken");
                (elements.place(), message)
            });
            WHITE
        });
        match group {
            PropertyGroup::Materials { colors, .. } => {
                push(&mut self.set.materials, self.elements.need("name")?.to_owned())?;
                push(colors, color)?;
            }
            PropertyGroup::Colors(colors) => push(colors, color)?,
            PropertyGroup::Skipped(_) => {}
        }
        Ok(OpenElement::Skipped)
    }

    fn object(&mut self) -> Result<OpenElement, ReadError> {
        let id = self.resource()?;
        let kind = self.elements.get("type").unwrap_or("model").to_owned();
        if matches!(&*kind, "support" | "solidsupport" | "other") {
            let Self { elements, set, part, .. } = &mut *self;
            set.warnings.count("object-types", || {
                let message = format!("objects of the type '{kind}' were read as parts like others");
                (elements.place(), format!("{part}: {message}"))
            });
        }
        let name = self.elements.get("name").unwrap_or("").to_owned();
        self.object = Some(ObjectDraft {
            id,
            name,
            group: index(&self.elements, "pid")?.unwrap_or(NOTHING),
            property: index(&self.elements, "pindex")?.unwrap_or(NOTHING),
            mesh: None,
            components: None,
        });
        Ok(OpenElement::Object)
    }

    /// Refuses a second mesh or list of components of an object.
    fn check_one_shape(&self) -> Result<(), ReadError> {
        let has = self.object.as_ref().is_some_and(|o| o.mesh.is_some() || o.components.is_some());
        if has {
            let message = "an object has more than one mesh or list of components";
            return Err(self.elements.error("two-shapes", message));
        }
        Ok(())
    }

    fn mesh(&mut self) -> Result<OpenElement, ReadError> {
        self.check_one_shape()?;
        if let Some(object) = &mut self.object {
            let (positions, faces, properties) = (Vec::new(), Vec::new(), Vec::new());
            let (group, property) = (object.group, object.property);
            object.mesh = Some(ModelMesh { id: object.id, group, property, positions, faces, properties });
        }
        Ok(OpenElement::Mesh)
    }

    fn components(&mut self) -> Result<OpenElement, ReadError> {
        self.check_one_shape()?;
        if let Some(object) = &mut self.object {
            object.components = Some(self.document.components.len());
        }
        Ok(OpenElement::Components)
    }

    fn reference(&mut self) -> Result<ObjectReference, ReadError> {
        let n = self.document.components.len() + self.document.items.len();
        if n as u64 >= self.limits.rows {
            let rows = n as u64 + 1;
            return Err(too_many_rows(self.elements.place(), "components and items", rows, self.limits.rows));
        }
        let object = needed_index(&self.elements, "objectid")?;
        let document = match self.elements.get_in(ModelNamespace::Production, "path") {
            None => self.number,
            Some(path) => {
                let name = part_name(self.part, path).map_err(|what| {
                    let message = format!("the path {} {what}", show(path.as_bytes()));
                    self.elements.error("external-link", message)
                })?;
                self.set.document(&name, self.elements.place())
            }
        };
        let transform = match self.elements.get("transform") {
            None => NOTHING,
            Some(text) => {
                let transform = self.transform(text)?;
                push(&mut self.document.transforms, transform)?;
                self.document.transforms.len() as u32 - 1
            }
        };
        Ok(ObjectReference { document, object, transform, line: self.elements.line() })
    }

    fn transform(&self, text: &str) -> Result<[f64; 12], ReadError> {
        let mut transform = [0.0; 12];
        let mut tokens = LineTokens::new(text.as_bytes());
        for value in &mut transform {
            let token = tokens.next().unwrap_or(b"");
            *value = finite(token, || self.elements.place()).map_err(|error| {
                let message = format!("a transform has 12 numbers: {}", &*error.message);
                self.elements.error(error.code, message)
            })?;
        }
        if let Some(extra) = tokens.next() {
            let message = format!("a transform has 12 numbers, and then {}", show(extra));
            return Err(self.elements.error("wrong-width", message));
        }
        Ok(transform)
    }

    fn finish(&mut self, meaning: OpenElement) -> Result<(), ReadError> {
        match meaning {
            OpenElement::Group(_) => {
                if let Some((id, group)) = self.group.take() {
                    self.groups.insert(id, group);
                }
            }
            OpenElement::Object => {
                if let Some(object) = self.object.take() {
                    self.finish_object(object)?;
                }
            }
            OpenElement::Certificate => self.finish_certificate(),
            _ => {}
        }
        Ok(())
    }

    fn finish_object(&mut self, object: ObjectDraft) -> Result<(), ReadError> {
        let ObjectDraft { id, name, mesh, components, .. } = object;
        let n_before = self.set.parts.len();
        let object = match (mesh, components) {
            (Some(mesh), _) => {
                let shape = ObjectShape::Mesh(n_before + self.meshes.len());
                push_large(&mut self.meshes, (mesh, name))?;
                ModelObject { name: String::new(), shape }
            }
            (None, Some(first)) => {
                let n = self.document.components.len() - first;
                ModelObject { name, shape: ObjectShape::Components { first, n } }
            }
            (None, None) => {
                let message = format!("object {id} has no mesh and no components");
                return Err(self.elements.error("empty-object", message));
            }
        };
        self.document.objects.insert(id, object);
        Ok(())
    }

    fn finish_certificate(&mut self) {
        let text = std::mem::take(&mut self.certificate);
        match serde_json::from_str(&text) {
            Ok(value) => self.document.certificate = Some(value),
            Err(why) => {
                let Self { elements, set, part, .. } = self;
                set.warnings.count("certificate-unreadable", || {
                    let message = format!("{part}: the certificate is unreadable and was skipped: {why}");
                    (elements.place(), message)
                });
            }
        }
    }

    /// Converts the meshes to parts, once all groups are known.
    fn assemble(&mut self) -> Result<(), ReadError> {
        reserve_large(&mut self.set.parts, self.meshes.len())?;
        for (model_mesh, name) in std::mem::take(&mut self.meshes) {
            let mut properties =
                PropertyReader { groups: &self.groups, part: self.part, warnings: &mut self.set.warnings };
            let attributes = properties.attributes(&model_mesh)?;
            let ModelMesh { positions, faces, .. } = model_mesh;
            let raw = RawMesh { positions, position_id: None, faces, attributes };
            let mesh = mesh(raw, self.limits, &mut self.set.warnings)?;
            self.set.parts.push(Part { name, mesh, indexed: true, ..Part::default() });
        }
        Ok(())
    }
}
