//! A rasterizer that shares no code with the library: pixel by pixel, in whole numbers of its own.
use chordal::Mesh;
use chordal::budget::camera::{Camera, Projection};

/// What the naive rasterizer finds.
#[derive(Debug, PartialEq)]
pub struct Naive {
    pub in_view: u64,
    pub missed: u64,
    pub micro: u64,
    pub covered_px: u64,
    pub every: [u64; 2],
    pub visible: [u64; 2],
    pub launches: Vec<u32>,
}

/// Pixel by pixel and triangle by triangle. The top-left rule is what a centre decides that is moved right by
/// nearly nothing and down by nearly nothing of that; here coordinates are magnified so that both are whole
/// numbers. For cameras of the tests' kind, with all triangles before the near plane.
pub fn naive(mesh: &Mesh, camera: &Camera) -> Naive {
    const K: i128 = 1 << 40;
    const MOVED: [i128; 2] = [1 << 24, 1];
    let [w, h] = [camera.screen.width_px, camera.screen.height_px].map(|n| n as usize);
    let project = |p: [f64; 3]| {
        let depth = camera.eye[2] - p[2];
        let (per_unit, nearness) = match camera.projection {
            Projection::Orthographic { height } => (h as f64 / height, -depth),
            Projection::Perspective { fov_y_deg } => {
                (h as f64 / 2.0 / libm::tan(fov_y_deg.to_radians() / 2.0) / depth, 1.0 / depth)
            }
        };
        let steps = |pixels: f64| (256.0 * pixels).round() as i128;
        let at = [w as f64 / 2.0 + per_unit * p[0], h as f64 / 2.0 - per_unit * p[1]];
        (at.map(steps), nearness)
    };
    let mut found = Naive {
        in_view: 0,
        missed: 0,
        micro: 0,
        covered_px: 0,
        every: [0; 2],
        visible: [0; 2],
        launches: vec![0; w.div_ceil(2) * h.div_ceil(2)],
    };
    let mut nearest = vec![(f64::NEG_INFINITY, usize::MAX); w * h];
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face).map(project);
        let at = corners.map(|corner| corner.0.map(|x| x * K));
        let cross = |a: [i128; 2], b: [i128; 2], c: [i128; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let area = cross(at[0], at[1], at[2]);
        let covers = |x: usize, y: usize| {
            let p = [0, 1].map(|axis| ([x, y][axis] as i128 * 256 + 128) * K + MOVED[axis]);
            let signs = [0, 1, 2].map(|k| cross(at[k], at[(k + 1) % 3], p).signum());
            area != 0 && signs.iter().all(|sign| *sign == area.signum())
        };
        let pixels: Vec<[usize; 2]> =
            (0..h).flat_map(|y| (0..w).map(move |x| [x, y])).filter(|[x, y]| covers(*x, *y)).collect();
        let mut quads: Vec<usize> = pixels.iter().map(|[x, y]| x / 2 + w.div_ceil(2) * (y / 2)).collect();
        quads.sort_unstable();
        quads.dedup();
        quads.iter().for_each(|quad| found.launches[*quad] += 1);
        found.every[0] += pixels.len() as u64;
        found.every[1] += quads.len() as u64;
        // Two convex shapes meet unless one of their sides has the other beyond it.
        let screen = [[0, 0], [w, 0], [w, h], [0, h]].map(|c| c.map(|x| x as i128 * 256 * K));
        let apart = |a: &[[i128; 2]], b: &[[i128; 2]], sign: i128| {
            (0..a.len()).any(|k| b.iter().all(|p| cross(a[k], a[(k + 1) % a.len()], *p) * sign < 0))
        };
        let in_view = !apart(&screen, &at, 1) && (area == 0 || !apart(&at, &screen, area.signum()));
        found.in_view += u64::from(in_view);
        found.missed += u64::from(in_view && pixels.is_empty());
        found.micro += u64::from(in_view && area.abs() < 2 * (256 * K) * (256 * K));
        // The plane through three points (column, row, nearness), by Cramer's rule.
        let [(a, na), (b, nb), (c, nc)] = corners;
        let f = |p: [i128; 2]| p.map(|x| x as f64 / 256.0);
        let ([ax, ay], [bx, by], [cx, cy]) = (f(a), f(b), f(c));
        let det = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        let slope_x = ((nb - na) * (cy - ay) - (nc - na) * (by - ay)) / det;
        let slope_y = ((bx - ax) * (nc - na) - (cx - ax) * (nb - na)) / det;
        for [x, y] in pixels {
            let nearness = na + slope_x * (x as f64 + 0.5 - ax) + slope_y * (y as f64 + 0.5 - ay);
            let here = &mut nearest[x + w * y];
            if nearness > here.0 {
                *here = (nearness, face);
            }
        }
    }
    let mut shaded: Vec<(usize, usize)> = Vec::new();
    for y in 0..h {
        for x in 0..w {
            let face = nearest[x + w * y].1;
            if face != usize::MAX {
                found.covered_px += 1;
                shaded.push((x / 2 + w * (y / 2), face));
            }
        }
    }
    shaded.sort_unstable();
    shaded.dedup();
    found.visible = [found.covered_px, shaded.len() as u64];
    found
}
