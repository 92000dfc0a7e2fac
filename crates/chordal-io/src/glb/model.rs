//! What a glTF file says, parsed: every field is what it should be, or `None` where the file errs.
use super::format::{Component, Format, Kind};

/// The objects of a file by their lists; an item that is no object is `None`.
#[derive(Default)]
pub(super) struct Model<'a> {
    pub buffers: Vec<Option<Buffer<'a>>>,
    pub views: Vec<Option<View>>,
    pub accessors: Vec<Option<Accessor>>,
    pub images: Vec<Option<Image<'a>>>,
    pub textures: Vec<Option<Texture>>,
    pub materials: Vec<Option<Material>>,
    pub meshes: Vec<Option<Mesh<'a>>>,
    pub nodes: Vec<Option<Node<'a>>>,
    pub skins: Vec<Option<Skin>>,
    pub animations: Vec<Option<Animation<'a>>>,
    pub scenes: Vec<Option<Scene>>,
    /// The default scene.
    pub scene: Option<usize>,
    pub extensions_used: Vec<&'a str>,
    pub extensions_required: Vec<&'a str>,
}

/// Bytes, and where they come from.
pub(super) struct Buffer<'a> {
    pub byte_length: Option<u64>,
    /// The `uri`, whatever it says.
    pub uri: Option<&'a str>,
    /// The bytes, where the file holds them.
    pub data: Option<std::borrow::Cow<'a, [u8]>>,
}

/// A part of a buffer.
#[derive(Default)]
pub(super) struct View {
    pub buffer: Option<usize>,
    pub offset: Option<u64>,
    pub length: Option<u64>,
    pub stride: Option<u64>,
    pub target: Option<u64>,
    /// The extension by which it is compressed, if there is one.
    pub compressed: bool,
}

/// Rows of numbers.
#[derive(Default)]
pub(super) struct Accessor {
    pub view: Option<usize>,
    pub offset: Option<u64>,
    pub count: Option<u64>,
    pub component: Option<Component>,
    pub kind: Option<Kind>,
    pub normalized: bool,
    pub min: Option<Box<[f64]>>,
    pub max: Option<Box<[f64]>>,
    pub sparse: Option<Box<Sparse>>,
}

impl Accessor {
    /// Its format, where it has one.
    pub fn format(&self) -> Option<Format> {
        Some(Format { kind: self.kind?, component: self.component?, normalized: self.normalized })
    }
}

/// Rows that replace others.
pub(super) struct Sparse {
    pub count: u64,
    pub index_view: Option<usize>,
    pub index_offset: Option<u64>,
    pub index_component: Option<Component>,
    pub value_view: Option<usize>,
    pub value_offset: Option<u64>,
}

/// A picture.
pub(super) struct Image<'a> {
    pub view: Option<usize>,
    pub mime: Option<&'a str>,
    pub data: Option<Vec<u8>>,
    pub extended: bool,
    /// The type that the bytes turned out to have.
    pub found: Option<&'static str>,
}

/// A picture with a sampler.
pub(super) struct Texture {
    pub source: Option<usize>,
    /// The source by `EXT_texture_webp`.
    pub webp: Option<usize>,
}

/// What a material asks of meshes.
#[derive(Default)]
pub(super) struct Material {
    pub has_normal_texture: bool,
    pub needs_tangents: bool,
    /// The highest texture coordinate set it reads, and which texture does.
    pub texcoord: Option<(u64, String)>,
}

/// Primitives.
pub(super) struct Mesh<'a> {
    pub name: &'a str,
    pub primitives: Vec<Primitive<'a>>,
}

/// Named accessors.
pub(super) type Attributes<'a> = Vec<(&'a str, Option<usize>)>;

/// One drawing.
pub(super) struct Primitive<'a> {
    pub attributes: Attributes<'a>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u64>,
    pub targets: Option<Vec<Attributes<'a>>>,
    /// Materials by `KHR_materials_variants`, each with its place below the primitive.
    pub variants: Vec<(usize, String)>,
    pub n_joints: u64,
    pub n_texcoords: u64,
    pub draco: bool,
}

/// A place.
#[derive(Default)]
pub(super) struct Node<'a> {
    pub name: &'a str,
    pub children: Vec<Option<usize>>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub weights: Option<Vec<f64>>,
}

/// Joints.
pub(super) struct Skin {
    pub matrices: Option<usize>,
    pub skeleton: Option<usize>,
    pub joints: Option<Vec<Option<usize>>>,
}

/// Channels and samplers.
pub(super) struct Animation<'a> {
    pub channels: Option<Vec<Channel<'a>>>,
    pub samplers: Option<Vec<Sampler<'a>>>,
}

/// What moves.
pub(super) struct Channel<'a> {
    pub sampler: Option<usize>,
    pub target: Option<Target<'a>>,
}

/// A property of a node.
pub(super) struct Target<'a> {
    pub node: Option<usize>,
    pub path: Option<&'a str>,
}

/// How it moves.
pub(super) struct Sampler<'a> {
    pub input: Option<usize>,
    pub output: Option<usize>,
    pub interpolation: &'a str,
}

/// What is shown.
pub(super) struct Scene {
    pub nodes: Option<Vec<Option<usize>>>,
}

/// The item of a list, if it is there.
pub(super) fn item<T>(list: &[Option<T>], index: Option<usize>) -> Option<&T> {
    list.get(index?)?.as_ref()
}
