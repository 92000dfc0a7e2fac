//! `Meter`: resource use of a script, beyond what the interpreter counts itself.
use crate::language::Arg;
use crate::{Limits, Parameter, RunOptions, ShapeFiles};
use chordal::Job;
use chordal::implicit::Field;
use starlark::any::ProvidesStaticType;
use starlark::eval::Evaluator;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt;

/// The state of one run of a script.
#[derive(ProvidesStaticType)]
pub(crate) struct Meter<'e> {
    pub limits: Limits,
    /// What files hold, and the conditions of work that takes long.
    pub files: &'e dyn ShapeFiles,
    pub job: &'e Job,
    /// The meshes that were read, by name.
    pub meshes: RefCell<BTreeMap<String, Field>>,
    /// Where bounds were taken as distances: offsets in the parsed text.
    pub bounded: RefCell<Vec<usize>>,
    /// Parameter values set by the caller, by name.
    pub set: BTreeMap<String, f64>,
    /// The parameters that the script has read.
    pub parameters: RefCell<Vec<Parameter>>,
    /// For each difference that is the right operand of a `|`, whether it has been one of shapes.
    pub cuts: RefCell<Vec<bool>>,
    work: Cell<u64>,
    made: Cell<u64>,
}

/// Why a script was stopped: it exceeded a limit.
#[derive(Debug)]
pub(crate) struct LimitError(pub String);

impl fmt::Display for LimitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for LimitError {}

impl<'e> Meter<'e> {
    pub fn new(options: &RunOptions, (files, job): (&'e dyn ShapeFiles, &'e Job), n_cuts: usize) -> Self {
        Self {
            limits: options.limits,
            files,
            job,
            meshes: RefCell::default(),
            bounded: RefCell::default(),
            set: options.set.clone(),
            parameters: RefCell::default(),
            cuts: RefCell::new(vec![false; n_cuts]),
            work: Cell::new(0),
            made: Cell::new(0),
        }
    }

    /// The meter of a run.
    pub fn from_eval<'a>(eval: &Evaluator<'_, 'a, 'e>) -> &'a Self {
        eval.extra.and_then(|extra| extra.downcast_ref()).expect("every run has its meter")
    }

    /// Charges for reading, or creating, that many elements.
    pub fn charge(eval: &mut Evaluator<'_, '_, 'e>, elements: usize) -> starlark::Result<()> {
        let meter = Self::from_eval(eval);
        let all = meter.work.get().saturating_add(elements as u64);
        meter.work.set(all);
        if all > meter.limits.work {
            return Err(exceeded(format!(
                "the script handles more than {} elements of lists",
                meter.limits.work
            )));
        }
        // The most bytes of an element, in a list that grows by doubling.
        const BYTES: usize = 16;
        let heap = eval.heap().peak_allocated_bytes().saturating_add(elements.saturating_mul(BYTES));
        if heap > Self::from_eval(eval).limits.heap {
            return Err(heap_exceeded(&Self::from_eval(eval).limits));
        }
        Ok(())
    }

    /// Charges for a new value of the language.
    pub fn charge_arg(&self, arg: &Arg) -> starlark::Result<()> {
        let all = self.made.get().saturating_add(arg.step_weight());
        self.made.set(all);
        if arg.weight() > self.limits.terms || all / 4 > self.limits.terms {
            return Err(exceeded(format!("the shape has more than {} terms", self.limits.terms)));
        }
        Ok(())
    }

    /// Checks the heap between statements, since one statement can double it.
    pub fn check_heap(eval: &mut Evaluator<'_, '_, 'e>) -> starlark::Result<()> {
        Self::charge(eval, 0)
    }
}

fn heap_exceeded(limits: &Limits) -> starlark::Error {
    exceeded(format!("the script's values take more than {} bytes", limits.heap))
}

/// The error for an exceeded limit.
pub(crate) fn exceeded(message: String) -> starlark::Error {
    starlark::Error::new_other(LimitError(message))
}
