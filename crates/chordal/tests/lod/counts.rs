//! Triangle counts: about the error of a length that leaves as many, or the steps of least cost.
use super::{bounds, length, made, n_faces, shapes};
use chordal::explicit::Topology;
use chordal::lod::SimplifiedMesh;
use chordal::lod::count::{Effort, simplify_to_count};
use chordal::{Bounded, Budget, Failure, Job, Mesh};
use chordal_testkit::Random;

fn counted(mesh: &Mesh, most: u64, effort: Effort, threads: usize) -> Bounded<SimplifiedMesh> {
    let job = Job::default().with_threads(threads);
    match simplify_to_count(mesh, most, effort, Topology::Positions, &job) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other}"),
    }
}

fn solids() -> [(&'static str, Mesh); 5] {
    [
        ("bumps", shapes::torus([80, 40], 0.1)),
        ("lobes", shapes::lobes(4)),
        ("heights", shapes::heights([40, 40], 0.002)),
        ("gear", shapes::gear(4, 12)),
        ("shaft", shapes::shaft(60)),
    ]
}

#[test]
fn a_count_has_the_error_of_a_length_that_leaves_as_many() {
    for (name, mesh) in solids() {
        for share in [3, 10] {
            let most = mesh.faces().len() / share;
            let best = made(&mesh, &Budget::triangles(most as u64));
            assert!(n_faces(&best) <= most);
            let error = best.bound.at_most().expect("proved");
            if error <= 1e-9 {
                continue;
            }
            // A length that is a tenth less leaves more, and one that is a tenth more no more than a few more.
            let (tighter, wider) = (made(&mesh, &length(error / 1.1)), made(&mesh, &length(1.1 * error)));
            let [few, many] = [0.94, 1.06].map(|x| (x * most as f64) as usize);
            assert!(n_faces(&tighter) >= few, "{name}/{share}: {} for {most}", n_faces(&tighter));
            assert!(n_faces(&wider) <= many, "{name}/{share}: {} for {most}", n_faces(&wider));
        }
    }
}

#[test]
fn steps_of_least_cost_have_a_larger_error() {
    let mut random = Random::new(3);
    let mut worse = 0;
    for (number, (name, mesh)) in solids().into_iter().enumerate() {
        let most = mesh.faces().len() as u64 / 8;
        let [best, fast] = [Effort::Best, Effort::Fast].map(|effort| counted(&mesh, most, effort, 1));
        assert!(n_faces(&best).max(n_faces(&fast)) <= most as usize, "{name}");
        assert!(n_faces(&best) as f64 > 0.97 * most as f64, "{name}: {} of {most}", n_faces(&best));
        bounds::holds(name, &mesh, &Budget::triangles(most), &fast, &mut random);
        worse += u32::from(fast.bound.at_least() > 1.2 * best.bound.at_most().expect("proved"));
        assert!(best.bound.at_most() <= fast.bound.at_most(), "{name}");
        if number % 3 == 0 || chordal_testkit::is_long() {
            assert_eq!(best, counted(&mesh, most, Effort::Best, 2), "{name}");
        }
    }
    assert!(worse >= 3, "{worse}");
}

#[test]
fn what_is_flat_stays_flat() {
    for mesh in [shapes::tray(20, 0.002), shapes::heights([30, 30], 0.0)] {
        let fewest = made(&mesh, &length(1e-9 * mesh.bounds().diagonal()));
        let most = 2 * n_faces(&fewest) as u64;
        if most < mesh.faces().len() as u64 {
            let best = counted(&mesh, most, Effort::Best, 1);
            assert!(best.bound.at_most().expect("proved") <= 1e-9, "{}", best.bound);
        }
    }
}

#[test]
fn a_count_out_of_reach_is_the_best_of_both() {
    let mesh = shapes::torus([24, 12], 0.0);
    for effort in [Effort::Best, Effort::Fast] {
        let tried = simplify_to_count(&mesh, 3, effort, Topology::Indices, &Job::default());
        let Err(Failure::Unmet(best)) = tried else { panic!("a torus of three triangles") };
        assert!(n_faces(&best) > 3 && n_faces(&best) < 40, "{}", n_faces(&best));
        let all =
            simplify_to_count(&mesh, 576, effort, Topology::Indices, &Job::default()).expect("all of it");
        assert_eq!(n_faces(&all), 576);
        assert_eq!(all.bound.at_most(), Some(0.0));
    }
}
