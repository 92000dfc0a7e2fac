//! Any polygon on a lattice: always n - 2 triangles, whose areas add up exactly when nothing is folded.
#![no_main]
use chordal::explicit::triangulate::polygon;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let points: Vec<[f64; 3]> =
        bytes.chunks_exact(2).map(|p| [f64::from(p[0]), f64::from(p[1]), 0.0]).collect();
    let cut = polygon(&points);
    assert_eq!(cut.triangles.len(), points.len().saturating_sub(2));
    let twice = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    // Small integers, so that both sums are exact.
    let sum: f64 = cut.triangles.iter().map(twice).sum();
    let covered: f64 = cut.triangles.iter().map(|t| twice(t).abs()).sum();
    assert_eq!(cut.is_exact(), sum.abs() == covered);
});
