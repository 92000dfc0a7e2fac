//! `View`: from where a shape is seen, and what a length becomes on that screen.
//!
//! A true point at depth `z` and angle `θ` off the axis, moved by at most `ε` in any direction, moves on the
//! screen by at most `F·ε·√(1+tan²θ)/(z − ε)` pixels, where `F = H/(2·tan(fov/2))`. (Write the two points as
//! `(X, z)` and `(X+a, z+b)`: `|X/z − (X+a)/(z+b)| = |a·z − b·X|/(z(z+b)) ≤ ε·√(z²+|X|²)/(z(z−ε))`.) A bound on
//! the screen has to hold whichever of the two points is the visible one, so the code uses the depth and the
//! angle of the *made* point, which are up to `ε` nearer and wider: `z − 2ε` below.
//!
//! The shorter formula `ε·F/z` that viewers use is its first order on the axis and is low by `1/cos²θ` at the
//! corner of the screen: 1.71 at a vertical field of view of 45° and 16:9.
use crate::math::{Box3, add_up, div_down, div_up, mul_down, mul_up, sqrt_up, sub_down};
use std::fmt;
use std::str::FromStr;

/// A distance on the screen in device pixels, finite and > 0. Reads and shows as `1px`; a bare `1` reads too.
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
        let number = text.trim().trim_end_matches("px").trim();
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

/// How space becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// The vertical field of view in degrees, between 0 and 180.
        fov_y_deg: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// The height of the picture in the shape's units, > 0.
        height: f64,
    },
}

/// One eye at one place: for work that depends on the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: [f64; 3],
    /// The point in the middle of the picture.
    pub target: [f64; 3],
    /// A direction that is up in the picture, not along the line of sight.
    pub up: [f64; 3],
    /// Depth below which nothing is drawn, ≥ 0.
    pub near: f64,
    /// How space becomes a picture.
    pub projection: Projection,
    /// The picture's size.
    pub screen: Screen,
}

/// An eye anywhere, looking anywhere, but never nearer than `distance` to the shape: for assets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The nearest distance between the eye and the box of the surface, > 0.
    pub distance: f64,
    /// How space becomes a picture.
    pub projection: Projection,
    /// The picture's size.
    pub screen: Screen,
}

/// From where a shape is seen.
///
/// ```
/// use chordal::View;
/// let view: View = "1920x1080 fov=45 dist=4".parse()?;
/// assert_eq!(view.to_string(), "1920x1080 fov=45 dist=4");
/// assert!("1920x1080 fov=180 dist=4".parse::<View>().is_err());
/// # Ok::<(), chordal::budget::InvalidView>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// One eye at one place.
    Camera(Camera),
    /// Any eye that keeps its distance.
    Closest(Closest),
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

    /// `tan(fov/2)` from below and above. `libm::tan` is off by less than one unit in the last place and the
    /// conversion to radians by two more, which `tan` magnifies by `x/(sin x·cos x) ≤ (π/2)/cos x`.
    fn half_tan(fov_y_deg: f64) -> (f64, f64) {
        let half = fov_y_deg * (std::f64::consts::PI / 360.0);
        let tan = libm::tan(half);
        // (π/2)·2/cos x of the conversion, 1 of `tan`, 2 of the products below: together less than these 8.
        let slack = 8.0 * f64::EPSILON * (1.0 + 1.0 / libm::cos(half));
        (tan * (1.0 - slack), tan * (1.0 + slack))
    }
}

/// The numbers of a screen that every conversion needs, rounded outward.
struct Lens {
    /// Pixels per unit of `X/z`, from above (perspective), or per unit of length (orthographic).
    focal: f64,
    /// `tan²` of the angle at the corner of the screen, from above; `None` for parallel rays.
    corner_tan_sq: Option<f64>,
}

impl Lens {
    fn new(projection: Projection, screen: Screen) -> Self {
        let (w, h) = (f64::from(screen.width_px), f64::from(screen.height_px));
        match projection {
            Projection::Perspective { fov_y_deg } => {
                let (low, high) = Projection::half_tan(fov_y_deg);
                let wide = mul_up(high, div_up(w, h));
                let corner = add_up(mul_up(high, high), mul_up(wide, wide));
                Self { focal: div_up(h, mul_down(2.0, low)), corner_tan_sq: Some(corner) }
            }
            Projection::Orthographic { height } => Self { focal: div_up(h, height), corner_tan_sq: None },
        }
    }
}

impl View {
    /// The same view, checked: sizes and distances finite and positive, the axes independent.
    ///
    /// # Errors
    /// [`InvalidView`] with what is wrong.
    pub fn checked(self) -> Result<Self, InvalidView> {
        let (projection, screen) = match &self {
            Self::Camera(camera) => (camera.projection, camera.screen),
            Self::Closest(closest) => (closest.projection, closest.screen),
        };
        projection.checked()?;
        if screen.width_px == 0 || screen.height_px == 0 {
            return Err(InvalidView("the screen must be at least 1x1 pixels".into()));
        }
        match &self {
            Self::Closest(c) if !(c.distance > 0.0 && c.distance.is_finite()) => {
                Err(InvalidView(format!("dist is a finite length greater than 0, not '{}'", c.distance)))
            }
            Self::Camera(c) if !(c.near >= 0.0 && c.near.is_finite()) => {
                Err(InvalidView(format!("near is a finite length, 0 or more, not '{}'", c.near)))
            }
            Self::Camera(c) if Axes::new(c).is_none() => Err(InvalidView(
                "eye, target and up must be finite, apart from each other, and not in one line".into(),
            )),
            _ => Ok(self),
        }
    }

    /// The distance on the screen, in pixels and bounded from above, that a point of `place` can move when the
    /// shape is off by at most `error` (≥ 0). `None` when there is no bound: the eye is too close.
    #[must_use]
    pub fn pixels_of(&self, error: f64, place: &Box3) -> Option<f64> {
        let found = match self {
            Self::Closest(closest) => {
                let lens = Lens::new(closest.projection, closest.screen);
                let Some(corner) = lens.corner_tan_sq else { return Some(mul_up(lens.focal, error)) };
                // z = d·cosθ with d ≥ distance − error for the made point, and 1/cosθ = √(1+tan²θ).
                let secant = sqrt_up(add_up(1.0, corner));
                let depth = div_down(sub_down(closest.distance, error), secant);
                spread(lens.focal, error, secant, sub_down(depth, error))
            }
            Self::Camera(camera) => {
                let lens = Lens::new(camera.projection, camera.screen);
                let sight = Axes::new(camera)?.sight(place, error);
                if sight.far < camera.near {
                    return Some(0.0);
                }
                let Some(corner) = lens.corner_tan_sq else { return Some(mul_up(lens.focal, error)) };
                let depth = if sight.near > camera.near { sight.near } else { camera.near };
                let tan_sq = sight.tan_sq.map_or(corner, |t| if t < corner { t } else { corner });
                spread(lens.focal, error, sqrt_up(add_up(1.0, tan_sq)), sub_down(depth, error))
            }
        }?;
        found.is_finite().then_some(found)
    }

    /// The largest length (up to rounding) of which [`View::pixels_of`] at `place` is at most `pixels`. `None` when there is no such length.
    #[must_use]
    pub fn length_of(&self, pixels: Pixels, place: &Box3) -> Option<f64> {
        let wanted = pixels.get();
        let fits = |length: f64| length > 0.0 && self.pixels_of(length, place).is_some_and(|p| p <= wanted);
        // `pixels_of` grows with the length, so a bisection over its exponent and mantissa is safe and exact:
        // positive floats are ordered as their bits are.
        let (mut low, mut high) = (0_u64, f64::MAX.to_bits());
        if fits(f64::from_bits(high)) {
            return Some(f64::MAX);
        }
        while high - low > 1 << 24 {
            let middle = low + (high - low) / 2;
            if fits(f64::from_bits(middle)) { low = middle } else { high = middle }
        }
        let length = f64::from_bits(low);
        fits(length).then_some(length)
    }
}

/// `focal·error·secant/room`, from above; `None` when there is no room before the eye.
fn spread(focal: f64, error: f64, secant: f64, room: f64) -> Option<f64> {
    if error == 0.0 {
        return Some(0.0);
    }
    (room > 0.0).then(|| div_up(mul_up(mul_up(focal, error), secant), room))
}

/// The camera's axes.
struct Axes {
    eye: glam::DVec3,
    right: glam::DVec3,
    up: glam::DVec3,
    forward: glam::DVec3,
}

/// What a camera sees of a box whose points may move by some error.
struct Sight {
    /// Smallest depth, from below.
    near: f64,
    /// Largest depth, from above.
    far: f64,
    /// Largest `tan²` of the angle off the axis, from above; `None` when the box reaches the plane of the eye.
    tan_sq: Option<f64>,
}

impl Axes {
    fn new(camera: &Camera) -> Option<Self> {
        let eye = glam::DVec3::from(camera.eye);
        let forward = (glam::DVec3::from(camera.target) - eye).try_normalize()?;
        let up_hint = glam::DVec3::from(camera.up).try_normalize()?;
        let right = forward.cross(up_hint);
        // Closer to one line than this, rounding alone would decide where up is.
        if right.length() <= 64.0 * f64::EPSILON {
            return None;
        }
        let right = right.try_normalize()?;
        Some(Self { eye, right, up: right.cross(forward), forward })
            .filter(|a| a.forward.is_finite() && a.up.is_finite())
    }

    fn sight(&self, place: &Box3, error: f64) -> Sight {
        let mut sight = Sight { near: f64::INFINITY, far: f64::NEG_INFINITY, tan_sq: Some(0.0) };
        for corner in 0..8 {
            let pick = |k: usize| if corner >> k & 1 == 0 { place.min[k] } else { place.max[k] };
            let to = glam::DVec3::new(pick(0), pick(1), pick(2)) - self.eye;
            // Three roundings per product and sum, two for the difference, and the axes' own four each.
            let slack = add_up(error, 16.0 * f64::EPSILON * (to.abs().element_sum()));
            let depth = to.dot(self.forward);
            let (low, high) = (sub_down(depth, slack), add_up(depth, slack));
            sight.near = if low < sight.near { low } else { sight.near };
            sight.far = if high > sight.far { high } else { sight.far };
            let (x, y) = (add_up(to.dot(self.right).abs(), slack), add_up(to.dot(self.up).abs(), slack));
            sight.tan_sq = match sight.tan_sq {
                Some(most) if low > 0.0 => {
                    let tan_sq = div_up(add_up(mul_up(x, x), mul_up(y, y)), mul_down(low, low));
                    Some(if tan_sq > most { tan_sq } else { most })
                }
                _ => None,
            };
        }
        sight
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (projection, screen) = match self {
            Self::Camera(camera) => (camera.projection, camera.screen),
            Self::Closest(closest) => (closest.projection, closest.screen),
        };
        write!(f, "{}x{}", screen.width_px, screen.height_px)?;
        match projection {
            Projection::Perspective { fov_y_deg } => write!(f, " fov={fov_y_deg}")?,
            Projection::Orthographic { height } => write!(f, " height={height}")?,
        }
        match self {
            Self::Closest(closest) => write!(f, " dist={}", closest.distance),
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

    /// Reads `1920x1080 fov=45 dist=4`, `1920x1080 height=3` (parallel rays) or, with `eye=x,y,z target=x,y,z`
    /// and optionally `up=x,y,z` (default 0,0,1, or 0,1,0 when the eye looks along z) and `near=n`, a camera.
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
                let along_z = eye[0] == target[0] && eye[1] == target[1];
                let default_up = if along_z { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
                let up = up.map_or(Ok(default_up), |up| parse_point("up", up))?;
                let near = near.map_or(Ok(0.0), |near| number("near", near))?;
                Self::Camera(Camera { eye, target, up, near, projection, screen })
            }
            (None, None, dist) if up.is_none() && near.is_none() => {
                let distance = match (dist, projection) {
                    (Some(dist), _) => number("dist", dist)?,
                    // Parallel rays look the same from every distance.
                    (None, Projection::Orthographic { .. }) => 1.0,
                    (None, Projection::Perspective { .. }) => {
                        return Err(InvalidView(
                            "a view needs dist=LENGTH, or eye=x,y,z and target=x,y,z".into(),
                        ));
                    }
                };
                Self::Closest(Closest { distance, projection, screen })
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

/// What is wrong with a view or a number of pixels, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidView(String);

impl fmt::Display for InvalidView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidView {}
