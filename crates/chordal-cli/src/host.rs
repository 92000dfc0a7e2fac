//! The number of this process; a module in a browser has none.

/// The process id, which keeps temporary names of concurrent processes apart.
#[cfg(not(target_family = "wasm"))]
pub fn process_number() -> u32 {
    std::process::id()
}

/// No other process writes beside a module in a browser.
#[cfg(target_family = "wasm")]
pub fn process_number() -> u32 {
    0
}
