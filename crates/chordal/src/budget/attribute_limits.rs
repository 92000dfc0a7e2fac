//! `AttributeLimits`: how far texture coordinates and normals of a simplified mesh may be from the
//! original's.
use std::fmt;

/// Optional limits on the attributes of a simplified mesh, compared at nearest points of the two surfaces, in
/// both directions.
///
/// They are used beside a limit in length or pixels. They are measured, not proved: at four samples on each
/// face of either mesh. Under flat shading the normals are those of the faces, and have no limit.
///
/// ```
/// use chordal::budget::attributes::AttributeLimits;
/// let limits = AttributeLimits::new(Some(0.01), None)?; // a hundredth of the texture
/// assert_eq!(limits.texcoord(), Some(0.01));
/// assert!(AttributeLimits::new(None, Some(200.0)).is_err());
/// # Ok::<(), chordal::budget::attributes::InvalidAttributeLimit>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttributeLimits {
    texcoord: Option<f64>,
    normal_deg: Option<f64>,
}

/// The error for a limit out of range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidAttributeLimit {
    /// A distance of texture coordinates that is not a finite number above 0.
    Texcoord(f64),
    /// An angle that is not above 0 and at most 180 degrees.
    Normal(f64),
}

impl fmt::Display for InvalidAttributeLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Texcoord(most) => {
                write!(f, "a distance of texture coordinates is above 0 and finite, not {most}")
            }
            Self::Normal(most) => {
                write!(f, "an angle between normals is above 0 and at most 180 degrees, not {most}")
            }
        }
    }
}

impl std::error::Error for InvalidAttributeLimit {}

impl AttributeLimits {
    /// Limits on the distance of texture coordinates, in sides of the texture, and on the angle between
    /// normals, in degrees.
    ///
    /// # Errors
    /// When a distance is not finite or not above 0, or an angle is not above 0 and at most 180.
    pub fn new(texcoord: Option<f64>, normal_deg: Option<f64>) -> Result<Self, InvalidAttributeLimit> {
        if let Some(most) = texcoord.filter(|most| !(*most > 0.0 && most.is_finite())) {
            return Err(InvalidAttributeLimit::Texcoord(most));
        }
        if let Some(most) = normal_deg.filter(|most| !(*most > 0.0 && *most <= 180.0)) {
            return Err(InvalidAttributeLimit::Normal(most));
        }
        Ok(Self { texcoord, normal_deg })
    }

    /// The largest distance of texture coordinates.
    #[must_use]
    pub fn texcoord(&self) -> Option<f64> {
        self.texcoord
    }

    /// The largest angle between normals, in degrees.
    #[must_use]
    pub fn normal_deg(&self) -> Option<f64> {
        self.normal_deg
    }

    /// Whether there is a limit.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.texcoord.is_some() || self.normal_deg.is_some()
    }
}
