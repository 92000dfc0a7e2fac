//! `Scene`: the content of a mesh file: parts, the nodes that place them, and their coordinate frame.
use crate::glb::deformation::is_deformed;
use crate::glb::{GltfPacking, VertexStorage};
use crate::{Curves, Drawing, Frame, MATERIAL, Marks, Polygons, RareValue, SceneAssets, Volume, Warning};
use chordal::explicit::nurbs::TrimmedSurface;
use chordal::implicit::Field;
use chordal::math::Box3;
use chordal::{Mesh, Patch};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// One mesh with its name, in its own coordinates; nodes place it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The name in the file, or empty.
    pub name: String,
    /// The triangles.
    pub mesh: Mesh,
    /// Whether the file's own position indices say which vertices share a position (OBJ, PLY, OFF). False if
    /// the format has none (STL, glTF), so that bit-identical positions do.
    pub indexed: bool,
    /// Other properties of the mesh in glTF: extras, and the weights of its morph targets. Boxed, since a
    /// file may have a hundred thousand parts and few of them have any.
    pub properties: Option<Box<Map<String, Value>>>,
    /// How its numbers are stored if glTF is quantized; readers leave it `None`. Boxed for the same reason.
    pub storage: Option<Box<VertexStorage>>,
    /// Points and lines of the mesh in glTF, passed through unchanged.
    pub marks: RareValue<Vec<Marks>>,
}

impl Part {
    /// Whether a skin or morph targets move its vertices.
    #[must_use]
    pub fn is_deformed(&self) -> bool {
        is_deformed(&self.mesh)
    }
}

/// A node of the scene graph: a transform, children, and maybe a part that it shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// The name in the file, or empty.
    pub name: String,
    /// Column-major 4 × 4 matrix from this node's space to its parent's.
    pub matrix: RareValue<[f64; 16]>,
    /// Indices of child nodes.
    pub children: Vec<usize>,
    /// Index of the part that it shows.
    pub part: Option<usize>,
    /// Other properties of the node in glTF: camera, light, extras, and translation, rotation and scale if
    /// these define its matrix.
    pub properties: RareValue<Map<String, Value>>,
}

/// The content of a mesh file. A format without nodes gets one identity node for each part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The meshes.
    pub parts: Vec<Part>,
    /// The nodes.
    pub nodes: Vec<Node>,
    /// Nodes without a parent.
    pub roots: Vec<usize>,
    /// The coordinate frame.
    pub frame: Frame,
    /// The certificate in the file, if it carries one.
    pub certificate: Option<Value>,
    /// The number of coarser levels of detail in a glTF beside those that were read; writers ignore it.
    pub coarser_levels: usize,
    /// The names of the values of a face attribute `Semantic::Group(kind)`: `groups[kind][value]`, for the
    /// kinds that have names ([`MATERIAL`], "g", "o" of OBJ, "solid" of STL). Value 0 is a face without such
    /// a group.
    pub groups: BTreeMap<String, Vec<String>>,
    /// Materials with their textures, cameras, lights, animations.
    pub assets: Box<SceneAssets>,
    /// How glTF stores its numbers. Readers leave it at the plain form, whatever the form of their file.
    pub packing: GltfPacking,
    /// How the glTF that was read stored its numbers; the plain form for other files.
    pub stored: GltfPacking,
}

/// The shape that a reader found.
#[derive(Clone, Debug)]
pub enum Content {
    /// Bicubic Bézier patches.
    Patches(Vec<Patch>, Frame),
    /// NURBS surfaces, untrimmed or trimmed.
    Surfaces(Vec<TrimmedSurface>, Frame),
    /// Meshes.
    Scene(Scene),
    /// A polygon cage.
    Polygons(Polygons),
    /// Curves in the plane.
    Drawing(Drawing),
    /// Curves in space.
    Curves(Curves),
    /// An implicit field.
    Field {
        /// The field.
        field: Field,
        /// The box in which the format views it, if it has one.
        region: Option<Box3>,
        /// The coordinate frame.
        frame: Frame,
    },
    /// Samples on a lattice.
    Volume(Volume),
}

/// A shape with the oddities of its file.
#[derive(Clone, Debug)]
pub struct ReadOutcome {
    /// The shape.
    pub content: Content,
    /// Counted oddities.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// Its assets. If groups of faces name materials that have no properties, these are plain materials of
    /// the same names.
    pub(crate) fn assets_for_gltf(&self, plain: impl Fn(&Self) -> Value) -> Cow<'_, SceneAssets> {
        let names = self.groups.get(MATERIAL).map_or(&[][..], |names| names);
        if !self.assets.materials.is_empty() || names.len() < 2 {
            return Cow::Borrowed(&self.assets);
        }
        let plain = plain(self);
        let named = |name: &String| {
            let mut material = plain.clone();
            material["name"] = Value::from(name.as_str());
            material
        };
        // The first name is for faces without a material.
        let materials = names[1..].iter().map(named).collect();
        Cow::Owned(SceneAssets { materials, ..(*self.assets).clone() })
    }

    /// The scene of one mesh with an identity node.
    #[must_use]
    pub fn from_mesh(name: &str, mesh: Mesh, frame: Frame) -> Self {
        Self::from_part(Part { name: name.to_owned(), mesh, indexed: true, ..Part::default() }, frame)
    }

    /// The scene of one mesh of a format without indices, whose triangles share positions by equal
    /// coordinates.
    #[must_use]
    pub fn from_triangle_soup(name: &str, mesh: Mesh, frame: Frame) -> Self {
        Self::from_part(Part { name: name.to_owned(), mesh, ..Part::default() }, frame)
    }

    /// The scene of one part, with an identity node of the same name.
    #[must_use]
    pub fn from_part(part: Part, frame: Frame) -> Self {
        let name = part.name.clone();
        let node = Node { name, part: Some(0), ..Node::default() };
        Self { parts: vec![part], nodes: vec![node], roots: vec![0], frame, ..Self::default() }
    }
}
