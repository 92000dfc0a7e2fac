//! `Deadline`: asks a job, after a while, to end with the best that it has, and says on the way that it is at work.
use crate::console::Console;
use chordal::Job;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// After how long something is said. Chosen: at a terminal one waits for so long without asking; a log of many runs is read
/// where one of them is slow.
#[cfg(not(target_family = "wasm"))]
const FIRST_SIGN: Duration = Duration::from_secs(5);
#[cfg(not(target_family = "wasm"))]
const FIRST_LINE: Duration = Duration::from_secs(30);

/// Ends with its value.
pub struct Deadline(Arc<(Mutex<bool>, Condvar)>);

impl Deadline {
    /// Begins to count; without a console nothing is said on the way.
    #[cfg(not(target_family = "wasm"))]
    pub fn start(job: &Job, within: Duration, console: Option<Console>) -> Self {
        use std::sync::atomic::Ordering;
        let state = Arc::new((Mutex::new(false), Condvar::new()));
        let (shared, finish) = (Arc::clone(&state), job.finish_flag());
        let sign = |console: &Console| if console.shows_progress() { FIRST_SIGN } else { FIRST_LINE };
        let first = console.as_ref().map_or(within, |console| within.min(sign(console)));
        std::thread::spawn(move || {
            if is_over_after(&shared, first) {
                return;
            }
            if let Some(console) = console.filter(|_| within > first) {
                console.say(&format!(
                    "at work for {} s: the best so far is written after {} s at the latest; --within says otherwise",
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

    /// There is no thread to count on.
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

/// Waits for so long, or until the work is over; returns whether it is.
#[cfg(not(target_family = "wasm"))]
fn is_over_after((over, told): &(Mutex<bool>, Condvar), time: Duration) -> bool {
    let guard = over.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = told.wait_timeout_while(guard, time, |over| !*over);
    *waited.unwrap_or_else(PoisonError::into_inner).0
}
