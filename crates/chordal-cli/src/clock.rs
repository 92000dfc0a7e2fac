//! Facts of this run alone: its duration and its memory. They are never part of a certificate.
use crate::threads;
use chordal::Job;
use chordal_verbs::report::RunFacts;
use std::time::Instant;

/// A stopwatch, started with the verb.
#[derive(Clone, Copy, Debug)]
pub struct Clock(Instant);

impl Clock {
    /// Starts the clock.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Fills in time, memory and threads.
    pub fn fill(self, run: RunFacts, job: &Job) -> RunFacts {
        let threads = if job.threads == 0 { threads::available() } else { job.threads };
        RunFacts {
            seconds: Some(self.0.elapsed().as_secs_f64()),
            peak_bytes: peak_bytes(),
            threads: Some(threads as u64),
            ..run
        }
    }
}

/// The largest resident size so far, if the system has it in a file, as Linux.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    // The file says `kB`, and means 1024 bytes.
    Some(kibibytes * 1024)
}
