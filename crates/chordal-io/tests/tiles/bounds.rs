//! Boxes around contents: tight, outward, and where a viewer puts what the GLB holds.
use chordal::Mesh;
use chordal::math::Box3;
use chordal_io::tiles::{aligned_box, content_bounds};
use chordal_io::{Axis, Content, Frame, Limits, Scene, glb};
use proptest::prelude::*;

fn scene(points: &[[f64; 3]], frame: Frame) -> Scene {
    let n = points.len() as u32;
    let faces = (0..n - 2).map(|i| [i, i + 1, i + 2]).collect();
    Scene::from_mesh("cloud", Mesh::new(points.to_vec(), faces).expect("valid"), frame)
}

/// What a viewer shows of the file: its positions, turned to z-up.
fn shown(scene: &Scene) -> Vec<[f64; 3]> {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    let Content::Scene(read) = glb::read(&bytes, &Limits::default()).expect("read").content else {
        panic!("no scene")
    };
    let meshes = read.world_meshes().expect("placed");
    let points = meshes.iter().flat_map(|(_, mesh)| mesh.positions().to_vec());
    points.map(|[x, y, z]| [x, -z, y]).collect()
}

fn frames() -> impl Strategy<Value = Frame> {
    let up = prop::sample::select(vec![None, Some(Axis::Y), Some(Axis::Z)]);
    let unit = prop::sample::select(vec![None, Some(1.0), Some(0.001), Some(0.3048), Some(1e5)]);
    (up, unit).prop_map(|(up, metres_per_unit)| Frame { up, metres_per_unit, ..Frame::default() })
}

proptest! {
    #[test]
    fn the_box_holds_what_is_shown_and_touches_it(
        unit in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 3..20),
        centre in prop::array::uniform3(-1.0..1.0_f64),
        scale in prop::array::uniform2(-3.0..4.0_f64),
        angle in prop::option::of(-3.0..3.0_f64),
        frame in frames(),
    ) {
        let (size, away) = (libm::pow(10.0, scale[0]), libm::pow(10.0, scale[1]));
        let points: Vec<[f64; 3]> = unit.iter().map(|u| std::array::from_fn(|k| away * centre[k] + size * u[k])).collect();
        let mut scene = scene(&points, frame);
        if let Some(angle) = angle {
            let (s, c) = (libm::sin(angle), libm::cos(angle));
            scene.nodes[0].matrix = [c, s, 0.0, 0.0, -s, c, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, -7.0, 0.1, 1.0].into();
        }
        let bounds = content_bounds(&scene).unwrap();
        let seen = Box3::from_points(&shown(&scene));
        // The reader rounds too: by a few units in the last place of the largest number on the way.
        let reach = bounds.min.iter().chain(&bounds.max).fold(10.0 * away * frame.metres_per_unit.unwrap_or(1.0), |m, x| x.abs().max(m));
        for k in 0..3 {
            let slack = 32.0 * f64::EPSILON * reach;
            prop_assert!(bounds.min[k] <= seen.min[k] + slack && seen.max[k] - slack <= bounds.max[k]);
            prop_assert!((bounds.min[k] - seen.min[k]).abs() <= slack && (bounds.max[k] - seen.max[k]).abs() <= slack);
        }
    }

    #[test]
    fn the_tile_holds_its_box(
        a in prop::array::uniform3(-1.0..1.0_f64),
        side in prop::array::uniform3(prop::sample::select(vec![0.0, 1e-12, 1e-3, 1.0, 1e9])),
    ) {
        let bounds = Box3 { min: a, max: std::array::from_fn(|k| a[k] + side[k]) };
        let volume = aligned_box(&bounds);
        for k in 0..3 {
            let (centre, half) = (volume[k], volume[3 + 4 * k]);
            prop_assert!(centre - half <= bounds.min[k] && bounds.max[k] <= centre + half);
            let room = 4.0 * f64::EPSILON * (centre.abs() + half);
            prop_assert!(2.0 * half <= (bounds.max[k] - bounds.min[k]) + room);
        }
        prop_assert!([4, 5, 6, 8, 9, 10].iter().all(|i| volume[*i] == 0.0));
    }
}

#[test]
fn a_z_up_scene_is_where_its_coordinates_say() {
    let points = [[1.0, 2.0, 3.0], [4.0, 2.0, 3.0], [1.0, 8.0, 5.0]];
    let bounds = |up, metres_per_unit| {
        let bounds = content_bounds(&scene(&points, Frame { up, metres_per_unit, ..Frame::default() }))
            .expect("bounds");
        (bounds.min, bounds.max)
    };
    assert_eq!(bounds(Some(Axis::Z), None), ([1.0, 2.0, 3.0], [4.0, 8.0, 5.0]));
    assert_eq!(bounds(Some(Axis::Y), Some(1.0)), ([1.0, -5.0, 2.0], [4.0, -3.0, 8.0]));
    assert_eq!(bounds(None, None), bounds(Some(Axis::Y), None));
    let (min, max) = bounds(Some(Axis::Z), Some(0.001));
    assert!(min[0] <= 0.001 && min[0] > 0.000_999_999 && max[1] >= 0.008 && max[1] < 0.008_000_001);
}

#[test]
fn nodes_that_are_no_tree_and_units_that_are_no_length_are_refused() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut twice = scene(&points, Frame::default());
    twice.roots = vec![0, 0];
    assert!(content_bounds(&twice).is_err());
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let frame = Frame { up: None, metres_per_unit: Some(unit), ..Frame::default() };
        assert!(content_bounds(&scene(&points, frame)).is_err());
    }
    let mut wide = scene(&points, Frame { up: None, metres_per_unit: Some(1e300), ..Frame::default() });
    wide.nodes[0].matrix[0] = 1e200;
    assert!(content_bounds(&wide).is_err());
    let nothing = Scene { nodes: vec![], roots: vec![], ..scene(&points, Frame::default()) };
    assert!(content_bounds(&nothing).expect("empty").is_empty());
}
