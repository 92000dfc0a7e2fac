//! `run`: evaluates a script to the field of its last expression.
use crate::Parameter;
use crate::advice::{POWERS, why_nothing};
use crate::builtins::builtins;
use crate::files::{FileError, MAIN, NoFiles, ScriptFiles};
use crate::grammar::Program;
use crate::language::{Arg, CallError, NOTHING_GIVEN, functions};
use crate::library::Library;
use crate::meter::{LimitError, Meter};
use crate::operators::{OPERATORS, StarlarkOperator};
use crate::script_source::ScriptSource;
use crate::values::{StarlarkFunction, StarlarkShape, arg_of, elements};
use crate::{Limits, ScriptError, ScriptWarning};
use chordal::Job;
use chordal::implicit::Field;
use starlark::ErrorKind;
use starlark::environment::{FrozenModule, Globals, GlobalsBuilder, Module};
use starlark::eval::{BeforeStmtFunc, BeforeStmtFuncDyn, Evaluator, FileLoader};
use starlark::values::dict::DictRef;
use starlark::values::none::NoneType;
use starlark::values::{Value, ValueLike};
use std::collections::BTreeMap;

/// Options of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Parameter values, by name.
    pub set: BTreeMap<String, f64>,
    /// The resource limits.
    pub limits: Limits,
}

/// One of several shapes of a script.
#[derive(Clone, Debug)]
pub struct ScriptBody {
    /// Its name.
    pub name: String,
    /// The shape.
    pub field: Field,
}

/// A shape that a call in a script returned: the final shape, or an intermediate one.
#[derive(Clone, Debug)]
pub struct ScriptStep {
    /// The number of the line, from 1.
    pub line: u64,
    /// The shape that the call returned.
    pub field: Field,
}

/// The result of a script.
#[derive(Clone, Debug)]
pub struct Script {
    /// The value of its last expression; the union of several shapes.
    pub field: Field,
    /// The shapes of a dictionary, by their names, or of a list, which are numbered from 1. Empty for a
    /// single shape.
    pub bodies: Vec<ScriptBody>,
    /// Its parameters, in the order in which it reads them.
    pub parameters: Vec<Parameter>,
    /// Likely mistakes, in the order of the text.
    pub warnings: Vec<ScriptWarning>,
    /// Notes about its shapes and files, then the lines that it prints.
    pub said: Vec<String>,
    /// The shapes that its calls returned, in the order of evaluation: the first few thousand.
    pub steps: Vec<ScriptStep>,
}

/// Runs a script without access to files; otherwise as [`run_with`].
///
/// # Errors
/// As for [`run_with`]; also when it names a file.
pub fn run(text: &str, options: &RunOptions, job: &Job) -> Result<Script, ScriptError> {
    run_with(text, options, &NoFiles, job)
}

/// Runs a script and returns the field of its last expression, with its parameters.
///
/// Cost: at most what [`Limits`] allow, for each file that it loads; a shape of some hundred parts takes a
/// millisecond.
///
/// # Errors
/// When the text is not a valid script, exceeds a limit, or ends without a shape; when a parameter is set
/// that the script does not have; when a file cannot be opened, or files load each other in a cycle; when the
/// job is cancelled.
pub fn run_with(
    text: &str,
    options: &RunOptions,
    files: &dyn ScriptFiles,
    job: &Job,
) -> Result<Script, ScriptError> {
    let library = Library::new(text, &options.limits, (files, job))?;
    if job.is_cancelled() {
        return Err(cancelled());
    }
    let meter = Meter::new((options.limits, options.set.clone()), (files, job), library.n_cuts);
    let (evaluated, cuts) = evaluate(library, &meter, job)?;
    script_of(evaluated, cuts, meter, options)
}

/// The shapes of a script's value.
struct Evaluated {
    field: Field,
    bodies: Vec<ScriptBody>,
}

/// The cuts (`b - c` in `a | b - c`) of the main script, as offsets with their numbers; and its source.
type CutPlaces = (Vec<(usize, usize)>, ScriptSource);

/// Evaluates all files of a library, the main script last.
fn evaluate(library: Library, meter: &Meter, job: &Job) -> Result<(Evaluated, CutPlaces), ScriptError> {
    let globals = globals();
    let mut loaded = LoadedModules::default();
    let (mut sources, mut first_cut) = (Vec::new(), 0);
    for (name, Program { module, source, cuts }) in library.programs {
        sources.push((name.clone(), source));
        let numbered_cuts: Vec<(usize, usize)> =
            cuts.iter().enumerate().map(|(k, offset)| (*offset, first_cut + k)).collect();
        first_cut += cuts.len();
        // `Err` is the value of the main script, which no file loads and which is therefore not frozen.
        let outcome = Module::with_temp_heap(|environment| {
            let value = {
                let mut eval = Evaluator::new(&environment);
                let limits = &meter.limits;
                let limited = (|| {
                    eval.set_max_callstack_size(limits.calls)?;
                    eval.set_max_tick_count(limits.ticks)?;
                    eval.set_max_heap_size(limits.heap)
                })();
                limited.map_err(|error| ScriptError::new("script-limit", error.to_string()))?;
                eval.disable_gc();
                eval.set_check_cancelled(Box::new(|| job.is_cancelled()));
                eval.before_stmt_for_dap(BeforeStmtFunc::Dyn(Box::new(StatementHook)));
                eval.set_loader(&loaded);
                eval.extra = Some(meter);
                eval.eval_module(module, &globals)
                    .map_err(|error| translated(&sources, &error, limits, job))?
            };
            if name == MAIN {
                let text =
                    sources.last().map_or("", |(_, source): &(String, ScriptSource)| source.text.as_str());
                return Ok(Err(value_of(value, text, &meter.limits)?));
            }
            let module = environment.freeze();
            module.map(Ok).map_err(|error| ScriptError::new("script-value", format!("{name}: {error:?}")))
        })?;
        match outcome {
            Ok(module) => {
                loaded.0.insert(name, module);
            }
            Err(evaluated) => {
                let (_, source) = sources.pop().unwrap_or_else(|| unreachable!("it was just added"));
                return Ok((evaluated, (numbered_cuts, source)));
            }
        }
    }
    unreachable!("the script itself is the last")
}

fn script_of(
    evaluated: Evaluated,
    (cuts, source): CutPlaces,
    meter: Meter,
    options: &RunOptions,
) -> Result<Script, ScriptError> {
    let parameters = meter.parameters.into_inner();
    let is_parameter = |name: &str| parameters.iter().any(|parameter| parameter.name == name);
    if let Some(name) = options.set.keys().find(|name| !is_parameter(name)) {
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let hint =
            if names.is_empty() { "it has none".to_owned() } else { format!("it has {}", names.join(", ")) };
        let message = format!("the script has no parameter '{name}'; {hint}");
        return Err(ScriptError::new("unknown-parameter", message));
    }
    // `a | b - c` is a likely mistake only if the operands were shapes, which the meter has recorded.
    let is_shape = meter.cuts.into_inner();
    let mut cuts: Vec<usize> =
        cuts.into_iter().filter_map(|(offset, number)| is_shape[number].then_some(offset)).collect();
    cuts.sort_unstable();
    let places = source.lines_and_columns(&cuts);
    let mut warnings: Vec<ScriptWarning> = places.into_iter().map(ScriptWarning::last_operand_cut).collect();
    let mut bounded = meter.bounded.into_inner();
    bounded.sort_unstable();
    bounded.dedup();
    let offsets: Vec<usize> = bounded.into_iter().map(|offset| source.place(offset)).collect();
    warnings
        .extend(source.lines_and_columns(&offsets).into_iter().map(ScriptWarning::bound_taken_as_distance));
    warnings.sort_by_key(|warning| warning.place);
    let steps = steps_by_line(meter.steps.into_inner(), &source);
    let said = meter.notes.into_inner().into_iter().chain(meter.printed.into_inner()).collect();
    let Evaluated { field, bodies } = evaluated;
    Ok(Script { field, bodies, parameters, warnings, said, steps })
}

/// Replaces the offsets of shapes in the parsed text by lines of the script.
fn steps_by_line(steps: Vec<(usize, Field)>, source: &ScriptSource) -> Vec<ScriptStep> {
    let offsets: Vec<usize> = steps.iter().map(|(offset, _)| source.place(*offset)).collect();
    // The lines are counted in one pass over the text, for which offsets have to be in order.
    let mut in_order_of_text = offsets.clone();
    in_order_of_text.sort_unstable();
    in_order_of_text.dedup();
    let lines = source.lines_and_columns(&in_order_of_text);
    let line_of = |offset: usize| in_order_of_text.binary_search(&offset).map_or(0, |at| lines[at].0);
    let with_line = |(offset, (_, field))| ScriptStep { line: line_of(offset), field };
    offsets.iter().copied().zip(steps).map(with_line).collect()
}

/// The modules of the files that were evaluated, by name.
#[derive(Default)]
struct LoadedModules(BTreeMap<String, FrozenModule>);

impl FileLoader for LoadedModules {
    fn load(&self, path: &str) -> starlark::Result<FrozenModule> {
        let unknown = || starlark::Error::new_other(CallError(format!("'{path}' was not loaded")));
        self.0.get(path).cloned().ok_or_else(unknown)
    }
}

/// Checks the limits between statements.
struct StatementHook;

impl<'e> BeforeStmtFuncDyn<'e> for StatementHook {
    fn call<'v>(
        &mut self,
        _span: starlark::codemap::FileSpanRef,
        _continued: bool,
        eval: &mut Evaluator<'v, '_, 'e>,
    ) -> starlark::Result<()> {
        Meter::check_heap(eval)
    }
}

/// Every global name of a script, and the operators.
pub(crate) fn globals() -> Globals {
    let mut globals = GlobalsBuilder::new().with(builtins);
    for function in functions() {
        globals.set(function.name, StarlarkFunction(function));
    }
    for (name, axis) in Arg::axes() {
        globals.set(name, StarlarkShape(axis));
    }
    globals.set("True", true);
    globals.set("False", false);
    globals.set("None", NoneType);
    for operator in OPERATORS {
        globals.set(operator, StarlarkOperator(operator));
    }
    globals.build()
}

/// The most shapes that one script may return. Chosen: more than the parts of a hand-written assembly; larger
/// values let a short script ask for more meshes than anybody waits for.
const MOST_BODIES: usize = 1000;

/// The shape of a value, or those of a dictionary or list.
fn value_of(value: Value, text: &str, limits: &Limits) -> Result<Evaluated, ScriptError> {
    if value.is_none() {
        let message = format!("the script's value must be a shape, but it is None: {}", why_nothing(text));
        return Err(ScriptError::new("script-value", message));
    }
    let named: Vec<(String, Value)> = match (DictRef::from_value(value), elements(value)) {
        (Some(entries), _) => entries
            .iter()
            .map(|(name, shape)| (name.unpack_str().map_or_else(|| name.to_str(), str::to_owned), shape))
            .collect(),
        (None, Some(list)) => {
            list.iter().enumerate().map(|(k, shape)| (format!("part {}", k + 1), *shape)).collect()
        }
        _ => return Ok(Evaluated { field: field_of(value, limits)?, bodies: Vec::new() }),
    };
    let wrong = |message: String| Err(ScriptError::new("script-value", message));
    if named.is_empty() || named.len() > MOST_BODIES {
        return wrong(format!(
            "the script's value has {} shapes, but must have 1 to {MOST_BODIES}",
            named.len()
        ));
    }
    let (mut bodies, mut weight) = (Vec::new(), 0_u64);
    for (name, shape) in named {
        let is_plain = !name.is_empty() && name.len() <= 100 && !name.chars().any(char::is_control);
        if !is_plain {
            return wrong(
                "the name of a shape must have 1 to 100 characters, without control characters".to_owned(),
            );
        }
        let field = field_of(shape, limits)
            .map_err(|error| ScriptError { message: format!("{name}: {}", error.message), ..error })?;
        // Each shape may be within the limit and all of them together beyond it.
        weight = weight.saturating_add(arg_of(shape).weight());
        bodies.push(ScriptBody { name, field });
    }
    if weight > limits.terms {
        let message = format!("the shapes together have more than {} terms", limits.terms);
        return Err(ScriptError::new("script-limit", message));
    }
    let fields: Vec<Field> = bodies.iter().map(|body| body.field.clone()).collect();
    Ok(Evaluated { field: Field::union_of(&fields), bodies })
}

fn field_of(value: Value, limits: &Limits) -> Result<Field, ScriptError> {
    let other;
    let hint = match value.downcast_ref::<StarlarkShape>() {
        Some(StarlarkShape(Arg::Shape(solid))) if solid.weight > limits.terms => {
            let message = format!("the shape has more than {} terms", limits.terms);
            return Err(ScriptError::new("script-limit", message));
        }
        Some(StarlarkShape(Arg::Shape(solid))) => return Ok(solid.field.clone()),
        Some(StarlarkShape(Arg::Path(_))) => "a path: fill it with polygon(), or follow it with sweep()",
        Some(_) => "a formula: turn it into a shape with field()",
        None if value.is_none() => NOTHING_GIVEN,
        None if elements(value).is_some() => "a list of lists: combine the shapes of each with union()",
        None => {
            other = arg_of(value);
            other.kind()
        }
    };
    Err(ScriptError::new("script-value", format!("the script's value must be a shape, but it is {hint}")))
}

fn cancelled() -> ScriptError {
    ScriptError::new("cancelled", "cancelled")
}

fn translated(
    sources: &[(String, ScriptSource)],
    error: &starlark::Error,
    limits: &Limits,
    job: &Job,
) -> ScriptError {
    let file = error.span().map(|span| span.file.filename().to_owned());
    // An error without a span belongs to the file that is being evaluated, which is the last one.
    let is_origin = |(name, _): &&(String, ScriptSource)| file.as_ref().is_some_and(|file| file == name);
    let origin = sources.iter().find(is_origin).or(sources.last());
    let Some((name, source)) = origin else { return ScriptError::new("script-error", error.to_string()) };
    translated_in(source, error, limits, job).of_file(name)
}

fn translated_in(source: &ScriptSource, error: &starlark::Error, limits: &Limits, job: &Job) -> ScriptError {
    // First, since a cancelled evaluation fails with an error like any other.
    if job.is_cancelled() {
        return cancelled();
    }
    // The interpreter has no error kinds for its own limits: they are known by their text.
    let message = error.without_diagnostic().to_string();
    let limit = match error.kind() {
        ErrorKind::Other(cause) if cause.is::<LimitError>() => None,
        ErrorKind::Other(cause) if cause.is::<FileError>() => {
            return source.translate_error("script-file", error);
        }
        ErrorKind::Other(cause) if cause.is::<CallError>() => {
            return source.translate_error("script-error", error);
        }
        _ if message.contains("call stack overflow") || message.contains("recursion") => {
            Some(format!("the call stack is deeper than {} functions", limits.calls))
        }
        _ if message.starts_with("Execution duration limit") => {
            Some(format!("the script takes more than {} calls and loop iterations", limits.ticks))
        }
        _ if message.starts_with("Heap memory limit") => {
            Some(format!("the script's values take more than {} bytes of memory", limits.heap))
        }
        _ if message.contains("`pow` not found") => {
            let translation = source.translate_error("script-error", error);
            return ScriptError { message: format!("there is no pow(): {POWERS}"), ..translation };
        }
        _ => return source.translate_error("script-error", error),
    };
    let translation = source.translate_error("script-limit", error);
    ScriptError { message: limit.unwrap_or(translation.message), ..translation }
}
