//! Twice the segments, a quarter of the error.
use super::families::regular;
use super::measure::{Look, measure};
use super::truth::Path;
use super::{cases, flatten, for_all, quantile};
use chordal::Budget;
use chordal::convert::Spacing;

/// The measured and the proved error of `n` equal steps.
fn errors(path: &Path<2>, n: u64) -> [f64; 2] {
    let made = flatten(path, &Budget::segments(n), Spacing::Even).expect("n steps");
    assert_eq!(made.shape.n_segments() as u64, n);
    [measure(path, &made.shape, Look::Quick).both(), made.bound.at_most().expect("proved")]
}

#[test]
fn twice_the_equal_steps_lose_a_quarter() {
    let ratios = for_all(cases(100), |seed| {
        let path = Path::cubic(regular(seed));
        [64, 128, 256, 512].map(|n| {
            let (once, twice) = (errors(&path, n), errors(&path, 2 * n));
            let ratios = [0, 1].map(|i| once[i] / twice[i]);
            for ratio in ratios {
                assert!((3.8..=4.2).contains(&ratio), "seed {seed}: {ratio} from {n} to {}: {path:?}", 2 * n);
            }
            ratios[0]
        })
    });
    let mut ratios: Vec<f64> = ratios.into_iter().flatten().collect();
    let [least, median, most] = [0.0, 0.5, 1.0].map(|q| quantile(&mut ratios, q));
    eprintln!("error(N)/error(2N) of {} pairs: {least:.4} to {most:.4}, median {median:.4}", ratios.len());
}
