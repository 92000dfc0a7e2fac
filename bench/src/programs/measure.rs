//! Measures dumped meshes against the patches they came from: `measure CORPUS TOLERANCE ENGINE...`.
//!
//! A dump with one mesh is measured against the whole corpus, one with a mesh for each patch one by one.
//! Prints CSV, for all shapes and for each family: corpus, tolerance, engine, family, shapes, triangles,
//! shapes over, worst and median of error/tolerance.
use chordal_bench::sampler::{Surface, Triangles, measure};
use chordal_bench::{Dumped, labels, out, patches, read};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// From the surface to the mesh, and back.
fn measured(surface: Surface, (positions, faces): &Dumped) -> [f64; 2] {
    if faces.is_empty() {
        return [f64::INFINITY, 0.0];
    }
    let found = measure(&surface, &Triangles::new(positions, faces));
    [found.to_mesh, found.to_surface]
}

fn all(corpus: &str, meshes: &[Dumped]) -> Vec<[f64; 2]> {
    let patches = patches(corpus);
    if meshes.len() == 1 {
        return vec![measured(Surface::new(patches), &meshes[0])];
    }
    assert_eq!(meshes.len(), patches.len(), "one mesh for each patch");
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(mesh) = meshes.get(i) else { return done };
            done.push((i, measured(Surface::new(vec![patches[i]]), mesh)));
        }
    };
    let mut found = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("no panic")).collect::<Vec<_>>()
    });
    found.sort_by_key(|(i, _)| *i);
    found.into_iter().map(|(_, d)| d).collect()
}

/// What is said of some shapes: how many, their triangles, how many are over, worst and median of
/// error/tolerance.
fn summary(shapes: &[(usize, f64)]) -> String {
    let mut ratios: Vec<f64> = shapes.iter().map(|(_, ratio)| *ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let triangles: usize = shapes.iter().map(|(triangles, _)| triangles).sum();
    let over = ratios.iter().filter(|r| **r > 1.0).count();
    let (worst, median) = (ratios[ratios.len() - 1], ratios[ratios.len() / 2]);
    format!("{},{triangles},{over},{worst:.3},{median:.3}", ratios.len())
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [corpus, tolerance, engines @ ..] = args.as_slice() else {
        panic!("measure CORPUS TOLERANCE ENGINE...")
    };
    let limit: f64 = tolerance.parse().expect("a tolerance");
    let names = labels(corpus);
    for engine in engines {
        let path = out().join(format!("{corpus}.{tolerance}.{engine}.mesh"));
        let meshes = read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let found = all(corpus, &meshes);
        let ratio = |[to, back]: &[f64; 2]| to.max(*back) / limit;
        let shapes: Vec<_> = meshes.iter().zip(&found).map(|(mesh, d)| (mesh.1.len(), ratio(d))).collect();
        println!("{corpus},{tolerance},{engine},all,{}", summary(&shapes));
        let mut families = BTreeMap::<&str, Vec<(usize, f64)>>::new();
        for (shape, name) in shapes.iter().zip(&names) {
            families.entry(name).or_default().push(*shape);
        }
        for (family, shapes) in families.iter().filter(|_| shapes.len() > 1) {
            println!("{corpus},{tolerance},{engine},{family},{}", summary(shapes));
        }
    }
}
