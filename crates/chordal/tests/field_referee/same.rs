//! The same bytes on any number of threads and with every instruction set.
use super::{budget, shapes};
use chordal::Job;
use chordal::convert::field_to_mesh;
use chordal_testkit::Fingerprint;

/// A number for all bytes of the meshes and of their bounds.
fn digest(threads: usize) -> u64 {
    let mut sum = Fingerprint::default();
    for shape in [shapes::torus(), shapes::gyroid()] {
        let job = Job::default().with_threads(threads);
        let made = field_to_mesh(&shape.field, &budget(0.06), &job).expect("it is proved");
        sum.add_bits(made.shape.positions().as_flattened());
        made.shape.faces().as_flattened().iter().for_each(|i| sum.add_number(u64::from(*i)));
        sum.add_bits(&[made.bound.at_least(), made.bound.at_most().expect("proved")]);
    }
    sum.0
}

#[test]
fn threads_change_no_byte() {
    let one = digest(1);
    assert_eq!([digest(2), digest(8)], [one; 2]);
}

#[test]
fn digest_for_another_process() {
    println!("digest {}", digest(1));
}

#[test]
fn instruction_sets_change_no_byte() {
    let of = |isa: &str| {
        let exe = std::env::current_exe().expect("this test");
        let output = std::process::Command::new(exe)
            .args(["--exact", "field_referee::same::digest_for_another_process", "--nocapture"])
            .env("CHORDAL_ISA", isa)
            .output()
            .expect("a second process");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let at = text.find("digest ").map(|at| text[at + 7..].lines().next().unwrap_or("").to_string());
        at.unwrap_or_else(|| panic!("no digest in {text}"))
    };
    assert_eq!(of("plain"), of("avx2"));
}
