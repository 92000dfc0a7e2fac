//! What a batch came to: counts, the table at the end, the line while it runs.
use super::manifest::ManifestEntry;
use crate::fault::Exit;
use crate::numbers::{RoundingDirection, grouped, short};
use crate::summary::{SummaryLines, plural};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// How a file ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileVerdict {
    /// Done.
    Met,
    /// The budget was not reached.
    Unmet,
    /// The budget cannot be reached.
    Refused,
    /// It could not be read, written or done, or the process died.
    Failed,
}

impl FileVerdict {
    /// The verdict of an entry.
    pub fn new(entry: &ManifestEntry) -> Self {
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
    /// Files in all.
    pub files: u64,
    /// Done.
    pub met: u64,
    /// With a budget that was not reached.
    pub unmet: u64,
    /// With a budget that cannot be reached.
    pub refused: u64,
    /// With another error.
    pub failed: u64,
    /// Done before.
    pub skipped: u64,
    /// Triangles of the inputs that became something.
    pub triangles_in: u64,
    /// Triangles of what they became.
    pub triangles_out: u64,
    /// The largest of all, where there is one.
    pub bound: Option<f64>,
}

impl BatchTally {
    /// Counts a file that was done now, or before.
    pub fn add(&mut self, entry: &ManifestEntry, is_skipped: bool) {
        match FileVerdict::new(entry) {
            _ if is_skipped => self.skipped += 1,
            FileVerdict::Met => self.met += 1,
            FileVerdict::Unmet => self.unmet += 1,
            FileVerdict::Refused => self.refused += 1,
            FileVerdict::Failed => self.failed += 1,
        }
        // What did not become anything is in neither sum, so that they can be compared.
        if entry.output_sha256.is_some() {
            self.triangles_in += entry.triangles_in.unwrap_or_default();
            self.triangles_out += entry.triangles_out.unwrap_or_default();
            if self.bound.is_none_or(|most| entry.bound.is_some_and(|bound| bound > most)) {
                self.bound = entry.bound.or(self.bound);
            }
        }
    }

    /// Files that are over.
    pub fn over(&self) -> u64 {
        self.met + self.skipped + self.not_well()
    }

    /// Files that did not go well.
    pub fn not_well(&self) -> u64 {
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

    /// The same for programs.
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

/// The line on stderr: how many files are over, how many did not go well, how long it may take still.
#[derive(Debug)]
pub struct BatchProgress {
    /// None where nobody looks.
    bar: Option<ProgressBar>,
    started: Instant,
    /// Bytes of all inputs, and of those that were done now.
    bytes: u64,
    bytes_done: u64,
}

impl BatchProgress {
    /// A line about inputs of so many bytes, where it is shown.
    pub fn new(bytes: u64, is_shown: bool) -> Self {
        let bar = is_shown.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            // The template is a constant; should it ever be wrong, the line looks otherwise.
            if let Ok(style) = ProgressStyle::with_template("{msg}") {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, started: Instant::now(), bytes, bytes_done: 0 }
    }

    /// Says that an input of so many bytes is over.
    pub fn advance(&mut self, bytes: u64, is_skipped: bool, tally: &BatchTally) {
        if is_skipped {
            self.bytes = self.bytes.saturating_sub(bytes);
        } else {
            self.bytes_done += bytes;
        }
        if let Some(bar) = &self.bar {
            let left = left(self.started.elapsed(), self.bytes_done, self.bytes);
            bar.set_message(line(tally, left));
        }
    }

    /// Something else is written while the line is away.
    pub fn aside(&self, write: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Takes the line away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn line(tally: &BatchTally, left: Option<Duration>) -> String {
    let mut line = format!("{} of {} files", grouped(tally.over()), grouped(tally.files));
    if tally.not_well() > 0 {
        line += &format!(", {} not well", grouped(tally.not_well()));
    }
    line + &left.map_or_else(String::new, |left| format!(", about {} left", duration_text(left)))
}

/// The time for the bytes that are left, if they take as long as those before.
fn left(elapsed: Duration, done: u64, all: u64) -> Option<Duration> {
    let share = (all.saturating_sub(done)) as f64 / done as f64;
    // Without any done there is no share.
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
            (tally.over(), tally.bound, tally.triangles_in, tally.triangles_out),
            (7, Some(5.0), 30, 12)
        );
    }

    #[test]
    fn the_time_that_is_left_goes_by_bytes() {
        let text = |done, all| left(Duration::from_secs(100), done, all).map(duration_text);
        assert_eq!(text(50, 100).as_deref(), Some("2 minutes"));
        assert_eq!(text(99, 100).as_deref(), Some("1 second"));
        assert_eq!(text(1, 1000).as_deref(), Some("28 hours"));
        assert_eq!(text(0, 100), None);
        assert_eq!(text(0, 0), None);
    }
}
