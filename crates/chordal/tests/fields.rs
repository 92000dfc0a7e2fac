//! The evaluator of fields: the tape against the plain one, ranges against points, leaves, and hostile expressions.
#[path = "fields/models.rs"]
mod models;
#[path = "fields/tape_laws.rs"]
mod tape_laws;
#[path = "fields/leaves.rs"]
mod leaves;
#[path = "fields/hostile.rs"]
mod hostile;
#[path = "fields/soundness.rs"]
mod soundness;
