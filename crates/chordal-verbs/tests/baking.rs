//! Baking the corpus: no wrong sign on closed meshes by a vote of rays, and distances as a plain loop finds
//! them.
use crate::common;

use chordal::convert::{mesh_to_field, mesh_to_grid};
use chordal::{Job, Mesh};
use chordal_io::Format;
use chordal_testkit::is_long;
use chordal_verbs::{BakeResolution, BakeSpec, FormatHint, Shape, bake, load};

/// Whether the ray from `p` along `d` leaves more often than it enters; `None` where it comes too close to an
/// edge to tell.
fn is_surrounded(p: [f64; 3], d: [f64; 3], mesh: &Mesh) -> Option<bool> {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let mut count = 0;
    for face in 0..mesh.faces().len() {
        let [a, b, c] = mesh.corners(face).map(|q| sub(q, p));
        let volumes = [dot(d, cross(a, b)), dot(d, cross(b, c)), dot(d, cross(c, a))];
        let size = volumes.iter().map(|v| v.abs()).sum::<f64>();
        // Rounding of a product of three is below 1e-14 of its largest terms, which are about this size.
        let far = [a, b, c].iter().map(|q| dot(*q, *q)).fold(0.0, f64::max);
        if volumes.iter().any(|v| v.abs() <= 1e-11 * far) {
            // Not near at all, if the other two disagree for sure.
            let sure: Vec<f64> = volumes.into_iter().filter(|v| v.abs() > 1e-11 * far).collect();
            if sure.iter().any(|v| *v > 0.0) && sure.iter().any(|v| *v < 0.0) {
                continue;
            }
            return None;
        }
        let same = volumes.iter().all(|v| *v > 0.0) || volumes.iter().all(|v| *v < 0.0);
        if !same || size == 0.0 {
            continue;
        }
        let n = cross(sub(b, a), sub(c, a));
        let ahead = dot(a, n) / dot(d, n);
        if ahead > 0.0 {
            count += if dot(d, n) > 0.0 { 1 } else { -1 };
        }
    }
    Some(count > 0)
}

#[test]
fn no_sign_of_a_closed_mesh_is_wrong() {
    let directions = [[0.31, 0.57, 0.76], [-0.83, 0.21, 0.52], [0.11, -0.94, -0.33]];
    let job = Job::default();
    let (mut meshes, mut votes) = (0, 0);
    // Points are judged against all triangles.
    let files = common::files(if is_long() { 400_000 } else { 100_000 });
    for path in &files {
        let bytes = std::fs::read(path).unwrap();
        let name = path.to_string_lossy();
        let Ok(input) =
            load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default())
        else {
            continue;
        };
        let Shape::Scene(scene) = &input.shape else { continue };
        for part in scene.parts.iter().filter(|part| !part.mesh.faces().is_empty()) {
            let Ok(baked) = mesh_to_grid(&part.mesh, 14, None, &job) else { continue };
            if !baked.solid.closed || part.mesh.faces().len() > 30_000 {
                assert!(baked.solid.is_solid() || baked.solid.to_string().contains("not a solid"), "{name}");
                continue;
            }
            meshes += 1;
            let size = baked.grid.size();
            let step = if part.mesh.faces().len() > 3000 { 23 } else { 5 };
            for row in (0..baked.grid.samples().len()).step_by(step) {
                let index = [row % size[0], row / size[0] % size[1], row / size[0] / size[1]];
                let p = baked.grid.affine().at(index.map(|i| i as f64));
                let value = baked.grid.samples().get(row);
                // A sample on the surface has no side.
                if value.abs() < 1e-9 * part.mesh.bounds().diagonal() {
                    continue;
                }
                let ballot: Vec<bool> =
                    directions.iter().filter_map(|d| is_surrounded(p, *d, &part.mesh)).collect();
                let ayes = ballot.iter().filter(|inside| **inside).count();
                if ballot.is_empty() || 2 * ayes == ballot.len() {
                    continue;
                }
                votes += 1;
                assert_eq!(value < 0.0, 2 * ayes > ballot.len(), "{name}: {value} at {p:?}, {ballot:?}");
            }
        }
    }
    eprintln!("{meshes} closed meshes, {votes} votes");
    assert!(meshes > 10 || files.is_empty());
}

/// The whole of a scan with holes: said, and not refused.
#[test]
fn a_scan_with_holes_is_no_solid() {
    let Some(path) = common::files(400_000).into_iter().find(|path| path.ends_with("cube_no_bottom.obj"))
    else {
        return;
    };
    let bytes = std::fs::read(&path).unwrap();
    let name = path.to_string_lossy();
    let input =
        load(&bytes, FormatHint { name: Some(&name), ..FormatHint::default() }, &Default::default()).unwrap();
    let Shape::Scene(scene) = &input.shape else { panic!("a mesh") };
    let made = mesh_to_field(&scene.parts[0].mesh, &Job::default()).unwrap();
    assert!(!made.solid.closed && made.solid.boundary_edges > 0);
}

/// The trilinear interpolant by its definition.
fn interpolated(values: &dyn Fn([usize; 3]) -> f64, index: [f64; 3]) -> f64 {
    let low = index.map(|x| x.floor());
    (0..8)
        .map(|corner| {
            let side = [0, 1, 2].map(|k| corner >> k & 1);
            let weight: f64 = (0..3)
                .map(|k| if side[k] == 1 { index[k] - low[k] } else { 1.0 - (index[k] - low[k]) })
                .product();
            weight * values([0, 1, 2].map(|k| low[k] as usize + side[k]))
        })
        .sum()
}

fn ball(p: [f64; 3]) -> f64 {
    p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0
}

fn torus(p: [f64; 3]) -> f64 {
    (p[0].hypot(p[1]) - 1.0).hypot(p[2]) - 0.4
}

fn block(p: [f64; 3]) -> f64 {
    let q = [p[0].abs() - 1.0, p[1].abs() - 1.0, p[2].abs() - 0.5];
    let out = q.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt();
    out + q[0].max(q[1]).max(q[2]).min(0.0)
}

/// The block without what is near the axis; outside of it the distance is to walls and to circles.
fn drilled(p: [f64; 3]) -> f64 {
    let (r, z) = (p[0].hypot(p[1]), p[2].abs());
    let wall = if z <= 0.5 { (r - 0.4).abs() } else { (r - 0.4).abs().hypot(z - 0.5) };
    if r < 0.4 {
        return wall;
    }
    let solid = block(p);
    if solid > 0.0 { solid } else { -solid.abs().min(wall) }
}

#[test]
fn the_bounds_of_the_interpolant_are_never_exceeded() {
    type Truth = fn([f64; 3]) -> f64;
    let shapes: [(&str, Truth, &str); 4] = [
        ("sphere(1)", ball, "field"),
        ("torus(1, 0.4)", torus, "field"),
        ("box(2, 2, 1)", block, "field"),
        ("box(2, 2, 1) - cylinder(0.4, 2)", drilled, "tessellation"),
    ];
    let mut random = chordal_testkit::Random::new(71);
    for (script, truth, route) in shapes {
        for band in [None, Some(2.5)] {
            let hint = FormatHint { name: Some("a.star"), ..FormatHint::default() };
            let input = load(script.as_bytes(), hint, &Default::default()).unwrap();
            let spec = BakeSpec { band, is_sparse: band.is_some(), ..BakeSpec::cells(21) };
            let outcome = bake(input, &spec, chordal_io::Format::Nrrd, &Job::default()).unwrap();
            let facts = outcome.certificate.verb.grid().cloned().unwrap();
            assert_eq!(facts.route, route, "{script}");
            let between = facts.interpolant.unwrap();
            let (most, at_samples) = (between.at_most, facts.off_at_most.unwrap());
            let grid = outcome.volume.into_dense().grid;
            let (size, band) = (grid.size(), facts.band.unwrap_or(f64::INFINITY));
            let (mut worst, mut judged) = ([0.0_f64; 2], 0);
            for _ in 0..200_000 {
                let index: [f64; 3] =
                    std::array::from_fn(|k| random.unit() * (size[k] - 1) as f64 * (1.0 - 1e-12));
                let low = index.map(|x| x.floor() as usize);
                let corners = (0..8).map(|c| grid.sample([0, 1, 2].map(|k| low[k] + (c >> k & 1))));
                if corners.into_iter().any(|value| value.abs() >= band) {
                    continue;
                }
                judged += 1;
                let value = interpolated(&|at| grid.sample(at), index);
                let found = truth(grid.affine().at(index));
                let off = if route == "field" { value - found } else { value.abs() - found.abs() };
                let at = grid.affine().at(low.map(|i| i as f64));
                worst[0] = worst[0].max(off.abs());
                worst[1] = worst[1].max((grid.sample(low).abs() - truth(at).abs()).abs());
            }
            assert!(judged > 10_000, "{script}: {judged}");
            assert!(worst[0] <= most && worst[1] <= at_samples + 1e-12, "{script}: {worst:?}, {most}");
            // Where the distance has kinks, as it has inside, the bound is within some times of what is there.
            assert!(band.is_finite() || worst[0] > 0.05 * most, "{script}: {worst:?}, {most}");
        }
    }
}

#[test]
fn a_longer_length_is_met_where_a_shorter_one_is() {
    // A plate a hundredth as thick as it is wide: cells of an eighth of a long length miss it.
    let corner = |n: usize| format!("v {} {} {}\n", 10 * (n & 1), 10 * (n >> 1 & 1), 0.1 * (n >> 2) as f64);
    let faces = "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
    let obj = (0..8).map(corner).collect::<String>() + faces;
    // The last has cells by the million.
    let lengths = ["2", "1", "0.3", "0.1"];
    for length in &lengths[..if is_long() { 4 } else { 3 }] {
        let hint = FormatHint { name: Some("plate.obj"), ..FormatHint::default() };
        let input = load(obj.as_bytes(), hint, &Default::default()).unwrap();
        let spec =
            BakeSpec { resolution: BakeResolution::Within(length.parse().unwrap()), ..BakeSpec::cells(8) };
        let made = bake(input, &spec, Format::Nrrd, &Job::default()).unwrap();
        assert!(made.unmet.is_none(), "{length}: {:?}", made.unmet);
        assert!(made.certificate.bound.unwrap().at_most.unwrap() <= length.parse::<f64>().unwrap());
    }
}
