//! `GltfModel`: a parsed glTF file; invalid fields are `None`.
use super::format::FIRST_MODE_OF_TRIANGLES;
use super::format::{AccessorFormat, AccessorType, ComponentType};
use super::meshopt::MeshoptLayout;

/// The objects of a file by their lists; an item that is not an object is `None`.
#[derive(Default)]
pub(super) struct GltfModel<'a> {
    pub buffers: Vec<Option<GltfBuffer<'a>>>,
    pub views: Vec<Option<GltfBufferView>>,
    pub accessors: Vec<Option<GltfAccessor>>,
    pub images: Vec<Option<GltfImage<'a>>>,
    pub textures: Vec<Option<GltfTexture>>,
    pub materials: Vec<Option<GltfMaterial>>,
    pub meshes: Vec<Option<GltfMesh<'a>>>,
    pub nodes: Vec<Option<GltfNode<'a>>>,
    pub skins: Vec<Option<GltfSkin>>,
    pub animations: Vec<Option<GltfAnimation<'a>>>,
    pub scenes: Vec<Option<GltfScene>>,
    /// The default scene.
    pub scene: Option<usize>,
    pub extensions_used: Vec<&'a str>,
    pub extensions_required: Vec<&'a str>,
}

impl GltfModel<'_> {
    /// The number of bytes of buffers outside the file or in data URIs.
    pub fn n_external(&self) -> usize {
        let data = self.buffers.iter().flatten().filter(|buffer| buffer.uri.is_some());
        data.filter_map(|buffer| buffer.data.as_ref()).map(|data| data.len()).sum()
    }

    /// The bytes of a view, if they are available; unpacked if it is compressed.
    pub fn view_bytes(&self, view: Option<usize>) -> Option<&[u8]> {
        let GltfBufferView { buffer, offset, length, packed, .. } = item(&self.views, view)?;
        match packed {
            Some(packed) => packed.bytes.as_deref(),
            None => self.buffer_bytes((*buffer)?, (*offset)?, (*length)?),
        }
    }

    /// A range of a buffer, if it is available.
    pub fn buffer_bytes(&self, buffer: usize, offset: u64, length: u64) -> Option<&[u8]> {
        let data = item(&self.buffers, Some(buffer))?.data.as_deref()?;
        data.get(usize::try_from(offset).ok()?..)?.get(..usize::try_from(length).ok()?)
    }
}

/// A buffer: its bytes, and their source.
pub(super) struct GltfBuffer<'a> {
    pub byte_length: Option<u64>,
    /// The `uri`, valid or not.
    pub uri: Option<&'a str>,
    /// The bytes, if they are available.
    pub data: Option<std::borrow::Cow<'a, [u8]>>,
    /// Whether it exists only for readers that cannot decode the compressed views on it.
    pub is_fallback: bool,
}

/// A range of a buffer.
#[derive(Default)]
pub(super) struct GltfBufferView {
    pub buffer: Option<usize>,
    pub offset: Option<u64>,
    pub length: Option<u64>,
    pub stride: Option<u64>,
    pub target: Option<u64>,
    /// The compression of the view by an extension.
    pub packed: Option<Box<GltfPackedView>>,
}

/// A compressed view as its extension describes it.
pub(super) struct GltfPackedView {
    /// The name of the extension.
    pub extension: &'static str,
    /// The location of the stream; `None` if the extension is invalid.
    pub layout: Option<MeshoptLayout>,
    /// The decoded bytes of the view.
    pub bytes: Option<Vec<u8>>,
}

/// A typed, strided view of rows of numbers.
#[derive(Default)]
pub(super) struct GltfAccessor {
    pub view: Option<usize>,
    pub offset: Option<u64>,
    pub count: Option<u64>,
    pub component: Option<ComponentType>,
    pub kind: Option<AccessorType>,
    pub normalized: bool,
    pub min: Option<Box<[f64]>>,
    pub max: Option<Box<[f64]>>,
    pub sparse: Option<Box<GltfSparse>>,
    /// The rows, tightly packed, if they come from the compressed stream of a primitive.
    pub unpacked: Option<Vec<u8>>,
}

impl GltfAccessor {
    /// The format, if it is known.
    pub fn format(&self) -> Option<AccessorFormat> {
        Some(AccessorFormat { kind: self.kind?, component: self.component?, normalized: self.normalized })
    }
}

/// The rows of an accessor that replace base rows.
pub(super) struct GltfSparse {
    pub count: u64,
    pub index_view: Option<usize>,
    pub index_offset: Option<u64>,
    pub index_component: Option<ComponentType>,
    pub value_view: Option<usize>,
    pub value_offset: Option<u64>,
}

/// An image.
pub(super) struct GltfImage<'a> {
    pub view: Option<usize>,
    /// The `uri`, valid or not.
    pub uri: Option<&'a str>,
    pub mime: Option<&'a str>,
    pub data: Option<Vec<u8>>,
    pub extended: bool,
    /// The media type detected from its bytes.
    pub detected: Option<&'static str>,
}

/// A texture: an image with a sampler.
pub(super) struct GltfTexture {
    pub source: Option<usize>,
    /// The source given by `EXT_texture_webp`.
    pub webp: Option<usize>,
}

/// The requirements of a material on meshes.
#[derive(Default)]
pub(super) struct GltfMaterial {
    pub has_normal_texture: bool,
    pub needs_tangents: bool,
    /// The highest texture coordinate set that it reads, and the texture that reads it.
    pub texcoord: Option<(u64, String)>,
}

/// A mesh: a list of primitives.
pub(super) struct GltfMesh<'a> {
    pub name: &'a str,
    pub primitives: Vec<GltfPrimitive<'a>>,
}

/// Accessors by attribute name.
pub(super) type GltfAttributes<'a> = Vec<(&'a str, Option<usize>)>;

/// A primitive of a mesh.
pub(super) struct GltfPrimitive<'a> {
    pub attributes: GltfAttributes<'a>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u64>,
    pub targets: Option<Vec<GltfAttributes<'a>>>,
    /// Materials by `KHR_materials_variants`, each with its pointer below the primitive.
    pub variants: Vec<(usize, String)>,
    pub n_joints: u64,
    pub n_texcoords: u64,
    /// The Draco stream of the primitive, if it is compressed.
    pub draco: Option<GltfDracoStream<'a>>,
}

impl GltfPrimitive<'_> {
    /// The accessor of the positions.
    pub fn position(&self) -> Option<usize> {
        self.attributes.iter().find(|(name, _)| *name == "POSITION").and_then(|(_, accessor)| *accessor)
    }

    /// The accessors that its compressed stream fills, each with its attribute in the stream: `None` for
    /// indices.
    pub fn stream_accessors(&self) -> Vec<(usize, Option<u32>)> {
        let Some(stream) = &self.draco else { return Vec::new() };
        let id_of = |name: &str| stream.attributes.iter().find(|(known, _)| *known == name)?.1;
        let attributes = self.attributes.iter();
        let named = attributes.filter_map(|(name, accessor)| Some(((*accessor)?, Some(id_of(name)?))));
        named.chain(self.indices.map(|indices| (indices, None))).collect()
    }

    /// Whether it is points or lines.
    pub fn is_marks(&self) -> bool {
        self.mode.is_some_and(|mode| mode < FIRST_MODE_OF_TRIANGLES)
    }

    /// Whether it has triangles.
    pub fn is_drawn(&self) -> bool {
        self.mode.is_some_and(|mode| mode >= FIRST_MODE_OF_TRIANGLES) && self.position().is_some()
    }
}

/// `KHR_draco_mesh_compression` of a primitive.
pub(super) struct GltfDracoStream<'a> {
    pub view: Option<usize>,
    /// The id in the stream of each attribute.
    pub attributes: Vec<(&'a str, Option<u32>)>,
}

/// A node of the scene graph. It takes only 56 bytes, since a file of a megabyte may have three hundred
/// thousand empty nodes.
#[derive(Default)]
pub(super) struct GltfNode<'a> {
    pub name: &'a str,
    pub children: Box<[Option<usize>]>,
    pub mesh: Option<usize>,
    /// The rarer members of a node.
    pub more: Option<Box<GltfNodeMore<'a>>>,
}

/// The members of nodes other than name, children and mesh.
#[derive(Default, PartialEq)]
pub(super) struct GltfNodeMore<'a> {
    pub skin: Option<usize>,
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<Box<[f64; 3]>>,
    pub rotation: Option<Box<[f64; 4]>>,
    pub scale: Option<Box<[f64; 3]>>,
    pub weights: Option<Box<[f64]>>,
    /// The accessors of `EXT_mesh_gpu_instancing`.
    pub instances: Option<GltfAttributes<'a>>,
}

impl<'a> GltfNode<'a> {
    pub fn skin(&self) -> Option<usize> {
        self.more.as_ref()?.skin
    }

    pub fn matrix(&self) -> Option<&[f64; 16]> {
        self.more.as_ref()?.matrix.as_deref()
    }

    pub fn weights(&self) -> Option<&[f64]> {
        self.more.as_ref()?.weights.as_deref()
    }

    pub fn instances(&self) -> Option<&GltfAttributes<'a>> {
        self.more.as_ref()?.instances.as_ref()
    }
}

/// A skin: joints and their matrices.
pub(super) struct GltfSkin {
    pub matrices: Option<usize>,
    pub skeleton: Option<usize>,
    pub joints: Option<Vec<Option<usize>>>,
}

/// An animation: channels and samplers.
pub(super) struct GltfAnimation<'a> {
    pub channels: Option<Vec<GltfChannel<'a>>>,
    pub samplers: Option<Vec<GltfAnimationSampler<'a>>>,
}

/// A channel: which sampler drives which property.
pub(super) struct GltfChannel<'a> {
    pub sampler: Option<usize>,
    pub target: Option<GltfChannelTarget<'a>>,
}

/// The animated property of a node.
pub(super) struct GltfChannelTarget<'a> {
    pub node: Option<usize>,
    pub path: Option<&'a str>,
}

/// The sampler of a channel: keyframe times and values.
pub(super) struct GltfAnimationSampler<'a> {
    pub input: Option<usize>,
    pub output: Option<usize>,
    pub interpolation: &'a str,
}

/// A scene: its root nodes.
pub(super) struct GltfScene {
    pub nodes: Option<Vec<Option<usize>>>,
}

/// The item of a list, if it exists.
pub(super) fn item<T>(list: &[Option<T>], index: Option<usize>) -> Option<&T> {
    list.get(index?)?.as_ref()
}
