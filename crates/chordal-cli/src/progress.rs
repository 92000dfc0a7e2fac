//! How far the work is, on stderr.
use crate::console::Console;
use chordal::Job;

#[cfg(not(target_family = "wasm"))]
impl Console {
    /// The job with a bar on stderr, when that is a terminal and something may be said.
    pub fn progress(&self, job: Job) -> Job {
        use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
        if !self.shows_progress() {
            return job;
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        // The template is a constant; should it ever be wrong, the bar looks plainer.
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
    /// The job with a line for each hundredth, which a page shows as it likes: `\r`, the stage, the percentage.
    pub fn progress(&self, job: Job) -> Job {
        use std::io::Write;
        use std::sync::Mutex;
        if !self.shows_progress() {
            return job;
        }
        let said = Mutex::new(("", 0));
        job.with_progress(move |progress| {
            let now = (progress.stage, 100 * progress.done / progress.total.max(1));
            let mut said = said.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if *said != now {
                *said = now;
                // At once: stderr has no buffer, and each piece would be a line.
                let _ = std::io::stderr().write_all(format!("\r{} {}", now.0, now.1).as_bytes());
            }
        })
    }
}
