//! The gates: what a machine can see of ARCHITECTURE.md and STYLE.md in the sources. A program of its own, so
//! that it is built in seconds.
#[path = "../circles.rs"]
mod circles;
#[path = "../crates.rs"]
mod crates;
#[path = "../determinism.rs"]
mod determinism;
#[path = "mod.rs"]
mod gates;
#[path = "../layers.rs"]
mod layers;
#[path = "../names.rs"]
mod names;
#[path = "../options.rs"]
mod options;
#[path = "../public_items.rs"]
mod public_items;
#[path = "../test_programs.rs"]
mod test_programs;
#[path = "../tidy.rs"]
mod tidy;
