//! The progress of a job, on stderr.
use crate::console::Console;
use chordal::Job;

#[cfg(not(target_family = "wasm"))]
impl Console {
    /// The job with a progress bar on stderr, if that is a terminal and not quiet.
    pub fn progress(&self, job: Job) -> Job {
        use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
        if !self.shows_progress() {
            return job;
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        // The template is a constant; if it were ever invalid, the bar would just look plainer.
        if let Ok(style) = ProgressStyle::with_template("{msg:12} {wide_bar} {percent:>3} %") {
            bar.set_style(style);
        }
        job.with_progress(move |progress| {
            bar.set_length(progress.total);
            bar.set_message(progress.stage);
            bar.set_position(progress.done);
            if progress.done >= progress.total {
                bar.finish_and_clear();
            }
        })
    }
}

#[cfg(target_family = "wasm")]
impl Console {
    /// The job with a line for each percent, which the page displays: `\r`, the stage, the percentage.
    pub fn progress(&self, job: Job) -> Job {
        use std::io::Write;
        use std::sync::Mutex;
        if !self.shows_progress() {
            return job;
        }
        let last = Mutex::new(("", 0));
        job.with_progress(move |progress| {
            let now = (progress.stage, 100 * progress.done / progress.total.max(1));
            let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if *last != now {
                *last = now;
                // One write, since stderr is unbuffered and the page takes each write for a line.
                let _ = std::io::stderr().write_all(format!("\r{} {}", now.0, now.1).as_bytes());
            }
        })
    }
}
