//! `ColladaReader`: visits the elements of a COLLADA file.
use super::document::{ColladaDocument, ColladaInstance, ColladaNode, InstanceKind, UpAxis};
use super::elements::{ColladaElement, LeftOut, is_grouping, left_out};
use super::geometry::{ColladaGeometry, ColladaSource};
use super::looks::{ColladaEffect, ColladaMaterial};
use super::primitives::{
    ColladaPrimitive, MOST_INPUTS, PrimitiveInput, PrimitiveKind, PrimitiveScope, local,
};
use super::transform::TransformKind;
use crate::grow::{push, push_large, with_room};
use crate::matrix::{IDENTITY, product};
use crate::text::{LineTokens, integer, is_space, number, number_error, show};
use crate::warnings::Warnings;
use crate::xml_elements::{AnyNamespace, XmlElements, XmlStep};
use crate::xml_text::place;
use crate::{Limits, ReadError};
use chordal::explicit::Semantic;
use std::borrow::Cow;

/// An open element, and whether it takes its meaning from its parent.
#[derive(Clone, Copy, Debug)]
struct OpenEntry {
    meaning: ColladaElement,
    is_own: bool,
}

/// Reads a document.
pub(super) struct ColladaReader<'a, 'w> {
    text: &'a str,
    elements: XmlElements<'a, AnyNamespace>,
    limits: &'a Limits,
    warnings: &'w mut Warnings,
    document: ColladaDocument,
    open: Vec<OpenEntry>,
    /// The text of the element, and the byte at which it starts.
    content: Cow<'a, str>,
    content_at: usize,
    /// The id of the open image, effect or controller, and that of its parameter.
    id: String,
    parameter: String,
    source: ColladaSource,
    source_id: String,
    primitive: Option<ColladaPrimitive<'a>>,
    open_nodes: Vec<usize>,
}

impl<'a, 'w> ColladaReader<'a, 'w> {
    pub(super) fn new(text: &'a str, limits: &'a Limits, warnings: &'w mut Warnings) -> Self {
        Self {
            text,
            elements: XmlElements::new(text, "", limits),
            limits,
            warnings,
            document: ColladaDocument { metres_per_unit: 1.0, ..ColladaDocument::default() },
            open: Vec::new(),
            content: Cow::Borrowed(""),
            content_at: 0,
            id: String::new(),
            parameter: String::new(),
            source: ColladaSource::default(),
            source_id: String::new(),
            primitive: None,
            open_nodes: Vec::new(),
        }
    }

    /// Reads all elements.
    ///
    /// # Errors
    /// With the line and the column.
    pub(super) fn read(mut self) -> Result<ColladaDocument, ReadError> {
        while let Some(step) = self.elements.next()? {
            match step {
                XmlStep::Start(element) => {
                    let entry = self.start(element.local)?;
                    self.content = Cow::Borrowed("");
                    self.open.push(entry);
                }
                XmlStep::Text(text) => self.text(text),
                XmlStep::End => {
                    if let Some(OpenEntry { meaning, is_own: true }) = self.open.pop() {
                        self.finish(meaning)?;
                    }
                }
            }
        }
        Ok(self.document)
    }

    fn text(&mut self, more: Cow<'a, str>) {
        if more.bytes().all(is_space) {
            return;
        }
        if self.content.is_empty() {
            (self.content, self.content_at) = (more, self.elements.offset());
        } else {
            self.content.to_mut().push_str(&more);
        }
    }

    fn attribute(&self, name: &str) -> String {
        self.elements.get(name).unwrap_or("").to_owned()
    }

    /// The id in a URL attribute with a '#', or empty.
    fn reference(&self, name: &str) -> String {
        self.elements.get(name).and_then(local).unwrap_or("").to_owned()
    }

    fn start(&mut self, name: &str) -> Result<OpenEntry, ReadError> {
        let own_entry = |meaning| Ok(OpenEntry { meaning, is_own: true });
        let Some(parent) = self.open.last().map(|entry| entry.meaning) else {
            if name != "COLLADA" {
                let message = format!("the root is {}, not 'COLLADA'", show(name.as_bytes()));
                return Err(self.elements.error("not-collada", message));
            }
            return own_entry(ColladaElement::File);
        };
        if parent == ColladaElement::Skipped {
            return own_entry(ColladaElement::Skipped);
        }
        // An element that only groups others takes the meaning of its parent, so that both forms of
        // a file are read alike.
        if is_grouping(parent, name) {
            if parent == ColladaElement::Controller {
                self.controller();
            }
            return Ok(OpenEntry { meaning: parent, is_own: false });
        }
        let meaning = match parent {
            ColladaElement::Image | ColladaElement::Effect | ColladaElement::Parameter => {
                self.look(parent, name)
            }
            ColladaElement::Diffuse | ColladaElement::Material => self.look(parent, name),
            ColladaElement::VisualScene | ColladaElement::LibraryNodes => self.place(parent, name)?,
            ColladaElement::Node | ColladaElement::Instance => self.place(parent, name)?,
            ColladaElement::File | ColladaElement::Asset => self.top(parent, name)?,
            _ => self.mesh(parent, name)?,
        };
        own_entry(meaning.unwrap_or_else(|| self.skip(parent, name)))
    }

    /// An element at the top level of the file.
    fn top(&mut self, parent: ColladaElement, name: &str) -> Result<Option<ColladaElement>, ReadError> {
        use ColladaElement as Open;
        Ok(Some(match (parent, name) {
            (Open::File, "asset") => Open::Asset,
            (Open::Asset, "up_axis") => Open::UpAxis,
            (Open::Asset, "unit") => {
                self.unit()?;
                Open::Skipped
            }
            (Open::File, "image") => {
                self.id = self.attribute("id");
                Open::Image
            }
            (Open::File, "effect") => {
                self.id = self.attribute("id");
                self.document.looks.effects.insert(self.id.clone(), ColladaEffect::default());
                Open::Effect
            }
            (Open::File, "material") => {
                let (id, name) = (self.attribute("id"), self.attribute("name"));
                let material = ColladaMaterial { id, name, effect: String::new() };
                push_large(&mut self.document.looks.materials, material)?;
                Open::Material
            }
            (Open::File, "geometry") => self.geometry()?,
            (Open::File, "controller") => {
                self.id = self.attribute("id");
                Open::Controller
            }
            (Open::File, "library_nodes") => Open::LibraryNodes,
            (Open::File, "visual_scene") => {
                let id = self.attribute("id");
                push(&mut self.document.scenes, (id, Vec::new()))?;
                Open::VisualScene
            }
            (Open::File, "instance_visual_scene") => {
                self.document.shown = Some(self.reference("url"));
                Open::Shown
            }
            _ => return Ok(None),
        }))
    }

    /// An element of an image, an effect or a material.
    fn look(&mut self, parent: ColladaElement, name: &str) -> Option<ColladaElement> {
        use ColladaElement as Open;
        Some(match (parent, name) {
            (Open::Image, "init_from") => Open::ImagePath,
            (Open::Effect, "newparam") => {
                self.parameter = self.attribute("sid");
                Open::Parameter
            }
            (Open::Parameter, "init_from" | "source") => Open::ParameterValue,
            (Open::Parameter, "instance_image") => {
                let target = self.reference("url");
                self.set_parameter(target);
                Open::Skipped
            }
            // The filtering and wrapping of pictures.
            (Open::Parameter, "format" | "minfilter" | "magfilter" | "mipfilter" | "wrap_s" | "wrap_t") => {
                Open::Skipped
            }
            (Open::Effect, "diffuse") => Open::Diffuse,
            (Open::Diffuse, "color") => Open::DiffuseColor,
            (Open::Diffuse, "texture") => {
                let texture = self.attribute("texture");
                self.effect(|effect| effect.texture = Some(texture));
                Open::Skipped
            }
            (Open::Material, "instance_effect") => {
                let effect = self.reference("url");
                if let Some(material) = self.document.looks.materials.last_mut() {
                    material.effect = effect;
                }
                Open::Skipped
            }
            _ => return None,
        })
    }

    /// An element of a geometry or a controller.
    fn mesh(&mut self, parent: ColladaElement, name: &str) -> Result<Option<ColladaElement>, ReadError> {
        use ColladaElement as Open;
        Ok(Some(match (parent, name) {
            // The content of a controller is skipped with it.
            (Open::Controller, _) => Open::Skipped,
            (Open::Geometry, "mesh") => Open::Mesh,
            (Open::Mesh, "source") => {
                (self.source, self.source_id) = (ColladaSource::default(), self.attribute("id"));
                Open::Source
            }
            (Open::Source, "float_array") => Open::Floats,
            (Open::Source, "accessor") => {
                let size =
                    |n: Option<u64>, missing| n.map_or(missing, |n| usize::try_from(n).unwrap_or(usize::MAX));
                self.source.count = self.count("count")?.unwrap_or(0);
                self.source.offset = size(self.count("offset")?, 0);
                self.source.stride = size(self.count("stride")?, 1);
                Open::Accessor
            }
            (Open::Accessor, "param") => {
                self.source.width += 1;
                Open::Skipped
            }
            (Open::Mesh, "vertices") => {
                let id = self.attribute("id");
                if let Some(geometry) = self.document.geometries.last_mut() {
                    geometry.vertices_id = id;
                }
                Open::Vertices
            }
            (Open::Vertices, "input") => {
                self.vertices_input()?;
                Open::Skipped
            }
            (Open::Mesh, name) => match PrimitiveKind::from_element(name) {
                Some(kind) => {
                    let symbol = self.attribute("material");
                    let (inputs, counts, lists) = (Vec::new(), Cow::Borrowed(""), Vec::new());
                    self.primitive = Some(ColladaPrimitive { kind, symbol, inputs, counts, lists });
                    Open::Primitive
                }
                None => return Ok(None),
            },
            (Open::Primitive, "input") => {
                self.input()?;
                Open::Skipped
            }
            (Open::Primitive, "vcount") => Open::Counts,
            (Open::Primitive, "p") => Open::Indices,
            _ => return Ok(None),
        }))
    }

    /// An element of a visual scene.
    fn place(&mut self, parent: ColladaElement, name: &str) -> Result<Option<ColladaElement>, ReadError> {
        use ColladaElement as Open;
        Ok(Some(match (parent, name) {
            (Open::Instance, "instance_material") => {
                let binding = [self.attribute("symbol"), self.reference("target")];
                let node = self.open_nodes.last().and_then(|node| self.document.nodes.get_mut(*node));
                if let Some(instance) = node.and_then(|node| node.instances.last_mut()) {
                    push(&mut instance.bindings, binding)?;
                }
                Open::Skipped
            }
            (Open::Instance, _) => return Ok(None),
            (_, "node") => self.node(parent)?,
            (Open::Node, "instance_geometry") => self.instance(InstanceKind::Geometry)?,
            (Open::Node, "instance_controller") => self.instance(InstanceKind::Controller)?,
            (Open::Node, "instance_node") => self.instance(InstanceKind::Node)?,
            (Open::Node, "skew") => {
                return Err(self.elements.error("unsupported-transform", "skew is not read"));
            }
            (Open::Node, name) => match TransformKind::from_element(name) {
                Some(kind) => Open::Transform(kind),
                None => return Ok(None),
            },
            _ => return Ok(None),
        }))
    }

    /// Counts an element that is skipped with its content, unless it does not affect the shape.
    fn skip(&mut self, parent: ColladaElement, name: &str) -> ColladaElement {
        let Self { elements, warnings, .. } = self;
        if let Some(LeftOut { code, what }) = left_out(parent, name) {
            warnings.count(code, || {
                (elements.place(), format!("not kept: {what}, {} first", show(name.as_bytes())))
            });
        }
        ColladaElement::Skipped
    }

    fn controller(&mut self) {
        let source = self.reference("source");
        self.document.controllers.insert(self.id.clone(), source);
        let Self { elements, warnings, id, .. } = self;
        warnings.count("controllers-skipped", || {
            let id = show(id.as_bytes());
            let message =
                format!("controllers (skins, morphs) were not read, {id} first: their meshes are at rest");
            (elements.place(), message)
        });
    }

    fn unit(&mut self) -> Result<(), ReadError> {
        let Some(text) = self.elements.get("meter") else { return Ok(()) };
        match number(text.trim().as_bytes()).filter(|metres| metres.is_finite() && *metres > 0.0) {
            Some(metres) => self.document.metres_per_unit = metres,
            None => {
                let message = format!("meter = {} is no length", show(text.as_bytes()));
                return Err(self.elements.error("unknown-unit", message));
            }
        }
        Ok(())
    }

    /// A count in an attribute.
    fn count(&self, name: &str) -> Result<Option<u64>, ReadError> {
        let Some(text) = self.elements.get(name) else { return Ok(None) };
        let value = integer(text.trim().as_bytes()).ok().and_then(|value| u64::try_from(value).ok());
        value.map(Some).ok_or_else(|| {
            let message = format!("{name} = {} is no possible count", show(text.as_bytes()));
            self.elements.error("count-out-of-range", message)
        })
    }

    fn effect(&mut self, change: impl FnOnce(&mut ColladaEffect)) {
        if let Some(effect) = self.document.looks.effects.get_mut(&self.id) {
            change(effect);
        }
    }

    fn set_parameter(&mut self, value: String) {
        let parameter = self.parameter.clone();
        self.effect(|effect| {
            effect.parameters.insert(parameter, value);
        });
    }

    fn geometry(&mut self) -> Result<ColladaElement, ReadError> {
        let (id, name) = (self.attribute("id"), self.attribute("name"));
        let number = self.document.geometries.len();
        if self.document.geometry_ids.insert(id.clone(), number).is_some() {
            let message = format!("two geometries have the id {}", show(id.as_bytes()));
            return Err(self.elements.error("duplicate-id", message));
        }
        let geometry = ColladaGeometry { id, name, ..ColladaGeometry::default() };
        push_large(&mut self.document.geometries, geometry)?;
        Ok(ColladaElement::Geometry)
    }

    fn vertices_input(&mut self) -> Result<(), ReadError> {
        let (semantic, id) = (self.attribute("semantic"), self.reference("source"));
        let Some(geometry) = self.document.geometries.last_mut() else { return Ok(()) };
        let Some(source) = geometry.sources.get(&id) else {
            let message = format!("the source {} is not there", show(id.as_bytes()));
            return Err(self.elements.error("missing-source", message));
        };
        let semantic = match &*semantic {
            "POSITION" => {
                let positions = source.positions(self.limits);
                geometry.positions = positions.map_err(|bad| self.elements.error(bad.code, &*bad.message))?;
                return Ok(());
            }
            "NORMAL" => Semantic::Normal,
            "TEXCOORD" => Semantic::TexCoord(0),
            "COLOR" => Semantic::Color(0),
            other => {
                let message = format!("values of vertices were skipped, {} first", show(other.as_bytes()));
                self.warnings.count("inputs-skipped", || (self.elements.place(), message));
                return Ok(());
            }
        };
        if geometry.vertices.len() >= MOST_INPUTS {
            let message = format!("more inputs than the limit of {MOST_INPUTS}");
            return Err(self.elements.error("too-many-inputs", message));
        }
        push(&mut geometry.vertices, (semantic, id))
    }

    fn input(&mut self) -> Result<(), ReadError> {
        let offset = usize::try_from(self.count("offset")?.unwrap_or(0)).unwrap_or(usize::MAX);
        let (semantic, source) = (self.attribute("semantic"), self.attribute("source"));
        let Some(primitive) = &mut self.primitive else { return Ok(()) };
        if offset >= MOST_INPUTS || primitive.inputs.len() >= MOST_INPUTS {
            let message = format!("more inputs, or a larger offset, than the limit of {MOST_INPUTS}");
            return Err(self.elements.error("too-many-inputs", message));
        }
        push(&mut primitive.inputs, PrimitiveInput { semantic, source, offset })
    }

    fn node(&mut self, parent: ColladaElement) -> Result<ColladaElement, ReadError> {
        let (id, name) = (self.attribute("id"), self.attribute("name"));
        let number = self.document.nodes.len();
        let name = if name.is_empty() { id.clone() } else { name };
        // If several nodes have one id, the first counts.
        if !id.is_empty() {
            self.document.node_ids.entry(id).or_insert(number);
        }
        let (children, instances) = (Vec::new(), Vec::new());
        push_large(&mut self.document.nodes, ColladaNode { name, matrix: IDENTITY, children, instances })?;
        match (parent, self.open_nodes.last()) {
            (ColladaElement::Node, Some(above)) => push(&mut self.document.nodes[*above].children, number)?,
            (ColladaElement::VisualScene, _) => {
                if let Some((_, roots)) = self.document.scenes.last_mut() {
                    push(roots, number)?;
                }
            }
            _ => {}
        }
        self.open_nodes.push(number);
        Ok(ColladaElement::Node)
    }

    fn instance(&mut self, kind: InstanceKind) -> Result<ColladaElement, ReadError> {
        let url = self.elements.need("url")?;
        let Some(target) = local(url).map(str::to_owned) else {
            let message = format!("the content of other files was not read, {} first", show(url.as_bytes()));
            self.warnings.count("external-skipped", || (self.elements.place(), message));
            return Ok(ColladaElement::Skipped);
        };
        let line = self.elements.line();
        let node = self.open_nodes.last().and_then(|node| self.document.nodes.get_mut(*node));
        if let Some(node) = node {
            push(&mut node.instances, ColladaInstance { kind, target, bindings: Vec::new(), line })?;
        }
        Ok(ColladaElement::Instance)
    }

    fn finish(&mut self, meaning: ColladaElement) -> Result<(), ReadError> {
        let content = std::mem::take(&mut self.content);
        let word = content.trim();
        match meaning {
            ColladaElement::UpAxis => {
                self.document.up = match word {
                    "X_UP" => UpAxis::X,
                    "Y_UP" => UpAxis::Y,
                    "Z_UP" => UpAxis::Z,
                    other => {
                        let other = show(other.as_bytes());
                        let message = format!("up_axis {other} is none of X_UP, Y_UP and Z_UP");
                        return Err(self.elements.error("unknown-value", message));
                    }
                };
            }
            ColladaElement::ImagePath => {
                self.document.looks.images.insert(self.id.clone(), word.to_owned());
            }
            ColladaElement::ParameterValue => self.set_parameter(word.to_owned()),
            ColladaElement::DiffuseColor => {
                let numbers = self.numbers(&content)?;
                if let [r, g, b, rest @ ..] = &numbers[..] {
                    let alpha = rest.first().copied().unwrap_or(1.0);
                    let color = [*r, *g, *b, alpha].map(|x| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) });
                    self.effect(|effect| effect.color = Some(color));
                }
            }
            ColladaElement::Floats => self.source.values = self.numbers(&content)?,
            ColladaElement::Source => self.finish_source()?,
            ColladaElement::Counts => {
                if let Some(primitive) = &mut self.primitive {
                    primitive.counts = content;
                }
            }
            ColladaElement::Indices => {
                let at = self.content_at;
                if let Some(primitive) = &mut self.primitive {
                    push(&mut primitive.lists, (content, at))?;
                }
            }
            ColladaElement::Primitive => self.finish_primitive()?,
            ColladaElement::Geometry => {
                if let Some(geometry) = self.document.geometries.last_mut() {
                    geometry.drop_unused_sources();
                }
            }
            ColladaElement::Transform(kind) => self.transform(kind, &content)?,
            ColladaElement::Node => {
                self.open_nodes.pop();
            }
            _ => {}
        }
        Ok(())
    }

    fn finish_source(&mut self) -> Result<(), ReadError> {
        let mut source = std::mem::take(&mut self.source);
        if source.width == 0 {
            source.width = source.stride;
        }
        if !source.is_whole() || source.count > self.limits.rows {
            let message = format!(
                "the source {} has {} numbers, fewer than {} rows of {} need",
                show(self.source_id.as_bytes()),
                source.values.len(),
                source.count,
                source.stride
            );
            return Err(self.elements.error("truncated", message));
        }
        let id = std::mem::take(&mut self.source_id);
        if let Some(geometry) = self.document.geometries.last_mut() {
            geometry.sources.insert(id, source);
        }
        Ok(())
    }

    fn finish_primitive(&mut self) -> Result<(), ReadError> {
        let Some(primitive) = self.primitive.take() else { return Ok(()) };
        let (text, limits) = (self.text, self.limits);
        let mut scope =
            PrimitiveScope { limits, warnings: &mut *self.warnings, place: &|at| place(text, at) };
        match self.document.geometries.last_mut() {
            Some(geometry) => primitive.read(geometry, &mut scope),
            None => Ok(()),
        }
    }

    fn transform(&mut self, kind: TransformKind, content: &str) -> Result<(), ReadError> {
        let numbers = self.numbers(content)?;
        let numbers = Some(numbers).filter(|numbers| numbers.len() == kind.n_numbers());
        let matrix = numbers.and_then(|numbers| kind.matrix(&numbers));
        let Some(matrix) = matrix.filter(|matrix| matrix.iter().all(|x| x.is_finite())) else {
            let message = format!(
                "a transform has {} finite numbers that make one, and these are {}",
                kind.n_numbers(),
                show(content.trim().as_bytes())
            );
            return Err(self.elements.error("bad-transform", message));
        };
        let node = self.open_nodes.last().and_then(|node| self.document.nodes.get_mut(*node));
        if let Some(node) = node {
            node.matrix = product(&node.matrix, &matrix);
        }
        Ok(())
    }

    /// The numbers of a text.
    fn numbers(&self, content: &str) -> Result<Vec<f64>, ReadError> {
        let n = LineTokens::new(content.as_bytes()).count();
        let mut numbers = with_room(n)?;
        for token in LineTokens::new(content.as_bytes()) {
            match number(token) {
                Some(value) => numbers.push(value),
                None => {
                    // The token is a part of the content, so the difference of their addresses is
                    // its offset.
                    let at = (token.as_ptr() as usize).saturating_sub(content.as_ptr() as usize);
                    let place = place(self.text, self.content_at + at.min(content.len()));
                    return Err(ReadError::new("not-a-number", place, number_error(token)));
                }
            }
        }
        Ok(numbers)
    }
}
