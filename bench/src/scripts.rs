//! Fields that scripts and op lists say, and the op lists of fields, for a peer that reads nothing else.
use crate::models;
use chordal::Job;
use chordal::implicit::Field;
use chordal::implicit::evaluation::{Binary, ExprGraph, Term, Unary};
use chordal::math::Box3;
use std::fmt::Write;
use std::path::Path;

/// Half the side of the box around the origin that holds all models without a box of their own.
pub const HALF: f64 = 1.25;

/// How much wider than its box the cube around a script's field is.
const ROOM: f64 = 1.02;

/// A field, and its op list where it can be written as one.
#[derive(Clone, Debug)]
pub struct Model {
    /// The field, within its box.
    pub field: Field,
    /// What fidget reads.
    pub text: Option<String>,
    /// The cube that it is meshed and measured in: its middle, and half of its side.
    pub cube: ([f64; 3], f64),
}

impl Model {
    /// A model of the bench by its name, or a file: a script (`.star`) or an op list (`.vm`).
    ///
    /// # Panics
    /// When there is no such model.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let text = match name {
            "ball" => models::ball(),
            "torus" => models::torus(),
            "cube-ball" => models::cube_without_ball(),
            "csg6" => models::csg(6),
            "gyroid-ball" => models::gyroid_in_ball(),
            "blobs" => models::blobs(),
            path => return Self::read(Path::new(path)),
        };
        Self::of_text(text)
    }

    fn of_text(text: String) -> Self {
        let whole = Box3 { min: [-HALF; 3], max: [HALF; 3] };
        let field = Field::new(models::expression(&text)).with_bounds(whole);
        Self { field, text: Some(text), cube: ([0.0; 3], HALF) }
    }

    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap_or_else(|_| panic!("no model {}", path.display()));
        if path.extension().is_some_and(|e| e == "vm") {
            return Self::of_text(text);
        }
        let options = chordal_script::RunOptions::default();
        let script = chordal_script::run(&text, &options, &Job::default()).expect("a script");
        let text = op_list(&script.field);
        let Box3 { min, max } = script.field.bounds();
        let half = (0..3).map(|k| 0.5 * (max[k] - min[k])).fold(0.0, f64::max);
        assert!(half.is_finite(), "a model without end");
        let cube = ([0, 1, 2].map(|k| 0.5 * (min[k] + max[k])), ROOM * half);
        Self { field: script.field, text, cube }
    }
}

/// The sign of a field as an op list; nothing where a leaf takes part of which fidget knows nothing.
#[must_use]
pub fn op_list(field: &Field) -> Option<String> {
    let mut text = String::new();
    // Names of terms; a term may take several lines, whose last is the value.
    let mut lines = 0;
    let mut line = |words: &str| {
        lines += 1;
        writeln!(text, "_{lines:x} {words}").expect("a string takes it");
        format!("_{lines:x}")
    };
    let mut names: Vec<String> = Vec::new();
    for term in ExprGraph::from_expr(field.sign()).terms() {
        let name = |k: u32| names[k as usize].clone();
        let made = match term {
            Term::Const(value) => line(&format!("const {value}")),
            Term::Axis(k) => line(["var-x", "var-y", "var-z"][usize::from(*k)]),
            Term::Unary(Unary::Recip, a) => {
                let one = line("const 1");
                line(&format!("div {one} {}", name(*a)))
            }
            Term::Unary(op, a) => {
                let (_, word) = Unary::ALL.iter().find(|(known, _)| known == op)?;
                line(&format!("{word} {}", name(*a)))
            }
            Term::Binary(Binary::SmoothMin, a, b) => {
                // min(a, b) − max(1 − |a − b|, 0)² / 4.
                let (a, b) = (name(*a), name(*b));
                let least = line(&format!("min {a} {b}"));
                let apart = line(&format!("sub {a} {b}"));
                let apart = line(&format!("abs {apart}"));
                let one = line("const 1");
                let near = line(&format!("sub {one} {apart}"));
                let zero = line("const 0");
                let near = line(&format!("max {near} {zero}"));
                let near = line(&format!("square {near}"));
                let quarter = line("const 0.25");
                let bulge = line(&format!("mul {near} {quarter}"));
                line(&format!("sub {least} {bulge}"))
            }
            Term::Binary(op, a, b) => {
                let (_, word) = Binary::ALL.iter().find(|(known, _)| known == op)?;
                line(&format!("{word} {} {}", name(*a), name(*b)))
            }
            // The distance from the axis is a leaf where a profile is revolved.
            Term::Leaf(leaf, [x, y, _]) if format!("{leaf:?}") == "Radius" => {
                let squares = [line(&format!("square {}", name(*x))), line(&format!("square {}", name(*y)))];
                let sum = line(&format!("add {} {}", squares[0], squares[1]));
                line(&format!("sqrt {sum}"))
            }
            Term::Leaf(..) => return None,
        };
        names.push(made);
    }
    Some(text)
}
