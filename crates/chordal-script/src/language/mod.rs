//! The language of shape scripts: its values, functions and operators, independent of syntax.
//!
//! Starlark and Python both translate into this and compute nothing themselves, so that one text means one
//! shape in both.
mod bind;
mod combine;
mod formula;
mod materials;
mod paths;
mod script_path;
mod solids;
mod sweep;
mod transforms;

use chordal::implicit::{Expr, Field};
use std::fmt;
use std::sync::Arc;

pub use bind::{BoundArgs, Function, FunctionParameter, ParameterDefault, ParameterKind};
pub(crate) use bind::{defaulting, optional, required, usage, variadic};
pub use formula::operate;
pub use script_path::ScriptPath;

/// A value that functions of the language take and return.
#[derive(Clone, Debug)]
pub enum Arg {
    /// A number.
    Number(f64),
    /// A string, as in the name of a parameter.
    Text(String),
    /// True or False.
    Truth(bool),
    /// Python's None.
    Nothing,
    /// A list or a tuple.
    List(Vec<Arg>),
    /// A path, 2D or 3D.
    Path(Arc<ScriptPath>),
    /// A shape.
    Shape(Solid),
    /// An expression in x, y and z.
    Formula(Formula),
    /// A value that no function takes, by the name of its type in the host language.
    Other(String),
}

/// A shape with its cost.
#[derive(Clone, Debug)]
pub struct Solid {
    /// The shape.
    pub field: Field,
    /// An upper bound of the number of terms of its expression, with shared ones counted at each use.
    pub(crate) weight: u64,
    /// The number of these that the last step added.
    pub(crate) step_weight: u64,
}

/// An expression with its cost.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The expression.
    pub expr: Expr,
    weight: u64,
}

impl Arg {
    /// The coordinates, by name.
    #[must_use]
    pub fn axes() -> [(&'static str, Self); 3] {
        let axes = Expr::axes().map(|expr| Self::Formula(Formula { expr, weight: 1 }));
        let [x, y, z] = axes;
        [("x", x), ("y", y), ("z", z)]
    }

    /// Wraps a shape that is no result of this language.
    #[must_use]
    pub fn shape(field: Field) -> Self {
        Self::Shape(Solid { field, weight: 1, step_weight: 1 })
    }

    /// Wraps a path.
    #[must_use]
    pub fn path(path: ScriptPath) -> Self {
        Self::Path(Arc::new(path))
    }

    /// Its kind, for an error.
    #[must_use]
    pub fn kind(&self) -> &str {
        match self {
            Self::Number(_) => "a number",
            Self::Text(_) => "a string",
            Self::Truth(_) => "a boolean",
            Self::Nothing => "None",
            Self::List(_) => "a list",
            Self::Path(_) => "a path",
            Self::Shape(_) => "a shape",
            Self::Formula(_) => "a formula",
            Self::Other(kind) => kind,
        }
    }

    /// Its kind, for an error where a shape is needed.
    pub(crate) fn instead_of_shape(&self) -> &str {
        match self {
            Self::Nothing => NOTHING_GIVEN,
            other => other.kind(),
        }
    }

    /// An upper bound of the number of terms of the expression.
    pub(crate) fn weight(&self) -> u64 {
        match self {
            Self::Shape(solid) => solid.weight,
            Self::Formula(formula) => formula.weight,
            Self::Path(path) => path.n_pieces() as u64,
            _ => 0,
        }
    }

    /// The number of terms that the last step added.
    pub(crate) fn step_weight(&self) -> u64 {
        match self {
            Self::Shape(solid) => solid.step_weight,
            Self::Formula(_) => 1,
            Self::Path(path) => path.n_pieces() as u64,
            _ => 0,
        }
    }
}

/// The kind of None, in an error where a shape is needed.
pub(crate) const NOTHING_GIVEN: &str = "None, which is the result of a function without 'return'";

/// An error in a call, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallError(pub String);

impl fmt::Display for CallError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for CallError {}

/// The groups of functions, in the order of a reference page.
#[must_use]
pub fn groups() -> [(&'static str, &'static [Function]); 8] {
    [
        ("Solids", solids::SOLIDS),
        ("2D shapes", solids::FLAT),
        ("Paths", paths::PATHS),
        ("Combining", combine::COMBINE),
        ("Placing", transforms::PLACE),
        ("Changing", transforms::CHANGE),
        ("Materials", materials::MATERIALS),
        ("Formulas", formula::FORMULAS),
    ]
}

/// Every function.
pub fn functions() -> impl Iterator<Item = &'static Function> {
    groups().into_iter().flat_map(|(_, functions)| functions)
}

/// Looks a function up by name.
#[must_use]
pub fn function(name: &str) -> Option<&'static Function> {
    functions().find(|function| function.name == name)
}
