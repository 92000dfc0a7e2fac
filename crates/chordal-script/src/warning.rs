//! `ScriptWarning`: code that is valid and likely a mistake.
use std::fmt;

/// A stable code, a source position, and one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptWarning {
    /// Stable, for programs: `last-operand-cut` or `bound-as-distance`.
    pub code: &'static str,
    /// Line and column, counted from 1.
    pub place: (u64, u64),
    /// The effect of the code, and what to write instead.
    pub message: &'static str,
}

impl ScriptWarning {
    /// For `a | b - c` of shapes, at `b - c`.
    pub(crate) fn last_operand_cut(place: (u64, u64)) -> Self {
        let message = "'-' binds tighter than '|', so this cuts only the last shape of the union: write \
            (a | b) - c to cut all of them, or a | (b - c) to cut only the last";
        Self { code: "last-operand-cut", place, message }
    }

    /// For an operation that moves the surface by a distance, of a shape whose value is only a bound.
    pub(crate) fn bound_taken_as_distance(place: (u64, u64)) -> Self {
        let message = "this moves the surface by a distance, but on that side the value of the shape is only a \
            lower bound of the distance, so the surface moves too far: apply redistance(shape, within) to \
            the shape first";
        Self { code: "bound-as-distance", place, message }
    }
}

impl fmt::Display for ScriptWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.place;
        write!(f, "line {line}, column {column}: {}", self.message)
    }
}
