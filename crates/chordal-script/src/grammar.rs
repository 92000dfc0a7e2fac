//! What of Starlark scripts may use: parsed, looked through, and with operators that keep to the limits.
use crate::ScriptError;
use crate::operators::OPERATORS;
use starlark::syntax::ast::{
    ArgumentP, AssignOp, AssignTargetP, AstExpr, AstLiteral, AstNoPayload, AstStmt, ClauseP, ExprP, ParameterP, StmtP,
};
use starlark::syntax::{AstModule, Dialect, DialectTypes};

