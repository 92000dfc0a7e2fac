//! Newell's teapot: 32 patches, some of them with poles, and six open edges.
use super::length::rounding;
use super::topology::Topology;
use super::{is_long, library_patches, mesh_within};
use chordal::{Budget, Job, Tolerance, convert};
use chordal_testkit::sampler::{Control, Surface, Triangles, measure};
use std::path::Path;

/// The shipped teapot: a count, then for each patch its two degrees and sixteen points.
pub fn teapot() -> Vec<Control> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/teapot.bpt");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().expect("a number"));
    let mut next = || numbers.next().expect("enough numbers");
    let patch = |next: &mut dyn FnMut() -> f64| -> Control {
        assert_eq!([next(), next()], [3.0, 3.0], "bicubic");
        std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| next())))
    };
    let n = next() as usize;
    (0..n).map(|_| patch(&mut next)).collect()
}

#[test]
fn has_six_boundary_loops_at_every_tolerance() {
    let patches = teapot();
    assert_eq!(patches.len(), 32);
    // At 1e-5 there are 6 million triangles, at 1e-4 half a million.
    let finest = if is_long() { Some(1e-5) } else { None };
    for length in [10.0, 1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4].into_iter().chain(finest) {
        let made = mesh_within(&patches, length);
        let topology = Topology::of(&made.shape);
        assert_eq!(topology.boundary_loops(), Ok(6), "at {length}");
        assert_eq!(topology.crowded_edges(), 0, "at {length}");
        assert_eq!(topology.degenerate_faces(), 0, "at {length}");
        // Nearer than any two vertices of this mesh, further than rounding.
        assert_eq!(topology.t_junctions(1e-12), 0, "at {length}");
    }
}

#[test]
fn stays_within_its_bound() {
    let patches = teapot();
    for length in [1.0, 0.1, 0.01, 0.001] {
        let made = mesh_within(&patches, length);
        let mesh = Triangles::new(made.shape.positions(), made.shape.faces());
        let measured = measure(&Surface::new(patches.clone()), &mesh).both();
        let at_most = made.bound.at_most().expect("proved");
        let slack = patches.iter().map(rounding).fold(0.0, f64::max);
        eprintln!(
            "teapot at {length}: {} triangles, at_most/measured {:.3}",
            mesh.corners.len(),
            at_most / measured
        );
        assert!(
            at_most <= length && measured <= at_most + slack,
            "{measured:e}, {:?} at {length}",
            made.bound
        );
        assert!(made.bound.at_least() <= measured * 1.002 + slack, "{measured:e}, {:?}", made.bound);
    }
}

#[test]
fn has_the_same_bytes_on_one_and_two_threads() {
    let patches = library_patches(&teapot());
    for length in [0.1, 0.003, 1e-4] {
        let budget = Budget::length(Tolerance::new(length).expect("positive"));
        let [one, two, many] = [1, 2, 5].map(|threads| {
            let made = convert::patches_to_mesh(&patches, &budget, &Job::default().with_threads(threads));
            let made = made.expect("reachable");
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            let attributes: Vec<_> = made.shape.attributes().iter().map(|a| bits(&a.values)).collect();
            let tied = made.shape.position_id().map(<[u32]>::to_vec);
            let positions = bits(made.shape.positions().as_flattened());
            (positions, made.shape.faces().to_vec(), tied, attributes, made.bound)
        });
        assert!(one == two && one == many, "threads change the mesh at {length}");
    }
}
