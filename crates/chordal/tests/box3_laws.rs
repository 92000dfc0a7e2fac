//! Laws of `Box3`.
use crate::exact;
use chordal::math::Box3;
use exact::{at_most, cases, exact, number};
use proptest::prelude::*;

fn point() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn cloud() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(point(), 1..9)
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn the_diagonal_bounds_every_distance_inside_and_little_more(points in cloud()) {
        let place = Box3::from_points(&points);
        let diagonal = place.diagonal();
        let sides: [_; 3] = std::array::from_fn(|k| exact(place.max[k]) - exact(place.min[k]));
        let square = sides.iter().fold(exact(0.0), |sum, side| sum + side * side);
        prop_assert!(diagonal == f64::INFINITY || square <= exact(diagonal) * exact(diagonal));
        // Ten roundings of half a unit each, moved outward by one unit each.
        let low = exact(diagonal.min(f64::MAX)) * exact(1.0 - 16.0 * f64::EPSILON) - exact(1e-322);
        prop_assert!(low < exact(0.0) || &low * &low <= square, "{diagonal:e} is high for {place:?}");
    }

    #[test]
    fn a_box_holds_what_it_is_around_and_grows_by_union(a in cloud(), b in cloud(), stray in point()) {
        let (box_a, box_b) = (Box3::from_points(&a), Box3::from_points(&b));
        let both = box_a.union(box_b);
        prop_assert!(a.iter().chain(&b).all(|p| both.contains(*p)));
        prop_assert!(!both.is_empty() && box_a.with(stray).contains(stray));
        prop_assert_eq!(both, box_b.union(box_a));
        prop_assert_eq!(both.union(box_a), both);
        prop_assert_eq!(box_a.union(Box3::EMPTY), box_a);
        prop_assert_eq!(Box3::from_points(a.iter().chain(&b)), both);
        prop_assert!(!box_a.contains(stray) || both.contains(stray));
        prop_assert!(both.diagonal() >= box_a.diagonal());
        // It is the smallest: each face carries a point.
        for k in 0..3 {
            prop_assert!(a.iter().any(|p| p[k] == box_a.min[k]) && a.iter().any(|p| p[k] == box_a.max[k]));
        }
    }

    #[test]
    fn the_centre_is_inside(points in cloud()) {
        let place = Box3::from_points(&points);
        let centre = place.centre();
        for k in 0..3 {
            let off = exact(2.0) * exact(centre[k]) - (exact(place.min[k]) + exact(place.max[k]));
            let rounding = exact(4.0 * f64::EPSILON * (0.5 * place.min[k].abs() + 0.5 * place.max[k].abs())) + exact(1e-323);
            prop_assert!(off <= rounding && -off <= rounding, "{centre:?} in {place:?}");
        }
        prop_assert!(at_most(&exact(centre[0]), place.max[0].next_up()));
    }
}

#[test]
fn the_empty_box_has_nothing() {
    assert!(Box3::EMPTY.is_empty() && !Box3::EMPTY.contains([0.0; 3]));
    assert_eq!(Box3::EMPTY.diagonal(), 0.0);
    assert!(Box3::from_points(&[]).is_empty());
}

#[test]
fn the_diagonal_of_a_box_too_large_to_measure_is_infinite() {
    let huge = Box3 { min: [-1e308; 3], max: [1e308; 3] };
    assert_eq!(huge.diagonal(), f64::INFINITY);
    let large = Box3 { min: [0.0; 3], max: [1e200, 1e200, 1e200] };
    assert!(large.diagonal() > 1.7320508e200 && large.diagonal() < 1.7320509e200);
}
