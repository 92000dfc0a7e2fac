//! `PatchGrid` gives the bits of `Patch::at` and `Patch::normal`, on every instruction set.
use crate::exact;
use chordal::Patch;
use chordal::explicit::parametric::PatchGrid;
use chordal::math::simd::{self, Isa};
use proptest::prelude::*;

fn patch() -> impl Strategy<Value = Patch> {
    let numbers = prop::collection::vec(-1.0..1.0_f64, 48);
    (numbers, 0..7_u8, -300..300_i32).prop_map(|(n, kind, exponent)| {
        let scale = if kind == 0 { 2_f64.powi(exponent) } else { 1.0 };
        let mut patch = Patch {
            control: std::array::from_fn(|i| {
                std::array::from_fn(|j| std::array::from_fn(|k| n[12 * i + 3 * j + k] * scale))
            }),
        };
        match kind {
            // A pole: one side is a point.
            1 => patch.control[0] = [patch.control[0][0]; 4],
            2 => (0..4).for_each(|i| patch.control[i][3] = patch.control[0][3]),
            // Every row alike, so that S_v vanishes everywhere.
            3 => patch.control = [patch.control[0]; 4],
            4 => patch = Patch::flat([0.1, 0.2, 0.3], [1.0, 0.0, 0.5], [0.0, 2.0, 0.0]),
            5 => patch.control[2][1][1] = f64::NAN,
            _ => {}
        }
        patch
    })
}

/// Parameters inside and on the border, of a number that fills blocks or does not.
fn parameters() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let parameter = || prop_oneof![3 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(0.5)];
    prop::collection::vec([parameter(), parameter()], 0..150)
}

proptest! {
    #![proptest_config(exact::cases(400))]

    #[test]
    fn many_at_once_are_the_bits_of_one_at_a_time(patch in patch(), uv in parameters()) {
        let bits = |p: [f64; 3]| p.map(f64::to_bits);
        for isa in Isa::ALL {
            let grid = PatchGrid::new(&patch).on(isa);
            let (mut points, mut normals) = (vec![[f64::NAN; 3]; uv.len()], vec![None; uv.len()]);
            grid.points_and_normals(&uv, &mut points, &mut normals);
            for (i, &[u, v]) in uv.iter().enumerate() {
                let (point, normal) = (patch.at(u, v), patch.normal(u, v));
                if point.iter().all(|x| !x.is_nan()) {
                    prop_assert_eq!(bits(points[i]), bits(point), "{} at {} {}", isa, u, v);
                }
                prop_assert_eq!(normals[i].map(bits), normal.map(bits), "{} at {} {}", isa, u, v);
            }
            let mut alone = vec![[0.0; 3]; uv.len()];
            grid.points(&uv, &mut alone);
            prop_assert_eq!(alone.into_iter().map(bits).collect::<Vec<_>>(), points.into_iter().map(bits).collect::<Vec<_>>());
        }
    }
}

#[test]
fn says_which_sets_were_compared() {
    let compared: Vec<_> = Isa::ALL.into_iter().filter(|isa| isa.is_available()).collect();
    eprintln!("instruction sets compared: {compared:?}; chosen: {}", simd::isa());
    assert!(compared.contains(&Isa::Plain) && compared.contains(&simd::isa()));
}
