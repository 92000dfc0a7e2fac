//! The lines of `inspect` for a volume: its samples, their places and values, and a suitable level.
use crate::numbers::{RoundingDirection, grouped, point, short};
use crate::summary::{SummaryLines, plural};
use chordal_verbs::report::VolumeFacts;

/// The most labels that are listed; the JSON report has more. Chosen: they fit on a line.
const LABELS: usize = 12;

/// The facts of the samples.
pub(crate) fn samples(lines: &mut SummaryLines, volume: &VolumeFacts) {
    if !volume.name.is_empty() {
        lines.add("name", volume.name.escape_debug().to_string());
    }
    let [x, y, z] = volume.size.map(grouped);
    lines.add("samples", format!("{x} x {y} x {z} of {}", volume.samples));
    let number = |x: f64| short(x, RoundingDirection::Nearest);
    let [a, b, c] = volume.spacing.map(number);
    let mut details = vec![format!("{a} x {b} x {c}")];
    details.extend(volume.mirrored.then(|| "indices run left-handed".to_owned()));
    details.extend(volume.sheared.then(|| "sheared".to_owned()));
    lines.add("spacing", details.join(", "));
    let space = volume.space.as_ref().map(|space| match &volume.axes {
        Some(axes) => format!("{space}, indices run to {axes}"),
        None => space.clone(),
    });
    lines.add_if("space", space);
    lines.add("origin", point(volume.origin));
    let values = match (volume.low, volume.high) {
        (Some(low), Some(high)) => format!("{} to {}", number(low), number(high)),
        _ => "none that is finite".to_owned(),
    };
    let non_finite = [(volume.nan, "NaN, which are outside"), (volume.infinite, "infinite")];
    let non_finite =
        non_finite.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {} {what}", grouped(*n)));
    lines.add("values", values + &non_finite.collect::<String>());
    labels(lines, volume);
    if let Some(suggestion) = &volume.suggested {
        let confidence = if suggestion.follows { "taken for" } else { "a guess for" };
        let article = if suggestion.kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        // With every digit, since users copy it to `--iso`.
        let text = format!(
            "{}, with {} inside ({confidence} {article} {})",
            suggestion.level, suggestion.inside, suggestion.kind
        );
        lines.add("level", text);
    } else {
        lines.add("level", "none: all samples are equal");
    }
}

fn labels(lines: &mut SummaryLines, volume: &VolumeFacts) {
    let Some(n) = volume.labels else { return };
    let list = &volume.label_list;
    // The list is incomplete if there are many values, which are then measurements, not labels.
    if n > list.len() as u64 || n < 2 {
        lines.add("distinct", plural(n, "value"));
        return;
    }
    let names = list.iter().take(LABELS).map(|label| match &*label.name {
        "" => label.label.to_string(),
        name => format!("{} {}", label.label, name.escape_debug()),
    });
    let names = names.collect::<Vec<_>>().join(", ");
    let more = if list.len() > LABELS { ", …" } else { "" };
    lines.add("distinct", format!("{}: {names}{more}", plural(n, "value")));
}
