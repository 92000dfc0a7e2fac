//! `time_limit`: after how long a field is taken as it is, the same in every shell. Shells count the time: nothing here has a
//! clock.
use crate::Shape;
use chordal::budget::RequiredEvidence;
use chordal::budget::proof::ProofEffort;
use std::time::Duration;

/// After how long the best is taken unless something else is said. Chosen: nobody waits longer for a part without a sign.
const USUAL: Duration = Duration::from_secs(60);

/// After how long a job for a shape is to be told to finish ([`Job::finish`](chordal::Job::finish)): after the time that is
/// said, or the usual one. A proof that is asked for by name has no end unless one is said, and what is no field has none.
#[must_use]
pub fn time_limit(
    shape: &Shape,
    said: Option<Duration>,
    require: Option<RequiredEvidence>,
    effort: ProofEffort,
) -> Option<Duration> {
    let has_no_end = require == Some(RequiredEvidence::Proved) || effort == ProofEffort::Full;
    let usual = (!has_no_end).then_some(USUAL);
    said.or(usual).filter(|_| matches!(shape, Shape::Field(_)))
}

/// A time as a text.
///
/// # Errors
/// A sentence, where it is none, or not above 0.
///
/// ```
/// use std::time::Duration;
/// assert_eq!(chordal_verbs::parse_time("2m"), Ok(Duration::from_secs(120)));
/// assert!(chordal_verbs::parse_time("5").is_err());
/// ```
pub fn parse_time(text: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0)];
    let split = units.iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let seconds = split.and_then(|(number, seconds)| Some(number.trim().parse::<f64>().ok()? * seconds));
    let time = seconds.filter(|seconds| *seconds > 0.0).and_then(|s| Duration::try_from_secs_f64(s).ok());
    time.ok_or_else(|| "a time is a number above 0 and a unit, as in 20s, 2m or 500ms".into())
}
