//! Reads STL: decides between text and binary.
use super::{binary, text};
use crate::text::{grouped, is_space};
use crate::{FileLocation, Limits, ReadError, ReadOutcome};

/// The bytes before the first facet of a binary file: 80 of header and a count.
pub(super) const HEAD: usize = 84;
/// The bytes of one binary facet: a normal and three corners of three f32 each, and two for what tools like.
pub(super) const FACET: usize = 50;

/// The mesh of an STL file, text or binary, as one part.
///
/// A file whose size is 84 + 50 n for the n that it declares is binary, whatever its header says; else one
/// that starts with `solid` and holds no NUL is text. Every facet gets three vertices of its own; those with
/// the same position, bit by bit, are tied by `position_id`. For that, −0 is read as 0 and counted. Facet
/// normals are compared with the corners and dropped. The solids of a text become a face attribute
/// `Group("solid")` if there are several.
///
/// # Errors
/// [`ReadError`] at the byte or line.
///
/// ```
/// use chordal_io::{Content, Limits, stl};
/// let file = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
/// let Content::Scene(scene) = stl::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    if !is_exact_binary(bytes) && is_text(bytes) {
        return text::read(bytes, limits);
    }
    if bytes.len() < HEAD {
        let message = format!(
            "{} bytes are no STL: binary needs {HEAD} or more, and text starts with 'solid'",
            bytes.len()
        );
        return Err(ReadError::new("not-stl", FileLocation::File, message));
    }
    binary::read(bytes, limits)
}

/// The number of facets that a binary header declares.
pub(super) fn declared(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEAD - 4..HEAD)?;
    Some(u64::from(u32::from_le_bytes(count.try_into().ok()?)))
}

/// The size that a binary file with that many facets has.
pub(super) fn size_of(facets: u64) -> u64 {
    HEAD as u64 + FACET as u64 * facets
}

fn is_exact_binary(bytes: &[u8]) -> bool {
    declared(bytes).is_some_and(|facets| size_of(facets) == bytes.len() as u64)
}

fn is_text(bytes: &[u8]) -> bool {
    // A binary count below 2^24 has a NUL in its highest byte, so that a few lines of text show what it is.
    const LOOK: usize = 1024;
    let head = &bytes[..bytes.len().min(LOOK)];
    let head = head.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(head);
    let start = head.iter().position(|b| !is_space(*b)).unwrap_or(head.len());
    let word = &head[start..];
    word.len() >= 5
        && word[..5].eq_ignore_ascii_case(b"solid")
        && word.get(5).is_none_or(|b| is_space(*b))
        && !head.contains(&0)
}

/// Whether the content is STL, by the size rule or its first word.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    is_exact_binary(bytes) || is_text(bytes)
}

/// The message of a binary file that is shorter than it declares.
pub(super) fn too_short(bytes: &[u8], facets: u64) -> ReadError {
    let size = bytes.len() as u64;
    let whole = (size - HEAD as u64) / FACET as u64;
    let message = format!(
        "{} bytes, header says {} facets: that needs {} bytes, and facet {} is cut off",
        grouped(size),
        grouped(facets),
        grouped(size_of(facets)),
        grouped(whole)
    );
    ReadError::new("truncated", FileLocation::Byte(size_of(whole)), message)
}
