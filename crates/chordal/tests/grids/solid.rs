//! Whether triangles are a closed, oriented manifold, by counting alone.

/// What is wrong with the topology, if anything. `border` says whether an edge with one face may be there.
pub fn flaw(n: usize, faces: &[[u32; 3]], border: impl Fn(u32, u32) -> bool) -> Option<String> {
    let mut half: Vec<(u32, u32)> = Vec::with_capacity(3 * faces.len());
    for f in faces {
        if f[0] == f[1] || f[1] == f[2] || f[2] == f[0] {
            return Some(format!("face {f:?} has a corner twice"));
        }
        half.extend([(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]);
    }
    half.sort_unstable();
    if let Some(w) = half.windows(2).find(|w| w[0] == w[1]) {
        return Some(format!("edge {:?} is used twice in one direction", w[0]));
    }
    for (a, b) in &half {
        if half.binary_search(&(*b, *a)).is_err() && !border(*a, *b) {
            return Some(format!("edge {a} {b} is open"));
        }
    }
    // Around each vertex the faces make one chain: as many steps from face to face as there are faces.
    let mut corners: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * faces.len());
    for f in faces {
        corners.extend([(f[0], f[1], f[2]), (f[1], f[2], f[0]), (f[2], f[0], f[1])]);
    }
    corners.sort_unstable();
    let mut at = 0;
    let mut used = 0;
    while at < corners.len() {
        let v = corners[at].0;
        let fan: Vec<(u32, u32)> =
            corners[at..].iter().take_while(|c| c.0 == v).map(|c| (c.1, c.2)).collect();
        at += fan.len();
        used += 1;
        let start = fan.iter().find(|(from, _)| !fan.iter().any(|(_, to)| to == from)).unwrap_or(&fan[0]);
        let (mut end, mut steps) = (start.1, 1);
        while let Some(next) = fan.iter().find(|(from, _)| *from == end) {
            if next == start {
                break;
            }
            end = next.1;
            steps += 1;
        }
        if steps != fan.len() {
            return Some(format!("vertex {v} has more than one fan"));
        }
    }
    (used != n).then(|| format!("{} of {n} vertices have no face", n - used))
}

/// The first face whose exact area may be zero, or whose corners are not apart.
pub fn flat(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Option<usize> {
    faces.iter().position(|f| {
        let [a, b, c] = f.map(|i| positions[i as usize]);
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let long = |w: [f64; 3]| (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
        // Far above what the differences lose to rounding on the small lattices of these tests.
        long(n) <= 1e-9 * long(u) * long(v)
    })
}

/// Six times the volume.
pub fn volume6(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> f64 {
    faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|i| positions[i as usize]);
            let n = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
        })
        .sum()
}

#[test]
fn finds_what_it_has_to_refuse() {
    let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    assert_eq!(flaw(4, &tetrahedron, |_, _| false), None);
    assert!(flaw(4, &tetrahedron[..3], |_, _| false).is_some_and(|text| text.contains("open")));
    assert_eq!(flaw(4, &tetrahedron[..3], |_, _| true), None);
    assert!(flaw(5, &tetrahedron, |_, _| false).is_some());
    let mut turned = tetrahedron;
    turned[0].swap(0, 1);
    assert!(flaw(4, &turned, |_, _| false).is_some());
    let pair: Vec<[u32; 3]> = tetrahedron
        .iter()
        .copied()
        .chain(tetrahedron.map(|f| f.map(|i| if i == 0 { 0 } else { i + 3 })))
        .collect();
    assert!(flaw(7, &pair, |_, _| false).is_some_and(|text| text.contains("fan")));
    assert_eq!(flat(&[[0.0; 3], [1.0; 3], [2.0; 3]], &[[0, 1, 2]]), Some(0));
}
