//! Hill climbing from a sample to a local maximum, with steps that are halved (pattern search).

/// Climbs in the unit square from `start`, whose value is `value`; `step` is the first step, which is halved
/// after each of `halvings` rounds. Returns the largest value of `of` and its place.
pub fn climb(
    start: [f64; 2],
    value: f64,
    (step, halvings): (f64, u32),
    mut of: impl FnMut([f64; 2]) -> f64,
) -> (f64, [f64; 2]) {
    const AROUND: [[f64; 2]; 8] = [
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [-1.0, -1.0],
        [1.0, -1.0],
    ];
    let (mut best, mut at, mut step) = (value, start, step);
    for _ in 0..halvings {
        let centre = at;
        for direction in AROUND {
            let next = [0, 1].map(|k: usize| (centre[k] + step * direction[k]).clamp(0.0, 1.0));
            let value = of(next);
            if value > best {
                (best, at) = (value, next);
            }
        }
        step *= 0.5;
    }
    (best, at)
}
