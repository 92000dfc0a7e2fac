//! Whether a repair may start.
use crate::budget::advice::Message;
use crate::budget::{Job, JobError, Refusal, RefusalCode};
use crate::explicit::Mesh;

/// Checks whether a repair may start: the job is not cancelled, and its memory limit is sufficient.
pub(super) fn check_limits(mesh: &Mesh, job: &Job) -> Result<(), JobError> {
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    // Counted: a face and its sources 64 bytes, in and out 24, twins and sets 48; a row and its source 48, in
    // and out 56.
    let attributes: usize = mesh.attributes().iter().map(|attribute| attribute.values.len()).sum();
    let bytes = 136 * mesh.faces().len() + 104 * mesh.positions().len() + 16 * attributes;
    if bytes as u64 > job.memory_limit {
        let limit = job.memory_limit;
        return Err(refusal(
            RefusalCode::TooMuchMemory,
            format!("mending needs about {bytes} bytes; the limit is {limit}"),
        ));
    }
    Ok(())
}

pub(super) fn refusal(code: RefusalCode, message: impl Into<Message>) -> JobError {
    JobError::Refused(Refusal::new(code, message))
}
