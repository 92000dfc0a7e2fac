//! `Polygons`: a polygon cage of a file, with its subdivision tags, attributes and frame.
use crate::{Frame, SceneAssets};
use chordal::explicit::subdivision::Scheme;
use chordal::explicit::{Attribute, Cage};
use serde_json::Value;
use std::collections::BTreeMap;

/// Which surface the polygons of a file define.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonSurface {
    /// The limit of subdivision.
    Limit(Scheme),
    /// The polygons themselves, cut into triangles.
    Faceted,
}

/// A cage with the other data of its file.
///
/// ```
/// use chordal_io::{Content, Limits, obj};
/// let file = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\nt crease 2/1/0 0 1 2.5\n";
/// let Content::Polygons(polygons) = obj::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(polygons.cage.creases(), [([0, 1], 2.5)]);
/// assert_eq!(polygons.cage.texcoords().unwrap().corners, [0; 4]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Polygons {
    /// The polygons, their tags, the scheme, and texture coordinates at the corners of faces.
    pub cage: Cage,
    /// Colours, one row for each vertex of the cage, and groups, one row for each face.
    pub attributes: Vec<Attribute>,
    /// The names of group values, as in [`crate::Scene::groups`].
    pub groups: BTreeMap<String, Vec<String>>,
    /// The materials of its faces with their textures, as in [`crate::Scene::assets`].
    pub assets: Box<SceneAssets>,
    /// The coordinate frame.
    pub frame: Frame,
    /// The certificate in the file, if it carries one.
    pub certificate: Option<Value>,
}

impl Polygons {
    /// A cage without other data.
    #[must_use]
    pub fn from_cage(cage: Cage, frame: Frame) -> Self {
        let (attributes, groups) = (Vec::new(), BTreeMap::new());
        let assets = Box::default();
        Self { cage, attributes, groups, assets, frame, certificate: None }
    }
}
