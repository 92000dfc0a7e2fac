//! `Function`: one function of the language, and how it binds its arguments.
use super::{Arg, CallError, Formula, ScriptPath, Solid};
use chordal::Job;
use chordal::implicit::evaluation::ExprGraph;
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{DistanceQuality, Expr, Field};
use chordal::math::{greater, lesser};
use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

/// One function of the language.
#[derive(Debug)]
pub struct Function {
    /// Its name.
    pub name: &'static str,
    /// Its parameters, in order.
    pub parameters: &'static [FunctionParameter],
    /// Its result, in a sentence or two.
    pub about: &'static str,
    /// How far the result's value can be trusted as a distance; empty if the result is not a shape.
    pub distance: &'static str,
    pub(super) make: fn(&BoundArgs) -> Result<Arg, CallError>,
}

/// A parameter of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionParameter {
    /// Its name.
    pub name: &'static str,
    /// Its default value; `None` if it is required.
    pub default: Option<ParameterDefault>,
    /// Whether it takes any number of arguments.
    pub rest: bool,
    /// What it takes.
    pub kind: ParameterKind,
}

/// What a parameter takes, for hosts that declare the types of parameters. The function judges its arguments
/// itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// A number.
    Number,
    /// A list of numbers.
    Numbers,
    /// A text.
    Text,
    /// True or False.
    Truth,
    /// A point or a direction: two numbers in the plane, three in space.
    Vector,
    /// A list of points.
    Points,
    /// A path, or the corners of a polyline or polygon.
    Path,
    /// A shape. If there may be any number of them, also a list of shapes.
    Shape,
    /// A list of shapes.
    Shapes,
    /// A list of points, a shape, or a list of shapes.
    PointsOrShapes,
    /// A 2D shape or a number.
    ShapeOrNumber,
    /// A formula or a number.
    Formula,
    /// A colour: a text, or a list of numbers.
    Color,
    /// Any value.
    Any,
}

impl FunctionParameter {
    /// The same parameter for values of another kind.
    pub(crate) const fn of(self, kind: ParameterKind) -> Self {
        Self { kind, ..self }
    }
}

/// The shape that a function changes or places.
pub(super) const SHAPE: FunctionParameter = required("shape").of(ParameterKind::Shape);

/// The default value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterDefault {
    /// A number.
    Number(f64),
    /// A text.
    Text(&'static str),
    /// False.
    False,
    /// Nothing at all: Python's None.
    Nothing,
}

impl ParameterDefault {
    fn arg(self) -> Arg {
        match self {
            Self::Number(value) => Arg::Number(value),
            Self::Text(text) => Arg::Text(text.to_owned()),
            Self::False => Arg::Truth(false),
            Self::Nothing => Arg::Nothing,
        }
    }
}

impl fmt::Display for ParameterDefault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(text) => write!(f, "\"{text}\""),
            Self::False => f.write_str("False"),
            Self::Nothing => f.write_str("None"),
        }
    }
}

/// A required number.
pub(crate) const fn required(name: &'static str) -> FunctionParameter {
    FunctionParameter { name, default: None, rest: false, kind: ParameterKind::Number }
}

/// An optional number.
pub(crate) const fn optional(name: &'static str, default: f64) -> FunctionParameter {
    defaulting(name, ParameterDefault::Number(default))
}

/// An optional number with a default of any kind.
pub(crate) const fn defaulting(name: &'static str, default: ParameterDefault) -> FunctionParameter {
    FunctionParameter { default: Some(default), ..required(name) }
}

/// Any number of numbers.
pub(crate) const fn variadic(name: &'static str) -> FunctionParameter {
    FunctionParameter { rest: true, ..required(name) }
}

/// The signature of a function of this name.
pub(crate) fn usage(name: &str, parameters: &[FunctionParameter]) -> String {
    let shown = parameters.iter().map(|p| match (p.rest, p.default) {
        (true, _) => format!("*{}", p.name),
        (false, None) => p.name.to_owned(),
        (false, Some(default)) => format!("{}={default}", p.name),
    });
    format!("{name}({})", shown.collect::<Vec<_>>().join(", "))
}

/// The arguments of a call, bound to parameters.
#[derive(Debug)]
pub struct BoundArgs {
    function: &'static Function,
    args: Vec<Arg>,
    rest: Vec<Arg>,
    /// The limits and the cancellation of long operations.
    job: Job,
    /// Notes about the result, in sentences.
    notes: RefCell<Vec<String>>,
}

impl Function {
    /// Calls it with positional and named arguments.
    ///
    /// # Errors
    /// When an argument is missing, unknown, given twice or of the wrong kind, or when there is no such
    /// shape.
    pub fn call(&'static self, by_position: Vec<Arg>, by_name: Vec<(String, Arg)>) -> Result<Arg, CallError> {
        self.call_within(by_position, by_name, &Job::default(), &mut Vec::new())
    }

    /// As [`Function::call`], within the limits of a job. Adds notes about the result, in sentences, that its
    /// bound does not express.
    ///
    /// # Errors
    /// As for [`Function::call`]; also when the work is beyond the limits of the job, or cancelled.
    pub fn call_within(
        &'static self,
        by_position: Vec<Arg>,
        by_name: Vec<(String, Arg)>,
        job: &Job,
        notes: &mut Vec<String>,
    ) -> Result<Arg, CallError> {
        let args = BoundArgs { job: job.clone(), ..self.bind(by_position, by_name)? };
        let result = (self.make)(&args)?;
        notes.append(&mut args.notes.into_inner());
        Ok(result)
    }

    /// Whether these arguments move a surface to a side on which the value is only a lower bound of its
    /// distance.
    pub(crate) fn moves_by_bound(&self, by_position: &[Arg], by_name: &[(String, Arg)]) -> bool {
        let arg = |k: usize| {
            let name = self.parameters.get(k).map(|p| p.name);
            by_position
                .get(k)
                .or_else(|| by_name.iter().find(|(n, _)| Some(&**n) == name).map(|(_, arg)| arg))
        };
        // A bevel or rounded edges take their depth from the shape's value, too.
        let is_number = |k: &usize| matches!(arg(*k), Some(Arg::Number(by)) if *by != 0.0);
        let k = if self.name == "extrude" { [2, 3].into_iter().find(is_number) } else { Some(1) };
        let (Some(Arg::Shape(solid)), Some(Arg::Number(by))) = (arg(0), k.and_then(arg)) else {
            return false;
        };
        let distance = solid.field.distance();
        // A union or intersection of exact distances stays exact on one side only, which is easily
        // overlooked. A bound on both sides is taken for intended.
        let is_bound = |side: DistanceQuality, opposite: DistanceQuality| {
            side == DistanceQuality::Bound && opposite == DistanceQuality::Exact
        };
        let (outside, inside) = (distance.outside, distance.inside);
        match self.name {
            "offset" if *by > 0.0 => is_bound(outside, inside),
            "offset" => is_bound(inside, outside),
            "extrude" => *by > 0.0 && is_bound(inside, outside),
            "shell" => is_bound(outside, inside) || is_bound(inside, outside),
            _ => false,
        }
    }

    fn bind(
        &'static self,
        by_position: Vec<Arg>,
        by_name: Vec<(String, Arg)>,
    ) -> Result<BoundArgs, CallError> {
        // Parameters after the variadic one are given by name alone.
        let takes_rest = self.parameters.iter().any(|p| p.rest);
        let n_positional = self.parameters.iter().take_while(|p| !p.rest).count();
        let n_given = by_position.len();
        let mut rest = by_position;
        // What is left in `rest` belongs to the variadic parameter.
        let mut args: Vec<Option<Arg>> = rest.drain(..n_positional.min(n_given)).map(Some).collect();
        args.resize(self.single().count(), None);
        if !rest.is_empty() && !takes_rest {
            let plural = if n_positional == 1 { "" } else { "s" };
            let message = format!("takes {n_positional} argument{plural}, but {n_given} were given");
            return Err(self.fault(message + &self.called_as()));
        }
        for (name, arg) in by_name {
            let Some(k) = self.single().position(|p| p.name == name) else {
                let shown: String = name.chars().take(40).collect();
                return Err(self.fault(format!("has no argument '{shown}'{}", self.called_as())));
            };
            if args[k].replace(arg).is_some() {
                return Err(self.fault(format!("got '{name}' twice{}", self.called_as())));
            }
        }
        let bound = args.into_iter().zip(self.single()).map(|(arg, p)| {
            arg.or(p.default.map(ParameterDefault::arg))
                .ok_or_else(|| self.fault(format!("needs '{}'{}", p.name, self.called_as())))
        });
        let (args, job, notes) = (bound.collect::<Result<_, _>>()?, Job::default(), RefCell::default());
        Ok(BoundArgs { function: self, args, rest, job, notes })
    }

    /// A hint with the signature, as in `: call it as rotate(shape, axis, degrees)`.
    fn called_as(&self) -> String {
        format!(": call it as {}", usage(self.name, self.parameters))
    }

    /// The parameters that take one argument.
    fn single(&self) -> impl Iterator<Item = &'static FunctionParameter> + use<> {
        self.parameters.iter().filter(|p| !p.rest)
    }

    fn fault(&self, predicate: String) -> CallError {
        CallError(format!("{}() {predicate}", self.name))
    }

    /// Its signature, as in `gyroid(period, level=0)`.
    #[must_use]
    pub fn usage(&self) -> String {
        usage(self.name, self.parameters)
    }
}

impl BoundArgs {
    /// The limits and the cancellation of long operations.
    pub(super) fn job(&self) -> &Job {
        &self.job
    }

    /// Adds a note about the result, in a sentence.
    pub(super) fn note(&self, sentence: &str) {
        self.notes.borrow_mut().push(format!("{}(): {sentence}", self.function.name));
    }

    /// The truth value at index `k`.
    pub(super) fn truth(&self, k: usize) -> Result<bool, CallError> {
        match &self.args[k] {
            Arg::Truth(truth) => Ok(*truth),
            other => Err(self.wrong(k, "True or False", other.kind())),
        }
    }

    /// The argument at index `k`, unless it is Python's None.
    pub(super) fn argument(&self, k: usize) -> Option<&Arg> {
        Some(&self.args[k]).filter(|arg| !matches!(arg, Arg::Nothing))
    }

    /// The numbers of the list at index `k`.
    pub(super) fn number_list(&self, k: usize) -> Result<Vec<f64>, CallError> {
        let Arg::List(list) = &self.args[k] else {
            return Err(self.wrong(k, "a list of numbers", self.args[k].kind()));
        };
        let number = |arg: &Arg| match arg {
            Arg::Number(value) => Ok(*value),
            other => Err(self.wrong(k, "a list of numbers", &format!("one with {}", other.kind()))),
        };
        list.iter().map(number).collect()
    }

    /// The path at index `k`.
    pub(super) fn path(&self, k: usize) -> Result<Arc<ScriptPath>, CallError> {
        match &self.args[k] {
            Arg::Path(path) => Ok(Arc::clone(path)),
            other => Err(self.wrong(k, "a path", other.kind())),
        }
    }

    /// The dimension of the points at index `k`, 2 or 3, by the first of them.
    pub(super) fn width(&self, k: usize) -> Result<usize, CallError> {
        let Arg::List(points) = &self.args[k] else {
            return Err(self.wrong(k, "a list of points", self.args[k].kind()));
        };
        match points.first() {
            Some(Arg::List(first)) if matches!(first.len(), 2 | 3) => Ok(first.len()),
            Some(Arg::List(first)) => {
                Err(self.wrong(k, "points of 2 or 3 numbers", &first.len().to_string()))
            }
            Some(other) => Err(self.wrong(k, "points of 2 or 3 numbers", other.kind())),
            None => Err(self.wrong(k, "points of 2 or 3 numbers", "an empty list")),
        }
    }

    /// The name of the function.
    pub(super) fn name(&self) -> &'static str {
        self.function.name
    }

    fn wrong(&self, k: usize, expected: &str, found: &str) -> CallError {
        let name = self.function.single().nth(k).map_or("", |p| p.name);
        self.function.fault(format!("needs {expected} for '{name}', not {found}"))
    }

    /// The number at index `k`.
    pub(super) fn number(&self, k: usize) -> Result<f64, CallError> {
        match &self.args[k] {
            Arg::Number(value) => Ok(*value),
            other => Err(self.wrong(k, "a number", other.kind())),
        }
    }

    /// `N` numbers from index `first` on.
    pub(super) fn numbers<const N: usize>(&self, first: usize) -> Result<[f64; N], CallError> {
        let mut numbers = [0.0; N];
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = self.number(first + k)?;
        }
        Ok(numbers)
    }

    /// The whole number at index `k`, not below 0.
    pub(super) fn count(&self, k: usize) -> Result<u32, CallError> {
        let value = self.number(k)?;
        if value >= 0.0 && value <= f64::from(u32::MAX) && value.floor() == value {
            // In range and whole: exact.
            Ok(value as u32)
        } else {
            Err(self.wrong(k, "a whole number of at least 0", &value.to_string()))
        }
    }

    /// The shape at index `k`.
    pub(super) fn shape(&self, k: usize) -> Result<&Solid, CallError> {
        match &self.args[k] {
            Arg::Shape(solid) => Ok(solid),
            other => Err(self.wrong(k, "a shape", other.instead_of_shape())),
        }
    }

    /// Whether there is a shape at index `k`, or a list that begins with one.
    pub(super) fn has_shapes(&self, k: usize) -> bool {
        match &self.args[k] {
            Arg::List(list) => matches!(list.first(), Some(Arg::Shape(_))),
            arg => matches!(arg, Arg::Shape(_)),
        }
    }

    /// All shapes: those before the variadic parameter, and the variadic ones. A list of shapes stands for
    /// its elements.
    pub(super) fn shapes(&self) -> Result<Vec<&Solid>, CallError> {
        let mut solids = Vec::new();
        // Without a variadic parameter, the first argument holds the shapes.
        let n_leading = self.function.parameters.iter().take_while(|p| !p.rest).count();
        let n_leading = if n_leading == self.args.len() { lesser(n_leading, 1) } else { n_leading };
        for arg in self.args[..n_leading].iter().chain(&self.rest) {
            let items = if let Arg::List(items) = arg { items.as_slice() } else { std::slice::from_ref(arg) };
            for item in items {
                match item {
                    Arg::Shape(solid) => solids.push(solid),
                    other => {
                        let predicate = format!("needs shapes, not {}", other.instead_of_shape());
                        return Err(self.function.fault(predicate));
                    }
                }
            }
        }
        Ok(solids)
    }

    /// The expression at index `k`; a number counts as one.
    pub(super) fn formula(&self, k: usize) -> Result<Formula, CallError> {
        match &self.args[k] {
            Arg::Formula(formula) => Ok(formula.clone()),
            Arg::Number(value) => Ok(Formula { expr: Expr::constant(*value), weight: 1 }),
            other => Err(self.wrong(k, "a formula", other.kind())),
        }
    }

    /// The text at index `k`.
    pub(super) fn text(&self, k: usize) -> Result<&str, CallError> {
        match &self.args[k] {
            Arg::Text(text) => Ok(text),
            other => Err(self.wrong(k, "a string", other.kind())),
        }
    }

    /// The argument at index `k`, of any kind.
    pub(super) fn any(&self, k: usize) -> &Arg {
        &self.args[k]
    }

    /// The point at index `k`.
    pub(super) fn point<const D: usize>(&self, k: usize) -> Result<[f64; D], CallError> {
        self.point_of(k, &self.args[k])
    }

    /// The points at index `k`.
    pub(super) fn points<const D: usize>(&self, k: usize) -> Result<Vec<[f64; D]>, CallError> {
        match &self.args[k] {
            Arg::List(points) => points.iter().map(|point| self.point_of(k, point)).collect(),
            other => Err(self.wrong(k, "a list of points", other.kind())),
        }
    }

    fn point_of<const D: usize>(&self, k: usize, arg: &Arg) -> Result<[f64; D], CallError> {
        let wrong = |found: &str| self.wrong(k, &format!("{D} numbers"), found);
        let Arg::List(list) = arg else { return Err(wrong(arg.kind())) };
        let numbers: Vec<f64> =
            list.iter().filter_map(|n| if let Arg::Number(n) = n { Some(*n) } else { None }).collect();
        if numbers.len() != list.len() {
            return Err(wrong("a list with other values"));
        }
        numbers.try_into().map_err(|_| wrong(&format!("{}", list.len())))
    }

    /// The result of a call that built a field from some operands; or an error, if the field is invalid.
    pub(super) fn shape_result(
        &self,
        field: Result<Field, InvalidShape>,
        operands: &[&Solid],
    ) -> Result<Arg, CallError> {
        self.weighted_shape_result(field, operands, 1)
    }

    /// As `shape_result`, for a field in which each operand occurs several times.
    pub(super) fn weighted_shape_result(
        &self,
        field: Result<Field, InvalidShape>,
        operands: &[&Solid],
        times: u64,
    ) -> Result<Arg, CallError> {
        let field = field.map_err(|why| CallError(format!("{}(): {why}", self.function.name)))?;
        // Each item of a list may be a term, as the corners of a polygon; each operand of a union adds two
        // more.
        let n_items = |arg: &Arg| if let Arg::List(list) = arg { list.len() as u64 } else { 0 };
        let step_weight =
            STEP_WEIGHT + self.args.iter().map(n_items).sum::<u64>() + 2 * operands.len() as u64;
        let inner = operands.iter().fold(0, |sum: u64, solid| sum.saturating_add(solid.weight));
        let weight = inner.saturating_mul(times).saturating_add(step_weight);
        Ok(Arg::Shape(Solid { field, weight, step_weight }))
    }
}

/// More terms than any single step adds to those of its operands, as measured in the tests.
const STEP_WEIGHT: u64 = 80;

/// As `BoundArgs::shape_result`, for shapes with blends: the terms that these add are counted.
pub(super) fn counted_result(
    args: &BoundArgs,
    field: Result<Field, InvalidShape>,
    solids: &[&Solid],
) -> Result<Arg, CallError> {
    let n_terms = field.as_ref().map_or(0, n_terms);
    let result = args.shape_result(field, solids)?;
    Ok(match result {
        Arg::Shape(solid) => {
            Arg::Shape(Solid { weight: greater(solid.weight, n_terms), step_weight: n_terms, ..solid })
        }
        other => other,
    })
}

/// The number of terms in the expressions of a field's value and sign.
fn n_terms(field: &Field) -> u64 {
    let count = |expr| ExprGraph::from_expr(expr).terms().len() as u64;
    count(field.expr()).saturating_add(count(field.sign()))
}
