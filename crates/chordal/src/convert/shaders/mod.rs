//! The parts of `field_to_shader`: the walk through the terms, and the printers of a language.
pub mod glsl;
pub mod glsl_helpers;
pub mod statements;
