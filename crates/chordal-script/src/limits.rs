//! `Limits`: how much a script may use.

/// Caps on what one script may use. Each is checked before what it caps is taken, or right after a step that is itself
/// bounded, so that a script ends with an error and not with the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the text.
    pub bytes: usize,
    /// How deeply expressions and blocks may be nested, operators in a row included.
    pub nesting: u32,
    /// Calls and turns of loops.
    pub ticks: u64,
    /// Bytes that the values of the script may take.
    pub heap: usize,
    /// Functions that wait for each other.
    pub calls: usize,
    /// Elements that built-in functions and operators may look at or make, all together.
    pub work: u64,
    /// Terms of the shape's expression, and a quarter of those that may be made on the way.
    pub terms: u64,
}

impl Default for Limits {
    /// What a laptop does in less than two seconds.
    fn default() -> Self {
        Self {
            bytes: 1 << 18,
            nesting: 200,
            ticks: 1_500_000,
            heap: 256 << 20,
            calls: 64,
            work: 50_000_000,
            terms: 1 << 20,
        }
    }
}
