//! `Polygons`: what a file says of a cage: polygons with their subdivision tags, and what stands beside them.
use crate::Frame;
use chordal::explicit::{Attribute, Cage};
use serde_json::Value;
use std::collections::BTreeMap;

/// Which surface polygons of a file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonSurface {
    /// The limit of Catmull–Clark subdivision.
    CatmullClark,
    /// The limit of Loop subdivision, of triangles.
    Loop,
    /// Each quad bilinear, each other polygon cut into quads.
    Bilinear,
    /// The polygons themselves, cut into triangles.
    Faceted,
}

/// A cage with what its file says beside it.
///
/// ```
/// use chordal_io::{Content, Limits, obj};
/// let file = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\nt crease 2/1/0 0 1 2.5\n";
/// let Content::Polygons(polygons) = obj::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(polygons.cage.creases(), [([0, 1], 2.5)]);
/// assert_eq!(polygons.texcoords.unwrap().corners, [0; 4]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Polygons {
    /// The polygons, their tags and the scheme.
    pub cage: Cage,
    /// Texture coordinates at the corners of faces.
    pub texcoords: Option<CornerTexcoords>,
    /// Colours, one row a vertex of the cage, and groups, one row a face.
    pub attributes: Vec<Attribute>,
    /// What the values of groups stand for, as in [`crate::Scene::groups`].
    pub groups: BTreeMap<String, Vec<String>>,
    /// The space.
    pub frame: Frame,
    /// The certificate that travels in the file, if it carries one.
    pub certificate: Option<Value>,
}

impl Polygons {
    /// A cage by itself.
    #[must_use]
    pub fn of(cage: Cage, frame: Frame) -> Self {
        let (attributes, groups) = (Vec::new(), BTreeMap::new());
        Self { cage, texcoords: None, attributes, groups, frame, certificate: None }
    }
}

/// Texture coordinates with a topology of their own: corners of neighbouring faces that name the same row hang together there,
/// others are parted by a seam.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerTexcoords {
    /// n × 2, as they are listed in the file.
    pub values: Vec<[f64; 2]>,
    /// One a corner of the cage, face by face: a row of `values`, or [`CornerTexcoords::NONE`].
    pub corners: Vec<u32>,
    /// Where they are interpolated linearly when they are refined.
    pub linear: LinearTexcoords,
}

impl CornerTexcoords {
    /// The row of a corner that names none.
    pub const NONE: u32 = u32::MAX;
}

/// Where refinement interpolates texture coordinates linearly, so that they stay where they are: the rules of OpenSubdiv's
/// `Sdc::Options::FVarLinearInterpolation`, in the numbers of the tag `facevaryinginterpolateboundary`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearTexcoords {
    /// 0: nowhere.
    None,
    /// 1: at corners of their borders.
    CornersOnly,
    /// 2: also where a border forks.
    CornersPlus1,
    /// 3: also where a border ends within the surface, or a piece comes back to one vertex.
    CornersPlus2,
    /// 4: along all borders.
    Boundaries,
    /// 5: everywhere.
    #[default]
    All,
}

impl LinearTexcoords {
    /// All, by their numbers.
    pub const ALL: [Self; 6] =
        [Self::None, Self::CornersOnly, Self::CornersPlus1, Self::CornersPlus2, Self::Boundaries, Self::All];
}
