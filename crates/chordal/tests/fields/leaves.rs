//! Leaves are asked breadth-first: once for a whole batch, at what was computed for them.
use chordal::Evidence;
use chordal::implicit::evaluation::{Dual, Tape};
use chordal::implicit::leaves::{Leaf, LeafError};
use chordal::implicit::{Expr, Lipschitz};
use chordal::math::{Box3, Interval};
use std::sync::{Arc, Mutex};

/// x + 2y + 3z, counting how often and for how many points it is asked.
#[derive(Debug, Default)]
struct Plane {
    calls: Mutex<Vec<usize>>,
    fails: bool,
}

impl Leaf for Plane {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        self.calls.lock().expect("no panic").push(points.len());
        if self.fails {
            return Err(LeafError::new("the plane is closed on Sundays"));
        }
        for (value, p) in out.iter_mut().zip(points) {
            *value = p[0] + 2.0 * p[1] + 3.0 * p[2];
        }
        Ok(())
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        Some(Lipschitz { constant: 4.0, error: 0.0 })
    }

    fn evidence(&self) -> Evidence {
        Evidence::Measured { samples: 1 }
    }
}

/// A leaf at a moved point, and another one at what that says.
fn nested() -> (Tape, [Arc<Plane>; 2]) {
    let [x, y, z] = Expr::axes();
    let planes = [Arc::new(Plane::default()), Arc::new(Plane::default())];
    let inner = Expr::leaf(planes[0].clone(), [&x - 1.0, y.clone(), z.square()]);
    let outer = Expr::leaf(planes[1].clone(), [inner.clone(), x.sin(), inner.abs()]);
    (Tape::new(&(outer + inner * y)), planes)
}

#[test]
fn a_leaf_is_asked_once_for_all_points() {
    let (tape, planes) = nested();
    let points: Vec<[f64; 3]> =
        (0..5000).map(|k| [f64::from(k) * 0.01, 1.0 - f64::from(k) * 0.02, 0.5]).collect();
    let mut values = vec![0.0; points.len()];
    tape.at(&points, &mut values).unwrap();
    for plane in &planes {
        assert_eq!(*plane.calls.lock().unwrap(), [5000]);
    }
    for (p, value) in points.iter().zip(&values) {
        let plane = |p: [f64; 3]| p[0] + 2.0 * p[1] + 3.0 * p[2];
        let inner = plane([p[0] - 1.0, p[1], p[2] * p[2]]);
        let expected = plane([inner, p[0].sin(), inner.abs()]) + inner * p[1];
        assert!((value - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{value} {expected}");
    }
}

#[test]
fn gradients_without_the_leaf_s_help_come_from_differences() {
    let (tape, _) = nested();
    let mut slopes = [Dual { value: 0.0, gradient: [0.0; 3] }];
    tape.gradient_at(&[[3.0, 2.0, 1.0]], &mut slopes).unwrap();
    // inner = x − 1 + 2y + 3z² = 9; outer = inner + 2 sin x + 3 |inner|; the value is outer + inner y.
    let expected = [4.0 + 2.0 * 3.0_f64.cos() + 2.0, 8.0 + 9.0 + 4.0, 24.0 + 12.0];
    assert!((slopes[0].value - (36.0 + 2.0 * 3.0_f64.sin() + 18.0)).abs() < 1e-12);
    for (found, truth) in slopes[0].gradient.iter().zip(expected) {
        assert!((found - truth).abs() < 1e-8, "{slopes:?} {expected:?}");
    }
}

#[test]
fn ranges_hold_what_the_leaf_has_and_keep_its_evidence() {
    let (tape, _) = nested();
    assert!(matches!(tape.evidence(), Evidence::Measured { .. }));
    let bounds = Box3 { min: [0.5, 0.25, -1.0], max: [0.75, 0.5, -0.75] };
    let mut range = [Interval::EMPTY];
    tape.over(&[bounds], &mut range).unwrap();
    let mut value = [0.0];
    for t in 0..=20 {
        let p = [0, 1, 2].map(|k| bounds.min[k] + (bounds.max[k] - bounds.min[k]) * f64::from(t) / 20.0);
        tape.at(&[p], &mut value).unwrap();
        assert!(range[0].contains(value[0]) && range[0].is_defined(), "{} {}", range[0], value[0]);
    }
    let (again, _) = tape.prune(&bounds).unwrap();
    assert_eq!(again, range[0]);
}

#[test]
fn what_a_leaf_complains_of_comes_through() {
    let [x, y, z] = Expr::axes();
    let leaf = Expr::leaf(Arc::new(Plane { fails: true, ..Plane::default() }), [x, y, z]);
    let error = Tape::new(&(leaf + 1.0)).at(&[[0.0; 3]], &mut [0.0]).unwrap_err();
    assert_eq!(error.to_string(), "the plane is closed on Sundays");
}
