//! The laws of cubic curves, on curves, on patches along both parameters, and on curves that break them.
use chordal::explicit::laws::{self, CubicCurve};
use chordal::{Bezier, Patch, curve_laws};
use chordal_testkit::Random;
use std::panic::catch_unwind;

curve_laws!(curve_in_the_plane, Bezier<2>, 2);
curve_laws!(curve_in_space, Bezier<3>, 3);
curve_laws!(patch_along_its_first_row, AlongU<0>, 3);
curve_laws!(patch_along_its_middle, AlongU<2>, 3);
curve_laws!(patch_along_its_last_column, AlongV<4>, 3);
curve_laws!(patch_across_its_middle, AlongV<2>, 3);

/// A patch whose rows are all the same line, read along `u` at `v = QUARTERS/4`.
struct AlongU<const QUARTERS: usize>(Patch);

/// The same with columns, read along `v` at `u = QUARTERS/4`.
struct AlongV<const QUARTERS: usize>(Patch);

impl<const QUARTERS: usize> AlongU<QUARTERS> {
    const V: f64 = QUARTERS as f64 / 4.0;
}

impl<const QUARTERS: usize> AlongV<QUARTERS> {
    const U: f64 = QUARTERS as f64 / 4.0;
}

impl<const QUARTERS: usize> CubicCurve<3> for AlongU<QUARTERS> {
    fn from_control(control: [[f64; 3]; 4]) -> Self {
        Self(Patch { control: [control; 4] })
    }
    fn control(&self) -> [[f64; 3]; 4] {
        self.0.control[0]
    }
    fn at(&self, t: f64) -> [f64; 3] {
        self.0.at(t, Self::V)
    }
    fn by_de_casteljau(&self, t: f64) -> [f64; 3] {
        self.0.at_de_casteljau(t, Self::V)
    }
    fn tangent(&self, t: f64) -> [f64; 3] {
        self.0.tangents(t, Self::V)[0]
    }
    fn split(&self, t: f64) -> [Self; 2] {
        if t == 0.5 {
            return self.0.halves_u().map(Self);
        }
        [[0.0, t], [t, 1.0]].map(|range| Self(self.0.part(range, [0.0, 1.0])))
    }
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; 3] {
        self.0.blossom([a, b, c], [Self::V; 3])
    }
}

impl<const QUARTERS: usize> CubicCurve<3> for AlongV<QUARTERS> {
    fn from_control(control: [[f64; 3]; 4]) -> Self {
        Self(Patch { control: control.map(|point| [point; 4]) })
    }
    fn control(&self) -> [[f64; 3]; 4] {
        self.0.control.map(|row| row[0])
    }
    fn at(&self, t: f64) -> [f64; 3] {
        self.0.at(Self::U, t)
    }
    fn by_de_casteljau(&self, t: f64) -> [f64; 3] {
        self.0.at_de_casteljau(Self::U, t)
    }
    fn tangent(&self, t: f64) -> [f64; 3] {
        self.0.tangents(Self::U, t)[1]
    }
    fn split(&self, t: f64) -> [Self; 2] {
        if t == 0.5 {
            return self.0.halves_v().map(Self);
        }
        [[0.0, t], [t, 1.0]].map(|range| Self(self.0.part([0.0, 1.0], range)))
    }
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; 3] {
        self.0.blossom([Self::U; 3], [a, b, c])
    }
}

/// A curve with one mistake, which is the number.
struct Wrong<const MISTAKE: usize>(Bezier<3>);

impl<const MISTAKE: usize> Wrong<MISTAKE> {
    fn bent(&self, t: f64, by: f64) -> [f64; 3] {
        let most = self.0.control.as_flattened().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        self.0.at(t).map(|x| x + by * most)
    }
}

impl<const MISTAKE: usize> CubicCurve<3> for Wrong<MISTAKE> {
    fn from_control(control: [[f64; 3]; 4]) -> Self {
        Self(Bezier { control })
    }
    fn control(&self) -> [[f64; 3]; 4] {
        self.0.control
    }
    fn at(&self, t: f64) -> [f64; 3] {
        match MISTAKE {
            // A Catmull-Rom habit: the middle weights are too large.
            0 => self.bent(t, t * (1.0 - t)),
            // A few units in the last place everywhere.
            1 => self.bent(t, 12.0 * f64::EPSILON),
            _ => self.0.at(t),
        }
    }
    fn by_de_casteljau(&self, t: f64) -> [f64; 3] {
        self.0.de_casteljau(t).point
    }
    fn tangent(&self, t: f64) -> [f64; 3] {
        // The factor 3 forgotten.
        self.0.tangent(t).map(|x| if MISTAKE == 2 { x / 3.0 } else { x })
    }
    fn split(&self, t: f64) -> [Self; 2] {
        // Split at the middle whatever was asked.
        self.0.split(if MISTAKE == 3 { 0.5 } else { t }).map(Self)
    }
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; 3] {
        // Not symmetric.
        if MISTAKE == 4 { self.0.blossom(a, b, b) } else { self.0.blossom(a, b, c) }
    }
}

#[test]
fn each_law_fails_on_the_mistake_that_it_forbids() {
    type Law = (&'static str, fn());
    let broken: [Law; 7] = [
        ("weights", laws::weights_are_at_least_0_and_sum_to_1::<Wrong<0>, 3>),
        ("ends", laws::starts_and_ends_at_its_end_points::<Wrong<1>, 3>),
        ("legs", laws::leaves_and_arrives_along_its_legs::<Wrong<2>, 3>),
        ("hull", laws::stays_inside_its_hull::<Wrong<0>, 3>),
        ("evaluations", laws::bernstein_equals_de_casteljau::<Wrong<1>, 3>),
        ("halves", laws::halves_evaluate_to_the_whole::<Wrong<3>, 3>),
        ("blossom", laws::blossom_is_symmetric_and_affine::<Wrong<4>, 3>),
    ];
    for (name, law) in broken {
        assert!(catch_unwind(law).is_err(), "the law of the {name} let a mistake pass");
    }
}

/// Sixteen random control points about `centre`, from a seed.
fn random_patch(seed: u64, size: f64, centre: f64) -> Patch {
    let mut random = Random::new(seed);
    let mut next = || centre + size * random.signed();
    Patch { control: std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| next()))) }
}

#[test]
fn a_patch_is_one_surface_whichever_way_it_is_evaluated() {
    for seed in 1..=500 {
        let size = [1e-6, 1.0, 1e6][seed as usize % 3];
        let patch = random_patch(seed, size, [0.0, 50.0 * size][seed as usize / 3 % 2]);
        let ulp = patch.size().next_up() - patch.size();
        let near = |what: &str, a: [f64; 3], b: [f64; 3], ulps: f64| {
            let close = (0..3).all(|k| (a[k] - b[k]).abs() <= ulps * ulp);
            assert!(close, "{what} of the patch of seed {seed}: {a:?} and {b:?}");
        };
        for (u, v) in [(0.0, 0.0), (1.0, 1.0), (0.5, 0.5), (0.3, 0.8), (0.9, 0.1), (1.0, 0.4)] {
            let point = patch.at(u, v);
            // Two passes of a law that allows 4 ulp each.
            near("de Casteljau", point, patch.at_de_casteljau(u, v), 8.0);
            near("the diagonal of the blossom", point, patch.blossom([u; 3], [v; 3]), 16.0);
            near(
                "symmetry",
                patch.blossom([u, 0.2, 0.7], [v, 0.6, 0.1]),
                patch.blossom([0.7, u, 0.2], [0.1, v, 0.6]),
                32.0,
            );
            let part = patch.part([0.25, 0.75], [0.5, 1.0]);
            near("a part", part.at(u, v), patch.at(0.25 + 0.5 * u, 0.5 + 0.5 * v), 32.0);
            near("the left half", patch.halves_u()[0].at(u, v), patch.at(0.5 * u, v), 16.0);
            near("the upper half", patch.halves_v()[1].at(u, v), patch.at(u, 0.5 + 0.5 * v), 16.0);
        }
    }
}
