//! The lines of `inspect` for a volume: how many samples, where, of which values, and which level suits them.
use crate::numbers::{RoundingDirection, grouped, point, short};
use crate::summary::{SummaryLines, plural};
use chordal_verbs::report::VolumeFacts;

/// How many labels are named; the report has more.
const LABELS: usize = 12;

/// What there is of samples.
pub(crate) fn samples(lines: &mut SummaryLines, volume: &VolumeFacts) {
    if !volume.name.is_empty() {
        lines.add("name", volume.name.escape_debug().to_string());
    }
    let [x, y, z] = volume.size.map(grouped);
    lines.add("samples", format!("{x} x {y} x {z} of {}", volume.samples));
    let number = |x: f64| short(x, RoundingDirection::Nearest);
    let [a, b, c] = volume.spacing.map(number);
    let mut how = vec![format!("{a} x {b} x {c}")];
    how.extend(volume.mirrored.then(|| "indices run left-handed".to_owned()));
    how.extend(volume.sheared.then(|| "sheared".to_owned()));
    lines.add("spacing", how.join(", "));
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
    let odd = [(volume.nan, "NaN, which are outside"), (volume.infinite, "infinite")];
    let odd = odd.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {} {what}", grouped(*n)));
    lines.add("values", values + &odd.collect::<String>());
    labels(lines, volume);
    if let Some(found) = &volume.suggested {
        let sure = if found.follows { "taken for" } else { "a guess for" };
        let article = if found.kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        // Every digit: it is copied to `--iso`.
        let words =
            format!("{}, with {} inside ({sure} {article} {})", found.level, found.inside, found.kind);
        lines.add("level", words);
    } else {
        lines.add("level", "none: all samples are equal");
    }
}

fn labels(lines: &mut SummaryLines, volume: &VolumeFacts) {
    let Some(n) = volume.labels else { return };
    let list = &volume.label_list;
    // More than these are numbers and not names.
    if n > list.len() as u64 || n < 2 {
        lines.add("distinct", plural(n, "value"));
        return;
    }
    let named = list.iter().take(LABELS).map(|label| match &*label.name {
        "" => label.label.to_string(),
        name => format!("{} {}", label.label, name.escape_debug()),
    });
    let named = named.collect::<Vec<_>>().join(", ");
    let more = if list.len() > LABELS { ", …" } else { "" };
    lines.add("distinct", format!("{}: {named}{more}", plural(n, "value")));
}
