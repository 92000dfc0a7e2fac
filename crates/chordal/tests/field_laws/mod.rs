//! Laws of fields: what a shape says of its value, its sign and its box holds at random points, for every
//! shape and for random trees of them.
mod law;
mod trees;

use chordal::implicit::shapes::*;
use chordal::implicit::{Affine3, Distance, DistanceQuality, Field, Repeat};
use chordal_testkit::{Random, is_long};
use law::obey;

/// One test for each shape: its name and how it is made.
macro_rules! field_laws {
    ($($name:ident: $field:expr;)*) => {$(
        #[test]
        fn $name() {
            let make = || -> Result<Field, InvalidShape> { $field };
            obey(stringify!($name), &make().expect("a shape"));
        }
    )*};
}

fn star() -> Vec<[f64; 2]> {
    (0..14_u32)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 14.0;
            let r = if k % 2 == 0 { 1.5 } else { 0.6 };
            [r * angle.cos(), r * angle.sin()]
        })
        .collect()
}

fn bar() -> Result<Field, InvalidShape> {
    cuboid([0.5, 0.4, 2.0])
}

field_laws! {
    a_sphere: sphere(1.25);
    a_cuboid: cuboid([2.0, 1.0, 0.5]);
    a_rounded_cuboid: rounded_cuboid([2.0, 1.0, 1.5], 0.25);
    a_ball_as_a_rounded_cuboid: rounded_cuboid([1.0; 3], 0.5);
    a_cylinder: cylinder(0.75, 1.5);
    a_capped_cone: capped_cone(1.0, 0.4, 1.5);
    a_pointed_cone: capped_cone(0.0, 1.2, 1.5);
    a_capsule: capsule([-0.5, 0.25, 0.0], [1.0, 0.5, 1.0], 0.4);
    a_capsule_without_length: capsule([0.5, 0.25, 0.0], [0.5, 0.25, 0.0], 0.4);
    a_torus: torus(1.0, 0.3);
    a_spindle: torus(0.4, 0.7);
    a_plane: plane([1.0, 2.0, -2.0], 0.5);
    a_level_plane: plane([0.0, 0.0, -3.0], 0.5);
    an_ellipsoid: ellipsoid([1.5, 0.5, 0.75]);
    a_triangle: triangle([[0.0, 0.0, 0.0], [1.5, 0.2, 0.0], [0.3, 1.2, 0.8]], 0.3);
    a_tetrahedron: tetrahedron(1.5);
    an_octahedron: octahedron(1.5);
    a_gyroid: gyroid(2.0, 0.1);
    a_schwarz_p: schwarz_p(2.5, 0.0);
    a_diamond: diamond(3.0, 0.0);
    a_circle: circle(1.0);
    a_rectangle: rectangle([2.0, 1.0]);
    a_rounded_rectangle: rounded_rectangle([2.0, 1.0], 0.2);
    a_segment: segment([-1.0, 0.0], [1.0, 0.5], 0.3);
    a_pentagon: regular_polygon(5, 1.2);
    a_star: polygon(&star());
    a_bow_tie: polygon(&[[-1.0, -1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0]]);
    a_prism: prism(6, 1.0, 1.5);
    a_star_extruded: polygon(&star())?.extruded(1.0);
    a_ring_revolved: Ok(rectangle([0.5, 0.8])?.moved([1.0, 0.0, 0.0])?.revolved());
    a_ball_revolved: Ok(circle(1.0)?.revolved());
    a_drilled_block: Ok(cuboid([2.0, 2.0, 1.0])?.difference(&cylinder(0.4, 2.0)?));
    a_symmetric_difference: Ok(sphere(1.0)?.xor(&cuboid([1.5; 3])?));
    a_gyroid_in_a_ball: Ok(gyroid(1.0, 0.0)?.intersection(&sphere(1.5)?));
    a_gyroid_wall: gyroid(1.5, 0.0)?.shell(0.2);
    a_blend: cuboid([1.5, 0.6, 0.6])?.smooth_union(&sphere(0.6)?.moved([0.5, 0.5, 0.0])?, 0.4);
    a_rounded_cut: cuboid([1.5, 1.5, 1.0])?.smooth_difference(&cylinder(0.4, 2.0)?, 0.3);
    a_rounded_common_part: cuboid([1.5; 3])?.smooth_intersection(&sphere(1.0)?, 0.3);
    a_moved_box: bar()?.moved([0.1, -0.7, 1e-3]);
    a_turned_box: bar()?.rotated_deg([1.0, 2.0, 0.5], 33.0);
    a_box_turned_by_quarters: bar()?.rotated_deg([1.0, 0.0, 0.0], 90.0);
    a_larger_box: bar()?.scaled([1.5; 3]);
    a_stretched_torus: torus(1.0, 0.3)?.scaled([1.0, -0.5, 2.0]);
    a_mirrored_cone: capped_cone(1.0, 0.4, 1.5)?.mirrored([1.0, 1.0, 1.0]);
    a_sheared_box: bar()?.transformed(&shear());
    a_grown_box: bar()?.offset(0.3);
    a_shrunk_star: polygon(&star())?.offset(-0.2);
    a_grown_cut: cuboid([1.0; 3])?.difference(&sphere(0.6)?).offset(0.2);
    a_box_wall: bar()?.shell(0.1);
    a_twisted_bar: bar()?.twisted(1.5);
    a_bent_bar: cuboid([2.0, 0.4, 0.5])?.bent(0.8);
    a_row_of_balls: sphere(0.4)?.repeated([Repeat::Times(3, 1.0), Repeat::Once, Repeat::Once]);
    balls_without_end: sphere(0.4)?.repeated([Repeat::Every(1.0), Repeat::Every(1.5), Repeat::Once]);
    overlapping_capsules: capsule([0.0; 3], [1.7, 0.3, 0.0], 0.2)?
        .repeated([Repeat::Every(1.0), Repeat::Times(40, 0.25), Repeat::Once]);
    a_union_of_many: Ok(Field::union_of(&scattered()?));
    bumps: sphere(1.0)?.displaced(&gyroid(0.7, 0.0)?.expr().clone(), 0.3);
}

fn shear() -> Affine3 {
    Affine3::new([[1.0, 0.5, 0.0, 0.1], [0.0, 1.0, 0.2, 0.0], [0.0, 0.0, 0.7, 0.3]]).expect("regular")
}

fn scattered() -> Result<Vec<Field>, InvalidShape> {
    let mut random = Random::new(7);
    (0..50).map(|_| sphere(0.3)?.moved(random.point_within(2.0))).collect()
}

/// Laws that fail on what breaks them: a distance twice too long, a box that is too small, a sign of another
/// shape.
#[test]
fn the_laws_notice_what_is_wrong() {
    let ball = || sphere(1.0).expect("a shape");
    let wrong = [
        Field::new(ball().expr() * 2.0).with_distance(Distance::EXACT),
        Field::new(ball().expr() * 1.5).with_distance(Distance::BOUND),
        Field::new(ball().expr() * 0.5).with_distance(Distance::EXACT),
        ball().with_bounds(cuboid([1.5; 3]).expect("a shape").bounds()),
        ball().with_sign(sphere(1.25).expect("a shape").expr().clone()),
    ];
    for field in wrong {
        let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| obey("wrong", &field)));
        assert!(found.is_err(), "{field:?} passed");
    }
}

#[test]
fn csg_is_minimum_and_maximum() {
    let (a, b) = (torus(1.0, 0.3).expect("a shape"), cuboid([1.0, 2.0, 0.5]).expect("a shape"));
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let p = random.point_within(2.0);
        let at = |field: &Field| field.expr().at(p).expect("no leaf fails");
        let (va, vb) = (at(&a), at(&b));
        assert_eq!(at(&a.union(&b)), va.min(vb));
        assert_eq!(at(&a.intersection(&b)), va.max(vb));
        assert_eq!(at(&a.difference(&b)), va.max(-vb));
        assert_eq!(at(&a.complement()), -va);
        assert_eq!(at(&a.xor(&b)), va.min(vb).max(-va.max(vb)));
    }
}

#[test]
fn what_needs_a_distance_asks_for_it() {
    let ball = sphere(1.0).expect("a shape");
    let sign = Field::new(ball.expr().square() * ball.expr());
    for refused in [
        sign.offset(0.1),
        sign.offset(-0.1),
        sign.shell(0.1),
        sign.smooth_union(&ball, 0.1),
        ball.smooth_intersection(&sign, 0.1),
        sign.displaced(ball.expr(), 0.1),
    ] {
        let error = refused.expect_err("only a sign");
        assert!(matches!(error, InvalidShape::NeedsDistance { .. }), "{error}");
        assert!(error.to_string().contains("needs a distance"));
    }
}

#[test]
fn wrong_numbers_are_named() {
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    let ball = sphere(1.0).expect("a shape");
    let refused: Vec<(Result<Field, InvalidShape>, &str)> = vec![
        (sphere(-1.0), "-1"),
        (sphere(nan), "NaN"),
        (sphere(0.0), "0"),
        (cuboid([1.0, inf, 1.0]), "inf"),
        (rounded_cuboid([1.0; 3], 0.75), "0.75"),
        (cylinder(1.0, -2.0), "-2"),
        (capped_cone(0.0, 0.0, 1.0), "0"),
        (capsule([nan, 0.0, 0.0], [0.0; 3], 1.0), "NaN"),
        (torus(1.0, 0.0), "0"),
        (plane([0.0; 3], 1.0), "length"),
        (gyroid(-3.0, 0.0), "-3"),
        (polygon(&[[0.0; 2], [1.0, 0.0]]), "2"),
        (regular_polygon(2, 1.0), "2"),
        (ball.scaled([1.0, 0.0, 1.0]), "0"),
        (ball.moved([0.0, inf, 0.0]), "inf"),
        (ball.rotated_deg([0.0; 3], 10.0), "length"),
        (ball.repeated([Repeat::Every(-1.0), Repeat::Once, Repeat::Once]), "-1"),
        (ball.repeated([Repeat::Every(1e-6), Repeat::Once, Repeat::Once]), "short"),
        (ball.complement().repeated([Repeat::Every(1.0), Repeat::Once, Repeat::Once]), "bounds"),
    ];
    for (made, named) in refused {
        let sentence = made.expect_err(named).to_string();
        assert!(sentence.contains(named), "{sentence} does not name {named}");
    }
}

/// Any number of shapes are one: depth is logarithmic, and nothing recurses.
#[test]
fn a_million_shapes_unite() {
    // A tenth of them would overflow the stack of a test, too, if anything recursed.
    let n = if is_long() { 1_000_000 } else { 100_000 };
    let ball = sphere(0.4).expect("a shape");
    let many: Vec<Field> = (0..n).map(|k| ball.moved([f64::from(k), 0.0, 0.0]).expect("finite")).collect();
    let all = Field::union_of(&many);
    let end = all.bounds().max[0];
    let last = f64::from(n - 1) + 0.4;
    assert!((last..last + 1e-6).contains(&end), "{end}");
    assert_eq!(all.distance().outside, DistanceQuality::Exact);
}

#[test]
fn nothing_is_neutral() {
    let ball = sphere(1.0).expect("a shape");
    let p = [0.3, 0.9, 2.0];
    let at = |field: &Field| field.expr().at(p).expect("no leaf fails");
    assert_eq!(at(&ball.union(&Field::nothing())), at(&ball));
    assert_eq!(at(&ball.difference(&Field::nothing())), at(&ball));
    assert!(ball.intersection(&Field::nothing()).bounds().is_empty());
}
