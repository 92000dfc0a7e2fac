//! `time_limit`: the time after which a field is taken as far as it is proved, the same in every front end. Front ends
//! measure the time: there is no clock here.
use crate::Shape;
use chordal::budget::RequiredEvidence;
use chordal::budget::proof::ProofEffort;
use std::time::Duration;

/// The default time after which the best result is taken. Chosen: nobody waits longer for a part without a sign of progress.
const USUAL: Duration = Duration::from_secs(60);

/// The time after which a front end has to tell a job for a shape to finish ([`Job::finish`](chordal::Job::finish)): the
/// given time, or the default. An explicitly requested proof has no limit unless one is given, and other shapes than fields
/// have none.
#[must_use]
pub fn time_limit(
    shape: &Shape,
    given: Option<Duration>,
    require: Option<RequiredEvidence>,
    effort: ProofEffort,
) -> Option<Duration> {
    let is_unlimited = require == Some(RequiredEvidence::Proved) || effort == ProofEffort::Full;
    let default_time = (!is_unlimited).then_some(USUAL);
    given.or(default_time).filter(|_| matches!(shape, Shape::Field(_)))
}

/// Parses a time.
///
/// # Errors
/// A sentence, if the text is not a time above 0.
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
