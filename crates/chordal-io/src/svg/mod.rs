//! SVG: reads drawings as curves in the plane, and writes polylines as drawings.
//!
//! Coordinates are the root's user units, as its `viewBox` defines; y grows downwards. Visible elements that
//! are not supported are counted in warnings; `docs/svg.md` lists them.
mod cursor;
mod length;
mod names;
mod path;
mod path_builder;
mod shape;
mod style;
mod stylesheet;
mod transform;
mod walker;
mod write;
mod xml;

use crate::warnings::Warnings;
use crate::xml_text::text_of;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome};
pub use write::{write, write_paths};

/// The element with a certificate, in its own namespace.
const CERTIFICATE: &str = "chordal:certificate";

/// Reads the curves of an SVG file: one for each subpath of each drawn element, in document order.
///
/// Arcs stay arcs, lines stay lines, and quadratic curves become equal cubics. The slack of each curve bounds
/// the rounding of transforms and relative coordinates.
///
/// # Errors
/// [`ReadError`] with line and column, for XML that is not well-formed, a document type with declarations, a
/// number that is not finite (unless the limits drop such elements), nesting or copies by `use` over the
/// limits, or `use` in a cycle.
///
/// ```
/// use chordal_io::{Content, Limits, svg};
/// let file = br#"<svg xmlns="http://www.w3.org/2000/svg"><circle cx="5" cy="5" r="4"/><path d="M0 0h3v4z"/></svg>"#;
/// let Content::Drawing(drawing) = svg::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(drawing.lines[0].at(0.0), [9.0, 5.0]);
/// assert_eq!(drawing.lines[1].segments().len(), 3);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: W3C, *Scalable Vector Graphics (SVG) 2*, 2018.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let text = text_of(bytes)?;
    let mut warnings = Warnings::default();
    let tree = xml::XmlTree::read(text, limits)?;
    if let Some(at) = tree.doctype {
        warnings.count("ignored-doctype", || {
            (tree.place_of(at as usize), "the document type was ignored: nothing is fetched".to_owned())
        });
    }
    if let Some(at) = tree.style_sheet {
        warnings.count("unsupported-css", || {
            (
                tree.place_of(at as usize),
                "style sheets in other files were left out: nothing is fetched".to_owned(),
            )
        });
    }
    if !tree.has_namespace {
        warnings.count("no-namespace", || {
            (tree.place(0), "the root does not say that it is SVG (xmlns), and was taken for it".to_owned())
        });
    }
    let mut drawing = walker::SvgWalker::new(&tree, limits, &mut warnings).run()?;
    let certificate = tree.certificate.as_deref();
    drawing.certificate = certificate
        .and_then(|text| crate::certificate::read(text.as_bytes(), FileLocation::File, &mut warnings));
    if drawing.lines.is_empty() {
        warnings
            .count("nothing-drawn", || (FileLocation::File, "the file draws no path or shape".to_owned()));
    }
    Ok(ReadOutcome { content: Content::Drawing(drawing), warnings: warnings.into_list() })
}

/// Whether a text starts like an SVG file: with the element, or with constructs that XML allows before it.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    const LOOKED_AT: usize = 4096;
    if text.first() != Some(&b'<') {
        return false;
    }
    let head = &text[..text.len().min(LOOKED_AT)];
    let name =
        |rest: &[u8]| rest.first().is_some_and(|b| b.is_ascii_whitespace() || matches!(b, b'>' | b'/'));
    let is_root = |at: usize| head[at..].starts_with(b"<svg") && name(&head[at + 4..]);
    let is_prefixed = |at: usize| head[at..].starts_with(b"<svg:svg") && name(&head[at + 8..]);
    memchr::memchr_iter(b'<', head).any(|at| is_root(at) || is_prefixed(at))
}
