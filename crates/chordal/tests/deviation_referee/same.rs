//! Laws: nothing is 0 away from itself, the order does not matter, nor scale, place or threads; and what a
//! limit does.
use super::families::{KINDS, moved, pair};
use super::measured;
use chordal::budget::{JobError, RefusalCode, Tolerance};
use chordal::check::{Goal, deviation};
use chordal::{Job, Mesh};
use chordal_testkit::Random;

fn pairs() -> impl Iterator<Item = (String, [Mesh; 2])> {
    (0..KINDS.len()).flat_map(|kind| {
        (0..3).map(move |seed| {
            let mut random = Random::new((5000 + 10 * kind + seed) as u64);
            (format!("{} {seed}", KINDS[kind]), pair(kind, &mut random))
        })
    })
}

#[test]
fn a_mesh_is_not_away_from_itself_however_it_is_listed() {
    for (name, [a, _]) in pairs() {
        assert_eq!(measured(&a, &a, &Goal::default()).bound.at_most(), Some(0.0), "{name}");
        // As a soup, backwards, turned inside out.
        let positions =
            a.faces().iter().rev().flat_map(|f| [f[2], f[1], f[0]]).map(|i| a.positions()[i as usize]);
        let faces = (0..a.faces().len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let soup = Mesh::new(positions.collect(), faces).unwrap();
        assert_eq!(measured(&a, &soup, &Goal::default()).bound.at_most(), Some(0.0), "{name}");
    }
}

#[test]
fn the_order_does_not_matter() {
    for (name, [a, b]) in pairs() {
        let (one, two) = (measured(&a, &b, &Goal::default()), measured(&b, &a, &Goal::default()));
        assert_eq!(
            (one.bound.at_least(), one.bound.at_most()),
            (two.bound.at_least(), two.bound.at_most()),
            "{name}"
        );
        assert_eq!((one.forward, one.backward), (two.backward, two.forward), "{name}");
    }
}

#[test]
fn powers_of_two_scale_the_ends_exactly() {
    for (name, [a, b]) in pairs().filter(|(name, _)| !name.starts_with("tiny") && !name.starts_with("huge")) {
        let plain = measured(&a, &b, &Goal::default());
        for power in [-20, 20] {
            let scale = 2_f64.powi(power);
            let [a, b] = [&a, &b].map(|mesh| moved(mesh, |p| p.map(|x| x * scale)));
            let scaled = measured(&a, &b, &Goal::default());
            assert_eq!(scaled.bound.at_least(), plain.bound.at_least() * scale, "{name}");
            assert_eq!(scaled.bound.at_most().unwrap(), plain.bound.at_most().unwrap() * scale, "{name}");
        }
    }
}

#[test]
fn neither_threads_nor_instructions_change_a_bit() {
    for (name, [a, b]) in pairs() {
        let one = deviation(&a, &b, &Goal::default(), &Job::default().with_threads(1)).unwrap();
        for threads in [2, 3] {
            let more = deviation(&a, &b, &Goal::default(), &Job::default().with_threads(threads)).unwrap();
            assert_eq!(one, more, "{name}");
        }
    }
}

#[test]
fn a_shift_keeps_the_verdict() {
    for (name, [a, b]) in pairs().filter(|(name, _)| name.starts_with("whole") || name.starts_with("stairs"))
    {
        let plain = measured(&a, &b, &Goal::default());
        // Dyadic coordinates stay exact when a million is added.
        let round = |mesh: &Mesh, off: f64| moved(mesh, |p| p.map(|x| (x * 1024.0).round() / 1024.0 + off));
        let [near, far] = [0.0, 1e6].map(|off| measured(&round(&a, off), &round(&b, off), &Goal::default()));
        let close = |x: f64, y: f64| (x - y).abs() <= 1e-12 + 0.1 * x.abs();
        assert!(close(near.bound.at_least(), far.bound.at_least()), "{name}");
        assert!(close(near.bound.at_most().unwrap(), far.bound.at_most().unwrap()), "{name}");
        assert!(plain.reached && near.reached && far.reached);
    }
}

#[test]
fn a_limit_is_decided_and_a_length_is_reached() {
    let length = |x: f64| Some(Tolerance::new(x).unwrap());
    for (name, [a, b]) in pairs() {
        let plain = measured(&a, &b, &Goal { relative: 0.01, ..Goal::default() });
        let (least, most) = (plain.bound.at_least(), plain.bound.at_most().unwrap());
        assert!(most <= 1.01 * least * (1.0 + 1e-12) + 64.0 * f64::EPSILON * size(&a, &b), "{name}");
        // Below, rounding decides.
        if most < 1e-12 * size(&a, &b) {
            continue;
        }
        let under = measured(&a, &b, &Goal { max: length(0.9 * least), ..Goal::default() });
        assert!(under.reached && under.bound.at_least() > 0.9 * least, "{name}");
        assert!(under.bound.at_most().unwrap() >= least, "{name}");
        let over = measured(&a, &b, &Goal { max: length(1.1 * most), ..Goal::default() });
        assert!(over.reached && over.bound.at_most().unwrap() <= 1.1 * most, "{name}");
        let near =
            measured(&a, &b, &Goal { relative: 0.0, absolute: length(0.02 * most), ..Goal::default() });
        let [least, most] = [near.bound.at_least(), near.bound.at_most().unwrap()];
        assert!(near.reached && most - least <= 0.021 * most, "{name}: [{least:e}, {most:e}]");
    }
}

fn size(a: &Mesh, b: &Mesh) -> f64 {
    a.bounds().union(b.bounds()).diagonal()
}

#[test]
fn what_has_no_surface_or_no_extent_is_refused() {
    let triangle = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let points = Mesh::new(vec![[0.0; 3]], Vec::new()).unwrap();
    let huge = Mesh::new(vec![[-1.7e308; 3], [1.7e308, 0.0, 0.0], [0.0; 3]], vec![[0, 1, 2]]).unwrap();
    let code = |a: &Mesh, b: &Mesh| match deviation(a, b, &Goal::default(), &Job::default()) {
        Err(JobError::Refused(refusal)) => Some(refusal.code),
        _ => None,
    };
    assert_eq!(code(&triangle, &points), Some(RefusalCode::Empty));
    assert_eq!(code(&points, &triangle), Some(RefusalCode::Empty));
    assert_eq!(code(&huge, &triangle), Some(RefusalCode::NotFinite));
    let job = Job::default();
    job.cancel();
    assert_eq!(deviation(&triangle, &triangle, &Goal::default(), &job), Err(JobError::Cancelled));
}

#[test]
fn unused_vertices_are_no_part_of_a_surface() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [50.0, 50.0, 50.0]];
    let some = Mesh::new(positions.clone(), vec![[0, 1, 2]]).unwrap();
    let plain = Mesh::new(positions[..3].to_vec(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(measured(&some, &plain, &Goal::default()).bound.at_most(), Some(0.0));
}
