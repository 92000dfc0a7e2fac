//! Pictures of shading cost: the number of lanes that a graphics processor launches for each pixel.
use super::color::{Backdrop, ColorRamp, linear_to_srgb};
use super::frame;
use super::options::{Background, CullMode, RenderOptions, Viewpoint};
use super::picture::Picture;
use crate::budget::{Camera, Job, JobError};
use crate::check::{Overshade, overshade};
use crate::explicit::{HitSides, Mesh};

/// The lanes per pixel at which the last colour is reached.
pub const DARKEST_LANES: u32 = 16;

/// The shading counts of a mesh at the camera of the options, and a picture of them: light for one lane per
/// pixel, over yellow for two, orange for four and red for eight, to dark violet for 16 and more. All lanes
/// count, including those of hidden triangles; `options.cull` selects the sides that are culled. Pixels
/// without a lane show the background. One sample per pixel; other options are ignored.
///
/// # Errors
/// As for [`overshade`].
///
/// ```
/// use chordal::{Job, Mesh, render::{RenderOptions, render_overshade}};
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 0., 1.]], vec![[0, 1, 2]]).unwrap();
/// let (picture, found) = render_overshade(&mesh, &RenderOptions::sized(40, 30), &Job::default())?;
/// assert_eq!((picture.width, picture.height), (40, 30));
/// assert!(found.ratio() > 1.0 && found.ratio() < 2.0);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn render_overshade(
    mesh: &Mesh,
    options: &RenderOptions,
    job: &Job,
) -> Result<(Picture, Overshade), JobError> {
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame(mesh, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let sides = match options.cull {
        CullMode::None => HitSides::Both,
        CullMode::Back => HitSides::Front,
        CullMode::Front => HitSides::Back,
    };
    let shading = overshade(mesh, &camera, sides, job)?;
    let picture = picture(&shading, &camera, options.background);
    Ok((picture, shading))
}

fn picture(shading: &Overshade, camera: &Camera, background: Background) -> Picture {
    let [width, height] = [camera.screen.width_px, camera.screen.height_px];
    let columns = shading.quad_columns as usize;
    let ramp = ColorRamp::new();
    let doublings = f64::from(DARKEST_LANES.ilog2());
    // The scale is logarithmic at powers of two, and linear between them.
    let colors: Vec<[u8; 4]> = (0..=DARKEST_LANES)
        .map(|lanes| {
            let octave = lanes.max(1).ilog2();
            let part = f64::from(lanes.max(1)) / f64::from(1_u32 << octave) - 1.0;
            let [r, g, b] = ramp.at((f64::from(octave) + part) / doublings).to_array().map(linear_to_srgb);
            [r, g, b, 255]
        })
        .collect();
    let backdrop = Backdrop::new(height);
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        let empty = match background {
            Background::Studio => {
                let [r, g, b] = backdrop.at(y).to_array().map(linear_to_srgb);
                [r, g, b, 255]
            }
            Background::Shadow | Background::Transparent => [0; 4],
        };
        for x in 0..width {
            let lanes = shading.launches[(y / 2) as usize * columns + (x / 2) as usize];
            rgba.extend(if lanes == 0 { empty } else { colors[lanes.min(DARKEST_LANES) as usize] });
        }
    }
    Picture { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::{Projection, Screen};

    #[test]
    fn each_quad_has_the_colour_of_its_launches() {
        // Two triangles over the upper left corner of the screen, of which the second lies over one quad
        // alone.
        let mesh = Mesh::new(
            vec![
                [0.0, 0.0, 0.0],
                [0.0, -7.5, 0.0],
                [7.5, 0.0, 0.0],
                [1.9, -0.1, 1.0],
                [0.1, -0.1, 1.0],
                [0.1, -1.9, 1.0],
            ],
            vec![[0, 1, 2], [3, 4, 5]],
        );
        let screen = Screen { width_px: 12, height_px: 12 };
        let camera = Camera {
            eye: [6.0, -6.0, 9.0],
            target: [6.0, -6.0, 0.0],
            up: [0.0, 1.0, 0.0],
            near: 0.0,
            projection: Projection::Orthographic { height: 12.0 },
            screen,
        };
        let options = RenderOptions {
            viewpoint: Viewpoint::Camera(camera),
            background: Background::Transparent,
            ..RenderOptions::default()
        };
        let (picture, found) = render_overshade(&mesh.unwrap(), &options, &Job::default()).unwrap();
        let color = |share: f64| {
            let [r, g, b] = ColorRamp::new().at(share).to_array().map(linear_to_srgb);
            [r, g, b, 255]
        };
        for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (x, y))) {
            let (column, row) = (x / 2, y / 2);
            let expected = match (column, row) {
                (0, 0) => color(0.25),
                _ if column + row <= 3 => color(0.0),
                _ => [0; 4],
            };
            assert_eq!(picture.pixel(x, y), expected, "({x}, {y})");
        }
        assert_eq!(found.launches.iter().sum::<u32>(), 11);
    }
}
