//! Pictures of curvature combs: paths with their teeth as thin strips in the plane.
use super::drawing::top_view_camera;
use super::options::{RenderOptions, RenderStyle, UpAxis, Viewpoint};
use super::{Picture, render};
use crate::budget::{Camera, Job, JobError, Projection, Refusal, RefusalCode};
use crate::check::curves::{Tooth, curvature_comb};
use crate::explicit::{Curve, Mesh};
use crate::math::{Box3, difference, distance, greater, length};

/// A picture of the curvature combs of paths.
#[derive(Clone, Debug, PartialEq)]
pub struct CombPicture {
    /// The picture.
    pub picture: Picture,
    /// Its camera: from straight above unless one was given.
    pub camera: Camera,
    /// The length of a tooth where the curvature is 1.
    pub scale: f64,
    /// The largest curvature, 1/radius.
    pub most: f64,
}

/// The longest tooth, as a fraction of the diagonal of the paths' box. Chosen: both combs and paths are
/// visible.
const LONGEST: f64 = 0.15;
/// Teeth for each piece, and the steps of a piece that are drawn between two of them. Chosen by looking.
const TEETH: usize = 24;
const STEPS: usize = 4;
/// The width of paths, tips and teeth in pixels. Chosen by looking.
const WIDTHS: [f64; 3] = [3.0, 1.5, 0.75];

/// Draws paths with their curvature combs: teeth on the outer side of each bend, as long as the curvature
/// there, with their tips joined. Where the curvature jumps, so does the line of tips; at a kink of a path it
/// is interrupted.
///
/// All paths have the same scale: the longest tooth is 0.15 of the diagonal of their box. Straight pieces
/// have no teeth.
///
/// # Errors
/// [`JobError::Refused`] if no path bends, and as for [`render`].
///
/// ```
/// use chordal::{Bezier, Job, render::{RenderOptions, drawings::render_comb}};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let comb = render_comb(&[arch.into()], &RenderOptions::sized(80, 60), &Job::default())?;
/// assert_eq!(comb.picture.width, 80);
/// // In the middle: the first derivative is (3/2, 0), the second (0, -6).
/// assert!((comb.most - 6.0 / 2.25).abs() < 1e-12);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn render_comb(paths: &[Curve<2>], options: &RenderOptions, job: &Job) -> Result<CombPicture, JobError> {
    let refused = |message: &str| JobError::Refused(Refusal::new(RefusalCode::Empty, message));
    // 1. The same scale for all paths.
    let teeth = |scale: f64| paths.iter().flat_map(move |path| curvature_comb(path, TEETH, scale));
    // Once at scale 1 for the largest curvature, then at the scale that follows from it.
    let most = teeth(1.0).flatten().fold(0.0, |most, tooth| greater(tooth.curvature.abs(), most));
    if most == 0.0 {
        return Err(refused("no path bends, so that a curvature comb has no teeth"));
    }
    let lift = |[x, y]: [f64; 2]| [x, y, 0.0];
    let bounds =
        paths.iter().fold(Box3::EMPTY, |all, path| all.union(Box3::from_points(&path.bounds().map(lift))));
    let scale = LONGEST * bounds.diagonal() / most;
    let combs: Vec<Vec<Tooth>> = teeth(scale).collect();
    // 2. The camera, which determines the width of a pixel.
    let around =
        combs.iter().flatten().fold(bounds, |all, tooth| all.union(Box3::from_points(&[lift(tooth.tip)])));
    let camera = match options.viewpoint {
        Viewpoint::Camera(camera) => camera,
        Viewpoint::Automatic(screen) => {
            top_view_camera(&around, screen).map_err(|_| refused("the paths have no extent to show"))?
        }
    };
    let seen_height = match camera.projection {
        Projection::Orthographic { height } => height,
        Projection::Perspective { fov_y_deg } => {
            let half = 0.5 * fov_y_deg.to_radians();
            2.0 * distance(camera.target, camera.eye) * libm::tan(half)
        }
    };
    let pixel = seen_height / f64::from(camera.screen.height_px.max(1));
    // 3. Strips.
    let [path_width, tip_width, tooth_width] = WIDTHS.map(|width| width * pixel);
    let mut strips = Strips::default();
    for piece in paths.iter().flat_map(Curve::segments) {
        // Steps end at teeth, so that these stand on the drawn line.
        let n = TEETH * STEPS;
        let points: Vec<[f64; 2]> = (0..=n).map(|i| piece.at(i as f64 / n as f64)).collect();
        points.windows(2).for_each(|pair| strips.add([pair[0], pair[1]], path_width));
    }
    for comb in combs.iter().filter(|comb| comb.iter().any(|tooth| tooth.tip != tooth.on_curve)) {
        comb.iter().for_each(|tooth| strips.add([tooth.on_curve, tooth.tip], tooth_width));
        comb.windows(2).for_each(|pair| strips.add([pair[0].tip, pair[1].tip], tip_width));
    }
    let mesh = Mesh::new(strips.corners, strips.faces)
        .map_err(|_| refused("the comb leaves the range of numbers"))?;
    let options = RenderOptions {
        show: RenderStyle::Flat,
        viewpoint: Viewpoint::Camera(camera),
        up: UpAxis::Y,
        ..*options
    };
    Ok(CombPicture { picture: render(&mesh, &options, job)?, camera, scale, most })
}

/// Lines as pairs of triangles.
#[derive(Default)]
struct Strips {
    corners: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Strips {
    /// A line with square ends.
    fn add(&mut self, [a, b]: [[f64; 2]; 2], width: f64) {
        let along = difference(b, a);
        let long = length(along);
        if long == 0.0 {
            return;
        }
        let [x, y] = along.map(|x| 0.5 * width * x / long);
        let first = self.corners.len() as u32;
        let corners =
            [[a[0] + y, a[1] - x], [b[0] + y, b[1] - x], [b[0] - y, b[1] + x], [a[0] - y, a[1] + x]];
        self.corners.extend(corners.map(|[x, y]| [x, y, 0.0]));
        self.faces.extend([[0, 1, 2], [0, 2, 3]].map(|face| face.map(|corner: u32| first + corner)));
    }
}
