//! The fixed points at which a pixel, the sky and the lamp are sampled: the same for every picture.
use glam::DVec3;

/// The golden ratio minus 1: its multiples modulo 1 are spread the most evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// The inverse of the real root of x³ = x + 1 and its square: the same in the plane (M. Roberts, *The
/// unreasonable effectiveness of quasirandom sequences*, 2018).
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Rotations of the points on the hemisphere and the lamp, so that neighbouring pixels do not repeat a
/// pattern. More make no visible difference.
const TURNS: usize = 64;
/// The fewest points on the sky and on the lamp for all rays of a pixel together. Chosen side by side: with
/// 16, shadows show a weave.
const SKY: usize = 32;
const LAMP: usize = 32;
/// The points on each for a position whose light is that of many pixels, and of one.
const LIGHT: [usize; 2] = [64, 32];
/// The points along the lamp's rim, and along a circle inside: unless these and the middle differ in
/// visibility, the whole lamp is taken for visible, or for hidden.
const RIM: usize = 8;
/// The radius of that circle. Chosen side by side: an object thinner than the gaps casts a shadow too faint
/// to see.
const INNER: f64 = 0.55;

/// Sample points for `n` rays per pixel.
#[derive(Clone, Debug)]
pub(super) struct SamplePattern {
    /// Offsets from the corner of the pixel. Their density is a tent two pixels wide, so the plain mean of
    /// the rays is a filtered picture.
    pub pixel_offsets: Vec<[f64; 2]>,
    /// Points for all rays of a pixel together; each ray takes its share.
    sky: Vec<[f64; 3]>,
    lamp: Vec<[f64; 2]>,
    /// Points for a single position: for the light of many pixels, and of one.
    pub light: [LightPattern; 2],
    turns: Vec<[f64; 2]>,
}

/// Sample points on the sky and on the lamp, and along the lamp's rim.
#[derive(Clone, Debug)]
pub(super) struct LightPattern {
    pub sky: Vec<[f64; 3]>,
    pub lamp: Vec<[f64; 2]>,
    pub rim: Vec<[f64; 2]>,
}

fn fraction(x: f64) -> f64 {
    x - x.floor()
}

/// Maps 0 … 1 to the density of a tent over −1 … 1.
fn tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

impl SamplePattern {
    /// The pattern for `side²` rays.
    pub fn new(side: u32) -> Self {
        let n = (side * side) as usize;
        // The number is a multiple of the rays, so that each ray gets the same number of points.
        let [sky, lamp] = [SKY, LAMP].map(|least| n * least.div_ceil(n));
        let even = |n: usize, i: usize| (i as f64 + 0.5) / n as f64;
        let circle = |u: f64| [libm::cos(std::f64::consts::TAU * u), libm::sin(std::f64::consts::TAU * u)];
        let disc = |n: usize, i: usize| {
            // The root makes rings of equal area, so points are as dense at the rim as in the
            // middle.
            let radius = even(n, i).sqrt();
            circle(fraction(0.5 + i as f64 * GOLDEN)).map(|x| x * radius)
        };
        let hemisphere = |n: usize, i: usize| {
            let [x, y] = disc(n, i);
            // Points of a disc lifted onto the hemisphere are as dense as the cosine of their
            // angle, which is the weight that light from there has.
            [x, y, (1.0 - even(n, i)).sqrt()]
        };
        let light = |n: usize| LightPattern {
            sky: (0..n).map(|i| hemisphere(n, i)).collect(),
            lamp: (0..n).map(|i| disc(n, i)).collect(),
            rim: (0..RIM)
                .map(|i| circle(even(RIM, i)))
                .chain((0..RIM).map(|i| circle(i as f64 / RIM as f64).map(|x| x * INNER)))
                .chain([[0.0; 2]])
                .collect(),
        };
        let offset = |i| [even(n, i), fraction(0.5 + i as f64 * GOLDEN)].map(|u| 0.5 + tent(u));
        Self {
            pixel_offsets: (0..n).map(offset).collect(),
            sky: (0..sky).map(|i| hemisphere(sky, i)).collect(),
            lamp: (0..lamp).map(|i| disc(lamp, i)).collect(),
            light: LIGHT.map(light),
            turns: (0..TURNS).map(|i| circle(even(TURNS, i))).collect(),
        }
    }

    /// The pattern without rotation, for points between which light is interpolated: without noise.
    pub fn unturned(&self) -> PixelPattern<'_> {
        PixelPattern { pattern: self, turn: [1.0, 0.0] }
    }

    /// The pattern for the rays of one pixel.
    pub fn for_pixel(&self, [x, y]: [i64; 2]) -> PixelPattern<'_> {
        let turn = fraction(x as f64 * PLASTIC[0] + y as f64 * PLASTIC[1]);
        PixelPattern { pattern: self, turn: self.turns[(turn * TURNS as f64) as usize % TURNS] }
    }
}

/// The pattern, rotated for one pixel.
#[derive(Clone, Copy)]
pub(super) struct PixelPattern<'a> {
    pattern: &'a SamplePattern,
    turn: [f64; 2],
}

impl PixelPattern<'_> {
    fn rotate(&self, x: f64, y: f64) -> [f64; 2] {
        let [cos, sin] = self.turn;
        [cos * x - sin * y, sin * x + cos * y]
    }

    fn sky_around<'s>(
        &self,
        points: impl ExactSizeIterator<Item = &'s [f64; 3]>,
        normal: DVec3,
    ) -> impl ExactSizeIterator<Item = DVec3> {
        let [right, up] = tangents(normal);
        points.map(move |[x, y, z]| {
            let [x, y] = self.rotate(*x, *y);
            right * x + up * y + normal * *z
        })
    }

    /// Directions around `normal`, as dense as their cosine with it, for one of the pixel's rays. All rays
    /// together have the whole set.
    pub fn sky(&self, ray: usize, normal: DVec3) -> impl ExactSizeIterator<Item = DVec3> {
        let of_ray = self.pattern.sky[ray..].iter().step_by(self.pattern.pixel_offsets.len());
        self.sky_around(of_ray, normal)
    }

    /// Points of the unit disc for one of the pixel's rays.
    pub fn lamp(&self, ray: usize) -> impl ExactSizeIterator<Item = [f64; 2]> {
        let of_ray = self.pattern.lamp[ray..].iter().step_by(self.pattern.pixel_offsets.len());
        of_ray.map(|[x, y]| self.rotate(*x, *y))
    }

    /// Directions around `normal`, all of them for one point.
    pub fn whole_sky(&self, detail: LightDetail, normal: DVec3) -> impl ExactSizeIterator<Item = DVec3> {
        self.sky_around(self.pattern.light[detail as usize].sky.iter(), normal)
    }

    /// Points of the unit disc, all of them for one point.
    pub fn whole_lamp(&self, detail: LightDetail) -> impl ExactSizeIterator<Item = [f64; 2]> {
        self.pattern.light[detail as usize].lamp.iter().map(|[x, y]| self.rotate(*x, *y))
    }

    /// Points on the rim of the unit disc, and its middle.
    pub fn rim(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        self.pattern.light[0].rim.iter().map(|[x, y]| self.rotate(*x, *y))
    }
}

/// The part of the picture that the light of a point determines.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LightDetail {
    /// For many pixels.
    Area = 0,
    /// For one pixel.
    Pixel = 1,
}

/// Two unit vectors perpendicular to `n` and each other.
///
/// Source: T. Duff et al., *Building an orthonormal basis, revisited*, 2017.
pub(super) fn tangents(n: DVec3) -> [DVec3; 2] {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}
