//! What a graphics processor would shade: closed forms, a naive rasterizer that shares no code, and hostile
//! input.
mod naive;

use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::budget::{JobError, RefusalCode};
use chordal::check::shading::{Overshade, flicker, micro_triangles, overshade};
use chordal::explicit::query::HitSides;
use chordal::{Job, Mesh, View};
use chordal_testkit::Random;
use naive::{Naive, naive};

fn camera(projection: Projection, [width_px, height_px]: [u32; 2]) -> Camera {
    let screen = Screen { width_px, height_px };
    Camera { eye: [0.0, 0.0, 8.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], near: 0.0, projection, screen }
}

/// Parallel rays along −z with a pixel a unit; the screen's upper left corner is at (−width/2, height/2).
fn by_pixels([width, height]: [u32; 2]) -> Camera {
    camera(Projection::Orthographic { height: f64::from(height) }, [width, height])
}

const FOV: Projection = Projection::Perspective { fov_y_deg: 50.0 };

fn seen(mesh: &Mesh, camera: &Camera) -> Overshade {
    overshade(mesh, camera, HitSides::Both, &Job::default()).expect("rasterizes")
}

fn mesh(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, faces).expect("valid")
}

/// `n × m` squares of a side over the screen from its lower left corner on, each cut along the diagonal that
/// rises.
fn grid([n, m]: [u32; 2], side: f64, [x, y]: [f64; 2]) -> Mesh {
    let row = |i: u32, j: u32| i + (n + 1) * j;
    let places = (0..=m).flat_map(|j| (0..=n).map(move |i| [f64::from(i), f64::from(j)]));
    let positions = places.map(|[i, j]| [x + side * i, y + side * j, 0.0]).collect();
    let cells = (0..m).flat_map(|j| (0..n).map(move |i| [i, j]));
    let faces = cells.flat_map(|[i, j]| {
        let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(positions, faces.collect())
}

/// A sphere of radius 1 in `2n × n` quads.
fn sphere(n: u32) -> Mesh {
    let angle = |k: u32| std::f64::consts::PI * f64::from(k) / f64::from(n);
    let places = (0..=n).flat_map(|i| (0..2 * n).map(move |j| (angle(i), angle(j))));
    let positions = places.map(|(polar, around)| {
        let ring = libm::sin(polar);
        [ring * libm::cos(around), libm::cos(polar), ring * libm::sin(around)]
    });
    let row = |i: u32, j: u32| 2 * n * i + j % (2 * n);
    let quads = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let faces = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
        [[a, c, b], [a, d, c]]
    });
    mesh(positions.collect(), faces.collect())
}

/// Triangles of corners by chance, all sizes, some beyond the screen or behind the eye.
fn soup(n: u32, random: &mut Random) -> Mesh {
    let mut positions = Vec::new();
    for _ in 0..n {
        let size = [8.0, 1.0, 0.1, 0.01][random.below(4)];
        let at = [5.0 * random.signed(), 5.0 * random.signed(), 6.0 * random.signed()];
        positions.extend((0..3).map(|_| at.map(|x| x + size * random.signed())));
    }
    mesh(positions, (0..n).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
}

fn same(found: &Overshade, expected: &Naive) {
    let of = |shaded: chordal::check::shading::ShadingCounts| [shaded.fragments, shaded.quads];
    let found = Naive {
        in_view: found.in_view,
        missed: found.missed,
        micro: found.micro,
        covered_px: found.covered_px,
        every: of(found.every),
        visible: of(found.visible),
        launches: found.launches.clone(),
    };
    assert_eq!(&found, expected);
}

#[test]
fn the_naive_rasterizer_finds_the_same() {
    for seed in 0..12 {
        let mut random = Random::new(seed);
        println!("seed {seed}");
        let size = [[37, 23], [16, 16], [64, 41], [1, 9]][seed as usize % 4];
        let mesh = soup(120, &mut random);
        for projection in [FOV, Projection::Orthographic { height: 9.0 }] {
            // Far enough that all triangles are before the eye.
            let camera = Camera { eye: [0.0, 0.0, 20.0], ..camera(projection, size) };
            let expected = naive(&mesh, &camera);
            assert!(expected.visible[1] > 0 && expected.missed > 0, "{expected:?}");
            same(&seen(&mesh, &camera), &expected);
        }
    }
}

#[test]
fn needles_and_corners_on_pixel_centres_are_as_the_rule_says() {
    for seed in 0..20 {
        let mut random = Random::new(1000 + seed);
        println!("seed {}", 1000 + seed);
        // Corners on halves of pixels, many in one line; and long triangles a few steps thin.
        let mut positions = Vec::new();
        for k in 0..200 {
            let corner = |random: &mut Random| [0, 1].map(|_| 0.5 * random.below(64) as f64 - 16.0);
            let [a, b, c] = [corner(&mut random), corner(&mut random), corner(&mut random)];
            let thin = [0, 1].map(|axis| a[axis] + random.below(4) as f64 / 256.0);
            let c = if k % 2 == 0 { c } else { thin };
            positions.extend([a, b, c].map(|[x, y]| [x, y, -f64::from(k) / 100.0]));
        }
        let mesh = mesh(positions, (0..200).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
        let camera = by_pixels([32, 24]);
        same(&seen(&mesh, &camera), &naive(&mesh, &camera));
    }
}

#[test]
fn a_triangle_that_covers_the_screen_wastes_nothing() {
    for size in [[64, 48], [2, 2], [1920, 1080]] {
        let r = 1e4;
        let all = mesh(vec![[-r, -r, 0.0], [3.0 * r, -r, 0.0], [-r, 3.0 * r, 0.0]], vec![[0, 1, 2]]);
        let found = seen(&all, &by_pixels(size));
        let n = u64::from(size[0]) * u64::from(size[1]);
        assert_eq!((found.covered_px, found.visible.quads, found.visible.helpers()), (n, n / 4, 0));
        assert_eq!((found.every, found.ratio(), found.in_view, found.missed), (found.visible, 1.0, 1, 0));
        assert!(found.launches.iter().all(|n| *n == 1));
    }
    // Odd sides: the quads of the last column and row have lanes beyond the screen.
    let all = mesh(vec![[-99.0, -99.0, 0.0], [299.0, -99.0, 0.0], [-99.0, 299.0, 0.0]], vec![[0, 1, 2]]);
    let found = seen(&all, &by_pixels([5, 3]));
    assert_eq!((found.covered_px, found.visible.quads, found.visible.helpers()), (15, 6, 9));
}

#[test]
fn a_triangle_wastes_lanes_only_where_its_edges_pass() {
    let mut random = Random::new(7);
    for _ in 0..50 {
        let corner = |random: &mut Random| [40.0 * random.signed(), 40.0 * random.signed(), 0.0];
        let corners = vec![corner(&mut random), corner(&mut random), corner(&mut random)];
        let found = seen(&mesh(corners.clone(), vec![[0, 1, 2]]), &by_pixels([64, 64]));
        // An edge passes at most two quads for each row of quads that it spans and two for each column.
        let crossed: f64 = (0..3)
            .map(|k| {
                (0..2)
                    .map(|axis| (corners[k][axis] - corners[(k + 1) % 3][axis]).abs() / 2.0 + 2.0)
                    .sum::<f64>()
            })
            .sum();
        assert!(found.visible.helpers() as f64 <= 3.0 * crossed, "{found:?}");
    }
}

#[test]
fn right_triangles_of_whole_quads_share_those_on_their_diagonals() {
    for m in [1_u64, 2, 4, 8] {
        let cells = 32 / m;
        let side = 2.0 * m as f64;
        let mesh = grid([cells as u32; 2], side, [-32.0, -32.0]);
        let found = seen(&mesh, &by_pixels([64, 64]));
        // A square of m × m quads: those on the diagonal are shaded twice.
        let quads = cells * cells * (m * m + m);
        assert_eq!((found.covered_px, found.every.fragments, found.every.quads), (4096, 4096, quads));
        assert_eq!((found.visible, found.missed, found.in_view), (found.every, 0, 2 * cells * cells));
        assert_eq!(found.ratio(), (m + 1) as f64 / m as f64);
        assert_eq!(found.micro, 0, "two squares of pixels at least");
    }
}

#[test]
fn triangles_of_half_a_pixel_run_four_lanes_for_each_and_half_of_them_for_nothing() {
    let found = seen(&grid([64; 2], 1.0, [-32.0, -32.0]), &by_pixels([64, 64]));
    // The diagonal passes through the centre, which is one triangle's.
    assert_eq!((found.in_view, found.missed, found.micro), (8192, 4096, 8192));
    assert_eq!((found.every.quads, found.every.helpers(), found.ratio()), (4096, 3 * 4096, 4.0));
    assert!(found.launches.iter().all(|n| *n == 4));
    assert_eq!((found.drawn(), found.micro_share(), found.visible.helper_share()), (4096, 1.0, 0.75));
}

#[test]
fn every_pixel_of_a_tiling_belongs_to_one_triangle() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        println!("seed {seed}");
        let n = 3 + random.below(40) as u32;
        let step = 80.0 / f64::from(n);
        let flat = grid([n; 2], step, [-40.0, -40.0]);
        // Moved within their cells, so that none turns over, and some on to pixel centres.
        let move_by = |p: &[f64; 3], random: &mut Random| {
            let moved = [p[0] + 0.2 * step * random.signed(), p[1] + 0.2 * step * random.signed()];
            let [x, y] =
                if step > 8.0 && random.below(2) == 0 { moved.map(|x| x.floor() + 0.5) } else { moved };
            [x, y, 0.0]
        };
        let positions = flat.positions().iter().map(|p| move_by(p, &mut random)).collect();
        let tiling = mesh(positions, flat.faces().to_vec());
        for camera in [by_pixels([60, 46]), Camera { eye: [3.0, -20.0, 30.0], ..camera(FOV, [60, 46]) }] {
            let found = seen(&tiling, &camera);
            assert_eq!((found.every.fragments, found.covered_px), (60 * 46, 60 * 46));
        }
    }
}

#[test]
fn a_turned_camera_sees_the_same_turned() {
    let mut random = Random::new(3);
    let mesh = soup(300, &mut random);
    for projection in [FOV, Projection::Orthographic { height: 9.0 }] {
        let camera = Camera { eye: [0.0, 0.0, 30.0], ..camera(projection, [48, 48]) };
        let all = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]]
            .map(|up| seen(&mesh, &Camera { up, ..camera }));
        for turned in &all[1..] {
            assert_eq!((turned.every, turned.visible), (all[0].every, all[0].visible));
            assert_eq!(
                (turned.in_view, turned.missed, turned.micro),
                (all[0].in_view, all[0].missed, all[0].micro)
            );
        }
        assert!(all[0].launches != all[1].launches);
    }
}

#[test]
fn scale_changes_nothing() {
    let mesh = soup(200, &mut Random::new(5));
    let near = Camera { near: 0.5, ..camera(FOV, [60, 40]) };
    let at_one = (seen(&mesh, &near), flicker(&mesh, &near, HitSides::Both, &Job::default()));
    for scale in [2.0_f64.powi(-100), 2.0_f64.powi(-20), 2.0_f64.powi(20), 2.0_f64.powi(400)] {
        let larger =
            mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect()).unwrap();
        let camera = Camera { eye: near.eye.map(|x| x * scale), near: near.near * scale, ..near };
        let found = (seen(&larger, &camera), flicker(&larger, &camera, HitSides::Both, &Job::default()));
        assert!(found == at_one, "scale {scale}");
    }
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let mesh = sphere(150);
    let camera = Camera { eye: [0.0, 0.0, 3.0], ..camera(FOV, [700, 500]) };
    let on = |threads: usize| {
        let job = Job::default().with_threads(threads);
        let found = flicker(&mesh, &camera, HitSides::Both, &job).unwrap();
        (overshade(&mesh, &camera, HitSides::Both, &job).unwrap(), found.rms.to_bits(), found.n_pixels)
    };
    let one = on(1);
    assert!(one.0.covered_px > 100_000 && one.2 > 100_000);
    assert!(on(2) == one && on(5) == one);
}

#[test]
fn hidden_triangles_are_shaded_only_without_a_depth_test() {
    // Three layers, the nearest last: of the others nothing is visible.
    let layers: Vec<Mesh> = [-2.0, -1.0, 0.0].map(|_| grid([4; 2], 16.0, [-32.0, -32.0])).into();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for (k, layer) in layers.iter().enumerate() {
        let first = positions.len() as u32;
        positions.extend(layer.positions().iter().map(|p| [p[0], p[1], k as f64 - 2.0]));
        faces.extend(layer.faces().iter().map(|face| face.map(|row| row + first)));
    }
    let one = seen(&layers[0], &by_pixels([64, 64]));
    let all = seen(&mesh(positions, faces), &by_pixels([64, 64]));
    assert_eq!((all.visible, all.covered_px), (one.visible, 4096));
    assert_eq!((all.every.quads, all.every.fragments), (3 * one.every.quads, 3 * 4096));
}

#[test]
fn fronts_and_backs_are_all() {
    let mesh = sphere(40);
    let camera = Camera { eye: [0.0, 0.0, 3.0], ..camera(FOV, [200, 200]) };
    let [both, front, back] = [HitSides::Both, HitSides::Front, HitSides::Back]
        .map(|sides| overshade(&mesh, &camera, sides, &Job::default()).unwrap());
    assert_eq!(both.every.quads, front.every.quads + back.every.quads);
    assert_eq!(both.every.fragments, 2 * both.covered_px, "each ray enters and leaves");
    assert_eq!((front.visible, front.covered_px), (both.visible, both.covered_px), "backs are hidden");
    assert!(front.every.quads >= front.visible.quads && back.covered_px == both.covered_px);
}

#[test]
fn ground_from_under_the_eye_to_the_horizon_fills_the_lower_half() {
    let r = 1e7;
    let ground =
        mesh(vec![[-r, -r, 0.0], [r, -r, 0.0], [r, r, 0.0], [-r, r, 0.0]], vec![[0, 1, 2], [0, 2, 3]]);
    let eye = [0.3, 0.1, 1.0];
    let looks = Camera { eye, target: [0.3, 9.0, 1.0], up: [0.0, 0.0, 1.0], ..camera(FOV, [320, 200]) };
    assert_eq!(seen(&ground, &looks).covered_px, 320 * 100);
    // A row y pixels below the horizon sees the depth F/y, F = 100/tan 25°; those nearer than 4 are not
    // drawn.
    let focal = 100.0 / libm::tan(25.0_f64.to_radians());
    let rows = (0..100).filter(|y| focal / (f64::from(*y) + 0.5) >= 4.0).count() as u64;
    assert!((40..60).contains(&rows));
    assert_eq!(seen(&ground, &Camera { near: 4.0, ..looks }).covered_px, 320 * rows);
    // A grid of many triangles, some cut by the plane of the eye and some behind it, has no cracks and no
    // overlaps.
    let field = grid([31; 2], 7.3, [-100.0, -100.0]);
    let found = seen(&field, &looks);
    assert_eq!(found.every.fragments, found.covered_px);
    let far = mesh(field.positions().to_vec(), vec![[0, 31, 32 * 32 - 1], [0, 32 * 32 - 1, 32 * 31]]);
    assert_eq!(found.covered_px, seen(&far, &looks).covered_px);
}

#[test]
fn what_is_behind_or_beside_costs_nothing() {
    let front = camera(FOV, [64, 48]);
    for shift in [[0.0, 0.0, 20.0], [0.0, 0.0, 8.0], [400.0, 0.0, 0.0], [0.0, -400.0, 0.0]] {
        let moved = grid([3; 2], 1.0, [-1.5, -1.5]);
        let place = |p: &[f64; 3]| [0, 1, 2].map(|k| p[k] + shift[k]);
        let mesh = moved.with_positions(moved.positions().iter().map(place).collect()).unwrap();
        let found = seen(&mesh, &front);
        assert_eq!(
            (found.covered_px, found.every.quads, found.in_view, found.micro),
            (0, 0, 0, 0),
            "{shift:?}"
        );
        assert_eq!((found.ratio(), found.visible.helper_share(), found.micro_share()), (0.0, 0.0, 0.0));
    }
    let empty = mesh(vec![], vec![]);
    assert_eq!((seen(&empty, &front).n_triangles, seen(&empty, &front).launches.len()), (0, 32 * 24));
    assert_eq!(flicker(&empty, &front, HitSides::Both, &Job::default()).unwrap().n_pixels, 0);
}

#[test]
fn no_finite_mesh_breaks_it() {
    let mut random = Random::new(11);
    let extremes = [0.0, -0.0, 1.0, -1.0, 8.0, 1e-320, 1e-30, 3e5, 1e30, -1e160, 1e300, f64::MAX, f64::MIN];
    let views = [
        "9x7 fov=50 eye=0,0,8 target=0,0,0",
        "9x7 fov=179.9999 eye=0,0,8 target=0,0,0",
        "9x7 fov=1e-9 eye=0,0,8 target=0,0,0",
        "9x7 height=1e300 eye=0,0,8 target=0,0,0",
        "9x7 height=1e-300 eye=0,0,8 target=0,0,0",
        "9x7 fov=50 eye=1e308,0,-1e308 target=0,0,0",
        "9x7 fov=50 eye=0,0,1e-310 target=0,0,0",
        "9x7 fov=50 eye=0,0,8 target=0,0,0 near=1e300",
    ];
    let mut covered = 0;
    for round in 0..40 {
        let corner = |random: &mut Random| {
            [0, 1, 2].map(|_| {
                let x = extremes[random.below(extremes.len())];
                if round % 2 == 0 { x } else { x * random.signed() }
            })
        };
        let positions = (0..30).map(|_| corner(&mut random)).collect();
        let mesh = mesh(positions, (0..60).map(|_| [0, 1, 2].map(|_| random.below(30) as u32)).collect());
        for view in views {
            let View::Camera(camera) = view.parse().unwrap() else { unreachable!() };
            let found = seen(&mesh, &camera);
            assert!(found.covered_px <= 63 && found.visible.fragments == found.covered_px);
            assert!(found.visible.quads <= found.every.quads && found.missed <= found.in_view);
            covered += found.covered_px;
            let flickers = flicker(&mesh, &camera, HitSides::Both, &Job::default()).unwrap();
            assert!((0.0..=0.5).contains(&flickers.rms), "{flickers:?}");
        }
    }
    assert!(covered > 1000, "{covered}");
}

#[test]
fn refusals_are_typed_and_a_cancel_is_obeyed() {
    let mesh = sphere(4);
    let refused = |camera: &Camera, job: &Job| match overshade(&mesh, camera, HitSides::Both, job) {
        Err(JobError::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    };
    let job = Job::default();
    assert_eq!(refused(&camera(FOV, [u32::MAX; 2]), &job), RefusalCode::TooMuchMemory);
    assert_eq!(refused(&camera(FOV, [1 << 21, 1]), &job), RefusalCode::Unsupported);
    assert_eq!(refused(&Camera { eye: [0.0; 3], ..camera(FOV, [4, 4]) }, &job), RefusalCode::Unsupported);
    assert_eq!(refused(&Camera { near: f64::NAN, ..camera(FOV, [4, 4]) }, &job), RefusalCode::Unsupported);
    assert_eq!(
        refused(&camera(Projection::Orthographic { height: 1e-320 }, [4, 4]), &job),
        RefusalCode::Unsupported
    );
    let limited = |bytes: u64| {
        let mut job = Job::default();
        job.memory_limit = bytes;
        job
    };
    let small = limited(100_000);
    assert_eq!(refused(&camera(FOV, [100, 100]), &small), RefusalCode::TooMuchMemory);
    assert!(overshade(&mesh, &camera(FOV, [20, 20]), HitSides::Both, &small).is_ok());
    // The list of which triangle is where does not fit.
    let many = many();
    assert!(overshade(&many, &by_pixels([64, 64]), HitSides::Both, &limited(12_000_000)).is_ok());
    assert_eq!(
        overshade(&many, &by_pixels([64, 64]), HitSides::Both, &limited(6_000_000)).err().map(|stopped| {
            match stopped {
                JobError::Refused(refusal) => refusal.code,
                JobError::Cancelled => RefusalCode::Empty,
            }
        }),
        Some(RefusalCode::TooMuchMemory)
    );
    job.cancel();
    for cancelled in [
        overshade(&mesh, &camera(FOV, [64, 64]), HitSides::Both, &job).err(),
        flicker(&mesh, &camera(FOV, [64, 64]), HitSides::Both, &job).err(),
    ] {
        assert_eq!(cancelled, Some(JobError::Cancelled));
    }
}

/// 500,000 triangles in one place: 2 megabytes of shades, and 4 of places.
fn many() -> Mesh {
    mesh(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]; 500_000])
}

#[test]
fn the_edge_of_a_roof_flickers_by_half_of_its_contrast_along_its_line() {
    // The ridge runs up the screen through the centres of one column: eight of sixteen shifts see either
    // side.
    let slope = 0.5;
    let roof = mesh(
        vec![
            [-50.0, -50.0, -50.0 * slope],
            [0.0, -50.0, 0.0],
            [0.0, 50.0, 0.0],
            [-50.0, 50.0, -50.0 * slope],
            [50.0, -50.0, -50.0 * slope],
            [50.0, 50.0, -50.0 * slope],
        ],
        vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]],
    );
    let size = [31, 20];
    let found = flicker(&roof, &by_pixels(size), HitSides::Both, &Job::default()).unwrap();
    let shade = |x: f64| {
        let normal = [x * slope, 0.0, 1.0].map(|n: f64| n / (1.0 + slope * slope).sqrt());
        0.5 + 0.5 * (-normal[0] + normal[1] + 2.0 * normal[2]) / 6.0_f64.sqrt()
    };
    let expected = (shade(1.0) - shade(-1.0)).abs() / 2.0 / 31.0_f64.sqrt();
    assert_eq!(found.n_pixels, 31 * 20);
    assert!((found.rms - expected).abs() < 1e-7, "{} and not {expected}", found.rms);
    // From behind the normal is turned: the same contrast.
    let behind = Camera { eye: [0.0, 0.0, -90.0], ..by_pixels(size) };
    let from_behind = flicker(&roof, &behind, HitSides::Both, &Job::default()).unwrap();
    assert!((from_behind.rms - expected).abs() < 1e-7, "{}", from_behind.rms);
}

#[test]
fn detail_below_the_pixel_flickers_as_chance_would_and_a_smooth_surface_hardly() {
    let rough = |n: u32| {
        let flat = grid([n; 2], 64.0 / f64::from(n), [-32.0, -32.0]);
        let mut random = Random::new(9);
        // As steep at every size.
        let high = 30.0 / f64::from(n);
        let lift = |p: &[f64; 3]| [p[0], p[1], high * random.signed()];
        mesh(flat.positions().iter().map(lift).collect(), flat.faces().to_vec())
    };
    let rms = |mesh: &Mesh| flicker(mesh, &by_pixels([60, 60]), HitSides::Both, &Job::default()).unwrap().rms;
    let [coarse, fine, finest] = [8, 64, 512].map(rough);
    assert!(rms(&fine) > 2.0 * rms(&coarse));
    // In an eighth of a pixel, no two of a pixel's sixteen samples share a corner: their shades are
    // independent, and the mean square about the mean of sixteen is 15/16 of the variance.
    let shades: Vec<f64> = (0..finest.faces().len())
        .map(|face| {
            let [x, y, z] = chordal::explicit::face_normal(finest.corners(face)).unwrap();
            0.5 + 0.5 * (-x + y + 2.0 * z) / 6.0_f64.sqrt()
        })
        .collect();
    let n = shades.len() as f64;
    let mean = shades.iter().sum::<f64>() / n;
    let variance = shades.iter().map(|shade| (shade - mean).powi(2)).sum::<f64>() / n;
    let expected = (variance * 15.0 / 16.0).sqrt();
    // 57,600 samples say the root of a variance to about half a percent.
    assert!((rms(&finest) / expected - 1.0).abs() < 0.015, "{} and not {expected}", rms(&finest));
    let smooth = Camera { eye: [0.0, 0.0, 3.0], ..camera(FOV, [200, 200]) };
    let [coarse, fine] =
        [20, 200].map(|n| flicker(&sphere(n), &smooth, HitSides::Both, &Job::default()).unwrap().rms);
    assert!(fine < 0.4 * coarse, "{coarse} {fine}");
}

#[test]
fn a_million_triangles_on_a_screen_run_nearly_four_lanes_a_pixel() {
    let camera = Camera { eye: [0.0, 0.0, 4.0], ..camera(FOV, [480, 270]) };
    let mut last = 1.0;
    for n in [5, 16, 50, 158, 500] {
        let found = seen(&sphere(n), &camera);
        assert!(found.ratio() > last, "{n}: {}", found.ratio());
        last = found.ratio();
    }
    assert!(last > 3.8, "{last}");
    let found = seen(&sphere(500), &camera);
    assert!(found.micro_share() > 0.99 && found.missed > found.in_view / 2, "{found:?}");
}

#[test]
fn the_estimate_for_any_eye_so_near_counts_what_a_camera_there_sees() {
    // One pixel's area is two of these triangles': from half as far, half as many would be.
    for (view, at) in [("100x100 fov=90 dist=50", 50.0), ("100x100 height=100", 50.0)] {
        let view: View = view.parse().unwrap();
        for (side, micro) in [(1.0, 1800), (1.3, 1800), (1.5, 0)] {
            let mesh = grid([30; 2], side, [-15.0 * side, -15.0 * side]);
            let closest = micro_triangles(&mesh, &view, &Job::default()).unwrap();
            assert_eq!((closest.n_micro, closest.n_triangles), (micro, 1800));
            let projection = match view {
                View::MinDistance(closest) => closest.projection,
                View::Camera(_) => unreachable!(),
            };
            let there = View::Camera(Camera { eye: [0.0, 0.0, at], ..camera(projection, [100, 100]) });
            assert_eq!(micro_triangles(&mesh, &there, &Job::default()).unwrap(), closest);
        }
    }
}
