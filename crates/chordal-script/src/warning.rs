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
        let message = "'-' binds closer than '|': what follows it is cut from this last shape of the union \
            alone; write (a | b) - c to cut it from all of them, or a | (b - c) if that is meant";
        Self { code: "last-operand-cut", place, message }
    }

    /// For an operation that moves the surface by a distance, of a shape whose value is only a bound.
    pub(crate) fn bound_taken_as_distance(place: (u64, u64)) -> Self {
        let message = "this moves the surface by its distance, and the value of this shape is a lower bound of \
            it where the surface moves to: it moves farther than asked there; \
            redistance(shape, within) makes the value a distance first";
        Self { code: "bound-as-distance", place, message }
    }
}

impl fmt::Display for ScriptWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.place;
        write!(f, "line {line}, column {column}: {}", self.message)
    }
}
