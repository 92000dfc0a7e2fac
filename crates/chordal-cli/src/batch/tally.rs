//! The counts of a batch: the table at its end, and the progress line.
use super::manifest::ManifestEntry;
use crate::fault::Exit;
use crate::numbers::{RoundingDirection, grouped, short};
use crate::summary::{SummaryLines, plural};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// The outcome of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileVerdict {
    /// Done.
    Met,
    /// The budget was not met.
    Unmet,
    /// The budget cannot be met.
    Refused,
    /// Another error, or the process died.
    Failed,
}

impl FileVerdict {
    /// The verdict of an entry.
    pub fn new(entry: &ManifestEntry) -> Self {
        // A best result that was kept has a report in place of an error, and so no code.
        let is_unmet = entry.code.as_deref() == Some("unmet") || entry.output_sha256.is_some();
        match entry.exit {
            Some(0) => Self::Met,
            Some(exit) if exit == Exit::Budget as i32 && is_unmet => Self::Unmet,
            Some(exit) if exit == Exit::Budget as i32 => Self::Refused,
            _ => Self::Failed,
        }
    }
}

/// Counts of files.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BatchTally {
    /// All files.
    pub files: u64,
    /// Done.
    pub met: u64,
    /// With a budget that was not met.
    pub unmet: u64,
    /// With a budget that cannot be met.
    pub refused: u64,
    /// With another error.
    pub failed: u64,
    /// Done by an earlier run.
    pub skipped: u64,
    /// Triangles of the inputs that have outputs.
    pub triangles_in: u64,
    /// Triangles of the outputs.
    pub triangles_out: u64,
    /// The largest bound, if there is any.
    pub bound: Option<f64>,
}

impl BatchTally {
    /// Counts a file that was processed now or by an earlier run.
    pub fn add(&mut self, entry: &ManifestEntry, is_skipped: bool) {
        match FileVerdict::new(entry) {
            _ if is_skipped => self.skipped += 1,
            FileVerdict::Met => self.met += 1,
            FileVerdict::Unmet => self.unmet += 1,
            FileVerdict::Refused => self.refused += 1,
            FileVerdict::Failed => self.failed += 1,
        }
        // Inputs without an output are left out of both sums, so that these can be compared.
        if entry.output_sha256.is_some() {
            self.triangles_in += entry.triangles_in.unwrap_or_default();
            self.triangles_out += entry.triangles_out.unwrap_or_default();
            if self.bound.is_none_or(|most| entry.bound.is_some_and(|bound| bound > most)) {
                self.bound = entry.bound.or(self.bound);
            }
        }
    }

    /// The number of finished files.
    pub fn finished(&self) -> u64 {
        self.met + self.skipped + self.not_met()
    }

    /// The number of files that are unmet, refused or failed.
    pub fn not_met(&self) -> u64 {
        self.unmet + self.refused + self.failed
    }

    /// The table.
    pub fn text(&self, folder: &str, seconds: f64) -> String {
        let mut lines = SummaryLines::titled(folder);
        lines.add("files", grouped(self.files));
        lines.add("met", grouped(self.met));
        for (name, count) in [
            ("unmet", self.unmet),
            ("refused", self.refused),
            ("failed", self.failed),
            ("skipped", self.skipped),
        ] {
            lines.add_if(name, (count > 0).then(|| grouped(count)));
        }
        let triangles = format!("{} -> {}", grouped(self.triangles_in), grouped(self.triangles_out));
        lines.add_if("triangles", (self.triangles_in + self.triangles_out > 0).then_some(triangles));
        lines.add_if(
            "bound",
            self.bound.map(|most| format!("at most {}", short(most, RoundingDirection::Up))),
        );
        lines.add("seconds", format!("{seconds:.2}"));
        lines.finish()
    }

    /// The same as JSON.
    pub fn to_value(self, manifest: &str, seconds: f64) -> Value {
        json!({
            "schema": "chordal.batch/1",
            "files": self.files,
            "met": self.met,
            "unmet": self.unmet,
            "refused": self.refused,
            "failed": self.failed,
            "skipped": self.skipped,
            "triangles_in": self.triangles_in,
            "triangles_out": self.triangles_out,
            "bound": self.bound,
            "seconds": seconds,
            "manifest": manifest,
        })
    }
}

/// The progress line on stderr: finished files, failed files and the remaining time.
#[derive(Debug)]
pub struct BatchProgress {
    /// `None` if the line is not shown.
    bar: Option<ProgressBar>,
    started: Instant,
    /// Bytes of all inputs that this run processes, and of those that are finished.
    bytes: u64,
    bytes_done: u64,
}

impl BatchProgress {
    /// A progress line for inputs of a number of bytes.
    pub fn new(bytes: u64, is_shown: bool) -> Self {
        let bar = is_shown.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            // The template is a constant; if it were ever invalid, the line would just look different.
            if let Ok(style) = ProgressStyle::with_template("{msg}") {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, started: Instant::now(), bytes, bytes_done: 0 }
    }

    /// Counts an input of a number of bytes as finished.
    pub fn advance(&mut self, bytes: u64, is_skipped: bool, tally: &BatchTally) {
        if is_skipped {
            self.bytes = self.bytes.saturating_sub(bytes);
        } else {
            self.bytes_done += bytes;
        }
        if let Some(bar) = &self.bar {
            let left = time_left(self.started.elapsed(), self.bytes_done, self.bytes);
            bar.set_message(line(tally, left));
        }
    }

    /// Hides the line while something else is written.
    pub fn aside(&self, write: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Removes the line.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn line(tally: &BatchTally, left: Option<Duration>) -> String {
    let mut line = format!("{} of {} files", grouped(tally.finished()), grouped(tally.files));
    if tally.not_met() > 0 {
        line += &format!(", {} failed", grouped(tally.not_met()));
    }
    line + &left.map_or_else(String::new, |left| format!(", about {} left", duration_text(left)))
}

/// The remaining time if bytes take as long as before.
fn time_left(elapsed: Duration, done: u64, total: u64) -> Option<Duration> {
    let share = (total.saturating_sub(done)) as f64 / done as f64;
    // If nothing is done yet, the share is not finite and the result is `None`.
    Duration::try_from_secs_f64(elapsed.as_secs_f64() * share).ok()
}

fn duration_text(duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..60 => plural(seconds, "second"),
        seconds @ 60..7200 => plural(seconds.div_ceil(60), "minute"),
        seconds => plural(seconds.div_ceil(3600), "hour"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(exit: Option<i32>, code: Option<&str>, output: bool) -> ManifestEntry {
        ManifestEntry {
            exit,
            code: code.map(str::to_owned),
            output_sha256: output.then(|| "00".to_owned()),
            bound: Some(f64::from(exit.unwrap_or(9))),
            triangles_in: Some(10),
            triangles_out: output.then_some(4),
            ..ManifestEntry::default()
        }
    }

    #[test]
    fn files_are_counted_by_their_end() {
        let mut tally = BatchTally { files: 7, ..BatchTally::default() };
        for (entry, is_skipped) in [
            (entry(Some(0), None, true), false),
            (entry(Some(5), Some("unmet"), false), false),
            (entry(Some(5), None, true), false),
            (entry(Some(5), Some("budget"), false), false),
            (entry(Some(3), Some("no-vertices"), false), false),
            (entry(None, None, false), false),
            (entry(Some(0), None, true), true),
        ] {
            tally.add(&entry, is_skipped);
        }
        let BatchTally { met, unmet, refused, failed, skipped, .. } = tally;
        assert_eq!([met, unmet, refused, failed, skipped], [1, 2, 1, 2, 1]);
        assert_eq!(
            (tally.finished(), tally.bound, tally.triangles_in, tally.triangles_out),
            (7, Some(5.0), 30, 12)
        );
    }

    #[test]
    fn the_time_that_is_left_goes_by_bytes() {
        let text = |done, total| time_left(Duration::from_secs(100), done, total).map(duration_text);
        assert_eq!(text(50, 100).as_deref(), Some("2 minutes"));
        assert_eq!(text(99, 100).as_deref(), Some("1 second"));
        assert_eq!(text(1, 1000).as_deref(), Some("28 hours"));
        assert_eq!(text(0, 100), None);
        assert_eq!(text(0, 0), None);
    }
}
