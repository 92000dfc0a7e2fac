//! `Normals`: the normals of triangles, as a user requests them.
use super::file_rows::unsupported;
use crate::MeshFailure;
use chordal::budget::advice::Message;
use chordal::explicit::{NormalWeight, Semantic, Shading, with_normals};
use chordal_io::{Format, Scene};
use std::fmt;
use std::str::FromStr;

/// The normals of triangles.
///
/// ```
/// use chordal_verbs::Normals;
/// assert_eq!("crease=45deg".parse(), Ok(Normals::Crease { angle_deg: 45.0 }));
/// assert_eq!("crease".parse(), Ok(Normals::Crease { angle_deg: 30.0 }));
/// assert!("crease=200deg".parse::<Normals>().is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Normals {
    /// The normals of the shape. A mesh without normals gets [`Normals::Crease`] of 30° in formats that hold normals beside
    /// the positions or identify vertices by their bits (OBJ, glTF), and no normals in other formats. A mesh of a glTF
    /// without normals gets none in any format: glTF defines that it is shaded flat.
    #[default]
    Auto,
    /// The normals of the shape, if it has any.
    Keep,
    /// Flat: one normal a triangle.
    Flat,
    /// Smooth everywhere.
    Smooth,
    /// Smooth across edges whose dihedral angle is at most this.
    Crease {
        /// From 0 to 180.
        angle_deg: f64,
    },
    /// Smooth within the smoothing groups of the file.
    Groups,
}

/// The start of the note on normals, before their name.
const COMPUTED: &str = "normals were computed: ";

/// The default crease angle, as in most modellers.
const USUAL_CREASE_DEG: f64 = 30.0;

impl Normals {
    /// The normals for triangles from a file of a format. glTF defines that a mesh without normals is shaded flat (Khronos,
    /// glTF 2.0, section 3.7.2.1), so that none are computed for it unless they are requested.
    pub(crate) fn of_file(self, from: Format) -> Self {
        let says_flat = from.is_gltf();
        if self == Self::Auto && says_flat { Self::Keep } else { self }
    }

    /// Sets the normals of every part of a scene, and adds a note. The format `from` determines which vertices are one
    /// position; `to` is the output format.
    pub(crate) fn apply(
        self,
        scene: &mut Scene,
        [from, to]: [Format; 2],
        notes: &mut Vec<Message>,
    ) -> Result<(), MeshFailure> {
        let normals = self.of_file(from);
        let mut n_computed = 0;
        for part in &mut scene.parts {
            let has_some = part.mesh.attribute(&Semantic::Normal).is_some() || part.mesh.faces().is_empty();
            let Some(shading) = normals.shading(has_some, to) else { continue };
            part.mesh = with_normals(&part.mesh, from.topology(), shading).map_err(unsupported)?;
            n_computed += 1;
        }
        if n_computed > 0 {
            let name = if self == Self::Auto { Self::USUAL } else { self };
            notes.push(format!("{COMPUTED}{name}").into());
        }
        Ok(())
    }

    /// The method by which normals were computed, from a note that [`Self::apply`] has added.
    pub(crate) fn from_note(note: &str) -> Option<Self> {
        note.strip_prefix(COMPUTED)?.parse().ok()
    }

    /// The normals of triangles without any, unless others are requested.
    pub(crate) const USUAL: Self = Self::Crease { angle_deg: USUAL_CREASE_DEG };

    pub(crate) fn shading(self, has_some: bool, to: Format) -> Option<Shading> {
        let crease = |angle_deg: f64| Shading::Crease {
            angle_rad: angle_deg.to_radians(),
            weight: NormalWeight::Angle,
        };
        match self {
            Self::Keep => None,
            Self::Auto if has_some || !to.wants_normals() => None,
            Self::Auto => Some(crease(USUAL_CREASE_DEG)),
            Self::Flat => Some(Shading::Flat),
            Self::Smooth => Some(Shading::Smooth(NormalWeight::Angle)),
            Self::Crease { angle_deg } => Some(crease(angle_deg)),
            Self::Groups => Some(Shading::Groups(NormalWeight::Angle)),
        }
    }
}

impl fmt::Display for Normals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Keep => f.write_str("keep"),
            Self::Flat => f.write_str("flat"),
            Self::Smooth => f.write_str("smooth"),
            Self::Crease { angle_deg } => write!(f, "crease={angle_deg}deg"),
            Self::Groups => f.write_str("groups"),
        }
    }
}

/// A text that is not a name of normals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidNormals(String);

impl fmt::Display for InvalidNormals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "normals are auto, keep, flat, smooth, groups, or crease=ANGLE with an angle from 0deg to 180deg, not '{}'",
            self.0
        )
    }
}

impl std::error::Error for InvalidNormals {}

impl FromStr for Normals {
    type Err = InvalidNormals;
    fn from_str(text: &str) -> Result<Self, InvalidNormals> {
        let wrong = || InvalidNormals(text.to_owned());
        Ok(match text {
            "auto" => Self::Auto,
            "keep" => Self::Keep,
            "flat" => Self::Flat,
            "smooth" => Self::Smooth,
            "groups" => Self::Groups,
            "crease" => Self::Crease { angle_deg: USUAL_CREASE_DEG },
            _ => {
                let angle = text.strip_prefix("crease=").ok_or_else(wrong)?;
                let angle_deg = angle.strip_suffix("deg").unwrap_or(angle).parse().map_err(|_| wrong())?;
                if !(0.0..=180.0).contains(&angle_deg) {
                    return Err(wrong());
                }
                Self::Crease { angle_deg }
            }
        })
    }
}
