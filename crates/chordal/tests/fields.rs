//! The evaluator of fields: the tape against the plain one, ranges against points, leaves, and hostile
//! expressions.
mod answers;
mod hostile;
mod leaves;
mod models;
mod profiles;
mod promises;
mod soundness;
mod tape_laws;
