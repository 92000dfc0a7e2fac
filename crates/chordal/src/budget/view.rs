//! `View`: how a shape is viewed. [`super::Lens`] converts lengths into pixels of the view.
use crate::math::{cross, difference, length, unit};
use std::fmt;
use std::str::FromStr;

/// A distance on the screen in device pixels, finite and > 0. Its text is `1px`; a bare `1` is read too.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Pixels(f64);

impl Pixels {
    /// `pixels` on the screen.
    ///
    /// # Errors
    /// When it is NaN, infinite, zero or negative.
    pub fn new(pixels: f64) -> Result<Self, InvalidView> {
        if pixels.is_finite() && pixels > 0.0 {
            Ok(Self(pixels))
        } else {
            Err(InvalidView(format!("a pixel budget is a finite number greater than 0, not '{pixels}'")))
        }
    }

    /// The number of device pixels.
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }
}

impl fmt::Display for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}px", self.0)
    }
}

impl FromStr for Pixels {
    type Err = InvalidView;
    fn from_str(text: &str) -> Result<Self, InvalidView> {
        let number = text.trim();
        let number = number.strip_suffix("px").unwrap_or(number).trim_end();
        let wrong = || InvalidView(format!("a pixel budget is a finite number greater than 0, not '{text}'"));
        Self::new(number.parse().map_err(|_| wrong())?).map_err(|_| wrong())
    }
}

/// The size of the picture in device pixels; the pixels are square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screen {
    /// Columns, > 0.
    pub width_px: u32,
    /// Rows, > 0.
    pub height_px: u32,
}

/// How space is projected onto the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Perspective projection, as of a pinhole camera.
    Perspective {
        /// The vertical field of view in degrees, between 0 and 180.
        fov_y_deg: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// The height of the picture in the shape's units, > 0.
        height: f64,
    },
}

/// A camera at one position, for work that depends on the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position of the eye.
    pub eye: [f64; 3],
    /// The point in the middle of the picture.
    pub target: [f64; 3],
    /// The upward direction in the picture; not parallel to the line of sight.
    pub up: [f64; 3],
    /// The near plane's depth, below which nothing is drawn, ≥ 0.
    pub near: f64,
    /// The projection.
    pub projection: Projection,
    /// The picture's size.
    pub screen: Screen,
}

/// An eye at any position and in any direction, but at least `distance` from the shape: for assets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinDistanceView {
    /// The smallest distance between the eye and the bounding box of the surface, > 0.
    pub distance: f64,
    /// The projection.
    pub projection: Projection,
    /// The picture's size.
    pub screen: Screen,
}

/// How a shape is viewed.
///
/// ```
/// use chordal::View;
/// let view: View = "1920x1080 fov=45 dist=4".parse()?;
/// assert_eq!(view.to_string(), "1920x1080 fov=45 dist=4");
/// assert!("1920x1080 fov=180 dist=4".parse::<View>().is_err());
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// A camera at one position.
    Camera(Camera),
    /// Any eye that keeps a minimum distance.
    MinDistance(MinDistanceView),
}

impl Projection {
    fn checked(self) -> Result<Self, InvalidView> {
        match self {
            Self::Perspective { fov_y_deg } if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) => Err(InvalidView(
                format!("fov is a number of degrees between 0 and 180, both excluded, not '{fov_y_deg}'"),
            )),
            Self::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                Err(InvalidView(format!("height is a finite length greater than 0, not '{height}'")))
            }
            good => Ok(good),
        }
    }
}

impl View {
    /// The same view after checks: sizes and distances are finite and positive, and the axes are independent.
    ///
    /// # Errors
    /// [`InvalidView`] with the reason.
    pub fn checked(self) -> Result<Self, InvalidView> {
        let (projection, screen) = match &self {
            Self::Camera(camera) => (camera.projection, camera.screen),
            Self::MinDistance(closest) => (closest.projection, closest.screen),
        };
        projection.checked()?;
        if screen.width_px == 0 || screen.height_px == 0 {
            return Err(InvalidView("the screen must be at least 1x1 pixels".into()));
        }
        match &self {
            Self::MinDistance(c) if !(c.distance > 0.0 && c.distance.is_finite()) => {
                Err(InvalidView(format!("dist is a finite length greater than 0, not '{}'", c.distance)))
            }
            Self::Camera(c) if !(c.near >= 0.0 && c.near.is_finite()) => {
                Err(InvalidView(format!("near is a finite length, 0 or more, not '{}'", c.near)))
            }
            Self::Camera(c) if c.axes().is_none() => Err(InvalidView(
                "eye, target and up must be finite, apart from each other, and not in one line".into(),
            )),
            _ => Ok(self),
        }
    }
}

impl Camera {
    /// The unit vectors to the right, up and forward; `None` when eye, target and up give none. The error of
    /// forward is at most 4 units in the last place of each coordinate; right and up are as uncertain as `up`
    /// is close to forward.
    pub(crate) fn axes(&self) -> Option<[[f64; 3]; 3]> {
        let forward = unit(difference(self.target, self.eye))?;
        let right = cross(forward, unit(self.up)?);
        // Below this, rounding alone would decide the upward direction.
        if length(right) <= 64.0 * f64::EPSILON {
            return None;
        }
        let right = unit(right)?;
        Some([right, cross(right, forward), forward])
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (projection, screen) = match self {
            Self::Camera(camera) => (camera.projection, camera.screen),
            Self::MinDistance(closest) => (closest.projection, closest.screen),
        };
        write!(f, "{}x{}", screen.width_px, screen.height_px)?;
        match projection {
            Projection::Perspective { fov_y_deg } => write!(f, " fov={fov_y_deg}")?,
            Projection::Orthographic { height } => write!(f, " height={height}")?,
        }
        match self {
            Self::MinDistance(closest) => write!(f, " dist={}", closest.distance),
            Self::Camera(camera) => {
                for (name, [x, y, z]) in [("eye", camera.eye), ("target", camera.target), ("up", camera.up)] {
                    write!(f, " {name}={x},{y},{z}")?;
                }
                write!(f, " near={}", camera.near)
            }
        }
    }
}

impl FromStr for View {
    type Err = InvalidView;

    /// Reads `1920x1080 fov=45 dist=4`, `1920x1080 height=3` (parallel rays) or, with
    /// `eye=x,y,z target=x,y,z` and optionally `up=x,y,z` (default 0,0,1, or 0,1,0 when the eye looks along
    /// z) and `near=n`, a camera.
    fn from_str(text: &str) -> Result<Self, InvalidView> {
        let mut words = text.split_whitespace();
        let size =
            words.next().ok_or_else(|| InvalidView("a view reads like '1920x1080 fov=45 dist=4'".into()))?;
        let screen = parse_screen(size)?;
        let mut fields: [(&str, Option<&str>); 7] = [
            ("fov", None),
            ("height", None),
            ("dist", None),
            ("eye", None),
            ("target", None),
            ("up", None),
            ("near", None),
        ];
        for word in words {
            let (key, value) =
                word.split_once('=').ok_or_else(|| InvalidView(format!("'{word}' is not NAME=VALUE")))?;
            let field = fields.iter_mut().find(|field| field.0 == key);
            let names = "fov, height, dist, eye, target, up and near";
            let field = field.ok_or_else(|| InvalidView(format!("a view has no '{key}'; it has {names}")))?;
            if field.1.replace(value).is_some() {
                return Err(InvalidView(format!("'{key}' is given twice")));
            }
        }
        let [fov, height, dist, eye, target, up, near] = fields.map(|field| field.1);
        let number = |name: &str, value: &str| {
            value.parse::<f64>().map_err(|_| InvalidView(format!("{name}: '{value}' is not a number")))
        };
        let projection = match (fov, height) {
            (Some(fov), None) => Projection::Perspective { fov_y_deg: number("fov", fov)? },
            (None, Some(height)) => Projection::Orthographic { height: number("height", height)? },
            _ => {
                return Err(InvalidView(
                    "a view needs either fov=DEGREES or height=LENGTH (parallel rays)".into(),
                ));
            }
        };
        let view = match (eye, target, dist) {
            (Some(eye), Some(target), None) => {
                let (eye, target) = (parse_point("eye", eye)?, parse_point("target", target)?);
                // A direction of view along z leaves z no meaning as up.
                let along_z = eye[0] == target[0] && eye[1] == target[1];
                let default_up = if along_z { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
                let up = up.map_or(Ok(default_up), |up| parse_point("up", up))?;
                let near = near.map_or(Ok(0.0), |near| number("near", near))?;
                Self::Camera(Camera { eye, target, up, near, projection, screen })
            }
            (None, None, dist) if up.is_none() && near.is_none() => {
                let distance = match (dist, projection) {
                    (Some(dist), _) => number("dist", dist)?,
                    // With parallel rays the picture is the same from every distance.
                    (None, Projection::Orthographic { .. }) => 1.0,
                    (None, Projection::Perspective { .. }) => {
                        return Err(InvalidView(
                            "a view needs dist=LENGTH, or eye=x,y,z and target=x,y,z".into(),
                        ));
                    }
                };
                Self::MinDistance(MinDistanceView { distance, projection, screen })
            }
            _ => return Err(InvalidView("eye, target, up and near belong together and exclude dist".into())),
        };
        view.checked()
    }
}

fn parse_screen(text: &str) -> Result<Screen, InvalidView> {
    let wrong = || InvalidView(format!("the size of the screen reads like 1920x1080, not '{text}'"));
    let (w, h) = text.split_once('x').ok_or_else(wrong)?;
    Ok(Screen { width_px: w.parse().map_err(|_| wrong())?, height_px: h.parse().map_err(|_| wrong())? })
}

fn parse_point(name: &str, text: &str) -> Result<[f64; 3], InvalidView> {
    let wrong = || InvalidView(format!("{name} reads like 1,2,3, not '{text}'"));
    let parts: Vec<f64> = text.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    let point: [f64; 3] = parts.try_into().map_err(|_| wrong())?;
    if point.iter().all(|x| x.is_finite()) { Ok(point) } else { Err(wrong()) }
}

/// The reason why a view or a number of pixels is invalid, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidView(String);

impl fmt::Display for InvalidView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidView {}
