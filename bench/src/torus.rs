//! The torus with bumps that meshes are measured on.
use chordal::Mesh;

/// A torus of n × m quads with bumps, turned by a share of a cell.
pub fn torus([n, m]: [u32; 2], turn: f64, bump: f64) -> Mesh {
    let tau = std::f64::consts::TAU;
    let at = |i: u32, j: u32| -> [f64; 3] {
        let (u, v) = (tau * (f64::from(i) / f64::from(n) + turn), tau * (f64::from(j) / f64::from(m) + turn));
        let r = 0.3 * (1.0 + bump * (9.0 * u).sin() * (7.0 * v).cos());
        [(1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin()]
    };
    let id = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let faces = cells().flat_map(|(i, j)| {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(cells().map(|(i, j)| at(i, j)).collect(), faces.collect()).expect("valid")
}
