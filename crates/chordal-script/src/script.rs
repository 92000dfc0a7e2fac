//! `run`: evaluates a script to the field of its last expression.
use crate::Parameter;
use crate::builtins::builtins;
use crate::grammar::{Program, parse};
use crate::language::{Arg, CallError, functions};
use crate::meter::{LimitError, Meter};
use crate::operators::{OPERATORS, StarlarkOperator};
use crate::script_source::ScriptSource;
use crate::values::{StarlarkFunction, StarlarkShape};
use crate::{Limits, NoFiles, ScriptError, ScriptWarning, ShapeFiles};
use chordal::Job;
use chordal::implicit::Field;
use starlark::ErrorKind;
use starlark::environment::{Globals, GlobalsBuilder, Module};
use starlark::eval::{BeforeStmtFunc, BeforeStmtFuncDyn, Evaluator};
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

/// The result of a script.
#[derive(Clone, Debug)]
pub struct Script {
    /// The value of its last expression.
    pub field: Field,
    /// Its parameters, in the order in which it reads them.
    pub parameters: Vec<Parameter>,
    /// What it says and is likely not to mean, in the order of its text.
    pub warnings: Vec<ScriptWarning>,
}

/// Runs a script and returns the field of its last expression, with its parameters.
///
/// Cost: at most what [`Limits`] allow; a shape of some hundred parts takes a millisecond.
///
/// # Errors
/// When the text is not a valid script, exceeds a limit, or ends without a shape; when a parameter is set
/// that the script does not have; when the job is cancelled.
pub fn run(text: &str, options: &RunOptions, job: &Job) -> Result<Script, ScriptError> {
    run_with_files(text, options, &NoFiles, job)
}

/// As [`run`], for a script that may name files: `files` returns what they hold. Meshes that are made on the
/// way (`redistance`) stay within the limits of the job.
///
/// # Errors
/// As for [`run`]; also when a file cannot be read.
pub fn run_with_files(
    text: &str,
    options: &RunOptions,
    files: &dyn ShapeFiles,
    job: &Job,
) -> Result<Script, ScriptError> {
    let Program { module, source, cuts } =
        parse(text.strip_prefix('\u{feff}').unwrap_or(text), &options.limits)?;
    if job.is_cancelled() {
        return Err(cancelled());
    }
    let globals = globals();
    let meter = Meter::new(options, (files, job), cuts.len());
    let outcome = Module::with_temp_heap(|environment| {
        let mut eval = Evaluator::new(&environment);
        let limits = &options.limits;
        let set = (|| {
            eval.set_max_callstack_size(limits.calls)?;
            eval.set_max_tick_count(limits.ticks)?;
            eval.set_max_heap_size(limits.heap)
        })();
        set.map_err(|error| ScriptError::new("script-limit", error.to_string()))?;
        eval.disable_gc();
        eval.set_check_cancelled(Box::new(|| job.is_cancelled()));
        eval.before_stmt_for_dap(BeforeStmtFunc::Dyn(Box::new(StatementHook)));
        eval.extra = Some(&meter);
        let value =
            eval.eval_module(module, &globals).map_err(|error| translated(&source, &error, limits, job))?;
        field_of(value, limits)
    });
    let field = outcome?;
    let parameters = meter.parameters.into_inner();
    if let Some(name) = options.set.keys().find(|name| !parameters.iter().any(|known| known.name == **name)) {
        let names: Vec<&str> = parameters.iter().map(|known| known.name.as_str()).collect();
        let known =
            if names.is_empty() { "it has none".to_owned() } else { format!("it has {}", names.join(", ")) };
        let message = format!("the script has no parameter '{name}'; {known}");
        return Err(ScriptError::new("unknown-parameter", message));
    }
    let mut cuts: Vec<usize> = cuts
        .into_iter()
        .zip(meter.cuts.into_inner())
        .filter_map(|(at, is_cut)| is_cut.then_some(at))
        .collect();
    cuts.sort_unstable();
    let places = source.lines_and_columns(&cuts);
    let mut warnings: Vec<ScriptWarning> = places.into_iter().map(ScriptWarning::last_operand_cut).collect();
    let mut bounded = meter.bounded.into_inner();
    bounded.sort_unstable();
    bounded.dedup();
    let offsets: Vec<usize> = bounded.into_iter().map(|at| source.place(at)).collect();
    warnings
        .extend(source.lines_and_columns(&offsets).into_iter().map(ScriptWarning::bound_taken_as_distance));
    warnings.sort_by_key(|warning| warning.place);
    Ok(Script { field, parameters, warnings })
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
fn globals() -> Globals {
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

fn field_of(value: Value, limits: &Limits) -> Result<Field, ScriptError> {
    let hint = match value.downcast_ref::<StarlarkShape>() {
        Some(StarlarkShape(Arg::Shape(solid))) if solid.weight > limits.terms => {
            let message = format!("the shape has more than {} terms", limits.terms);
            return Err(ScriptError::new("script-limit", message));
        }
        Some(StarlarkShape(Arg::Shape(solid))) => return Ok(solid.field.clone()),
        Some(_) => "a formula; field() makes a shape of it",
        None if value.is_none() => "nothing: its last line must be an expression, not an assignment",
        None if value.get_type() == "list" => "a list; union() joins shapes",
        None => "something else",
    };
    Err(ScriptError::new("script-value", format!("the script's value must be a shape, and is {hint}")))
}

fn cancelled() -> ScriptError {
    ScriptError::new("cancelled", "cancelled")
}

fn translated(source: &ScriptSource, error: &starlark::Error, limits: &Limits, job: &Job) -> ScriptError {
    if job.is_cancelled() {
        return cancelled();
    }
    let said = error.without_diagnostic().to_string();
    let limit = match error.kind() {
        ErrorKind::Other(cause) if cause.is::<LimitError>() => None,
        ErrorKind::Other(cause) if cause.is::<CallError>() => {
            return source.translate_error("script-error", error);
        }
        _ if said.contains("call stack overflow") || said.contains("recursion") => {
            Some(format!("more than {} functions wait for each other", limits.calls))
        }
        _ if said.starts_with("Execution duration limit") => {
            Some(format!("the script takes more than {} calls and turns of loops", limits.ticks))
        }
        _ if said.starts_with("Heap memory limit") => {
            Some(format!("the script's values take more than {} bytes", limits.heap))
        }
        _ => return source.translate_error("script-error", error),
    };
    let told = source.translate_error("script-limit", error);
    ScriptError { message: limit.unwrap_or(told.message), ..told }
}
