//! Shape scripts: runs a few lines of Starlark, Python's syntax in a sandbox, and returns a field.
//!
//! The value of the last expression is the shape, or a dictionary or list of shapes. Scripts have no clock
//! and no randomness; the only files that they can read are those that the caller opens for them
//! ([`ScriptFiles`]). [`Limits`] bound their time and memory, and every failure is one [`ScriptError`] with
//! line and column.
//!
//! ```
//! use chordal_script::{RunOptions, run};
//! let script = run("r = param('r', 0.4)\nbox(2, 2, 1) - cylinder(r, 2)\n", &RunOptions::default(), &Default::default())?;
//! let mut values = [0.0; 2];
//! script.field.tape().at(&[[0.0; 3], [0.75, 0.0, 0.0]], &mut values)?;
//! assert_eq!(values, [0.4, -0.25]);
//! assert_eq!((script.parameters[0].name.as_str(), script.parameters[0].value), ("r", 0.4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod advice;
mod builtins;
mod compare;
mod error;
mod files;
mod grammar;
pub mod language;
mod library;
mod limits;
mod meter;
mod nesting;
mod operators;
mod other_tools;
mod parameter;
mod parentheses;
mod script;
mod script_source;
mod texts;
mod values;
mod warning;
pub mod words;

pub use error::ScriptError;
pub use files::{FileUse, FontText, NoFiles, OpenedFile, ScriptFiles};
pub use limits::Limits;
pub use parameter::Parameter;
pub use script::{RunOptions, Script, ScriptBody, ScriptStep, run, run_with};
pub use warning::ScriptWarning;
