//! `AmfDocument`: the objects, materials and constellations of an AMF file.
use super::object::{AmfColor, AmfMaterial, AmfNames, AmfObject, AmfVolume};
use crate::assemble::too_many_rows;
use crate::grow::{push, push_large};
use crate::text::{IntegerError, grouped, integer, not_finite, number, number_error, show, trim};
use crate::warnings::Warnings;
use crate::xml_elements::{AnyNamespace, XmlElements, XmlStep};
use crate::{Limits, ReadError};
use std::collections::BTreeMap;

/// The units of AMF, in metres.
const UNITS: [(&str, f64); 8] = [
    // Defined by ISO/ASTM 52915, 5.1; inch and foot are the international ones of 1959. Some programs write
    // synonyms.
    ("millimeter", 0.001),
    ("inch", 0.0254),
    ("feet", 0.3048),
    ("foot", 0.3048),
    ("meter", 1.0),
    ("micrometer", 0.000_001),
    ("micron", 0.000_001),
    ("centimeter", 0.01),
];

/// An instance of an object or a constellation in a constellation.
#[derive(Clone, Debug, Default)]
pub(super) struct AmfInstance {
    pub target: String,
    pub shift: [f64; 3],
    /// Rotations about x, then y, then z, in degrees.
    pub turns_deg: [f64; 3],
    pub line: u32,
}

/// A constellation.
#[derive(Clone, Debug, Default)]
pub(super) struct AmfConstellation {
    pub name: String,
    pub instances: Vec<AmfInstance>,
}

/// The target of an id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AmfTarget {
    Object(usize),
    Constellation(usize),
}

/// The content of a file.
#[derive(Debug, Default)]
pub(super) struct AmfDocument {
    pub metres_per_unit: f64,
    pub objects: Vec<AmfObject>,
    pub constellations: Vec<AmfConstellation>,
    pub targets: BTreeMap<String, AmfTarget>,
    pub names: AmfNames,
    /// The names of materials by number, from 1.
    pub material_names: Vec<String>,
}

/// The meaning of an open element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AmfElement {
    File,
    Object,
    Mesh,
    Vertices,
    Vertex,
    Coordinates,
    Volume,
    Triangle,
    Material,
    Constellation,
    Instance,
    Color,
    /// A name in the metadata.
    Name,
    /// A number: of a vertex, a triangle, a colour or an instance.
    Value(usize),
    Skipped,
}

/// Reads a document.
pub(super) struct AmfReader<'a, 'w> {
    elements: XmlElements<'a, AnyNamespace>,
    limits: &'a Limits,
    warnings: &'w mut Warnings,
    document: AmfDocument,
    open: Vec<AmfElement>,
    text: String,
    numbers: [f64; 6],
    /// Which of the values were present.
    has: [bool; 6],
    corners: [u32; 3],
    color: AmfColor,
    is_formula: bool,
    face_color: Option<AmfColor>,
    material: Option<(String, String, Option<AmfColor>)>,
}

impl<'a, 'w> AmfReader<'a, 'w> {
    pub(super) fn new(text: &'a str, part: &'a str, limits: &'a Limits, warnings: &'w mut Warnings) -> Self {
        Self {
            elements: XmlElements::new(text, part, limits),
            limits,
            warnings,
            document: AmfDocument::default(),
            open: Vec::new(),
            text: String::new(),
            numbers: [0.0; 6],
            has: [false; 6],
            corners: [u32::MAX; 3],
            color: [0.0; 4],
            is_formula: false,
            face_color: None,
            material: None,
        }
    }

    /// Reads all elements.
    ///
    /// # Errors
    /// With the line and the column.
    pub(super) fn read(mut self) -> Result<AmfDocument, ReadError> {
        while let Some(step) = self.elements.next()? {
            match step {
                XmlStep::Start(element) => {
                    let meaning = self.start(element.local)?;
                    self.text.clear();
                    self.open.push(meaning);
                }
                XmlStep::Text(text) => {
                    if matches!(self.open.last(), Some(AmfElement::Value(_) | AmfElement::Name)) {
                        self.text.push_str(&text);
                    }
                }
                XmlStep::End => {
                    if let Some(meaning) = self.open.pop() {
                        self.finish(meaning)?;
                    }
                }
            }
        }
        Ok(self.document)
    }

    fn start(&mut self, name: &str) -> Result<AmfElement, ReadError> {
        use AmfElement as Open;
        let Some(parent) = self.open.last().copied() else { return self.file(name) };
        let value = |names: &[&str]| names.iter().position(|known| *known == name).map(Open::Value);
        let element = match (parent, name) {
            // Whatever is in an element that is skipped, or that holds text alone, is skipped with
            // it.
            (Open::Skipped | Open::Name | Open::Value(_), _) => Some(Open::Skipped),
            (Open::File, "object") => Some(self.object()?),
            (Open::File, "material") => Some(self.material()?),
            (Open::File, "constellation") => Some(self.constellation()?),
            (Open::File, "texture") => Some(self.skip("textures-skipped", "textures were not kept")),
            (Open::Object, "mesh") => Some(Open::Mesh),
            (Open::Mesh, "vertices") => Some(Open::Vertices),
            (Open::Mesh, "volume") => Some(self.volume()?),
            (Open::Vertices, "vertex") => {
                // Which coordinates the element has given; a missing one is found when it ends.
                self.has = [false; 6];
                Some(Open::Vertex)
            }
            (Open::Vertices, "edge") | (Open::Vertex, "normal") => {
                let what = "triangles curved by normals or edges were read as flat: these were left out";
                Some(self.skip("curved-triangles", what))
            }
            (Open::Vertex, "coordinates") => Some(Open::Coordinates),
            (Open::Coordinates, _) => value(&["x", "y", "z"]),
            (Open::Volume, "triangle") => {
                (self.corners, self.face_color) = ([u32::MAX; 3], None);
                Some(Open::Triangle)
            }
            (Open::Triangle, "texmap" | "map") => {
                Some(self.skip("textures-skipped", "textures were not kept"))
            }
            (Open::Triangle, "v1" | "v2" | "v3") => value(&["v1", "v2", "v3"]),
            (Open::Object | Open::Vertex | Open::Volume | Open::Triangle | Open::Material, "color") => {
                (self.color, self.is_formula) = ([0.0, 0.0, 0.0, 1.0], false);
                Some(Open::Color)
            }
            (Open::Color, _) => value(&["r", "g", "b", "a"]),
            (Open::Material, "composite") => {
                Some(self.skip("composites-skipped", "mixtures of materials were not kept"))
            }
            (Open::Constellation, "instance") => Some(self.instance()?),
            (Open::Instance, _) => value(&["deltax", "deltay", "deltaz", "rx", "ry", "rz"]),
            (_, "metadata") => Some(self.metadata(parent)),
            _ => None,
        };
        Ok(match element {
            Some(element) => element,
            None => {
                let what = format!("elements were skipped, {} first", show(name.as_bytes()));
                self.skip("elements-skipped", &what)
            }
        })
    }

    /// Counts an element that is skipped with its content.
    fn skip(&mut self, code: &'static str, what: &str) -> AmfElement {
        let Self { elements, warnings, .. } = self;
        warnings.count(code, || (elements.place(), what.to_owned()));
        AmfElement::Skipped
    }

    /// Metadata is skipped, except names.
    fn metadata(&self, parent: AmfElement) -> AmfElement {
        use AmfElement as Open;
        let is_named = matches!(parent, Open::Object | Open::Volume | Open::Material | Open::Constellation);
        let is_name = self.elements.get("type").is_some_and(|kind| kind.eq_ignore_ascii_case("name"));
        if is_named && is_name { Open::Name } else { Open::Skipped }
    }

    fn file(&mut self, name: &str) -> Result<AmfElement, ReadError> {
        if !name.eq_ignore_ascii_case("amf") {
            let message = format!("the root is {}, not the 'amf' of AMF", show(name.as_bytes()));
            return Err(self.elements.error("not-amf", message));
        }
        let unit = self.elements.get("unit").unwrap_or("millimeter");
        let Some((_, metres)) = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)) else {
            let names = UNITS.map(|(name, _)| name).join(", ");
            let message = format!("the unit {} is none of {names}", show(unit.as_bytes()));
            return Err(self.elements.error("unknown-unit", message));
        };
        self.document.metres_per_unit = *metres;
        Ok(AmfElement::File)
    }

    /// Registers an object or a constellation under its id.
    fn declare(&mut self, target: AmfTarget) -> Result<(), ReadError> {
        let id = self.elements.need("id")?.trim().to_owned();
        let n = self.document.targets.len() as u64;
        if n >= self.limits.rows {
            return Err(too_many_rows(self.elements.place(), "objects", n + 1, self.limits.rows));
        }
        if self.document.targets.contains_key(&id) {
            let message = format!("two objects or constellations have the id {}", show(id.as_bytes()));
            return Err(self.elements.error("duplicate-id", message));
        }
        self.document.targets.insert(id, target);
        Ok(())
    }

    fn object(&mut self) -> Result<AmfElement, ReadError> {
        self.declare(AmfTarget::Object(self.document.objects.len()))?;
        push_large(&mut self.document.objects, AmfObject::default())?;
        Ok(AmfElement::Object)
    }

    fn constellation(&mut self) -> Result<AmfElement, ReadError> {
        self.declare(AmfTarget::Constellation(self.document.constellations.len()))?;
        push_large(&mut self.document.constellations, AmfConstellation::default())?;
        Ok(AmfElement::Constellation)
    }

    fn instance(&mut self) -> Result<AmfElement, ReadError> {
        self.numbers = [0.0; 6];
        let target = self.elements.need("objectid")?.trim().to_owned();
        let line = self.elements.line();
        if let Some(constellation) = self.document.constellations.last_mut() {
            push(&mut constellation.instances, AmfInstance { target, line, ..AmfInstance::default() })?;
        }
        Ok(AmfElement::Instance)
    }

    fn material(&mut self) -> Result<AmfElement, ReadError> {
        let id = self.elements.need("id")?.trim().to_owned();
        if self.document.names.materials.contains_key(&id) {
            let message = format!("two materials have the id {}", show(id.as_bytes()));
            return Err(self.elements.error("duplicate-id", message));
        }
        self.material = Some((id, String::new(), None));
        Ok(AmfElement::Material)
    }

    fn volume(&mut self) -> Result<AmfElement, ReadError> {
        // Material 0 means no material.
        let material = self.elements.get("materialid").map(str::trim).filter(|id| !id.is_empty());
        let material = material.filter(|id| *id != "0").map(str::to_owned);
        let kind = self.elements.get("type").unwrap_or("object");
        if !kind.eq_ignore_ascii_case("object") {
            let message = format!("volumes of the type {} were read like others", show(kind.as_bytes()));
            self.warnings.count("object-types", || (self.elements.place(), message));
        }
        let line = self.elements.line();
        if let Some(object) = self.document.objects.last_mut() {
            let first = object.faces.len();
            push_large(&mut object.volumes, AmfVolume { first, material, line, ..AmfVolume::default() })?;
        }
        Ok(AmfElement::Volume)
    }

    fn finish(&mut self, meaning: AmfElement) -> Result<(), ReadError> {
        match meaning {
            AmfElement::Value(k) => self.value(k),
            AmfElement::Vertex => self.vertex(),
            AmfElement::Triangle => self.triangle(),
            AmfElement::Color => self.finish_color(),
            AmfElement::Name => {
                self.name();
                Ok(())
            }
            AmfElement::Instance => {
                let instances =
                    self.document.constellations.last_mut().map(|constellation| &mut constellation.instances);
                if let Some(instance) = instances.and_then(|list| list.last_mut()) {
                    let [x, y, z, rx, ry, rz] = self.numbers;
                    (instance.shift, instance.turns_deg) = ([x, y, z], [rx, ry, rz]);
                }
                Ok(())
            }
            AmfElement::Material => self.finish_material(),
            _ => Ok(()),
        }
    }

    fn finish_material(&mut self) -> Result<(), ReadError> {
        let Some((id, name, color)) = self.material.take() else { return Ok(()) };
        let name = if name.is_empty() { id.clone() } else { name };
        push(&mut self.document.material_names, name)?;
        let number = self.document.material_names.len() as u32;
        self.document.names.materials.insert(id, AmfMaterial { number, color });
        Ok(())
    }

    fn name(&mut self) {
        let name = self.text.trim().to_owned();
        match self.open.last() {
            Some(AmfElement::Object) => {
                self.document.objects.last_mut().into_iter().for_each(|object| object.name.clone_from(&name));
            }
            Some(AmfElement::Volume) => {
                let volumes = self.document.objects.last_mut().map(|object| &mut object.volumes);
                if let Some(volume) = volumes.and_then(|list| list.last_mut()) {
                    volume.name = name;
                }
            }
            Some(AmfElement::Material) => self.material.iter_mut().for_each(|m| m.1.clone_from(&name)),
            Some(AmfElement::Constellation) => {
                self.document.constellations.last_mut().into_iter().for_each(|c| c.name.clone_from(&name));
            }
            _ => {}
        }
    }

    /// The number in an element, interpreted by the parent.
    fn value(&mut self, k: usize) -> Result<(), ReadError> {
        let token = trim(self.text.as_bytes());
        match self.open.last() {
            Some(AmfElement::Triangle) => {
                let n = self.document.objects.last().map_or(0, |object| object.positions.len());
                match integer(token) {
                    Ok(index) if index >= 0 && (index as u64) < n as u64 => self.corners[k] = index as u32,
                    Err(IntegerError::Spelling) => {
                        let message = format!("{} is not a whole number", show(token));
                        return Err(self.elements.error("not-a-number", message));
                    }
                    _ => {
                        let n = grouped(n as u64);
                        let message =
                            format!("index {} is out of range: there are {n} vertices, from 0", show(token));
                        return Err(self.elements.error("index-out-of-range", message));
                    }
                }
            }
            Some(AmfElement::Color) => match number(token).filter(|value| value.is_finite()) {
                Some(value) => self.color[k] = value,
                // AMF permits formulas in x, y and z as channels of a colour.
                None => self.is_formula = true,
            },
            parent => {
                let may_drop = parent == Some(&AmfElement::Coordinates) && self.limits.drop_nonfinite;
                self.has[k] = true;
                self.numbers[k] = match number(token) {
                    Some(value) if value.is_finite() || may_drop => value,
                    Some(_) => {
                        let error = not_finite(token, self.elements.place());
                        return Err(self.elements.error(error.code, &*error.message));
                    }
                    None => return Err(self.elements.error("not-a-number", number_error(token))),
                };
            }
        }
        Ok(())
    }

    fn vertex(&mut self) -> Result<(), ReadError> {
        let [x, y, z, ..] = self.numbers;
        if !self.has[..3].iter().all(|has| *has) {
            return Err(self.elements.error("missing-value", "the vertex has no coordinates x, y and z"));
        }
        let Some(object) = self.document.objects.last_mut() else { return Ok(()) };
        let rows = object.positions.len() as u64 + 1;
        let most = self.limits.rows.min(u64::from(u32::MAX - 1));
        if rows > most {
            return Err(too_many_rows(self.elements.place(), "vertices of an object", rows, most));
        }
        push(&mut object.positions, [x, y, z])
    }

    fn triangle(&mut self) -> Result<(), ReadError> {
        if self.corners.contains(&u32::MAX) {
            return Err(self.elements.error("missing-value", "the triangle has no corners v1, v2 and v3"));
        }
        let Some(object) = self.document.objects.last_mut() else { return Ok(()) };
        let rows = object.faces.len() as u64 + 1;
        // Half-edges are counted in 31 bits.
        let most = self.limits.rows.min(u64::from(u32::MAX / 6));
        if rows > most {
            return Err(too_many_rows(self.elements.place(), "triangles of an object", rows, most));
        }
        if let Some(color) = self.face_color {
            object.face_colors.set(object.faces.len(), color)?;
        }
        push(&mut object.faces, self.corners)
    }

    /// Assigns a colour to the element that contains it.
    fn finish_color(&mut self) -> Result<(), ReadError> {
        let Self { elements, warnings, color, .. } = self;
        if self.is_formula {
            let message = "colours by formulas were not kept";
            warnings.count("color-formula", || (elements.place(), message.to_owned()));
            return Ok(());
        }
        if color.iter().any(|x| !(0.0..=1.0).contains(x)) {
            let message = "channels of colours beyond 0 to 1 were cut to it";
            warnings.count("color-out-of-range", || (elements.place(), message.to_owned()));
            *color = color.map(|x| x.clamp(0.0, 1.0));
        }
        let color = *color;
        let object = self.document.objects.last_mut();
        match (self.open.last(), object) {
            (Some(AmfElement::Material), _) => {
                self.material.iter_mut().for_each(|material| material.2 = Some(color));
            }
            (Some(AmfElement::Object), Some(object)) => object.color = Some(color),
            (Some(AmfElement::Vertex), Some(object)) => {
                object.vertex_colors.set(object.positions.len(), color)?;
            }
            (Some(AmfElement::Volume), Some(object)) => {
                object.volumes.last_mut().into_iter().for_each(|volume| volume.color = Some(color));
            }
            (Some(AmfElement::Triangle), _) => self.face_color = Some(color),
            _ => {}
        }
        Ok(())
    }
}
