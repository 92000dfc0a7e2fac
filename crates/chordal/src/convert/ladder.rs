//! `LengthLadder`: the lengths that are tried when a budget limits only the number of triangles or segments.

/// A geometric series of lengths from four times the size of a shape downwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LengthLadder {
    pub size: f64,
    /// Lengths for each factor of two.
    pub per_octave: u32,
    pub octaves: u32,
}

impl LengthLadder {
    /// The number of lengths.
    pub(crate) fn n_rungs(&self) -> u32 {
        self.octaves * self.per_octave
    }

    /// The `k`-th length: an exact power of two times one of as many fixed factors as an octave has lengths.
    pub(crate) fn length(&self, k: u32) -> f64 {
        let step = libm::exp2(-f64::from(k % self.per_octave) / f64::from(self.per_octave));
        4.0 * self.size * step * libm::exp2(-f64::from(k / self.per_octave))
    }

    /// The number of the finest length that fits: searched by octaves, then by bisection, on the assumption that no
    /// length below one that does not fit does. The first length is assumed to fit.
    ///
    /// # Errors
    /// Those of `fits`.
    pub(crate) fn finest<E>(&self, mut fits: impl FnMut(u32) -> Result<bool, E>) -> Result<u32, E> {
        let (mut low, mut high) = (0, self.n_rungs());
        while high - low > 1 {
            let octave = low.saturating_add(self.per_octave);
            let k = if octave < high { octave } else { low.midpoint(high) };
            if fits(k)? {
                low = k;
            } else {
                high = k;
            }
        }
        Ok(low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LADDER: LengthLadder = LengthLadder { size: 1.0, per_octave: 16, octaves: 100 };

    #[test]
    fn the_finest_length_is_found_in_a_few_trials_of_each_octave() {
        for finest in [0, 1, 15, 16, 17, 100, 1598, 1599] {
            let mut trials = 0;
            let found = LADDER.finest(|k| {
                trials += 1;
                Ok::<_, ()>(k <= finest)
            });
            assert_eq!(found, Ok(finest));
            assert!(trials <= finest / 16 + 6, "{trials} trials for {finest}");
        }
    }

    #[test]
    fn an_octave_is_exactly_a_factor_of_two() {
        assert_eq!(LADDER.length(0), 4.0);
        for k in 0..200 {
            assert_eq!(LADDER.length(k), 2.0 * LADDER.length(k + 16));
            assert!(LADDER.length(k + 1) < LADDER.length(k));
        }
    }
}
