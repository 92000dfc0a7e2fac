//! The names of subdivision tags in an OBJ, and of their values.
use crate::text::LineTokens;
use chordal::explicit::subdivision::{Boundary, Scheme};

/// Tags that mark the polygons as a cage, whether or not all of their content is supported.
pub(super) const KNOWN: [&str; 13] = [
    "crease",
    "corner",
    "hole",
    "interpolateboundary",
    "creasemethod",
    "facevaryinginterpolateboundary",
    "facevaryingpropagatecorners",
    "smoothtriangles",
    "vertexedit",
    "edgeedit",
    "faceedit",
    SCHEME,
    REFINED,
];

/// Chordal's own tag for a scheme, since OBJ has none.
pub(super) const SCHEME: &str = "scheme";

/// Chordal's own tag for a cage after a round of refinement, in which implicit corners are listed.
pub(super) const REFINED: &str = "refined";

/// Whether the words after `t` start with the name of a tag.
pub(super) fn is_tag(mut words: LineTokens) -> bool {
    words.next().is_some_and(|name| KNOWN.iter().any(|known| known.as_bytes() == name))
}

/// The scheme in the words after `t`, if they are a scheme tag.
pub(super) fn scheme_of(mut words: LineTokens) -> Option<Scheme> {
    let name = words.next().filter(|name| *name == SCHEME.as_bytes()).and_then(|_| words.nth(1))?;
    scheme_named(name)
}

/// The scheme of a value of the scheme tag.
pub(super) fn scheme_named(name: &[u8]) -> Option<Scheme> {
    Scheme::ALL.into_iter().find(|scheme| scheme.name().as_bytes() == name)
}

/// The values of `interpolateboundary` for boundary rules.
pub(super) const BOUNDARIES: [(Boundary, u32); 3] =
    [(Boundary::None, 0), (Boundary::EdgeAndCorner, 1), (Boundary::EdgeOnly, 2)];
