//! Summaries of reports for people: a few aligned lines.
use crate::numbers::{RoundingDirection, grouped, short, size};
use chordal_verbs::report::{
    AttributeFacts, BooleanFacts, BoundFacts, Output, OvershadeFacts, Report, RunFacts, ShadingFacts,
    SmoothingFacts, TriangleFacts, ValidityFacts, VerbFacts,
};
use std::fmt::Write;

/// Lines of a name and a value, with aligned values.
pub(crate) struct SummaryLines(pub String);

impl SummaryLines {
    pub fn titled(title: &str) -> Self {
        Self(format!("{title}\n"))
    }

    /// The title: input and output.
    pub fn of_run(run: &RunFacts) -> Self {
        let name = |name: &Option<String>| name.clone().unwrap_or_default();
        Self::titled(&format!("{} -> {}", name(&run.input), name(&run.output)))
    }

    pub fn add(&mut self, name: &str, value: impl AsRef<str>) {
        // Writing to a text does not fail.
        let _ = writeln!(self.0, "  {name:<11} {}", value.as_ref());
    }

    pub fn add_if(&mut self, name: &str, value: Option<String>) {
        if let Some(value) = value {
            self.add(name, value);
        }
    }

    /// The text.
    pub fn finish(self) -> String {
        self.0
    }

    /// The text, with the size of the output and the duration.
    pub fn finish_run(mut self, run: &RunFacts) -> String {
        self.add_if("size", run.bytes.map(size));
        self.add_if("seconds", run.seconds.map(|seconds| format!("{seconds:.2}")));
        self.0
    }
}

/// The summary of `mesh`.
pub fn mesh(report: &Report) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let mut lines = SummaryLines::of_run(run);
    if let Some(output) = &certificate.output {
        add_output(&mut lines, output);
    }
    if let VerbFacts::Refined { refined } = &certificate.verb {
        let sharpness =
            format!("{} and {} left", plural(refined.creases, "crease"), plural(refined.corners, "corner"));
        lines.add(
            "refined",
            format!("{} of {}, {sharpness}", plural(u64::from(refined.levels), "round"), refined.scheme),
        );
    }
    if let Some(facts) = certificate.verb.boolean() {
        lines.add("combined", combined(facts));
    }
    if let Some(facts) = &certificate.bound {
        lines.add("bound", bound(facts));
        facts.assumptions.iter().for_each(|sentence| lines.add("if", sentence));
        lines.add_if("not proved", facts.open.as_ref().map(ToString::to_string));
        let view = certificate.budget.as_ref().and_then(|budget| budget.view.as_ref());
        lines.add_if(
            "pixels",
            facts.pixels.zip(view).map(|(pixels, view)| {
                format!("at most {} at {}", short(pixels, RoundingDirection::Up), view.text)
            }),
        );
    }
    let angle = certificate.bound.as_ref().and_then(|facts| facts.angle_deg);
    lines.add_if(
        "angle",
        angle.map(|angle| {
            format!("{} degrees between normals, measured", short(angle, RoundingDirection::Up))
        }),
    );
    if let VerbFacts::Smoothed { smoothed } = &certificate.verb {
        lines.add("smoothed", smoothing(smoothed));
    }
    certificate.verb.attributes().iter().for_each(|facts| lines.add("attribute", attribute(facts)));
    certificate.stayed.iter().for_each(|note| lines.add("stayed", &**note));
    certificate.warned.iter().for_each(|note| lines.add("note", &**note));
    if let Some(valid) = &certificate.valid {
        add_validity(&mut lines, valid);
    }
    lines.finish_run(run)
}

/// The operations of a Boolean and their method.
fn combined(facts: &BooleanFacts) -> String {
    let ops: Vec<&str> = facts.operands.iter().filter_map(|operand| operand.op).collect();
    let kept: Vec<String> = facts.operands.iter().map(|operand| grouped(operand.kept)).collect();
    format!(
        "by {}, in {} arithmetic; triangles kept of each: {}",
        ops.join(", "),
        facts.method,
        kept.join(", ")
    )
}

/// The effect of smoothing.
fn smoothing(facts: &SmoothingFacts) -> String {
    let most =
        facts.at_most.map_or_else(|| "any length".to_owned(), |most| short(most, RoundingDirection::Up));
    let least = short(facts.at_least, RoundingDirection::Down);
    format!(
        "{} samples changed sides, {} were inside before; the surface moved by {least} to {most} ({})",
        grouped(facts.changed),
        grouped(facts.inside),
        facts.evidence
    )
}

/// The summary of `render`.
pub fn render(report: &Report, picture: &str, back_share: Option<f64>) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let mut lines = SummaryLines::of_run(run);
    lines.add("picture", picture);
    if let Some(output) = &certificate.output {
        add_output(&mut lines, output);
    }
    lines
        .add_if("backs", back_share.map(|share| format!("{:.0}% of the triangles face away", 100.0 * share)));
    if let VerbFacts::Overshade { overshade: facts } = &certificate.verb {
        overshade(&mut lines, facts);
    }
    if let Some(facts) = &certificate.bound {
        lines.add("bound", bound(facts));
    }
    lines.finish_run(run)
}

fn overshade(lines: &mut SummaryLines, facts: &OvershadeFacts) {
    let share = |part: u64, total: u64| if total == 0 { 0.0 } else { 100.0 * part as f64 / total as f64 };
    let [in_view, missed, micro] = [facts.in_view, facts.missed, facts.micro];
    lines.add("in view", plural(in_view, "triangle"));
    lines.add("tiny", format!("{:.1}% are smaller than a pixel", share(micro, in_view)));
    lines.add("missed", format!("{:.1}% cover no pixel's centre", share(missed, in_view)));
    lines.add("covered", plural(facts.covered_px, "pixel"));
    let shaded = |shaded: &ShadingFacts| {
        let quads = plural(shaded.quads, "quad");
        format!("{quads}, {:.1}% of their lanes are helpers", 100.0 * shaded.helper_share)
    };
    lines.add("visible", format!("{}; {:.2} lanes a covered pixel", shaded(&facts.visible), facts.ratio));
    lines.add("with hidden", shaded(&facts.every));
    lines.add("flicker", format!("{:.2}% of the way from black to white", 100.0 * facts.flicker));
}

pub(crate) fn add_output(lines: &mut SummaryLines, output: &Output) {
    match output {
        Output::Triangles(output) => triangles(lines, output),
        Output::Polygons(output) => {
            lines.add("faces", grouped(output.faces));
            lines.add("vertices", grouped(output.vertices));
        }
        Output::Polylines(output) => {
            lines.add("polylines", grouped(output.polylines));
            lines.add(
                "segments",
                format!("{} between {} points", grouped(output.segments), grouped(output.points)),
            );
        }
    }
}

fn triangles(lines: &mut SummaryLines, output: &TriangleFacts) {
    lines.add("triangles", grouped(output.triangles));
    let has_splits = output.vertices != output.positions;
    let positions =
        if has_splits { format!(" at {} positions", grouped(output.positions)) } else { String::new() };
    lines.add("vertices", grouped(output.vertices) + &positions);
}

fn add_validity(lines: &mut SummaryLines, valid: &ValidityFacts) {
    let counts = &valid.counts;
    lines.add(
        "closed",
        if counts.closed { "yes".into() } else { no(&[(counts.boundary_loops, "boundary loop")]) },
    );
    if !counts.manifold {
        let [edges, vertices] = [counts.non_manifold_edges, counts.non_manifold_vertices];
        lines.add(
            "manifold",
            no(&[(edges, "edge of three triangles or more"), (vertices, "vertex of several fans")]),
        );
    }
    if !counts.oriented {
        lines.add("oriented", no(&[(counts.inconsistent_edges, "edge of opposite winding")]));
    }
}

/// `no: 2 edges of this, 1 vertex of that`.
fn no(why: &[(u64, &str)]) -> String {
    let counted = why.iter().filter(|(count, _)| *count > 0).map(|(count, what)| plural(*count, what));
    let counted: Vec<_> = counted.collect();
    if counted.is_empty() { "no".to_owned() } else { format!("no: {}", counted.join(", ")) }
}

/// `1 edge of this`, `2 edges of this`, `2 vertices of that`.
pub(crate) fn plural(count: u64, what: &str) -> String {
    let noun_end = [" of ", " within "].iter().find_map(|word| what.find(word)).unwrap_or(what.len());
    let (noun, rest) = what.split_at(noun_end);
    let noun = match (count, noun.strip_suffix("ex")) {
        (1, _) => noun.to_owned(),
        (_, Some(stem)) => format!("{stem}ices"),
        (_, None) => format!("{noun}s"),
    };
    format!("{} {noun}{rest}", grouped(count))
}

/// The error of an attribute.
pub fn attribute(facts: &AttributeFacts) -> String {
    let unit = if facts.unit == "degrees" { " degrees" } else { "" };
    let error = facts.largest.zip(facts.rms).map_or("by a non-finite amount".to_owned(), |(largest, rms)| {
        format!(
            "up to {}{unit}, {} root mean square",
            short(largest, RoundingDirection::Up),
            short(rms, RoundingDirection::Up)
        )
    });
    format!("{} off {error} (measured)", facts.name)
}

/// The restriction of a bound that is not two-sided: added surfaces, as of filled holes, are far from the
/// source. A bound of a Boolean is for the sides of points.
pub(crate) fn one_way_note(metric: &str) -> &'static str {
    match metric {
        "one-sided" => ", of the source; what was added is not counted",
        "solid" => ", to sides: thin tips may be shorter",
        _ => "",
    }
}

pub(crate) fn bound(facts: &BoundFacts) -> String {
    let least = short(facts.at_least, RoundingDirection::Down);
    let one_way = one_way_note(facts.metric);
    match facts.at_most {
        Some(most) => {
            format!(
                "between {least} and {} ({}{one_way})",
                short(most, RoundingDirection::Up),
                facts.evidence
            )
        }
        None if facts.evidence == "estimated" && facts.at_least == 0.0 => "not known (estimated)".into(),
        None if facts.evidence == "measured" => {
            format!("{least} at the farthest point looked at (measured{one_way})")
        }
        None => format!("at least {least} ({})", facts.evidence),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_in_words() {
        assert_eq!(plural(1, "edge of three triangles or more"), "1 edge of three triangles or more");
        assert_eq!(plural(2_000, "vertex of several fans"), "2,000 vertices of several fans");
        assert_eq!(no(&[(6, "boundary loop")]), "no: 6 boundary loops");
        assert_eq!(no(&[(0, "boundary loop")]), "no");
    }
}
