//! What a picture promises: places, normals, holes, lines, sides, and the same bytes everywhere.
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::budget::{JobError, Progress, RefusalCode};
use chordal::explicit::{Attribute, Patch};
use chordal::render::{Background, Picture, RenderOptions, RenderStyle, UpAxis, Viewpoint, frame, render};
use chordal::{Job, Mesh};
use chordal_testkit::Fingerprint;
use chordal_testkit::corpus;
use std::sync::{Arc, Mutex};

/// A sphere of radius 1 about the origin in `2n × n` quads, its outside in front.
fn sphere(n: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..=n {
        let polar = std::f64::consts::PI * f64::from(i) / f64::from(n);
        for j in 0..2 * n {
            let around = std::f64::consts::PI * f64::from(j) / f64::from(n);
            let ring = libm::sin(polar);
            positions.push([ring * libm::cos(around), ring * libm::sin(around), libm::cos(polar)]);
        }
    }
    let row = |i: u32, j: u32| 2 * n * i + j % (2 * n);
    let quads = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let faces = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let faces = faces.collect();
    Mesh::new(positions, faces).expect("finite")
}

/// The cube from −1 to 1, two triangles a side, without the sides along `open` (axis, end).
fn cube(open: &[(usize, usize)]) -> Mesh {
    let positions = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 })).collect();
    let mut faces = Vec::new();
    for (axis, end) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]).filter(|side| !open.contains(side)) {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let from = (end as u32) << axis;
        let [a, b, c, d] = [from, from + u, from + u + v, from + v];
        faces.extend(if end == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
    }
    Mesh::new(positions, faces).expect("finite")
}

fn camera(eye: [f64; 3], projection: Projection, [width_px, height_px]: [u32; 2]) -> Camera {
    let up = if eye[0] == 0.0 && eye[1] == 0.0 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    Camera { eye, target: [0.0; 3], up, near: 0.0, projection, screen: Screen { width_px, height_px } }
}

const PARALLEL: Projection = Projection::Orthographic { height: 3.0 };

/// A picture with nothing behind the mesh.
fn picture(mesh: &Mesh, camera: Camera, show: RenderStyle) -> Picture {
    let options = RenderOptions {
        show,
        viewpoint: Viewpoint::Camera(camera),
        background: Background::Transparent,
        ..RenderOptions::default()
    };
    render(mesh, &options, &Job::default()).expect("renders")
}

fn coverage(picture: &Picture) -> f64 {
    picture.rgba.chunks_exact(4).map(|p| f64::from(p[3]) / 255.0).sum()
}

#[test]
fn a_sphere_covers_the_pixels_of_its_disc() {
    let mesh = sphere(128);
    let eye = [1.5, -2.0, 2.5];
    let area = coverage(&picture(&mesh, camera(eye, PARALLEL, [300, 240]), RenderStyle::Flat));
    let expected = std::f64::consts::PI * 80.0 * 80.0;
    assert!((area / expected - 1.0).abs() < 0.005, "{area} pixels, not {expected}");

    // A pinhole sees a sphere of radius r at distance d under the angle asin(r/d).
    let fov = Projection::Perspective { fov_y_deg: 60.0 };
    let area = coverage(&picture(&mesh, camera([0.0, -3.0, 0.0], fov, [300, 240]), RenderStyle::Flat));
    let radius = 120.0 / libm::tan(libm::asin(0.5)) * libm::tan(libm::asin(1.0 / 3.0));
    let expected = std::f64::consts::PI * radius * radius;
    assert!((area / expected - 1.0).abs() < 0.005, "{area} pixels, not {expected}");
}

#[test]
fn the_normal_in_the_centre_points_at_the_eye() {
    let mesh = sphere(64);
    for eye in [[3.0, 0.0, 0.0], [0.0, 0.0, -4.0], [1.0, 2.0, 2.0], [-2.0, 1.0, -2.0]] {
        let shown = picture(&mesh, camera(eye, PARALLEL, [201, 201]), RenderStyle::Normals);
        let pixel = shown.pixel(100, 100);
        let length = eye.iter().map(|x| x * x).sum::<f64>().sqrt();
        for k in 0..3 {
            let normal = f64::from(pixel[k]) / 127.5 - 1.0;
            assert!((normal - eye[k] / length).abs() < 0.02, "{pixel:?} from {eye:?}");
        }
    }
}

#[test]
fn sharp_edges_stay_sharp_and_given_normals_win() {
    let (mesh, seen_from) = (cube(&[]), camera([3.0, -4.0, 5.0], PARALLEL, [120, 120]));
    // Without normals: three sides, three colours, and mixtures only along the lines between them.
    let shown = picture(&mesh, seen_from, RenderStyle::Normals);
    let sides = [[255, 128, 128], [128, 0, 128], [128, 128, 255]];
    let pure =
        shown.rgba.chunks_exact(4).filter(|p| p[3] == 255 && sides.contains(&[p[0], p[1], p[2]])).count();
    let all = shown.rgba.chunks_exact(4).filter(|p| p[3] == 255).count();
    assert!(pure * 100 > all * 90, "{pure} of {all}");

    let up = Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 8]);
    let shown = picture(&mesh.clone().with_attribute(up).unwrap(), seen_from, RenderStyle::Normals);
    let top = [128, 128, 255];
    let (x, y) = (60, 90);
    assert_eq!(shown.pixel(x, y)[..3], top, "the side facing the eye, by the mesh's own normals");
    // Normals that say nothing leave the triangle's own.
    let none = Attribute::vertex_normals(&[[0.0, f64::NAN, 0.0]; 8]);
    let shown = picture(&mesh.with_attribute(none).unwrap(), seen_from, RenderStyle::Normals);
    assert!(sides.contains(&shown.pixel(x, y)[..3].try_into().unwrap()));
}

#[test]
fn a_hole_opens_where_a_face_is_missing() {
    let from_front = camera([0.0, -5.0, 0.0], PARALLEL, [61, 61]);
    let whole = picture(&cube(&[]), from_front, RenderStyle::Flat).pixel(30, 30);
    let open = picture(&cube(&[(1, 0)]), from_front, RenderStyle::Flat).pixel(30, 30);
    let through = picture(&cube(&[(1, 0), (1, 1)]), from_front, RenderStyle::Flat).pixel(30, 30);
    assert_eq!((whole[3], open[3], through[3]), (255, 255, 0));
    // Fronts are warm; the back of the far side is cool.
    assert!(whole[0] > whole[2] && open[2] > open[0], "{whole:?} {open:?}");
}

#[test]
fn both_sides_of_a_triangle_are_seen_and_differ() {
    let mesh = Mesh::new(vec![[-1., -1., 0.], [1., -1., 0.], [0., 1., 0.]], vec![[0, 1, 2]]).unwrap();
    for show in [RenderStyle::Shaded, RenderStyle::Flat] {
        let front = picture(&mesh, camera([0.0, 0.0, 3.0], PARALLEL, [31, 31]), show).pixel(15, 15);
        let back = picture(&mesh, camera([0.0, 0.0, -3.0], PARALLEL, [31, 31]), show).pixel(15, 15);
        assert!(front[0] > front[2] && back[2] > back[0], "{front:?} {back:?}");
    }
    let back =
        picture(&mesh, camera([0.0, 0.0, -3.0], PARALLEL, [31, 31]), RenderStyle::Normals).pixel(15, 15);
    assert_eq!(back, [128, 128, 0, 255], "normals are shown towards the eye");
}

/// Where a point appears in the picture, and its depth.
fn project(camera: &Camera, p: [f64; 3]) -> [f64; 3] {
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let unit = |a: [f64; 3]| a.map(|x| x / dot(a, a).sqrt());
    let forward = unit(sub(camera.target, camera.eye));
    let right = unit(cross(forward, camera.up));
    let above = cross(right, forward);
    let to = sub(p, camera.eye);
    let height = f64::from(camera.screen.height_px);
    let depth = dot(to, forward);
    let scale = match camera.projection {
        Projection::Orthographic { height: length } => height / length,
        Projection::Perspective { fov_y_deg } => {
            0.5 * height / libm::tan(fov_y_deg.to_radians() / 2.0) / depth
        }
    };
    let half = [f64::from(camera.screen.width_px) / 2.0, height / 2.0];
    [half[0] + scale * dot(to, right), half[1] - scale * dot(to, above), depth]
}

#[test]
fn wire_shows_every_visible_edge_and_no_hidden_one() {
    let mesh = sphere(6);
    let sum = |p: [u8; 4]| p[..3].iter().map(|c| u32::from(*c)).sum::<u32>();
    for projection in [PARALLEL, Projection::Perspective { fov_y_deg: 40.0 }] {
        let seen_from = camera([2.0, -3.0, 2.5], projection, [420, 420]);
        let shown = picture(&mesh, seen_from, RenderStyle::Wire);
        let bright = |p: [f64; 3]| {
            let [x, y, _] = project(&seen_from, p);
            sum(shown.pixel(x as u32, y as u32))
        };
        let (mut seen, mut hidden, mut hidden_light) = (0, 0, 0);
        for face in 0..mesh.faces().len() {
            let corners = mesh.corners(face);
            let sides = [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3]));
            // The poles are rows of equal points, whose faces have no area.
            if sides.iter().any(|(a, b)| a == b) {
                continue;
            }
            let middle: [f64; 3] =
                std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
            // The normal of a sphere's face is about its middle: it is seen when that points at the eye.
            let toward: [f64; 3] = match projection {
                Projection::Orthographic { .. } => seen_from.eye,
                Projection::Perspective { .. } => std::array::from_fn(|k| seen_from.eye[k] - middle[k]),
            };
            let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
            let cos = (0..3).map(|k| middle[k] * toward[k]).sum::<f64>() / length;
            for (a, b) in sides {
                let on = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
                if cos > 0.4 {
                    let (line, paper) = (bright(on), bright(middle));
                    assert!(paper > 350 && 5 * line < 4 * paper, "face {face}: {line} on {paper} at {on:?}");
                    seen += 1;
                } else if cos < -0.4 {
                    hidden += 1;
                    hidden_light += u32::from(bright(on) > 350);
                }
            }
        }
        // A hidden edge may lie under a seen one, but most do not.
        assert!(
            seen > 60 && hidden > 60 && 10 * hidden_light > 8 * hidden,
            "{seen} {hidden_light} of {hidden}"
        );
    }
}

/// A teapot-like scene without data: a sphere with a bite, so that shadows, backs and ground all show.
fn bitten() -> Mesh {
    let whole = sphere(16);
    let faces = whole.faces().iter().enumerate().filter(|(i, _)| !(40..90).contains(i)).map(|(_, f)| *f);
    Mesh::new(whole.positions().to_vec(), faces.collect()).unwrap()
}

#[test]
fn bytes_are_the_same_on_any_number_of_threads_and_every_machine() {
    let mesh = bitten();
    // These change only when the look of pictures is meant to: every target gives the same.
    let expected = [
        (RenderStyle::Shaded, SHADED),
        (RenderStyle::Flat, FLAT),
        (RenderStyle::Wire, WIRE),
        (RenderStyle::Normals, NORMALS),
    ];
    let mut wrong = Vec::new();
    for (show, expected) in expected {
        let options = RenderOptions { show, samples: 2, ..RenderOptions::sized(96, 72) };
        for threads in [1, 2, 5] {
            let shown = render(&mesh, &options, &Job::default().with_threads(threads)).unwrap();
            let found = Fingerprint::of(&shown.rgba);
            if found != expected {
                wrong.push(format!("{show:?} on {threads} threads: {found:#018x}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

const SHADED: u64 = 0x5240_bf8a_3660_35fd;
const FLAT: u64 = 0xdc2d_67c3_4dec_736e;
const WIRE: u64 = 0x2cfc_c498_fdd4_2534;
const NORMALS: u64 = 0x4b4f_408a_9a4c_3bd5;

#[test]
fn size_and_place_do_not_matter() {
    let mesh = bitten();
    let options = RenderOptions::sized(80, 60);
    let near = render(&mesh, &options, &Job::default()).unwrap();
    for exponent in [-400, -20, 20, 400] {
        let scale = libm::ldexp(1.0, exponent);
        let scaled = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
        let shown = render(&mesh.with_positions(scaled).unwrap(), &options, &Job::default()).unwrap();
        assert!(shown == near, "another picture at 2^{exponent}");
    }
    // A kilometre of millimetres away, rounding may show, but hardly.
    let moved = mesh.positions().iter().map(|p| p.map(|x| x + 1e6)).collect();
    let shown = render(&mesh.with_positions(moved).unwrap(), &options, &Job::default()).unwrap();
    let differing = shown.rgba.iter().zip(&near.rgba).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(differing * 100 < near.rgba.len(), "{differing} of {} bytes", near.rgba.len());
}

#[test]
fn the_automatic_viewpoint_holds_all_and_wastes_little() {
    let shapes = [sphere(12), cube(&[]), mesh_of_points([[0.0, 0.0, 0.0], [9.0, 0.0, 0.1], [0.0, 0.2, 0.0]])];
    for (mesh, up) in shapes.iter().flat_map(|mesh| [(mesh, UpAxis::Y), (mesh, UpAxis::Z)]) {
        for [width_px, height_px] in [[640, 480], [300, 900]] {
            let camera = frame(mesh, up, Screen { width_px, height_px });
            let size = [f64::from(width_px), f64::from(height_px)];
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            for p in mesh.positions() {
                let at = project(&camera, *p);
                assert!(at[2] > 0.0, "behind the eye");
                for k in 0..2 {
                    (low[k], high[k]) = (low[k].min(at[k] / size[k]), high[k].max(at[k] / size[k]));
                }
            }
            let fill = (high[0] - low[0]).max(high[1] - low[1]);
            assert!(low[0] > 0.05 && low[1] > 0.05 && high[0] < 0.95 && high[1] < 0.95, "{low:?} {high:?}");
            assert!(fill > 0.7, "only {fill} of the picture");
            let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
            assert!(middle.iter().all(|m| (m - 0.5).abs() < 0.1), "off centre: {middle:?}");
        }
    }
}

fn mesh_of_points(points: [[f64; 3]; 3]) -> Mesh {
    Mesh::new(points.to_vec(), vec![[0, 1, 2]]).unwrap()
}

#[test]
fn rods_thinner_than_a_pixel_are_seen_all_along() {
    // 0.3 pixels wide, leaning so that it passes between the middles of pixels, and behind it a second one that a wall
    // hides.
    let rod = |z: f64| [[-0.8, -1.2, z], [-0.797, -1.2, z], [0.703, 1.2, z], [0.7, 1.2, z]];
    let mut positions = rod(0.5).to_vec();
    positions.extend(rod(-0.5).map(|[x, y, z]| [x + 0.4, y, z]));
    positions.extend([[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]]);
    let quad = |i: u32| [[i, i + 1, i + 2], [i, i + 2, i + 3]];
    let above = camera([0.0, 0.0, 5.0], PARALLEL, [300, 300]);
    let alone = Mesh::new(positions.clone(), quad(0).to_vec()).unwrap();
    let shown = picture(&alone, above, RenderStyle::Flat);
    for y in 32..268 {
        let row: f64 = (0..300).map(|x| f64::from(shown.pixel(x, y)[3]) / 255.0).sum();
        assert!((row - 0.3).abs() < 0.2, "row {y} is covered by {row} pixels");
    }
    let all = Mesh::new(positions, [quad(0), quad(4), quad(8)].concat()).unwrap();
    let normals = picture(&all, above, RenderStyle::Normals);
    assert!(normals.rgba.chunks_exact(4).all(|p| p == [128, 128, 255, 255]));
}

#[test]
fn the_ground_takes_the_shadow_only_where_asked() {
    let options = |background| RenderOptions { background, ..RenderOptions::sized(120, 90) };
    let shadow = render(&sphere(24), &options(Background::Shadow), &Job::default()).unwrap();
    let clear = render(&sphere(24), &options(Background::Transparent), &Job::default()).unwrap();
    let studio = render(&sphere(24), &options(Background::Studio), &Job::default()).unwrap();
    assert!(studio.is_opaque() && !shadow.is_opaque());
    let beside: Vec<[u8; 4]> = (0..90)
        .flat_map(|y| (0..120).map(move |x| (x, y)))
        .filter(|(x, y)| clear.pixel(*x, *y)[3] == 0)
        .map(|(x, y)| shadow.pixel(x, y))
        .collect();
    let darkest = beside.iter().map(|p| p[3]).max().unwrap();
    assert!(darkest > 60 && beside.iter().all(|p| p[..3] == [0, 0, 0]), "{darkest}");
    assert_eq!(shadow.pixel(0, 0)[3], 0, "no shadow in the sky");
    // Seen from below, there is no ground in between.
    let below = camera([0.0, -3.0, -3.0], PARALLEL, [60, 60]);
    let from_below = RenderOptions { viewpoint: Viewpoint::Camera(below), ..options(Background::Shadow) };
    let shown = render(&sphere(24), &from_below, &Job::default()).unwrap();
    assert!(shown.rgba.chunks_exact(4).all(|p| p[3] == 0 || p[0] > 0));
}

#[test]
fn pictures_of_nothing_are_background() {
    let empty = Mesh::new(vec![], vec![]).unwrap();
    let point = Mesh::new(vec![[7.0; 3]], vec![[0, 0, 0]]).unwrap();
    for (mesh, show) in
        [&empty, &point].into_iter().flat_map(|m| [(m, RenderStyle::Shaded), (m, RenderStyle::Wire)])
    {
        let options =
            RenderOptions { show, background: Background::Transparent, ..RenderOptions::sized(16, 9) };
        let shown = render(mesh, &options, &Job::default()).unwrap();
        assert!(shown.rgba.len() == 16 * 9 * 4 && shown.rgba.iter().all(|b| *b == 0));
        let studio = RenderOptions { background: Background::Studio, ..options };
        assert!(render(mesh, &studio, &Job::default()).unwrap().is_opaque());
    }
}

#[test]
fn meshes_at_the_ends_of_the_numbers_end_in_a_picture_or_a_refusal() {
    for scale in [f64::MIN_POSITIVE, 1e-300, 1e-200, 1e200, 1e300, 1.7e308] {
        for show in [RenderStyle::Shaded, RenderStyle::Wire, RenderStyle::Normals] {
            let mesh = cube(&[]);
            let scaled = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
            let options = RenderOptions { show, ..RenderOptions::sized(24, 18) };
            match render(&mesh.with_positions(scaled).unwrap(), &options, &Job::default()) {
                Ok(shown) => assert!(shown.is_opaque()),
                Err(stopped) => assert!(matches!(stopped, JobError::Refused(_)), "{stopped}"),
            }
        }
    }
}

#[test]
fn reports_progress_stops_and_refuses() {
    let mesh = cube(&[]);
    let seen: Arc<Mutex<Vec<Progress>>> = Arc::default();
    let sink = Arc::clone(&seen);
    let job = Job::default().with_progress(move |p| sink.lock().unwrap().push(p)).with_threads(2);
    // Tiles of 96 pixels: four across, two down.
    let tiled = RenderOptions { samples: 1, ..RenderOptions::sized(300, 160) };
    render(&mesh, &tiled, &job).unwrap();
    let mut done: Vec<u64> = seen.lock().unwrap().iter().map(|p| p.done).collect();
    done.sort_unstable();
    assert!(done.into_iter().eq(1..=8) && seen.lock().unwrap().iter().all(|p| p.total == 8));

    // Cancelled from within, after the first tiles.
    let job = Job::default().with_threads(1);
    let flag = job.cancel_flag();
    let job = job.with_progress(move |p| flag.store(p.done >= 3, std::sync::atomic::Ordering::Relaxed));
    assert_eq!(render(&mesh, &tiled, &job), Err(JobError::Cancelled));

    let refusal = |options: &RenderOptions, job: &Job| match render(&mesh, options, job) {
        Err(JobError::Refused(refusal)) => refusal,
        other => panic!("{other:?}"),
    };
    let mut small = Job::default();
    small.memory_limit = 1 << 20;
    let refused = refusal(&RenderOptions::sized(100_000, 100_000), &small);
    assert_eq!(refused.code, RefusalCode::TooMuchMemory);
    assert!(refused.message.contains("100000x100000") && refused.message.contains("1048576"));
    assert_eq!(refusal(&RenderOptions::sized(0, 9), &Job::default()).code, RefusalCode::Unsupported);
    for samples in [0, 17] {
        let options = RenderOptions { samples, ..RenderOptions::sized(9, 9) };
        assert!(refusal(&options, &Job::default()).message.contains(&samples.to_string()));
    }
    let blind = Camera { target: [0.0, -5.0, 0.0], ..camera([0.0, -5.0, 0.0], PARALLEL, [9, 9]) };
    let options = RenderOptions { viewpoint: Viewpoint::Camera(blind), ..RenderOptions::default() };
    assert_eq!(refusal(&options, &Job::default()).code, RefusalCode::Unsupported);
}

/// The original teapot by uniform sampling, with its patches' normals; `None` when the data is not there.
fn teapot(n: usize) -> Option<Mesh> {
    let text = std::fs::read_to_string(corpus::find("patches/teapot")?).ok()?;
    let mut words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let mut count = || words.next()?.parse::<usize>().ok();
    let n_patches = count()?;
    let rows: Vec<usize> = (0..16 * n_patches).map(|_| count()).collect::<Option<_>>()?;
    let n_points = count()?;
    let numbers: Vec<f64> = (0..3 * n_points).map(|_| words.next()?.parse().ok()).collect::<Option<_>>()?;
    let point = |row: usize| [numbers[3 * row - 3], numbers[3 * row - 2], numbers[3 * row - 1]];
    let (mut positions, mut normals, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for rows in rows.chunks_exact(16) {
        let control = std::array::from_fn(|i| std::array::from_fn(|j| point(rows[4 * i + j])));
        let patch = Patch { control };
        let first = positions.len();
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let (u, v) = (j as f64 / n as f64, i as f64 / n as f64);
            positions.push(patch.at(u, v));
            normals.push(patch.normal(u, v).unwrap_or([0.0; 3]));
        }
        let at = |i: usize, j: usize| (first + i * (n + 1) + j) as u32;
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            faces.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    Mesh::new(positions, faces).ok()?.with_attribute(Attribute::vertex_normals(&normals)).ok()
}

#[test]
fn the_teapot_stands_in_the_picture_from_lid_to_bottom() {
    let Some(mesh) = teapot(8) else { return };
    let options = RenderOptions { background: Background::Transparent, ..RenderOptions::sized(320, 240) };
    let shown = render(&mesh, &options, &Job::default()).unwrap();
    let camera = frame(&mesh, UpAxis::Z, Screen { width_px: 320, height_px: 240 });
    for p in mesh.positions() {
        let [x, y, _] = project(&camera, *p);
        let near = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + f64::from(dx), y + f64::from(dy))));
        let covered = near.map(|(x, y)| shown.pixel(x as u32, y as u32)[3]).max();
        assert!(covered > Some(0), "{p:?} is not in the picture at ({x}, {y})");
    }
    // Warm fronts make up nearly all that is seen; cool backs show between lid and body, and in the spout.
    let full = || shown.rgba.chunks_exact(4).filter(|p| p[3] == 255);
    let (warm, cool) = (full().filter(|p| p[0] > p[2]).count(), full().filter(|p| p[2] > p[0]).count());
    assert!(warm > 50 * cool && cool > 20, "{warm} warm, {cool} cool pixels");
}
