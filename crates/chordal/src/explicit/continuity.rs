//! Continuing one cubic by another: which control points a smooth joint determines.
use super::Bezier;

/// The smoothness of the joint of two cubics over parameter intervals of equal length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Continuity {
    /// The end points are equal.
    C0,
    /// The first derivatives are equal too.
    C1,
    /// The second derivatives are equal too.
    C2,
}

impl<const D: usize> Bezier<D> {
    /// This curve with the smallest change that continues it smoothly from the end of `before`. Of the
    /// control points `[a, b, c, d]` one is set for C0, two for C1 and three for C2; the others stay.
    ///
    /// Each coordinate that is set is rounded once for each of its sums.
    ///
    /// ```
    /// use chordal::Bezier;
    /// use chordal::explicit::parametric::Continuity;
    /// let before = Bezier { control: [[0.0, 0.0], [1.0, 2.0], [2.0, 2.0], [3.0, 1.0]] };
    /// let after = Bezier { control: [[9.0, 9.0]; 4] }.continuing(&before, Continuity::C2);
    /// assert_eq!(after.control, [[3.0, 1.0], [4.0, 0.0], [5.0, -2.0], [9.0, 9.0]]);
    /// assert_eq!(after.tangent(0.0), before.tangent(1.0));
    /// assert_eq!(after.second_derivative(0.0), before.second_derivative(1.0));
    /// ```
    #[must_use]
    pub fn continuing(&self, before: &Self, smoothness: Continuity) -> Self {
        let [_, p1, p2, p3] = before.control;
        let mut control = self.control;
        control[0] = p3;
        if smoothness >= Continuity::C1 {
            // q1 − q0 = p3 − p2.
            control[1] = std::array::from_fn(|k| p3[k] + (p3[k] - p2[k]));
        }
        if smoothness >= Continuity::C2 {
            // q2 − 2 q1 + q0 = p3 − 2 p2 + p1.
            control[2] = std::array::from_fn(|k| p1[k] + 4.0 * (p3[k] - p2[k]));
        }
        Self { control }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEFORE: Bezier<2> = Bezier { control: [[0.5, 0.0], [1.0, 2.0], [2.25, 3.0], [3.0, 1.0]] };
    const AFTER: Bezier<2> = Bezier { control: [[4.0, 4.0], [5.0, 6.0], [7.0, 5.0], [8.0, 0.0]] };

    #[test]
    fn changes_only_what_it_has_to() {
        for (smoothness, n_set) in [(Continuity::C0, 1), (Continuity::C1, 2), (Continuity::C2, 3)] {
            let joined = AFTER.continuing(&BEFORE, smoothness);
            assert_eq!(joined.control[n_set..], AFTER.control[n_set..]);
            let agrees = [
                joined.at(0.0) == BEFORE.at(1.0),
                joined.tangent(0.0) == BEFORE.tangent(1.0),
                joined.second_derivative(0.0) == BEFORE.second_derivative(1.0),
            ];
            assert_eq!(agrees.iter().take_while(|same| **same).count(), n_set);
        }
    }

    #[test]
    fn twice_is_once() {
        let once = AFTER.continuing(&BEFORE, Continuity::C2);
        assert_eq!(once.continuing(&BEFORE, Continuity::C2), once);
    }
}
