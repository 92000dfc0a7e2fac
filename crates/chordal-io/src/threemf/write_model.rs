//! `ModelWriter`: the model part of a 3MF file.
use super::model::{DEFAULT_UNIT, UNITS};
use super::namespace::{CORE, MATERIALS};
use super::properties::ColorBytes;
use super::write_properties::{PartProperties, SceneProperties, corner_indices};
use crate::forest::check_forest;
use crate::instances::first_rows;
use crate::losses::refuse_points_alone;
use crate::matrix::IDENTITY;
use crate::number::{ShortestDecimal, put_count, put_shortest};
use crate::xml_text::{CERTIFICATE_NAMESPACE, escaped};
use crate::{Axis, Frame, Node, Part, Scene, WriteError};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;

/// The objects for a scene, with their ids.
pub(super) struct ModelWriter<'a> {
    scene: &'a Scene,
    unit: &'static str,
    properties: SceneProperties,
    /// For each part the id of its colour group, if it has one, and of its object, unless it is empty.
    parts: Vec<(Option<u32>, Option<u32>)>,
    /// For each node the id of its object, unless it shows nothing; and the nodes that are separate objects,
    /// in the order of the file.
    nodes: Vec<Option<u32>>,
    assemblies: Vec<usize>,
}

/// The id of the group of materials.
const BASE_MATERIALS: u32 = 1;

impl<'a> ModelWriter<'a> {
    /// Assigns ids to the objects.
    ///
    /// # Errors
    /// As for [`super::write()`], except errors of the sink.
    pub(super) fn new(scene: &'a Scene) -> Result<Self, WriteError> {
        check_forest(scene)?;
        let unit = unit_of(scene.frame)?;
        if let Some(i) = scene.nodes.iter().position(|node| !is_affine(&node.matrix)) {
            return Err(WriteError::Unsupported(format!("node {i} has a matrix that is not affine")));
        }
        let properties = SceneProperties::new(scene);
        let mut next = BASE_MATERIALS;
        let mut number = || {
            next += 1;
            next - 1
        };
        if !properties.materials.is_empty() {
            number();
        }
        refuse_points_alone(&scene.parts)?;
        let mut parts = Vec::with_capacity(scene.parts.len());
        for (part, properties) in scene.parts.iter().zip(&properties.parts) {
            let n_faces = part.mesh.faces().len();
            let group = matches!(properties, PartProperties::Colors(_)).then(&mut number);
            parts.push((group, (n_faces > 0).then(&mut number)));
        }
        let mut writer = Self {
            scene,
            unit,
            properties,
            parts,
            nodes: vec![None; scene.nodes.len()],
            assemblies: Vec::new(),
        };
        // Children come before their parents: an object may only refer to earlier objects.
        let mut open: Vec<(usize, bool)> = scene.roots.iter().rev().map(|root| (*root, false)).collect();
        while let Some((node, is_ready)) = open.pop() {
            if !is_ready {
                open.push((node, true));
                open.extend(scene.nodes[node].children.iter().rev().map(|child| (*child, false)));
            } else if writer.is_assembly(&scene.nodes[node]) {
                writer.nodes[node] = Some(number());
                writer.assemblies.push(node);
            } else {
                writer.nodes[node] = writer.part_object(&scene.nodes[node]);
            }
        }
        Ok(writer)
    }

    /// The object of the part that a node shows.
    fn part_object(&self, node: &Node) -> Option<u32> {
        node.part.and_then(|part| self.parts[part].1)
    }

    /// Whether a node needs its own object. Its children must have ids already.
    fn is_assembly(&self, node: &Node) -> bool {
        if node.children.iter().any(|child| self.nodes[*child].is_some()) {
            return true;
        }
        let is_renamed = |part: usize| !node.name.is_empty() && node.name != self.scene.parts[part].name;
        self.part_object(node).is_some() && node.part.is_some_and(is_renamed)
    }

    /// Writes the part.
    pub(super) fn write(&self, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
        writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        write!(out, "<model unit=\"{}\" xml:lang=\"en-US\" xmlns=\"{CORE}\"", self.unit)?;
        if self.parts.iter().any(|(group, _)| group.is_some()) {
            write!(out, " xmlns:m=\"{MATERIALS}\"")?;
        }
        if certificate.is_some() {
            write!(out, " xmlns:chordal=\"{CERTIFICATE_NAMESPACE}\"")?;
        }
        let version = env!("CARGO_PKG_VERSION");
        writeln!(out, ">\n<metadata name=\"Application\">Chordal {version}</metadata>")?;
        if let Some(certificate) = certificate {
            let (name, text) = (super::CERTIFICATE, escaped(&certificate.to_string()));
            writeln!(out, "<metadata name=\"chordal:{name}\">{text}</metadata>")?;
        }
        writeln!(out, "<resources>")?;
        self.base_materials(out)?;
        for (i, part) in self.scene.parts.iter().enumerate() {
            if let (group, Some(object)) = self.parts[i] {
                self.part(part, &self.properties.parts[i], group, object, out)?;
            }
        }
        for node in &self.assemblies {
            self.assembly(*node, out)?;
        }
        writeln!(out, "</resources>\n<build>")?;
        for root in &self.scene.roots {
            if let Some(object) = self.nodes[*root] {
                let matrix = self.z_up_matrix(&self.scene.nodes[*root].matrix);
                reference("item", object, &matrix, out)?;
            }
        }
        Ok(writeln!(out, "</build>\n</model>")?)
    }

    fn base_materials(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        if self.properties.materials.is_empty() {
            return Ok(());
        }
        writeln!(out, "<basematerials id=\"{BASE_MATERIALS}\">")?;
        for material in self.properties.materials.values() {
            let (name, color) = (escaped(&material.name), hex(material.color));
            writeln!(out, "<base name=\"{name}\" displaycolor=\"{color}\"/>")?;
        }
        Ok(writeln!(out, "</basematerials>")?)
    }

    fn part(
        &self,
        part: &Part,
        properties: &PartProperties,
        group: Option<u32>,
        object: u32,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        if let (PartProperties::Colors(palette), Some(group)) = (properties, group) {
            color_group(group, palette, out)?;
        }
        write!(out, "<object id=\"{object}\" type=\"model\"")?;
        name(&part.name, out)?;
        if let Some(index) = self.default_property(part, properties) {
            let group = group.unwrap_or(BASE_MATERIALS);
            write!(out, " pid=\"{group}\" pindex=\"{index}\"")?;
        }
        writeln!(out, ">\n<mesh>\n<vertices>")?;
        let first_rows = first_rows(&part.mesh);
        let mut numbers = vec![0; first_rows.len()];
        let (mut n_written, mut line) = (0_u32, Vec::new());
        for (row, first) in first_rows.iter().enumerate() {
            // Triangles of 3MF are neighbours only by the numbers of their vertices, so rows that
            // are tied become one.
            if *first as usize != row {
                numbers[row] = numbers[*first as usize];
                continue;
            }
            line.clear();
            for (name, x) in ["<vertex x=\"", "\" y=\"", "\" z=\""].iter().zip(part.mesh.positions()[row]) {
                line.extend_from_slice(name.as_bytes());
                put_shortest(&mut line, x);
            }
            line.extend_from_slice(b"\"/>\n");
            out.write_all(&line)?;
            numbers[row] = n_written;
            n_written += 1;
        }
        writeln!(out, "</vertices>\n<triangles>")?;
        for (face_idx, face) in part.mesh.faces().iter().enumerate() {
            let [a, b, c] = face.map(|vertex| numbers[vertex as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            line.clear();
            for (name, corner) in ["<triangle v1=\"", "\" v2=\"", "\" v3=\""].iter().zip([a, b, c]) {
                line.extend_from_slice(name.as_bytes());
                put_count(&mut line, u64::from(corner));
            }
            line.push(b'"');
            out.write_all(&line)?;
            match properties {
                PartProperties::Nothing => {}
                PartProperties::Materials { .. } => {
                    if let Some(material) = self.properties.material(self.scene, part, face_idx) {
                        write!(out, " pid=\"{BASE_MATERIALS}\" p1=\"{material}\"")?;
                    }
                }
                PartProperties::Colors(palette) => {
                    let [p1, p2, p3] = corner_indices(part, palette, face_idx);
                    write!(out, " pid=\"{}\" p1=\"{p1}\"", group.unwrap_or(0))?;
                    if p2 != p1 || p3 != p1 {
                        write!(out, " p2=\"{p2}\" p3=\"{p3}\"")?;
                    }
                }
            }
            writeln!(out, "/>")?;
        }
        Ok(writeln!(out, "</triangles>\n</mesh>\n</object>")?)
    }

    /// The default property of an object: that of most of its triangles, the first one of several, since some
    /// programs show objects only with the default. Readers demand one as soon as a triangle has a property;
    /// it would also apply to triangles without a material.
    fn default_property(&self, part: &Part, properties: &PartProperties) -> Option<u32> {
        let property = |face| match properties {
            PartProperties::Materials { of_all: true } => self.properties.material(self.scene, part, face),
            PartProperties::Colors(palette) => Some(corner_indices(part, palette, face)[0]),
            PartProperties::Materials { of_all: false } | PartProperties::Nothing => None,
        };
        let mut counts = BTreeMap::new();
        (0..part.mesh.faces().len())
            .filter_map(property)
            .for_each(|one| *counts.entry(one).or_insert(0) += 1);
        counts
            .into_iter()
            .min_by_key(|(index, n)| (std::cmp::Reverse(*n), *index))
            .map(|(index, _): (u32, usize)| index)
    }

    /// Writes the object of a node: its own part, untransformed, and its children.
    fn assembly(&self, index: usize, out: &mut dyn Write) -> Result<(), WriteError> {
        let node = &self.scene.nodes[index];
        write!(out, "<object id=\"{}\" type=\"model\"", self.nodes[index].unwrap_or(0))?;
        name(&node.name, out)?;
        writeln!(out, ">\n<components>")?;
        if let Some(object) = self.part_object(node) {
            reference("component", object, &IDENTITY, out)?;
        }
        for child in &node.children {
            if let Some(object) = self.nodes[*child] {
                reference("component", object, &self.scene.nodes[*child].matrix, out)?;
            }
        }
        Ok(writeln!(out, "</components>\n</object>")?)
    }

    /// The matrix of a root, with z up. Only signs and positions of numbers change.
    fn z_up_matrix(&self, matrix: &[f64; 16]) -> [f64; 16] {
        if self.scene.frame.up != Some(Axis::Y) {
            return *matrix;
        }
        let mut turned = *matrix;
        for (to, from) in turned.chunks_exact_mut(4).zip(matrix.chunks_exact(4)) {
            // Adding zero removes the sign of −0.
            (to[1], to[2]) = (0.0 - from[2], from[1] + 0.0);
        }
        turned
    }
}

fn is_affine(matrix: &[f64; 16]) -> bool {
    let bottom = [matrix[3], matrix[7], matrix[11], matrix[15]];
    bottom == [0.0, 0.0, 0.0, 1.0] && matrix.iter().all(|x| x.is_finite())
}

fn unit_of(frame: Frame) -> Result<&'static str, WriteError> {
    let Some(metres) = frame.metres_per_unit else { return Ok(DEFAULT_UNIT) };
    match UNITS.iter().find(|(_, of)| *of == metres) {
        Some((name, _)) => Ok(name),
        None => {
            let names = UNITS.map(|(name, _)| name).join(", ");
            let message = format!("3MF has no unit of {metres} m; it has {names}");
            Err(WriteError::Unsupported(message))
        }
    }
}

fn name(name: &str, out: &mut dyn Write) -> std::io::Result<()> {
    if name.is_empty() { Ok(()) } else { write!(out, " name=\"{}\"", escaped(name)) }
}

fn hex([red, green, blue, alpha]: ColorBytes) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}{alpha:02X}")
}

fn color_group(group: u32, palette: &BTreeMap<ColorBytes, u32>, out: &mut dyn Write) -> std::io::Result<()> {
    let mut colors: Vec<(u32, ColorBytes)> = palette.iter().map(|(color, index)| (*index, *color)).collect();
    colors.sort_unstable();
    writeln!(out, "<m:colorgroup id=\"{group}\">")?;
    colors.iter().try_for_each(|(_, color)| writeln!(out, "<m:color color=\"{}\"/>", hex(*color)))?;
    writeln!(out, "</m:colorgroup>")
}

/// Writes an element that places an object. Columns of our matrix are rows of the file.
fn reference(element: &str, object: u32, matrix: &[f64; 16], out: &mut dyn Write) -> std::io::Result<()> {
    write!(out, "<{element} objectid=\"{object}\"")?;
    if *matrix != IDENTITY {
        let numbers = matrix.chunks_exact(4).flat_map(|column| &column[..3]);
        let text: Vec<String> = numbers.map(|x| ShortestDecimal(*x).to_string()).collect();
        write!(out, " transform=\"{}\"", text.join(" "))?;
    }
    writeln!(out, "/>")
}
