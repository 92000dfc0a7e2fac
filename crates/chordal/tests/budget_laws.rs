//! Laws of the nouns of `budget`: a chain of bounds holds for real point sets and claims no more than the
//! triangle inequality leaves; what is shown reads back; what is no budget is refused.
use crate::exact;
use chordal::budget::camera::{Camera, MinDistanceView, Projection, Screen};
use chordal::budget::{Bound, Evidence, Length, Metric, Pixels, Reference, Tolerance, Unit, View};
use chordal::math::{add_up, sqrt_down, sqrt_up, sub_down};
use exact::{at_least, at_most, cases, exact};
use proptest::prelude::*;

type Points = Vec<[i32; 2]>;

/// Three or four clouds of equally many lattice points: their squared distances are exact.
fn clouds() -> impl Strategy<Value = [Points; 4]> {
    (1..6_usize, 1..40_i32).prop_flat_map(|(n, reach)| {
        prop::array::uniform4(prop::collection::vec([-reach..=reach, -reach..=reach], n))
    })
}

fn distance_sq(a: [i32; 2], b: [i32; 2]) -> i32 {
    (a[0] - b[0]).pow(2) + (a[1] - b[1]).pow(2)
}

fn one_sided_sq(from: &Points, to: &Points) -> i32 {
    let nearest = |a: &[i32; 2]| to.iter().map(|b| distance_sq(*a, *b)).min().unwrap();
    from.iter().map(nearest).max().unwrap()
}

/// The square of the true distance, in `metric`.
fn true_sq(metric: Metric, a: &Points, b: &Points) -> i32 {
    match metric {
        Metric::OneSided => one_sided_sq(a, b),
        Metric::Solid => unreachable!("points have no sides"),
        Metric::Hausdorff => one_sided_sq(a, b).max(one_sided_sq(b, a)),
        Metric::Parametric => a.iter().zip(b).map(|(a, b)| distance_sq(*a, *b)).max().unwrap(),
    }
}

/// How a step's bound is widened from the truth: shares of 1 below and above, and its metric.
type Slack = (f64, f64, Metric);

fn slack() -> impl Strategy<Value = Slack> {
    let share = || prop_oneof![2 => Just(0.0), 1 => 0.0..1.0];
    let metric = prop::sample::select(vec![Metric::Hausdorff, Metric::Parametric, Metric::OneSided]);
    (share(), share(), metric)
}

/// A true bound on the step from `a` to `b`.
fn step(a: &Points, b: &Points, (below, above, metric): Slack) -> Bound {
    let square = f64::from(true_sq(metric, a, b));
    let (low, high) = (sqrt_down(square) * (1.0 - below), sqrt_up(square) * (1.0 + above));
    let mut bound = Bound::proved(low, high, Reference::InputTriangles);
    bound.metric = metric;
    bound
}

fn holds(bound: &Bound, a: &Points, b: &Points) -> bool {
    let square = exact(f64::from(true_sq(bound.metric, a, b)));
    let square_of = |x: f64| exact(x) * exact(x);
    square_of(bound.at_least()) <= square && bound.at_most().is_none_or(|most| square <= square_of(most))
}

fn evidence() -> impl Strategy<Value = Evidence> {
    let sentence =
        prop::sample::select(vec!["L is 1".to_owned(), "closed".to_owned(), "unit is mm".to_owned()]);
    prop_oneof![
        Just(Evidence::Proved),
        prop::collection::btree_set(sentence, 1..4)
            .prop_map(|set| Evidence::ProvedIf(set.into_iter().collect())),
        (1..9_u64).prop_map(|samples| Evidence::Measured { samples }),
        Just(Evidence::Estimated),
    ]
}

fn bound_with(evidence: Evidence, low: f64, high: f64) -> Bound {
    let most = evidence.bounds_above().then_some(high);
    Bound::with_evidence(low, most, evidence, Reference::BezierPatches)
}

fn close(a: f64, b: f64) -> bool {
    // Three roundings up or down in each of two orders.
    (a - b).abs() <= 8.0 * f64::EPSILON * a.abs().max(b.abs())
}

proptest! {
    #![proptest_config(cases(6000))]

    #[test]
    fn a_chain_of_true_bounds_is_a_true_bound(
        [a, b, c, d] in clouds(), first in slack(), second in slack(), third in slack(),
    ) {
        let (ab, bc, cd) = (step(&a, &b, first), step(&b, &c, second), step(&c, &d, third));
        prop_assert!(holds(&ab, &a, &b) && holds(&bc, &b, &c) && holds(&cd, &c, &d));
        prop_assert!(holds(&ab.then(&bc), &a, &c), "{} then {} is {}", ab, bc, ab.then(&bc));
        prop_assert!(holds(&ab.then(&bc).then(&cd), &a, &d));
        prop_assert!(holds(&ab.then(&bc.then(&cd)), &a, &d));
    }

    #[test]
    fn within_one_metric_nothing_is_given_away_and_the_order_of_joining_does_not_matter(
        [a, b, c, d] in clouds(), first in slack(), second in slack(), third in slack(),
        metric in prop::sample::select(vec![Metric::Hausdorff, Metric::Parametric]),
    ) {
        let like = |(below, above, _): Slack| (below, above, metric);
        let (ab, bc, cd) =
            (step(&a, &b, like(first)), step(&b, &c, like(second)), step(&c, &d, like(third)));
        let ac = ab.then(&bc);
        let (ab_most, bc_most) = (ab.at_most().unwrap(), bc.at_most().unwrap());
        prop_assert_eq!(ac.at_most(), Some(add_up(ab_most, bc_most)));
        let left = sub_down(ab.at_least(), bc_most).max(sub_down(bc.at_least(), ab_most)).max(0.0);
        prop_assert_eq!(ac.at_least(), left);
        let (one, other) = (ac.then(&cd), ab.then(&bc.then(&cd)));
        prop_assert!(close(one.at_most().unwrap(), other.at_most().unwrap()), "{one} {other}");
        let far = one.at_most().unwrap();
        prop_assert!((one.at_least() - other.at_least()).abs() <= 8.0 * f64::EPSILON * far, "{one} {other}");
        prop_assert_eq!(one.metric, metric);
    }

    #[test]
    fn the_weaker_evidence_wins(x in evidence(), y in evidence(), z in evidence(), low in 0.0..1.0, high in 1.0..2.0) {
        let rank = |evidence: &Evidence| match evidence {
            Evidence::Proved => 0,
            Evidence::ProvedIf(_) => 1,
            Evidence::Measured { .. } => 2,
            Evidence::Estimated => 3,
        };
        let both = x.weaker(&y);
        prop_assert_eq!(rank(&both), rank(&x).max(rank(&y)));
        prop_assert_eq!(both.weaker(&z), x.weaker(&y.weaker(&z)));
        prop_assert_eq!(rank(&y.weaker(&x)), rank(&both));
        prop_assert_eq!(x.weaker(&x), x.clone());
        let chain = bound_with(x.clone(), low, high).then(&bound_with(y.clone(), low / 8.0, high / 8.0));
        prop_assert_eq!(chain.evidence(), &both);
        prop_assert_eq!(chain.at_most().is_some(), chain.evidence().bounds_above());
        prop_assert!(chain.at_least() <= low && chain.at_most().is_none_or(|most| most >= chain.at_least()));
        if let (Evidence::ProvedIf(all), Evidence::ProvedIf(a), Evidence::ProvedIf(b)) = (&both, &x, &y) {
            prop_assert!(a.iter().chain(b).all(|sentence| all.contains(sentence)));
            prop_assert!(all.iter().all(|sentence| a.contains(sentence) || b.contains(sentence)));
        }
        if let (Evidence::Measured { samples: all }, Evidence::Measured { samples: a }, Evidence::Measured { samples: b }) = (&both, &x, &y) {
            prop_assert_eq!(all, a.min(b));
        }
    }

    #[test]
    fn a_tolerance_reads_back(x in positive()) {
        let tolerance = Tolerance::new(x).unwrap();
        prop_assert_eq!(tolerance.to_string().parse::<Tolerance>().unwrap(), tolerance);
        prop_assert_eq!(format!("  {x:e} ").parse::<Tolerance>().unwrap().get(), x);
        let negative = format!("-{x}");
        prop_assert!(Tolerance::new(-x).is_err() && negative.parse::<Tolerance>().is_err());
    }

    #[test]
    fn a_length_reads_back(x in positive(), unit in unit()) {
        for length in [Length::Plain(x), Length::In(x, unit), Length::Percent(x)] {
            prop_assert_eq!(length.to_string().parse::<Length>().unwrap(), length);
        }
        prop_assert_eq!(format!("{x:e} {unit}").parse::<Length>().unwrap(), Length::In(x, unit));
        prop_assert_eq!(format!("{x:E}%").parse::<Length>().unwrap(), Length::Percent(x));
        let negative = format!("-{x}{unit}");
        prop_assert!(negative.parse::<Length>().is_err());
    }

    #[test]
    fn a_length_resolves_to_a_rounding_of_its_meaning(x in 1e-9..1e9, diagonal in 1e-9..1e9, unit in unit()) {
        let near = |found: f64, over: f64, under: f64| {
            let off = exact(found) * exact(under) - exact(over);
            let rounding = exact(2.0 * f64::EPSILON) * exact(found) * exact(under);
            off <= rounding && -off <= rounding
        };
        let share = Length::Percent(x).resolve(diagonal, None).unwrap().get();
        prop_assert!(near(share, x * diagonal, 100.0), "{x}% of {diagonal} is {share}");
        let inches = Length::In(x, unit).resolve(diagonal, Some(0.0254)).unwrap().get();
        prop_assert!(near(inches, x * unit.metres(), 0.0254), "{x}{unit} is {inches}in");
        prop_assert_eq!(Length::Plain(x).resolve(diagonal, None).unwrap().get(), x);
    }

    #[test]
    fn pixels_read_back(x in positive()) {
        let pixels = Pixels::new(x).unwrap();
        prop_assert_eq!(pixels.to_string().parse::<Pixels>().unwrap(), pixels);
        prop_assert_eq!(format!(" {x} ").parse::<Pixels>().unwrap(), pixels);
        let twice = format!("{x}pxpx");
        prop_assert!(twice.parse::<Pixels>().is_err());
    }

    #[test]
    fn a_view_reads_back(view in view()) {
        let Ok(view) = view.checked() else { return Ok(()) };
        prop_assert_eq!(view.to_string().parse::<View>().unwrap(), view);
    }
}

fn positive() -> impl Strategy<Value = f64> {
    exact::number().prop_map(f64::abs).prop_filter("positive", |x| *x > 0.0)
}

fn unit() -> impl Strategy<Value = Unit> {
    prop::sample::select(UNITS.map(|row| row.0).to_vec())
}

const UNITS: [(Unit, &str, f64); 7] = [
    (Unit::Micrometre, "um", 1e-6),
    (Unit::Millimetre, "mm", 1e-3),
    (Unit::Centimetre, "cm", 1e-2),
    (Unit::Metre, "m", 1.0),
    (Unit::Kilometre, "km", 1e3),
    (Unit::Inch, "in", 0.0254),
    (Unit::Foot, "ft", 0.3048),
];

fn view() -> impl Strategy<Value = View> {
    let projection = prop_oneof![
        (0.0..180.0).prop_map(|fov_y_deg| Projection::Perspective { fov_y_deg }),
        positive().prop_map(|height| Projection::Orthographic { height }),
    ];
    let screen = (1..=u32::MAX, 1..5000_u32).prop_map(|(width_px, height_px)| Screen { width_px, height_px });
    let point = || [exact::number(), exact::number(), exact::number()];
    let pose = prop_oneof![
        positive().prop_map(Err),
        (point(), point(), point(), prop_oneof![Just(0.0), positive()]).prop_map(Ok),
    ];
    (projection, screen, pose).prop_map(|(projection, screen, pose)| match pose {
        Ok((eye, target, up, near)) => View::Camera(Camera { eye, target, up, near, projection, screen }),
        Err(distance) => View::MinDistance(MinDistanceView { distance, projection, screen }),
    })
}

#[test]
fn most_random_views_are_views() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let good = (0..400).filter(|_| {
        let tree = view().new_tree(&mut runner).expect("a view");
        proptest::strategy::ValueTree::current(&tree).checked().is_ok()
    });
    let good = good.count();
    assert!(good > 200, "{good}");
}

#[test]
fn each_unit_is_its_own_row() {
    for (unit, name, metres) in UNITS {
        assert_eq!((unit.to_string().as_str(), unit.metres()), (name, metres));
        assert_eq!(name.parse::<Unit>().unwrap(), unit);
    }
    for name in ["", "MM", "parsec", " mm", "e", "px"] {
        assert!(name.parse::<Unit>().is_err(), "{name}");
    }
}

#[test]
fn refuses_what_is_no_tolerance() {
    for text in
        ["", "0", "-0", "-1", "nan", "inf", "infinity", "1e400", "1e-400", "0x1", "1,5", "1 2", "0.1mm"]
    {
        let message = text.parse::<Tolerance>().unwrap_err().to_string();
        assert!(message.contains(&format!("'{text}'")), "{message}");
    }
    for x in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Tolerance::new(x).is_err() && Pixels::new(x).is_err(), "{x}");
    }
}

#[test]
fn refuses_what_is_no_pixel_budget() {
    for text in ["", "px", "0px", "-1px", "nanpx", "inf", "1 p x", "1pxpx", "px1", "1mm", "1%"] {
        assert!(text.parse::<Pixels>().is_err(), "{text}");
    }
    assert_eq!("1 px".parse::<Pixels>().unwrap().get(), 1.0);
}

#[test]
fn refuses_what_is_no_view() {
    let good = "100x100 fov=45 dist=4";
    assert!(good.parse::<View>().is_ok());
    for (text, part) in [
        ("", "reads like"),
        ("100 fov=45 dist=4", "1920x1080"),
        ("0x100 fov=45 dist=4", "1x1"),
        ("100x-1 fov=45 dist=4", "1920x1080"),
        ("5000000000x1 fov=45 dist=4", "1920x1080"),
        ("100x100 fov=0 dist=4", "between 0 and 180"),
        ("100x100 fov=180 dist=4", "between 0 and 180"),
        ("100x100 fov=nan dist=4", "between 0 and 180"),
        ("100x100 fov=45deg dist=4", "not a number"),
        ("100x100 fov=45 height=2 dist=4", "either fov"),
        ("100x100 dist=4", "either fov"),
        ("100x100 height=0", "height"),
        ("100x100 height=inf", "height"),
        ("100x100 fov=45", "dist"),
        ("100x100 fov=45 dist=0", "dist"),
        ("100x100 fov=45 dist=-1", "dist"),
        ("100x100 fov=45 dist=nan", "dist"),
        ("100x100 fov=45 dist=4 dist=4", "twice"),
        ("100x100 fov=45 dist=4 zoom=2", "zoom"),
        ("100x100 fov=45 dist", "NAME=VALUE"),
        ("100x100 fov=45 dist=4 near=1", "belong together"),
        ("100x100 fov=45 eye=0,0,0", "belong together"),
        ("100x100 fov=45 eye=0,0,0 target=1,0", "target"),
        ("100x100 fov=45 eye=0,0,0 target=1,0,0,0", "target"),
        ("100x100 fov=45 eye=0,0,0 target=1,nan,0", "target"),
        ("100x100 fov=45 eye=0,0,0 target=0,0,0", "apart"),
        ("100x100 fov=45 eye=0,0,0 target=1,0,0 up=2,0,0", "line"),
        ("100x100 fov=45 eye=0,0,0 target=1,0,0 up=0,0,0", "line"),
        ("100x100 fov=45 eye=0,0,0 target=1,0,0 near=-1", "near"),
        ("100x100 fov=45 eye=0,0,0 target=1,0,0 dist=2", "belong together"),
    ] {
        let message = text.parse::<View>().expect_err(text).to_string();
        assert!(message.contains(part), "'{text}': {message}");
    }
}

#[test]
fn a_sum_that_overflows_bounds_nothing() {
    let huge = Bound::proved(0.0, f64::MAX, Reference::BezierPatches);
    let chain = huge.then(&huge);
    assert_eq!((chain.at_most(), chain.evidence()), (None, &Evidence::Estimated));
}

#[test]
fn the_place_of_a_chain_is_that_of_its_larger_step() {
    let mut far = Bound::proved(0.0, 2.0, Reference::BezierPatches);
    let mut near = Bound::proved(0.0, 1.0, Reference::InputTriangles);
    (far.at, near.at) = (Some([1.0; 3]), Some([2.0; 3]));
    assert_eq!((far.then(&near).at, near.then(&far).at), (far.at, far.at));
    assert_eq!(far.then(&near).reference, Reference::BezierPatches);
    far.at = None;
    assert_eq!(far.then(&near).at, near.at);
}

#[test]
fn lower_ends_do_not_cross_metrics_that_forbid_it() {
    let of = |metric, low: f64, high: f64| {
        let mut bound = Bound::proved(low, high, Reference::BezierPatches);
        bound.metric = metric;
        bound
    };
    // B has a second point far from A's; the way back from B to A is long, the way there is short, and C is
    // B.
    let one_sided = of(Metric::OneSided, 1.0, 1.0).then(&of(Metric::OneSided, 0.0, 0.1));
    assert_eq!((one_sided.at_least(), one_sided.metric), (0.0, Metric::OneSided));
    // Equal parameters may be far apart on shapes that are one.
    let slid = of(Metric::Parametric, 1.0, 1.0).then(&of(Metric::Hausdorff, 0.0, 0.1));
    assert_eq!((slid.at_least(), slid.metric), (0.0, Metric::Hausdorff));
    let kept = of(Metric::OneSided, 1.0, 1.0).then(&of(Metric::Hausdorff, 0.0, 0.25));
    assert!(at_least(&exact(0.75), kept.at_least()) && kept.at_least() > 0.7499);
    assert!(at_most(&exact(1.25), kept.at_most().unwrap()));
}
