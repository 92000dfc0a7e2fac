//! `Lens`: a view prepared for converting lengths into pixels and back, at many places.
//!
//! A true point `(X, z)`, `z` its depth and `X` its offset from the axis, and an approximating point
//! `(X+a, z+b)` with `a² + b² ≤ ε²` lie on the screen at a distance, in units of `F = H/(2·tan(fov/2))`, of
//!
//! `|X/z − (X+a)/(z+b)| = |a·z − b·X| / (z·(z+b)) ≤ ε·√(z²+|X|²) / (z·(z+b)) = ε·sec θ / (z+b)`,
//!
//! where `θ` is the angle off the axis of the first point and `z+b` the depth of the second. The two points
//! may be exchanged. So if the visible point is at an angle of at most `C`, the angle of the screen's corner,
//! and the other one is at least `z − ε` deep, the distance is at most `ε·sec C/(z − ε)`.
//!
//! *Camera.* Let the place have depths from `z₀` and angles up to `θ₀`, and let `n` be the near plane. Claim:
//! with `D = max(z₀, n)`, the distance is at most `ε·sec(min(θ₀, C))/(D − ε)`. When `θ₀ ≤ C`, take the true
//! point first: its angle is at most `θ₀`; the approximating point is at least `D − ε` deep, because it is
//! visible (`≥ n`) and near the place (`≥ z₀ − ε`), or its partner is visible and in the place (`≥ D`). When
//! `C < θ₀`, take the visible point first: its angle is at most `C`; the other one is at least `D − ε` deep,
//! because it is the approximating one and its partner is `≥ D` deep, or because it is the true one, so
//! `≥ z₀`, and its visible partner is `≥ n`.
//!
//! *Minimum distance.* The true point is at least `d` from the eye, which looks anywhere. If the true point
//! is visible, at `θ`, it is `d·cos θ` deep, and `ε·sec θ/(d·cos θ − ε)` is largest at `θ = C`. If the
//! approximating point is visible, the true one lies outside the cone of angle `C` by at most `ε`, so by an
//! angle of at most `asin(ε/d)`, and its depth is at least `cos C·√(d²−ε²) − ε·sin C`, which is
//! `≥ d·cos C − ε` as long as `ε < d·cos C`. So with `D = d·cos C` the bound is the same: `ε·sec C/(D − ε)`.
//!
//! All of these are `p = s·ε/(D − ε)`, which grows with `ε`; its inverse is `ε = D/(1 + s/p)`. Parallel rays
//! move on the screen by at most `ε·H/height`.
//!
//! The shorter formula `ε·F/z` that viewers use is the first-order term on the axis. It is too low by
//! `1/cos²θ` at the corner of the screen: 1.71 at a vertical field of view of 45° and 16:9.
use super::view::{Camera, MinDistanceView, Pixels, Projection, Screen, View};
use crate::math::{Box3, add_up, div_down, div_up, greater, lesser, mul_down, mul_up, sqrt_up, sub_down};

/// A prepared view: build it once with [`View::lens`] and use it for many places.
///
/// ```
/// use chordal::{View, math::Box3};
/// let view: View = "1000x1000 fov=90 eye=0,0,-10 target=0,0,0".parse()?;
/// let scale = view.lens().scale_at(&Box3 { min: [0.0; 3], max: [0.0; 3] });
/// // 500 pixels a unit at depth 1, so 50 at depth 10.
/// let length = scale.length_of("1px".parse()?).unwrap();
/// assert!(length < 0.02 && length > 0.0199);
/// assert!(scale.pixels_of(length).unwrap() <= 1.0);
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Pixels per unit of `X/z`, or per unit of length for parallel rays, rounded up; ∞ when no bound exists.
    focal: f64,
    /// `sec C`, rounded up; `None` for parallel rays.
    corner_secant: Option<f64>,
    eye: EyePosition,
}

/// Where the eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EyePosition {
    Anywhere { distance: f64 },
    At { eye: [f64; 3], forward: [f64; 3], near: f64 },
}

/// The scale of a lens at one place, for converting lengths there into pixels and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelScale {
    /// `F·sec(min(θ₀, C))`, rounded up.
    scale: f64,
    /// `D`, rounded down; `None` for parallel rays.
    depth: Option<f64>,
    /// Errors below this leave all points in front of the near plane, so they are invisible.
    hidden: f64,
}

impl View {
    /// Prepares the view for many places. A view that [`View::checked`] refuses gives no bound anywhere.
    #[must_use]
    pub fn lens(&self) -> Lens {
        self.try_lens().unwrap_or(Lens {
            focal: f64::INFINITY,
            corner_secant: None,
            eye: EyePosition::Anywhere { distance: 0.0 },
        })
    }

    fn try_lens(&self) -> Option<Lens> {
        Some(match self.checked().ok()? {
            Self::MinDistance(MinDistanceView { distance, projection, screen }) => {
                Lens::new(projection, screen, EyePosition::Anywhere { distance })
            }
            Self::Camera(camera) => {
                let [_, _, forward] = camera.axes()?;
                let position = EyePosition::At { eye: camera.eye, forward, near: camera.near };
                Lens::new(camera.projection, camera.screen, position)
            }
        })
    }

    /// An upper bound of the screen distance, in pixels, between a point of `place` and a point at most
    /// `error` (≥ 0) away from it, when one of the two is on the screen and not in front of the near plane.
    /// `None` when there is no bound because the eye is too close.
    #[must_use]
    pub fn pixels_of(&self, error: f64, place: &Box3) -> Option<f64> {
        self.lens().scale_at(place).pixels_of(error)
    }

    /// An upper bound of the screen distance between the ends of two successive steps, when one of the two
    /// ends is visible. The steps are `first` and `second` pixels by [`View::pixels_of`], each with a point
    /// of its place. The bound is a little more than their sum, since the point between the two may be off
    /// the screen and nearer to the eye. `None` when there is no bound.
    ///
    /// *Why.* Let `p` and `q` be the two, and `a = p/F` and `b = q/F`, so that the lengths are at most
    /// `a/(1+a)` and `b/(1+b)` of the depth `D` of the place. If the end of the first step is visible, the
    /// secant of the point between is at most `1+a` times that of the corner, and the far end is at least `D`
    /// less both lengths deep. So the second step is at most `q·(1+a)²/(1−ab)`, and the sum is at most
    /// `(p + q + 2pq/F)/(1 − ab)`. The formula is symmetric, so it also holds when the other end is visible.
    /// A step that a near plane hides completely is shorter than the other one, and is counted as just as long.
    #[must_use]
    pub fn pixels_of_two_steps(&self, first: f64, second: f64) -> Option<f64> {
        if second == 0.0 {
            return Some(first);
        }
        let (projection, screen, near) = match self {
            Self::MinDistance(MinDistanceView { projection, screen, .. }) => (projection, screen, 0.0),
            Self::Camera(Camera { projection, screen, near, .. }) => (projection, screen, *near),
        };
        // A step that the near plane hides has 0 pixels, but its far end may be seen after the
        // other step: see the last sentence of the doc above.
        let first = if near > 0.0 && first < second { second } else { first };
        if first == 0.0 {
            return Some(second);
        }
        let sum = add_up(first, second);
        let Projection::Perspective { fov_y_deg } = projection else { return Some(sum) };
        // The smallest focal length makes `product / focal` largest, so each rounding errs upwards.
        let (_, high) = half_tan(*fov_y_deg);
        let focal = div_down(f64::from(screen.height_px), mul_up(2.0, high));
        let product = div_up(mul_up(first, second), focal);
        let denominator = sub_down(1.0, div_up(product, focal));
        let pixels = div_up(add_up(sum, mul_up(2.0, product)), denominator);
        (denominator > 0.0 && pixels.is_finite()).then_some(pixels)
    }

    /// The largest length, up to rounding, for which [`View::pixels_of`] at `place` is at most `pixels`.
    /// `None` when there is no such length.
    #[must_use]
    pub fn length_of(&self, pixels: Pixels, place: &Box3) -> Option<f64> {
        self.lens().scale_at(place).length_of(pixels)
    }
}

impl MinDistanceView {
    /// Pixels per unit of length at depth 1 in the middle of the picture, `height/(2·tan(fov/2))`, rounded
    /// up; none for parallel rays.
    ///
    /// ```
    /// use chordal::View;
    /// let View::MinDistance(view) = "1000x1000 fov=90 dist=1".parse::<View>()? else { panic!() };
    /// assert!((view.focal_px().unwrap() - 500.0).abs() < 1e-9);
    /// # Ok::<(), chordal::budget::camera::InvalidView>(())
    /// ```
    #[must_use]
    pub fn focal_px(&self) -> Option<f64> {
        let Projection::Perspective { fov_y_deg } = self.projection else { return None };
        let (low, _) = half_tan(fov_y_deg);
        (low > 0.0).then(|| div_up(f64::from(self.screen.height_px), mul_down(2.0, low)))
    }
}

impl Lens {
    fn new(projection: Projection, screen: Screen, position: EyePosition) -> Self {
        let (w, h) = (f64::from(screen.width_px), f64::from(screen.height_px));
        match projection {
            Projection::Perspective { fov_y_deg } => {
                // Both ends of tan(fov/2) are used, each where it gives more pixels: the low one
                // for the focal length, the high one for the angle of the corner.
                let (low, high) = half_tan(fov_y_deg);
                let wide = mul_up(high, div_up(w, h));
                let corner_sq = add_up(mul_up(high, high), mul_up(wide, wide));
                // So close to 180° that rounding hides the difference: no bound.
                let focal = if low > 0.0 { div_up(h, mul_down(2.0, low)) } else { f64::INFINITY };
                Self { focal, corner_secant: Some(sqrt_up(add_up(1.0, corner_sq))), eye: position }
            }
            Projection::Orthographic { height } => {
                Self { focal: div_up(h, height), corner_secant: None, eye: position }
            }
        }
    }

    /// The pixel scale for the points of `place`. For [`View::MinDistance`] it is the same everywhere.
    #[must_use]
    pub fn scale_at(&self, place: &Box3) -> PixelScale {
        if place.is_empty() {
            return PixelScale { scale: 0.0, depth: None, hidden: f64::INFINITY };
        }
        match (self.eye, self.corner_secant) {
            (EyePosition::Anywhere { .. }, None) => {
                PixelScale { scale: self.focal, depth: None, hidden: 0.0 }
            }
            (EyePosition::Anywhere { distance }, Some(secant)) => PixelScale {
                scale: mul_up(self.focal, secant),
                depth: Some(div_down(distance, secant)),
                hidden: 0.0,
            },
            (EyePosition::At { eye, forward, near }, corner) => {
                let extent = ViewExtent::from_eye(place, eye, forward);
                // An error that is shorter than this gap reaches no point in front of the near
                // plane.
                let hidden = if extent.far < near { sub_down(near, extent.far) } else { 0.0 };
                let Some(corner) = corner else {
                    return PixelScale { scale: self.focal, depth: None, hidden };
                };
                // D and sec(min(θ₀, C)) of the derivation.
                let depth = greater(extent.near, near);
                let secant = sqrt_up(add_up(1.0, mul_up(extent.tan, extent.tan)));
                let secant = lesser(secant, corner);
                PixelScale { scale: mul_up(self.focal, secant), depth: Some(depth), hidden }
            }
        }
    }
}

impl PixelScale {
    /// [`View::pixels_of`] at this place.
    #[must_use]
    pub fn pixels_of(&self, error: f64) -> Option<f64> {
        if error == 0.0 || (0.0 < error && error < self.hidden) {
            return Some(0.0);
        }
        let numerator = mul_up(self.scale, error);
        let pixels = match self.depth {
            None => numerator,
            Some(depth) => {
                let remaining_depth = sub_down(depth, error);
                if remaining_depth > 0.0 { div_up(numerator, remaining_depth) } else { f64::INFINITY }
            }
        };
        (error > 0.0 && pixels.is_finite()).then_some(pixels)
    }

    /// [`View::length_of`] at this place.
    #[must_use]
    pub fn length_of(&self, pixels: Pixels) -> Option<f64> {
        let limit = pixels.get();
        let guess = match self.depth {
            None => limit / self.scale,
            Some(depth) => depth / (1.0 + self.scale / limit),
        };
        let guess = lesser(guess, f64::MAX);
        let fits = |length: &f64| *length > 0.0 && self.pixels_of(*length).is_some_and(|p| p <= limit);
        // `pixels_of` rounds up, so the guess may be a few units in the last place too long, and many where
        // the difference `D − ε` cancels: shorten it by 0, 1, 2, 4, … such units until it fits.
        let shortened = |k: i32| guess - guess * (f64::EPSILON * (1_u64 << k) as f64);
        let visible = std::iter::once(guess).chain((0..52).map(shortened)).find(fits).unwrap_or(0.0);
        let invisible = if self.hidden > 0.0 { self.hidden.next_down() } else { 0.0 };
        let length = greater(visible, invisible);
        (length > 0.0).then_some(length)
    }
}

/// `tan(fov/2)` from below and above. `libm::tan` is off by less than one unit in the last place and the
/// conversion to radians by two more, which `tan` magnifies by `x/(sin x·cos x) ≤ (π/2)/cos x` at most. The
/// lower one is not positive if the error exceeds it.
fn half_tan(fov_y_deg: f64) -> (f64, f64) {
    let half = fov_y_deg * (std::f64::consts::PI / 360.0);
    let tan = libm::tan(half);
    let slack = 8.0 * f64::EPSILON * (1.0 + 1.0 / libm::cos(half));
    (tan * (1.0 - slack), tan * (1.0 + slack))
}

/// The depths of a place and its largest angle off the axis.
struct ViewExtent {
    /// Smallest depth, rounded down.
    near: f64,
    /// Largest depth, rounded up.
    far: f64,
    /// Largest tangent of the angle off the axis, rounded up; ∞ when the place reaches the plane of the eye.
    tan: f64,
}

impl ViewExtent {
    /// No information.
    const UNBOUNDED: Self = Self { near: f64::NEG_INFINITY, far: f64::INFINITY, tan: f64::INFINITY };

    /// Depth is linear and the cone of an angle in front of the eye is convex, so the extremes are at the
    /// corners.
    fn from_eye(place: &Box3, eye: [f64; 3], forward: [f64; 3]) -> Self {
        let mut extent = Self { near: f64::INFINITY, far: f64::NEG_INFINITY, tan: 0.0 };
        let forward = glam::DVec3::from(forward);
        // A single point is all of its corners.
        let n_corners = if place.min == place.max { 1 } else { 8 };
        for corner in 0..n_corners {
            let pick = |k: usize| (if corner >> k & 1 == 0 { place.min[k] } else { place.max[k] }) - eye[k];
            let to = glam::DVec3::new(pick(0), pick(1), pick(2));
            // Relative to |to|, in halves of EPSILON: 1 for the difference, 8 for the axis, 3 for the depth's
            // products and sums, or 2 for each coordinate of the cross product, √3 · 11 together. Below the
            // normal numbers, roundings are absolute and far less than the smallest of these.
            let slack = add_up(16.0 * f64::EPSILON * to.abs().element_sum(), f64::MIN_POSITIVE);
            if !slack.is_finite() {
                return Self::UNBOUNDED;
            }
            let depth = to.dot(forward);
            let (low, high) = (sub_down(depth, slack), add_up(depth, slack));
            extent.near = lesser(low, extent.near);
            extent.far = greater(high, extent.far);
            let tan = if low > 0.0 {
                div_up(add_up(norm_up(to.cross(forward)), slack), low)
            } else {
                f64::INFINITY
            };
            extent.tan = greater(tan, extent.tan);
        }
        extent
    }
}

/// `|v|`, rounded up.
fn norm_up(v: glam::DVec3) -> f64 {
    sqrt_up(add_up(add_up(mul_up(v.x, v.x), mul_up(v.y, v.y)), mul_up(v.z, v.z)))
}
