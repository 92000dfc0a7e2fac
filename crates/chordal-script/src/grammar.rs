//! The subset of Starlark that scripts may use: parses a text, checks it, and replaces operators by metered
//! functions.
use crate::advice::with_advice;
use crate::operators::OPERATORS;
use crate::script_source::{MeteredPart, ScriptSource, TextChange};
use crate::{Limits, ScriptError, nesting};
use starlark::codemap::Span;
use starlark::syntax::ast::{
    ArgumentP, AssignTargetP, AstAssignTarget, AstExpr, AstLiteral, AstParameter, AstStmt, BinOp, ExprP,
    ParameterP, StmtP,
};
use starlark::syntax::{AstModule, Dialect, DialectTypes};
use std::collections::HashMap;

/// A program with its source text.
pub(crate) struct Program {
    pub module: AstModule,
    pub source: ScriptSource,
    /// The right operands of `a | b - c`, as offsets in the text, in the order of their numbers.
    pub cuts: Vec<usize>,
}

/// Parses the text of a file into a program, whose cuts are numbered from `first_cut` on.
pub(crate) fn parse(
    text: &str,
    name: &str,
    first_cut: usize,
    limits: &Limits,
) -> Result<Program, ScriptError> {
    if text.len() > limits.bytes {
        let message = format!("the script has {} bytes, more than the limit of {}", text.len(), limits.bytes);
        return Err(ScriptError::new("script-limit", message));
    }
    // With one kind of line end, our scans and the parser agree on where strings and comments end.
    let text = text.replace("\r\n", "\n");
    if let Some(at) = text.find('\r') {
        return Err(
            ScriptError::new("script-syntax", "a carriage return alone does not end a line").at(&text, at)
        );
    }
    let text = text.as_str();
    // Before the parser, which recurses for every level.
    nesting::check(text, limits.nesting)?;
    let dialect = Dialect {
        enable_def: true,
        enable_lambda: true,
        enable_load: true,
        enable_keyword_only_arguments: true,
        enable_positional_only_arguments: false,
        enable_types: DialectTypes::Disable,
        enable_load_reexport: false,
        enable_top_level_stmt: true,
        enable_f_strings: false,
        ..Dialect::Standard
    };
    let parsed = |source: &ScriptSource| {
        AstModule::parse(name, source.rewritten.clone(), &dialect)
            .map_err(|error| with_advice(source.translate_error("script-syntax", &error)))
    };
    let plain = ScriptSource::new(text);
    let module = parsed(&plain)?;
    let mut scan = ProgramScan::default();
    statement(module.statement(), &mut scan);
    module.statement().visit_expr(|expr| expression(expr, &mut scan));
    if let Some((span, reason)) = scan.refusal {
        return Err(plain.error("script-syntax", reason, span));
    }
    let mut calls: Vec<MeteredPart> =
        scan.calls.into_iter().map(|(span, function)| (plain.extent(span), function)).collect();
    calls.sort_by_key(|(part, _)| part.start);
    // Callees are wrapped too: Starlark prints them in its errors, which would never end for nested shared
    // lists.
    let mut changes: Vec<TextChange> =
        calls.iter().flat_map(|(part, function)| ScriptSource::wrap(part, function, "")).collect();
    for (target, operator, statement) in scan.assignments {
        let change = plain.assignment(&target, &operator, statement, &calls);
        let unreadable = || {
            plain.error("script-syntax", "this assignment is not supported: write it as a = a + b", statement)
        };
        changes.extend(change.ok_or_else(unreadable)?);
    }
    let mut cuts = Vec::new();
    for operands in scan.cuts {
        if let Some(cut) = plain.bare_right_operand(operands) {
            changes.extend(ScriptSource::wrap(&cut, LAST_OPERAND, &format!(", {}", first_cut + cuts.len())));
            cuts.push(cut.start);
        }
    }
    let source = plain.with_changes(changes);
    // The tree cannot be changed in place, so the changed text is parsed again.
    let mut module = if source.is_changed() { parsed(&source)? } else { module };
    if source.is_changed() {
        // A string or comment that our scan reads differently from the parser would leave calls
        // unmetered; that is refused here.
        check_rewritten(&module, &source)?;
    }
    // The order of the map does not matter: it is only looked up. No name of a script can be an operator.
    let functions: HashMap<String, String> = OPERATORS.map(|op| (op.to_owned(), op.to_owned())).into();
    module.replace_binary_operators(&functions);
    Ok(Program { module, source, cuts })
}

/// Refuses a rewritten program that still has an unmetered construct, in case the rewriting itself was wrong.
fn check_rewritten(module: &AstModule, source: &ScriptSource) -> Result<(), ScriptError> {
    let mut scan = ProgramScan::default();
    statement(module.statement(), &mut scan);
    module.statement().visit_expr(|expr| expression(expr, &mut scan));
    let assignment = scan.assignments.first().map(|(_, _, span)| (*span, "an assignment".to_owned()));
    let unmetered = scan.unmetered.map(|span| (span, "a call or an index".to_owned()));
    match scan.refusal.or(assignment).or(unmetered) {
        Some((span, construct)) => Err(source.error(
            "script-syntax",
            format!("{construct} is not supported in this form: write it in simpler steps"),
            span,
        )),
        None => Ok(()),
    }
}

/// The function that checks the callee of every call. Scripts can call it themselves, but gain nothing by it.
const CALLED: &str = "called__";

/// The function that checks every index, as `CALLED` checks callees.
const INDEX: &str = "index__";

/// The function that checks every key of a dictionary: it refuses keys that take long to compare.
const KEY: &str = "key__";

/// The function that records whether `b - c` in `a | b - c` is a shape; its second argument numbers the
/// place.
const LAST_OPERAND: &str = "last_operand__";

/// The findings of a scan through a program.
#[derive(Default)]
struct ProgramScan {
    /// The first construct that scripts may not use, with the reason.
    refusal: Option<(Span, String)>,
    /// Augmented assignments: targets, operators and the whole statements.
    assignments: Vec<(AstAssignTarget, String, Span)>,
    /// Expressions to wrap in a function, and which function.
    calls: Vec<(Span, &'static str)>,
    /// The operands of each `|` whose right one is a difference.
    cuts: Vec<[Span; 2]>,
    /// The first call, index or key that is not wrapped in its function; after the rewriting there is none.
    unmetered: Option<Span>,
}

impl ProgramScan {
    fn refuse(&mut self, span: Span, reason: &str) {
        self.refusal.get_or_insert_with(|| (span, reason.to_owned()));
    }

    fn key(&mut self, key: &AstExpr) {
        self.calls.push((key.span, KEY));
        if !is_call_of(key, KEY) {
            self.unmetered.get_or_insert(key.span);
        }
    }

    fn index(&mut self, index: &AstExpr) {
        self.calls.push((index.span, INDEX));
        if !is_call_of(index, INDEX) {
            self.unmetered.get_or_insert(index.span);
        }
    }
}

fn is_named(expr: &AstExpr, name: &str) -> bool {
    matches!(&expr.node, ExprP::Identifier(identifier) if identifier.node.ident == name)
}

fn is_call_of(expr: &AstExpr, name: &str) -> bool {
    matches!(&expr.node, ExprP::Call(function, _) if is_named(function, name))
}

fn statement(stmt: &AstStmt, scan: &mut ProgramScan) {
    match &stmt.node {
        StmtP::AssignModify(lhs, op, _) => {
            let operator = op.to_string().trim().trim_end_matches('=').to_owned();
            target(lhs, scan);
            scan.assignments.push((lhs.clone(), operator, stmt.span));
        }
        StmtP::Assign(assign) => target(&assign.lhs, scan),
        StmtP::For(for_loop) => target(&for_loop.var, scan),
        StmtP::Def(def) => parameters(&def.params, scan),
        _ => {}
    }
    stmt.visit_stmt(|inner| statement(inner, scan));
}

fn parameters(parameters: &[AstParameter], scan: &mut ProgramScan) {
    for parameter in parameters {
        if matches!(parameter.node, ParameterP::Args(..) | ParameterP::KwArgs(..)) {
            scan.refuse(parameter.span, "*args and **kwargs are not supported: take a list instead");
        }
    }
}

fn expression(expr: &AstExpr, scan: &mut ProgramScan) {
    /// Bytes of the longest whole number: 2^60 has 19 digits.
    const LONGEST_NUMBER: u32 = 20;
    let reason = match &expr.node {
        ExprP::Dot(_, name) if name.node != "append" => {
            Some("attributes are not supported, except append() of lists")
        }
        ExprP::Index2(_) | ExprP::Slice(..) => Some("slices are not supported: use a list comprehension"),
        ExprP::BitNot(_) => Some("~ is not supported: use complement()"),
        ExprP::FString(_) | ExprP::Literal(AstLiteral::Bytes(_) | AstLiteral::Ellipsis) => {
            Some("f-strings, bytes and '...' are not supported")
        }
        ExprP::Literal(AstLiteral::Int(_))
            if expr.span.end().get() - expr.span.begin().get() > LONGEST_NUMBER =>
        {
            Some("whole numbers above 2^60 are not supported")
        }
        ExprP::Call(_, args) if args.args.iter().any(|arg| matches!(arg.node, ArgumentP::KwArgs(_))) => {
            Some("** is not supported in calls: name the arguments")
        }
        _ => None,
    };
    if let Some(reason) = reason {
        scan.refuse(expr.span, reason);
    } else if scan.refusal.is_none() {
        if let ExprP::Lambda(lambda) = &expr.node {
            parameters(&lambda.params, scan);
        }
        // Calls of attributes are those of append() alone, which needs no check of the callee.
        if let ExprP::Call(function, _) = &expr.node
            && !matches!(function.node, ExprP::Dot(..))
        {
            scan.calls.push((function.span, CALLED));
            // In the second pass every call must have been wrapped, except those of the wrappers.
            let names = [CALLED, INDEX, KEY, LAST_OPERAND];
            if !names.iter().any(|name| is_named(function, name)) && !is_call_of(function, CALLED) {
                scan.unmetered.get_or_insert(function.span);
            }
        }
        match &expr.node {
            ExprP::Index(parts) => scan.index(&parts.1),
            ExprP::Dict(entries) => entries.iter().for_each(|(key, _)| scan.key(key)),
            ExprP::DictComprehension(entry, ..) => scan.key(&entry.0),
            _ => {}
        }
        if let ExprP::Op(left, BinOp::BitOr, right) = &expr.node
            && matches!(right.node, ExprP::Op(_, BinOp::Subtract, _))
        {
            scan.cuts.push([left.span, right.span]);
        }
        expr.visit_expr(|inner| expression(inner, scan));
    }
}

/// Finds indexed elements among assignment targets, also in tuples.
fn target(target: &AstAssignTarget, scan: &mut ProgramScan) {
    match &target.node {
        AssignTargetP::Index(parts) => scan.index(&parts.1),
        AssignTargetP::Tuple(targets) => targets.iter().for_each(|item| self::target(item, scan)),
        AssignTargetP::Dot(..) => scan.refuse(target.span, "attributes are not supported"),
        AssignTargetP::Identifier(_) => {}
    }
}
