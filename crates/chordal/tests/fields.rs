//! The evaluator of fields: the tape against the plain one, ranges against points, leaves, and hostile expressions.
#[path = "fields/hostile.rs"]
mod hostile;
#[path = "fields/leaves.rs"]
mod leaves;
#[path = "fields/models.rs"]
mod models;
#[path = "fields/profiles.rs"]
mod profiles;
#[path = "fields/promises.rs"]
mod promises;
#[path = "fields/soundness.rs"]
mod soundness;
#[path = "fields/tape_laws.rs"]
mod tape_laws;
