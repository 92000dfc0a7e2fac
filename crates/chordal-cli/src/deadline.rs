//! `Deadline`: asks a job to end with its best result after a time limit, and prints a message while waiting.
use crate::console::Console;
use chordal::Job;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// When the message is printed: early at a terminal with a progress bar, later without one. Chosen: users get
/// impatient after some seconds; logs should only mention slow runs.
#[cfg(not(target_family = "wasm"))]
const FIRST_SIGN: Duration = Duration::from_secs(5);
#[cfg(not(target_family = "wasm"))]
const FIRST_LINE: Duration = Duration::from_secs(30);

/// A running time limit, which ends when it is dropped.
pub struct Deadline(Arc<(Mutex<bool>, Condvar)>);

impl Deadline {
    /// Starts a time limit; without a console no message is printed.
    #[cfg(not(target_family = "wasm"))]
    pub fn start(job: &Job, within: Duration, console: Option<Console>) -> Self {
        use std::sync::atomic::Ordering;
        let state = Arc::new((Mutex::new(false), Condvar::new()));
        let (shared, finish) = (Arc::clone(&state), job.finish_flag());
        let delay = |console: &Console| if console.shows_progress() { FIRST_SIGN } else { FIRST_LINE };
        let first = console.as_ref().map_or(within, |console| within.min(delay(console)));
        std::thread::spawn(move || {
            if is_over_after(&shared, first) {
                return;
            }
            if let Some(console) = console.filter(|_| within > first) {
                console.say(&format!(
                    "still working after {} s: the best result so far is written after {} s at most; --within changes that",
                    first.as_secs(),
                    within.as_secs()
                ));
                if is_over_after(&shared, within - first) {
                    return;
                }
            }
            finish.store(true, Ordering::Relaxed);
        });
        Self(state)
    }

    /// Without threads there is no time limit.
    #[cfg(target_family = "wasm")]
    pub fn start(_: &Job, _: Duration, _: Option<Console>) -> Self {
        Self(Arc::default())
    }
}

impl Drop for Deadline {
    fn drop(&mut self) {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.1.notify_all();
    }
}

/// Waits for a duration or until the work is over; returns whether it is.
#[cfg(not(target_family = "wasm"))]
fn is_over_after((over, changed): &(Mutex<bool>, Condvar), time: Duration) -> bool {
    let guard = over.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = changed.wait_timeout_while(guard, time, |over| !*over);
    *waited.unwrap_or_else(PoisonError::into_inner).0
}
