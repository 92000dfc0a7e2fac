//! Reads STL: decides between text and binary.
use super::binary::{self, HEAD, declared, size_of};
use super::text;
use crate::text::is_space;
use crate::{FileLocation, Limits, ReadError, ReadOutcome};

/// Reads the mesh of an STL file, text or binary, as one part.
///
/// A file that declares n facets and has 84 + 50 n bytes is binary, whatever its header says. Any other file
/// is text if it starts with `solid` and holds no NUL. Every facet gets three separate vertices; those at
/// bit-identical positions share a `position_id`. To this end −0 is read as 0 and counted. Facet normals are
/// compared with the corners and dropped. The solids of a text become a face attribute `Group("solid")` if
/// there are several.
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

fn is_exact_binary(bytes: &[u8]) -> bool {
    declared(bytes).is_some_and(|facets| size_of(facets) == bytes.len() as u64)
}

fn is_text(bytes: &[u8]) -> bool {
    // A binary count below 2^24 has a NUL in its highest byte, so a few lines of text are enough to decide.
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
