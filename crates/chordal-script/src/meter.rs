//! `Meter`: the resources that a script uses, beyond those that the interpreter counts itself.
use crate::files::{FileUse, MOST_FILES, OpenedFile, OpenedShapes, ScriptFiles};
use crate::language::Arg;
use crate::{Limits, Parameter};
use chordal::Job;
use chordal::implicit::Field;
use starlark::any::ProvidesStaticType;
use starlark::eval::Evaluator;
use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// The state of one run of a script.
#[derive(ProvidesStaticType)]
pub(crate) struct Meter<'e> {
    pub limits: Limits,
    /// Opens the files that the script names.
    files: &'e dyn ScriptFiles,
    /// The limits and the cancellation of long operations.
    pub job: &'e Job,
    /// Calls that took a lower bound for a distance, as offsets in the parsed text.
    pub bounded: RefCell<Vec<usize>>,
    /// The first shapes that calls returned, with the offsets of the calls in the parsed text.
    pub steps: RefCell<Vec<(usize, Field)>>,
    /// Parameter values set by the caller, by name.
    pub set: BTreeMap<String, f64>,
    /// The parameters that the script has read.
    pub parameters: RefCell<Vec<Parameter>>,
    /// For each difference that is the right operand of a `|`, whether its value has been a shape.
    pub cuts: RefCell<Vec<bool>>,
    /// The lines that the script has printed.
    pub printed: RefCell<Vec<String>>,
    /// Notes about files and shapes, in sentences.
    pub notes: RefCell<Vec<String>>,
    /// The shapes of files, so that each is read once.
    shapes: RefCell<OpenedShapes>,
    /// Elements of lists and texts that were read or created so far.
    work: Cell<u64>,
    /// Terms that all steps together have added so far.
    terms: Cell<u64>,
}

/// The most lines that a script prints. Chosen: more than a report should hold.
const MOST_LINES: usize = 100;
/// The most shapes that are kept with their lines. Chosen: more than a part has lines, and a few megabytes at
/// most.
const MOST_STEPS: usize = 4096;
/// The most characters of a printed line. Chosen: some lines of a terminal.
const LONGEST_LINE: usize = 500;

/// The error of a script that exceeded a limit.
#[derive(Debug)]
pub(crate) struct LimitError(pub String);

impl fmt::Display for LimitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for LimitError {}

impl<'e> Meter<'e> {
    pub fn new(
        (limits, set): (Limits, BTreeMap<String, f64>),
        (files, job): (&'e dyn ScriptFiles, &'e Job),
        n_cuts: usize,
    ) -> Self {
        Self {
            limits,
            files,
            job,
            bounded: RefCell::default(),
            steps: RefCell::default(),
            set,
            parameters: RefCell::default(),
            cuts: RefCell::new(vec![false; n_cuts]),
            printed: RefCell::default(),
            notes: RefCell::default(),
            shapes: RefCell::default(),
            work: Cell::new(0),
            terms: Cell::new(0),
        }
    }

    /// The meter of a run.
    pub fn from_eval<'a>(eval: &Evaluator<'_, 'a, 'e>) -> &'a Self {
        eval.extra.and_then(|extra| extra.downcast_ref()).expect("every run has its meter")
    }

    /// Keeps the result of a call at an offset of the parsed text, if it is a shape.
    pub fn keep_step(&self, offset: usize, result: &Arg) {
        let mut steps = self.steps.borrow_mut();
        if let Arg::Shape(solid) = result
            && steps.len() < MOST_STEPS
        {
            steps.push((offset, solid.field.clone()));
        }
    }

    /// Charges for reading, or creating, that many elements.
    pub fn charge(eval: &mut Evaluator<'_, '_, 'e>, elements: usize) -> starlark::Result<()> {
        let meter = Self::from_eval(eval);
        let work = meter.work.get().saturating_add(elements as u64);
        meter.work.set(work);
        if work > meter.limits.work {
            return Err(exceeded(format!(
                "the script reads or creates more than {} list elements",
                meter.limits.work
            )));
        }
        // The most bytes of an element, in a list that grows by doubling.
        const BYTES: usize = 16;
        // With the elements that are about to be created: the interpreter itself notices them only
        // afterwards.
        let heap = eval.heap().peak_allocated_bytes().saturating_add(elements.saturating_mul(BYTES));
        if heap > Self::from_eval(eval).limits.heap {
            return Err(heap_exceeded(&Self::from_eval(eval).limits));
        }
        Ok(())
    }

    /// The shape of a file, which is opened once for each use.
    pub fn shape_of(&self, name: &str, file_use: FileUse) -> Result<Field, String> {
        // Floats have no order; their `Debug` form differs whenever they do.
        let key = (name.to_owned(), format!("{file_use:?}"));
        if let Some(field) = self.shapes.borrow().get(&key) {
            return Ok(field.clone());
        }
        // Counts files and not keys: a font that sets many texts is one file.
        let names: BTreeSet<String> = self.shapes.borrow().keys().map(|(name, _)| name.clone()).collect();
        if names.len() >= MOST_FILES && !names.contains(name) {
            return Err(format!("the script reads more than {MOST_FILES} files"));
        }
        match self.files.open(name, file_use, self.job)? {
            OpenedFile::Shape(field, sentences) => {
                let sentences = sentences.into_iter().map(|sentence| format!("{name}: {sentence}"));
                self.notes.borrow_mut().extend(sentences);
                self.shapes.borrow_mut().insert(key, field.clone());
                Ok(field)
            }
            OpenedFile::Script(_) => Err("it is a script".to_owned()),
        }
    }

    /// Keeps a printed line, unless there are too many.
    pub fn print(&self, line: &str) {
        let mut printed = self.printed.borrow_mut();
        match printed.len().cmp(&MOST_LINES) {
            Ordering::Less => printed.push(line.chars().take(LONGEST_LINE).collect()),
            Ordering::Equal => printed.push("further lines are omitted".to_owned()),
            Ordering::Greater => {}
        }
    }

    /// Charges for a new value of the language.
    pub fn charge_arg(&self, arg: &Arg) -> starlark::Result<()> {
        let terms = self.terms.get().saturating_add(arg.step_weight());
        self.terms.set(terms);
        // All steps together may add four times as many terms as the shape may have (`Limits::terms`).
        if arg.weight() > self.limits.terms || terms / 4 > self.limits.terms {
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
    exceeded(format!("the script's values take more than {} bytes of memory", limits.heap))
}

/// The error for an exceeded limit.
pub(crate) fn exceeded(message: String) -> starlark::Error {
    starlark::Error::new_other(LimitError(message))
}
