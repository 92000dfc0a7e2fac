//! The codecs of `EXT_meshopt_compression` and `KHR_meshopt_compression`: the bytes of a view from a stream.
//!
//! Rows and triangles are also encoded, in the oldest version that every reader supports.
//!
//! There are three bitstreams: vertices of any stride, triangles by their indices, and other indices, each in
//! versions 0 and 1. Vertices may pass a filter afterwards. The codecs are written in safe Rust from the
//! descriptions of the formats, since the original library is C++ and files are untrusted: a stream that ends
//! too early, has bytes left over or refers to data that it never wrote is an error, and only the caller
//! allocates.
//!
//! Both names are read alike: version 1 of the vertex codec and the colour filter, which only
//! `KHR_meshopt_compression` defines, are also decoded under the name `EXT_meshopt_compression`.
//!
//! Sources: A. Kapoulkine and J. St. Pierre, *EXT_meshopt_compression*, Khronos Group, 2021; A. Kapoulkine,
//! J. St. Pierre, A. Knyazev and D. McCurdy, *KHR_meshopt_compression*, Khronos Group, 2025; version 0 of the
//! index codec: A. Kapoulkine, *meshoptimizer* (MIT), `indexcodec.cpp`, 2016–2025.
mod filters;
mod indices;
mod packed_bytes;
mod recent_items;
mod vertices;
mod write_triangles;
mod write_vertices;

/// The names of the extension, in the order of the search.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The code of a stream that cannot be decoded.
pub(super) const BROKEN_STREAM: &str = "meshopt-stream";

/// The bitstream of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MeshoptMode {
    Attributes,
    Triangles,
    Indices,
}

impl MeshoptMode {
    /// Converts from its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "ATTRIBUTES" => Self::Attributes,
            "TRIANGLES" => Self::Triangles,
            "INDICES" => Self::Indices,
            _ => return None,
        })
    }
}

/// The filter applied to each decoded row of attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MeshoptFilter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl MeshoptFilter {
    /// Converts from its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "NONE" => Self::None,
            "OCTAHEDRAL" => Self::Octahedral,
            "QUATERNION" => Self::Quaternion,
            "EXPONENTIAL" => Self::Exponential,
            "COLOR" => Self::Color,
            _ => return None,
        })
    }

    /// Whether the filter accepts rows of `stride` bytes.
    fn accepts(self, stride: u64) -> bool {
        match self {
            Self::None | Self::Exponential => true,
            Self::Octahedral | Self::Color => stride == 4 || stride == 8,
            Self::Quaternion => stride == 8,
        }
    }
}

/// The location of a view's stream, and the layout of its content.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshoptLayout {
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
    pub stride: u64,
    pub count: u64,
    pub mode: MeshoptMode,
    pub filter: MeshoptFilter,
}

impl MeshoptLayout {
    /// The rule of the extension that a layout breaks: the member and the error.
    pub fn broken_rule(&self) -> Option<(&'static str, String)> {
        let Self { stride, count, .. } = *self;
        if self.mode == MeshoptMode::Attributes {
            if stride % 4 != 0 || !(4..=256).contains(&stride) {
                return Some(("byteStride", format!("{stride} is no multiple of 4 from 4 to 256")));
            }
            if !self.filter.accepts(stride) {
                return Some(("filter", format!("the filter is not one for rows of {stride} bytes")));
            }
            return None;
        }
        if stride != 2 && stride != 4 {
            return Some(("byteStride", format!("indices have 2 or 4 bytes and not {stride}")));
        }
        if self.filter != MeshoptFilter::None {
            return Some(("filter", "indices have no filter".to_owned()));
        }
        if self.mode == MeshoptMode::Triangles && count % 3 != 0 {
            return Some(("count", format!("{count} indices make no whole triangles")));
        }
        None
    }

    /// The number of bytes that it decodes to.
    pub fn n_bytes(&self) -> u64 {
        self.count.saturating_mul(self.stride)
    }
}

/// Encodes at least one row of attributes of `stride` bytes: see [`MeshoptMode::Attributes`].
pub(super) fn encode_rows(rows: &[u8], stride: usize) -> Vec<u8> {
    write_vertices::encode(rows, stride)
}

/// Encodes triangles. The corners of a triangle may be rotated: see [`MeshoptMode::Triangles`].
pub(super) fn encode_triangles(triangles: &[[u32; 3]]) -> Vec<u8> {
    write_triangles::encode(triangles)
}

/// Decodes a stream into `out`, which holds as many zeros as the layout has bytes. The layout must be valid.
///
/// Linear in the decoded bytes, whatever the stream is.
///
/// # Errors
/// The error in the stream, as the end of a sentence.
pub(super) fn decode(layout: &MeshoptLayout, stream: &[u8], out: &mut [u8]) -> Result<(), String> {
    // Strides are at most 256.
    let stride = layout.stride as usize;
    match layout.mode {
        MeshoptMode::Attributes => {
            vertices::decode(stream, stride, out)?;
            match layout.filter {
                MeshoptFilter::None => Ok(()),
                MeshoptFilter::Octahedral => filters::octahedral(out, stride),
                MeshoptFilter::Quaternion => filters::quaternion(out),
                MeshoptFilter::Exponential => {
                    filters::exponential(out);
                    Ok(())
                }
                MeshoptFilter::Color => filters::color(out, stride),
            }
        }
        MeshoptMode::Triangles => indices::triangles(stream, stride, out),
        MeshoptMode::Indices => indices::sequence(stream, stride, out),
    }
}
