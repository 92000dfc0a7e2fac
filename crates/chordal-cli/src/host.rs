//! What a process has and a module in a browser has not.

/// What tells this process from others that write beside it.
#[cfg(not(target_family = "wasm"))]
pub fn process_number() -> u32 {
    std::process::id()
}

/// A module is alone with its files.
#[cfg(target_family = "wasm")]
pub fn process_number() -> u32 {
    0
}
