//! `Limits`: caps on the resources of a script.

/// Caps on the resources of one script. Each is checked before the resource is taken, or right after a step
/// that is itself bounded, so that a script ends with an error and does not exhaust the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the text.
    pub bytes: usize,
    /// The nesting depth of expressions and blocks; operators in a row count.
    pub nesting: u32,
    /// Calls and loop iterations.
    pub ticks: u64,
    /// Bytes of the script's values.
    pub heap: usize,
    /// The depth of the call stack.
    pub calls: usize,
    /// Elements that built-in functions and operators may read or create, in total.
    pub work: u64,
    /// Terms of the shape's expression. All steps together may add four times as many.
    pub terms: u64,
}

impl Default for Limits {
    /// Limits within which a laptop evaluates a script in less than two seconds.
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
